/* Estimators of the direction and strength of each channel's light. */
#include "contract.h"

static struct {
    ofc_tilts tilts;
    ofc_slant_estimate slants[3], behind;
    ofc_disc disc;
    double norms[3], last;
} out;

static const int32_t steps[] = {1, 0, 0, 1, 2, 1, -1, 3};
static ofc_disc disc = {.x = WIDTH / 2, .y = HEIGHT / 2, .radius_squared = 400};

typedef ofc_status (*tilt_call)(const ofc_image *, const ofc_inlier_test *, ofc_tilts *);

static ofc_status along(const ofc_image *image, const ofc_inlier_test *inliers, ofc_tilts *tilts)
{
    return ofc_tilt_pentland_along(image, inliers, steps, 4, tilts);
}

static ofc_status chojnacki(const ofc_image *image, const ofc_inlier_test *inliers, ofc_tilts *tilts)
{
    return ofc_tilt_chojnacki(image, inliers, &disc, tilts);
}

static tilt_call tilt;
static ofc_status tilt_of(const ofc_image *image)
{
    return tilt(image, &stages.solution.inlier_test, &out.tilts);
}

static void tilts(void **state)
{
    (void)state;
    static const tilt_call calls[] = {ofc_tilt_pentland, ofc_tilt_lee_rosenfeld, ofc_tilt_zheng_chellappa, along,
                                      chojnacki};
    static uint8_t gray[HEIGHT][WIDTH][3];
    memset(gray, 77, sizeof gray);
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
        tilt = calls[i];
        refuses_bad_images(tilt_of, &out, sizeof out);
        ofc_image image = ball_image();
        ofc_inlier_test *inliers = &stages.solution.inlier_test;
        REFUSED(OFC_STATUS_NULL_POINTER, out, tilt(&image, inliers, NULL));
        REFUSED(OFC_STATUS_MISALIGNED, out, tilt(&image, MISALIGNED(inliers), &out.tilts));
        REFUSED(OFC_STATUS_MISALIGNED, out, tilt(&image, inliers, MISALIGNED(&out.tilts)));
        REFUSED(OFC_STATUS_OVERLAP, out, tilt(&image, inliers, (ofc_tilts *)inliers));
        REFUSED(OFC_STATUS_OVERLAP, out, tilt(&image, inliers, (ofc_tilts *)(void *)&image));
        memset(&out, PATTERN, sizeof out);
        assert_int_equal(tilt(&image, NULL, &out.tilts), OFC_STATUS_OK);
        assert_true(is_untouched(out.slants, sizeof out.slants));
        for (int c = 0; c < 3; c++) /* the ball is round: every estimator sees roughly the same */
            assert_true(fabs(remainder(out.tilts.tilt_rad[c] - stages.solution.tilts.tilt_rad[c], 6.2831853)) < 0.7);
        image.pixels = gray;
        REFUSED(OFC_STATUS_NO_TILT, out, tilt(&image, NULL, &out.tilts));
        image.height = 1;
        image.width = 1;
        REFUSED(OFC_STATUS_NO_TILT, out, tilt(&image, NULL, &out.tilts));
    }
}

static void pentland_along(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
#define ALONG(steps, count) ofc_tilt_pentland_along(&image, NULL, steps, count, &out.tilts)
    /* The axes and diagonals are what ofc_tilt_pentland() looks at. */
    static const int32_t eight[] = {1, 0, 0, 1, 1, 1, -1, 1}, parallel[] = {1, 2, -2, -4}, zero[] = {1, 0, 0, 0};
    static const int32_t far[] = {1, 0, 0, 1025}, extreme[] = {INT32_MIN, INT32_MAX, 0, 1};
    static const int32_t extreme_alone[] = {INT32_MIN, 0, 0, 1};
    ofc_tilts expected;
    assert_int_equal(ofc_tilt_pentland(&image, NULL, &expected), OFC_STATUS_OK);
    assert_int_equal(ALONG(eight, 4), OFC_STATUS_OK);
    for (int c = 0; c < 3; c++)
        assert_true(fabs(out.tilts.tilt_rad[c] - expected.tilt_rad[c]) < 1e-9);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ALONG(NULL, 4));
    REFUSED(OFC_STATUS_MISALIGNED, out, ALONG(MISALIGNED(eight), 3));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ALONG(eight, 1));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ALONG(eight, 0));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ALONG(eight, -4));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ALONG(eight, 65));
    REFUSED(OFC_STATUS_NO_TILT, out, ALONG(parallel, 2));
    REFUSED(OFC_STATUS_NO_TILT, out, ALONG(zero, 2));
    REFUSED(OFC_STATUS_NO_TILT, out, ALONG(far, 2));
    REFUSED(OFC_STATUS_NO_TILT, out, ALONG(extreme, 2));
    REFUSED(OFC_STATUS_NO_TILT, out, ALONG(extreme_alone, 2));
    static int32_t shared[sizeof(ofc_tilts) / 4];
    assert_int_equal(ofc_tilt_pentland_along(&image, NULL, shared, 2, (ofc_tilts *)(void *)shared), OFC_STATUS_OVERLAP);
}

static ofc_status largest(const ofc_image *image)
{
    return ofc_largest_disc(image, NULL, workspace, sizeof workspace, &out.disc);
}

static void discs(void **state)
{
    (void)state;
    refuses_bad_images(largest, &out, sizeof out);
    ofc_image image = ball_image();
    const size_t need = ofc_largest_disc_workspace_size(WIDTH, HEIGHT);
    assert_int_equal(need, OFC_LARGEST_DISC_WORKSPACE_SIZE(WIDTH, HEIGHT));
    assert_int_equal(ofc_largest_disc_workspace_size(0, HEIGHT), 0);
    assert_int_equal(ofc_largest_disc_workspace_size(INT32_MAX, INT32_MAX), 0);
#define LARGEST(inliers, space, bytes, disc) ofc_largest_disc(&image, inliers, space, bytes, disc)
    REFUSED(OFC_STATUS_NULL_POINTER, out, LARGEST(NULL, NULL, need, &out.disc));
    REFUSED(OFC_STATUS_NULL_POINTER, out, LARGEST(NULL, workspace, need, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, LARGEST(MISALIGNED(&stages.inliers), workspace, need, &out.disc));
    REFUSED(OFC_STATUS_MISALIGNED, out, LARGEST(NULL, MISALIGNED(workspace), need, &out.disc));
    REFUSED(OFC_STATUS_MISALIGNED, out, LARGEST(NULL, workspace, need, MISALIGNED(&out.disc)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, LARGEST(NULL, workspace, need - 1, &out.disc));
    REFUSED(OFC_STATUS_OVERLAP, out, LARGEST(NULL, workspace, need, (ofc_disc *)workspace));
    REFUSED(OFC_STATUS_OVERLAP, out, LARGEST((ofc_inlier_test *)workspace, workspace, need, &out.disc));
    assert_int_equal(largest(&image), OFC_STATUS_OK);
    assert_in_range(out.disc.x, WIDTH / 2 - 2, WIDTH / 2 + 2);
    assert_in_range(out.disc.y, HEIGHT / 2 - 2, HEIGHT / 2 + 2);
    static uint8_t mask[PIXELS];
    image.mask = mask;
    image.mask_stride_bytes = WIDTH;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, largest(&image));
    image.mask = NULL;
    const ofc_disc bad[] = {{.x = -1, .y = 5, .radius_squared = 9}, {.x = 5, .y = INT32_MIN, .radius_squared = 9}};
    const ofc_disc away = {.x = INT32_MAX, .y = INT32_MAX, .radius_squared = 9};
    const ofc_disc whole = {.x = 0, .y = 0, .radius_squared = UINT64_MAX};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_tilt_chojnacki(&image, NULL, &bad[0], &out.tilts));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_tilt_chojnacki(&image, NULL, &bad[1], &out.tilts));
    REFUSED(OFC_STATUS_NO_TILT, out, ofc_tilt_chojnacki(&image, NULL, &away, &out.tilts));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_tilt_chojnacki(&image, NULL, NULL, &out.tilts));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_tilt_chojnacki(&image, NULL, MISALIGNED(&disc), &out.tilts));
    assert_int_equal(ofc_tilt_chojnacki(&image, NULL, &whole, &out.tilts), OFC_STATUS_OK);
}

typedef ofc_status (*slant_call)(const ofc_image *, const ofc_inlier_test *, ofc_slant_estimate *);

static ofc_status zheng_chellappa(const ofc_image *image, const ofc_inlier_test *inliers, ofc_slant_estimate *slants)
{
    (void)inliers;
    return ofc_slant_zheng_chellappa(image, slants);
}

static ofc_status lee_rosenfeld(const ofc_image *image, const ofc_inlier_test *inliers, ofc_slant_estimate *slants)
{
    return ofc_slant_lee_rosenfeld(image, inliers, slants, NULL);
}

static slant_call slant;
static ofc_status slant_of(const ofc_image *image)
{
    return slant(image, NULL, out.slants);
}

static void slants(void **state)
{
    (void)state;
    static const slant_call calls[] = {ofc_slant_pentland, lee_rosenfeld, zheng_chellappa};
    static uint8_t mask[PIXELS];
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
        slant = calls[i];
        refuses_bad_images(slant_of, &out, sizeof out);
        ofc_image image = ball_image();
        REFUSED(OFC_STATUS_NULL_POINTER, out, slant(&image, NULL, NULL));
        REFUSED(OFC_STATUS_MISALIGNED, out, slant(&image, NULL, MISALIGNED(out.slants)));
        REFUSED(OFC_STATUS_OVERLAP, out, slant(&image, NULL, (ofc_slant_estimate *)(void *)&image));
        if (slant != zheng_chellappa) {
            REFUSED(OFC_STATUS_MISALIGNED, out, slant(&image, MISALIGNED(&stages.inliers), out.slants));
            REFUSED(OFC_STATUS_OVERLAP, out, slant(&image, &stages.inliers, (ofc_slant_estimate *)&stages.inliers));
        }
        memset(&out, PATTERN, sizeof out);
        assert_int_equal(slant_of(&image), OFC_STATUS_OK);
        assert_true(is_untouched(&out.behind, sizeof out.behind));
        for (int c = 0; c < 3; c++) {
            assert_true(out.slants[c].slant_rad >= 0 && out.slants[c].slant_rad < 3.15);
            assert_in_range(out.slants[c].clamping, OFC_SLANT_NOT_CLAMPED, OFC_SLANT_CLAMPED_TO_LARGEST);
        }
        image.mask = mask;
        image.mask_stride_bytes = WIDTH;
        REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, slant_of(&image));
    }
}

static void strengths(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_slant_lee_rosenfeld(&image, NULL, out.slants, MISALIGNED(out.norms)));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_slant_lee_rosenfeld(&image, NULL, out.slants, (double *)&out.slants[1]));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(ofc_slant_lee_rosenfeld(&image, NULL, out.slants, out.norms), OFC_STATUS_OK);
    assert_true(is_untouched(&out.behind, sizeof out.behind) && is_untouched(&out.last, sizeof out.last));
    const ofc_slant_estimate with[3] = {out.slants[0], out.slants[1], out.slants[2]};
    for (int c = 0; c < 3; c++)
        assert_true(out.norms[c] > 0 && out.norms[c] < 1e4);
    assert_int_equal(lee_rosenfeld(&image, NULL, out.slants), OFC_STATUS_OK);
    assert_memory_equal(out.slants, with, sizeof with);
}

static ofc_status maxima(const ofc_image *image)
{
    return ofc_channel_maxima(image, NULL, out.norms);
}

static void channel_maxima(void **state)
{
    (void)state;
    refuses_bad_images(maxima, &out, sizeof out);
    ofc_image image = ball_image();
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_channel_maxima(&image, NULL, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_channel_maxima(&image, MISALIGNED(&stages.inliers), out.norms));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_channel_maxima(&image, NULL, MISALIGNED(out.norms)));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_channel_maxima(&image, &stages.inliers, stages.inliers.norm_form));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(maxima(&image), OFC_STATUS_OK);
    assert_true(is_untouched(&out.last, sizeof out.last));
    double largest[3] = {0};
    for (int i = 0; i < PIXELS * 3; i++)
        largest[i % 3] = fmax(largest[i % 3], (&ball[0][0][0])[i]);
    assert_memory_equal(out.norms, largest, sizeof largest);
}

static void solve_with_any_tilts(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    ofc_solve_params params = stages.params;
    static ofc_solution solution;
    for (params.tilt_estimator = OFC_TILT_PENTLAND; params.tilt_estimator <= OFC_TILT_CHOJNACKI; params.tilt_estimator++)
        assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    params.tilt_estimator = OFC_TILT_GIVEN;
    memcpy(params.tilt_rad, stages.solution.tilts.tilt_rad, sizeof params.tilt_rad);
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    assert_memory_equal(&solution.orientation, &stages.solution.orientation, sizeof solution.orientation);
    params.tilt_rad[1] = NAN;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution),
                     OFC_STATUS_INVALID_PARAMETER);
    params.tilt_estimator = 5;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution),
                     OFC_STATUS_INVALID_PARAMETER);
    params = stages.params;
    params.lmeds.method = OFC_FIT_LEAST_SQUARES;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    assert_int_equal(solution.fit.inlier_count, solution.pixel_counts.usable);
    params.lmeds.method = 2;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution),
                     OFC_STATUS_INVALID_PARAMETER);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tilts),  cmocka_unit_test(pentland_along), cmocka_unit_test(discs),
        cmocka_unit_test(slants),
        cmocka_unit_test(strengths), cmocka_unit_test(channel_maxima), cmocka_unit_test(solve_with_any_tilts),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
