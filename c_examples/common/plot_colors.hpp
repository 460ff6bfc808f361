// Figure 6(b) of the paper: the colors of a picture and the ellipsoid of the regression.
#pragma once

#include "common/picture.hpp"

// The colors of inliers (CV_8U), those of the other pixels, and the ellipsoid that was fitted, if there is one.
cv::Mat plot_colors(const Picture &picture, const ofc_solution &solution, const cv::Mat &inliers, cv::Size size);
