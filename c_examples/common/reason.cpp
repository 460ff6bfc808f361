#include "common/reason.hpp"


#include <cstdio>

std::string counts_in_words(const ofc_solution &solution)
{
    const ofc_pixel_counts &c = solution.pixel_counts;
    const int all = c.usable + c.masked_out + c.dark + c.saturated + c.non_finite + c.shadowed;
    char line[256];
    std::snprintf(line, sizeof line,
                  "%d: %d masked out, %d black, %d saturated, %d shaded, %d not finite; %d usable, %d inliers after residuals, "
                  "%d after norms",
                  all, c.masked_out, c.dark, c.saturated, c.shadowed, c.non_finite, c.usable, solution.fit.inlier_count,
                  solution.inlier_count);
    return line;
}

std::string reason_in_words(const ofc_solution &solution)
{
    if (solution.reason == OFC_REASON_NONE)
        return "";
    std::string words = ofc_reason_message(solution.reason);
    if (solution.reason_channel >= 0)
        words += std::string(", channel ") + "rgb"[solution.reason_channel];
    if (solution.reason_value != 0 || solution.reason_limit != 0) {
        char numbers[64];
        std::snprintf(numbers, sizeof numbers, " (%.3g, limit %.3g)", solution.reason_value, solution.reason_limit);
        words += numbers;
    }
    return words;
}

void explain_refusal(const ofc_image &image, const ofc_solve_params &params, ofc_solution &solution)
{
    ofc::Workspace workspace(ofc_solve_workspace_size(image.width, image.height, &params));
    solution = {};
    solution.reason_channel = -1;
    ofc_pixel_counts_compute(&image, &params, workspace.data(), workspace.bytes(), &solution.pixel_counts, &solution.reason);
}
