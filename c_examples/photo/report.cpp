#include "photo/report.hpp"

#include "common/reason.hpp"
#include "photo/text.hpp"
#include "photo/trust.hpp"
#include "photo/whole.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

using json = nlohmann::ordered_json;

namespace {

const char *const channel_names[] = {"r", "g", "b"};

json matrix(const double (&m)[9])
{
    return {{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}};
}

json in_degrees(const double (&radians)[3])
{
    return {degrees(radians[0]), degrees(radians[1]), degrees(radians[2])};
}

const char *source_name(ofc_slant_source source)
{
    switch (source) {
    case OFC_SLANTS_ROOT:
        return "root of eqs. 25";
    case OFC_SLANTS_LEAST_SQUARES:
        return "least squares over eqs. 24 (eqs. 25 have no root)";
    case OFC_SLANTS_JOINT:
        return "F oriented as a whole";
    default:
        return "none";
    }
}

json candidates(const ofc_solution &solution)
{
    json list = json::array();
    for (int i = 0; i < solution.candidate_count; i++) {
        const ofc_slants &candidate = solution.candidates[i];
        list.push_back({{"slant_deg", in_degrees(candidate.slant_rad)},
                        {"branch", candidate.branch},
                        {"integral", candidate.integral},
                        {"residual", candidate.residual},
                        {"chosen", i == solution.chosen}});
    }
    return list;
}

json coefficients(const ofc_color_fit &fit)
{
    const char *const names[] = {"c11", "c22", "c33", "c12", "c13", "c23"};
    json list = json::array();
    for (int i = 0; i < 6; i++) {
        const ofc_estimate &c = fit.coefficients[i];
        list.push_back({{"name", names[i]},
                        {"value", c.value},
                        {"standard_error", c.standard_error},
                        {"t", c.t},
                        {"p", c.p},
                        {"low", c.low},
                        {"high", c.high}});
    }
    return list;
}

json check_report(const ofc_check_result &check)
{
    json report = {{"correlation", check.correlation},
                   {"norms", {{"median", check.norm_median}, {"min", check.norm_min}, {"max", check.norm_max}}},
                   {"tilt_deg", in_degrees(check.tilts.tilt_rad)},
                   {"relit_tilt_deg", in_degrees(check.relit_tilts.tilt_rad)},
                   {"tilt_difference_deg", in_degrees(check.tilt_difference_rad)},
                   {"tilt_residual_deg", in_degrees(check.tilt_residual_rad)},
                   {"depth",
                    {{"pixels", check.depth_pixel_count},
                     {"median_angle_deg", degrees(check.depth_angle_median_rad)},
                     {"tilt_deg", in_degrees(check.depth_tilts.tilt_rad)},
                     {"tilt_difference_deg", in_degrees(check.depth_tilt_difference_rad)}}},
                   {"largest_p", check.largest_p}};
    if (check.has_turn)
        report["turn"] = {{"deg", degrees(check.turn_rad)},
                          {"expected_deg", degrees(check.turn_expected_rad)},
                          {"convexity", check.convexity}};
    return report;
}

// Whether the light of a channel shines from behind the surface, which only the joint method can find.
bool from_behind(const ofc_solution &s, int channel)
{
    return (s.lights_from_behind >> channel & 1) != 0;
}

template <std::size_t size> json rows(const double (&entries)[size], std::size_t columns)
{
    json list = json::array();
    for (std::size_t i = 0; i < size; i += columns)
        list.push_back(std::vector<double>(entries + i, entries + i + columns));
    return list;
}

json uncertainty(const Result &result)
{
    return {{"median_deg", quantile(result.uncertainty, 0.5)},
            {"p90_deg", quantile(result.uncertainty, 0.9)},
            {"pixel_noise", result.covariance.pixel_noise},
            {"covariance_of_coefficients", rows(result.covariance.c, 6)},
            {"covariance_of_F", rows(result.covariance.f, 9)}};
}

json doubts(const Result &result)
{
    json list = json::array();
    for (const Doubt &doubt : result.doubts)
        list.push_back({{"in_words", doubt.words}, {"turn_deg", doubt.turn}, {"expected_deg", doubt.expected}});
    return list;
}

// Numbers that are not known, which are NaN, become null.
json confidence(const Result &result)
{
    static const char *const names[] = {"tilts alone", "outward normals", "integrability", "both"};
    if (!result.solved())
        return nullptr;
    const ofc_confidence &c = result.solution.confidence;
    return {{"evidence", names[c.evidence]},
            {"expected_error_deg", error_as_a_whole(result)},
            {"doubts", doubts(result)},
            {"convexity", c.convexity},
            {"open_outline", result.open_outline},
            {"second_best", c.log_likelihood_margin},
            {"covariance", matrix(c.covariance)},
            {"in_words", trust(result)}};
}

// What a refusal or a doubt comes from, or null where there is nothing to doubt.
json reason(const ofc_solution &s)
{
    if (s.reason == OFC_REASON_NONE)
        return nullptr;
    return {{"code", s.reason},
            {"in_words", ofc_reason_message(s.reason)},
            {"advice", ofc_reason_advice(s.reason)},
            {"channel", s.reason_channel < 0 ? json(nullptr) : json(channel_names[s.reason_channel])},
            {"value", s.reason_value},
            {"limit", s.reason_limit}};
}

// What a stage found, or null where the solve did not come so far.
json found(bool is_there, json value)
{
    return is_there ? std::move(value) : json(nullptr);
}

} // namespace

void add_wrapped(std::vector<Line> &lines, std::string label, std::string text)
{
    constexpr std::size_t width = 180;
    while (text.size() > width) {
        const std::size_t end = text.rfind(' ', width);
        if (end == std::string::npos)
            break;
        lines.push_back({std::exchange(label, ""), text.substr(0, end)});
        text.erase(0, end + 1);
    }
    lines.push_back({label, text});
}

cv::Mat uncertainty_picture(const Result &result, cv::Rect part)
{
    cv::Vec2d range(0, quantile(result.uncertainty, 0.99));
    if (!(range[0] <= range[1]))
        range = {0, 1}; // there are no values
    return color_picture(result.uncertainty(part), range,
                         text("1 sigma of the normals, degrees (median %.2f)", quantile(result.uncertainty, 0.5)));
}

json report_of(const Result &result)
{
    const ofc_solution &s = result.solution;
    const bool is_fitted = s.fit.inlier_count > 0, is_ellipsoid = s.ellipsoid.norms[0] > 0, is_oriented = s.orientation.rank > 0;
    json report = {
        {"status", ofc_status_message(result.status)},
        {"status_code", result.status},
        {"reason", reason(s)},
        {"version", ofc_version_string()},
        {"parameters", {{"seed", result.params.lmeds.seed},
          {"subsets", s.fit.subsets},
          {"fit", result.params.lmeds.method == OFC_FIT_LEAST_SQUARES ? "squares" : "median"},
          {"orientation", result.params.orientation_method == OFC_ORIENTATION_DIRECT ? "direct" : "joint"}}},
        {"input", result.input},
        {"shadows", result.shadows},
        {"pixels",
         {{"usable", s.pixel_counts.usable},
          {"masked_out", s.pixel_counts.masked_out},
          {"dark", s.pixel_counts.dark},
          {"saturated", s.pixel_counts.saturated},
          {"shaded", s.pixel_counts.shadowed},
          {"non_finite", s.pixel_counts.non_finite}}},
        {"coefficients", found(is_fitted, coefficients(s.fit))},
        {"C", found(is_ellipsoid, matrix(s.ellipsoid.c))},
        {"r_squared", found(is_fitted, s.fit.r_squared)},
        {"dispersion", found(is_fitted, s.fit.dispersion)},
        {"noise_deviation", found(is_fitted, s.fit.noise_deviation)},
        {"degenerate_noise_deviation", found(is_fitted, s.fit.degenerate_noise_deviation)},
        {"inliers", {{"after_residuals", s.fit.inlier_count}, {"after_norms", s.inlier_count}}},
        {"norm_location", found(is_ellipsoid, s.norm_location.location)},
        {"norms", found(is_ellipsoid, s.ellipsoid.norms)},
        {"cosines", found(is_ellipsoid, s.ellipsoid.cosines)},
        {"tilt_deg", found(is_oriented, in_degrees(s.tilts.tilt_rad))},
        {"slant_deg", found(is_oriented, in_degrees(s.slant_rad))},
        {"slant_source", source_name(s.slant_source)},
        {"from_behind", {from_behind(s, 0), from_behind(s, 1), from_behind(s, 2)}},
        {"confidence", confidence(result)},
        {"candidates", candidates(s)},
        {"F", found(is_oriented, matrix(s.orientation.f))},
        {"singular_values", found(is_oriented, s.orientation.singular_values)},
    };
    for (const auto &[stage, milliseconds] : result.milliseconds)
        report["ms"][stage] = std::round(milliseconds * 1000) / 1000;
    if (result.status >= 0)
        report["rank"] = {{"colors", s.rank.colors},
                          {"normals", found(s.rank.normals > 0, s.rank.normals)},
                          {"color_deviations", s.rank.color_deviations},
                          {"color_noise", s.rank.color_noise},
                          {"normal_deviations", found(s.rank.normals > 0, s.rank.normal_deviations)},
                          {"normal_noise", found(s.rank.normals > 0, s.rank.normal_noise)}};
    if (result.paint)
        report["paint"] = result.paint->report();
    if (result.check)
        report["check"] = check_report(*result.check);
    if (result.solved() && result.depth.is_wanted)
        report["depth"] = result.depth.report(result.surface);
    if (result.whole)
        report["surface"] = ::report(*result.whole);
    else if (!result.whole_left_out.empty())
        report["surface"] = {{"left_out", result.whole_left_out}};
    if (!result.uncertainty.empty())
        report["uncertainty"] = uncertainty(result);
    if (result.median_error_deg)
        report["median_error_deg"] = *result.median_error_deg;
    if (result.true_f) {
        const Directions truth = directions_of(*result.true_f);
        for (int c = 0; c < 3; c++)
            report["truth"][channel_names[c]] = {{"tilt_deg", degrees(truth.tilts[c])},
                                                 {"slant_deg", degrees(truth.slants[c])},
                                                 {"norm", truth.norms[c]}};
    }
    return report;
}

std::vector<Line> summary(const Result &result)
{
    const ofc_solution &s = result.solution;
    std::vector<Line> lines;
    if (!result.solved())
        lines.push_back({"refused", ofc_status_message(result.status)});
    if (s.reason != OFC_REASON_NONE) {
        add_wrapped(lines, result.solved() ? "doubt" : "reason", reason_in_words(s));
        add_wrapped(lines, "try", ofc_reason_advice(s.reason));
    }
    lines.push_back({"pixels", counts_in_words(s)});
    if (result.paint)
        add_wrapped(lines, "paint", result.paint->in_words());
    if (result.status < 0)
        return lines;
    lines.push_back({"shadows", result.shadows});
    if (s.fit.inlier_count > 0)
        lines.push_back({"ellipsoid", text("robust R² %.4f, dispersion %.4f", s.fit.r_squared, s.fit.dispersion)});
    if (s.orientation.rank == 0)
        return lines;
    lines.back().text += text(", location of norms %.4f", s.norm_location.location);
    add_wrapped(lines, "trust", trust(result));
    if (s.slant_source != OFC_SLANTS_JOINT)
        lines.push_back({"slants", text("from a %s; %d candidate%s", source_name(s.slant_source), s.candidate_count,
                                        s.candidate_count == 1 ? "" : "s")});
    for (int c = 0; c < 3; c++) {
        std::string line = text("tilt %7.2f  slant %5.2f  norm %6.1f", degrees(s.tilts.tilt_rad[c]),
                                degrees(s.slant_rad[c]), s.ellipsoid.norms[c]);
        if (from_behind(s, c))
            line += "   above 90 degrees: a light from behind the surface, or a wrong answer";
        if (result.true_f) {
            const Directions truth = directions_of(*result.true_f);
            line += text("   (true %7.2f  %5.2f  %6.1f)", degrees(truth.tilts[c]), degrees(truth.slants[c]), truth.norms[c]);
        }
        lines.push_back({channel_names[c], line});
    }
    if (result.whole)
        for (const Line &line : summary(*result.whole))
            lines.push_back(line);
    else if (!result.whole_left_out.empty())
        add_wrapped(lines, "surface", "only pixels that all lights reach, the whole surface is left out: " + result.whole_left_out);
    if (!result.uncertainty.empty())
        lines.push_back({"1 sigma", text("%.2f degrees at half of the normals, %.2f at nine tenths; noise %.2f",
                                         quantile(result.uncertainty, 0.5), quantile(result.uncertainty, 0.9),
                                         result.covariance.pixel_noise)});
    if (result.median_error_deg)
        lines.push_back({"normals", text("median error %.2f degrees", *result.median_error_deg)});
    if (const ofc_depth_result &d = result.surface.result; result.surface.integrated()) {
        const cv::Vec2d range = range_of(result.surface.depth);
        std::string line = text("%s: %.4g %s over %d pixels in %d region%s, %s", result.depth.method.c_str(), range[1] - range[0],
                                result.depth.unit(), d.pixel_count, d.regions, d.regions == 1 ? "" : "s",
                                d.converged ? "converged" : "stopped");
        if (!result.whole)
            line += text(" at residual %.0e in %d cycles", d.residual, d.cycles);
        lines.push_back({"depth", line});
    }
    return lines;
}
