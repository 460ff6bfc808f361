/* A moving ball under three colored lamps, as a sensor would deliver it: a row at a time. */
#ifndef SCENE_H
#define SCENE_H

#include <stdint.h>

enum { WIDTH = 320, HEIGHT = 240 };

struct lamp {
    float direction[3]; /* x right, y up, z toward the camera */
    float strength;     /* pixel value of a surface that faces it */
    float tilt_deg, slant_deg;
};

/* Red, green, blue: each channel sees its own lamp, so these are the rows of F. */
extern const struct lamp lamps[3];

/* Row `y` of frame `frame`: WIDTH pixels of red, green, blue. */
void scene_row(int frame, int y, uint8_t *row);

/* The normal there; 0 beside the ball. */
int scene_normal(int frame, int x, int y, float normal[3]);

#endif
