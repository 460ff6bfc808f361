// Range maps, and pictures of them under the paper's three lights.
#pragma once

#include "common/picture.hpp"
#include "common/surface.hpp"

#include <array>

struct Relief {
    cv::Mat depth;          // CV_32F, grows toward the camera
    cv::Mat mask;           // CV_8U, 255 on the surface
    double pixel_pitch = 1; // in the unit of depth

    ofc_depth_map view() const { return depth_map_of(depth, pixel_pitch, mask); }
};

// The programs' own surface: a bust, depth in pixels.
Relief bust();

// A range map from a gray PNG of 16 bits (0 is no surface) or a float TIFF (NaN is none), larger values nearer.
Relief read_relief(const std::string &path, double pixel_pitch);

struct Scene {
    Picture picture; // 8 bits
    cv::Mat normals; // the true ones, CV_32FC3 x, y, z
    cv::Matx33d f;   // the true F where all lights are seen
};

// The relief under the three lights of section 4, with Gaussian noise in gray levels and cast shadows.
Scene render(const Relief &relief, double noise, std::uint64_t seed = 0);
