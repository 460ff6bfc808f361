// Pictures into files, row by row: of a large one there is no second copy.
#pragma once

#include <opencv2/core.hpp>
#include <string>

// Writes a PNG of 8 or 16 bits, gray or BGR(A), or throws std::runtime_error.
void write_png(const std::string &path, const cv::Mat &image);

// Writes a TIFF of floats as they are, uncompressed, samples in the order of the Mat's channels, or throws std::runtime_error.
void write_tiff(const std::string &path, const cv::Mat &floats);
