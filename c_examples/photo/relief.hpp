// Pictures most of which is one flat surface: the relief on it.
#pragma once

#include "photo/options.hpp"
#include "photo/report.hpp"

struct ReliefResult {
    ofc_status status = OFC_STATUS_OK;
    ofc_relief relief = {};  // all but its reason zero where there is none
    cv::Mat classes;         // CV_8U, OFC_RELIEF_*
    cv::Mat normals;         // CV_32FC3 x, y, z; zero where there is none
    cv::Mat uncertainty;     // CV_32F, 1-sigma angle in degrees, NaN where there is no normal
    DepthOptions depth;
    Surface surface;         // over the whole frame, zero on the plane
    nlohmann::ordered_json input; // what was read, and what became of it
    std::optional<double> median_error_deg; // over the contact, where the truth is known

    // Whether to take it instead of the first model: that is refused, or leaves out many pixels and expects larger errors.
    bool is_better_than(const Result &ellipsoid) const;
    // Leaves out what is not in the mask.
    void restrict_to(const cv::Mat &mask);
    bool solved() const { return status == OFC_STATUS_OK; }
};

// Solves the picture as a relief on a plane. The background, a picture of the plane alone, may be null.
ReliefResult solve_relief(const Picture &picture, const Picture *background, const ofc_relief_params &params);

// Adds the normals of a relief that was found, their uncertainty and depth. The truth may be empty.
void complete(ReliefResult &result, const Picture &picture, const Picture *background, const DepthOptions &depth,
              const cv::Mat &truth);

// Why there is none, in words.
const char *no_relief(const ReliefResult &result);

// How far to trust it, in words.
std::string trust(const ReliefResult &result);

// Writes the files of a relief that are wanted.
void write_relief(const ResultFolder &out, const Options &options, const Picture &picture, const ReliefResult &result);

// `ellipsoid` is what the first model says of the picture; null where it was not asked.
nlohmann::ordered_json report_of(const ReliefResult &result, const Result *ellipsoid);

std::vector<Line> summary(const ReliefResult &result);
