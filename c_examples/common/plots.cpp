#include "common/plots.hpp"

#include "common/draw.hpp"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace {

const cv::Scalar red(40, 40, 210), gray(150, 150, 150);

// One color a branch, told apart also by people who see red and green alike (Okabe and Ito), as BGR.
const std::array<cv::Scalar, 8> branch_colors = {
    cv::Scalar(178, 114, 0),  cv::Scalar(0, 94, 213),    cv::Scalar(115, 158, 0),  cv::Scalar(167, 121, 204),
    cv::Scalar(0, 159, 230),  cv::Scalar(233, 180, 86),  cv::Scalar(50, 190, 200), cv::Scalar(90, 90, 90)};

void draw_curve(cv::Mat &plot, const Axes &axes, const ofc_solution &solution, int branch)
{
    constexpr int samples = 1441;
    std::vector<cv::Vec3d> slants(samples);
    std::vector<double> f(samples);
    if (ofc_slant_curve_sample(solution.tilts.tilt_rad, solution.ellipsoid.cosines, branch, samples, slants[0].val,
                               f.data()) != OFC_STATUS_OK)
        return;
    for (int i = 1; i < samples; i++) {
        const double from = degrees(f[i - 1]), to = degrees(f[i]);
        const bool in_view = from >= 0 && from <= 90 && to >= 0 && to <= 90; // false for NaN: no value there
        if (in_view && std::abs(to - from) < 20)
            cv::line(plot, axes.at(degrees(slants[i - 1][0]), from), axes.at(degrees(slants[i][0]), to),
                     branch_colors[branch - 1], 2, cv::LINE_AA);
    }
}

void mark(cv::Mat &plot, const Axes &axes, double slant_deg, const std::string &label, bool chosen)
{
    const cv::Point at = axes.at(slant_deg, slant_deg);
    cv::circle(plot, at, 7, white, cv::FILLED, cv::LINE_AA);
    cv::circle(plot, at, 7, chosen ? red : ink, 2, cv::LINE_AA);
    // Below and to the right, but above and to the left where that would be on the axis or in the legend.
    const double scale = chosen ? 0.7 : 0.45;
    const int width = cv::getTextSize(label, font, scale, 1, nullptr).width;
    const bool low = at.y > axes.at(0, 12).y, right = at.x > axes.at(90, 0).x - 20 - width;
    put_text(plot, label, at + cv::Point(right ? -10 - width : 10, low ? -10 : 18), scale, chosen ? red : ink);
}

// A view of color space, turned so that all three axes show; r, g, b in, pixels out.
struct ColorView {
    // Red to the right, green to the left and forward, blue up, from above.
    const cv::Matx23d turn{0.80, -0.60, 0.0, -0.27, -0.36, 0.89};
    cv::Vec2d shift;
    double scale = 1;

    // Fits the points into the area.
    ColorView(const std::vector<cv::Vec3d> &points, cv::Rect area)
    {
        cv::Vec2d low(HUGE_VAL, HUGE_VAL), high = -low;
        for (const cv::Vec3d &point : points)
            for (int i = 0; i < 2; i++) {
                const double value = (turn * point)[i];
                low[i] = std::min(low[i], value);
                high[i] = std::max(high[i], value);
            }
        scale = std::min(area.width / (high[0] - low[0]), area.height / (high[1] - low[1]));
        const cv::Vec2d middle = (low + high) / 2;
        shift = {area.x + area.width / 2.0 - scale * middle[0], area.y + area.height / 2.0 + scale * middle[1]};
    }

    cv::Point at(const cv::Vec3d &rho) const
    {
        const cv::Vec2d p = turn * rho;
        return {cvRound(shift[0] + scale * p[0]), cvRound(shift[1] - scale * p[1])};
    }
};

// Meridians and parallels of the ellipsoid, as closed lines.
std::vector<std::vector<cv::Vec3d>> wireframe(const ofc_ellipsoid &ellipsoid)
{
    const cv::Matx33d to_color = cv::Matx33d(ellipsoid.root).inv();
    const auto point = [&](double latitude, double longitude) {
        return to_color * cv::Vec3d(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                                    std::sin(latitude));
    };
    constexpr int count = 12, steps = 72;
    std::vector<std::vector<cv::Vec3d>> lines(2 * count);
    for (int i = 0; i < count; i++)
        for (int step = 0; step <= steps; step++) {
            const double angle = 2 * CV_PI * step / steps;
            lines[2 * i].push_back(point(angle, CV_PI * i / count));
            lines[2 * i + 1].push_back(point(CV_PI * (i + 0.5) / count - CV_PI / 2, angle));
        }
    return lines;
}

} // namespace

cv::Mat plot_curves(const ofc_solution &s, cv::Size size)
{
    cv::Mat plot(size, CV_8UC3, white);
    const int side = std::min(size.width - 130, size.height - 76);
    const Axes axes{cv::Rect(44, 32, side, side), {0, 90}, {0, 90}, "slant 1, degrees", "f(slant 1), degrees"};
    axes.draw(plot, 15, 15);
    cv::line(plot, axes.at(0, 0), axes.at(90, 90), gray, 1, cv::LINE_AA);
    for (int branch = 1; branch <= 8; branch++) {
        draw_curve(plot, axes, s, branch);
        const cv::Point at(axes.area.br().x + 14, axes.area.y + 20 + 24 * (branch - 1));
        cv::line(plot, at + cv::Point(0, -5), at + cv::Point(18, -5), branch_colors[branch - 1], 2, cv::LINE_AA);
        const auto sign = [&](int bit) { return (branch - 1) & bit ? "-" : "+"; };
        put_text(plot, std::to_string(branch) + " " + sign(4) + sign(2) + sign(1), at + cv::Point(24, 0), 0.42, ink);
    }
    for (int i = 0; i < s.candidate_count; i++) {
        const double sigma = degrees(s.candidates[i].slant_rad[0]);
        if (i != s.chosen)
            mark(plot, axes, sigma, std::to_string(s.candidates[i].branch), false);
    }
    const double sigma = degrees(s.slant_rad[0]);
    if (s.slant_source == OFC_SLANTS_ROOT || s.slant_source == OFC_SLANTS_JOINT)
        mark(plot, axes, sigma, "S", true);
    else if (s.slant_source != OFC_SLANTS_NONE)
        mark(plot, axes, sigma, "no root", true);
    return plot;
}

cv::Mat plot_colors(const Picture &picture, const ofc_solution &s, const cv::Mat &inliers, cv::Size size)
{
    cv::Mat plot(size, CV_8UC3, white);
    std::vector<std::vector<cv::Vec3d>> lines;
    if (s.ellipsoid.norms[0] > 0)
        lines = wireframe(s.ellipsoid);
    const double length = 1.05 * std::max<double>(s.pixel_counts.largest, 1e-30);
    const cv::Vec3d axes[3] = {{length, 0, 0}, {0, length, 0}, {0, 0, length}};
    std::vector<cv::Vec3d> corners(axes, axes + 3);
    for (const auto &line : lines)
        corners.insert(corners.end(), line.begin(), line.end());
    const ColorView view(corners, cv::Rect(24, 20, size.width - 48, size.height - 70));
    for (const auto &line : lines)
        for (std::size_t i = 1; i < line.size(); i++)
            cv::line(plot, view.at(line[i - 1]), view.at(line[i]), cv::Scalar(190, 190, 190), 1, cv::LINE_AA);
    const cv::Scalar axis_colors[3] = {{40, 40, 210}, {40, 140, 40}, {200, 80, 40}};
    for (int c = 0; c < 3; c++) {
        const cv::Point end = view.at(axes[c]);
        cv::arrowedLine(plot, view.at({0, 0, 0}), end, axis_colors[c], 2, cv::LINE_AA, 0, 0.05);
        put_text(plot, std::string(1, "rgb"[c]), end + (c == 1 ? cv::Point(-16, -8) : cv::Point(8, -4)), 0.6, axis_colors[c]);
    }

    // Colors in pixel values: a Mat of r, g, b floats whatever the format.
    cv::Mat colors;
    cv::merge(std::vector<cv::Mat>{picture.channel(0), picture.channel(1), picture.channel(2)}, colors);
    colors.convertTo(colors, CV_32FC3);
    const double pixels = static_cast<double>(colors.total());
    const int step = std::max(1, cvRound(std::sqrt(pixels / 60000)));
    for (const bool inlier : {false, true}) // inliers on top
        for (int y = 0; y < colors.rows; y += step)
            for (int x = 0; x < colors.cols; x += step) {
                const cv::Vec3d rho = colors.at<cv::Vec3f>(y, x);
                const bool masked = !picture.mask.empty() && picture.mask.at<uchar>(y, x) == 0;
                if (masked || rho == cv::Vec3d() || (inliers.at<uchar>(y, x) != 0) != inlier)
                    continue;
                cv::circle(plot, view.at(rho), 1, inlier ? cv::Scalar(178, 114, 0) : cv::Scalar(0, 94, 213), cv::FILLED,
                           cv::LINE_AA);
            }
    const int y = size.height - 14;
    cv::circle(plot, {16, y - 4}, 4, cv::Scalar(178, 114, 0), cv::FILLED, cv::LINE_AA);
    put_text(plot, "inliers", {26, y}, 0.45, ink);
    cv::circle(plot, {106, y - 4}, 4, cv::Scalar(0, 94, 213), cv::FILLED, cv::LINE_AA);
    put_text(plot, "rejected", {116, y}, 0.45, ink);
    cv::line(plot, {202, y - 4}, {222, y - 4}, gray, 1, cv::LINE_AA);
    put_text(plot, "fitted ellipsoid", {230, y}, 0.45, ink);
    return plot;
}
