/* Uneven paint: C from pairs of neighbors, the albedo, and the picture without it. */
#include "digest.h"
#include "stages.h"

void mix_paint(const ofc_image *image)
{
    static ofc_paint paint;
    ofc_paint_params params;
    ofc_solve_params solve;
    ofc_pixel_counts counts = {0};
    ofc_reason reason = 0;
    mix_status(ofc_solve_params_default(&solve));
    mix_status(ofc_pixel_counts_compute(image, &solve, workspace, workspace_bytes, &counts, &reason));
    mix_pixel_counts(&counts);
    mix_status(reason);
    mix_integer(ofc_paint_workspace_size());
    mix_integer(ofc_paint_albedo_workspace_size(image->width, image->height));
    mix_status(ofc_paint_params_default(&params));
    params.seed = 5;
    const ofc_status status = ofc_paint_estimate(image, &params, workspace, workspace_bytes, &paint);
    mix_status(status);
    if (status < 0)
        return;
    mix_paint_estimate(&paint);
    const size_t row = (size_t)image->width * sizeof(float);
    const ofc_status made =
        ofc_paint_albedo(image, &params, paint.coefficients, workspace, workspace_bytes, angles, row);
    mix_status(made);
    if (made != OFC_STATUS_OK)
        return;
    mix_floats(angles, image->width * image->height);
    mix_status(ofc_paint_divide(image, &params, angles, row, normals, 3 * row));
    mix_floats(normals, image->width * image->height * 3);
}
