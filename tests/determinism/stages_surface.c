/* The whole surface: lights from shadows, and what their colors leave open. */
#include "digest.h"
#include "stages.h"

static float depths[PIXELS];

void mix_surface(const ofc_image *image)
{
    static ofc_solution solution;
    static ofc_surface_result result;
    ofc_solve_params solve;
    ofc_surface_params params;
    mix_integer(ofc_surface_workspace_size(image->width, image->height));
    mix_status(ofc_solve_params_default(&solve));
    mix_status(ofc_surface_params_default(&params));
    solve.lmeds.subsets = 20;
    solve.lmeds.sample_size = 400;
    params.seed = 5;
    params.channels_are_lights = 1;
    mix_status(ofc_solve(image, &solve, workspace, workspace_bytes, NULL, &solution));
    const size_t row = (size_t)image->width * sizeof(float);
    const int pixels = image->width * image->height;
    const ofc_status status = ofc_surface_complete(image, &solution, &params, workspace, workspace_bytes, normals, 3 * row,
                                                   angles, row, depths, row, marks, (size_t)image->width, &result);
    mix_status(status);
    if (status < 0)
        return;
    mix_floats(normals, 3 * pixels);
    mix_floats(angles, pixels);
    mix_floats(depths, pixels);
    mix_bytes(marks, pixels);
    mix_surface_result(&result);
}
