// The two plots of the overview, after Figures 4(a) and 6(b) of the paper.
#pragma once

#include "common/draw.hpp"
#include "photo/report.hpp"

// f(sigma1) on the eight branches of eqs. 25, with the solutions marked; S is the chosen one.
cv::Mat plot_curves(const Result &result, cv::Size size);

// Colors of the picture and the ellipsoid fitted to them.
cv::Mat plot_colors(const Picture &picture, const Result &result, cv::Size size);
