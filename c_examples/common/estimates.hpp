// The estimators that the paper's tables compare, and the tables.
#pragma once

#include "common/picture.hpp"

#include <array>
#include <nlohmann/json_fwd.hpp>

using Triple = std::array<double, 3>;

inline Triple triple(const double *values)
{
    return {values[0], values[1], values[2]};
}

// What the estimators of single channels say of a picture; radians, NaN where they refuse.
struct Estimates {
    Triple pentland_tilts, pentland_slants, lee_rosenfeld_slants, zheng_chellappa_slants, channel_maxima;
};
Estimates estimates_of(const ofc_image &image, const ofc_inlier_test &inliers);

// The rows of F as angles and norms.
struct Directions {
    Triple tilts, slants, norms;
};
Directions directions_of(const cv::Matx33d &f);

// A table of three columns. Angles are kept in degrees.
struct Table {
    struct Row {
        std::string quantity, method;
        Triple values;
    };
    std::vector<Row> rows;

    void angles(const std::string &quantity, const std::string &method, const Triple &radians);
    void numbers(const std::string &quantity, const std::string &method, const Triple &values);
    void print() const;
    nlohmann::json json() const;
};
