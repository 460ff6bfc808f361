#include "table1/slopes.hpp"

#include "common/draw.hpp"
#include "common/surface.hpp"

#include <algorithm>
#include <cmath>

namespace {

// Of a ball, seen from far away, 3 % of the pixels are steeper than this, and hardly more of other shapes. Five times as many
// are a surface whose depth has been stretched, and which few pixels show to all lights.
constexpr double steep_deg = 80, steep_share = 0.15;
// An 8-bit picture of a surface that is flatter than this holds little but noise.
constexpr double flat_deg = 1, flat_share = 0.99;

double share_of(const std::vector<double> &sorted, double below)
{
    const auto count = std::lower_bound(sorted.begin(), sorted.end(), below) - sorted.begin();
    return static_cast<double>(count) / static_cast<double>(sorted.size());
}

} // namespace

void require_usable_slopes(const Relief &relief, const std::string &name)
{
    const cv::Mat normals = normals_of(relief.view());
    std::vector<double> slants;
    for (auto n = normals.begin<cv::Vec3f>(); n != normals.end<cv::Vec3f>(); ++n)
        if (*n != cv::Vec3f())
            slants.push_back(degrees(std::atan2(std::hypot((*n)[0], (*n)[1]), (*n)[2])));
    if (slants.empty())
        return;
    std::sort(slants.begin(), slants.end());
    const double steep = 1 - share_of(slants, steep_deg), flat = share_of(slants, flat_deg);
    const bool too_steep = steep > steep_share, too_flat = flat > flat_share && slants.back() > 0;
    if (!too_steep && !too_flat)
        return;
    const double step = std::tan(slants[slants.size() / 2] * CV_PI / 180) * relief.pixel_pitch;
    throw UsageError(number(100 * (too_steep ? steep : flat), 0.1) + " % of " + name + " is " +
                     (too_steep ? "steeper than 80 degrees" : "flatter than 1 degree") + " with a pixel pitch of " +
                     number(relief.pixel_pitch, relief.pixel_pitch / 100) +
                     ": the unit of its depth is not that of its pixels. Depth changes by " + number(step, step / 10) +
                     " from pixel to pixel (median); say with --pixel-pitch how wide a pixel is in that unit");
}
