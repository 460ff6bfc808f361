#include "gel.h"

/* The ball touches the gel within so many pixels, and the gel comes up to it within so many more. */
#define RIM 40.0f
#define SKIRT 14.0f

/* Three colored lights around the gel, which each channel sees a share of. */
static const float lights[3][3] = {{110, 20, 140}, {-80, 100, 130}, {-40, -110, 120}};

void gel_middle(int frame, float middle[2])
{
    middle[0] = (float)(80 + frame % 3 * 75 + frame % 4 * 4);
    middle[1] = (float)(75 + frame / 3 % 3 * 45 - frame % 5 * 3);
}

void gel_normal(int frame, int x, int y, float normal[3])
{
    float middle[2];
    gel_middle(frame, middle);
    const float u = (float)x - middle[0], v = middle[1] - (float)y, r = __builtin_sqrtf(u * u + v * v);
    const float steepest = RIM / __builtin_sqrtf(BALL_RADIUS * BALL_RADIUS - RIM * RIM);
    const float slope = r < RIM           ? r / __builtin_sqrtf(BALL_RADIUS * BALL_RADIUS - r * r)
                        : r < RIM + SKIRT ? steepest * (RIM + SKIRT - r) / SKIRT
                                          : 0;
    const float length = __builtin_sqrtf(1 + slope * slope);
    normal[0] = r > 0 ? u / r * slope / length : 0;
    normal[1] = r > 0 ? v / r * slope / length : 0;
    normal[2] = 1 / length;
}

void gel_row(int frame, int y, uint8_t *row)
{
    /* The sensor's noise: a step up or down, or none. */
    uint32_t noise = (uint32_t)(frame * HEIGHT + y) * 2654435761u + 1;
    for (int x = 0; x < WIDTH; x++, row += 3) {
        float n[3];
        gel_normal(frame, x, y, n);
        for (int c = 0; c < 3; c++) {
            /* The lights are near: brighter on their side. */
            const float *a = lights[c];
            const float near = 1 + (a[0] * (float)(x - WIDTH / 2) - a[1] * (float)(y - HEIGHT / 2)) / (200.0f * WIDTH);
            noise = noise * 1664525u + 1013904223u;
            const float lit = near * (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]);
            row[c] = lit > 0 ? (uint8_t)(lit + (float)(noise >> 30) * 0.5f) : 0;
        }
    }
}
