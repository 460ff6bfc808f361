// Surface normals from a photograph, with everything a person wants to see of how they came about.
//
// Shows how cv::Mat goes in and out of ofc, the whole solve and each of its stages, and what to do with a status.

#include "common/scene.hpp"
#include "photo/options.hpp"
#include "photo/overview.hpp"
#include "photo/paper_report.hpp"
#include "photo/relief.hpp"
#include "photo/report.hpp"
#include "photo/solve.hpp"
#include "photo/whole.hpp"

#include <cstdio>

namespace {

// What a run may write into its folder, but for the planes of --save-planes, which may be the next run's input.
constexpr const char *const outputs[] = {"report.json",      "inliers.png",     "overview.png", "normals.png",
                                         "normals.tiff",     "uncertainty.png", "depth.tiff",   "depth.png",
                                         "uncertainty.tiff", "mesh.ply",        "classes.png", "albedo.png"};

int run(const Options &options)
{
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
    const Picture undivided = picture;
    std::optional<Picture> background;
    if (!options.background.empty()) {
        background = read_picture(options.background);
        picture = flattened(picture, *background, options.background);
    }
    if (!options.mask.empty())
        picture.mask = read_mask(options.mask, picture.size());
    if (!options.truth.empty())
        truth = read_normals_tiff(options.truth, picture.size());
    const std::filesystem::path out = options.out;
    make_folder(out);
    // What an earlier run left there is not this picture's.
    for (const char *name : outputs)
        std::filesystem::remove(out / name);
    for (const char *name : paper_figures)
        std::filesystem::remove(out / name);

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
            write_relief(out.string(), frame, found, ellipsoid);
            if (ellipsoid != nullptr)
                std::printf("%-10s %s\n", "ellipsoid",
                            ellipsoid->solved() ? "fits fewer pixels, and expects larger errors" : ofc_status_message(ellipsoid->status));
            for (const Line &line : summary(found))
                std::fprintf(found.solved() ? stdout : stderr, "%-10s %s\n", line.label.c_str(), line.text.c_str());
            say_where(out, found.solved() ? "overview.png" : "report.json");
        }
        return found;
    };
    if (options.model == "relief")
        return relief(nullptr).solved() ? 0 : 1;

    const auto solve_by = [&](const Picture &solved, ofc_orientation_method method) {
        Result result = solve(solved, options.solve_params(method), options.shadows, options.depth);
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
        if (is_wanted && !paint.albedo.empty()) {
            Result even = solve_by(paint.even, method);
            paint.taken = even.solved() || asks_for_paint;
            if (paint.taken) {
                result = even;
                solved = paint.even;
            }
        }
        result.paint = paint;
    }
    if (result.solved())
        time_stages(solved, result);
    if (result.solved() && options.whole()) {
        complete(result, solved, !options.planes.empty());
        if (!truth.empty())
            result.median_error_deg = median_angle_deg(result.normals, truth);
    }

    if (options.save_planes) {
        const cv::Mat channels[] = {picture.channel(0), picture.channel(1), picture.channel(2)};
        const char *names[] = {"plane_r.png", "plane_g.png", "plane_b.png"};
        for (int c = 0; c < 3; c++)
            write_image(out / names[c], channels[c]);
    }
    write_report(out / "report.json", result);
    write_image(out / "inliers.png", result.inliers);
    if (result.paint && result.paint->taken)
        write_image(out / "albedo.png", result.paint->picture());
    if (result.solved()) {
        write_image(out / "normals.png", normal_map(result.normals));
        write_normals_tiff(out / "normals.tiff", result.normals);
        write_tiff(out / "depth.tiff", result.surface.depth);
        write_image(out / "depth.png", options.depth.picture(result.surface));
        write_mesh(out / "mesh.ply", result.surface, picture.display());
        if (result.whole)
            write_image(out / "classes.png", class_picture(*result.whole, cv::Rect({}, picture.size())));
    }
    if (!result.uncertainty.empty()) {
        write_tiff(out / "uncertainty.tiff", result.uncertainty);
        write_image(out / "uncertainty.png", uncertainty_picture(result, cv::Rect({}, picture.size())));
    }
    write_image(out / "overview.png", overview(picture, result));

    if (options.paper_report() && result.solved()) {
        const Result direct = options.direct() ? result : solve_by(solved, OFC_ORIENTATION_DIRECT);
        if (!direct.solved())
            throw std::runtime_error(std::string("the direct method has no answer: ") + ofc_status_message(direct.status));
        print_paper_report(solved, direct);
        write_paper_figures(out, solved, direct);
    } else {
        for (const Line &line : summary(result))
            std::fprintf(result.solved() ? stdout : stderr, "%-10s %s\n", line.label.c_str(), line.text.c_str());
    }
    say_where(out, "overview.png");
    return result.solved() ? 0 : 1;
}

} // namespace

int main(int argc, char **argv)
{
    const Options options = parse_options(argc, argv);
    return guarded("ofc_photo", [&] { return run(options); });
}
