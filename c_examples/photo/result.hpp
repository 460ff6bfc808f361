// What a run finds.
#pragma once

#include "common/depth_options.hpp"
#include "common/estimates.hpp"
#include "common/picture.hpp"
#include "photo/paint.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// The whole surface, which then is in the result's normals, uncertainty and depth.
struct Whole {
    cv::Mat classes; // CV_8U, OFC_SURFACE_*
    ofc_surface_result result = {};
};

// What may be otherwise, by how many degrees the normals would turn then, at half of them, and how much of that is expected.
struct Doubt {
    std::string words;
    double turn, expected; // in degrees
};

struct Result {
    ofc_status status = OFC_STATUS_OK;
    ofc_solve_params params = {};
    std::string shadows;            // what was done with them, in words; empty where the status is negative
    ofc_solution solution = {};     // but for pixel_counts and reason zero where the status is negative
    cv::Mat inliers;                // CV_8U, 255 for an inlier
    cv::Mat normals;                // CV_32FC3 x, y, z; zero where there is none
    cv::Mat uncertainty;            // CV_32F, 1-sigma angle in degrees, NaN where there is no normal; empty where it is not known, and
                                    // of fewer pixels where nothing else is wanted of it than its quantiles
    double open_outline = std::nan(""); // the share of the surface's outline at which it goes on; NaN where there are no normals
    ofc_covariance covariance = {}; // where the uncertainty is known
    DepthOptions depth;             // what was wanted of it
    Surface surface;                // empty where there are no normals
    std::optional<Whole> whole;     // where it was made
    std::string whole_left_out;     // why it was not, where it was wanted
    std::optional<Paint> paint;     // where it was looked for
    std::optional<ofc_check_result> check; // where there are normals
    std::vector<Doubt> doubts;      // which the uncertainty includes
    nlohmann::ordered_json input;   // what was read, and what became of it
    std::vector<std::pair<std::string, double>> milliseconds; // by stage, in the order they run

    // Where the truth is known.
    std::optional<cv::Matx33d> true_f;
    std::optional<double> median_error_deg;

    bool solved() const { return status == OFC_STATUS_OK; }
};
