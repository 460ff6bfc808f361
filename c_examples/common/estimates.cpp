#include "common/estimates.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

Estimates estimates_of(const ofc_image &image, const ofc_inlier_test &inliers)
{
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const Triple nothing = {none, none, none};
    Estimates estimates = {nothing, nothing, nothing, nothing, nothing};
    ofc_tilts tilts;
    if (ofc_tilt_pentland(&image, &inliers, &tilts) == OFC_STATUS_OK)
        std::copy_n(tilts.tilt_rad, 3, estimates.pentland_tilts.begin());
    ofc_slant_estimate slants[3];
    const auto keep = [&](ofc_status status, Triple &to) {
        for (int c = 0; status == OFC_STATUS_OK && c < 3; c++)
            to[c] = slants[c].slant_rad;
    };
    keep(ofc_slant_pentland(&image, &inliers, slants), estimates.pentland_slants);
    keep(ofc_slant_lee_rosenfeld(&image, &inliers, slants, nullptr), estimates.lee_rosenfeld_slants);
    keep(ofc_slant_zheng_chellappa(&image, slants), estimates.zheng_chellappa_slants);
    Triple maxima;
    if (ofc_channel_maxima(&image, &inliers, maxima.data()) == OFC_STATUS_OK)
        estimates.channel_maxima = maxima;
    return estimates;
}

Directions directions_of(const cv::Matx33d &f)
{
    Directions directions;
    for (int c = 0; c < 3; c++) {
        const double x = f(c, 0), y = f(c, 1), z = f(c, 2), across = std::hypot(x, y);
        directions.tilts[c] = std::atan2(y, x);
        directions.slants[c] = std::atan2(across, z);
        directions.norms[c] = std::hypot(across, z);
    }
    return directions;
}

void Table::angles(const std::string &quantity, const std::string &method, const Triple &radians)
{
    rows.push_back({quantity, method, {degrees(radians[0]), degrees(radians[1]), degrees(radians[2])}});
}

void Table::numbers(const std::string &quantity, const std::string &method, const Triple &values)
{
    rows.push_back({quantity, method, values});
}

void Table::print() const
{
    std::printf("%-29s %9s %9s %9s\n", "", "f1", "f2", "f3");
    std::string last;
    for (const Row &row : rows) {
        std::printf("%-6s %-22s", row.quantity == last ? "" : row.quantity.c_str(), row.method.c_str());
        for (const double value : row.values)
            if (std::isfinite(value))
                std::printf(" %9.2f", value);
            else
                std::printf(" %9s", "-");
        std::printf("\n");
        last = row.quantity;
    }
}

nlohmann::json Table::json() const
{
    nlohmann::json table = nlohmann::json::array();
    for (const Row &row : rows)
        table.push_back({{"quantity", row.quantity}, {"method", row.method}, {"values", row.values}}); // NaN becomes null
    return table;
}
