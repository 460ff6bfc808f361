// A picture's file as a picture: upright, whole, the largest of its pages.
#pragma once

#include "common/file_facts.hpp"

#include <opencv2/core.hpp>
#include <string>
#include <vector>

struct ImageFile {
    std::string path;
    cv::Mat pixels; // of any type with 1, 3 (BGR) or 4 channels (BGRA), upright
    FileFacts facts;
    std::vector<std::string> notes; // what was done that the user may not expect

    // Size, samples and notes in one line.
    std::string in_words() const;
};

// Reads it, or throws UsageError: where it cannot be read, or is cut or damaged.
ImageFile read_image_file(const std::string &path);

// The names of pictures: those that are given, and for a folder those in it that are named as pictures are, in the order of their
// names. Throws UsageError for a folder without any.
std::vector<std::string> pictures_in(const std::vector<std::string> &names);

// A picture as EXIF's orientation says that it was meant.
cv::Mat upright(const cv::Mat &stored, int orientation);

std::string size_text(cv::Size size);
