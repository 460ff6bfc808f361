/* What the contract tests share: a picture to work on, and checks that a refused call touches nothing. */
#ifndef CONTRACT_H
#define CONTRACT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>
#include <ofc.h>

enum { WIDTH = 90, HEIGHT = 80, PIXELS = WIDTH * HEIGHT };

/* A ball under three colored lights, 8-bit RGB, black around it. */
extern uint8_t ball[HEIGHT][WIDTH][3];
void render_ball(void);
ofc_image ball_image(void);

/* What ball_image() gives to the calls after the fit. */
struct stages {
    ofc_solve_params params;
    ofc_color_fit fit;
    ofc_inlier_test inliers;
    ofc_solution solution;
};
extern struct stages stages;
/* Group setup for cmocka: renders, fits and solves the ball. */
int prepare_stages(void **state);
/* The same, and by the joint method, which knows how sure it is, with Pentland's tilts. */
int prepare_jointly(void **state, ofc_solution *solution);

extern uint64_t workspace[OFC_SOLVE_WORKSPACE_SIZE(WIDTH, HEIGHT) / sizeof(uint64_t)];

/* Every output of a test file lives in one struct; a refused call must leave all of it as it was. */
#define PATTERN 0x5a
#define REFUSED(expected, outputs, call)                                                                               \
    do {                                                                                                               \
        memset(&(outputs), PATTERN, sizeof(outputs));                                                                  \
        assert_int_equal((call), (expected));                                                                          \
        assert_true(is_untouched(&(outputs), sizeof(outputs)));                                                        \
    } while (0)
int is_untouched(const void *bytes, size_t count);

/* Calls with every kind of picture that must be refused, and checks status and outputs. */
typedef ofc_status (*image_call)(const ofc_image *image);
void refuses_bad_images(image_call call, void *outputs, size_t size);

/* An address that is no multiple of any alignment but 1. */
#define MISALIGNED(pointer) ((void *)((char *)(pointer) + 1))

#endif
