#include "common/plot_directions.hpp"

#include "common/gnuplot.hpp"
#include "common/style.hpp"

#include <cmath>
#include <limits>

namespace {

using Rows = std::vector<std::vector<double>>;

const std::vector<double> gap(3, std::numeric_limits<double>::quiet_NaN());

cv::Vec3d direction(double slant, double tilt)
{
    return {std::sin(slant) * std::cos(tilt), std::sin(slant) * std::sin(tilt), std::cos(slant)};
}

void append(Rows &rows, const cv::Vec3d &point)
{
    rows.push_back({point[0], point[1], point[2]});
}

// Meridians and parallels of the upper half of the unit sphere, every 30 degrees.
Rows hemisphere()
{
    constexpr double step = CV_PI / 6;
    constexpr int fine = 48;
    Rows rows;
    for (int meridian = 0; meridian < 12; meridian++) {
        for (int i = 0; i <= fine; i++)
            append(rows, direction(CV_PI / 2 * i / fine, meridian * step));
        rows.push_back(gap);
    }
    for (int parallel = 1; parallel <= 3; parallel++) {
        for (int i = 0; i <= 2 * fine; i++)
            append(rows, direction(parallel * step, CV_PI * i / fine));
        rows.push_back(gap);
    }
    return rows;
}

// From the origin out along the tilt, and up the great circle to the z axis.
Rows tilt_plane(double tilt)
{
    constexpr int fine = 48;
    Rows rows = {{0, 0, 0}};
    for (int i = fine; i >= 0; i--)
        append(rows, direction(CV_PI / 2 * i / fine, tilt));
    return rows;
}

// The directions of the upper half at this angle to `middle`.
Rows circle(const cv::Vec3d &middle, double angle)
{
    constexpr int fine = 180;
    const cv::Vec3d aside = std::abs(middle[2]) < 0.9 ? cv::Vec3d(0, 0, 1) : cv::Vec3d(1, 0, 0);
    const cv::Vec3d a = cv::normalize(middle.cross(aside)), b = middle.cross(a);
    Rows rows;
    for (int i = 0; i <= fine; i++) {
        const double turn = 2 * CV_PI * i / fine;
        const cv::Vec3d point = std::cos(angle) * middle + std::sin(angle) * (std::cos(turn) * a + std::sin(turn) * b);
        if (point[2] >= 0)
            append(rows, point);
        else
            rows.push_back(gap);
    }
    return rows;
}

std::string place(const cv::Vec3d &at)
{
    char text[96];
    std::snprintf(text, sizeof text, "%.5f,%.5f,%.5f", at[0], at[1], at[2]);
    return text;
}

std::string rounded(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.1f°", value);
    return text;
}

} // namespace

Triple cosines_between(const Triple &slants, const Triple &tilts)
{
    cv::Vec3d v[3];
    for (int i = 0; i < 3; i++)
        v[i] = direction(slants[i], tilts[i]);
    return {v[0].dot(v[1]), v[0].dot(v[2]), v[1].dot(v[2])};
}

cv::Mat plot_directions(const Triple &slants, const Triple &tilts, const Triple &cosines, cv::Size size)
{
    // Around 1 the circle of the angle to 2, around 2 of that to 3, around 3 of that to 1.
    const double angles[3] = {std::acos(cosines[0]), std::acos(cosines[2]), std::acos(cosines[1])};
    Gnuplot plot(size);
    plot.data("hemisphere", hemisphere());
    for (int i = 0; i < 3; i++) {
        const std::string name = std::to_string(i + 1);
        plot.data("plane" + name, tilt_plane(tilts[i]));
        plot.data("circle" + name, circle(direction(slants[i], tilts[i]), angles[i]));
    }
    plot("set multiplot");
    plot("unset border; unset tics; unset key; set xyplane at 0");
    plot("set view equal xyz; set view 50,15,1.78");
    plot("set xrange [-1.1:1.1]; set yrange [-1.1:1.1]; set zrange [0:1.2]");
    const std::string captions[3] = {"(a) three unit vectors, (slant, tilt)", "(b) the planes of known tilt",
                                     "(c) the circles of known angles"};
    for (int part = 0; part < 3; part++) {
        plot("unset label; unset arrow; set size 0.333,1; set origin " + std::to_string(part / 3.0) + ",0.07");
        plot("set label '" + captions[part] + "' at screen " + std::to_string((part + 0.5) / 3) + ",0.95 center font ',12'");
        const cv::Vec3d ends[3] = {{1.25, 0, 0}, {0, 1.25, 0}, {0, 0, 1.25}};
        for (int axis = 0; axis < 3; axis++) {
            plot("set arrow from 0,0,0 to " + place(ends[axis]) + " head filled linecolor rgb '" + soft_color + "'");
            plot(std::string("set label '") + "xyz"[axis] + "' at " + place(ends[axis] * 1.07) + " center font ',11'");
        }
        std::string command = std::string("splot $hemisphere with lines linecolor rgb '") + faint_color + "'";
        for (int i = 0; i < 3; i++) {
            const std::string name = std::to_string(i + 1), color = std::string(" rgb '") + curve_colors[i] + "' ";
            const cv::Vec3d end = direction(slants[i], tilts[i]);
            plot("set arrow from 0,0,0 to " + place(end) + " head filled front linewidth 2.5 linecolor" + color);
            plot("set label 'f_" + name + "' at " + place(end * 1.13) + " center front font ',13' textcolor" + color);
            std::string line = "f_" + name;
            if (part == 0)
                line += ": (" + rounded(degrees(slants[i])) + ", " + rounded(degrees(tilts[i])) + ")";
            if (part == 1)
                line += ": tilt " + rounded(degrees(tilts[i]));
            if (part == 2)
                line += " to f_" + std::to_string((i + 1) % 3 + 1) + ": " + rounded(degrees(angles[i]));
            plot("set label '" + line + "' at screen " + std::to_string((part + (i + 0.5) / 3) / 3) +
                 ",0.06 center font ',11' textcolor" + color);
            if (part >= 1)
                command += ", $plane" + name + " with lines dashtype 2 linewidth 1.5 linecolor" + color;
            if (part >= 2)
                command += ", $circle" + name + " with lines dashtype 3 linewidth 2 linecolor" + color;
        }
        plot(command);
    }
    plot("unset multiplot");
    return plot.draw();
}
