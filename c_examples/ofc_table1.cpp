// The paper's section 4 on any range map: Table 1, the median errors, and Figures 3 to 5.

#include "common/draw.hpp"
#include "table1/figures.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace {

struct Options {
    std::string depth, out = "out";
    double noise = 1, pixel_pitch = 1;
    std::uint64_t seed = 0;
};

Options parse(int argc, char **argv)
{
    Options options;
    CLI::App app("The paper's experiment of section 4: a range map is rendered under three colored lights, and what orientation\n"
                 "from color and other methods make of the picture is compared with the truth.\n"
                 "Without DEPTH it takes a bust of its own.",
                 "ofc_table1");
    app.set_version_flag("--version", ofc_version_string());
    app.add_option("DEPTH", options.depth, "Range map: gray PNG of 16 bits (0 is nothing) or TIFF of float32 (NaN is nothing)");
    app.add_option("--pixel-pitch", options.pixel_pitch, "Width of a pixel in the unit of DEPTH (default 1)")
        ->check(CLI::Range(1e-9, 1e9));
    app.add_option("--noise", options.noise, "Standard deviation of the noise in gray levels (default 1)")
        ->check(CLI::Range(0.0, 255.0));
    app.add_option("--seed", options.seed, "Seed of noise, subsets and annealing (default 0)");
    app.add_option("--out", options.out, "Folder for the results (default: out)")->type_name("DIR");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError &error) {
        std::exit(app.exit(error) == 0 ? 0 : 2);
    }
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
                             {"noise", options.noise},
                             {"seed", options.seed}};
    if (!e.solved())
        return report;
    report["r_squared"] = e.solution.fit.r_squared;
    report["inliers"] = e.solution.inlier_count;
    report["candidates"] = e.solution.candidate_count;
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

int run(const Options &options)
{
    const Relief relief = options.depth.empty() ? bust() : read_relief(options.depth, options.pixel_pitch);
    const Experiment e = run_experiment(relief, options.noise, options.seed);
    const std::filesystem::path out = options.out;
    make_folder(out);
    write_json(out / "table1.json", report(options, e));
    Sheet sheet;
    for (const Figure &figure : figures(relief, e)) {
        write_image(out / figure.file, figure.image);
        sheet.add(figure.title, figure.image);
    }
    std::vector<Line> lines;
    if (e.solved())
        lines.push_back({"median", "angular error over " + std::to_string(e.solution.inlier_count) + " inliers, degrees"});
    for (const Answer &answer : e.answers)
        lines.push_back({short_text_of(answer), answer.name + (answer.median_deg ? "" : ": " + answer.refusal)});
    if (!e.solved())
        lines.push_back({"refused", ofc_status_message(e.status)});
    write_image(out / "overview.png", sheet.draw(lines));

    if (e.solved()) {
        e.table.print();
        std::printf("\nmedian angular error over %d inliers (robust R^2 %.4f)\n", e.solution.inlier_count,
                    e.solution.fit.r_squared);
        for (const Answer &answer : e.answers)
            std::printf("  %-36s %s\n", answer.name.c_str(), text_of(answer).c_str());
    } else {
        std::fprintf(stderr, "ofc_table1: %s\n", ofc_status_message(e.status));
    }
    std::printf("wrote %s: look at overview.png\n", std::filesystem::absolute(out).lexically_normal().c_str());
    return e.solved() ? 0 : 1;
}

} // namespace

int main(int argc, char **argv)
{
    const Options options = parse(argc, argv);
    return guarded("ofc_table1", [&] { return run(options); });
}
