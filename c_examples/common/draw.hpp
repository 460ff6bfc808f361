// What all drawings share.
#pragma once

#include <opencv2/core.hpp>
#include <string>

constexpr int font = 0; // cv::FONT_HERSHEY_SIMPLEX

// Text with its baseline at `at`.
void put_text(cv::Mat &image, const std::string &text, cv::Point at, double scale, cv::Scalar color);
