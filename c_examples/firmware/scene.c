#include "scene.h"

const struct lamp lamps[3] = {
    {{0.538985545f, 0.196174695f, 0.819152044f}, 230, 20, 35},
    {{-0.383022222f, 0.321393805f, 0.866025404f}, 220, 140, 30},
    {{-0.111618897f, -0.633022222f, 0.766044443f}, 240, -100, 40},
};

int scene_normal(int frame, int x, int y, float normal[3])
{
    /* The ball goes a little to the right and up in each frame. */
    const float radius = 0.45f * (float)HEIGHT;
    normal[0] = ((float)(x - 2 * frame - WIDTH / 2) + 0.5f) / radius;
    normal[1] = ((float)(HEIGHT / 2 - frame - y) - 0.5f) / radius;
    const float rest = 1 - normal[0] * normal[0] - normal[1] * normal[1];
    if (rest <= 0)
        return 0;
    normal[2] = __builtin_sqrtf(rest);
    return 1;
}

void scene_row(int frame, int y, uint8_t *row)
{
    /* The sensor's noise: a step up or down, or none. */
    uint32_t noise = (uint32_t)(frame * HEIGHT + y) * 2654435761u + 1;
    for (int x = 0; x < WIDTH; x++, row += 3) {
        float normal[3];
        const int is_ball = scene_normal(frame, x, y, normal);
        for (int c = 0; c < 3; c++) {
            const float *a = lamps[c].direction;
            const float facing = is_ball ? a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2] : 0;
            noise = noise * 1664525u + 1013904223u;
            row[c] = facing > 0 ? (uint8_t)(lamps[c].strength * facing + (float)(noise >> 30) * 0.5f) : 0;
        }
        /* Dust on the lens: a pixel in 64 has nothing to do with the ball. */
        if (is_ball && (noise >> 10) % 64 == 0)
            row[noise >> 20 & 1] = (uint8_t)(noise >> 24);
    }
}
