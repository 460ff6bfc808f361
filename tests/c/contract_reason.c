/* Why a picture was refused: reasons in words, and the numbers of pixels. */
#include "contract.h"

static struct {
    ofc_pixel_counts counts;
    ofc_reason reason;
    ofc_solution solution;
} out;

static void words(void **state)
{
    (void)state;
    static const ofc_reason all[] = {
        OFC_REASON_NONE,           OFC_REASON_UNKNOWN,   OFC_REASON_MASK_EMPTY, OFC_REASON_MASK_INVERTED, OFC_REASON_TOO_FEW_PIXELS,
        OFC_REASON_NOT_FINITE,     OFC_REASON_SATURATED, OFC_REASON_DARK,       OFC_REASON_CHANNEL_DEAD,  OFC_REASON_GRAY,
        OFC_REASON_TOO_FEW_LIGHTS, OFC_REASON_LIGHTS_COPLANAR, OFC_REASON_VIGNETTE, OFC_REASON_FLAT,      OFC_REASON_CYLINDER,
        OFC_REASON_CONVEX_OR_HOLLOW, OFC_REASON_TWO_PAINTS, OFC_REASON_BACKGROUND, OFC_REASON_OUTLIERS};
    /* The numbers are never reused. */
    static const ofc_reason numbers[] = {0, 1, 10, 11, 12, 13, 20, 21, 22, 23, 30, 31, 32, 40, 41, 42, 50, 51, 52};
    const size_t count = sizeof all / sizeof *all;
    assert_int_equal(count, sizeof numbers / sizeof *numbers);
    const char *unknown = ofc_reason_message(12345), *no_advice = ofc_reason_advice(12345);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(all[i], numbers[i]);
        assert_string_not_equal(ofc_reason_message(all[i]), unknown);
        assert_string_not_equal(ofc_reason_advice(all[i]), no_advice);
        for (size_t j = 0; j < i; j++)
            assert_string_not_equal(ofc_reason_message(all[i]), ofc_reason_message(all[j]));
    }
    /* Any number has words. */
    static const ofc_reason others[] = {INT32_MIN, -1, 2, 9, 14, 53, INT32_MAX};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        assert_string_equal(ofc_reason_message(others[i]), unknown);
        assert_string_equal(ofc_reason_advice(others[i]), no_advice);
    }
}

static ofc_status count(const ofc_image *image)
{
    return ofc_pixel_counts_compute(image, &stages.params, workspace, sizeof workspace, &out.counts, &out.reason);
}

static void bad_arguments(void **state)
{
    (void)state;
    refuses_bad_images(count, &out, sizeof out);
    const ofc_image image = ball_image();
    const ofc_solve_params *params = &stages.params;
    const size_t need = ofc_solve_workspace_size(WIDTH, HEIGHT, params);
#define COUNT(params, space, bytes, counts, reason) ofc_pixel_counts_compute(&image, params, space, bytes, counts, reason)
    REFUSED(OFC_STATUS_NULL_POINTER, out, COUNT(NULL, workspace, need, &out.counts, &out.reason));
    REFUSED(OFC_STATUS_NULL_POINTER, out, COUNT(params, NULL, need, &out.counts, &out.reason));
    REFUSED(OFC_STATUS_NULL_POINTER, out, COUNT(params, workspace, need, NULL, &out.reason));
    REFUSED(OFC_STATUS_NULL_POINTER, out, COUNT(params, workspace, need, &out.counts, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, COUNT(MISALIGNED(params), workspace, need, &out.counts, &out.reason));
    REFUSED(OFC_STATUS_MISALIGNED, out, COUNT(params, MISALIGNED(workspace), need, &out.counts, &out.reason));
    REFUSED(OFC_STATUS_MISALIGNED, out, COUNT(params, workspace, need, MISALIGNED(&out.counts), &out.reason));
    REFUSED(OFC_STATUS_MISALIGNED, out, COUNT(params, workspace, need, &out.counts, MISALIGNED(&out.reason)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, COUNT(params, workspace, need - 1, &out.counts, &out.reason));
    REFUSED(OFC_STATUS_OVERLAP, out, COUNT(params, workspace, need, (ofc_pixel_counts *)workspace, &out.reason));
    REFUSED(OFC_STATUS_OVERLAP, out, COUNT(params, workspace, need, &out.counts, (ofc_reason *)&out.counts));
    ofc_solve_params bad = *params;
    bad.convexity = 3;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, COUNT(&bad, workspace, need, &out.counts, &out.reason));
    bad = *params;
    bad.reserved[0] = 1;
    REFUSED(OFC_STATUS_RESERVED_NOT_ZERO, out, COUNT(&bad, workspace, need, &out.counts, &out.reason));
}

static void counts_and_reasons(void **state)
{
    (void)state;
    static uint8_t pixels[HEIGHT][WIDTH][3], mask[PIXELS];
    ofc_image image = ball_image();
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(count(&image), OFC_STATUS_OK);
    assert_true(is_untouched(&out.solution, sizeof out.solution));
    assert_int_equal(out.reason, OFC_REASON_NONE);
    assert_int_equal(out.counts.usable, stages.solution.pixel_counts.usable);
    assert_int_equal(out.counts.usable + out.counts.dark, PIXELS);
    /* The mask of nothing, and the mask of the black background. */
    image.mask = mask;
    image.mask_stride_bytes = WIDTH;
    assert_int_equal(count(&image), OFC_STATUS_OK);
    assert_true(out.reason == OFC_REASON_MASK_EMPTY && out.counts.masked_out == PIXELS);
    for (int i = 0; i < PIXELS; i++)
        mask[i] = (&ball[0][0][0])[3 * i] == 0;
    assert_int_equal(count(&image), OFC_STATUS_OK);
    assert_true(out.reason == OFC_REASON_MASK_INVERTED && out.counts.usable == 0);
    image.mask = NULL;
    image.pixels = pixels;
    assert_int_equal(count(&image), OFC_STATUS_OK);
    assert_true(out.reason == OFC_REASON_DARK && out.counts.dark == PIXELS);
    memset(pixels, 255, sizeof pixels);
    assert_int_equal(count(&image), OFC_STATUS_OK);
    assert_true(out.reason == OFC_REASON_SATURATED && out.counts.saturated == PIXELS);
}

static void reason_of_a_solution(void **state)
{
    (void)state;
    const ofc_image good = ball_image();
    ofc_solve_params params;
    ofc_solve_params_default(&params);
    assert_int_equal(ofc_solve(&good, &params, workspace, sizeof workspace, NULL, &out.solution), OFC_STATUS_OK);
    assert_true(out.solution.reason == OFC_REASON_NONE && out.solution.reason_channel == -1);
    assert_true(out.solution.reason_value == 0 && out.solution.reason_limit == 0);
    /* One color: a plane, and the ranks say so too. */
    static uint8_t pixels[HEIGHT][WIDTH][3];
    memset(pixels, 90, sizeof pixels);
    ofc_image image = good;
    image.pixels = pixels;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &out.solution), OFC_STATUS_RANK_DEFICIENT);
    assert_int_equal(out.solution.reason, OFC_REASON_FLAT);
    assert_true(out.solution.rank.colors == 1 && out.solution.rank.normals == 1);
    assert_true(out.solution.reason_value < out.solution.reason_limit && out.solution.reason_channel == -1);
    /* The ball without its blue. */
    memcpy(pixels, ball, sizeof pixels);
    for (int i = 0; i < PIXELS; i++)
        (&pixels[0][0][0])[3 * i + 2] = 0;
    assert_true(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &out.solution) > 0);
    assert_true(out.solution.reason == OFC_REASON_CHANNEL_DEAD && out.solution.reason_channel == 2);
    assert_true(out.solution.orientation.rank == 0 && isnan(out.solution.confidence.error_rad));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(counts_and_reasons),
        cmocka_unit_test(reason_of_a_solution),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
