#include "common/normal_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace {

// Eight bits, filters and compression leave lengths within these; what is shorter than `nothing` is gray, and says that nothing is there.
constexpr double nothing = 0.1, shortest = 0.8, longest = 1.25;
// Half of the lengths of a normal map are closer to 1.
constexpr double most_deviation = 0.15;

double median_of(std::vector<float> &values)
{
    if (values.empty())
        return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

struct Lengths {
    double median = 0;    // of all that are not empty
    double deviation = 1; // the median of how far they are from 1, or with floats, which may be of any length, from their median
};

Lengths lengths_of(const cv::Mat &vectors, bool of_any_length)
{
    std::vector<float> all;
    for (const cv::Vec3f &v : cv::Mat_<cv::Vec3f>(vectors)) {
        const double length = cv::norm(v);
        if (length > (of_any_length ? 0 : nothing) && std::isfinite(length))
            all.push_back(static_cast<float>(length));
    }
    if (all.empty())
        return {};
    const double median = median_of(all), unit = of_any_length ? median : 1;
    for (float &length : all)
        length = static_cast<float>(std::abs(length / unit - 1));
    return {median, median_of(all)};
}

// Undoes the curve of sRGB in what was stored as a share of full scale.
cv::Mat through_srgb(const cv::Mat &shares)
{
    cv::Mat light = shares.clone();
    for (float *value = light.ptr<float>(); value != light.ptr<float>() + 3 * light.total(); value++)
        *value = *value <= 0.04045F ? *value / 12.92F : std::pow((*value + 0.055F) / 1.055F, 2.4F);
    return light;
}

// (n + 1) / 2 as x, y, z; zero where the picture is black.
cv::Mat vectors_of(const cv::Mat &shares)
{
    cv::Mat vectors(shares.size(), CV_32FC3);
    for (int y = 0; y < shares.rows; y++)
        for (int x = 0; x < shares.cols; x++) {
            const cv::Vec3f bgr = shares.at<cv::Vec3f>(y, x);
            vectors.at<cv::Vec3f>(y, x) =
                bgr == cv::Vec3f() ? cv::Vec3f() : cv::Vec3f(2 * bgr[2] - 1, 2 * bgr[1] - 1, 2 * bgr[0] - 1);
        }
    return vectors;
}

// How far the field is from one of slopes, over the sizes of the differences it is made of: the median of |dp/dy - dq/dx| over that of
// |dp/dy| + |dq/dx|, with q as it is and turned around. On a surface the first is small.
struct Curls {
    double as_it_is, y_turned;
};

Curls curls_of(const cv::Mat &normals)
{
    // Differences over some pixels, smoothed: eight bits are coarse.
    cv::Mat p(normals.size(), CV_32F, cv::Scalar(0)), q = p.clone(), known(normals.size(), CV_32F, cv::Scalar(0));
    for (int y = 0; y < normals.rows; y++)
        for (int x = 0; x < normals.cols; x++) {
            const cv::Vec3f n = normals.at<cv::Vec3f>(y, x);
            if (std::abs(n[2]) < 0.2F)
                continue;
            p.at<float>(y, x) = -n[0] / n[2];
            q.at<float>(y, x) = -n[1] / n[2];
            known.at<float>(y, x) = 1;
        }
    constexpr int reach = 2;
    const cv::Size window(2 * reach + 1, 2 * reach + 1);
    cv::Mat whole;
    cv::boxFilter(known, whole, -1, window);
    cv::boxFilter(p, p, -1, window);
    cv::boxFilter(q, q, -1, window);
    std::vector<float> as_it_is, turned, size;
    for (int y = reach; y + reach < normals.rows; y++)
        for (int x = reach; x + reach < normals.cols; x++) {
            bool is_whole = true;
            for (const cv::Point step : {cv::Point(reach, 0), cv::Point(-reach, 0), cv::Point(0, reach), cv::Point(0, -reach)})
                is_whole = is_whole && whole.at<float>(cv::Point(x, y) + step) > 0.999F;
            if (!is_whole)
                continue;
            // y grows upward, rows downward.
            const float p_by_y = p.at<float>(y - reach, x) - p.at<float>(y + reach, x);
            const float q_by_x = q.at<float>(y, x + reach) - q.at<float>(y, x - reach);
            as_it_is.push_back(std::abs(p_by_y - q_by_x));
            turned.push_back(std::abs(p_by_y + q_by_x));
            size.push_back(std::abs(p_by_y) + std::abs(q_by_x));
        }
    const double all = std::max(median_of(size), 1e-12);
    return {median_of(as_it_is) / all, median_of(turned) / all};
}

// Whether no slope goes left and none goes down, as in a photograph, whose numbers have no sign.
bool leans_one_way(const cv::Mat &vectors, double length)
{
    std::vector<cv::Mat> xyz;
    cv::split(vectors, xyz);
    double lowest[2], highest[2];
    for (int c = 0; c < 2; c++)
        cv::minMaxLoc(xyz[static_cast<std::size_t>(c)], &lowest[c], &highest[c]);
    return lowest[0] >= 0 && lowest[1] >= 0 && std::max(highest[0], highest[1]) > 0.2 * length;
}

std::string number(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", value);
    return text;
}

} // namespace

NormalMap read_normal_map(const std::string &path, const NormalMapOptions &options)
{
    const ImageFile file = read_image_file(path);
    NormalMap map;
    map.words = file.in_words();
    cv::Mat colors = file.pixels, outside;
    if (colors.channels() == 4) {
        cv::Mat alpha;
        cv::extractChannel(colors, alpha, 3);
        outside = alpha == 0;
        cv::cvtColor(colors, colors, cv::COLOR_BGRA2BGR);
        map.words += "; what is transparent has no normal";
    }
    const int depth = colors.depth();
    if (colors.channels() != 3 || (depth != CV_8U && depth != CV_16U && depth != CV_32F))
        throw UsageError(path + " is neither a TIFF of 3 x 32-bit floats nor a color picture of 8 or 16 bits a channel");
    cv::Mat vectors;
    if (depth == CV_32F) {
        vectors = first_and_third_swapped(colors);
    } else {
        cv::Mat shares;
        colors.convertTo(shares, CV_32F, 1.0 / (depth == CV_8U ? 255 : 65535));
        vectors = vectors_of(options.transfer == "srgb" ? through_srgb(shares) : shares);
        if (options.transfer != "srgb" && lengths_of(vectors, false).deviation > most_deviation &&
            lengths_of(vectors_of(through_srgb(shares)), false).deviation < most_deviation)
            map.doubts.push_back("its vectors have length 1 only after the curve of sRGB is undone: give --transfer srgb");
    }
    cv::patchNaNs(vectors, 0);
    if (!outside.empty())
        vectors.setTo(cv::Scalar::all(0), outside);
    const bool is_float = depth == CV_32F;
    const Lengths lengths = lengths_of(vectors, is_float);
    if (lengths.median == 0)
        throw UsageError(path + " holds no normal: it is black, zero or transparent everywhere");
    // A photograph's colors are vectors of many lengths, and of floats they have no sign.
    if (!is_float && lengths.deviation > most_deviation && map.doubts.empty())
        throw UsageError(path + " is not a normal map: half of its vectors have lengths that are off by more than " +
                         std::to_string(static_cast<int>(100 * lengths.deviation)) + " %");
    if (is_float && leans_one_way(vectors, lengths.median))
        throw UsageError(path + " is not a normal map: no x and no y of it is negative");
    std::size_t left_out = 0, kept = 0, inward = 0;
    for (int y = 0; y < vectors.rows; y++)
        for (int x = 0; x < vectors.cols; x++) {
            cv::Vec3f &v = vectors.at<cv::Vec3f>(y, x);
            const double length = cv::norm(v);
            if (!is_float && map.doubts.empty() && !(length > shortest && length < longest)) {
                left_out += length > 0;
                v = {};
            }
            if (cv::norm(v) == 0)
                continue;
            if (options.y_down)
                v[1] = -v[1];
            if (options.z_inward)
                v[2] = -v[2];
            inward += v[2] < 0;
            kept++;
        }
    if (left_out > 0)
        map.words += "; " + std::to_string(left_out) + " vectors are far from length 1, and no normals";
    if (inward > kept / 2)
        map.doubts.push_back("its z points into the scene at " + std::to_string(100 * inward / kept) + " % of the pixels: give --z-inward");
    const Curls curls = curls_of(vectors);
    if (curls.y_turned < 0.5 * curls.as_it_is && curls.as_it_is > 0.3)
        map.doubts.push_back(std::string("its slopes are those of a surface only with y turned around (curl ") + number(curls.y_turned) +
                             " against " + number(curls.as_it_is) + " of all change): give " +
                             (options.y_down ? "no --y-down" : "--y-down"));
    map.normals = vectors;
    return map;
}
