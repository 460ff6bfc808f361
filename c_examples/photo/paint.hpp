// Uneven paint: what it is like, whether to divide it out, and the picture without it.
#pragma once

#include "common/command_line.hpp"
#include "common/picture.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

// The option --paint.
struct PaintOption {
    std::string choice = "auto"; // auto, even or uneven

    // Adds it.
    void add_to(CLI::App &app);
};

// What the pairs of neighboring pixels say of the paint.
struct Paint {
    ofc_status status = OFC_STATUS_OK;
    ofc_paint estimate = {};
    cv::Mat albedo; // CV_32F with the median 1, NaN where a pixel is not usable; empty until it is divided out
    Picture even;   // the picture divided by it
    bool taken = false; // whether the solution is that of the picture without its paint

    // In one line, for people.
    std::string in_words() const;

    nlohmann::ordered_json report() const;

    // For the eye: the median is gray, twice as much is white, and black is where there is none.
    cv::Mat picture() const;
};

// What the paint of a picture is like.
Paint paint_of(const Picture &picture, std::uint64_t seed);

// Finds the albedo, and the picture without it, where there is a C.
void divide_out(Paint &paint, const Picture &picture);

// Whether the picture without its paint is to be solved, given how the picture as it is was: where that has no answer for want of
// determination, and where its fit leaves far more noise than there is across the direction of the colors, and paint is known well.
bool is_better_even(const Paint &paint, ofc_status plain, const ofc_solution &solution);
