#include "photo/relief.hpp"

#include "common/surface_view.hpp"
#include "photo/text.hpp"
#include "photo/trust.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

using json = nlohmann::ordered_json;

namespace {

// BGR: nothing, the plane, the skirt, the contact.
const cv::Vec3b class_colors[] = {{30, 30, 30}, {150, 150, 150}, {178, 114, 0}, {0, 159, 230}};

cv::Mat class_picture(const cv::Mat &classes)
{
    cv::Mat shown(classes.size(), CV_8UC3);
    for (int y = 0; y < shown.rows; y++)
        for (int x = 0; x < shown.cols; x++)
            shown.at<cv::Vec3b>(y, x) = class_colors[classes.at<uchar>(y, x) & 3];
    return shown;
}

const char *scale_name(ofc_scale_source source)
{
    static const char *const names[] = {"unknown", "the bend of the colors", "the ball's radius", "what was set"};
    return names[source];
}

std::optional<ofc_image> view_of(const Picture *picture)
{
    return picture != nullptr ? std::make_optional(picture->view()) : std::nullopt;
}

// Shifts the depth so that the plane is at zero, in the median.
void put_plane_at_zero(cv::Mat &depth, const cv::Mat &classes)
{
    cv::Mat plane(depth.size(), CV_32F, cv::Scalar(std::nan("")));
    depth.copyTo(plane, classes == OFC_RELIEF_PLANE);
    const double level = quantile(plane, 0.5);
    if (std::isfinite(level))
        depth -= level;
}

double highest(const ReliefResult &result)
{
    const cv::Vec2d range = range_of(result.surface.depth);
    return std::abs(range[0]) > range[1] ? range[0] : range[1];
}

cv::Mat overview(const Picture &picture, const ReliefResult &result)
{
    const cv::Mat shown = picture.display(), &depth = result.surface.depth;
    cv::Mat contact;
    result.uncertainty.copyTo(contact);
    contact.setTo(std::nan(""), result.classes != OFC_RELIEF_CONTACT);
    Sheet sheet(3);
    sheet.add("input", shown);
    sheet.add("plane (gray), skirt (blue), contact (orange)", class_picture(result.classes));
    sheet.add("normals: x right, y up, z out as r, g, b", normal_map(result.normals));
    sheet.add("how sure each normal is",
              color_picture(result.uncertainty, {0, std::max(quantile(contact, 0.99), 1e-3)},
                            text("1 sigma of the normals, degrees (contact: median %.2f)", quantile(contact, 0.5))));
    if (result.surface.integrated()) {
        sheet.add("depth, " + std::string(result.depth.unit()), colors_of(depth, range_of(depth)));
        sheet.add("the surface from the side", mesh_picture(result.surface, Sheet::panel()));
    }
    return sheet.draw(summary(result));
}

} // namespace

bool ReliefResult::is_better_than(const Result &ellipsoid) const
{
    if (!solved() || !ellipsoid.solved())
        return solved();
    constexpr double most_pixels = 0.8;
    const ofc_solution &s = ellipsoid.solution;
    return relief.scale_source != OFC_SCALE_UNKNOWN && relief.expected_error < s.confidence.error_rad &&
           s.inlier_count < most_pixels * s.pixel_counts.usable;
}

void ReliefResult::restrict_to(const cv::Mat &mask)
{
    const cv::Mat outside = mask == 0;
    classes.setTo(OFC_RELIEF_NONE, outside);
    normals.setTo(cv::Scalar(), outside);
    uncertainty.setTo(std::nan(""), outside);
    if (surface.integrated())
        surface.depth.setTo(std::nan(""), outside);
}

ReliefResult solve_relief(const Picture &picture, const Picture *background, const ofc_relief_params &given)
{
    const ofc_image image = picture.view();
    const std::optional<ofc_image> plane = view_of(background);
    ofc_relief_params params = given;
    params.saturation = picture.saturation;
    ReliefResult result;
    result.classes = cv::Mat::zeros(picture.size(), CV_8U);
    ofc::Workspace workspace(ofc_relief_workspace_size(image.width, image.height));
    result.status = ofc_relief_solve(&image, plane ? &*plane : nullptr, &params, workspace.data(), workspace.bytes(),
                                     result.classes.data, &result.relief);
    return result;
}

void complete(ReliefResult &result, const Picture &picture, const Picture *background, const DepthOptions &depth,
              const cv::Mat &truth)
{
    const ofc_image image = picture.view();
    const std::optional<ofc_image> plane = view_of(background);
    result.normals.create(picture.size(), CV_32FC3);
    result.uncertainty.create(picture.size(), CV_32F);
    result.status = ofc_relief_normals(&image, plane ? &*plane : nullptr, &result.relief, result.classes.data,
                                       result.normals.ptr<float>(), result.normals.step, result.uncertainty.ptr<float>(),
                                       result.uncertainty.step);
    cv::patchNaNs(result.normals, 0);
    result.uncertainty *= degrees(1);
    // Over the plane as well: it is what the relief rises from.
    result.depth = depth;
    result.surface = integrate(result.normals, picture.mask, depth.params());
    if (result.surface.integrated())
        put_plane_at_zero(result.surface.depth, result.classes);
    if (!truth.empty()) {
        cv::Mat contact = cv::Mat::zeros(truth.size(), CV_32FC3);
        truth.copyTo(contact, result.classes == OFC_RELIEF_CONTACT);
        result.median_error_deg = median_angle_deg(result.normals, contact);
    }
}

const char *no_relief(const ReliefResult &result)
{
    switch (result.relief.reason) {
    case OFC_NO_RELIEF_UNTOUCHED:
        return "nothing differs from a smooth plane";
    case OFC_NO_RELIEF_NO_PLANE:
        return "more than half of the picture differs from a smooth plane";
    case OFC_NO_RELIEF_NOT_DETERMINED:
        return "what differs from the plane bends in one direction only, or hardly beyond noise";
    case OFC_NO_RELIEF_NOT_INTEGRABLE:
        return "what differs from the plane is paint, spots or shadows: its slopes would not be those of a surface";
    case OFC_NO_RELIEF_EDGE:
        return "what differs from the plane has an edge: it lies on the plane, or it is paint";
    default:
        return ofc_status_message(result.status);
    }
}

std::string trust(const ReliefResult &result)
{
    const ofc_relief &r = result.relief;
    std::string words;
    if (r.scale_source == OFC_SCALE_UNKNOWN)
        words = text("the shape, not its height: slopes and depth are right up to a factor that the colors do not tell (a usual one is "
                     "taken, and may be off by %.0f %%); give --ball-radius for one ball of known radius",
                     100 * (std::exp(r.scale_deviation) - 1));
    else
        words = text("normals in the contact are expected to be off by %.1f degrees; the scale of slopes and depth is from %s, known "
                     "within %.0f %%",
                     degrees(r.expected_error), scale_name(r.scale_source), 100 * r.scale_deviation);
    if (r.outward < 0.2)
        words += "; the picture hardly tells whether the relief rises or goes down: --hollow turns it around";
    return words;
}

std::vector<Line> summary(const ReliefResult &result)
{
    const ofc_relief &r = result.relief;
    std::vector<Line> lines;
    if (!result.solved()) {
        lines.push_back({"no relief", no_relief(result)});
        return lines;
    }
    const double pixels = static_cast<double>(result.classes.total()) / 100;
    lines.push_back({"model", text("a relief on a plane, relative to %s: %.1f %% of the picture is contact, %.1f %% plane",
                                   r.has_background ? "the background" : "the plane as the picture itself shows it",
                                   cv::countNonZero(result.classes == OFC_RELIEF_CONTACT) / pixels,
                                   cv::countNonZero(result.classes == OFC_RELIEF_PLANE) / pixels)});
    add_wrapped(lines, "trust", trust(result));
    lines.push_back({"evidence", text("circulation %.3f (paint and shadows: above 0.3), slopes %.1f times the noise, border %.2f",
                                      r.circulation, r.signal_to_noise, r.border)});
    if (result.median_error_deg)
        lines.push_back({"normals", text("median error in the contact %.2f degrees", *result.median_error_deg)});
    if (result.surface.integrated())
        lines.push_back({"depth", text("the highest point is %.4g %s from the plane", highest(result), result.depth.unit())});
    return lines;
}

json report_of(const ReliefResult &result, const Result *ellipsoid)
{
    const ofc_relief &r = result.relief;
    const bool is_solved = result.solved();
    json report = {{"status", ofc_status_message(result.status)},
                   {"status_code", result.status},
                   {"version", ofc_version_string()},
                   {"model", "relief"},
                   {"input", result.input},
                   {"reason", is_solved ? json(nullptr) : json(no_relief(result))}};
    if (ellipsoid != nullptr)
        report["ellipsoid"] = {{"status", ofc_status_message(ellipsoid->status)}, {"status_code", ellipsoid->status}};
    if (!is_solved)
        return report;
    report["confidence"] = {{"expected_error_deg", degrees(r.expected_error)}, {"in_words", trust(result)}};
    report["scale"] = {{"from", scale_name(r.scale_source)}, {"relative_deviation", r.scale_deviation}};
    report["slopes"] = {{r.slopes[0], r.slopes[1], r.slopes[2]}, {r.slopes[3], r.slopes[4], r.slopes[5]}};
    report["noise"] = r.noise;
    report["background_given"] = r.has_background != 0;
    report["pixels"] = {{"none", cv::countNonZero(result.classes == OFC_RELIEF_NONE)},
                        {"plane", cv::countNonZero(result.classes == OFC_RELIEF_PLANE)},
                        {"skirt", cv::countNonZero(result.classes == OFC_RELIEF_SKIRT)},
                        {"contact", cv::countNonZero(result.classes == OFC_RELIEF_CONTACT)}};
    report["evidence"] = {{"circulation", r.circulation},         {"circulation_ratio", r.circulation_ratio},
                          {"anisotropy", r.anisotropy},           {"signal_to_noise", r.signal_to_noise},
                          {"border", r.border},                   {"outward", r.outward},
                          {"disagreement", r.disagreement},       {"tilt", r.tilt}};
    if (result.surface.integrated()) {
        report["depth"] = result.depth.report(result.surface);
        report["depth"]["highest"] = highest(result);
    }
    if (result.median_error_deg)
        report["median_error_deg"] = *result.median_error_deg;
    return report;
}

void write_relief(const ResultFolder &out, const Options &options, const Picture &picture, const ReliefResult &result)
{
    if (!result.solved())
        return;
    if (options.wants("classes"))
        write_png(out / "classes.png", class_picture(result.classes));
    if (options.wants("normals")) {
        write_png(out / "normals.png", normal_map(result.normals));
        write_tiff(out / "normals.tiff", result.normals);
    }
    if (options.wants("uncertainty"))
        write_tiff(out / "uncertainty.tiff", result.uncertainty);
    if (result.surface.integrated()) {
        if (options.wants("depth")) {
            write_tiff(out / "depth.tiff", result.surface.depth);
            write_png(out / "depth.png", result.depth.picture(result.surface));
        }
        if (options.wants("mesh"))
            write_mesh(out / "mesh.ply", result.surface, picture.display(), options.mesh_faces);
    }
    if (options.wants("overview"))
        write_png(out / "overview.png", overview(picture, result));
}
