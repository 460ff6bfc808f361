#include "photo/doubt.hpp"

#include "photo/text.hpp"
#include "photo/trust.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace {

// Pictures are thinned to so many pixels: a doubt needs no more.
constexpr std::size_t most_pixels = 400000;
constexpr int sample_size = 8192;

// An offset's squared length by its covariance beyond which it is there, and beyond which it is spoken of: the covariance knows what
// is alike in neighbors, and not that a model may be wrong as a whole.
constexpr double chi_squared_of_one = 16.3, chi_squared_to_speak = 60, gain_to_speak = 0.5;

// What is linear fits worse as sRGB, mostly by far, and what is sRGB better.
constexpr double much_better = 0.85, much_worse = 1.5;
// And then the model explains the colors, where a gel or a near light looks like a curve too.
constexpr double down_to_noise = 1.3;
// What is as likely as not counts by half, in squares.
const double half = std::sqrt(0.5);

struct Solved {
    ofc_status status;
    ofc_solution solution;
};

Solved solve_quietly(const Picture &picture, ofc_solve_params params)
{
    params.lmeds.saturation = picture.saturation;
    const ofc_image image = picture.view();
    ofc::Workspace workspace(ofc_solve_workspace_size(image.width, image.height, &params));
    Solved solved = {};
    solved.status = ofc_solve(&image, &params, workspace.data(), workspace.bytes(), nullptr, &solved.solution);
    return solved;
}

// The fit to a picture's own inliers, and whether there is one.
bool fit_offset(const Picture &picture, const Solved &solved, ofc_offset &found)
{
    if (solved.status < 0 || solved.solution.ellipsoid.norms[0] <= 0)
        return false;
    const double *const c = solved.solution.ellipsoid.c;
    const double coefficients[] = {c[0], c[4], c[8], c[1], c[2], c[5]};
    const ofc_image image = picture.view();
    ofc::Workspace workspace(ofc_offset_workspace_size(sample_size));
    return ofc_offset_fit(&image, &solved.solution.inlier_test, coefficients, sample_size, workspace.data(), workspace.bytes(),
                          &found) == OFC_STATUS_OK;
}

// What nearly no pixel of the mask is darker than, a channel.
cv::Vec3d darkest(const Picture &picture)
{
    cv::Vec3d level;
    for (int c = 0; c < 3; c++) {
        cv::Mat values;
        picture.channel(c).convertTo(values, CV_32F);
        if (!picture.mask.empty())
            values.setTo(std::nan(""), picture.mask == 0);
        // Black is nothing to measure.
        values.setTo(std::nan(""), values <= 0);
        level[c] = quantile(values, 0.01);
    }
    return level;
}

cv::Mat normals_by(const Picture &picture, const ofc_solution &solution)
{
    const ofc_image image = picture.view();
    cv::Mat normals(picture.size(), CV_32FC3, cv::Scalar());
    return ofc_normals_compute(&image, &solution, normals.ptr<float>(), normals.step) == OFC_STATUS_OK ? normals : cv::Mat();
}

// The angle between two maps of normals in degrees, NaN where one has none.
cv::Mat angles(const cv::Mat &a, const cv::Mat &b)
{
    cv::Mat angle(a.size(), CV_32F);
    for (int y = 0; y < a.rows; y++)
        for (int x = 0; x < a.cols; x++) {
            const cv::Vec3d n = a.at<cv::Vec3f>(y, x), m = b.at<cv::Vec3f>(y, x);
            const double lengths = cv::norm(n) * cv::norm(m);
            angle.at<float>(y, x) =
                lengths > 0 ? static_cast<float>(degrees(std::acos(std::clamp(n.dot(m) / lengths, -1.0, 1.0)))) : std::nanf("");
        }
    return angle;
}

// How far the colors are from their ellipsoid, over their noise by neighbors.
double misfit(const Picture &picture, const Solved &solved)
{
    ofc_offset found;
    return fit_offset(picture, solved, found) && found.noise > 0 ? found.deviation_around_black / found.noise : HUGE_VAL;
}

// Widens the uncertainty of every normal by the angle that it would turn by.
void widen(Result &result, const cv::Mat &angle)
{
    if (result.uncertainty.empty())
        return;
    cv::Mat full;
    cv::resize(angle, full, result.uncertainty.size(), 0, 0, cv::INTER_NEAREST);
    const float median = static_cast<float>(quantile(angle, 0.5));
    for (int y = 0; y < full.rows; y++)
        for (int x = 0; x < full.cols; x++) {
            float &sigma = result.uncertainty.at<float>(y, x);
            const float doubt = full.at<float>(y, x);
            sigma = std::hypot(sigma, std::isfinite(doubt) ? doubt : median);
        }
}

// Adds what may be otherwise, given the picture as it would be then, and how much of the turn counts as an error.
void add(Result &result, const Picture &as_it_is, const Solved &is, const Picture &otherwise, const ofc_solve_params &params,
         const std::string &words, double share = 1)
{
    const Solved other = solve_quietly(otherwise, params);
    if (is.status != OFC_STATUS_OK || other.status != OFC_STATUS_OK)
        return;
    const cv::Mat a = normals_by(as_it_is, is.solution), b = normals_by(otherwise, other.solution);
    if (a.empty() || b.empty())
        return;
    const cv::Mat angle = angles(a, b);
    const double turn = quantile(angle, 0.5);
    if (!std::isfinite(turn))
        return;
    widen(result, share * angle);
    result.doubts.push_back({words, turn, share * turn});
}

} // namespace

std::string Ambient::in_words() const
{
    if (status != OFC_STATUS_OK)
        return "no offset could be fitted: nothing was subtracted";
    const std::string numbers = text("%.1f %.1f %.1f, each within %.1f", offset[0], offset[1], offset[2],
                                     std::max({sigma[0], sigma[1], sigma[2]}));
    return is_found ? "an offset of " + numbers + " was found and subtracted" : "no offset is told from none (" + numbers + "): nothing was subtracted";
}

nlohmann::ordered_json Ambient::report() const
{
    return {{"found", is_found}, {"offset", {offset[0], offset[1], offset[2]}}, {"sigma", {sigma[0], sigma[1], sigma[2]}}, {"chi_squared", chi_squared}, {"gain", gain}};
}

Ambient fit_ambient(const Picture &picture, const ofc_solve_params &params, int rounds)
{
    const Picture thin = thinned(picture, most_pixels);
    Ambient ambient;
    cv::Vec3d step;
    double noise = 0;
    for (int round = 0; round < rounds; round++) {
        const Picture left = round == 0 ? thin : less(thin, ambient.offset);
        ofc_offset found;
        if (!fit_offset(left, solve_quietly(left, params), found)) {
            ambient.status = OFC_STATUS_UNDETERMINED;
            return ambient;
        }
        if (round == 0) {
            ambient.chi_squared = found.chi_squared;
            // What the center explains, over what it leaves beyond noise.
            const double before = found.deviation_around_black * found.deviation_around_black, after = found.deviation * found.deviation;
            ambient.gain = (before - after) / std::max(after - 1.2 * found.noise * found.noise, 0.05 * before);
        }
        noise = found.noise;
        step = cv::Vec3d(found.offset);
        ambient.offset += step;
        for (int c = 0; c < 3; c++)
            ambient.sigma[c] = std::sqrt(found.covariance[4 * c]);
        if (cv::norm(step) < cv::norm(ambient.sigma) / 2)
            break;
    }
    // Where the rounds have not come together, they know no better than their last step.
    for (int c = 0; c < 3; c++)
        ambient.sigma[c] = std::hypot(ambient.sigma[c], rounds > 1 ? step[c] : 0);
    const cv::Vec3d dark = darkest(thin);
    bool is_possible = true;
    for (int c = 0; c < 3; c++)
        is_possible = is_possible && ambient.offset[c] > -2 * ambient.sigma[c] && ambient.offset[c] < 1.05 * dark[c] + 3 * (ambient.sigma[c] + noise);
    ambient.is_found = is_possible && ambient.chi_squared > chi_squared_of_one;
    ambient.is_plain = ambient.is_found && ambient.chi_squared > chi_squared_to_speak && ambient.gain > gain_to_speak;
    return ambient;
}

void add_doubts(Result &result, const Picture &picture, const LightOptions &options, const ofc_solve_params &params)
{
    const Picture thin = thinned(picture, most_pixels);
    const Solved is = solve_quietly(thin, params);
    if (options.transfer.empty()) {
        FileTransfer transfer = picture.facts.transfer;
        using Kind = FileTransfer::Kind;
        if (transfer.kind == Kind::srgb || transfer.kind == Kind::curve) {
            const char *const name = transfer.kind == Kind::srgb ? "sRGB" : "a curve";
            add(result, thin, is, linearized(thin, transfer), params,
                text("%s says that it holds %s, and it was taken for linear: --transfer file undoes it, --transfer linear rules it out",
                     transfer.source.c_str(), name));
        } else if (transfer.kind == Kind::unsaid && picture.pixels.depth() != CV_32F) {
            const Picture undone = linearized(thin, {Kind::srgb, "", 2.2, {}});
            const double straight = misfit(thin, is), bent = misfit(undone, solve_quietly(undone, params));
            result.input["transfer"]["misfit"] = {{"as_it_is", straight}, {"as_srgb", bent}};
            if (bent < much_better * straight && bent < down_to_noise)
                add(result, thin, is, undone, params,
                    "the colors fit better as sRGB, and were taken for linear: --transfer srgb undoes it, --transfer linear rules it out");
            else if (bent < much_worse * straight)
                add(result, thin, is, undone, params,
                    "neither the file nor its colors tell whether it holds sRGB, and it was taken for linear: --transfer srgb or linear says it",
                    half);
        }
    }
    if (options.ambient == "none" && options.dark.empty() && result.doubts.empty()) {
        const Ambient ambient = fit_ambient(picture, params, 2);
        result.input["offset"] = ambient.report();
        if (ambient.is_plain)
            add(result, thin, is, less(thin, ambient.offset), params,
                text("an offset of about %.0f %.0f %.0f, as of room light, would explain these colors better: --ambient fit subtracts it, "
                     "--dark does so better",
                     ambient.offset[0], ambient.offset[1], ambient.offset[2]));
    }
}
