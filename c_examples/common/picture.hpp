// Pictures between files, cv::Mat and ofc.
#pragma once

#include "common/image_file.hpp"
#include "common/image_writer.hpp"
#include "common/program.hpp"
#include "common/results.hpp"

// OpenCV first: then ofc.hpp knows cv::Mat.
#include <opencv2/core.hpp>

#include <ofc.hpp>
#include <optional>
#include <string>
#include <vector>

constexpr double degrees(double radians)
{
    return radians * 180 / CV_PI;
}

// A picture as ofc sees it: one Mat of BGR(A) pixels, or three grayscale planes.
struct Picture {
    cv::Mat pixels;       // CV_8U, CV_16U or CV_32F with 3 or 4 channels; or the red plane
    cv::Mat green, blue;  // the other planes, or empty
    cv::Mat mask;         // CV_8U, or empty
    double saturation = 0; // the level at which a channel saturates; 0 for the largest value of 8 and 16 bits
    FileFacts facts;       // what its file says of it
    std::string words;     // what was read, for people; empty for a picture that was made

    cv::Size size() const { return pixels.size(); }

    // The view of it; valid for as long as the Mats are.
    ofc_image view() const;

    // Red, green or blue as one gray Mat.
    cv::Mat channel(int index) const;

    // For the eye: 8-bit BGR, the brightest channel at 255, black outside the mask.
    cv::Mat display() const;
};

// A color picture. Its alpha channel, if it says anything, is the mask.
Picture read_picture(const std::string &path);
Picture read_planes(const std::string &red, const std::string &green, const std::string &blue);

// Reads a mask of the picture's size, of any depth and color: what is not zero is inside, or in a JPEG, which changes values a
// little, what is at least half as bright as its brightest pixel. A picture's mask may have been drawn on the picture as it is
// stored; `orientation` is the picture's.
cv::Mat read_mask(const std::string &path, cv::Size size, int orientation = 1);

// Normals are CV_32FC3 in the order x, y, z, zero where there is none, and so are the samples of a TIFF of them.
cv::Mat first_and_third_swapped(const cv::Mat &image);
cv::Mat read_normals_tiff(const std::string &path, cv::Size size);

// Median angle over the pixels where both have a normal; nothing where there is no such pixel.
std::optional<double> median_angle_deg(const cv::Mat &normals, const cv::Mat &truth);

using ofc::opencv::normal_map;

// Brightness under one white light from that direction, 8 bits.
cv::Mat shade(const cv::Mat &normals, const cv::Vec3d &light);
