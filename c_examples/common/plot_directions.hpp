// Figure 1 of the paper: three directions, the planes of their tilts, and the circles of the angles between them.
#pragma once

#include "common/estimates.hpp"

// (a) unit vectors at these slants and tilts (radians); (b) the plane that each of them must lie in when its tilt is known;
// (c) around each of them the circle on which the next must lie when the angle between the two is known.
cv::Mat plot_directions(const Triple &slants, const Triple &tilts, const Triple &cosines, cv::Size size);

// The cosines (h12, h13, h23) of the angles between the directions at these slants and tilts.
Triple cosines_between(const Triple &slants, const Triple &tilts);
