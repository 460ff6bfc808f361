#include "table1/figures.hpp"

#include "common/channels.hpp"
#include "common/draw.hpp"
#include "common/gnuplot.hpp"
#include "common/plot_directions.hpp"
#include "common/plot_slants.hpp"
#include "common/style.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

// Figures 1 and 2 show unit vectors at these slants and tilts.
const Triple example_slants = {40 * CV_PI / 180, 30 * CV_PI / 180, 5 * CV_PI / 180};
const Triple example_tilts = {20 * CV_PI / 180, -120 * CV_PI / 180, 0};

// Figure 4(b).
cv::Mat plot_branch(const Experiment &e)
{
    std::vector<std::vector<double>> rows;
    for (const cv::Vec2d &point : e.branch) {
        if (!rows.empty() && point[0] - rows.back()[0] > 1)
            rows.push_back({none, none});
        rows.push_back({point[0], point[1]});
    }
    const cv::Vec2d least = e.least_on_branch();
    const int branch = e.solution.candidates[e.solution.chosen].branch;
    Gnuplot plot(Sheet::panel());
    plot(std::string("set grid linetype 1 linecolor rgb '") + faint_color + "'; set tics nomirror; set border 3");
    plot("set xrange [0:90]; set xtics 15; set xlabel 'slant σ_1, degrees'");
    plot("set ylabel 'log_{10} of the mean of the integral (15), per pixel^2'");
    plot("set key at graph 0.98,0.97 right top Left reverse samplen 1.5 spacing 1.3 box linecolor rgb '#ffffff' opaque");
    plot.data("branch", rows);
    plot.data("least", {{least[0], least[1]}});
    plot("set arrow from first " + std::to_string(degrees(e.solution.slant_rad[0])) + ", graph 0 to first " +
         std::to_string(degrees(e.solution.slant_rad[0])) + ", graph 1 nohead linewidth 2 linecolor rgb '" + mark_color + "'");
    plot(std::string("plot $branch with lines linewidth 2.5 linecolor rgb '") + curve_colors[0] + "' title 'branch " +
         std::to_string(branch) + "', $least with points pointtype 6 pointsize 2 linewidth 2.5 linecolor rgb '" +
         curve_colors[0] + "' title 'least, at " + number(least[0], 1) + "°', keyentry with lines linewidth 2 linecolor rgb '" +
         mark_color + "' title 'S, at " + number(degrees(e.solution.slant_rad[0]), 1) + "°'");
    return plot.draw();
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

nlohmann::json example_report()
{
    const FixedPointProblem problem = FixedPointProblem::of(example_slants, example_tilts);
    nlohmann::json report;
    for (const double cosine : problem.cosines)
        report["angles_deg"].push_back(degrees(std::acos(cosine)));
    for (const ofc_slants &solution : problem.solutions)
        report["slants_deg"].push_back(
            {degrees(solution.slant_rad[0]), degrees(solution.slant_rad[1]), degrees(solution.slant_rad[2])});
    return report;
}

std::vector<Figure> figures(const Relief &relief, const Experiment &e)
{
    cv::Mat depth = relief.depth.clone();
    depth.setTo(none, relief.mask == 0);
    std::vector<Figure> list = {
        {"directions.png", "1 tilts and angles of three unit vectors",
         plot_directions(example_slants, example_tilts, cosines_between(example_slants, example_tilts), Sheet::panel(3)), 3},
        {"fixed_points.png", "2 eqs. 25 for these vectors: two solutions",
         plot_slants(FixedPointProblem::of(example_slants, example_tilts), Sheet::panel())},
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
    list.push_back({"curves.png", "4(a) eqs. 25 of the picture", plot_slants(FixedPointProblem::of(e.solution), Sheet::panel())});
    if (!e.branch.empty())
        list.push_back({"integral.png", "4(b) the integral along the solution's branch", plot_branch(e)});
    list.push_back({"shaded_truth.png", "5(a) the truth × inliers, lit from (1, 1, 1)", shaded_truth});
    list.push_back({"shaded_result.png", "5(b) the result, lit from (1, 1, 1)", shaded});
    list.push_back({"angular_error.png", "5(c) angular error", error_picture(angles, "angular error, degrees")});
    list.push_back({"gray_error.png", "5(d) error of gray levels", error_picture(grays, "error of gray levels, of 255")});
    list.push_back({"channels.png", "7 the channels, and the normals lit from the rows of F",
                    channels_picture(e.scene.picture, e.inliers, normals, e.solution.orientation.f, e.correlation), 2});
    return list;
}
