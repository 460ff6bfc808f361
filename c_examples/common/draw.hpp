// What all drawings share.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

constexpr int font = 0; // cv::FONT_HERSHEY_SIMPLEX
const cv::Scalar white(255, 255, 255), ink(40, 40, 40), dark(30, 30, 30), faint(222, 222, 222);

// Text with its baseline at `at`.
void put_text(cv::Mat &image, const std::string &text, cv::Point at, double scale, cv::Scalar color);

// A number with as many digits as steps of this size need.
std::string number(double value, double step);

// 1, 2 or 5 times a power of ten: about `count` steps in the range.
double round_step(double range, int count);

// The multiples of a step within a range; at most a hundred.
std::vector<double> ticks(cv::Vec2d range, double step);

// A plot's axes with their ticks.
struct Axes {
    cv::Rect area;
    cv::Vec2d x, y; // least and largest value
    std::string x_label, y_label;

    cv::Point at(double x_value, double y_value) const;
    void draw(cv::Mat &plot, double x_step, double y_step) const;
};

// Values (CV_32F, NaN is none) in the colors of cv::COLORMAP_VIRIDIS from `range[0]` to `range[1]`, dark where there is none.
cv::Mat colors_of(const cv::Mat &values, cv::Vec2d range);

// The same under a title and beside a bar that says which color is which value.
cv::Mat color_picture(const cv::Mat &values, cv::Vec2d range, const std::string &title);

// Least and largest finite value.
cv::Vec2d range_of(const cv::Mat &values);

// A line of text with a short label before it.
struct Line {
    std::string label, text;
};

// Panels with titles, left to right and top to bottom, and lines of text below them.
struct Sheet {
    cv::Size panel{520, 440};
    int columns = 3;
    std::vector<std::pair<std::string, cv::Mat>> panels;

    // Adds an image in the middle of a dark panel, as large as it fits.
    void add(const std::string &title, const cv::Mat &image);
    // Adds a text in place of an image.
    void add(const std::string &title, const std::string &message);
    cv::Mat draw(const std::vector<Line> &lines) const;
};
