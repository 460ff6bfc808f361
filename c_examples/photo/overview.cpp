#include "photo/overview.hpp"

#include "common/surface_view.hpp"
#include "photo/plots.hpp"

#include <opencv2/imgproc.hpp>

namespace {

const cv::Scalar background(244, 244, 244), ink(40, 40, 40), dark(30, 30, 30);
const cv::Size panel(520, 440);
constexpr int margin = 20, title_height = 34, line_height = 24;

// `image` in the middle of a dark panel, as large as it fits.
cv::Mat fitted(const cv::Mat &image)
{
    cv::Mat bgr = image;
    if (image.channels() == 1)
        cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
    const double scale = std::min(panel.width / double(image.cols), panel.height / double(image.rows));
    const cv::Size size(std::max(1, cvRound(image.cols * scale)), std::max(1, cvRound(image.rows * scale)));
    cv::resize(bgr, bgr, size, 0, 0, scale < 1 ? cv::INTER_AREA : scale > 3 ? cv::INTER_NEAREST : cv::INTER_LINEAR);
    cv::Mat framed(panel, CV_8UC3, dark);
    bgr.copyTo(framed(cv::Rect((panel.width - size.width) / 2, (panel.height - size.height) / 2, size.width, size.height)));
    return framed;
}

cv::Mat message(const std::string &text)
{
    cv::Mat image(panel, CV_8UC3, dark);
    put_text(image, text, {20, panel.height / 2}, 0.55, cv::Scalar(200, 200, 200));
    return image;
}

// The part of the picture that holds the object, with a little around it.
cv::Rect interesting(const cv::Mat &shown)
{
    cv::Mat gray;
    cv::cvtColor(shown, gray, cv::COLOR_BGR2GRAY);
    const cv::Rect all(cv::Point(), shown.size());
    const cv::Rect box = cv::boundingRect(gray);
    if (box.empty())
        return all;
    const int around = 4 + std::max(box.width, box.height) / 20;
    return all & cv::Rect(box.tl() - cv::Point(around, around), box.br() + cv::Point(around, around));
}

// Inliers white, rejected pixels orange, pixels that were never looked at dark.
cv::Mat inlier_picture(const cv::Mat &looked_at, const Result &result)
{
    cv::Mat shown(looked_at.size(), CV_8UC3, dark);
    for (int y = 0; y < shown.rows; y++)
        for (int x = 0; x < shown.cols; x++)
            if (result.inliers.at<uchar>(y, x))
                shown.at<cv::Vec3b>(y, x) = {235, 235, 235};
            else if (looked_at.at<cv::Vec3b>(y, x) != cv::Vec3b())
                shown.at<cv::Vec3b>(y, x) = {0, 94, 213};
    return shown;
}

} // namespace

cv::Mat overview(const Picture &picture, const Result &result)
{
    const bool has_curves = result.solution.slant_source != OFC_SLANTS_NONE;
    const bool integrated = result.surface.integrated() && !result.surface.depth.empty();
    const std::string none = "none: see the reason below";
    const cv::Mat shown = picture.display();
    const cv::Rect part = interesting(shown);
    const std::pair<std::string, cv::Mat> panels[] = {
        {"input x mask", fitted(shown(part))},
        {"inliers (white), rejected (orange)", fitted(inlier_picture(shown, result)(part))},
        {"normals: x right, y up, z out as r, g, b", result.solved() ? fitted(normal_map(result.normals)(part)) : message(none)},
        {"the surface relit from (1, 1, 1)", result.solved() ? fitted(shade(result.normals, {1, 1, 1})(part)) : message(none)},
        {"eqs. 25: solutions lie on the diagonal", has_curves ? plot_curves(result, panel) : message(none)},
        {"colors and their ellipsoid", plot_colors(picture, result, panel)},
        {"depth, " + std::string(result.depth.unit()), integrated ? fitted(depth_colors(result.surface)(part)) : message(none)},
        {"the surface from the side", integrated ? mesh_picture(result.surface, panel) : message(none)},
    };
    const std::vector<Line> lines = summary(result);
    constexpr int columns = 4, rows = 2;
    const int row_height = title_height + panel.height + margin;
    cv::Mat sheet(rows * row_height + margin * 2 + static_cast<int>(lines.size()) * line_height,
                  columns * (panel.width + margin) + margin, CV_8UC3, background);
    for (int i = 0; i < rows * columns; i++) {
        const cv::Point corner(margin + (i % columns) * (panel.width + margin), (i / columns) * row_height + title_height);
        put_text(sheet, panels[i].first, corner + cv::Point(0, -10), 0.6, ink);
        panels[i].second.copyTo(sheet(cv::Rect(corner, panel)));
    }
    int y = rows * row_height + margin + 10;
    for (const Line &line : lines) {
        put_text(sheet, line.label, {margin, y}, 0.55, ink);
        put_text(sheet, line.text, {margin + 110, y}, 0.55, ink);
        y += line_height;
    }
    return sheet;
}
