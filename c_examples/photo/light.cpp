#include "photo/light.hpp"

#include "common/thin.hpp"
#include "photo/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace {

using Kind = FileTransfer::Kind;

// The largest value of a sample, which floats do not have.
double full_scale(const Picture &picture)
{
    return picture.pixels.depth() == CV_8U ? 255 : picture.pixels.depth() == CV_16U ? 65535 : 1;
}

// The level at which the picture saturates; infinite for floats that were not clipped.
double level_of(const Picture &picture)
{
    if (picture.saturation > 0)
        return picture.saturation;
    return picture.pixels.depth() == CV_32F ? HUGE_VAL : full_scale(picture);
}

// Where a channel is saturated.
cv::Mat saturated(const Picture &picture)
{
    cv::Mat where = cv::Mat::zeros(picture.size(), CV_8U);
    if (std::isfinite(level_of(picture)))
        for (int c = 0; c < 3; c++)
            where |= picture.channel(c) >= level_of(picture);
    return where;
}

// A picture of floats r, g, b in place of another's pixels, in which what was saturated still is.
Picture with_pixels(const Picture &from, cv::Mat rgb)
{
    Picture picture = from;
    picture.green.release();
    picture.blue.release();
    cv::cvtColor(rgb, rgb, cv::COLOR_RGB2BGR);
    picture.pixels = rgb;
    const cv::Mat clipped = saturated(from);
    if (cv::countNonZero(clipped) == 0)
        return picture;
    cv::Mat others = rgb.clone();
    others.setTo(cv::Scalar::all(0), clipped);
    cv::patchNaNs(others, 0);
    double largest = 0;
    cv::minMaxLoc(others.reshape(1), nullptr, &largest);
    picture.saturation = std::max(level_of(from), 1.001 * largest);
    picture.pixels.setTo(cv::Scalar::all(picture.saturation), clipped);
    return picture;
}

void check(ofc_status status, const std::string &what)
{
    if (status != OFC_STATUS_OK)
        throw UsageError(what + ": " + ofc_status_message(status));
}

// Of a curve in steps.
double light_of(const std::vector<float> &curve, double stored)
{
    const double at = stored * static_cast<double>(curve.size() - 1);
    const std::size_t below = std::min(static_cast<std::size_t>(at), curve.size() - 2);
    const double share = at - static_cast<double>(below);
    return (1 - share) * curve[below] + share * curve[below + 1];
}

// The light of every stored value of 8 or 16 bits.
std::vector<float> table_of(const FileTransfer &transfer, int depth)
{
    std::vector<float> table(depth == CV_8U ? 256 : 65536);
    if (transfer.kind == Kind::srgb) {
        check(ofc_transfer_table(OFC_TRANSFER_SRGB, 0, static_cast<int32_t>(table.size()), table.data()), "sRGB");
        return table;
    }
    const double full = static_cast<double>(table.size() - 1);
    for (std::size_t i = 0; i < table.size(); i++)
        table[i] = static_cast<float>(full * light_of(transfer.curve, static_cast<double>(i) / full));
    return table;
}

std::string check_transfer(const std::string &name)
{
    try {
        transfer_of(name, {});
        return "";
    } catch (const UsageError &error) {
        return error.what();
    }
}

Picture less_dark(const Picture &light, const Picture &dark, const std::string &name)
{
    const ofc_image with = light.view(), without = dark.view();
    cv::Mat rgb(light.size(), CV_32FC3);
    check(ofc_dark_subtract(&with, &without, rgb.ptr<float>(), rgb.step), name + " is no dark frame of the picture");
    return with_pixels(light, rgb);
}

const char *said_by(const FileTransfer &transfer)
{
    static const char *const names[] = {"nothing", "linear", "sRGB", "a curve"};
    return names[static_cast<int>(transfer.kind)];
}

} // namespace

void LightOptions::add_to(CLI::App &app)
{
    app.add_option("--transfer", transfer,
                   "How the file stores light: linear, srgb, gamma:G, or file for what the file itself says; its opposite is\n"
                   "applied first (default: taken for linear, and doubted where the file says otherwise)")
        ->check(CLI::Validator(check_transfer, ""))
        ->type_name("CURVE");
    app.add_option("--dark", dark, "The same picture with the lights off, to subtract")->check(not_empty)->type_name("DARK.png");
    app.add_option("--ambient", ambient,
                   "Light that is the same on every pixel, as room light or a black level: fit finds it by the colors and\n"
                   "subtracts it (default: none)")
        ->check(CLI::IsMember({"none", "fit"}));
}

FileTransfer transfer_of(const std::string &name, const FileFacts &facts)
{
    if (name == "file")
        return facts.transfer;
    if (name.empty() || name == "linear")
        return {Kind::linear, "--transfer", 1, {}};
    if (name == "srgb")
        return {Kind::srgb, "--transfer", 2.2, {}};
    double gamma = 0;
    const std::string prefix = "gamma:";
    const char *const first = name.data() + std::min(prefix.size(), name.size()), *const end = name.data() + name.size();
    const auto [last, failure] = std::from_chars(first, end, gamma);
    if (name.compare(0, prefix.size(), prefix) != 0 || failure != std::errc() || last != end || !(gamma >= 0.1 && gamma <= 10))
        throw UsageError(name + " is not linear, srgb, file or gamma:G with G from 0.1 to 10");
    FileTransfer transfer = {Kind::curve, "--transfer", gamma, {}};
    for (int i = 0; i < 4096; i++)
        transfer.curve.push_back(static_cast<float>(std::pow(i / 4095.0, gamma)));
    return transfer;
}

Picture linearized(const Picture &picture, const FileTransfer &transfer)
{
    if (transfer.kind == Kind::unsaid || transfer.kind == Kind::linear)
        return picture;
    const ofc_image image = picture.view();
    cv::Mat rgb(picture.size(), CV_32FC3);
    const int depth = picture.pixels.depth();
    ofc_status status;
    if (depth == CV_32F) {
        status = ofc_transfer_linearize(&image, transfer.kind == Kind::srgb ? OFC_TRANSFER_SRGB : OFC_TRANSFER_GAMMA, transfer.gamma,
                                        nullptr, 0, rgb.ptr<float>(), rgb.step);
    } else {
        const std::vector<float> table = table_of(transfer, depth);
        status = ofc_transfer_linearize(&image, OFC_TRANSFER_TABLE, 0, table.data(), static_cast<int32_t>(table.size()),
                                        rgb.ptr<float>(), rgb.step);
    }
    check(status, "the transfer curve");
    return with_pixels(picture, rgb);
}

Picture as_light(const Picture &picture, const LightOptions &options, Steps &steps)
{
    Picture light = picture;
    const FileTransfer &said = picture.facts.transfer;
    if (!picture.words.empty())
        steps.lines.emplace_back("picture", picture.words);
    steps.report["size"] = {picture.size().width, picture.size().height};
    steps.report["orientation"] = picture.facts.orientation;
    steps.report["transfer"] = {{"file_says", said_by(said)}, {"source", said.source}, {"undone", nullptr}};

    const ofc_image image = picture.view();
    double level = 0;
    int32_t count = 0;
    check(ofc_saturation_find(&image, &level, &count), "saturation");
    steps.report["saturation"] = nullptr;
    if (level > 0) {
        light.saturation = level;
        steps.lines.emplace_back("saturation", text("at %.6g, below full scale: %d pixels pile up there and are left out", level, count));
        steps.report["saturation"] = {{"level", level}, {"pixels", count}};
    }
    const FileTransfer asked = transfer_of(options.transfer, picture.facts);
    if (options.transfer == "file" && said.kind == Kind::unsaid)
        throw UsageError("the file does not say how it stores light: give --transfer linear, srgb or gamma:G");
    if (asked.kind == Kind::srgb || asked.kind == Kind::curve) {
        light = linearized(light, asked);
        const std::string what = asked.kind == Kind::srgb ? "sRGB" : text("gamma %.3g", asked.gamma);
        steps.lines.emplace_back("transfer", what + " undone, as " + asked.source + " says");
        steps.report["transfer"]["undone"] = what;
    }
    if (!options.dark.empty()) {
        const Picture dark = linearized(read_picture(options.dark), asked);
        light = less_dark(light, dark, options.dark);
        const cv::Scalar mean = cv::mean(dark.pixels);
        steps.lines.emplace_back("dark frame", text("subtracted; its mean is %.2f %.2f %.2f", mean[2], mean[1], mean[0]));
        steps.report["dark_frame_mean"] = {mean[2], mean[1], mean[0]};
    }
    return light;
}

Picture background_as_light(const Picture &background, const LightOptions &options, const FileFacts &facts)
{
    const FileTransfer transfer = transfer_of(options.transfer, facts);
    const Picture light = linearized(background, transfer);
    return options.dark.empty() ? light : less_dark(light, linearized(read_picture(options.dark), transfer), options.dark);
}

Picture without_saturated(const Picture &picture)
{
    if (!(picture.saturation > 0))
        return picture;
    Picture seen = picture;
    cv::Mat planes[] = {picture.channel(2), picture.channel(1), picture.channel(0)};
    const cv::Mat clipped = saturated(picture);
    for (cv::Mat &plane : planes) {
        plane.convertTo(plane, CV_32F);
        plane.setTo(std::nan(""), clipped);
    }
    cv::merge(planes, 3, seen.pixels);
    seen.green.release();
    seen.blue.release();
    return seen;
}

Picture less(const Picture &picture, const cv::Vec3d &offset)
{
    const ofc_image image = picture.view();
    cv::Mat rgb(picture.size(), CV_32FC3);
    check(ofc_offset_subtract(&image, offset.val, rgb.ptr<float>(), rgb.step), "the offset");
    return with_pixels(picture, rgb);
}

Picture thinned(const Picture &picture, std::size_t most)
{
    const int step = step_to(picture.size(), most);
    Picture few = picture;
    for (cv::Mat *plane : {&few.pixels, &few.green, &few.blue, &few.mask})
        *plane = thin(*plane, step);
    return few;
}
