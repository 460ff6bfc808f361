/* What files hold, made what the model wants: transfer curves, saturation, dark frames and offsets. */
#include "contract.h"

enum { SAMPLE = 600 };

static struct {
    float pixels[HEIGHT][WIDTH + 1][3];
    float table[65536];
    double level;
    int32_t count;
    ofc_offset offset;
} out;

static float table[256];
static uint64_t space[OFC_OFFSET_WORKSPACE_SIZE(SAMPLE) / 8 + 1];

static int prepare(void **state)
{
    return prepare_stages(state) == 0 && ofc_transfer_table(OFC_TRANSFER_SRGB, 0, 256, table) == OFC_STATUS_OK ? 0 : -1;
}

static ofc_status linear(const ofc_image *image)
{
    return ofc_transfer_linearize(image, OFC_TRANSFER_SRGB, 0, NULL, 0, out.pixels[0][0], sizeof out.pixels[0]);
}

static void curves(void **state)
{
    (void)state;
    refuses_bad_images(linear, &out, sizeof out);
    const ofc_image image = ball_image();
    const size_t row = sizeof out.pixels[0];
    float *const pixels = out.pixels[0][0];
#define LINEARIZE(...) ofc_transfer_linearize(&image, __VA_ARGS__)
    REFUSED(OFC_STATUS_NULL_POINTER, out, LINEARIZE(OFC_TRANSFER_SRGB, 0, NULL, 0, NULL, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, LINEARIZE(OFC_TRANSFER_SRGB, 0, NULL, 0, MISALIGNED(pixels), row));
    REFUSED(OFC_STATUS_MISALIGNED, out, LINEARIZE(OFC_TRANSFER_SRGB, 0, NULL, 0, pixels, row + 2));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, LINEARIZE(OFC_TRANSFER_SRGB, 0, NULL, 0, pixels, WIDTH * 12 - 4));
    REFUSED(OFC_STATUS_TOO_LARGE, out, LINEARIZE(OFC_TRANSFER_SRGB, 0, NULL, 0, pixels, SIZE_MAX - 3));
    REFUSED(OFC_STATUS_OVERLAP, out, LINEARIZE(OFC_TRANSFER_SRGB, 0, NULL, 0, (float *)(void *)ball, WIDTH * 12));
    for (ofc_transfer bad = -1; bad <= 4; bad++)
        if (bad < OFC_TRANSFER_SRGB || bad > OFC_TRANSFER_TABLE)
            REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LINEARIZE(bad, 2, NULL, 0, pixels, row));
    const double exponents[] = {0, -1, 0.09, 10.1, NAN, INFINITY};
    for (int i = 0; i < 6; i++) {
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LINEARIZE(OFC_TRANSFER_GAMMA, exponents[i], NULL, 0, pixels, row));
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_transfer_table(OFC_TRANSFER_GAMMA, exponents[i], 256, out.table));
    }
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LINEARIZE(OFC_TRANSFER_SRGB, 0, table, 256, pixels, row));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LINEARIZE(OFC_TRANSFER_SRGB, 0, NULL, 256, pixels, row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, LINEARIZE(OFC_TRANSFER_TABLE, 0, NULL, 256, pixels, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, LINEARIZE(OFC_TRANSFER_TABLE, 0, MISALIGNED(table), 255, pixels, row));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LINEARIZE(OFC_TRANSFER_TABLE, 0, table, 255, pixels, row));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LINEARIZE(OFC_TRANSFER_TABLE, 0, table, 0, pixels, row));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LINEARIZE(OFC_TRANSFER_TABLE, 0, table, -1, pixels, row));
    REFUSED(OFC_STATUS_OVERLAP, out, LINEARIZE(OFC_TRANSFER_TABLE, 0, pixels, 256, pixels, row));
    table[7] = NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LINEARIZE(OFC_TRANSFER_TABLE, 0, table, 256, pixels, row));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_transfer_table(OFC_TRANSFER_TABLE, 1, 256, out.table));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_transfer_table(OFC_TRANSFER_SRGB, 1, 255, out.table));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_transfer_table(OFC_TRANSFER_SRGB, 1, -1, out.table));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_transfer_table(OFC_TRANSFER_SRGB, 1, 256, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_transfer_table(OFC_TRANSFER_SRGB, 1, 256, MISALIGNED(out.table)));

    memset(&out, PATTERN, sizeof out);
    assert_int_equal(ofc_transfer_table(OFC_TRANSFER_GAMMA, 2, 65536, out.table), OFC_STATUS_OK);
    assert_true(out.table[0] == 0 && out.table[65535] == 65535 && fabs(out.table[32768] - 16384.25) < 1);
    assert_int_equal(ofc_transfer_table(OFC_TRANSFER_SRGB, 0, 256, table), OFC_STATUS_OK);
    assert_int_equal(LINEARIZE(OFC_TRANSFER_SRGB, NAN, NULL, 0, pixels, row), OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++) {
                const double stored = ball[y][x][c] / 255.0;
                const double light = stored <= 0.04045 ? stored / 12.92 : pow((stored + 0.055) / 1.055, 2.4);
                assert_true(fabs(out.pixels[y][x][c] - 255 * light) < 1e-4 && out.pixels[y][x][c] == table[ball[y][x][c]]);
            }
        assert_true(is_untouched(out.pixels[y][WIDTH], sizeof out.pixels[y][WIDTH]));
    }
    /* The same through the table. */
    static float before[HEIGHT][WIDTH + 1][3];
    memcpy(before, out.pixels, sizeof before);
    assert_int_equal(LINEARIZE(OFC_TRANSFER_TABLE, 0, table, 256, pixels, row), OFC_STATUS_OK);
    assert_memory_equal(before, out.pixels, sizeof before);
}

static ofc_status level_of(const ofc_image *image)
{
    return ofc_saturation_find(image, &out.level, &out.count);
}

static void saturation(void **state)
{
    (void)state;
    refuses_bad_images(level_of, &out, sizeof out);
    ofc_image image = ball_image();
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_saturation_find(&image, NULL, &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_saturation_find(&image, MISALIGNED(&out.level), &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_saturation_find(&image, &out.level, MISALIGNED(&out.count)));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_saturation_find(&image, &out.level, (int32_t *)(void *)&out.level));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_saturation_find(&image, (double *)(void *)ball, &out.count));
    assert_int_equal(level_of(&image), OFC_STATUS_OK);
    assert_true(out.level == 0 && out.count == 0);
    /* Twelve bits in sixteen, overexposed. */
    static uint16_t clipped[HEIGHT][WIDTH][3];
    int expected = 0;
    for (int i = 0; i < PIXELS * 3; i++) {
        const int value = 40 * (&ball[0][0][0])[i];
        (&clipped[0][0][0])[i] = (uint16_t)(value < 4095 ? value : 4095);
    }
    for (int i = 0; i < PIXELS; i++) {
        const uint16_t *const color = &clipped[0][0][0] + 3 * i;
        expected += color[0] == 4095 || color[1] == 4095 || color[2] == 4095;
    }
    image.pixels = clipped;
    image.format = OFC_PIXEL_RGB16;
    image.row_stride_bytes = sizeof clipped[0];
    assert_int_equal(level_of(&image), OFC_STATUS_OK);
    assert_true(out.level == 4095 && out.count == expected && expected > 100);
    out.level = 0;
    assert_int_equal(ofc_saturation_find(&image, &out.level, NULL), OFC_STATUS_OK);
    assert_true(out.level == 4095);
}

static const double room[3] = {20, 25, 15};

static ofc_status less_offset(const ofc_image *image)
{
    return ofc_offset_subtract(image, room, out.pixels[0][0], sizeof out.pixels[0]);
}

static uint8_t dark[HEIGHT][WIDTH][3];

static ofc_status less_dark(const ofc_image *image)
{
    ofc_image below = ball_image();
    below.pixels = dark;
    return ofc_dark_subtract(image, &below, out.pixels[0][0], sizeof out.pixels[0]);
}

static ofc_status dark_of(const ofc_image *below)
{
    const ofc_image image = ball_image();
    return ofc_dark_subtract(&image, below, out.pixels[0][0], sizeof out.pixels[0]);
}

static void subtraction(void **state)
{
    (void)state;
    refuses_bad_images(less_offset, &out, sizeof out);
    refuses_bad_images(less_dark, &out, sizeof out);
    refuses_bad_images(dark_of, &out, sizeof out);
    const ofc_image image = ball_image();
    ofc_image below = image;
    below.pixels = dark;
    for (int i = 0; i < PIXELS * 3; i++)
        (&dark[0][0][0])[i] = (uint8_t)room[i % 3];
    const size_t row = sizeof out.pixels[0];
    float *const pixels = out.pixels[0][0];
    const double bad[3] = {0, NAN, 0}, endless[3] = {0, 0, INFINITY};
#define LESS(offset, pixels, row) ofc_offset_subtract(&image, offset, pixels, row)
#define DARK(pixels, row) ofc_dark_subtract(&image, &below, pixels, row)
    REFUSED(OFC_STATUS_NULL_POINTER, out, LESS(NULL, pixels, row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, LESS(room, NULL, row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, DARK(NULL, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, LESS(MISALIGNED(room), pixels, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, LESS(room, MISALIGNED(pixels), row));
    REFUSED(OFC_STATUS_MISALIGNED, out, DARK(MISALIGNED(pixels), row));
    REFUSED(OFC_STATUS_MISALIGNED, out, DARK(pixels, row + 1));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, LESS(room, pixels, WIDTH * 12 - 4));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, DARK(pixels, WIDTH * 12 - 4));
    REFUSED(OFC_STATUS_TOO_LARGE, out, LESS(room, pixels, SIZE_MAX - 3));
    REFUSED(OFC_STATUS_TOO_LARGE, out, DARK(pixels, SIZE_MAX - 3));
    REFUSED(OFC_STATUS_OVERLAP, out, LESS(room, (float *)(void *)ball, WIDTH * 12));
    REFUSED(OFC_STATUS_OVERLAP, out, DARK((float *)(void *)dark, WIDTH * 12));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LESS(bad, pixels, row));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LESS(endless, pixels, row));
    below.height--;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, DARK(pixels, row));
    below.height++;
    below.format = OFC_PIXEL_RGB16;
    below.width = below.width / 2;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, DARK(pixels, row));
    below = image;
    below.pixels = dark;
    static float by_color[HEIGHT][WIDTH + 1][3];
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(LESS(room, pixels, row), OFC_STATUS_OK);
    memcpy(by_color, out.pixels, sizeof by_color);
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(DARK(pixels, row), OFC_STATUS_OK);
    assert_memory_equal(by_color, out.pixels, sizeof by_color);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++)
                assert_true(by_color[y][x][c] == (float)(ball[y][x][c] - room[c]) || ball[y][x][c] == 255);
        assert_true(is_untouched(out.pixels[y][WIDTH], sizeof out.pixels[y][WIDTH]));
    }
}

static ofc_status offset_of(const ofc_image *image)
{
    return ofc_offset_fit(image, NULL, stages.solution.ellipsoid.c, SAMPLE, space, sizeof space, &out.offset);
}

static void offset(void **state)
{
    (void)state;
    const ofc_ellipsoid *const e = &stages.solution.ellipsoid;
    const double c[6] = {e->c[0], e->c[4], e->c[8], e->c[1], e->c[2], e->c[5]};
    refuses_bad_images(offset_of, &out, sizeof out);
    ofc_image image = ball_image();
    const ofc_inlier_test *const test = &stages.solution.inlier_test;
    const size_t need = ofc_offset_workspace_size(SAMPLE);
    assert_int_equal(need, OFC_OFFSET_WORKSPACE_SIZE(SAMPLE));
    assert_int_equal(ofc_offset_workspace_size(-1), 0);
#define FIT(...) ofc_offset_fit(&image, __VA_ARGS__)
    REFUSED(OFC_STATUS_NULL_POINTER, out, FIT(test, NULL, SAMPLE, space, need, &out.offset));
    REFUSED(OFC_STATUS_NULL_POINTER, out, FIT(test, c, SAMPLE, NULL, need, &out.offset));
    REFUSED(OFC_STATUS_NULL_POINTER, out, FIT(test, c, SAMPLE, space, need, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, FIT(MISALIGNED(test), c, SAMPLE, space, need, &out.offset));
    REFUSED(OFC_STATUS_MISALIGNED, out, FIT(test, MISALIGNED(c), SAMPLE, space, need, &out.offset));
    REFUSED(OFC_STATUS_MISALIGNED, out, FIT(test, c, SAMPLE, MISALIGNED(space), need, &out.offset));
    REFUSED(OFC_STATUS_MISALIGNED, out, FIT(test, c, SAMPLE, space, need, MISALIGNED(&out.offset)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, FIT(test, c, SAMPLE, space, need - 1, &out.offset));
    REFUSED(OFC_STATUS_OVERLAP, out, FIT(test, c, SAMPLE, space, need, (ofc_offset *)space));
    const int32_t sizes[] = {59, 0, -1, INT32_MIN};
    for (int i = 0; i < 4; i++)
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, FIT(test, c, sizes[i], space, need, &out.offset));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, FIT(test, c, INT32_MAX, space, need, &out.offset));
    for (int i = 0; i < 6; i++) {
        double bad[6];
        memcpy(bad, c, sizeof bad);
        bad[i] = i % 2 == 0 ? NAN : INFINITY;
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, FIT(test, bad, SAMPLE, space, need, &out.offset));
        bad[i] = i < 3 ? -1 : 1e9;
        REFUSED(OFC_STATUS_NOT_POSITIVE_DEFINITE, out, FIT(test, bad, SAMPLE, space, need, &out.offset));
    }
    ofc_inlier_test none = *test;
    none.saturation = 1;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, FIT(&none, c, SAMPLE, space, need, &out.offset));

    /* Room light, as far as the first round finds it. */
    static uint8_t lit[HEIGHT][WIDTH][3];
    for (int i = 0; i < PIXELS * 3; i++) {
        const uint8_t value = (&ball[0][0][0])[i];
        (&lit[0][0][0])[i] = (uint8_t)(value == 0 || value > 225 ? 0 : value + 30);
    }
    image.pixels = lit;
    ofc_solution solution;
    assert_int_equal(ofc_solve(&image, &stages.params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    const double *const found = solution.ellipsoid.c;
    const double around[6] = {found[0], found[4], found[8], found[1], found[2], found[5]};
    memset(&out, PATTERN, sizeof out);
    memset(space, PATTERN, sizeof space);
    assert_int_equal(FIT(&solution.inlier_test, around, SAMPLE, space, need, &out.offset), OFC_STATUS_OK);
    for (int channel = 0; channel < 3; channel++)
        assert_true(fabs(out.offset.offset[channel] - 30) < 15);
    assert_true(out.offset.chi_squared > 40 && out.offset.deviation <= out.offset.deviation_around_black);
    assert_true(out.offset.count > 100 && out.offset.count <= SAMPLE && out.offset.blocks > 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curves),
        cmocka_unit_test(saturation),
        cmocka_unit_test(subtraction),
        cmocka_unit_test(offset),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
