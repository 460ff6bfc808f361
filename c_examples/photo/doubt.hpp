// What else the colors may be: light that was stored by a curve, light that is not the model's. By how much the normals would turn
// if it were so is a part of how far they are expected to be off.
#pragma once

#include "photo/light.hpp"
#include "photo/result.hpp"

// An offset that was fitted round by round.
struct Ambient {
    ofc_status status = OFC_STATUS_OK;
    cv::Vec3d offset, sigma; // in pixel values
    double chi_squared = 0;    // of the first round
    double gain = 0;           // what the center explains, over what it leaves beyond noise
    bool is_found = false;   // beyond its error, and no more than the darkest pixels have
    bool is_plain = false;   // so far beyond the lack of fit that it is to be spoken of unasked
    std::string in_words() const;
    nlohmann::ordered_json report() const;
};

// Fits it to a picture, which is solved with these parameters round by round.
Ambient fit_ambient(const Picture &picture, const ofc_solve_params &params, int rounds);

// Adds to the result what may be otherwise and is not ruled out by options, and widens its uncertainty.
void add_doubts(Result &result, const Picture &picture, const LightOptions &options, const ofc_solve_params &params);
