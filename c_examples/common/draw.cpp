#include "common/draw.hpp"

#include <opencv2/imgproc.hpp>

void put_text(cv::Mat &image, const std::string &text, cv::Point at, double scale, cv::Scalar color)
{
    cv::putText(image, text, at, font, scale, color, 1, cv::LINE_AA);
}
