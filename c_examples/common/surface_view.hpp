// Surfaces for the eye.
#pragma once

#include "common/surface.hpp"

// The surface seen from the front, the right and above, lit from there, in parallel projection.
cv::Mat mesh_picture(const Surface &surface, cv::Size size);
