// What a run found, as JSON and as text.
#pragma once

#include "common/draw.hpp"
#include "photo/result.hpp"

// A part of the uncertainty in colors, beside a bar in degrees that begins at 0. The last hundredth of the values has
// the last color.
cv::Mat uncertainty_picture(const Result &result, cv::Rect part);

// Adds a line; a long one becomes several, of which only the first has the label.
void add_wrapped(std::vector<Line> &lines, std::string label, std::string text);

nlohmann::ordered_json report_of(const Result &result);

// The main numbers in a few lines, each with a short label, for the terminal and the overview.
std::vector<Line> summary(const Result &result);
