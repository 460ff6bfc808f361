// Depth from normals, and files of it.
#pragma once

#include <ofc.h>
#include <opencv2/core.hpp>
#include <string>

// The view of a depth map (CV_32F) that ofc takes; a mask (CV_8U) may be empty. Valid for as long as both are.
ofc_depth_map depth_map_of(const cv::Mat &depth, double pixel_pitch, const cv::Mat &mask = cv::Mat());

struct Surface {
    ofc_status status = OFC_STATUS_OK;
    ofc_depth_params params = {};
    ofc_depth_result result = {}; // zero where the status is negative
    cv::Mat depth;                // empty where it was not asked for; CV_32F in the unit of the pixel pitch, grows toward the camera; NaN where there is none
    double milliseconds = 0;

    bool integrated() const { return !depth.empty() && (status == OFC_STATUS_OK || status == OFC_STATUS_NOT_CONVERGED); }
    ofc_depth_map view() const { return depth_map_of(depth, params.pixel_pitch); }
};

// Integrates normals (CV_32FC3 x, y, z, zero where there is none) over the mask (CV_8U, or empty for all of them).
// Known depths (CV_32F, NaN where unknown) may be empty.
Surface integrate(const cv::Mat &normals, const cv::Mat &mask, const ofc_depth_params &params,
                  const cv::Mat &known = cv::Mat());

// Binary PLY: a vertex a pixel with depth, x right, y up, z toward the camera from the middle of the picture, in the unit
// of depth; normals of the surface, and the colors of a BGR picture of the same size. Where that would be more than `most_faces`
// triangles, if not 0, it is a vertex every so-many pixels.
void write_mesh(const std::string &path, const Surface &surface, const cv::Mat &bgr, std::size_t most_faces = 0);


// Unit normals of a depth map itself, zero where it has no depth. CV_32FC3.
cv::Mat normals_of(const ofc_depth_map &map);
