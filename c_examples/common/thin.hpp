// Large pictures for what needs no more than some of their pixels: numbers that say how they are as a whole, and the eye.
#pragma once

#include <opencv2/core.hpp>

// Every how-many-th row and column to take so that no more than `most` pixels are left.
int step_to(cv::Size size, std::size_t most);

// Every `step`-th row and column of a map, from its first pixel on or from this one.
cv::Mat thin(const cv::Mat &map, int step, cv::Point first = {});
