#include "common/surface_view.hpp"

#include "common/draw.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

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
