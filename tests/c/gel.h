/* A frame of a gel sensor, and what is said of it: for the stages of reliefs and of rigs. */
#ifndef OFC_GEL_H
#define OFC_GEL_H

#include "contract.h"

enum { ACROSS = 160, DOWN = 120, ALL = ACROSS * DOWN };

static uint8_t frame[DOWN][ACROSS][3], plane[DOWN][ACROSS][3];
static double truth[DOWN][ACROSS][3];
static uint64_t room[36 * ALL / sizeof(uint64_t)];
static ofc_relief_params params;

static ofc_image image_of(const void *pixels)
{
    const ofc_image image = {
        .pixels = pixels, .width = ACROSS, .height = DOWN, .row_stride_bytes = ACROSS * 3, .format = OFC_PIXEL_RGB8};
    return image;
}

/* The slopes p and q of a surface so far from its middle, x right and y up. */
typedef void slopes_of(double x, double y, double *p, double *q);

/* The surface with its middle at this pixel, with noise of one level, under three lights; and the plane without it. */
static void shade(slopes_of *slopes, double middle_x, double middle_y)
{
    static const double lights[3][3] = {{110, 20, 140}, {-80, 100, 130}, {-40, -110, 120}};
    uint32_t random = 1;
    for (int y = 0; y < DOWN; y++)
        for (int x = 0; x < ACROSS; x++) {
            double p, q;
            slopes(x - middle_x, middle_y - y, &p, &q);
            const double length = sqrt(1 + p * p + q * q);
            const double normal[3] = {-p / length, -q / length, 1 / length};
            memcpy(truth[y][x], normal, sizeof normal);
            for (int c = 0; c < 3; c++) {
                const double *light = lights[c];
                random = random * 1664525U + 1013904223U;
                const double noise = (double)(random >> 16) / 32768.0 - 1;
                const double lit = light[0] * normal[0] + light[1] * normal[1] + light[2] * normal[2];
                frame[y][x][c] = (uint8_t)fmax(0, lit + noise + 0.5);
                plane[y][x][c] = (uint8_t)(light[2] - noise + 0.5);
            }
        }
}

/* The mean error in radians of the normals of the contact, which has more than so many pixels. */
static double mean_error(uint8_t classes[DOWN][ACROSS], float normals[DOWN][ACROSS + 1][3], int least)
{
    double sum = 0;
    int count = 0;
    for (int y = 0; y < DOWN; y++)
        for (int x = 0; x < ACROSS; x++)
            if (classes[y][x] == OFC_RELIEF_CONTACT) {
                const float *n = normals[y][x];
                const double *t = truth[y][x];
                sum += acos(fmin(1, n[0] * t[0] + n[1] * t[1] + n[2] * t[2]));
                count++;
            }
    assert_true(count > least);
    return sum / count;
}

#endif
