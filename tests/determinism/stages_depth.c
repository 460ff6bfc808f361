/* Depth from the normals that are there, by every method, and the normals of the depth. */
#include "digest.h"
#include "stages.h"

ofc_depth_map mix_depth(const ofc_image *image)
{
    static float depths[3][PIXELS], again[PIXELS * 3];
    const size_t stride = (size_t)image->width * sizeof(float);
    const ofc_depth_input input = {.normals = normals,
                                   .normals_stride_bytes = WIDTH * 3 * sizeof(float),
                                   .width = image->width,
                                   .height = image->height};
    ofc_depth_map map = {.width = image->width, .height = image->height, .row_stride_bytes = stride, .pixel_pitch = 0.5};
    ofc_depth_params params;
    mix_status(ofc_depth_params_default(&params));
    params.pixel_pitch = 0.5;
    for (ofc_depth_method method = OFC_DEPTH_COUPLED; method >= OFC_DEPTH_POISSON; method--) {
        ofc_depth_result result = {0};
        params.method = method;
        const ofc_status status = ofc_depth_integrate(&input, &params, workspace, workspace_bytes, depths[method], stride,
                                                      &result);
        mix_status(status);
        mix_depth_result(&result);
        mix_floats(depths[method], status >= 0 ? image->width * image->height : 0);
        map.depth = depths[method];
        mix_status(ofc_depth_normals(&map, again, 3 * stride));
        mix_floats(again, image->width * image->height * 3);
    }
    return map;
}
