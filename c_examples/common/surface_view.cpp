#include "common/surface_view.hpp"

#include "common/draw.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace {

const cv::Scalar dark(30, 30, 30), ink(40, 40, 40), paper(244, 244, 244);

std::string number(double value, double step)
{
    char text[32];
    const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step))), 0, 6);
    std::snprintf(text, sizeof text, "%.*f", digits, value == 0 ? 0.0 : value);
    return text;
}

// 1, 2 or 5 times a power of ten: about `count` steps in the range.
double round_step(double range, int count)
{
    const double rough = range / count, power = std::pow(10, std::floor(std::log10(rough)));
    for (const double factor : {1, 2, 5})
        if (factor * power >= rough)
            return factor * power;
    return 10 * power;
}

} // namespace

cv::Mat depth_colors(const Surface &surface)
{
    const cv::Mat &depth = surface.depth;
    const cv::Vec2d range = surface.range();
    const double extent = std::max(range[1] - range[0], 1e-30);
    cv::Mat gray(depth.size(), CV_8U, cv::Scalar(0)), valid(depth.size(), CV_8U, cv::Scalar(0));
    for (int y = 0; y < depth.rows; y++)
        for (int x = 0; x < depth.cols; x++) {
            const double z = depth.at<float>(y, x);
            if (std::isfinite(z)) {
                gray.at<uchar>(y, x) = cv::saturate_cast<uchar>(255 * (z - range[0]) / extent);
                valid.at<uchar>(y, x) = 255;
            }
        }
    cv::Mat colors, map(depth.size(), CV_8UC3, dark);
    cv::applyColorMap(gray, colors, cv::COLORMAP_VIRIDIS);
    colors.copyTo(map, valid);
    return map;
}

cv::Mat depth_picture(const Surface &surface, const std::string &unit)
{
    cv::Mat map = depth_colors(surface), colors;
    const cv::Vec2d range = surface.range();
    const double extent = std::max(range[1] - range[0], 1e-30);
    // The bar: the nearest depth at the top. Small pictures are enlarged so that the text beside them fits.
    const int factor = std::max(1, 240 / std::max(1, map.rows));
    cv::resize(map, map, cv::Size(), factor, factor, cv::INTER_NEAREST);
    constexpr int margin = 16, bar_width = 18, text_width = 84, title_height = 30;
    cv::Mat sheet(std::max(map.rows, 120) + title_height + margin, map.cols + 3 * margin + bar_width + text_width, CV_8UC3, paper);
    map.copyTo(sheet(cv::Rect(margin, title_height, map.cols, map.rows)));
    const cv::Rect bar(2 * margin + map.cols, title_height, bar_width, sheet.rows - title_height - margin);
    cv::Mat ramp(bar.height, 1, CV_8U);
    for (int y = 0; y < bar.height; y++)
        ramp.at<uchar>(y) = cv::saturate_cast<uchar>(255.0 * (bar.height - 1 - y) / std::max(1, bar.height - 1));
    cv::applyColorMap(cv::repeat(ramp, 1, bar.width), colors, cv::COLORMAP_VIRIDIS);
    colors.copyTo(sheet(bar));
    cv::rectangle(sheet, bar, ink, 1);
    put_text(sheet, "depth toward the camera, " + unit, {margin, 20}, 0.45, ink);
    const double step = round_step(extent, 5);
    for (double z = std::ceil(range[0] / step) * step; z <= range[1] + 1e-9 * extent; z += step) {
        const int y = bar.y + cvRound((bar.height - 1) * (1 - (z - range[0]) / extent));
        cv::line(sheet, {bar.x + bar.width, y}, {bar.x + bar.width + 5, y}, ink, 1);
        put_text(sheet, number(z, step), {bar.x + bar.width + 10, y + 5}, 0.42, ink);
    }
    return sheet;
}

cv::Mat mesh_picture(const Surface &surface, cv::Size size)
{
    cv::Mat picture(size, CV_8UC3, dark);
    const cv::Mat &depth = surface.depth;
    const double pitch = surface.params.pixel_pitch;
    // Turned about the vertical, then tilted toward the viewer.
    const double turn = -25 * CV_PI / 180, tilt = 35 * CV_PI / 180;
    const cv::Matx33d about_y(std::cos(turn), 0, std::sin(turn), 0, 1, 0, -std::sin(turn), 0, std::cos(turn));
    const cv::Matx33d about_x(1, 0, 0, 0, std::cos(tilt), -std::sin(tilt), 0, std::sin(tilt), std::cos(tilt));
    const cv::Matx33d view = about_x * about_y;
    const cv::Vec3d light = cv::normalize(cv::Vec3d(-0.4, 0.5, 0.8));
    const int step = std::max(1, cvRound(std::sqrt(static_cast<double>(depth.total()) / 90000)));
    const auto vertex = [&](int x, int y) {
        return view * cv::Vec3d(x * pitch, -y * pitch, depth.at<float>(y, x));
    };
    struct Square {
        double distance;
        int x, y;
    };
    std::vector<Square> squares;
    cv::Vec2d low(HUGE_VAL, HUGE_VAL), high = -low;
    for (int y = 0; y + step < depth.rows; y += step)
        for (int x = 0; x + step < depth.cols; x += step) {
            const cv::Vec3d corners[] = {vertex(x, y), vertex(x + step, y), vertex(x + step, y + step), vertex(x, y + step)};
            double distance = 0;
            for (const cv::Vec3d &corner : corners)
                distance += corner[2];
            if (!std::isfinite(distance))
                continue;
            squares.push_back({distance, x, y});
            for (const cv::Vec3d &corner : corners) {
                low = {std::min(low[0], corner[0]), std::min(low[1], corner[1])};
                high = {std::max(high[0], corner[0]), std::max(high[1], corner[1])};
            }
        }
    std::sort(squares.begin(), squares.end(), [](const Square &a, const Square &b) { return a.distance < b.distance; });
    constexpr int margin = 20, fraction_bits = 4;
    const double scale = std::min((size.width - 2 * margin) / std::max(high[0] - low[0], 1e-30),
                                  (size.height - 2 * margin) / std::max(high[1] - low[1], 1e-30));
    const cv::Vec2d middle = (low + high) / 2;
    const auto at = [&](const cv::Vec3d &v) {
        return cv::Point(cvRound((size.width / 2.0 + scale * (v[0] - middle[0])) * (1 << fraction_bits)),
                         cvRound((size.height / 2.0 - scale * (v[1] - middle[1])) * (1 << fraction_bits)));
    };
    for (const Square &square : squares) { // the farthest first
        const int x = square.x, y = square.y;
        const cv::Vec3d a = vertex(x, y), b = vertex(x + step, y), c = vertex(x + step, y + step), d = vertex(x, y + step);
        const cv::Vec3d normal = cv::normalize((a - c).cross(d - b)); // toward the camera of the depth map
        const double shade = 40 + 205 * std::max(0.0, normal.dot(light));
        const cv::Point corners[] = {at(a), at(b), at(c), at(d)};
        cv::fillConvexPoly(picture, corners, 4, cv::Scalar(shade, shade, shade), cv::LINE_8, fraction_bits);
    }
    return picture;
}
