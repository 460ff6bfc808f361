/* What the contract tests of streams share: a stream with room for every pixel of the ball. */
#ifndef STREAM_H
#define STREAM_H

#include "contract.h"

enum { SIZE = OFC_STREAM_SIZE_FOR(WIDTH, HEIGHT, 10000) };

extern uint64_t memory[SIZE / sizeof(uint64_t)];
extern ofc_stream_params params;
extern ofc_stream *stream;

struct stream_outputs {
    ofc_solution solution;
    ofc_stream_drift drift;
    float normals[3 * WIDTH + 16];
    uint8_t packed[3 * WIDTH + 16];
    uint8_t flags[WIDTH + 16];
    ofc_stream_pass pass;
    ofc_stream *stream;
    ofc_stream_params params;
};
extern struct stream_outputs out;

/* Setups for cmocka, with the direct method and the joint one. */
int fresh(void **state);
int fresh_joint(void **state);

ofc_image row_of(uint8_t picture[HEIGHT][WIDTH][3], int y);
/* One frame; the status is that of the call that ends it. */
ofc_status frame_of(ofc_stream *s, uint8_t picture[HEIGHT][WIDTH][3], ofc_stream_pass *next);
/* Frames of the ball until there is an answer. */
void solve_cold(ofc_stream *s);

#endif
