#include "photo/trust.hpp"

#include "common/thin.hpp"
#include "photo/text.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace {

// Where a surface is turned so far from the camera it ends in a silhouette: 60 degrees.
constexpr float silhouette_n3 = 0.5F;

// Whether the picture tells a convex surface from a hollow one, and what it was taken for.
struct Shape {
    bool is_told; // by the picture or by the caller
    std::string words;
};

Shape shape(const Result &result)
{
    const ofc_convexity given = result.params.convexity;
    if (given == OFC_CONVEXITY_HOLLOW)
        return {true, "hollow, as --hollow says"};
    if (given == OFC_CONVEXITY_CONVEX)
        return {true, "convex, as --convex says"};
    const double clear = result.solution.confidence.convexity;
    // An engraving looks as convex as a relief does where it is lit from the other side. Only a silhouette tells them apart.
    if (result.open_outline > 0.5)
        return {false, "convex or hollow cannot be told, as the surface does not end within the picture: taken for convex, "
                       "--hollow takes it for hollow"};
    if (result.solution.reason == OFC_REASON_CONVEX_OR_HOLLOW)
        return {false, "convex or hollow is a guess: --convex or --hollow says which"};
    return {true, clear > 0.5 ? "clearly convex" : "more convex than concave"};
}

} // namespace

double quantile(const cv::Mat &values, double share)
{
    // A million values say as much as more.
    constexpr std::size_t most = 1000000;
    const cv::Mat few = thin(values, step_to(values.size(), most));
    std::vector<float> finite;
    finite.reserve(few.total());
    for (const float value : cv::Mat_<float>(few))
        if (std::isfinite(value))
            finite.push_back(value);
    if (finite.empty())
        return std::nan("");
    const auto middle = finite.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(finite.size() - 1));
    std::nth_element(finite.begin(), middle, finite.end());
    return *middle;
}

double open_outline(const cv::Mat &mask, const cv::Mat &inliers, const cv::Mat &normals)
{
    // Holes are no ends of the surface, whatever they are.
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(inliers, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    const cv::Rect frame({}, inliers.size());
    int open = 0, sides = 0;
    for (const auto &outline : outlines)
        for (const cv::Point p : outline)
            for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1), cv::Point(-1, 0), cv::Point(0, -1)}) {
                const cv::Point q = p + step;
                const bool is_steep = normals.at<cv::Vec3f>(p)[2] < silhouette_n3;
                const bool is_inside = frame.contains(q);
                if (is_inside && inliers.at<uchar>(q) != 0)
                    continue;
                sides++;
                // Beside a shadow or a highlight the surface may go on or end.
                open += !is_inside || (!is_steep && !mask.empty() && mask.at<uchar>(q) == 0);
            }
    return sides > 0 ? static_cast<double>(open) / sides : std::nan("");
}

double error_as_a_whole(const Result &result)
{
    double error = degrees(result.solution.confidence.error_rad);
    for (const Doubt &doubt : result.doubts)
        error = std::hypot(error, doubt.expected);
    return error;
}

namespace {

std::string trust_without_doubts(const Result &result)
{
    const ofc_confidence &c = result.solution.confidence;
    const auto [is_told, words] = shape(result);
    if (c.evidence == OFC_EVIDENCE_TILTS_ALONE) {
        const char *why = result.params.orientation_method == OFC_ORIENTATION_JOINT
                              ? "the picture is too small for the joint method, and the orientation rests on tilts alone"
                              : "the orientation rests on tilts alone";
        return text("how far the normals are off is not known: %s, good for closed convex shapes; %s", why, words.c_str());
    }
    const double sigma = quantile(result.uncertainty, 0.5);
    if (!std::isfinite(sigma))
        return text("how far the normals are off is not known; %s", words.c_str());
    const char *level = sigma < 5 ? "trust the normals" : sigma < 12 ? "trust the normals roughly" : "do not rely on the normals";
    const char *condition = is_told ? "" : ", if the surface is convex";
    const char *evidence = c.evidence == OFC_EVIDENCE_OUTWARD         ? "from normals that point outward"
                           : c.evidence == OFC_EVIDENCE_INTEGRABILITY ? "from integrability"
                                                                      : "from integrability and normals that point outward";
    // A hundredth as likely.
    const char *second = c.log_likelihood_margin < 4.6 ? "; another is not ruled out" : "";
    return text("%s%s: expected to be off by %.1f degrees, as a whole by %.1f; orientation %s, %s%s", level, condition, sigma,
                error_as_a_whole(result), evidence, words.c_str(), second);
}

} // namespace

std::string trust(const Result &result)
{
    std::string words = trust_without_doubts(result);
    for (const Doubt &doubt : result.doubts)
        words += text("; %s (the normals would turn by %.1f degrees)", doubt.words.c_str(), doubt.turn);
    return words;
}
