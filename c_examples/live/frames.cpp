#include "live/frames.hpp"

#include "common/picture.hpp"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

Frames::Frames(const std::string &source)
{
    const bool is_number = !source.empty() && std::all_of(source.begin(), source.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    if (std::filesystem::is_directory(source)) {
        for (const auto &entry : std::filesystem::directory_iterator(source))
            if (cv::haveImageReader(entry.path().string()))
                pictures.push_back(entry.path().string());
        std::sort(pictures.begin(), pictures.end());
        if (pictures.empty())
            throw UsageError(source + " has no pictures");
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
        frame = read_image(pictures[shown++], cv::IMREAD_COLOR);
    return frame;
}
