// How far to trust a result.
#pragma once

#include "photo/result.hpp"

// The value that this share of the finite ones is below; NaN where there are none.
double quantile(const cv::Mat &values, double share);

// The share of the surface's outline, from 0 to 1, at which the surface goes on: at the frame of the picture, or at the mask
// where it does not turn away from the camera. NaN without an outline.
double open_outline(const cv::Mat &mask, const cv::Mat &inliers, const cv::Mat &normals);

// How far to trust the normals, in plain words: what error is to be expected or that it is not known, what decided, and
// whether the picture can tell a convex surface from a hollow one.
// How far the normals are expected to be off as a whole, in degrees: what the solution knows, and what may be otherwise.
double error_as_a_whole(const Result &result);

std::string trust(const Result &result);
