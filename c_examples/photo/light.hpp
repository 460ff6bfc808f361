// From what a file holds to what the model is about: light, and only that of the model's lights.
#pragma once

#include "common/command_line.hpp"
#include "common/picture.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

// The options --transfer and --dark.
struct LightOptions {
    std::string transfer; // linear, srgb, gamma:G or file; empty where not given
    std::string dark;     // a picture's name, or empty
    std::string ambient = "none"; // or fit

    // Adds them.
    void add_to(CLI::App &app);

    bool fits_ambient() const { return ambient == "fit"; }
};

// The picture as light, with the same stored curve undone.
Picture linearized(const Picture &picture, const FileTransfer &transfer);

// The curve that --transfer names, or that the picture's file does.
FileTransfer transfer_of(const std::string &name, const FileFacts &facts);

// What was done to a picture on its way, for people and for the report.
struct Steps {
    std::vector<std::pair<std::string, std::string>> lines; // label and text
    nlohmann::ordered_json report;
};

// Finds where the picture saturates, undoes its curve and subtracts the dark frame, as far as the options ask for it.
Picture as_light(const Picture &picture, const LightOptions &options, Steps &steps);

// The same for a background, by the curve of the picture that it belongs to.
Picture background_as_light(const Picture &background, const LightOptions &options, const FileFacts &facts);

// A picture in which what is saturated below full scale has no value.
Picture without_saturated(const Picture &picture);

// The picture less one color.
Picture less(const Picture &picture, const cv::Vec3d &offset);

// Every so-many-th row and column of a picture, so that it has no more than this many pixels.
Picture thinned(const Picture &picture, std::size_t most);
