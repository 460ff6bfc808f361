#include "common/draw.hpp"

#include "common/gnuplot.hpp"
#include "common/thin.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace {

// The multiples of a step within a range; at most a hundred.
std::vector<double> ticks(cv::Vec2d range, double step)
{
    constexpr int most = 100;
    const double first = std::ceil(range[0] / step - 1e-9);
    std::vector<double> values;
    for (int i = 0; i < most && (first + i) * step <= range[1] + 1e-9 * step; i++)
        values.push_back((first + i) * step);
    return values;
}

// A label command in gnuplot's language.
std::string label(const Text &text, cv::Size size)
{
    static const char *const align[] = {"left", "center", "right"};
    char place[160];
    std::snprintf(place, sizeof place, " at screen %.6f,%.6f %s font 'DejaVu Sans%s,%g' textcolor rgb '#%02x%02x%02x'",
                  static_cast<double>(text.at.x) / size.width, 1 - static_cast<double>(text.at.y) / size.height,
                  align[static_cast<int>(text.align)], text.fixed_width ? " Mono" : "", text.points,
                  static_cast<unsigned>(text.color[2]), static_cast<unsigned>(text.color[1]),
                  static_cast<unsigned>(text.color[0]));
    return "set label " + Gnuplot::quoted(text.text) + place + " noenhanced";
}

} // namespace

void typeset(cv::Mat &image, const std::vector<Text> &texts)
{
    Gnuplot layer(image.size(), Gnuplot::Background::transparent);
    layer("unset border; unset tics; unset key");
    for (const Text &text : texts)
        layer(label(text, image.size()));
    layer("plot [0:1] [0:1] 2"); // nothing, for labels need a plot
    const cv::Mat letters = layer.draw();
    for (int y = 0; y < image.rows; y++)
        for (int x = 0; x < image.cols; x++) {
            const cv::Vec4b letter = letters.at<cv::Vec4b>(y, x);
            cv::Vec3b &pixel = image.at<cv::Vec3b>(y, x);
            for (int c = 0; c < 3; c++)
                pixel[c] = static_cast<uchar>((letter[3] * letter[c] + (255 - letter[3]) * pixel[c] + 127) / 255);
        }
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

cv::Vec2d range_of(const cv::Mat &values)
{
    cv::Vec2d range(HUGE_VAL, -HUGE_VAL);
    for (auto value = values.begin<float>(); value != values.end<float>(); ++value)
        if (std::isfinite(*value))
            range = {std::min<double>(range[0], *value), std::max<double>(range[1], *value)};
    return range[0] <= range[1] ? range : cv::Vec2d(0, 1);
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
    // Values that are all alike lie in the middle of a range that can be told apart on the bar.
    if (const double least = 1e-6 * std::max(std::abs(range[0]), 1.0); range[1] - range[0] < least)
        range += cv::Vec2d(-least, least);
    cv::Mat map = colors_of(thin(values, step_to(values.size(), most_drawn)), range), colors;
    const double extent = range[1] - range[0];
    // Small pictures are enlarged so that the text beside them is not larger than they are.
    const int factor = std::max(1, cvRound(400.0 / std::max({1, map.rows, map.cols})));
    cv::resize(map, map, cv::Size(), factor, factor, cv::INTER_NEAREST);
    constexpr int margin = 16, bar_width = 18, text_width = 84, title_height = 34, letter_width = 8;
    const int title_width = static_cast<int>(title.size()) * letter_width;
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
    std::vector<Text> texts = {{title, {margin, title_height / 2}, 10}};
    const double step = round_step(extent, 5);
    for (const double value : ticks(range, step)) {
        const int y = bar.y + cvRound((bar.height - 1) * (1 - (value - range[0]) / extent));
        cv::line(sheet, {bar.x + bar.width, y}, {bar.x + bar.width + 5, y}, ink, 1);
        texts.push_back({number(value, step), {bar.x + bar.width + 10, y}});
    }
    typeset(sheet, texts);
    return sheet;
}

void Sheet::add(const std::string &title, const cv::Mat &image, int span)
{
    cv::Mat bgr = image;
    if (image.channels() == 1)
        cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
    const cv::Size most = panel(span);
    const double scale = std::min(most.width / double(image.cols), most.height / double(image.rows));
    const cv::Size size(std::max(1, cvRound(image.cols * scale)), std::max(1, cvRound(image.rows * scale)));
    cv::resize(bgr, bgr, size, 0, 0, scale < 1 ? cv::INTER_AREA : scale > 3 ? cv::INTER_NEAREST : cv::INTER_LINEAR);
    // A picture with a margin of its own goes on in it, and plots are on white.
    const cv::Vec3b corner = bgr.at<cv::Vec3b>(0, 0);
    const bool has_margin = corner == cv::Vec3b(244, 244, 244) || corner == cv::Vec3b(255, 255, 255);
    cv::Mat framed(most, CV_8UC3, has_margin ? cv::Scalar(corner) : dark);
    bgr.copyTo(framed(cv::Rect((most.width - size.width) / 2, (most.height - size.height) / 2, size.width, size.height)));
    panels.push_back({title, "", framed, span});
}

void Sheet::add(const std::string &title, const std::string &message)
{
    panels.push_back({title, message, cv::Mat(panel(), CV_8UC3, dark), 1});
}

cv::Mat Sheet::draw(const std::vector<Line> &lines) const
{
    constexpr int title_height = 36, line_height = 24, label_width = 110, row_height = title_height + panel_height + gap;
    constexpr int text_width = 1400; // a long line of text takes this much
    // Where each panel stands: its column and row.
    std::vector<cv::Point> places;
    cv::Point next(0, 0);
    for (const Panel &panel : panels) {
        if (next.x + panel.span > columns)
            next = {0, next.y + 1};
        places.push_back(next);
        next.x += panel.span;
    }
    const int rows = next.y + 1;
    cv::Mat sheet(rows * row_height + gap * 2 + static_cast<int>(lines.size()) * line_height,
                  std::max(columns * (panel_width + gap) + gap, text_width), CV_8UC3, sheet_color);
    std::vector<Text> texts;
    for (std::size_t i = 0; i < panels.size(); i++) {
        const cv::Point corner(gap + places[i].x * (panel_width + gap), places[i].y * row_height + title_height);
        const cv::Mat &image = panels[i].image;
        image.copyTo(sheet(cv::Rect(corner, image.size())));
        texts.push_back({panels[i].title, corner + cv::Point(0, -title_height / 2 + 2), 12});
        if (!panels[i].message.empty())
            texts.push_back({panels[i].message, corner + cv::Point(image.cols / 2, image.rows / 2), 11,
                             cv::Scalar(200, 200, 200), Text::Align::center});
    }
    int y = rows * row_height + gap;
    for (const Line &line : lines) {
        texts.push_back({line.label, {gap, y}, 11, ink, Text::Align::left, true});
        texts.push_back({line.text, {gap + label_width, y}, 11, ink, Text::Align::left, true});
        y += line_height;
    }
    typeset(sheet, texts);
    return sheet;
}
