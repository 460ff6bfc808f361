/*
 * Makes tactile_model.h, on a computer: the model that tactile.c has in its flash.
 *
 *     cc -Iinclude c_examples/firmware/learn.c c_examples/firmware/gel.c -lofc -lm && ./a.out >c_examples/firmware/tactile_model.h
 */
#include "gel.h"

#include <ofc.h>
#include <stdio.h>
#include <stdlib.h>

enum { FRAMES = 12 };

static uint8_t frame[HEIGHT][WIDTH][3];
static uint8_t bytes[OFC_RIG_MODEL_BYTES];
static ofc_rig rig;
static ofc_rig_balls balls;
static ofc_rig_model model;

static void check(ofc_status status)
{
    if (status != OFC_STATUS_OK) {
        fprintf(stderr, "%s\n", ofc_status_message(status));
        exit(1);
    }
}

int main(void)
{
    const ofc_image image = {
        .pixels = frame, .width = WIDTH, .height = HEIGHT, .row_stride_bytes = sizeof frame[0], .format = OFC_PIXEL_RGB8};
    const size_t need = ofc_relief_workspace_size(WIDTH, HEIGHT);
    void *workspace = malloc(need);
    ofc_relief_params params;
    check(ofc_relief_params_default(&params));
    params.ball_radius = BALL_RADIUS;
    check(ofc_rig_init(WIDTH, HEIGHT, &rig, &balls));
    for (int number = 0; number < FRAMES; number++) {
        for (int y = 0; y < HEIGHT; y++)
            gel_row(number, y, frame[y][0]);
        check(ofc_rig_add(&rig, &balls, &image, NULL, &params, NULL, workspace, need, NULL, NULL));
    }
    check(ofc_rig_solve(&rig, &balls, &params, &model));
    check(ofc_rig_model_save(&model, bytes, sizeof bytes));
    free(workspace);
    printf("/* What learn.c found in %d frames. */\nstatic const uint8_t tactile_model[%d] = {", FRAMES, OFC_RIG_MODEL_BYTES);
    for (size_t i = 0; i < sizeof bytes; i++)
        printf("%s%d,", i % 24 == 0 ? "\n    " : " ", bytes[i]);
    printf("\n};\n");
    return 0;
}
