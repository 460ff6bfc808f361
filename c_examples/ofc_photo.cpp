// Surface normals from a photograph, with everything a person wants to see of how they came about.
//
// Shows how cv::Mat goes in and out of ofc, the whole solve and each of its stages, and what to do with a status.

#include "common/progress.hpp"
#include "common/scene.hpp"
#include "photo/batch.hpp"
#include "photo/doubt.hpp"
#include "photo/options.hpp"
#include "photo/overview.hpp"
#include "photo/paper_report.hpp"
#include "photo/relief.hpp"
#include "photo/report.hpp"
#include "photo/solve.hpp"
#include "photo/whole.hpp"

#include <cstdio>
#include <fstream>
#include <iostream>
#include <unistd.h>

namespace {

// Every stage by itself is run again to be timed, where that takes no time to speak of.
constexpr int most_pixels_to_time = 4000000;

void write_results(const ResultFolder &out, const Options &options, const Picture &picture, const Result &result)
{
    if (options.save_planes) {
        const cv::Mat channels[] = {picture.channel(0), picture.channel(1), picture.channel(2)};
        for (int c = 0; c < 3; c++)
            write_png(out / saved_planes[c], channels[c]);
    }
    if (options.wants("inliers"))
        write_png(out / "inliers.png", result.inliers);
    if (options.wants("albedo") && result.paint && result.paint->taken)
        write_png(out / "albedo.png", result.paint->picture());
    if (result.solved() && options.wants("normals")) {
        write_png(out / "normals.png", normal_map(result.normals));
        write_tiff(out / "normals.tiff", result.normals);
    }
    if (result.surface.integrated() && options.wants("depth")) {
        write_tiff(out / "depth.tiff", result.surface.depth);
        write_png(out / "depth.png", options.depth.picture(result.surface));
    }
    if (result.whole && options.wants("classes"))
        write_png(out / "classes.png", class_picture(*result.whole, cv::Rect({}, picture.size())));
    if (result.surface.integrated() && options.wants("mesh"))
        write_mesh(out / "mesh.ply", result.surface, picture.display(), options.mesh_faces);
    if (!result.uncertainty.empty() && options.wants("uncertainty")) {
        write_tiff(out / "uncertainty.tiff", result.uncertainty);
        write_png(out / "uncertainty.png", uncertainty_picture(result, cv::Rect({}, picture.size())));
    }
    if (options.wants("overview"))
        write_png(out / "overview.png", overview(picture, result));
}

int run(const Options &options)
{
    ResultFolder out(options.out, "report.json", options.results(), options.inputs());
    Progress progress;
    progress.stage("reading");
    Picture picture;
    cv::Mat truth;
    std::optional<cv::Matx33d> true_f;
    if (!options.planes.empty()) {
        picture = read_planes(options.planes[0], options.planes[1], options.planes[2]);
    } else if (!options.image.empty()) {
        picture = read_picture(options.image);
    } else {
        const Scene scene = render(bust(), 1);
        picture = scene.picture;
        truth = scene.normals;
        true_f = scene.f;
    }
    Steps steps;
    const int orientation = picture.facts.orientation;
    if (!options.mask.empty())
        picture.mask = read_mask(options.mask, picture.size(), orientation);
    picture = as_light(picture, options.light, steps);
    if (options.light.fits_ambient()) {
        progress.stage("fitting the ambient light");
        const Ambient ambient = fit_ambient(picture, options.solve_params(OFC_ORIENTATION_JOINT), 4);
        if (ambient.is_found)
            picture = less(picture, ambient.offset);
        steps.lines.emplace_back("ambient", ambient.in_words());
        steps.report["ambient"] = ambient.report();
    }
    progress.clear();
    for (const auto &[label, words] : steps.lines)
        std::printf("%-10s %s\n", label.c_str(), words.c_str());
    std::fflush(stdout);
    const Picture undivided = picture;
    std::optional<Picture> background;
    if (!options.background.empty()) {
        background = background_as_light(read_picture(options.background), options.light, picture.facts);
        const Picture flat = flattened(without_saturated(picture), *background, options.background);
        picture.pixels = flat.pixels;
        picture.green.release();
        picture.blue.release();
        picture.saturation = 0;
    }
    if (!options.truth.empty())
        truth = read_normals_tiff(options.truth, picture.size());

    // The other model, whose picture is not divided by the background, and what the first one said, if it was asked.
    const auto relief = [&](const Result *ellipsoid) {
        Picture frame = undivided;
        frame.mask = picture.mask;
        const Picture *const plane = background ? &*background : nullptr;
        ReliefResult found = solve_relief(frame, plane, options.relief_params());
        if (!found.solved() && !picture.mask.empty()) {
            // A mask around the relief hides the plane that it rises from.
            frame.mask.release();
            found = solve_relief(frame, plane, options.relief_params());
        }
        if (ellipsoid == nullptr || found.is_better_than(*ellipsoid)) {
            if (found.solved()) {
                complete(found, frame, plane, options.depth, truth);
                if (frame.mask.empty() && !picture.mask.empty())
                    found.restrict_to(picture.mask);
            }
            found.input = steps.report;
            progress.stage("writing");
            write_relief(out, options, frame, found);
            out.keep(report_of(found, ellipsoid));
            progress.clear();
            if (ellipsoid != nullptr)
                std::printf("%-10s %s\n", "ellipsoid",
                            ellipsoid->solved() ? "fits fewer pixels, and expects larger errors" : ofc_status_message(ellipsoid->status));
            for (const Line &line : summary(found))
                std::fprintf(found.solved() ? stdout : stderr, "%-10s %s\n", line.label.c_str(), line.text.c_str());
            say_where(out.path(), found.solved() ? "overview.png" : "report.json");
        }
        return found;
    };
    if (options.model == "relief")
        return relief(nullptr).solved() ? 0 : 1;

    const auto solve_by = [&](const Picture &solved, ofc_orientation_method method) {
        progress.stage("solving");
        Result result = solve(solved, options.solve_params(method), options.shadows, options.depth, options.wants_each_uncertainty());
        result.input = steps.report;
        result.true_f = true_f;
        if (result.solved() && !truth.empty())
            result.median_error_deg = median_angle_deg(result.normals, truth);
        return result;
    };
    const ofc_orientation_method method = options.direct() ? OFC_ORIENTATION_DIRECT : OFC_ORIENTATION_JOINT;
    Result result = solve_by(picture, method);
    const bool asks_for_paint = options.paint.choice == "uneven";
    if (options.model == "auto" && !options.direct() && !options.paper_report() && !asks_for_paint && result.status >= 0) {
        const ReliefResult found = relief(&result);
        if (found.is_better_than(result))
            return 0;
    }
    // The picture that was solved: as it is, or without its paint.
    Picture solved = picture;
    if (options.paint.choice != "even") {
        Paint paint = paint_of(picture, options.seed);
        const bool is_wanted = asks_for_paint || is_better_even(paint, result.status, result.solution);
        if (is_wanted)
            divide_out(paint, picture);
        if (!paint.albedo.empty()) {
            Result even = solve_by(paint.even, method);
            paint.taken = even.solved() || asks_for_paint;
            if (paint.taken) {
                result = even;
                solved = paint.even;
            }
        }
        result.paint = paint;
    }
    if (result.solved() && picture.size().area() <= most_pixels_to_time)
        time_stages(solved, result);
    if (result.solved() && options.whole()) {
        progress.stage("completing the surface");
        complete(result, solved, !options.planes.empty());
        if (!truth.empty())
            result.median_error_deg = median_angle_deg(result.normals, truth);
    }
    if (result.solved() && !background && !picture.words.empty())
        add_doubts(result, picture, options.light, options.solve_params(method));

    progress.stage("writing");
    write_results(out, options, picture, result);
    std::optional<Result> direct;
    if (options.paper_report() && result.solved()) {
        direct = options.direct() ? result : solve_by(solved, OFC_ORIENTATION_DIRECT);
        if (!direct->solved())
            throw std::runtime_error(std::string("the direct method has no answer: ") + ofc_status_message(direct->status));
        write_paper_figures(out.path(), solved, *direct);
    }
    out.keep(report_of(result));
    progress.clear();

    if (direct)
        print_paper_report(solved, *direct);
    else
        for (const Line &line : summary(result))
            std::fprintf(result.solved() ? stdout : stderr, "%-10s %s\n", line.label.c_str(), line.text.c_str());
    say_where(out.path(), options.wants("overview") ? "overview.png" : "report.json");
    return result.solved() ? 0 : 1;
}

// Runs what prints so that no one sees it, and then prints the report where that is asked for.
int in_silence(const Options &options, const std::function<int()> &body)
{
    std::fflush(stdout);
    const int before = dup(STDOUT_FILENO);
    if (before < 0 || std::freopen("/dev/null", "w", stdout) == nullptr)
        throw std::runtime_error("standard output cannot be put aside");
    const int status = body();
    std::fflush(stdout);
    dup2(before, STDOUT_FILENO);
    close(before);
    if (!options.json.empty())
        std::cout << std::ifstream(options.out + "/report.json").rdbuf();
    return status;
}

} // namespace

int main(int argc, char **argv)
{
    return guarded("ofc_photo", [&] {
        const Options options = parse_options(argc, argv);
        const auto solve_all = [&] { return options.images.size() > 1 ? run_each(options, run) : run(options); };
        return options.quiet || !options.json.empty() ? in_silence(options, solve_all) : solve_all();
    });
}
