/*
 * ofc without an operating system, C library or heap: a frame comes row by row, is solved, and so are the frames after
 * it, from what the first one taught.
 *
 * What is printed after a '#' is read by measure.sh.
 */
#include "board.h"
#include "print.h"
#include "scene.h"

#include <ofc.h>

#define DEGREES 57.2957795f

/* A camera writes here: not counted among the program's own memory. */
__attribute__((section(".frame"))) static uint8_t frame[HEIGHT][WIDTH][3];

enum { SAMPLE = 2000 };
static uint64_t workspace[OFC_SOLVE_WORKSPACE_SIZE_FOR(WIDTH, HEIGHT, SAMPLE) / sizeof(uint64_t)];
static ofc_solution solution;

static void camera(int number)
{
    for (int y = 0; y < HEIGHT; y++)
        scene_row(number, y, frame[y][0]);
}

static ofc_image rows(int first, int count)
{
    const ofc_image image = {.pixels = frame[first],
                             .width = WIDTH,
                             .height = count,
                             .row_stride_bytes = sizeof frame[0],
                             .format = OFC_PIXEL_RGB8};
    return image;
}

static ofc_status cold(void)
{
    const ofc_image image = rows(0, HEIGHT);
    ofc_solve_params params;
    ofc_solve_params_default(&params);
    params.lmeds.sample_size = SAMPLE;
    return ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution);
}

/* The lights have not moved: their F turns the next frame's colors into normals. Returns the mean angle to the truth. */
static ofc_status warm(int number, float *error_deg)
{
    float sum = 0;
    uint32_t count = 0;
    for (int y = 0; y < HEIGHT; y++) {
        static float normals[WIDTH][3];
        const ofc_image image = rows(y, 1);
        const ofc_status status = ofc_normals_compute(&image, &solution, normals[0], sizeof normals);
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

static void report(const char *name, uint64_t instructions)
{
    print_text("# instructions ");
    print_text(name);
    print_text(" ");
    print_integer((uint32_t)instructions);
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
    uint64_t start = board_instructions();
    camera(0);
    report("render", board_instructions() - start);

    start = board_instructions();
    ofc_status status = cold();
    report("cold", board_instructions() - start);

    for (int number = 0; number < 3 && status == OFC_STATUS_OK; number++) {
        float error_deg = 0;
        camera(number);
        start = board_instructions();
        status = warm(number, &error_deg);
        report(number == 0 ? "normals" : "warm", board_instructions() - start);
        print_text("frame ");
        print_integer((uint32_t)number);
        print_text(": mean angle to the true normals ");
        print_decimal(error_deg);
        print_text(" degrees\n");
        if (error_deg > 4)
            return 2;
    }
    if (status != OFC_STATUS_OK) {
        print_text(ofc_status_message(status));
        print_text("\n");
        return 1;
    }
    for (int c = 0; c < 3; c++)
        print_lamp(c);
    print_text("# stack ");
    print_integer(board_stack_peak());
    print_text("\n");
    return 0;
}
