#include "photo/solve.hpp"

#include "common/reason.hpp"
#include "common/thin.hpp"
#include "photo/light.hpp"
#include "photo/trust.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace {

// Runs a call, and keeps the milliseconds that it took.
template <typename Call> ofc_status timed(Result &result, const char *stage, Call call)
{
    const auto start = std::chrono::steady_clock::now();
    const ofc_status status = call();
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    result.milliseconds.emplace_back(stage, elapsed.count());
    return status;
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

// What only numbers are made of needs no more pixels of a large picture.
constexpr std::size_t most_for_numbers = 4000000;

void add_uncertainty(const Picture &picture, const cv::Mat &inliers, Result &result)
{
    const ofc_image image = picture.view();
    const ofc_solution &s = result.solution;
    result.uncertainty.create(picture.size(), CV_32F);
    const ofc_status known = timed(result, "uncertainty", [&] {
        return ofc_normals_uncertainty(&image, &s, result.uncertainty.ptr<float>(), result.uncertainty.step);
    });
    if (known == OFC_STATUS_OK && ofc_solution_covariance(&s, &result.covariance) == OFC_STATUS_OK) {
        result.uncertainty *= degrees(1);
        result.uncertainty.setTo(std::nan(""), inliers == 0);
    } else {
        // The direct method does not know how sure it is.
        result.uncertainty.release();
    }
}

// The answer against its own picture.
std::optional<ofc_check_result> check(const Picture &whole, const Result &result)
{
    const Picture picture = thinned(whole, most_for_numbers);
    const ofc_image image = picture.view();
    const int step = step_to(whole.size(), most_for_numbers);
    const cv::Mat few = thin(result.surface.depth, step);
    const ofc_depth_map depth = depth_map_of(few, result.surface.params.pixel_pitch * step);
    ofc::Workspace workspace(ofc_check_workspace_size(image.width, image.height));
    ofc_check_result found;
    const ofc_status status = ofc_check(&image, &result.solution, result.surface.integrated() ? &depth : nullptr,
                                        workspace.data(), workspace.bytes(), &found);
    return status == OFC_STATUS_OK ? std::make_optional(found) : std::nullopt;
}

} // namespace

Result solve(const Picture &picture, const ofc_solve_params &params, const ShadowOption &shadows, const DepthOptions &depth,
             bool uncertainty_of_each)
{
    Result result;
    result.params = params;
    shadows.apply_to(result.params);
    result.params.lmeds.saturation = picture.saturation;
    result.depth = depth;
    result.inliers = cv::Mat::zeros(picture.size(), CV_8U);
    const ofc_image image = picture.view();
    std::optional<ofc::Workspace> workspace(ofc_solve_workspace_size(image.width, image.height, &result.params));
    result.status = timed(result, "solve", [&] {
        return ofc_solve(&image, &result.params, workspace->data(), workspace->bytes(), result.inliers.data, &result.solution);
    });
    workspace.reset();
    if (result.status < 0)
        explain_refusal(image, result.params, result.solution);
    else
        result.shadows = shadows.in_words(result.params, result.solution);
    if (!result.solved())
        return result;
    result.normals = cv::Mat::zeros(picture.size(), CV_32FC3);
    result.status = timed(result, "normals", [&] {
        return ofc_normals_compute(&image, &result.solution, result.normals.ptr<float>(), result.normals.step);
    });
    if (uncertainty_of_each)
        add_uncertainty(picture, result.inliers, result);
    else
        add_uncertainty(thinned(picture, most_for_numbers), thin(result.inliers, step_to(picture.size(), most_for_numbers)), result);
    result.open_outline = open_outline(picture.mask, result.inliers, result.normals);
    if (depth.is_wanted)
        result.surface = integrate(result.normals, spanned(result.inliers, picture.mask), depth.params());
    result.check = check(picture, result);
    return result;
}

void time_stages(const Picture &picture, Result &result)
{
    const ofc_image image = picture.view();
    const ofc_solve_params &params = result.params;
    ofc::Workspace workspace(ofc_solve_workspace_size(image.width, image.height, &params));
    ofc_color_fit fit;
    ofc_location location;
    ofc_inlier_test first, both;
    ofc_tilts tilts;
    ofc_slants slants[OFC_MAX_CANDIDATES];
    ofc_ellipsoid ellipsoid;
    ofc_integrability integrability;
    int32_t count = 0;
    timed(result, "lmeds_fit",
          [&] { return ofc_lmeds_fit(&image, &params.lmeds, workspace.data(), workspace.bytes(), &fit, &first); });
    double c[6];
    for (int i = 0; i < 6; i++)
        c[i] = fit.coefficients[i].value;
    timed(result, "norm_location", [&] {
        return ofc_norm_location(&image, c, &first, params.lmeds.rejection, workspace.data(), workspace.bytes(), &location,
                                 &both);
    });
    timed(result, "ellipsoid", [&] { return ofc_ellipsoid_decompose(c, &ellipsoid); });
    timed(result, "tilts", [&] { return ofc_tilt_pentland(&image, &both, &tilts); });
    timed(result, "slants",
          [&] { return ofc_constrained_slants_find(tilts.tilt_rad, ellipsoid.cosines, slants, &count); });
    timed(result, "integrability", [&] {
        return ofc_integrability_integral(&image, &both, result.solution.orientation.f_inverse, &integrability);
    });
}

Picture flattened(const Picture &picture, const Picture &background, const std::string &path)
{
    const ofc_image image = picture.view(), below = background.view();
    Picture flat;
    flat.pixels.create(picture.size(), CV_32FC3);
    ofc_flat_field_result result;
    const ofc_status status = ofc_flat_field(&image, &below, flat.pixels.ptr<float>(), flat.pixels.step, &result);
    if (status != OFC_STATUS_OK)
        throw UsageError(path + " is no background of the picture: " + ofc_status_message(status));
    cv::cvtColor(flat.pixels, flat.pixels, cv::COLOR_RGB2BGR);
    std::printf("%-10s %d pixels divided; left out %d dark and %d saturated ones\n", "background", result.used, result.dark,
                result.saturated);
    return flat;
}
