/* From a depth map to pictures of every interleaved kind. */
#include "digest.h"
#include "inputs.h"
#include "stages.h"

void digest_rendering(void)
{
    static uint8_t bytes[HEIGHT][WIDTH][4];
    static uint16_t shorts[HEIGHT][WIDTH][4];
    static uint32_t seen[HEIGHT][WIDTH];
    static float floats[HEIGHT][WIDTH][3];
    const ofc_depth_map map = surface();
    const ofc_lights lights = lamps();
    ofc_render_params params;
    mix_status(ofc_render_params_default(&params));
    for (int i = 0; i < 4; i++) {
        ofc_rendering rendering = {0};
        params.seed = (uint64_t)i;
        params.noise = i;
        params.cast_shadows = i % 2;
        params.peak = i == 3 ? 0 : 200 + i;
        mix_status(ofc_render(&map, &lights, &params, bytes, OFC_PIXEL_BGRA8, sizeof bytes[0], seen[0],
                              sizeof seen[0], normals, WIDTH * 3 * sizeof(float), &rendering));
        mix_rendering(&rendering);
        mix_bytes(bytes[0][0], PIXELS * 4);
        mix_words(seen[0], PIXELS);
        mix_floats(normals, PIXELS * 3);
        mix_status(ofc_render(&map, &lights, &params, shorts, OFC_PIXEL_RGBA16, sizeof shorts[0], NULL, 0, NULL, 0,
                              &rendering));
        mix_shorts(shorts[0][0], PIXELS * 4);
        mix_status(ofc_render(&map, &lights, &params, floats, OFC_PIXEL_RGB32F, sizeof floats[0], NULL, 0, NULL, 0,
                              &rendering));
        mix_floats(floats[0][0], PIXELS * 3);
    }
    digest_print("rendering");
}
