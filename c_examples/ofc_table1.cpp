// The paper's section 4 on any range map: Table 1, the median errors, and the figures.

#include "common/draw.hpp"
#include "common/reason.hpp"
#include "table1/figures.hpp"
#include "table1/slopes.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace {

struct Options {
    std::string depth, out;
    double pixel_pitch = 1;
    ExperimentParams experiment;
};

Options parse(int argc, char **argv)
{
    Options options;
    CommandLine line("ofc_table1",
                     "The experiment of the paper's section 4: a range map is rendered under three colored lights, and the normals\n"
                     "that the direct method and other methods find in the picture are compared with the truth.\n"
                     "Without DEPTH it takes a bust of its own.");
    line.add_option("DEPTH", options.depth,
                    "Range map, larger is nearer: gray PNG of 16 bits, 0 where there is nothing, or TIFF of float32, NaN where\n"
                    "there is nothing");
    line.add_pixel_pitch(options.pixel_pitch, "Width of a pixel in the unit of DEPTH (default: 1)", "P");
    line.add_option("--noise", options.experiment.noise, "Standard deviation of the noise in gray levels (default: 1)")
        ->check(finite_between(0, 255))
        ->type_name("LEVELS");
    line.add_seed(options.experiment.seed, "noise, subsets and annealing");
    options.experiment.shadows.add_to(line);
    line.parse_or_exit(argc, argv);
    options.out = line.out;
    return options;
}

std::string text_of(const Answer &answer)
{
    char text[64];
    std::snprintf(text, sizeof text, "%6.2f degrees", answer.median_deg.value_or(0));
    return answer.median_deg ? text : answer.refusal;
}

std::string short_text_of(const Answer &answer)
{
    return answer.median_deg ? number(*answer.median_deg, 0.01) : "-";
}

nlohmann::json report(const Options &options, const Experiment &e)
{
    nlohmann::json report = {{"status", ofc_status_message(e.status)},
                             {"status_code", e.status},
                             {"version", ofc_version_string()},
                             {"noise", options.experiment.noise},
                             {"seed", options.experiment.seed},
                             {"shadows", {{"asked", options.experiment.shadows.choice}, {"direct", e.shadows}}},
                             {"example", example_report()}};
    if (!e.solved())
        return report;
    report["shadows"]["joint"] = e.joint_shadows;
    report["r_squared"] = e.solution.fit.r_squared;
    report["usable"] = e.solution.pixel_counts.usable;
    report["inliers"] = e.solution.inlier_count;
    report["candidates"] = e.solution.candidate_count;
    report["correlation"] = e.correlation;
    report["table"] = e.table.json();
    if (!e.branch.empty())
        report["branch"] = {{"solution_slant_deg", degrees(e.solution.slant_rad[0])},
                            {"least_integral_slant_deg", e.least_on_branch()[0]}};
    for (const Answer &answer : e.answers)
        if (answer.median_deg)
            report["median_error_deg"][answer.name] = *answer.median_deg;
        else
            report["median_error_deg"][answer.name] = nullptr;
    return report;
}

std::vector<Line> summary(const Experiment &e)
{
    std::vector<Line> lines = {{"shadows", "direct method: " + e.shadows}};
    if (!e.solved()) {
        lines.push_back({"refused", ofc_status_message(e.status)});
        lines.push_back({"reason", reason_in_words(e.solution)});
        lines.push_back({"try", ofc_reason_advice(e.solution.reason)});
        lines.push_back({"pixels", counts_in_words(e.solution)});
        return lines;
    }
    lines.push_back({"pixels", counts_in_words(e.solution)});
    lines.push_back({"", "joint method: " + e.joint_shadows});
    lines.push_back({"median", "angular error in degrees, over the " + std::to_string(e.solution.inlier_count) +
                                   " inliers of the direct method"});
    for (const Answer &answer : e.answers)
        lines.push_back({short_text_of(answer), answer.name + (answer.median_deg ? "" : ": " + answer.refusal)});
    return lines;
}

int run(const Options &options)
{
    const std::filesystem::path out = options.out;
    ResultFolder results(out, "table1.json",
                         {"overview.png", "directions.png", "fixed_points.png", "depth.png", "color.png", "inliers.png",
                               "curves.png", "integral.png", "shaded_truth.png", "shaded_result.png", "angular_error.png",
                               "gray_error.png", "channels.png"},
                         {options.depth});
    const Relief relief = options.depth.empty() ? bust() : read_relief(options.depth, options.pixel_pitch);
    require_usable_slopes(relief, options.depth);
    const Experiment e = run_experiment(relief, options.experiment);
    if (e.solved()) {
        e.table.print();
        std::printf("\nrobust R² %.4f; shadows by the direct method: %s\n", e.solution.fit.r_squared, e.shadows.c_str());
        std::printf("shadows by the joint method: %s\n", e.joint_shadows.c_str());
        std::printf("median angular error over the %d inliers of the direct method\n", e.solution.inlier_count);
        for (const Answer &answer : e.answers)
            std::printf("  %-36s %s\n", answer.name.c_str(), text_of(answer).c_str());
    } else {
        std::fprintf(stderr, "ofc_table1: %s\n", ofc_status_message(e.status));
        std::fprintf(stderr, "reason: %s\ntry: %s\n", reason_in_words(e.solution).c_str(), ofc_reason_advice(e.solution.reason));
    }
    std::printf("pixels %s\n", counts_in_words(e.solution).c_str());
    Sheet sheet(4);
    for (const Figure &figure : figures(relief, e)) {
        write_png(out / figure.file, figure.image);
        sheet.add(figure.title, figure.image, figure.span);
    }
    write_png(out / "overview.png", sheet.draw(summary(e)));
    results.keep(report(options, e));
    say_where(out, "overview.png");
    return e.solved() ? 0 : 1;
}

} // namespace

int main(int argc, char **argv)
{
    return guarded("ofc_table1", [&] { return run(parse(argc, argv)); });
}
