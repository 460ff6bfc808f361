/* The regression, the location of the norms, the inliers and the ellipsoid. */
#include "contract.h"

static struct {
    ofc_color_fit fit;
    ofc_inlier_test inliers;
    ofc_location location;
    ofc_ellipsoid ellipsoid;
    int32_t count;
    uint8_t mask[PIXELS + 64];
} out;

static double form[6];

static int prepare(void **state)
{
    const int failed = prepare_stages(state);
    for (int i = 0; i < 6; i++)
        form[i] = stages.fit.coefficients[i].value;
    return failed;
}

static ofc_status fit(const ofc_image *image)
{
    return ofc_lmeds_fit(image, &stages.params.lmeds, workspace, sizeof workspace, &out.fit, &out.inliers);
}

static void lmeds_fit(void **state)
{
    (void)state;
    refuses_bad_images(fit, &out, sizeof out);
    const ofc_image image = ball_image();
    const ofc_lmeds_params *params = &stages.params.lmeds;
    const size_t need = ofc_lmeds_workspace_size(WIDTH, HEIGHT, params);
    assert_true(need > 0 && need <= sizeof workspace);
#define FIT(params, space, bytes, fit, inliers) ofc_lmeds_fit(&image, params, space, bytes, fit, inliers)
    REFUSED(OFC_STATUS_NULL_POINTER, out, FIT(NULL, workspace, need, &out.fit, &out.inliers));
    REFUSED(OFC_STATUS_NULL_POINTER, out, FIT(params, NULL, need, &out.fit, &out.inliers));
    REFUSED(OFC_STATUS_NULL_POINTER, out, FIT(params, workspace, need, NULL, &out.inliers));
    REFUSED(OFC_STATUS_NULL_POINTER, out, FIT(params, workspace, need, &out.fit, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, FIT(MISALIGNED(params), workspace, need, &out.fit, &out.inliers));
    REFUSED(OFC_STATUS_MISALIGNED, out, FIT(params, MISALIGNED(workspace), need, &out.fit, &out.inliers));
    REFUSED(OFC_STATUS_MISALIGNED, out, FIT(params, workspace, need, MISALIGNED(&out.fit), &out.inliers));
    REFUSED(OFC_STATUS_MISALIGNED, out, FIT(params, workspace, need, &out.fit, MISALIGNED(&out.inliers)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, FIT(params, workspace, need - 1, &out.fit, &out.inliers));
    REFUSED(OFC_STATUS_OVERLAP, out, FIT(params, workspace, need, (ofc_color_fit *)workspace, &out.inliers));
    REFUSED(OFC_STATUS_OVERLAP, out, FIT(params, workspace, need, &out.fit, (ofc_inlier_test *)&out.fit));
    REFUSED(OFC_STATUS_OVERLAP, out, FIT(params, workspace, need, &out.fit, (ofc_inlier_test *)(void *)&stages.params));
    ofc_lmeds_params bad = *params;
    bad.rejection = NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, FIT(&bad, workspace, need, &out.fit, &out.inliers));
    assert_int_equal(ofc_lmeds_workspace_size(WIDTH, HEIGHT, &bad), 0);
    assert_int_equal(ofc_lmeds_workspace_size(0, HEIGHT, params), 0);
    assert_int_equal(ofc_lmeds_workspace_size(WIDTH, HEIGHT, NULL), 0);
    assert_int_equal(ofc_lmeds_workspace_size(INT32_MAX, INT32_MAX, params), 0);

    memset(&out, PATTERN, sizeof out);
    assert_int_equal(FIT(params, workspace, need, &out.fit, &out.inliers), OFC_STATUS_OK);
    assert_memory_equal(&out.fit, &stages.fit, sizeof out.fit);
    assert_memory_equal(&out.fit, &stages.solution.fit, sizeof out.fit);
    assert_true(is_untouched(&out.location, sizeof out.location));

    static uint8_t gray[HEIGHT][WIDTH][3];
    memset(gray, 77, sizeof gray);
    ofc_image flat = ball_image();
    flat.pixels = gray;
    REFUSED(OFC_STATUS_RANK_DEFICIENT, out, fit(&flat));
}

static void subset_count(void **state)
{
    (void)state;
    assert_int_equal(ofc_lmeds_subset_count(0.9999, 0.5, 500), 585);
    assert_int_equal(ofc_lmeds_subset_count(0.99, 0.5, 0), 293);
    assert_int_equal(ofc_lmeds_subset_count(0.9999, 0.5, 1000), 1000);
    assert_int_equal(ofc_lmeds_subset_count(0.9999, 0, 0), 1);
    assert_int_equal(ofc_lmeds_subset_count(0.9999, 0.99, 0), 0);
    assert_int_equal(ofc_lmeds_subset_count(1, 0.5, 0), 0);
    assert_int_equal(ofc_lmeds_subset_count(NAN, 0.5, 0), 0);
    assert_int_equal(ofc_lmeds_subset_count(0.5, -INFINITY, 0), 0);
    assert_int_equal(ofc_lmeds_subset_count(0.5, 0.5, UINT32_MAX), 0);
}

static void location_fit(void **state)
{
    (void)state;
    float values[10] = {90, 93, 86, 92, 95, 83, 75, 40, 88, 80};
    uint64_t space[10];
    assert_int_equal(ofc_location_workspace_size(10), sizeof space);
    assert_int_equal(ofc_location_workspace_size(0), 0);
    assert_int_equal(ofc_location_workspace_size(SIZE_MAX / 4), 0);
#define LOCATE(values, count, space, bytes, out) ofc_location_fit(values, count, space, bytes, out)
    REFUSED(OFC_STATUS_NULL_POINTER, out, LOCATE(NULL, 10, space, sizeof space, &out.location));
    REFUSED(OFC_STATUS_NULL_POINTER, out, LOCATE(values, 10, NULL, sizeof space, &out.location));
    REFUSED(OFC_STATUS_NULL_POINTER, out, LOCATE(values, 10, space, sizeof space, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, LOCATE(MISALIGNED(values), 9, space, sizeof space, &out.location));
    REFUSED(OFC_STATUS_MISALIGNED, out, LOCATE(values, 5, (float *)space + 1, 72, &out.location));
    REFUSED(OFC_STATUS_MISALIGNED, out, LOCATE(values, 10, space, sizeof space, MISALIGNED(&out.location)));
    REFUSED(OFC_STATUS_EMPTY, out, LOCATE(values, 0, space, sizeof space, &out.location));
    REFUSED(OFC_STATUS_EMPTY, out, LOCATE(values, 1, space, sizeof space, &out.location));
    REFUSED(OFC_STATUS_TOO_LARGE, out, LOCATE(values, SIZE_MAX, space, sizeof space, &out.location));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, LOCATE(values, 10, space, sizeof space - 1, &out.location));
    REFUSED(OFC_STATUS_OVERLAP, out, LOCATE((float *)space, 10, space, sizeof space, &out.location));
    REFUSED(OFC_STATUS_OVERLAP, out, LOCATE(values, 10, space, sizeof space, (ofc_location *)space));
    assert_int_equal(LOCATE(values, 10, space, sizeof space, &out.location), OFC_STATUS_OK);
    assert_true(out.location.location == 90.5 && out.location.median_distance == 4.5);
    assert_true(values[0] == 90 && values[7] == 40);
    values[3] = NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LOCATE(values, 10, space, sizeof space, &out.location));
    values[3] = -INFINITY;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, LOCATE(values, 10, space, sizeof space, &out.location));
}

static ofc_status norms(const ofc_image *image)
{
    return ofc_norm_location(image, form, &stages.inliers, 2.5, workspace, sizeof workspace, &out.location,
                             &out.inliers);
}

static void norm_location(void **state)
{
    (void)state;
    refuses_bad_images(norms, &out, sizeof out);
    const ofc_image image = ball_image();
    const ofc_inlier_test *first = &stages.inliers;
    const size_t need = ofc_norm_location_workspace_size(WIDTH, HEIGHT);
    assert_int_equal(need, PIXELS * 8);
    assert_int_equal(ofc_norm_location_workspace_size(-1, HEIGHT), 0);
    assert_int_equal(ofc_norm_location_workspace_size(INT32_MAX, INT32_MAX), 0);
#define NORMS(form, first, rejection, space, bytes, location, inliers)                                                 \
    ofc_norm_location(&image, form, first, rejection, space, bytes, location, inliers)
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMS(NULL, first, 2.5, workspace, need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMS(form, NULL, 2.5, workspace, need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMS(form, first, 2.5, NULL, need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMS(form, first, 2.5, workspace, need, NULL, &out.inliers));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMS(form, first, 2.5, workspace, need, &out.location, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMS(MISALIGNED(form), first, 2.5, workspace, need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMS(form, MISALIGNED(first), 2.5, workspace, need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMS(form, first, 2.5, MISALIGNED(workspace), need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMS(form, first, 2.5, workspace, need, MISALIGNED(&out.location), &out.inliers));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMS(form, first, 2.5, workspace, need, &out.location, MISALIGNED(&out.inliers)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, NORMS(form, first, 2.5, workspace, need - 1, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_OVERLAP, out, NORMS(form, first, 2.5, workspace, need, &out.location, &stages.inliers));
    REFUSED(OFC_STATUS_OVERLAP, out, NORMS(form, first, 2.5, workspace, need, &out.location, (ofc_inlier_test *)&out.location));
    REFUSED(OFC_STATUS_OVERLAP, out, NORMS((double *)workspace, first, 2.5, workspace, need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMS(form, first, 0, workspace, need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMS(form, first, NAN, workspace, need, &out.location, &out.inliers));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMS(form, first, INFINITY, workspace, need, &out.location, &out.inliers));
    const double bad[6] = {1, NAN, 1, 0, 0, 0};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMS(bad, first, 2.5, workspace, need, &out.location, &out.inliers));
    ofc_inlier_test nobody = *first;
    nobody.residual_high = NAN;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, NORMS(form, &nobody, 2.5, workspace, need, &out.location, &out.inliers));
    assert_int_equal(norms(&image), OFC_STATUS_OK);
    assert_memory_equal(&out.location, &stages.solution.norm_location, sizeof out.location);
    assert_memory_equal(&out.inliers, &stages.solution.inlier_test, sizeof out.inliers);
}

static ofc_status mark(const ofc_image *image)
{
    return ofc_inlier_test_apply(image, &stages.inliers, out.mask, &out.count);
}

static void inliers_mark(void **state)
{
    (void)state;
    refuses_bad_images(mark, &out, sizeof out);
    const ofc_image image = ball_image();
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_inlier_test_apply(&image, &stages.inliers, NULL, &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_inlier_test_apply(&image, MISALIGNED(&stages.inliers), out.mask, &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_inlier_test_apply(&image, &stages.inliers, out.mask, MISALIGNED(&out.count)));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_inlier_test_apply(&image, &stages.inliers, &ball[0][0][0], &out.count));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_inlier_test_apply(&image, &stages.inliers, (uint8_t *)&stages.inliers, NULL));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_inlier_test_apply(&image, NULL, out.mask, (int32_t *)(void *)out.mask));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(mark(&image), OFC_STATUS_OK);
    assert_true(is_untouched(out.mask + PIXELS, 64));
    assert_int_equal(out.count, stages.fit.inlier_count);
    assert_int_equal(ofc_inlier_test_apply(&image, NULL, out.mask, NULL), OFC_STATUS_OK);
    int32_t usable = 0;
    for (int i = 0; i < PIXELS; i++)
        usable += out.mask[i] == 255;
    assert_int_equal(usable, stages.solution.pixel_counts.usable);
}

static void ellipsoid_decompose(void **state)
{
    (void)state;
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_ellipsoid_decompose(NULL, &out.ellipsoid));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_ellipsoid_decompose(form, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_ellipsoid_decompose(MISALIGNED(form), &out.ellipsoid));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_ellipsoid_decompose(form, MISALIGNED(&out.ellipsoid)));
    static ofc_ellipsoid shared;
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_ellipsoid_decompose(shared.c, &shared));
    const double indefinite[6] = {1, 1, -1, 0, 0, 0}, zero[6] = {0}, nan[6] = {1, 1, 1, NAN, 0, 0};
    const double infinite[6] = {INFINITY, 1, 1, 0, 0, 0};
    REFUSED(OFC_STATUS_NOT_POSITIVE_DEFINITE, out, ofc_ellipsoid_decompose(indefinite, &out.ellipsoid));
    REFUSED(OFC_STATUS_NOT_POSITIVE_DEFINITE, out, ofc_ellipsoid_decompose(zero, &out.ellipsoid));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_ellipsoid_decompose(nan, &out.ellipsoid));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_ellipsoid_decompose(infinite, &out.ellipsoid));
    assert_int_equal(ofc_ellipsoid_decompose(form, &out.ellipsoid), OFC_STATUS_OK);
    assert_memory_equal(&out.ellipsoid, &stages.solution.ellipsoid, sizeof out.ellipsoid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lmeds_fit),     cmocka_unit_test(subset_count), cmocka_unit_test(location_fit),
        cmocka_unit_test(norm_location), cmocka_unit_test(inliers_mark), cmocka_unit_test(ellipsoid_decompose),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
