#include "photo/overview.hpp"

#include "common/plot_colors.hpp"
#include "common/plot_slants.hpp"
#include "common/surface_view.hpp"
#include "common/thin.hpp"
#include "photo/light.hpp"
#include "photo/whole.hpp"

#include <opencv2/imgproc.hpp>

namespace {

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

// The same result at every so-many-th pixel.
Result thinned(const Result &result, int step)
{
    Result few = result;
    for (cv::Mat *map : {&few.inliers, &few.normals, &few.uncertainty, &few.surface.depth})
        *map = thin(*map, step);
    if (few.whole)
        few.whole->classes = thin(few.whole->classes, step);
    few.surface.params.pixel_pitch *= step;
    return few;
}

} // namespace

cv::Mat overview(const Picture &large, const Result &of_large)
{
    const Picture picture = thinned(large, most_drawn);
    const Result result = thinned(of_large, step_to(large.size(), most_drawn));
    const cv::Mat shown = picture.display();
    const cv::Rect part = interesting(shown);
    Sheet sheet(4);
    const auto add = [&](const std::string &title, bool there, auto image) {
        if (there)
            sheet.add(title, image());
        else
            sheet.add(title, std::string("none: see the reason below"));
    };
    sheet.add("input × mask", shown(part));
    if (result.whole)
        sheet.add("what each pixel sees", class_picture(*result.whole, part));
    else
        sheet.add("inliers (white), rejected (orange)", inlier_picture(shown, result)(part));
    add("normals: x right, y up, z out as r, g, b", result.solved(), [&] { return normal_map(result.normals)(part); });
    add("the surface relit from (1, 1, 1)", result.solved(), [&] { return shade(result.normals, {1, 1, 1})(part); });
    // Eqs. 25 play no part in the joint method, and the direct method does not know how sure it is.
    if (!result.uncertainty.empty() || (!result.solved() && result.params.orientation_method == OFC_ORIENTATION_JOINT))
        add("how sure each normal is", result.solved(), [&] { return uncertainty_picture(result, part); });
    else
        add("eqs. 25: solutions lie on the diagonal", result.solution.slant_source != OFC_SLANTS_NONE,
            [&] { return plot_slants(FixedPointProblem::of(result.solution), Sheet::panel()); });
    sheet.add("colors in pixel values, and their ellipsoid", plot_colors(picture, result.solution, result.inliers, Sheet::panel()));
    const bool integrated = result.surface.integrated() && !result.surface.depth.empty();
    const cv::Mat &depth = result.surface.depth;
    add("depth, " + std::string(result.depth.unit()), integrated, [&] { return colors_of(depth, range_of(depth))(part); });
    add("the surface from the side", integrated, [&] { return mesh_picture(result.surface, Sheet::panel()); });
    return sheet.draw(summary(of_large));
}
