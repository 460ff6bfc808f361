// Surface normals from a photograph, with everything a person wants to see of how they came about.
//
// Shows how cv::Mat goes in and out of ofc, the whole solve and each of its stages, and what to do with a status.

#include "common/scene.hpp"
#include "photo/options.hpp"
#include "photo/overview.hpp"
#include "photo/report.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace {

// A workspace of so many bytes, aligned for any call.
std::vector<std::uint64_t> workspace_of(std::size_t bytes)
{
    return std::vector<std::uint64_t>(bytes / sizeof(std::uint64_t) + 1);
}

// Solves the picture, and computes its normals where it can be solved.
Result solve(const Picture &picture, const ofc_solve_params &params)
{
    Result result;
    result.params = params;
    result.inliers = cv::Mat::zeros(picture.size(), CV_8U);
    result.normals = cv::Mat::zeros(picture.size(), CV_32FC3);
    const ofc_image image = picture.view();
    const auto timed = [&](const char *stage, auto call) {
        const auto start = std::chrono::steady_clock::now();
        const ofc_status status = call();
        const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
        result.milliseconds.emplace_back(stage, elapsed.count());
        return status;
    };

    const std::size_t bytes = ofc_solve_workspace_size(image.width, image.height, &params);
    std::vector<std::uint64_t> workspace = workspace_of(bytes);
    ofc_solution &s = result.solution;
    result.status = timed("solve", [&] {
        return ofc_solve(&image, &params, workspace.data(), bytes, result.inliers.data, &s);
    });
    if (!result.solved())
        return result;
    result.status = timed("normals", [&] {
        return ofc_normals_compute(&image, &s, result.normals.ptr<float>(), result.normals.step);
    });
    result.uncertainty.create(picture.size(), CV_32F);
    const ofc_status known = timed("uncertainty", [&] {
        return ofc_normals_uncertainty(&image, &s, result.uncertainty.ptr<float>(), result.uncertainty.step);
    });
    if (known == OFC_STATUS_OK && ofc_solution_covariance(&s, &result.covariance) == OFC_STATUS_OK) {
        result.uncertainty *= degrees(1);
        result.uncertainty.setTo(std::nan(""), result.inliers == 0);
    } else {
        // The direct method does not know how sure it is.
        result.uncertainty.release();
    }

    // The same stages one by one, to say what each of them costs.
    ofc_color_fit fit;
    ofc_location location;
    ofc_inliers first, both;
    ofc_tilts tilts;
    ofc_slants slants[OFC_MAX_CANDIDATES];
    ofc_ellipsoid ellipsoid;
    ofc_integrability integrability;
    int32_t count = 0;
    timed("lmeds_fit", [&] { return ofc_lmeds_fit(&image, &params.lmeds, workspace.data(), bytes, &fit, &first); });
    double c[6];
    for (int i = 0; i < 6; i++)
        c[i] = fit.coefficients[i].value;
    timed("norm_location", [&] {
        return ofc_norm_location(&image, c, &first, params.lmeds.rejection, workspace.data(), bytes, &location, &both);
    });
    timed("ellipsoid", [&] { return ofc_ellipsoid_decompose(c, &ellipsoid); });
    timed("tilts", [&] { return ofc_tilt_pentland(&image, &both, &tilts); });
    timed("slants", [&] { return ofc_constrained_slants_find(tilts.tilt_rad, ellipsoid.cosines, slants, &count); });
    timed("integrability",
          [&] { return ofc_integrability_integral(&image, &both, s.orientation.f_inverse, &integrability); });
    return result;
}

// Where depth is wanted: everything that the outlines of the inliers enclose, so that gaps can be spanned.
cv::Mat spanned(const cv::Mat &inliers, const cv::Mat &mask)
{
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(inliers, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::Mat region = cv::Mat::zeros(inliers.size(), CV_8U);
    cv::drawContours(region, outlines, -1, cv::Scalar(255), cv::FILLED);
    if (!mask.empty())
        region.setTo(0, mask == 0);
    return region;
}

// The answer against its own picture.
std::optional<ofc_check_result> check(const Picture &picture, const Result &result)
{
    const ofc_image image = picture.view();
    const ofc_depth_map depth = result.surface.view();
    const std::size_t bytes = ofc_check_workspace_size(image.width, image.height);
    std::vector<std::uint64_t> workspace = workspace_of(bytes);
    ofc_check_result found;
    const ofc_status status = ofc_check(&image, &result.solution, result.surface.integrated() ? &depth : nullptr,
                                        workspace.data(), bytes, &found);
    return status == OFC_STATUS_OK ? std::make_optional(found) : std::nullopt;
}

// The picture divided by that of the flat surface alone.
Picture flattened(const Picture &picture, const Picture &background, const std::string &path)
{
    const ofc_image image = picture.view(), below = background.view();
    Picture flat;
    flat.pixels.create(picture.size(), CV_32FC3);
    ofc_flat_field_result result;
    const ofc_status status =
        ofc_flat_field(&image, &below, flat.pixels.ptr<float>(), flat.pixels.step, &result);
    if (status != OFC_STATUS_OK)
        throw UsageError(path + " is no background of the picture: " + ofc_status_message(status));
    cv::cvtColor(flat.pixels, flat.pixels, cv::COLOR_RGB2BGR);
    std::printf("%-10s %d pixels divided; left out %d dark and %d saturated ones\n", "background", result.used, result.dark,
                result.saturated);
    return flat;
}

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
    if (!options.background.empty())
        picture = flattened(picture, read_picture(options.background), options.background);
    if (!options.mask.empty())
        picture.mask = read_mask(options.mask, picture.size());
    if (!options.truth.empty())
        truth = read_normals_tiff(options.truth, picture.size());
    const std::filesystem::path out = options.out;
    make_folder(out);

    ofc_solve_params params;
    ofc_solve_params_default(&params);
    params.lmeds.seed = options.seed.value_or(params.lmeds.seed);
    params.lmeds.subsets = options.subsets.value_or(params.lmeds.subsets);
    params.orientation_method = options.direct_method ? OFC_ORIENTATION_DIRECT : OFC_ORIENTATION_JOINT;
    params.lmeds.method = options.least_squares ? OFC_FIT_LEAST_SQUARES : OFC_FIT_LEAST_MEDIAN;
    Result result = solve(picture, params);
    result.true_f = true_f;
    result.depth = options.depth;
    if (result.solved()) {
        result.surface = integrate(result.normals, spanned(result.inliers, picture.mask), options.depth.params());
        result.check = check(picture, result);
        result.estimates = estimates_of(picture.view(), result.solution.inliers);
    }
    if (result.solved() && !truth.empty())
        result.median_error_deg = median_angle_deg(result.normals, truth);

    if (options.save_planes) {
        const cv::Mat channels[] = {picture.channel(0), picture.channel(1), picture.channel(2)};
        const char *names[] = {"plane_r.png", "plane_g.png", "plane_b.png"};
        for (int c = 0; c < 3; c++)
            write_image(out / names[c], channels[c]);
    }
    write_report(out / "report.json", result);
    write_image(out / "inliers.png", result.inliers);
    write_image(out / "overview.png", overview(picture, result));
    if (result.solved()) {
        write_image(out / "normals.png", normal_map(result.normals));
        write_normals_tiff(out / "normals.tiff", result.normals);
        write_tiff(out / "depth.tiff", result.surface.depth);
        write_image(out / "depth.png", options.depth.picture(result.surface));
        write_mesh(out / "mesh.ply", result.surface, picture.display());
    }
    if (!result.uncertainty.empty()) {
        write_tiff(out / "uncertainty.tiff", result.uncertainty);
        write_image(out / "uncertainty.png", uncertainty_picture(result, cv::Rect({}, picture.size())));
    } else {
        for (const char *name : {"uncertainty.tiff", "uncertainty.png"})
            std::filesystem::remove(out / name);
    }
    if (!result.solved()) {
        // What an earlier run left there is not this picture's.
        for (const char *name : {"normals.png", "normals.tiff", "depth.tiff", "depth.png", "mesh.ply"})
            std::filesystem::remove(out / name);
    }

    if (options.paper_report && result.solved())
        print_paper_report(result);
    else
        for (const Line &line : summary(result))
            std::fprintf(result.solved() ? stdout : stderr, "%-10s %s\n", line.label.c_str(), line.text.c_str());
    std::printf("wrote %s: look at overview.png\n", std::filesystem::absolute(out).lexically_normal().c_str());
    return result.solved() ? 0 : 1;
}

} // namespace

int main(int argc, char **argv)
{
    const Options options = parse_options(argc, argv);
    return guarded("ofc_photo", [&] { return run(options); });
}
