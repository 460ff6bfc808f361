#include "common/picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace {

// Whether ofc has a format for the samples of a Mat.
bool is_known(const cv::Mat &pixels)
{
    return pixels.depth() == CV_8U || pixels.depth() == CV_16U || pixels.depth() == CV_32F;
}

// The gray values of a picture: its mean color where it has one, as a gray photograph that was saved in color has.
cv::Mat gray_of(const cv::Mat &pixels)
{
    cv::Mat gray = pixels;
    if (pixels.channels() > 1)
        cv::cvtColor(pixels, gray, pixels.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
    return gray;
}

// Where the alpha channel is at least half of what is opaque; empty where there is none or all is opaque.
cv::Mat opaque(const cv::Mat &pixels, const std::string &path)
{
    if (pixels.channels() != 4)
        return {};
    cv::Mat alpha;
    cv::extractChannel(pixels, alpha, 3);
    const double full = pixels.depth() == CV_8U ? 255 : pixels.depth() == CV_16U ? 65535 : 1;
    const cv::Mat inside = alpha >= full / 2;
    const int count = cv::countNonZero(inside);
    if (count == 0)
        throw UsageError(path + " is empty: its alpha channel is transparent everywhere");
    return static_cast<std::size_t>(count) == inside.total() ? cv::Mat() : inside;
}

} // namespace

// imread takes a file's channels 0, 1, 2 for r, g, b and swaps them.
cv::Mat first_and_third_swapped(const cv::Mat &image)
{
    cv::Mat swapped;
    cv::cvtColor(image, swapped, cv::COLOR_BGR2RGB);
    return swapped;
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
    ImageFile file = read_image_file(path);
    Picture picture;
    picture.pixels = file.pixels;
    picture.facts = file.facts;
    if (picture.pixels.channels() < 3)
        throw UsageError(path + " is grayscale: ofc needs a color picture, or three grayscale ones with --planes");
    if (!is_known(picture.pixels))
        throw UsageError(path + " is neither of 8 nor 16 bits nor of 32-bit floats a channel");
    if (const cv::Mat inside = opaque(picture.pixels, path); !inside.empty()) {
        picture.mask = inside;
        file.notes.push_back("its alpha channel is the mask where no other is given");
    }
    picture.words = file.in_words();
    return picture;
}

Picture read_planes(const std::string &red, const std::string &green, const std::string &blue)
{
    Picture picture;
    const auto plane = [&](const std::string &path) {
        const ImageFile file = read_image_file(path);
        picture.facts = file.facts;
        picture.words = file.in_words() + ", three planes";
        const cv::Mat gray = gray_of(file.pixels);
        return gray.isContinuous() ? gray : gray.clone(); // one stride for all three
    };
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

cv::Mat read_mask(const std::string &path, cv::Size size, int orientation)
{
    const ImageFile file = read_image_file(path);
    cv::Mat colors = file.pixels;
    if (colors.size() != size && orientation >= 5 && cv::Size(colors.rows, colors.cols) == size && file.facts.orientation == 1)
        colors = upright(colors, orientation);
    if (colors.size() != size)
        throw UsageError("the mask is " + size_text(file.pixels.size()) + ", the picture " + size_text(size));
    std::vector<cv::Mat> channels;
    cv::split(colors, channels);
    cv::Mat inside = cv::Mat::zeros(size, CV_8U);
    double brightest = 0;
    cv::minMaxLoc(colors.reshape(1), nullptr, &brightest);
    for (std::size_t c = 0; c < std::min<std::size_t>(channels.size(), 3); c++)
        inside |= file.facts.is_jpeg ? channels[c] >= 0.5 * std::max(brightest, 2.0) : channels[c] != 0;
    if (channels.size() == 4) {
        // Drawn in black on nothing, or in color on nothing.
        const cv::Mat drawn = channels[3] != 0;
        if (cv::countNonZero(inside) == 0)
            drawn.copyTo(inside);
        else
            inside &= drawn;
    }
    if (cv::countNonZero(inside) == 0)
        throw UsageError("the mask " + path + " is empty: all its pixels are zero");
    return inside;
}

cv::Mat read_normals_tiff(const std::string &path, cv::Size size)
{
    const cv::Mat zyx = read_image_file(path).pixels;
    if (zyx.type() != CV_32FC3)
        throw UsageError(path + " is not a TIFF of 3 x 32-bit floats");
    if (zyx.size() != size)
        throw UsageError("the true normals are " + size_text(zyx.size()) + ", the picture " + size_text(size));
    return first_and_third_swapped(zyx);
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

cv::Mat shade(const cv::Mat &normals, const cv::Vec3d &light)
{
    const cv::Vec3d direction = cv::normalize(light);
    cv::Mat image = cv::Mat::zeros(normals.size(), CV_8U);
    for (int y = 0; y < normals.rows; y++)
        for (int x = 0; x < normals.cols; x++)
            image.at<uchar>(y, x) = cv::saturate_cast<uchar>(255 * direction.dot(cv::Vec3d(normals.at<cv::Vec3f>(y, x))));
    return image;
}
