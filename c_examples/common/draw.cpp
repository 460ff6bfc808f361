#include "common/draw.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace {

constexpr uchar sheet_gray = 244;
const cv::Scalar sheet_color(sheet_gray, sheet_gray, sheet_gray);

} // namespace

void put_text(cv::Mat &image, const std::string &text, cv::Point at, double scale, cv::Scalar color)
{
    cv::putText(image, text, at, font, scale, color, 1, cv::LINE_AA);
}

std::string number(double value, double step)
{
    char text[32];
    const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step))), 0, 6);
    std::snprintf(text, sizeof text, "%.*f", digits, value == 0 ? 0.0 : value);
    return text;
}

double round_step(double range, int count)
{
    const double rough = range / count, power = std::pow(10, std::floor(std::log10(rough)));
    for (const double factor : {1, 2, 5})
        if (factor * power >= rough)
            return factor * power;
    return 10 * power;
}

std::vector<double> ticks(cv::Vec2d range, double step)
{
    constexpr int most = 100;
    const double first = std::ceil(range[0] / step - 1e-9);
    std::vector<double> values;
    for (int i = 0; i < most && (first + i) * step <= range[1] + 1e-9 * step; i++)
        values.push_back((first + i) * step);
    return values;
}

cv::Point Axes::at(double x_value, double y_value) const
{
    return {cvRound(area.x + area.width * (x_value - x[0]) / (x[1] - x[0])),
            cvRound(area.y + area.height * (y[1] - y_value) / (y[1] - y[0]))};
}

void Axes::draw(cv::Mat &plot, double x_step, double y_step) const
{
    for (const double tick : ticks(x, x_step)) {
        cv::line(plot, at(tick, y[0]), at(tick, y[1]), faint, 1);
        const std::string label = number(tick, x_step);
        const int width = cv::getTextSize(label, font, 0.42, 1, nullptr).width;
        put_text(plot, label, at(tick, y[0]) + cv::Point(-width / 2, 18), 0.42, ink);
    }
    for (const double tick : ticks(y, y_step)) {
        cv::line(plot, at(x[0], tick), at(x[1], tick), faint, 1);
        const std::string label = number(tick, y_step);
        const int width = cv::getTextSize(label, font, 0.42, 1, nullptr).width;
        put_text(plot, label, at(x[0], tick) + cv::Point(-width - 6, 5), 0.42, ink);
    }
    cv::rectangle(plot, area, ink, 1, cv::LINE_AA);
    put_text(plot, x_label, area.br() + cv::Point(-130, 36), 0.45, ink);
    put_text(plot, y_label, area.tl() + cv::Point(-28, -10), 0.45, ink);
}

cv::Vec2d range_of(const cv::Mat &values)
{
    cv::Vec2d range(HUGE_VAL, -HUGE_VAL);
    for (auto value = values.begin<float>(); value != values.end<float>(); ++value)
        if (std::isfinite(*value))
            range = {std::min<double>(range[0], *value), std::max<double>(range[1], *value)};
    return range;
}

cv::Mat colors_of(const cv::Mat &values, cv::Vec2d range)
{
    const double extent = std::max(range[1] - range[0], 1e-30);
    cv::Mat gray(values.size(), CV_8U, cv::Scalar(0)), valid(values.size(), CV_8U, cv::Scalar(0));
    for (int y = 0; y < values.rows; y++)
        for (int x = 0; x < values.cols; x++) {
            const double value = values.at<float>(y, x);
            if (std::isfinite(value)) {
                gray.at<uchar>(y, x) = cv::saturate_cast<uchar>(255 * (value - range[0]) / extent);
                valid.at<uchar>(y, x) = 255;
            }
        }
    cv::Mat colors, map(values.size(), CV_8UC3, dark);
    cv::applyColorMap(gray, colors, cv::COLORMAP_VIRIDIS);
    colors.copyTo(map, valid);
    return map;
}

cv::Mat color_picture(const cv::Mat &values, cv::Vec2d range, const std::string &title)
{
    if (range[0] > range[1])
        range = {0, 1}; // there are no values
    // Values that are all alike lie in the middle of a range that can be told apart on the bar.
    if (const double least = 1e-6 * std::max(std::abs(range[0]), 1.0); range[1] - range[0] < least)
        range += cv::Vec2d(-least, least);
    cv::Mat map = colors_of(values, range), colors;
    const double extent = range[1] - range[0];
    // Small pictures are enlarged so that the text beside them is not larger than they are.
    const int factor = std::max(1, cvRound(400.0 / std::max({1, map.rows, map.cols})));
    cv::resize(map, map, cv::Size(), factor, factor, cv::INTER_NEAREST);
    constexpr int margin = 16, bar_width = 18, text_width = 84, title_height = 30;
    const int title_width = cv::getTextSize(title, font, 0.45, 1, nullptr).width;
    const cv::Size size(std::max(map.cols + 3 * margin + bar_width + text_width, title_width + 2 * margin),
                        std::max(map.rows, 120) + title_height + margin);
    cv::Mat sheet(size, CV_8UC3, sheet_color);
    map.copyTo(sheet(cv::Rect(margin, title_height, map.cols, map.rows)));
    const cv::Rect bar(2 * margin + map.cols, title_height, bar_width, sheet.rows - title_height - margin);
    cv::Mat ramp(bar.height, 1, CV_8U);
    for (int y = 0; y < bar.height; y++)
        ramp.at<uchar>(y) = cv::saturate_cast<uchar>(255.0 * (bar.height - 1 - y) / std::max(1, bar.height - 1));
    cv::applyColorMap(cv::repeat(ramp, 1, bar.width), colors, cv::COLORMAP_VIRIDIS);
    colors.copyTo(sheet(bar));
    cv::rectangle(sheet, bar, ink, 1);
    put_text(sheet, title, {margin, 20}, 0.45, ink);
    const double step = round_step(extent, 5);
    for (const double value : ticks(range, step)) {
        const int y = bar.y + cvRound((bar.height - 1) * (1 - (value - range[0]) / extent));
        cv::line(sheet, {bar.x + bar.width, y}, {bar.x + bar.width + 5, y}, ink, 1);
        put_text(sheet, number(value, step), {bar.x + bar.width + 10, y + 5}, 0.42, ink);
    }
    return sheet;
}

void Sheet::add(const std::string &title, const cv::Mat &image)
{
    cv::Mat bgr = image;
    if (image.channels() == 1)
        cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
    const double scale = std::min(panel.width / double(image.cols), panel.height / double(image.rows));
    const cv::Size size(std::max(1, cvRound(image.cols * scale)), std::max(1, cvRound(image.rows * scale)));
    cv::resize(bgr, bgr, size, 0, 0, scale < 1 ? cv::INTER_AREA : scale > 3 ? cv::INTER_NEAREST : cv::INTER_LINEAR);
    // Pictures with a margin of their own go on in it.
    const bool has_margin = bgr.at<cv::Vec3b>(0, 0) == cv::Vec3b(sheet_gray, sheet_gray, sheet_gray);
    cv::Mat framed(panel, CV_8UC3, has_margin ? sheet_color : dark);
    bgr.copyTo(framed(cv::Rect((panel.width - size.width) / 2, (panel.height - size.height) / 2, size.width, size.height)));
    panels.emplace_back(title, framed);
}

void Sheet::add(const std::string &title, const std::string &message)
{
    cv::Mat image(panel, CV_8UC3, dark);
    put_text(image, message, {20, panel.height / 2}, 0.55, cv::Scalar(200, 200, 200));
    panels.emplace_back(title, image);
}

cv::Mat Sheet::draw(const std::vector<Line> &lines) const
{
    constexpr int margin = 20, title_height = 34, line_height = 24, label_width = 110;
    const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
    const int row_height = title_height + panel.height + margin;
    cv::Mat sheet(rows * row_height + margin * 2 + static_cast<int>(lines.size()) * line_height,
                  columns * (panel.width + margin) + margin, CV_8UC3, sheet_color);
    for (int i = 0; i < static_cast<int>(panels.size()); i++) {
        const cv::Point corner(margin + (i % columns) * (panel.width + margin), (i / columns) * row_height + title_height);
        put_text(sheet, panels[i].first, corner + cv::Point(0, -10), 0.6, ink);
        panels[i].second.copyTo(sheet(cv::Rect(corner, panel)));
    }
    int y = rows * row_height + margin + 10;
    for (const Line &line : lines) {
        put_text(sheet, line.label, {margin, y}, 0.55, ink);
        put_text(sheet, line.text, {margin + label_width, y}, 0.55, ink);
        y += line_height;
    }
    return sheet;
}
