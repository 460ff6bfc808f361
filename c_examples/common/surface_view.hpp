// Surfaces for the eye.
#pragma once

#include "common/surface.hpp"

// Depth in the colors of Viridis, dark where there is none, with a bar that says which color is which depth.
cv::Mat depth_picture(const Surface &surface, const std::string &unit);

// The colors alone.
cv::Mat depth_colors(const Surface &surface);

// The surface seen from the front, the right and above, lit from there, in parallel projection.
cv::Mat mesh_picture(const Surface &surface, cv::Size size);
