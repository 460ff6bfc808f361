// The whole surface of a picture: what lies in shadows too.
#pragma once

#include "common/draw.hpp"
#include "photo/result.hpp"

#include <nlohmann/json.hpp>

// Puts the whole surface in the place of the normals, the uncertainty and the depth of a solved picture, or says why it is
// left out. Channels that are gray photographs, each under one light, say so. The mask of a picture without one is what its
// pixels that are not black enclose.
void complete(Result &result, const Picture &picture, bool channels_are_lights);

// A part of the classes in colors, beside a legend with the share of each; of a large one fewer pixels.
cv::Mat class_picture(const Whole &whole, cv::Rect part);

// The lights that were found and the pixels of each class, in words.
std::vector<Line> summary(const Whole &whole);

nlohmann::ordered_json report(const Whole &whole);
