#include "live/frames.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <opencv2/imgproc.hpp>

cv::Mat as_frame(const Picture &picture)
{
    cv::Mat frame = picture.pixels;
    if (frame.depth() != CV_8U)
        throw UsageError("frames have 8 bits a channel: " + picture.words);
    if (frame.channels() == 4)
        cv::cvtColor(frame, frame, cv::COLOR_BGRA2BGR);
    return frame;
}

Frames::Frames(const std::string &source)
{
    const bool is_number = !source.empty() && std::all_of(source.begin(), source.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    if (std::filesystem::is_directory(source)) {
        pictures = pictures_in({source});
    } else if (is_number ? !capture.open(std::stoi(source)) : !capture.open(source)) {
        throw UsageError(source + " is no camera, video or folder of pictures that can be opened");
    }
}

cv::Mat Frames::next()
{
    cv::Mat frame;
    if (capture.isOpened())
        capture.read(frame);
    else if (shown < pictures.size())
        frame = as_frame(read_picture(pictures[shown++]));
    return frame;
}
