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
    assert_int_equal(solution.pixel_counts.masked_out, expected.pixel_counts.dark);
    assert_int_equal(solution.pixel_counts.dark, 0);
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
    assert_int_equal(solution.pixel_counts.non_finite, 3);
    assert_int_equal(solution.pixel_counts.saturated, 2);
    assert_int_equal(solution.pixel_counts.usable, expected.pixel_counts.usable - 5);
}

static struct {
    float pixels[HEIGHT][WIDTH + 1][3];
    ofc_flat_field_result result;
} flat;

static uint8_t background[HEIGHT][WIDTH][3];

static ofc_status divided(const ofc_image *image)
{
    ofc_image below = ball_image();
    below.pixels = background;
    return ofc_flat_field(image, &below, flat.pixels[0][0], sizeof flat.pixels[0], &flat.result);
}

static ofc_status divided_by(const ofc_image *below)
{
    const ofc_image image = ball_image();
    return ofc_flat_field(&image, below, flat.pixels[0][0], sizeof flat.pixels[0], &flat.result);
}

static void flat_field(void **state)
{
    (void)state;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++)
                background[y][x][c] = (uint8_t)(60 + x + 10 * c);
    refuses_bad_images(divided, &flat, sizeof flat);
    refuses_bad_images(divided_by, &flat, sizeof flat);
    const ofc_image image = ball_image();
    ofc_image below = image;
    below.pixels = background;
#define DIVIDE(below, pixels, stride, result) ofc_flat_field(&image, below, pixels, stride, result)
    REFUSED(OFC_STATUS_NULL_POINTER, flat, DIVIDE(&below, NULL, sizeof flat.pixels[0], &flat.result));
    REFUSED(OFC_STATUS_NULL_POINTER, flat, DIVIDE(&below, flat.pixels[0][0], sizeof flat.pixels[0], NULL));
    REFUSED(OFC_STATUS_MISALIGNED, flat, DIVIDE(&below, MISALIGNED(flat.pixels), sizeof flat.pixels[0], &flat.result));
    REFUSED(OFC_STATUS_MISALIGNED, flat, DIVIDE(&below, flat.pixels[0][0], WIDTH * 12 + 2, &flat.result));
    REFUSED(OFC_STATUS_MISALIGNED, flat, DIVIDE(&below, flat.pixels[0][0], WIDTH * 12, MISALIGNED(&flat.result)));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, flat, DIVIDE(&below, flat.pixels[0][0], WIDTH * 12 - 4, &flat.result));
    REFUSED(OFC_STATUS_TOO_LARGE, flat, DIVIDE(&below, flat.pixels[0][0], SIZE_MAX - 3, &flat.result));
    REFUSED(OFC_STATUS_OVERLAP, flat, DIVIDE(&below, (float *)(void *)background, WIDTH * 12, &flat.result));
    REFUSED(OFC_STATUS_OVERLAP, flat,
            DIVIDE(&below, flat.pixels[0][0], WIDTH * 12, (ofc_flat_field_result *)(void *)flat.pixels));
    below.height--;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, flat, DIVIDE(&below, flat.pixels[0][0], sizeof flat.pixels[0], &flat.result));
    static uint8_t black[HEIGHT][WIDTH][3];
    below = image;
    below.pixels = black;
    REFUSED(OFC_STATUS_DARK, flat, DIVIDE(&below, flat.pixels[0][0], sizeof flat.pixels[0], &flat.result));
    below.pixels = background;
    background[7][9][1] = 0;
    background[8][9][2] = 255;
    memset(&flat, PATTERN, sizeof flat);
    assert_int_equal(DIVIDE(&below, flat.pixels[0][0], sizeof flat.pixels[0], &flat.result), OFC_STATUS_OK);
    assert_int_equal(flat.result.dark, 1);
    assert_int_equal(flat.result.used + flat.result.saturated, PIXELS - 1);
    assert_true(flat.result.saturated >= 1 && flat.result.mean[0] > 100 && flat.result.mean[2] > flat.result.mean[0]);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++) {
                const float value = flat.pixels[y][x][c];
                const double expected = ball[y][x][c] * flat.result.mean[c] / background[y][x][c];
                assert_true(isnan(value) || fabs(value - expected) < 1e-4 * expected + 1e-6);
            }
        assert_true(is_untouched(flat.pixels[y][WIDTH], sizeof flat.pixels[y][WIDTH]));
    }
    assert_true(isnan(flat.pixels[7][9][0]) && isnan(flat.pixels[8][9][0]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interleaved),
        cmocka_unit_test(three_planes),
        cmocka_unit_test(masks),
        cmocka_unit_test(pixels_that_are_left_out), cmocka_unit_test(flat_field),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
