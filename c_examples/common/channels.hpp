// Figure 7 of the paper: each channel of the input beside the normals lit from that channel's row of F.
#pragma once

#include "common/picture.hpp"

// Top row: the channels of the picture where there are inliers (CV_8U). Bottom row: the normals (CV_32FC3) lit by the rows
// of F, with the correlation of the two. Histograms are equalized over the inliers, as the paper's are.
cv::Mat channels_picture(const Picture &picture, const cv::Mat &inliers, const cv::Mat &normals, const double (&f)[9],
                         const double (&correlation)[3]);
