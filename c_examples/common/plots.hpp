// The two plots of a solution, after Figures 4(a) and 6(b) of the paper.
#pragma once

#include "common/picture.hpp"

// f(sigma1) on the eight branches of eqs. 25, with the solutions marked; S is the chosen one.
cv::Mat plot_curves(const ofc_solution &solution, cv::Size size);

// Colors of the picture, those of inliers (CV_8U) apart from the others, and the ellipsoid fitted to them.
cv::Mat plot_colors(const Picture &picture, const ofc_solution &solution, const cv::Mat &inliers, cv::Size size);
