#include "common/thin.hpp"

#include <cmath>
#include <cstring>

int step_to(cv::Size size, std::size_t most)
{
    const double pixels = static_cast<double>(size.width) * size.height;
    return std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / static_cast<double>(most)))));
}

cv::Mat thin(const cv::Mat &map, int step, cv::Point first)
{
    if (map.empty() || step <= 1)
        return map;
    cv::Mat few((map.rows - first.y - 1) / step + 1, (map.cols - first.x - 1) / step + 1, map.type());
    for (int y = 0; y < few.rows; y++)
        for (int x = 0; x < few.cols; x++)
            std::memcpy(few.ptr(y, x), map.ptr(first.y + y * step, first.x + x * step), map.elemSize());
    return few;
}
