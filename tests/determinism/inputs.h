/* Pictures and numbers to work on. They are made of integers and of single floating-point operations, so that they are
 * the same on every target. */
#ifndef INPUTS_H
#define INPUTS_H

#include <ofc.h>

/* A reproducible sequence of random numbers (SplitMix64). */
void random_seed(uint64_t seed);
uint64_t random_bits(void);
/* The largest integer whose square is not larger. */
uint32_t integer_root(uint32_t square);
/* In [-1, 1]. */
double random_number(void);

struct scene {
    const char *name;
    /* Fills the buffers and returns the picture, which is valid until the next scene is made. */
    ofc_image (*make)(void);
};

enum { SCENES = 16 };
extern const struct scene scenes[SCENES];

/* A surface of WIDTH x HEIGHT that bulges, with ripples; and three lights to see it under. */
ofc_depth_map surface(void);
ofc_lights lamps(void);

#endif
