/*
 * ofc without an operating system, C library or heap: a frame comes row by row, is solved, and so are the frames after
 * it, from what the first one taught.
 *
 * What is printed after a '#' is read by run.sh.
 */
#include "board.h"
#include "print.h"
#include "scene.h"

#include <ofc.h>

#define DEGREES 57.2957795f

/* All the memory there is: a row of the camera, one of normals, and the stream's. */
static uint8_t row[WIDTH][3];
static float normals[WIDTH][3];
static uint64_t memory[OFC_STREAM_SIZE(WIDTH, HEIGHT) / sizeof(uint64_t)];
static ofc_stream *stream;
static ofc_solution solution;

static ofc_image camera(int number, int y)
{
    scene_row(number, y, row[0]);
    const ofc_image image = {
        .pixels = row, .width = WIDTH, .height = 1, .row_stride_bytes = sizeof row, .format = OFC_PIXEL_RGB8};
    return image;
}

/* What ofc's calls took: instructions since they were last set to zero, and the most bytes of stack of any call. */
static uint64_t instructions;
static uint32_t stack_in_call;

static uint64_t before_call(void)
{
    board_stack_paint();
    return board_instructions();
}

static ofc_status after_call(uint64_t start, ofc_status status)
{
    instructions += board_instructions() - start;
    const uint32_t taken = board_stack_taken();
    if (taken > stack_in_call)
        stack_in_call = taken;
    return status;
}

/* STATUS = CALL, measured: the start is read before the call is made. */
#define MEASURE(status, call)                                                                                          \
    do {                                                                                                               \
        const uint64_t start = before_call();                                                                          \
        status = after_call(start, call);                                                                              \
    } while (0)

/* One frame through the stream. */
static ofc_status pass(int number, ofc_stream_pass *next)
{
    ofc_status status;
    MEASURE(status, ofc_stream_begin(stream, NULL));
    for (int y = 0; y < HEIGHT && status == OFC_STATUS_OK; y++) {
        const ofc_image image = camera(number, y);
        MEASURE(status, ofc_stream_row(stream, y, &image));
    }
    if (status == OFC_STATUS_OK)
        MEASURE(status, ofc_stream_end(stream, next));
    return status;
}

/* The normals of a frame, and their mean angle to the truth. */
static ofc_status look(int number, float *error_deg)
{
    float sum = 0;
    uint32_t count = 0;
    for (int y = 0; y < HEIGHT; y++) {
        const ofc_image image = camera(number, y);
        ofc_status status;
        MEASURE(status, ofc_stream_normals_row(stream, &image, normals[0]));
        if (status != OFC_STATUS_OK)
            return status;
        for (int x = 0; x < WIDTH; x++) {
            const float *n = normals[x];
            float t[3];
            if (n[2] == 0 || !scene_normal(number, x, y, t))
                continue;
            const float d[3] = {n[0] - t[0], n[1] - t[1], n[2] - t[2]};
            sum += __builtin_sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]); /* the chord of a small angle */
            count++;
        }
    }
    *error_deg = count > 0 ? sum / (float)count * DEGREES : 180;
    return OFC_STATUS_OK;
}

static void report(const char *name, uint32_t value)
{
    print_text("# ");
    print_text(name);
    print_text(" ");
    print_integer(value);
    print_text("\n");
}

static void print_lamp(int c)
{
    const char name[2] = {"rgb"[c], 0};
    print_text(name);
    print_text("  tilt ");
    print_decimal((float)solution.tilts.tilt_rad[c] * DEGREES);
    print_text(" (true ");
    print_decimal(lamps[c].tilt_deg);
    print_text(")  slant ");
    print_decimal((float)solution.slant_rad[c] * DEGREES);
    print_text(" (true ");
    print_decimal(lamps[c].slant_deg);
    print_text(")\n");
}

int main(void)
{
    const uint64_t start = board_instructions();
    for (int y = 0; y < HEIGHT; y++)
        (void)camera(0, y);
    report("instructions render", (uint32_t)(board_instructions() - start));

    /* Cold: the first frame, as often as it takes. */
    ofc_stream_params params;
    ofc_stream_pass next = OFC_PASS_COLORS;
    ofc_status status;
    MEASURE(status, ofc_stream_params_default(&params));
    if (status == OFC_STATUS_OK)
        MEASURE(status, ofc_stream_init(WIDTH, HEIGHT, OFC_PIXEL_RGB8, &params, memory, sizeof memory, &stream));
    instructions = 0;
    while (status == OFC_STATUS_OK && next != OFC_PASS_REFINE)
        status = pass(0, &next);
    report("instructions cold", (uint32_t)instructions);

    for (int number = 0; number < 3 && status == OFC_STATUS_OK; number++) {
        float error_deg = 0;
        instructions = 0;
        if (number > 0) /* warm: the next frame refines what the last one taught */
            status = pass(number, &next);
        if (number == 1)
            report("instructions warm", (uint32_t)instructions);
        instructions = 0;
        if (status == OFC_STATUS_OK)
            status = look(number, &error_deg);
        if (number == 0)
            report("instructions normals", (uint32_t)instructions);
        print_text("frame ");
        print_integer((uint32_t)number);
        print_text(": mean angle to the true normals ");
        print_decimal(error_deg);
        print_text(" degrees\n");
        if (error_deg > 6)
            return 2;
    }
    if (status == OFC_STATUS_OK)
        MEASURE(status, ofc_stream_solution(stream, &solution));
    if (status != OFC_STATUS_OK) {
        print_text(ofc_status_message(status));
        print_text("\n");
        return 1;
    }
    for (int c = 0; c < 3; c++)
        print_lamp(c);
    report("stack call", stack_in_call);
    report("stack program", board_stack_peak());
    return 0;
}
