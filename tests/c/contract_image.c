/* The same picture in every format, stride and alignment gives the same bits. */
#include "contract.h"

static ofc_solution expected;

static void solves_to_expected(const ofc_image *image)
{
    ofc_solution solution;
    memset(&solution, 0, sizeof solution);
    memset(workspace, PATTERN, sizeof workspace);
    ofc_solve_params params = stages.params;
    params.lmeds.saturation = 255; /* the same for every type */
    assert_int_equal(ofc_solve(image, &params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    /* But for the noise that colors are compared with: integers are known to be rounded. */
    assert_true(solution.rank.color_noise <= expected.rank.color_noise);
    solution.rank.color_noise = expected.rank.color_noise;
    assert_memory_equal(&solution, &expected, sizeof solution);
}

static int prepare(void **state)
{
    if (prepare_stages(state) != 0)
        return -1;
    const ofc_image image = ball_image();
    ofc_solve_params params = stages.params;
    params.lmeds.saturation = 255;
    memset(&expected, 0, sizeof expected);
    return ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &expected) == OFC_STATUS_OK ? 0 : -1;
}

/* Room for the widest format with padded rows, and a byte to misalign it. */
static uint8_t buffer[HEIGHT * (WIDTH * 16 + 7) + 16], planes[2][HEIGHT * (WIDTH * 4 + 7) + 16];

static void store(uint8_t *at, int sample_bytes, uint8_t value)
{
    const uint16_t wide = value;
    const float real = value;
    if (sample_bytes == 1)
        *at = value;
    else
        memcpy(at, sample_bytes == 2 ? (const void *)&wide : (const void *)&real, (size_t)sample_bytes);
}

static void interleaved(void **state)
{
    (void)state;
    static const int positions[][3] = {{0, 1, 2}, {2, 1, 0}, {0, 1, 2}, {2, 1, 0}};
    static const int bases[] = {OFC_PIXEL_RGB8, OFC_PIXEL_RGB16, OFC_PIXEL_RGB32F}, bytes[] = {1, 2, 4};
    for (int type = 0; type < 3; type++)
        for (int order = 0; order < 4; order++)
            for (int padding = 0; padding < 8; padding += 7)
                for (int shift = 0; shift < 2; shift++) {
                    const int samples = order < 2 ? 3 : 4;
                    const size_t stride = (size_t)(WIDTH * samples * bytes[type] + padding);
                    memset(buffer, PATTERN, sizeof buffer); /* the fourth sample and the padding do not matter */
                    for (int y = 0; y < HEIGHT; y++)
                        for (int x = 0; x < WIDTH; x++)
                            for (int c = 0; c < 3; c++)
                                store(buffer + shift + (size_t)y * stride +
                                          (size_t)((x * samples + positions[order][c]) * bytes[type]),
                                      bytes[type], ball[y][x][c]);
                    ofc_image image = ball_image();
                    image.pixels = buffer + shift;
                    image.row_stride_bytes = stride;
                    image.format = bases[type] + order;
                    solves_to_expected(&image);
                }
}

static void three_planes(void **state)
{
    (void)state;
    static const int formats[] = {OFC_PIXEL_PLANES8, OFC_PIXEL_PLANES16, OFC_PIXEL_PLANES32F}, bytes[] = {1, 2, 4};
    for (int type = 0; type < 3; type++)
        for (int shift = 0; shift < 2; shift++) {
            const size_t stride = (size_t)(WIDTH * bytes[type] + 7 * shift);
            uint8_t *starts[3] = {buffer + shift, planes[0] + shift, planes[1] + shift};
            for (int y = 0; y < HEIGHT; y++)
                for (int x = 0; x < WIDTH; x++)
                    for (int c = 0; c < 3; c++)
                        store(starts[c] + (size_t)y * stride + (size_t)(x * bytes[type]), bytes[type], ball[y][x][c]);
            ofc_image image = ball_image();
            image.pixels = starts[0];
            image.green_plane = starts[1];
            image.blue_plane = starts[2];
            image.row_stride_bytes = stride;
            image.format = formats[type];
            solves_to_expected(&image);
        }
}

static void masks(void **state)
{
    (void)state;
    /* A mask leaves out just what black pixels leave out, and may be strided. */
    static uint8_t mask[HEIGHT][WIDTH + 5];
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            mask[y][x] = (ball[y][x][0] | ball[y][x][1] | ball[y][x][2]) ? (uint8_t)(1 + x) : 0;
    ofc_image image = ball_image();
    image.mask = &mask[0][0];
    image.mask_stride_bytes = sizeof mask[0];
    ofc_solution solution;
    ofc_solve_params params = stages.params;
    params.lmeds.saturation = 255;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    assert_int_equal(solution.census.masked_out, expected.census.dark);
    assert_int_equal(solution.census.dark, 0);
    assert_memory_equal(&solution.orientation, &expected.orientation, sizeof solution.orientation);
    image.mask_stride_bytes = SIZE_MAX;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_TOO_LARGE);
}

static void pixels_that_are_left_out(void **state)
{
    (void)state;
    static float floats[HEIGHT][WIDTH][3];
    for (int i = 0; i < PIXELS * 3; i++)
        (&floats[0][0][0])[i] = (&ball[0][0][0])[i];
    floats[40][45][0] = NAN;
    floats[40][46][1] = INFINITY;
    floats[40][47][2] = -INFINITY;
    floats[41][45][2] = 255;
    floats[41][46][0] = 1e30F;
    ofc_image image = ball_image();
    image.pixels = floats;
    image.format = OFC_PIXEL_RGB32F;
    image.row_stride_bytes = sizeof floats[0];
    ofc_solution solution;
    ofc_solve_params params = stages.params;
    params.lmeds.saturation = 255;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    assert_int_equal(solution.census.non_finite, 3);
    assert_int_equal(solution.census.saturated, 2);
    assert_int_equal(solution.census.usable, expected.census.usable - 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interleaved),
        cmocka_unit_test(three_planes),
        cmocka_unit_test(masks),
        cmocka_unit_test(pixels_that_are_left_out),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
