// The command line of ofc_photo.
#pragma once

#include "common/depth_options.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

struct Options {
    std::string image;               // empty: the program renders its own scene
    std::vector<std::string> planes; // none, or red, green, blue
    std::string mask, truth, background; // empty where not given
    std::optional<std::uint64_t> seed;
    std::optional<std::uint32_t> subsets;
    DepthOptions depth;
    bool direct_method = false;    // slants from tilts, in place of the joint orientation
    bool least_squares = false; // in place of least median of squares
    bool save_planes = false;   // the channels as three gray pictures
    bool paper_report = false;  // Table 2 and section 5's checks on the terminal
    std::string out = "out";
};

// Parses the command line; on --help, or with a message where it is wrong, exits with status 0 or 2.
Options parse_options(int argc, char **argv);
