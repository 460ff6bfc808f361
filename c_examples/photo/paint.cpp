#include "photo/paint.hpp"

#include "photo/text.hpp"
#include "photo/trust.hpp"

#include <opencv2/imgproc.hpp>

namespace {

// The margin of the plain fit has the noise that the fit leaves below the line, and that of the pairs the noise across the
// direction of the colors. Where the paint is even and the model holds they are about the same.
constexpr double clearly_worse = 3;

const char *verdict_name(ofc_paint_verdict verdict)
{
    switch (verdict) {
    case OFC_PAINT_SMOOTH:
        return "smooth";
    case OFC_PAINT_ROUGH:
        return "nearly as rough as the shape: normals may be twice as wrong as with even paint";
    case OFC_PAINT_BUSY:
        return "too busy: as rough as the shape, and not told from it";
    case OFC_PAINT_TWO_HUES:
        return "of two hues or more (or hard shadows look so): mask one of them";
    case OFC_PAINT_UNDETERMINED:
        return "not determined: the colors span too little, whatever their paint";
    default:
        return "unknown: neighboring pixels agree on no ellipsoid";
    }
}

ofc_paint_params params_of(const Picture &picture, std::uint64_t seed)
{
    ofc_paint_params params;
    ofc_paint_params_default(&params);
    params.seed = seed;
    params.saturation = picture.saturation;
    return params;
}

} // namespace

void PaintOption::add_to(CLI::App &app)
{
    app.add_option("--paint", choice,
                   "Whether the paint is even: uneven compares neighboring pixels, which share it, and divides it out;\n"
                   "auto does so where the picture has no answer otherwise, or clearly a worse one (default: auto)")
        ->check(CLI::IsMember({"auto", "even", "uneven"}));
}

std::string Paint::in_words() const
{
    std::string words;
    if (taken)
        words = text("divided out, albedo %.2f to %.2f in eight pixels of ten; ", quantile(albedo, 0.1), quantile(albedo, 0.9)) +
                verdict_name(estimate.verdict);
    else if (status == OFC_STATUS_OK)
        words = "left as it is, as dividing it out would not clearly help";
    else if (status > 0)
        words = std::string("not told from the shape: ") + verdict_name(estimate.verdict);
    else
        return std::string("not looked at: ") + ofc_status_message(status);
    return words + text(" (margin %.1f, ratio %.1f, variogram %.2f %.2f %.2f)", estimate.margin, estimate.ratio,
                        estimate.variogram[0], estimate.variogram[1], estimate.variogram[2]);
}

nlohmann::ordered_json Paint::report() const
{
    return {{"taken", taken},
            {"status", ofc_status_message(status)},
            {"verdict", verdict_name(estimate.verdict)},
            {"margin", estimate.margin},
            {"direction_noise", estimate.direction_noise},
            {"ratio", estimate.ratio},
            {"disagreement", estimate.disagreement},
            {"hue_excess", estimate.hue_excess},
            {"gradient", estimate.gradient},
            {"distances", estimate.distances},
            {"variogram", estimate.variogram},
            {"pairs", estimate.pair_counts},
            {"albedo", {{"p10", quantile(albedo, 0.1)}, {"p90", quantile(albedo, 0.9)}}}};
}

cv::Mat Paint::picture() const
{
    cv::Mat gray;
    cv::Mat known = albedo.clone();
    cv::patchNaNs(known, 0);
    known.convertTo(gray, CV_8U, 127.5);
    return gray;
}

Paint paint_of(const Picture &picture, std::uint64_t seed)
{
    Paint paint;
    const ofc_paint_params params = params_of(picture, seed);
    const ofc_image image = picture.view();
    ofc::Workspace workspace(ofc_paint_workspace_size());
    paint.status = ofc_paint_estimate(&image, &params, workspace.data(), workspace.bytes(), &paint.estimate);
    return paint;
}

void divide_out(Paint &paint, const Picture &picture)
{
    if (paint.status < 0)
        return;
    ofc_paint_params params = params_of(picture, 0);
    const ofc_image image = picture.view();
    ofc::Workspace workspace(ofc_paint_albedo_workspace_size(image.width, image.height));
    cv::Mat albedo(picture.size(), CV_32F), pixels(picture.size(), CV_32FC3);
    if (ofc_paint_albedo(&image, &params, paint.estimate.coefficients, workspace.data(), workspace.bytes(), albedo.ptr<float>(),
                         albedo.step) == OFC_STATUS_OK &&
        ofc_paint_divide(&image, &params, albedo.ptr<float>(), albedo.step, pixels.ptr<float>(), pixels.step) == OFC_STATUS_OK) {
        cv::cvtColor(pixels, pixels, cv::COLOR_RGB2BGR);
        paint.albedo = albedo;
        paint.even.pixels = pixels;
        paint.even.mask = picture.mask;
        paint.even.facts = picture.facts;
    }
}

bool is_better_even(const Paint &paint, ofc_status plain, const ofc_solution &solution)
{
    if (paint.status != OFC_STATUS_OK)
        return false;
    if (plain == OFC_STATUS_RANK_DEFICIENT || plain == OFC_STATUS_NOT_POSITIVE_DEFINITE)
        return true;
    const double margin = solution.fit.degenerate_noise_deviation / solution.fit.noise_deviation;
    return plain >= 0 && paint.estimate.verdict == OFC_PAINT_SMOOTH && paint.estimate.margin > clearly_worse * margin;
}
