/* A ball that moves over the gel of a tactile sensor, as a camera below would deliver it: a row at a time. */
#ifndef GEL_H
#define GEL_H

#include <stdint.h>

enum { WIDTH = 320, HEIGHT = 240 };

/* The radius of the ball in pixels. */
#define BALL_RADIUS 60.0f

/* The middle of the contact in frame `frame`, in pixels from the middle of the top left one, y down. */
void gel_middle(int frame, float middle[2]);

/* The normal of the gel there: x right, y up, z toward the camera. */
void gel_normal(int frame, int x, int y, float normal[3]);

/* Row `y` of frame `frame`: WIDTH pixels of red, green, blue. */
void gel_row(int frame, int y, uint8_t *row);

#endif
