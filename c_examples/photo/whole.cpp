#include "photo/whole.hpp"

#include "common/thin.hpp"
#include "photo/text.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>

namespace {

struct Class {
    int number;
    const char *name;
    cv::Vec3b color; // BGR
};

// Told apart also by people who see red and green alike (Okabe and Ito). The last one is a pixel of two lights.
const Class classes[] = {
    {OFC_SURFACE_THREE_LIGHTS, "three lights", {235, 235, 235}}, {OFC_SURFACE_TWO_LIGHTS, "two lights", {178, 114, 0}},
    {OFC_SURFACE_ONE_LIGHT, "one light", {115, 158, 0}},         {OFC_SURFACE_REJECTED, "rejected", {167, 121, 204}},
    {OFC_SURFACE_INTERPOLATED, "interpolated", {0, 94, 213}},    {OFC_SURFACE_DOUBTFUL, "mirror image?", {233, 180, 86}},
};

bool is_of(const Class &one, uchar byte)
{
    return one.number == OFC_SURFACE_DOUBTFUL ? (byte & OFC_SURFACE_DOUBTFUL) != 0
                                              : (byte & OFC_SURFACE_CLASS) == one.number;
}

// What the pixels that are not black enclose.
cv::Mat enclosed(const Picture &picture)
{
    cv::Mat shown, region = cv::Mat::zeros(picture.size(), CV_8U);
    cv::cvtColor(picture.display(), shown, cv::COLOR_BGR2GRAY);
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(shown > 0, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::drawContours(region, outlines, -1, cv::Scalar(255), cv::FILLED);
    return region;
}

bool has_direction(const ofc_surface_light &light)
{
    return cv::norm(cv::Vec3d(light.direction)) > 0;
}

// A light takes nothing away from a channel: where its color says so, beyond what noise does, there is no such light.
bool has_color(const ofc_surface_light &light)
{
    const auto [least, most] = std::minmax_element(std::begin(light.color), std::end(light.color));
    constexpr double noise = 0.05;
    return *most > 0 && *least > -noise * *most;
}

} // namespace

void complete(Result &result, const Picture &picture, bool channels_are_lights)
{
    if (result.uncertainty.empty()) {
        result.whole_left_out = "it is not known how sure the orientation is";
        return;
    }
    Picture masked = picture;
    if (masked.mask.empty())
        masked.mask = enclosed(picture);
    const ofc_image image = masked.view();
    ofc_surface_params params;
    ofc_surface_params_default(&params);
    params.pixel_pitch = result.depth.params().pixel_pitch;
    params.seed = result.params.lmeds.seed;
    params.channels_are_lights = channels_are_lights ? 1 : 0;
    Whole whole;
    whole.classes.create(picture.size(), CV_8U);
    cv::Mat normals(picture.size(), CV_32FC3), angles(picture.size(), CV_32F), depth(picture.size(), CV_32F);
    ofc::Workspace workspace(ofc_surface_workspace_size(image.width, image.height));
    const auto start = std::chrono::steady_clock::now();
    const ofc_status status = ofc_surface_complete(&image, &result.solution, &params, workspace.data(), workspace.bytes(),
                                                   normals.ptr<float>(), normals.step, angles.ptr<float>(), angles.step,
                                                   depth.ptr<float>(), depth.step, whole.classes.data, whole.classes.step,
                                                   &whole.result);
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    if (status < 0) {
        // There is an F, so that it is not that of the picture.
        result.whole_left_out = status == OFC_STATUS_NOT_SOLVED ? "the lit pixels do not have the colors of the solution"
                                                                : ofc_status_message(status);
        return;
    }
    result.milliseconds.emplace_back("whole surface", elapsed.count());
    result.normals = normals;
    result.uncertainty = angles * degrees(1);
    result.uncertainty.setTo(std::nan(""), whole.classes == OFC_SURFACE_OUTSIDE);
    Surface &surface = result.surface;
    surface.status = status;
    surface.params = result.depth.params();
    surface.depth = depth;
    surface.result = {};
    surface.result.regions = whole.result.regions;
    surface.result.converged = whole.result.converged;
    surface.result.pixel_count = cv::countNonZero(whole.classes);
    surface.milliseconds = elapsed.count();
    result.depth.method = "whole surface";
    result.whole = whole;
}

cv::Mat class_picture(const Whole &whole, cv::Rect part)
{
    const cv::Mat bytes = thin(whole.classes(part), step_to(part.size(), most_drawn));
    cv::Mat map(bytes.size(), CV_8UC3, dark);
    std::vector<int> counts;
    for (const Class &one : classes) {
        int count = 0;
        for (int y = 0; y < map.rows; y++)
            for (int x = 0; x < map.cols; x++)
                if (is_of(one, bytes.at<uchar>(y, x))) {
                    map.at<cv::Vec3b>(y, x) = one.color;
                    count++;
                }
        counts.push_back(count);
    }
    const int factor = std::max(1, cvRound(400.0 / std::max({1, map.rows, map.cols})));
    cv::resize(map, map, cv::Size(), factor, factor, cv::INTER_NEAREST);
    constexpr int margin = 16, square = 16, line = 26, text_width = 170;
    const int rows = static_cast<int>(counts.size()) * line;
    cv::Mat sheet(std::max(map.rows, rows) + 2 * margin, map.cols + 4 * margin + text_width, CV_8UC3, sheet_color);
    map.copyTo(sheet(cv::Rect(margin, margin, map.cols, map.rows)));
    std::vector<Text> texts;
    const double all = std::max(1, cv::countNonZero(bytes));
    for (std::size_t i = 0; i < counts.size(); i++) {
        const cv::Rect box(2 * margin + map.cols, margin + static_cast<int>(i) * line, square, square);
        sheet(box).setTo(classes[i].color);
        cv::rectangle(sheet, box, ink, 1);
        texts.push_back({text("%s %.1f %%", classes[i].name, 100 * counts[i] / all), {box.x + line, box.y + square / 2}});
    }
    typeset(sheet, texts);
    return sheet;
}

std::vector<Line> summary(const Whole &whole)
{
    std::string pixels;
    const double all = std::max(1, cv::countNonZero(whole.classes));
    for (const Class &one : classes) {
        if (one.number == OFC_SURFACE_DOUBTFUL)
            break;
        pixels += text("%s%.1f %% %s", pixels.empty() ? "" : ", ", 100 * whole.result.class_counts[one.number] / all, one.name);
    }
    std::vector<Line> lines = {{"surface", pixels}};
    for (const ofc_surface_light &light : whole.result.lights) {
        if (!has_direction(light))
            continue;
        const double tilt = degrees(std::atan2(light.direction[1], light.direction[0]));
        const double slant = degrees(std::acos(std::min(1.0, light.direction[2])));
        std::string line = text("tilt %7.2f  slant %5.2f", tilt, slant);
        line += has_color(light) ? text("  color %5.1f %5.1f %5.1f", light.color[0], light.color[1], light.color[2])
                                 : std::string("  color not known: its shadow is interpolated");
        lines.push_back({lines.size() == 1 ? "lights" : "", line});
    }
    if (lines.size() == 1)
        lines.push_back({"lights", "no shadow shows where one is"});
    return lines;
}

nlohmann::ordered_json report(const Whole &whole)
{
    nlohmann::ordered_json report, lights = nlohmann::ordered_json::array();
    for (const Class &one : classes)
        if (one.number != OFC_SURFACE_DOUBTFUL)
            report["pixels"][one.name] = whole.result.class_counts[one.number];
    report["pixels"]["mirror image doubtful"] = cv::countNonZero(whole.classes & OFC_SURFACE_DOUBTFUL);
    const char *const sources[] = {"not known", "directions", "search", "rejected"};
    for (const ofc_surface_light &light : whole.result.lights)
        if (has_direction(light))
            lights.push_back({{"direction", light.direction},
                              {"color", has_color(light) ? nlohmann::ordered_json(light.color) : nullptr},
                              {"color_from", sources[has_color(light) ? light.dual_source & 3 : 0]}});
    report["lights"] = lights;
    report["border_gap_deg"] = degrees(whole.result.border_gap_rad);
    report["regions"] = whole.result.regions;
    return report;
}
