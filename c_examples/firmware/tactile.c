/*
 * A tactile sensor without an operating system, C library or heap: a model that a computer found is in flash, and each frame is seen
 * row by row. What is pressed in, and its normals, are known when the last row has come.
 *
 * What is printed after a '#' is read by run.sh.
 */
#include "board.h"
#include "gel.h"
#include "print.h"

#include <ofc.h>

#include "tactile_model.h"

/* All the memory there is: a row of the camera, one of normals, the model, and what was seen of the frame. */
static uint8_t row[WIDTH][3];
static float normals[WIDTH][3];
static ofc_rig_model model;
static ofc_rig_rows rows;

/* What ofc's calls took: instructions, and the most bytes of stack of any call. */
static uint64_t instructions;
static uint32_t stack_in_call;

/* STATUS = CALL, measured. */
#define MEASURE(status, call)                                                                                          \
    do {                                                                                                               \
        board_stack_paint();                                                                                           \
        const uint64_t start = board_instructions();                                                                   \
        status = call;                                                                                                 \
        instructions += board_instructions() - start;                                                                  \
        if (board_stack_taken() > stack_in_call)                                                                       \
            stack_in_call = board_stack_taken();                                                                       \
    } while (0)

static void report(const char *name, uint32_t value)
{
    print_text("# ");
    print_text(name);
    print_text(" ");
    print_integer(value);
    print_text("\n");
}

/* One frame, and the mean angle in radians between the normals and the true ones where the gel is bent. */
static ofc_status look(int number, ofc_rig_contact *contact, float *error)
{
    float sum = 0;
    uint32_t count = 0;
    ofc_status status;
    MEASURE(status, ofc_rig_rows_begin(&rows));
    for (int y = 0; y < HEIGHT && status == OFC_STATUS_OK; y++) {
        gel_row(number, y, row[0]);
        const ofc_image image = {
            .pixels = row, .width = WIDTH, .height = 1, .row_stride_bytes = sizeof row, .format = OFC_PIXEL_RGB8};
        MEASURE(status, ofc_rig_row(&model, &rows, &image, NULL, NULL, normals[0]));
        for (int x = 0; x < WIDTH; x++) {
            float t[3];
            const float *n = normals[x];
            gel_normal(number, x, y, t);
            if (t[2] < 0.99f) {
                const float d[3] = {n[0] - t[0], n[1] - t[1], n[2] - t[2]};
                sum += __builtin_sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]); /* the chord of a small angle */
                count++;
            }
        }
    }
    if (status == OFC_STATUS_OK)
        MEASURE(status, ofc_rig_rows_contact(&rows, 1, contact));
    *error = count > 0 ? sum / (float)count : 3;
    return status;
}

int main(void)
{
    ofc_status status;
    MEASURE(status, ofc_rig_model_load(tactile_model, sizeof tactile_model, &model));
    report("instructions load", (uint32_t)instructions);
    report("stack load", stack_in_call);
    stack_in_call = 0;
    /* Frames that the model was not made of. */
    for (int number = 20; number < 23 && status == OFC_STATUS_OK; number++) {
        ofc_rig_contact contact;
        float error, middle[2];
        instructions = 0;
        status = look(number, &contact, &error);
        if (number == 20)
            report("instructions tactile", (uint32_t)instructions);
        if (status != OFC_STATUS_OK)
            break;
        gel_middle(number, middle);
        const float off[2] = {(float)contact.center[0] - middle[0], (float)contact.center[1] - middle[1]};
        print_text("contact of ");
        print_integer((uint32_t)contact.area);
        print_text(" pixels at ");
        print_decimal((float)contact.center[0]);
        print_text(", ");
        print_decimal((float)contact.center[1]);
        print_text(": mean angle to the true normals ");
        print_decimal(error * 57.2957795f);
        print_text(" degrees\n");
        if (error > 0.07f || off[0] * off[0] + off[1] * off[1] > 4)
            return 2;
    }
    if (status != OFC_STATUS_OK) {
        print_text(ofc_status_message(status));
        print_text("\n");
        return 1;
    }
    report("stack call", stack_in_call);
    report("stack program", board_stack_peak());
    return 0;
}
