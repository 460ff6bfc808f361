#include "common/channels.hpp"

#include "common/draw.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace {

// Gray levels by rank: as much of the inliers in every range of levels. Black elsewhere.
cv::Mat equalized(const cv::Mat &values, const cv::Mat &inliers)
{
    std::vector<float> sorted;
    for (int y = 0; y < values.rows; y++)
        for (int x = 0; x < values.cols; x++)
            if (inliers.at<uchar>(y, x))
                sorted.push_back(values.at<float>(y, x));
    std::sort(sorted.begin(), sorted.end());
    cv::Mat gray = cv::Mat::zeros(values.size(), CV_8U);
    for (int y = 0; y < values.rows; y++)
        for (int x = 0; x < values.cols; x++)
            if (inliers.at<uchar>(y, x)) {
                const auto below = std::upper_bound(sorted.begin(), sorted.end(), values.at<float>(y, x)) - sorted.begin();
                gray.at<uchar>(y, x) =
                    cv::saturate_cast<uchar>(255.0 * static_cast<double>(below) / static_cast<double>(sorted.size()));
            }
    return gray;
}

cv::Mat relit(const cv::Mat &normals, const cv::Vec3d &f)
{
    cv::Mat brightness(normals.size(), CV_32F);
    for (int y = 0; y < normals.rows; y++)
        for (int x = 0; x < normals.cols; x++)
            brightness.at<float>(y, x) = static_cast<float>(std::max(0.0, f.dot(cv::Vec3d(normals.at<cv::Vec3f>(y, x)))));
    return brightness;
}

} // namespace

cv::Mat channels_picture(const Picture &picture, const cv::Mat &inliers, const cv::Mat &normals, const double (&f)[9],
                         const double (&correlation)[3])
{
    constexpr int gap = 16, title_height = 34, width = 300;
    // What surrounds the object is left away.
    cv::Rect part = cv::boundingRect(inliers);
    if (part.empty())
        part = cv::Rect(cv::Point(), inliers.size());
    const double scale = std::min(static_cast<double>(width) / part.width, static_cast<double>(width) / part.height);
    const cv::Size cell(std::max(1, cvRound(part.width * scale)), std::max(1, cvRound(part.height * scale)));
    cv::Mat sheet(2 * (title_height + cell.height) + gap, 3 * (width + gap) + gap, CV_8UC3, sheet_color);
    std::vector<Text> texts;
    for (int c = 0; c < 3; c++) {
        cv::Mat input;
        picture.channel(c).convertTo(input, CV_32F);
        const cv::Mat output = relit(normals, {f[3 * c], f[3 * c + 1], f[3 * c + 2]});
        const std::string name(1, "RGB"[c]);
        const std::string titles[2] = {std::string("(") + "abc"[c] + ") " + name + ", input × inliers",
                                       name + ", lit from f" + std::string(1, "123"[c]) + ", correlation " +
                                           number(correlation[c], 1e-4)};
        for (int row = 0; row < 2; row++) {
            cv::Mat gray = equalized(row == 0 ? input : output, inliers)(part), image;
            cv::resize(gray, gray, cell, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_NEAREST);
            cv::cvtColor(gray, image, cv::COLOR_GRAY2BGR);
            const cv::Point corner(gap + c * (width + gap), row * (title_height + cell.height) + title_height);
            image.copyTo(sheet(cv::Rect(corner + cv::Point((width - cell.width) / 2, 0), cell)));
            texts.push_back({titles[row], corner + cv::Point(width / 2, -title_height / 2), 11, ink, Text::Align::center});
        }
    }
    typeset(sheet, texts);
    return sheet;
}
