#include "common/plot_slants.hpp"

#include "common/gnuplot.hpp"
#include "common/plot_directions.hpp"
#include "common/style.hpp"

#include <cmath>
#include <limits>

namespace {

using Rows = std::vector<std::vector<double>>;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// One branch: slant 1 and f(slant 1) in degrees, NaN where there is no value in view; and where it crosses the diagonal.
struct Curve {
    Rows rows;
    std::vector<double> crossings;
    bool in_view = false;
};

Curve curve_of(const FixedPointProblem &problem, int branch)
{
    constexpr int samples = 1441;
    constexpr double jump = 20; // degrees between neighboring samples: not one curve
    std::vector<cv::Vec3d> slants(samples);
    std::vector<double> f(samples);
    Curve curve;
    if (ofc_slant_curve_sample(problem.tilts.data(), problem.cosines.data(), branch, samples, slants[0].val, f.data()) !=
        OFC_STATUS_OK)
        return curve;
    double last_x = none, last_y = none;
    for (int i = 0; i < samples; i++) {
        const double x = degrees(slants[i][0]), y = degrees(f[i]);
        const bool visible = y >= 0 && y <= 90; // false for NaN
        if (visible && std::abs(y - last_y) > jump)
            curve.rows.push_back({none, none});
        else if (visible && (y - x) * (last_y - last_x) <= 0)
            curve.crossings.push_back((x + last_x) / 2);
        curve.rows.push_back({x, visible ? y : none});
        curve.in_view = curve.in_view || visible;
        last_x = x;
        last_y = visible ? y : none;
    }
    return curve;
}

bool is_solution(const FixedPointProblem &problem, int branch, double slant_deg)
{
    for (const ofc_slants &solution : problem.solutions)
        if (solution.branch == branch && std::abs(degrees(solution.slant_rad[0]) - slant_deg) < 0.5)
            return true;
    return false;
}

} // namespace

FixedPointProblem FixedPointProblem::of(const ofc_solution &s)
{
    FixedPointProblem problem;
    problem.tilts = triple(s.tilts.tilt_rad);
    problem.cosines = triple(s.ellipsoid.cosines);
    problem.solutions.assign(s.candidates, s.candidates + s.candidate_count);
    if (s.slant_source != OFC_SLANTS_NONE)
        problem.marked = s.slant_rad[0];
    problem.mark = s.slant_source == OFC_SLANTS_ROOT ? "S" : "no root";
    return problem;
}

FixedPointProblem FixedPointProblem::of(const Triple &slants, const Triple &tilts)
{
    FixedPointProblem problem;
    problem.tilts = tilts;
    problem.cosines = cosines_between(slants, tilts);
    problem.solutions.resize(OFC_MAX_CANDIDATES);
    int32_t count = 0;
    ofc_constrained_slants_find(tilts.data(), problem.cosines.data(), problem.solutions.data(), &count);
    problem.solutions.resize(static_cast<std::size_t>(count));
    problem.marked = slants[0];
    problem.mark = "S";
    return problem;
}

cv::Mat plot_slants(const FixedPointProblem &problem, cv::Size size)
{
    Gnuplot plot(size);
    plot("set xrange [0:90]; set yrange [0:90]; set xtics 15; set ytics 15; set size ratio -1");
    plot("set lmargin at screen 0.115; set rmargin at screen 0.76; set bmargin at screen 0.12; set tmargin at screen 0.97");
    plot(std::string("set grid linetype 1 linecolor rgb '") + faint_color + "'; set tics nomirror; set border 3");
    plot("set xlabel 'slant σ_1, degrees'; set ylabel 'f(σ_1), degrees'");
    plot("set key at screen 1,0.95 right top Left reverse samplen 1.5 spacing 1.3");
    std::string command = std::string("plot x with lines linewidth 1.5 linecolor rgb '") + soft_color + "' title 'f(σ_1) = σ_1'";
    Rows ruled_out, others;
    for (int branch = 1; branch <= 8; branch++) {
        const Curve curve = curve_of(problem, branch);
        if (!curve.in_view)
            continue;
        const std::string name = "branch" + std::to_string(branch);
        const auto sign = [&](int bit) { return (branch - 1) & bit ? "−" : "+"; };
        plot.data(name, curve.rows);
        command += ", $" + name + " with lines linewidth 2.5 linecolor rgb '" + curve_colors[branch - 1] + "' title '" +
                   std::to_string(branch) + " (" + sign(4) + sign(2) + sign(1) + ")'";
        for (const double slant : curve.crossings)
            if (!is_solution(problem, branch, slant))
                ruled_out.push_back({slant, slant});
    }
    for (const ofc_slants &solution : problem.solutions)
        others.push_back({degrees(solution.slant_rad[0]), degrees(solution.slant_rad[0])});
    if (!others.empty()) {
        plot.data("solutions", others);
        command += std::string(", $solutions with points pointtype 6 pointsize 2 linewidth 2 linecolor rgb '") + ink_color +
                   "' title 'solution'";
    }
    if (!ruled_out.empty()) {
        plot.data("out", ruled_out);
        command += std::string(", $out with points pointtype 2 pointsize 1.5 linewidth 2 linecolor rgb '") + ink_color +
                   "' title 'ruled out'";
    }
    if (problem.marked) {
        const double slant = degrees(*problem.marked);
        plot.data("marked", {{slant, slant}});
        command += std::string(", $marked with points pointtype 6 pointsize 2 linewidth 3 linecolor rgb '") + mark_color +
                   "' title '" + (problem.mark == "S" ? "S, chosen" : problem.mark) + "'";
        // On the side of the diagonal where there is room.
        const bool right = slant < 78;
        plot("set label '" + problem.mark + "' at " + std::to_string(slant + (right ? 3 : -3)) + "," +
             std::to_string(slant + (right ? -3 : 3)) + (right ? " left" : " right") + " front font ',14' textcolor rgb '" +
             mark_color + "'");
    }
    plot(command);
    return plot.draw();
}
