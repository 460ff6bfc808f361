// Frames of a camera, a video or a folder.
#pragma once

#include "common/picture.hpp"

#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

// A picture from a file as a frame, BGR with 8 bits, or UsageError.
cv::Mat as_frame(const Picture &picture);

class Frames {
  public:
    // A number is a camera, a folder its pictures in the order of their names, anything else a video. Throws UsageError.
    explicit Frames(const std::string &source);

    // The next frame, BGR with 8 bits; empty after the last one.
    cv::Mat next();

  private:
    std::vector<std::string> pictures;
    std::size_t shown = 0;
    cv::VideoCapture capture;
};
