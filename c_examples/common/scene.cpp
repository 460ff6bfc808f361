#include "common/scene.hpp"

#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

namespace {

// Surfaces are heights over (u, v), x right and y up, in units of half the picture's width; -infinity is nothing.

double gaussian(double u, double v, double cu, double cv, double wu, double wv)
{
    const double x = (u - cu) / wu, y = (v - cv) / wv;
    return std::exp(-x * x - y * y);
}

// The front of an ellipsoid; where it gets too steep it goes on along its tangent.
double ellipsoid(double u, double v, double cu, double cv, double au, double av, double az)
{
    constexpr double edge = 0.82;
    const double x = (u - cu) / au, y = (v - cv) / av, squared = x * x + y * y;
    if (squared < edge)
        return az * std::sqrt(1 - squared);
    const double height = std::sqrt(1 - edge);
    return az * (height - std::sqrt(edge) / height * (std::sqrt(squared) - std::sqrt(edge)));
}

// The higher of two surfaces with a rounded seam.
double blend(double a, double b, double radius)
{
    return 0.5 * (a + b + std::hypot(a - b, radius));
}

double face(double u, double v)
{
    const double side = std::hypot(u, 0.03); // both halves are alike, smoothly
    return ellipsoid(u, v, 0, 0.22, 0.35, 0.50, 0.44) +                                            //
           0.075 * gaussian(u, v, 0, 0.13, 0.05, 0.085) + 0.045 * gaussian(u, v, 0, 0.24, 0.038, 0.11) + // nose
           0.020 * gaussian(side, v, 0.06, 0.095, 0.03, 0.03) +                                    // nostrils
           0.026 * gaussian(side, v, 0.13, 0.385, 0.10, 0.035) -                                   // brows
           0.045 * gaussian(side, v, 0.14, 0.30, 0.075, 0.05) +                                    // sockets
           0.030 * gaussian(side, v, 0.14, 0.295, 0.04, 0.028) +                                   // eyes
           0.022 * gaussian(side, v, 0.17, 0.13, 0.09, 0.09) +                                     // cheeks
           0.022 * gaussian(u, v, 0, -0.005, 0.075, 0.02) +                                        // lips
           0.024 * gaussian(u, v, 0, -0.062, 0.065, 0.022) - 0.018 * gaussian(u, v, 0, -0.033, 0.085, 0.012) +
           0.035 * gaussian(u, v, 0, -0.16, 0.08, 0.06); // chin
}

double bust_height(double u, double v)
{
    const double locks = blend(ellipsoid(u, v, -0.37, 0.16, 0.16, 0.34, 0.17),
                               ellipsoid(u, v, 0.37, 0.16, 0.16, 0.34, 0.17), 0.02);
    const double waves =
        0.011 * std::sin(24 * (std::hypot(u, 0.03) + 0.35 * v) + 2 * std::sin(5 * v)) * (1 + std::cos(7 * v));
    const double hair = blend(ellipsoid(u, v, 0, 0.44, 0.46, 0.47, 0.30), locks, 0.06) + waves;
    const double head = blend(face(u, v), hair, 0.05);
    const double shoulders =
        ellipsoid(u, v, 0, -1.12, 0.88, 0.68, 0.34) + 0.03 * gaussian(u, v, 0, -0.75, 0.10, 0.25);
    const double body = blend(ellipsoid(u, v, 0, -0.38, 0.20, 0.42, 0.20), shoulders, 0.10);
    return blend(head, body, 0.06);
}

} // namespace

Relief bust()
{
    const cv::Size size(420, 440);
    const double half = 0.5 * size.width;
    Relief relief;
    relief.depth.create(size, CV_32F);
    relief.mask.create(size, CV_8U);
    for (int row = 0; row < size.height; row++)
        for (int column = 0; column < size.width; column++) {
            const double u = (column + 0.5) / half - 1, v = 1 - (row + 0.5) / half;
            const double z = bust_height(u, v);
            relief.depth.at<float>(row, column) = static_cast<float>(z * half);
            relief.mask.at<uchar>(row, column) = z > 0 ? 255 : 0;
        }
    return relief;
}

Relief read_relief(const std::string &path, double pixel_pitch)
{
    const cv::Mat image = read_image_file(path).pixels;
    Relief relief;
    relief.pixel_pitch = pixel_pitch;
    if (image.type() == CV_16UC1)
        relief.mask = image > 0;
    else if (image.type() == CV_32FC1)
        relief.mask = cv::abs(image) < HUGE_VAL; // false for NaN
    else
        throw UsageError(path + " is neither a gray picture of 16 bits nor a TIFF of one 32-bit float a pixel");
    image.convertTo(relief.depth, CV_32F);
    return relief;
}

Scene render(const Relief &relief, double noise, std::uint64_t seed)
{
    // Table 1's lights: slant and tilt in degrees, and their colors as columns of B. The paper prints 50 for the last
    // number; 40 is what reproduces its Table 1.
    const double angles[3][2] = {{60, 20}, {40, 160}, {50, -110}};
    const std::array<double, 9> colors = {59, 13, 55, 7, 51, 49, 32, 43, 40};
    std::array<double, 9> directions;
    for (int light = 0; light < 3; light++) {
        const double slant = angles[light][0] * CV_PI / 180, tilt = angles[light][1] * CV_PI / 180;
        directions[3 * light] = std::sin(slant) * std::cos(tilt);
        directions[3 * light + 1] = std::sin(slant) * std::sin(tilt);
        directions[3 * light + 2] = std::cos(slant);
    }
    ofc_lights lights = {};
    lights.directions = directions.data();
    lights.colors = colors.data();
    lights.count = 3;
    ofc_render_params params;
    ofc_render_params_default(&params);
    params.noise = noise;
    params.seed = seed;

    Scene scene;
    scene.picture.pixels.create(relief.depth.size(), CV_8UC3);
    scene.picture.mask = relief.mask;
    scene.normals.create(relief.depth.size(), CV_32FC3);
    const ofc_depth_map map = relief.view();
    ofc_rendering rendering;
    const ofc_status status =
        ofc_render(&map, &lights, &params, scene.picture.pixels.data, OFC_PIXEL_BGR8, scene.picture.pixels.step,
                   nullptr, 0, scene.normals.ptr<float>(), scene.normals.step, &rendering);
    if (status != OFC_STATUS_OK)
        throw std::runtime_error(ofc_status_message(status));
    scene.f = cv::Matx33d(rendering.f);
    return scene;
}
