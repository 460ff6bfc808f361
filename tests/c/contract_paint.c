/* Uneven paint. */
#include "contract.h"

static struct {
    ofc_paint_params params;
    ofc_paint paint;
    float albedo[HEIGHT][WIDTH + 2];
    float pixels[HEIGHT][3 * WIDTH + 2];
} out;

static ofc_paint_params params;
static uint64_t space[OFC_LARGER(OFC_PAINT_WORKSPACE_SIZE, OFC_PAINT_ALBEDO_WORKSPACE_SIZE(WIDTH, HEIGHT)) / 8 + 1];

static int prepare(void **state)
{
    return prepare_stages(state) == 0 && ofc_paint_params_default(&params) == OFC_STATUS_OK ? 0 : -1;
}

/* The ball, its lower half painted darker. */
static ofc_image painted_image(void)
{
    static uint8_t painted[HEIGHT][WIDTH][3];
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++)
                painted[y][x][c] = (uint8_t)(ball[y][x][c] * (y < HEIGHT / 2 ? 1 : 0.6));
    ofc_image image = ball_image();
    image.pixels = painted;
    return image;
}

static ofc_status estimate_of(const ofc_image *image)
{
    return ofc_paint_estimate(image, &params, space, sizeof space, &out.paint);
}

static void estimate(void **state)
{
    (void)state;
    refuses_bad_images(estimate_of, &out, sizeof out);
    ofc_image image = painted_image();
    const size_t need = ofc_paint_workspace_size();
    assert_int_equal(need, OFC_PAINT_WORKSPACE_SIZE);
#define ESTIMATE(params, space, bytes, paint) ofc_paint_estimate(&image, params, space, bytes, paint)
    REFUSED(OFC_STATUS_NULL_POINTER, out, ESTIMATE(NULL, space, need, &out.paint));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ESTIMATE(&params, NULL, need, &out.paint));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ESTIMATE(&params, space, need, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ESTIMATE(MISALIGNED(&params), space, need, &out.paint));
    REFUSED(OFC_STATUS_MISALIGNED, out, ESTIMATE(&params, MISALIGNED(space), need, &out.paint));
    REFUSED(OFC_STATUS_MISALIGNED, out, ESTIMATE(&params, space, need, MISALIGNED(&out.paint)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, ESTIMATE(&params, space, need - 1, &out.paint));
    REFUSED(OFC_STATUS_OVERLAP, out, ESTIMATE(&params, space, need, (ofc_paint *)space));
    ofc_paint_params bad = params;
    bad.saturation = -1;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ESTIMATE(&bad, space, need, &out.paint));
    bad.saturation = NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ESTIMATE(&bad, space, need, &out.paint));
    bad = params;
    bad.reserved[3] = 1;
    REFUSED(OFC_STATUS_RESERVED_NOT_ZERO, out, ESTIMATE(&bad, space, need, &out.paint));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_paint_params_default(NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_paint_params_default(MISALIGNED(&out.params)));

    memset(&out, PATTERN, sizeof out);
    assert_int_equal(estimate_of(&image), OFC_STATUS_OK);
    assert_true(out.paint.verdict == OFC_PAINT_SMOOTH || out.paint.verdict == OFC_PAINT_ROUGH);
    assert_true(out.paint.margin > 2 && out.paint.ratio > 1.7 && out.paint.disagreement < 1.5 && out.paint.reserved == 0);
    assert_true(out.paint.distances[2] == 4 * out.paint.distances[0] && out.paint.pair_counts[0] > 100);
    assert_true(out.paint.pixel_counts.usable > 1000 && out.paint.coefficients[0] > 0);
    assert_true(is_untouched(out.albedo, sizeof out.albedo));

    static uint8_t gray[HEIGHT][WIDTH][3];
    memset(gray, 90, sizeof gray);
    image.pixels = gray;
    assert_int_equal(estimate_of(&image), OFC_STATUS_RANK_DEFICIENT);
    assert_true(out.paint.verdict == OFC_PAINT_UNDETERMINED && out.paint.coefficients[0] == 0 && isnan(out.paint.ratio));
    memset(gray, 0, sizeof gray);
    REFUSED(OFC_STATUS_DARK, out, estimate_of(&image));
    memset(gray, 255, sizeof gray);
    REFUSED(OFC_STATUS_SATURATED, out, estimate_of(&image));
    image.width = 9;
    image.height = 9;
    memset(gray, 90, sizeof gray);
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, estimate_of(&image));
}

static double form[6];

static ofc_status albedo_of(const ofc_image *image)
{
    return ofc_paint_albedo(image, &params, form, space, sizeof space, out.albedo[0], sizeof out.albedo[0]);
}

static ofc_status division_of(const ofc_image *image)
{
    static float albedo[HEIGHT][WIDTH];
    return ofc_paint_divide(image, &params, albedo[0], sizeof albedo[0], out.pixels[0], sizeof out.pixels[0]);
}

static void albedo(void **state)
{
    (void)state;
    ofc_image image = painted_image();
    assert_int_equal(estimate_of(&image), OFC_STATUS_OK);
    for (int i = 0; i < 6; i++)
        form[i] = out.paint.coefficients[i];
    refuses_bad_images(albedo_of, &out, sizeof out);
    const size_t need = ofc_paint_albedo_workspace_size(WIDTH, HEIGHT), stride = sizeof out.albedo[0];
    assert_int_equal(need, OFC_PAINT_ALBEDO_WORKSPACE_SIZE(WIDTH, HEIGHT));
    assert_int_equal(ofc_paint_albedo_workspace_size(HEIGHT, WIDTH), need);
    assert_int_equal(ofc_paint_albedo_workspace_size(0, HEIGHT), 0);
    assert_int_equal(ofc_paint_albedo_workspace_size(INT32_MAX, INT32_MAX), 0);
#define ALBEDO(params, form, space, bytes, albedo, stride)                                                             \
    ofc_paint_albedo(&image, params, form, space, bytes, albedo, stride)
    REFUSED(OFC_STATUS_NULL_POINTER, out, ALBEDO(NULL, form, space, need, out.albedo[0], stride));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ALBEDO(&params, NULL, space, need, out.albedo[0], stride));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ALBEDO(&params, form, NULL, need, out.albedo[0], stride));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ALBEDO(&params, form, space, need, NULL, stride));
    REFUSED(OFC_STATUS_MISALIGNED, out, ALBEDO(MISALIGNED(&params), form, space, need, out.albedo[0], stride));
    REFUSED(OFC_STATUS_MISALIGNED, out, ALBEDO(&params, MISALIGNED(form), space, need, out.albedo[0], stride));
    REFUSED(OFC_STATUS_MISALIGNED, out, ALBEDO(&params, form, MISALIGNED(space), need, out.albedo[0], stride));
    REFUSED(OFC_STATUS_MISALIGNED, out, ALBEDO(&params, form, space, need, MISALIGNED(out.albedo[0]), stride));
    REFUSED(OFC_STATUS_MISALIGNED, out, ALBEDO(&params, form, space, need, out.albedo[0], stride + 1));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, ALBEDO(&params, form, space, need, out.albedo[0], 4 * WIDTH - 4));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, ALBEDO(&params, form, space, need - 1, out.albedo[0], stride));
    REFUSED(OFC_STATUS_OVERLAP, out, ALBEDO(&params, form, space, need, (float *)space, stride));
    const double flat[6] = {1, 1, 0}, unknown[6] = {1, 1, 1, NAN};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ALBEDO(&params, flat, space, need, out.albedo[0], stride));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ALBEDO(&params, unknown, space, need, out.albedo[0], stride));
    ofc_paint_params bad = params;
    bad.saturation = -1;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ALBEDO(&bad, form, space, need, out.albedo[0], stride));
    bad.saturation = 1e-3;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, ALBEDO(&bad, form, space, need, out.albedo[0], stride));

    memset(&out, PATTERN, sizeof out);
    assert_int_equal(albedo_of(&image), OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++)
        assert_true(is_untouched(&out.albedo[y][WIDTH], 2 * sizeof(float)));
    const float upper = out.albedo[HEIGHT / 4][WIDTH / 2], lower = out.albedo[3 * HEIGHT / 4][WIDTH / 2];
    assert_true(isnan(out.albedo[0][0]) && fabs(lower / upper - 0.6) < 0.03);

    static float own[HEIGHT][WIDTH + 2];
    memcpy(own, out.albedo, sizeof own);
    refuses_bad_images(division_of, &out, sizeof out);
    const size_t row = sizeof out.pixels[0];
#define DIVIDE(params, albedo, albedo_stride, pixels, stride)                                                          \
    ofc_paint_divide(&image, params, albedo, albedo_stride, pixels, stride)
    REFUSED(OFC_STATUS_NULL_POINTER, out, DIVIDE(NULL, own[0], stride, out.pixels[0], row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, DIVIDE(&params, NULL, stride, out.pixels[0], row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, DIVIDE(&params, own[0], stride, NULL, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, DIVIDE(MISALIGNED(&params), own[0], stride, out.pixels[0], row));
    REFUSED(OFC_STATUS_MISALIGNED, out, DIVIDE(&params, MISALIGNED(own[0]), stride, out.pixels[0], row));
    REFUSED(OFC_STATUS_MISALIGNED, out, DIVIDE(&params, own[0], stride + 2, out.pixels[0], row));
    REFUSED(OFC_STATUS_MISALIGNED, out, DIVIDE(&params, own[0], stride, MISALIGNED(out.pixels[0]), row));
    REFUSED(OFC_STATUS_MISALIGNED, out, DIVIDE(&params, own[0], stride, out.pixels[0], row + 1));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, DIVIDE(&params, own[0], 4 * WIDTH - 4, out.pixels[0], row));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, DIVIDE(&params, own[0], stride, out.pixels[0], 12 * WIDTH - 4));
    REFUSED(OFC_STATUS_OVERLAP, out, DIVIDE(&params, own[0], stride, own[0], row));
    bad = params;
    bad.reserved[0] = 1;
    REFUSED(OFC_STATUS_RESERVED_NOT_ZERO, out, DIVIDE(&bad, own[0], stride, out.pixels[0], row));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(DIVIDE(&params, own[0], stride, out.pixels[0], row), OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++)
        assert_true(is_untouched(&out.pixels[y][3 * WIDTH], 2 * sizeof(float)));
    /* The paint is gone, and the picture can be solved as it is. */
    const ofc_image even = {.pixels = out.pixels,
                            .width = WIDTH,
                            .height = HEIGHT,
                            .row_stride_bytes = row,
                            .format = OFC_PIXEL_RGB32F};
    static ofc_solution solution;
    assert_int_equal(ofc_solve(&even, &stages.params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    for (int c = 0; c < 3; c++) {
        const double truth = stages.solution.ellipsoid.cosines[c];
        assert_true(fabs(solution.ellipsoid.cosines[c] - truth) < 0.05);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(estimate),
        cmocka_unit_test(albedo),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
