// ofc::opencv sees regions of interest, masks and every type of Mat that ofc has a format for.
#include <ofc.hpp>
#include <opencv2/core.hpp>
// Once more, because OpenCV was not there before.
#include <ofc.hpp>

#include "scene.hpp"

namespace {

// The ball in the middle of a larger Mat that is not black.
cv::Mat framed(const cv::Mat &ball)
{
    cv::Mat large(height + 20, width + 30, ball.type(), cv::Scalar::all(77));
    cv::Mat region = large(cv::Rect(13, 7, width, height));
    ball.copyTo(region);
    return region;
}

// Whether the pixels of the view are those of the Mat, in the order r, g, b.
bool solves_alike(const ofc_image &view, const ofc_solution &expected)
{
    return same_bits(ofc::solve(view).orientation, expected.orientation);
}

} // namespace

int main()
{
    std::vector<std::uint8_t> pixels = ball();
    const ofc_image photo = ofc::image(pixels.data(), width, height, 3 * width, OFC_PIXEL_RGB8);
    const ofc_solution expected = ofc::solve(photo);
    const ofc::Array<float, 3> normals = ofc::normals(photo, expected);

    cv::Mat channels[3], bgr, bgra;
    cv::split(cv::Mat(height, width, CV_8UC3, pixels.data()), channels);
    cv::merge(std::vector<cv::Mat>{channels[2], channels[1], channels[0]}, bgr);
    cv::merge(std::vector<cv::Mat>{channels[2], channels[1], channels[0], channels[1]}, bgra);

    const cv::Mat region = framed(bgr);
    EXPECT(!region.isContinuous());
    const ofc_image view = ofc::opencv::image(region);
    EXPECT(view.format == OFC_PIXEL_BGR8 && view.width == width && view.height == height);
    EXPECT(solves_alike(view, expected));
    EXPECT(solves_alike(ofc::opencv::image(framed(bgra)), expected));
    EXPECT(solves_alike(ofc::opencv::planes(channels[0], channels[1], channels[2]), expected));
    for (const int depth : {CV_16U, CV_32F}) {
        cv::Mat converted;
        framed(bgr).convertTo(converted, depth);
        const ofc_image other = ofc::opencv::image(converted);
        EXPECT(other.format == (depth == CV_16U ? OFC_PIXEL_BGR16 : OFC_PIXEL_BGR32F));
        EXPECT(ofc::solve(other).pixel_counts.usable == expected.pixel_counts.usable);
    }

    const cv::Mat found = ofc::opencv::normals(view, expected);
    EXPECT(found.type() == CV_32FC3 && found.isContinuous());
    EXPECT(std::memcmp(found.data, normals.data(), normals.size() * sizeof(float)) == 0);
    const cv::Mat map = ofc::opencv::normal_map(found);
    const cv::Vec3b straight = map.at<cv::Vec3b>(height / 2, width / 2);
    EXPECT(straight[0] > 250 && std::abs(straight[1] - 127) < 4 && std::abs(straight[2] - 127) < 4);
    EXPECT(ofc::opencv::normal_map(cv::Mat(2, 2, CV_32FC3, cv::Scalar::all(0))).at<cv::Vec3b>(1, 1) == cv::Vec3b());

    // OpenCV's threads find the same, in a picture with work for several.
    const cv::Mat balls = cv::repeat(bgr, 9, 1);
    const ofc_parallel parallel = ofc::opencv::parallel();
    cv::Mat in_parts(balls.rows, balls.cols, CV_32FC3);
    ofc::normals(ofc::opencv::image(balls), expected, ofc::opencv::view<float, 3>(in_parts), &parallel);
    EXPECT(std::memcmp(in_parts.data, cv::repeat(found, 9, 1).data, 9 * normals.size() * sizeof(float)) == 0);

    // The left half is masked out, by a mask that is a region itself.
    cv::Mat mask = framed(cv::Mat(height, width, CV_8U, cv::Scalar(1)));
    mask.colRange(0, width / 2) = 0;
    const ofc_solution half = ofc::solve(ofc::opencv::image(region, mask));
    EXPECT(half.pixel_counts.masked_out == width / 2 * height);

    EXPECT(throws(OFC_STATUS_UNKNOWN_FORMAT, [&] { ofc::opencv::image(channels[0]); }));
    EXPECT(throws(OFC_STATUS_UNKNOWN_FORMAT, [&] { ofc::opencv::image(cv::Mat(9, 9, CV_64FC3)); }));
    EXPECT(throws(OFC_STATUS_UNKNOWN_FORMAT, [&] { ofc::opencv::image(region, region); }));
    EXPECT(throws(OFC_STATUS_UNKNOWN_FORMAT, [&] { ofc::opencv::view<float>(region); }));
    EXPECT(throws(OFC_STATUS_UNKNOWN_FORMAT, [&] { ofc::opencv::planes(channels[0], channels[1], region); }));
    EXPECT(throws(OFC_STATUS_UNKNOWN_FORMAT, [&] { ofc::opencv::image(cv::Mat()); }));
    EXPECT(throws(OFC_STATUS_INVALID_PARAMETER, [&] { ofc::opencv::image(region, mask.rowRange(1, height)); }));
    EXPECT(throws(OFC_STATUS_INVALID_PARAMETER,
                  [&] { ofc::opencv::planes(channels[0], channels[1], channels[2].rowRange(1, height)); }));
    return failures == 0 ? 0 : 1;
}
