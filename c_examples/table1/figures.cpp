#include "table1/figures.hpp"

#include "common/draw.hpp"
#include "common/plots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

// Fig. 4(b).
cv::Mat plot_branch(const Experiment &e, cv::Size size)
{
    cv::Mat plot(size, CV_8UC3, white);
    cv::Vec2d range(HUGE_VAL, -HUGE_VAL);
    for (const cv::Vec2d &point : e.branch)
        range = {std::min(range[0], point[1]), std::max(range[1], point[1])};
    const double step = round_step(std::max(range[1] - range[0], 1e-3), 6);
    range = {std::floor(range[0] / step) * step, std::ceil(range[1] / step) * step};
    const cv::Vec2d least = e.least_on_branch();
    const Axes axes{cv::Rect(64, 32, size.width - 100, size.height - 80), {0, 90}, range, "slant 1, degrees",
                    "log10 of the integral (15) along branch " +
                        std::to_string(e.solution.candidates[e.solution.chosen].branch) + ": least at " +
                        number(least[0], 1) + " degrees"};
    axes.draw(plot, 15, step);
    const cv::Scalar blue(178, 114, 0), red(40, 40, 210);
    for (std::size_t i = 1; i < e.branch.size(); i++)
        if (e.branch[i][0] - e.branch[i - 1][0] < 1)
            cv::line(plot, axes.at(e.branch[i - 1][0], e.branch[i - 1][1]), axes.at(e.branch[i][0], e.branch[i][1]), blue, 2,
                     cv::LINE_AA);
    const double slant = degrees(e.solution.slant_rad[0]);
    cv::line(plot, axes.at(slant, range[0]), axes.at(slant, range[1]), red, 1, cv::LINE_AA);
    put_text(plot, "S", axes.at(slant, range[1]) + cv::Point(6, 20), 0.7, red);
    cv::circle(plot, axes.at(least[0], least[1]), 5, blue, 2, cv::LINE_AA);
    return plot;
}

// An error map whose colors end where 99 in 100 pixels are below; the largest error is in the title.
cv::Mat error_picture(const cv::Mat &errors, const std::string &title)
{
    std::vector<float> values;
    for (auto value = errors.begin<float>(); value != errors.end<float>(); ++value)
        if (std::isfinite(*value))
            values.push_back(*value);
    if (values.empty())
        return color_picture(errors, {0, 1}, title);
    std::sort(values.begin(), values.end());
    const double most = std::max<double>(1, values[values.size() * 99 / 100]);
    return color_picture(errors, {0, most}, title + " (largest: " + number(values.back(), 0.1) + ")");
}

// Values over the inliers, NaN elsewhere.
template <typename Value> cv::Mat over_inliers(const cv::Mat &inliers, Value value)
{
    cv::Mat map(inliers.size(), CV_32F, cv::Scalar(none));
    for (int y = 0; y < map.rows; y++)
        for (int x = 0; x < map.cols; x++)
            if (inliers.at<uchar>(y, x))
                map.at<float>(y, x) = static_cast<float>(value(y, x));
    return map;
}

} // namespace

std::vector<Figure> figures(const Relief &relief, const Experiment &e)
{
    const cv::Size panel(520, 440);
    cv::Mat depth = relief.depth.clone();
    depth.setTo(none, relief.mask == 0);
    std::vector<Figure> list = {
        {"depth.png", "3(a) range map", color_picture(depth, range_of(depth), "depth toward the camera")},
        {"color.png", "3(b) the picture", e.scene.picture.display()},
    };
    if (!e.solved())
        return list;
    const cv::Mat &truth = e.scene.normals, &normals = e.answers.front().normals;
    const cv::Vec3d light(1, 1, 1);
    cv::Mat shaded_truth = shade(truth, light);
    shaded_truth.setTo(0, e.inliers == 0);
    const cv::Mat shaded = shade(normals, light);
    const cv::Mat angles = over_inliers(e.inliers, [&](int y, int x) {
        const cv::Vec3d n = normals.at<cv::Vec3f>(y, x), t = truth.at<cv::Vec3f>(y, x);
        return degrees(std::atan2(cv::norm(n.cross(t)), n.dot(t)));
    });
    const cv::Mat grays = over_inliers(e.inliers, [&](int y, int x) {
        return std::abs(shaded.at<uchar>(y, x) - shaded_truth.at<uchar>(y, x));
    });
    list.push_back({"inliers.png", "3(c) inliers", e.inliers});
    list.push_back({"curves.png", "4(a) eqs. 25: solutions lie on the diagonal", plot_curves(e.solution, panel)});
    if (!e.branch.empty())
        list.push_back({"integral.png", "4(b) the integral along the solution's branch", plot_branch(e, panel)});
    list.push_back({"shaded_truth.png", "5(a) the truth x inliers, lit from (1, 1, 1)", shaded_truth});
    list.push_back({"shaded_result.png", "5(b) the result, lit from (1, 1, 1)", shaded});
    list.push_back({"angular_error.png", "5(c) angular error", error_picture(angles, "angular error, degrees")});
    list.push_back({"gray_error.png", "5(d) error of gray levels", error_picture(grays, "error of gray levels, of 255")});
    return list;
}
