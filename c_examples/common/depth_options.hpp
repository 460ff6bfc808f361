// Integration on a command line and in a report.
#pragma once

#include "common/command_line.hpp"
#include "common/surface.hpp"
#include <nlohmann/json_fwd.hpp>

// What the user wants of the integration.
struct DepthOptions {
    std::string method = "poisson"; // poisson, paper or coupled
    bool is_wanted = true;
    double pixel_pitch = 0;         // in millimeters; 0 where not given: depth is in pixels

    // Adds --integrate and --pixel-pitch.
    void add_to(CommandLine &line);
    const char *unit() const { return pixel_pitch > 0 ? "mm" : "pixels"; }
    ofc_depth_params params() const;
    cv::Mat picture(const Surface &surface) const;
    nlohmann::json report(const Surface &surface) const;
};
