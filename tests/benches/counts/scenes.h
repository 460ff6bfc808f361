/* Pictures to measure on, the same bits on every machine: depths are made of single operations and square roots, and the library
 * renders them. */
#ifndef SCENES_H
#define SCENES_H

#include <ofc.h>

/* A picture of 8 bits in memory of its own, r, g, b without gaps. */
struct scene {
    ofc_image image; /* Without a mask. */
    uint8_t *mask;   /* 255 where the surface is. */
};

/* A cap of an ellipsoid that all of three lights reach, black around it; a tenth of its pixels have highlights. */
struct scene dome(int32_t width, int32_t height);
/* Half an ellipsoid that is partly in the shadow of each of three lights, with highlights, on a dark noisy background. */
struct scene egg(int32_t width, int32_t height);
/* A frame of a tactile sensor: a ball pressed in at x, y of the frame, which is all there is for radius 0. */
struct scene gel(int32_t width, int32_t height, double radius, double x, double y, uint64_t seed);
/* The colors of a dome of floats, of which this share in percent, spread over the picture, is anything: half of it random, half of it
 * highlights. All pixels are of the surface. */
struct scene points(int32_t width, int32_t height, int share);
/* The picture in another format. */
ofc_image converted(const ofc_image *image, ofc_pixel_format format);
/* Unit normals of hills, three floats a pixel, and where `mask` is not NULL the disc within the frame. */
float *hills(int32_t size, uint8_t *mask);

#endif
