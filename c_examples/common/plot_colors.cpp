#include "common/plot_colors.hpp"

#include "common/draw.hpp"
#include "common/gnuplot.hpp"
#include "common/style.hpp"

#include <cmath>
#include <limits>

namespace {

using Rows = std::vector<std::vector<double>>;

// A view of color space from above: red to the right, green to the left and forward, blue up.
std::vector<double> seen(const cv::Vec3d &rho)
{
    const cv::Vec2d at = cv::Matx23d(0.80, -0.60, 0.0, -0.27, -0.36, 0.89) * rho;
    return {at[0], at[1]};
}

// Meridians and parallels of the ellipsoid.
Rows wireframe(const ofc_ellipsoid &ellipsoid)
{
    const cv::Matx33d to_color = cv::Matx33d(ellipsoid.root).inv();
    Rows rows;
    const auto append = [&](double latitude, double longitude) {
        rows.push_back(seen(to_color * cv::Vec3d(std::cos(latitude) * std::cos(longitude),
                                                 std::cos(latitude) * std::sin(longitude), std::sin(latitude))));
    };
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    constexpr int count = 12, fine = 72;
    for (int i = 0; i < count; i++) {
        for (int step = 0; step <= fine; step++)
            append(2 * CV_PI * step / fine, CV_PI * i / count);
        rows.push_back({none, none});
        for (int step = 0; step <= fine; step++)
            append(CV_PI * (i + 0.5) / count - CV_PI / 2, 2 * CV_PI * step / fine);
        rows.push_back({none, none});
    }
    return rows;
}

} // namespace

cv::Mat plot_colors(const Picture &picture, const ofc_solution &s, const cv::Mat &inliers, cv::Size size)
{
    // Colors in pixel values: r, g, b floats whatever the format.
    cv::Mat colors;
    cv::merge(std::vector<cv::Mat>{picture.channel(0), picture.channel(1), picture.channel(2)}, colors);
    colors.convertTo(colors, CV_32FC3);
    constexpr double most = 30000; // points
    const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(colors.total()) / most))));
    Rows rejected, accepted;
    for (int y = 0; y < colors.rows; y += step)
        for (int x = 0; x < colors.cols; x += step) {
            const cv::Vec3d rho = colors.at<cv::Vec3f>(y, x);
            const bool masked = !picture.mask.empty() && picture.mask.at<uchar>(y, x) == 0;
            if (!masked && rho != cv::Vec3d())
                (inliers.at<uchar>(y, x) ? accepted : rejected).push_back(seen(rho));
        }

    Gnuplot plot(size);
    plot("unset border; unset tics; set size ratio -1; set offsets graph 0.12, graph 0.12, graph 0.08, graph 0.04");
    plot("set key at screen 0.5,0.02 center bottom horizontal samplen 1.5; set bmargin at screen 0.1");
    const char *const axis_colors[3] = {"#d22828", "#288c28", "#2850c8"};
    std::string command = "plot ";
    if (s.ellipsoid.norms[0] > 0) {
        plot.data("ellipsoid", wireframe(s.ellipsoid));
        command += "$ellipsoid with lines linecolor rgb '#bebebe' title 'fitted ellipsoid', ";
    }
    const auto points = [&](const std::string &name, const Rows &rows, const char *color) {
        const std::string look = std::string(" with points pointtype 7 linecolor rgb '") + color + "' pointsize ";
        if (!rows.empty()) {
            plot.data(name, rows);
            command += "$" + name + look + "0.25 notitle, ";
        }
        command += "keyentry" + look + "1 title '" + name + "', ";
    };
    points("rejected", rejected, curve_colors[1]);
    points("inliers", accepted, curve_colors[0]);
    const double length = 1.05 * std::max<double>(s.pixel_counts.largest, 1e-30);
    const char *const align[3] = {"left", "right", "center"};
    for (int c = 0; c < 3; c++) {
        cv::Vec3d end;
        end[c] = length;
        const std::string name = {"rgb"[c]}, color = std::string(" rgb '") + axis_colors[c] + "'";
        const std::vector<double> tip = seen(end), beyond = seen(end * 1.05);
        plot.data("axis_" + name, {{0, 0, tip[0], tip[1]}});
        plot.data("label_" + name, {beyond});
        command += "$axis_" + name + " with vectors head filled linewidth 2 linecolor" + color + " notitle, $label_" + name +
                   " using 1:2:('" + name + " " + number(length, length / 100) + "') with labels " + align[c] +
                   " font ',12' textcolor" + color + " notitle" + (c < 2 ? ", " : "");
    }
    plot(command);
    return plot.draw();
}
