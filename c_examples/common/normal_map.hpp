// Normal maps of other programs, and what is wrong with them.
#pragma once

#include "common/picture.hpp"

#include <string>
#include <vector>

struct NormalMap {
    cv::Mat normals;                 // CV_32FC3 x right, y up, z toward the camera; zero where there is none
    std::string words;               // what was read
    std::vector<std::string> doubts; // what looks wrong, with the option that mends it
};

// How the file has them.
struct NormalMapOptions {
    bool y_down = false, z_inward = false;
    std::string transfer = "linear"; // or srgb
};

// Reads a TIFF of 3 x float32, or a picture of 8 or 16 bits with (n + 1) / 2 in r, g, b; where there is none it is black, zero,
// transparent, or of a length far from 1. UsageError where it is no normal map.
NormalMap read_normal_map(const std::string &path, const NormalMapOptions &options);
