// The program's own scene: a bust under the paper's three lights.
#pragma once

#include "common/picture.hpp"

struct Scene {
    Picture picture; // 8 bits, noise of one gray level
    cv::Mat normals; // the true ones, CV_32FC3 x, y, z
    cv::Matx33d f;   // the true F where all lights are seen
};

Scene render_scene();
