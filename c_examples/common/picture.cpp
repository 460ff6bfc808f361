#include "common/picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace {

std::string size_text(cv::Size size)
{
    return std::to_string(size.width) + " x " + std::to_string(size.height);
}

// Whether ofc has a format for the samples of a Mat.
bool is_known(const cv::Mat &pixels)
{
    return pixels.depth() == CV_8U || pixels.depth() == CV_16U || pixels.depth() == CV_32F;
}

// imread takes a file's channels 0, 1, 2 for r, g, b and swaps them.
cv::Mat first_and_third_swapped(const cv::Mat &image)
{
    cv::Mat swapped;
    cv::cvtColor(image, swapped, cv::COLOR_BGR2RGB);
    return swapped;
}

} // namespace

cv::Mat read_image(const std::string &path, int flags)
{
    cv::Mat image = cv::imread(path, flags);
    if (image.empty())
        throw UsageError("cannot read " + path + " as an image");
    return image;
}

ofc_image Picture::view() const
{
    return green.empty() ? ofc::opencv::image(pixels, mask) : ofc::opencv::planes(pixels, green, blue, mask);
}

cv::Mat Picture::channel(int index) const
{
    if (!green.empty())
        return index == 0 ? pixels : index == 1 ? green : blue;
    cv::Mat plane;
    cv::extractChannel(pixels, plane, 2 - index);
    return plane;
}

cv::Mat Picture::display() const
{
    cv::Mat bgr;
    cv::merge(std::vector<cv::Mat>{channel(2), channel(1), channel(0)}, bgr);
    cv::Mat shown = cv::Mat::zeros(bgr.size(), bgr.type());
    bgr.copyTo(shown, mask.empty() ? cv::Mat(bgr.size(), CV_8U, cv::Scalar(255)) : mask);
    double brightest = 0;
    cv::minMaxLoc(shown.reshape(1), nullptr, &brightest);
    shown.convertTo(shown, CV_8U, brightest > 0 ? 255 / brightest : 1);
    return shown;
}

Picture read_picture(const std::string &path)
{
    Picture picture;
    picture.pixels = read_image(path, cv::IMREAD_UNCHANGED);
    if (picture.pixels.channels() < 3)
        throw UsageError(path + " is grayscale: ofc needs a color picture, or three grayscale ones with --planes");
    if (!is_known(picture.pixels))
        throw UsageError(path + " is neither of 8 nor 16 bits nor of 32-bit floats a channel");
    return picture;
}

Picture read_planes(const std::string &red, const std::string &green, const std::string &blue)
{
    const auto plane = [](const std::string &path) {
        cv::Mat image = read_image(path, cv::IMREAD_ANYDEPTH | cv::IMREAD_GRAYSCALE);
        return image.isContinuous() ? image : image.clone(); // one stride for all three
    };
    Picture picture;
    picture.pixels = plane(red);
    picture.green = plane(green);
    picture.blue = plane(blue);
    for (const cv::Mat &other : {picture.green, picture.blue})
        if (other.size() != picture.pixels.size() || other.type() != picture.pixels.type())
            throw UsageError("the three planes differ in size or depth: " + size_text(picture.pixels.size()) +
                             " and " + size_text(other.size()));
    if (!is_known(picture.pixels))
        throw UsageError(red + " is neither of 8 nor 16 bits nor of 32-bit floats");
    return picture;
}

cv::Mat read_mask(const std::string &path, cv::Size size)
{
    cv::Mat mask = read_image(path, cv::IMREAD_GRAYSCALE);
    if (mask.size() != size)
        throw UsageError("the mask is " + size_text(mask.size()) + ", the picture " + size_text(size));
    return mask;
}

cv::Mat read_normals_tiff(const std::string &path, cv::Size size)
{
    const cv::Mat zyx = read_image(path, cv::IMREAD_UNCHANGED);
    if (zyx.type() != CV_32FC3)
        throw UsageError(path + " is not a TIFF of 3 x 32-bit floats");
    if (zyx.size() != size)
        throw UsageError("the true normals are " + size_text(zyx.size()) + ", the picture " + size_text(size));
    return first_and_third_swapped(zyx);
}

cv::Mat read_normal_map(const std::string &path)
{
    const cv::Mat colors = read_image(path, cv::IMREAD_UNCHANGED);
    if (colors.type() == CV_32FC3)
        return first_and_third_swapped(colors);
    if (colors.type() != CV_8UC3 && colors.type() != CV_16UC3)
        throw UsageError(path + " is neither a TIFF of 3 x 32-bit floats nor a color picture of 8 or 16 bits a channel");
    cv::Mat normals;
    colors.convertTo(normals, CV_32F, 2.0 / (colors.depth() == CV_8U ? 255 : 65535), -1);
    for (auto n = normals.begin<cv::Vec3f>(); n != normals.end<cv::Vec3f>(); ++n)
        if (*n == cv::Vec3f(-1, -1, -1)) // black
            *n = cv::Vec3f();
    return first_and_third_swapped(normals);
}

std::optional<double> median_angle_deg(const cv::Mat &normals, const cv::Mat &truth)
{
    std::vector<double> angles;
    for (int y = 0; y < normals.rows; y++)
        for (int x = 0; x < normals.cols; x++) {
            const cv::Vec3d n = normals.at<cv::Vec3f>(y, x), t = truth.at<cv::Vec3f>(y, x);
            if (cv::norm(n) > 0 && cv::norm(t) > 0)
                angles.push_back(degrees(std::acos(std::clamp(n.dot(t) / (cv::norm(n) * cv::norm(t)), -1.0, 1.0))));
        }
    if (angles.empty())
        return std::nullopt;
    const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
    std::nth_element(angles.begin(), middle, angles.end());
    return *middle;
}

void write_normals_tiff(const std::string &path, const cv::Mat &normals)
{
    write_tiff(path, first_and_third_swapped(normals)); // imwrite swaps back: the file's samples are x, y, z
}

void write_tiff(const std::string &path, const cv::Mat &floats)
{
    // OpenCV's own choice for three floats is LogLuv, which is lossy, cannot hold a negative number, and which few
    // programs read.
    constexpr int no_compression = 1;
    write_image(path, floats, {cv::IMWRITE_TIFF_COMPRESSION, no_compression});
}

cv::Mat shade(const cv::Mat &normals, const cv::Vec3d &light)
{
    const cv::Vec3d direction = cv::normalize(light);
    cv::Mat image = cv::Mat::zeros(normals.size(), CV_8U);
    for (int y = 0; y < normals.rows; y++)
        for (int x = 0; x < normals.cols; x++)
            image.at<uchar>(y, x) = cv::saturate_cast<uchar>(255 * direction.dot(cv::Vec3d(normals.at<cv::Vec3f>(y, x))));
    return image;
}

void write_image(const std::string &path, const cv::Mat &image, const std::vector<int> &parameters)
{
    bool written = false;
    try {
        written = cv::imwrite(path, image, parameters);
    } catch (const cv::Exception &) {
    }
    if (!written)
        throw std::runtime_error("cannot write " + path);
}
