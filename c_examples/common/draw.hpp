// What all drawings share.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

// Colors are BGR.
const cv::Scalar white(255, 255, 255), ink(40, 40, 40), dark(30, 30, 30), sheet_color(244, 244, 244);

// Of larger maps every so-many-th pixel is drawn.
constexpr std::size_t most_drawn = 4000000;

// A text on a picture.
struct Text {
    enum class Align { left, center, right };

    std::string text;
    cv::Point at; // the left end, middle or right end, halfway up the line
    double points = 9;
    cv::Scalar color = ink;
    Align align = Align::left;
    bool fixed_width = false;
};

// Writes texts onto a picture (CV_8UC3).
void typeset(cv::Mat &image, const std::vector<Text> &texts);

// A number with as many digits as steps of this size need.
std::string number(double value, double step);

// 1, 2 or 5 times a power of ten: about `count` steps in the range.
double round_step(double range, int count);

// Values (CV_32F, NaN is none) in the colors of cv::COLORMAP_VIRIDIS from `range[0]` to `range[1]`, dark where there is none.
cv::Mat colors_of(const cv::Mat &values, cv::Vec2d range);

// The colors of values under a title and beside a bar that says which color is which value; of a large map fewer pixels.
cv::Mat color_picture(const cv::Mat &values, cv::Vec2d range, const std::string &title);

// Least and largest finite value; {0, 1} where there is none.
cv::Vec2d range_of(const cv::Mat &values);

// A line of text with a short label before it.
struct Line {
    std::string label, text;
};

// Panels with titles, left to right and top to bottom, and lines of text below them.
class Sheet {
  public:
    static constexpr int panel_width = 520, panel_height = 440, gap = 20;

    explicit Sheet(int columns) : columns(columns) {}

    // The size of a panel that is so many columns wide.
    static cv::Size panel(int span = 1) { return {span * panel_width + (span - 1) * gap, panel_height}; }

    // Adds an image in the middle of a panel, as large as it fits.
    void add(const std::string &title, const cv::Mat &image, int span = 1);
    // Adds a text in place of an image.
    void add(const std::string &title, const std::string &message);
    cv::Mat draw(const std::vector<Line> &lines) const;

  private:
    struct Panel {
        std::string title, message;
        cv::Mat image;
        int span = 1;
    };
    int columns;
    std::vector<Panel> panels;
};
