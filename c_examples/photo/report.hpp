// What a run found, as JSON and as text.
#pragma once

#include "common/depth_options.hpp"
#include "common/picture.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

struct Result {
    ofc_status status = OFC_STATUS_OK;
    ofc_solve_params params = {};
    ofc_solution solution = {}; // zero where the status is negative
    cv::Mat inliers;            // CV_8U, 255 for an inlier
    cv::Mat normals;            // CV_32FC3 x, y, z; zero where there is none
    DepthOptions depth;         // what was wanted of it
    Surface surface;            // empty where there are no normals
    std::vector<std::pair<std::string, double>> milliseconds; // by stage, in the order they run

    // Where the truth is known.
    std::optional<cv::Matx33d> true_f;
    std::optional<double> median_error_deg;

    bool solved() const { return status == OFC_STATUS_OK; }
};

// Tilt, slant and length of the rows of F.
struct Row {
    double tilt_deg, slant_deg, norm;
};
Row row_of(const cv::Matx33d &f, int channel);

void write_report(const std::string &path, const Result &result);

// The main numbers in a few lines, each with a short label, for the terminal and the overview.
struct Line {
    std::string label, text;
};
std::vector<Line> summary(const Result &result);
