/* Tilts, F, the integrability integral and normals. */
#include "contract.h"

enum { PADDED = WIDTH * 3 + 5 };

static struct {
    ofc_tilts tilts;
    ofc_orientation orientation;
    ofc_integrability integrability;
    float normals[HEIGHT * PADDED + 8];
} out;

static ofc_status tilts(const ofc_image *image)
{
    return ofc_tilt_pentland(image, &stages.solution.inlier_test, &out.tilts);
}

static void tilt_pentland(void **state)
{
    (void)state;
    refuses_bad_images(tilts, &out, sizeof out);
    ofc_image image = ball_image();
    ofc_inlier_test *inliers = &stages.solution.inlier_test;
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_tilt_pentland(&image, inliers, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_tilt_pentland(&image, MISALIGNED(inliers), &out.tilts));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_tilt_pentland(&image, inliers, MISALIGNED(&out.tilts)));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_tilt_pentland(&image, inliers, (ofc_tilts *)inliers));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_tilt_pentland(&image, inliers, (ofc_tilts *)(void *)&image));
    assert_int_equal(tilts(&image), OFC_STATUS_OK);
    assert_memory_equal(&out.tilts, &stages.solution.tilts, sizeof out.tilts);
    assert_int_equal(ofc_tilt_pentland(&image, NULL, &out.tilts), OFC_STATUS_OK);
    static uint8_t gray[HEIGHT][WIDTH][3], mask[PIXELS];
    memset(gray, 77, sizeof gray);
    image.pixels = gray;
    REFUSED(OFC_STATUS_NO_TILT, out, ofc_tilt_pentland(&image, NULL, &out.tilts));
    image = ball_image();
    image.mask = mask;
    image.mask_stride_bytes = WIDTH;
    REFUSED(OFC_STATUS_NO_TILT, out, tilts(&image));
    image = ball_image();
    image.height = 1;
    REFUSED(OFC_STATUS_NO_TILT, out, tilts(&image));
}

static void orientation_compose(void **state)
{
    (void)state;
    double norms[3] = {150, 160, 140};
    const double t[3] = {-0.6, -2.6, 2.4}, s[3] = {0.4, 0.5, 0.3}, nan[3] = {1, NAN, 1}, level[3] = {0, 0, 0};
#define COMPOSE(n, t, s, threshold, out) ofc_orientation_compose(n, t, s, threshold, out)
    REFUSED(OFC_STATUS_NULL_POINTER, out, COMPOSE(NULL, t, s, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_NULL_POINTER, out, COMPOSE(norms, NULL, s, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_NULL_POINTER, out, COMPOSE(norms, t, NULL, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_NULL_POINTER, out, COMPOSE(norms, t, s, 1e-3, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, COMPOSE(MISALIGNED(norms), t, s, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_MISALIGNED, out, COMPOSE(norms, MISALIGNED(t), s, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_MISALIGNED, out, COMPOSE(norms, t, MISALIGNED(s), 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_MISALIGNED, out, COMPOSE(norms, t, s, 1e-3, MISALIGNED(&out.orientation)));
    static ofc_orientation shared;
    REFUSED(OFC_STATUS_OVERLAP, out, COMPOSE(shared.f, t, s, 1e-3, &shared));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, COMPOSE(nan, t, s, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, COMPOSE(norms, nan, s, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, COMPOSE(norms, t, nan, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, COMPOSE(norms, t, s, 1, &out.orientation));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, COMPOSE(norms, t, s, NAN, &out.orientation));
    assert_int_equal(COMPOSE(norms, t, s, 1e-3, &out.orientation), OFC_STATUS_OK);
    assert_int_equal(out.orientation.rank, 3);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += out.orientation.f[3 * i + k] * out.orientation.f_inverse[3 * k + j];
            assert_true(fabs(sum - (i == j)) < 1e-12);
        }
    assert_int_equal(COMPOSE(norms, t, level, 1e-3, &out.orientation), OFC_STATUS_RANK_DEFICIENT);
    assert_int_equal(out.orientation.rank, 1);
}

static ofc_status integral(const ofc_image *image)
{
    return ofc_integrability_integral(image, &stages.solution.inlier_test, stages.solution.orientation.f_inverse,
                                      &out.integrability);
}

static void integrability_integral(void **state)
{
    (void)state;
    refuses_bad_images(integral, &out, sizeof out);
    ofc_image image = ball_image();
    const ofc_inlier_test *inliers = &stages.solution.inlier_test;
    const double *inverse = stages.solution.orientation.f_inverse;
#define INTEGRAL(inliers, inverse, out) ofc_integrability_integral(&image, inliers, inverse, out)
    REFUSED(OFC_STATUS_NULL_POINTER, out, INTEGRAL(inliers, NULL, &out.integrability));
    REFUSED(OFC_STATUS_NULL_POINTER, out, INTEGRAL(inliers, inverse, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTEGRAL(MISALIGNED(inliers), inverse, &out.integrability));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTEGRAL(inliers, MISALIGNED(inverse), &out.integrability));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTEGRAL(inliers, inverse, MISALIGNED(&out.integrability)));
    REFUSED(OFC_STATUS_OVERLAP, out, INTEGRAL(inliers, inverse, (ofc_integrability *)(void *)ball));
    const double nan[9] = {NAN};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, INTEGRAL(inliers, nan, &out.integrability));
    assert_int_equal(integral(&image), OFC_STATUS_OK);
    assert_true(out.integrability.cells > 1000 && out.integrability.mean >= 0);
    assert_true(out.integrability.mean == stages.solution.candidates[stages.solution.chosen].integral);
    image.height = 1;
    REFUSED(OFC_STATUS_NO_CELLS, out, integral(&image));
}

static ofc_status from_matrix(const ofc_image *image)
{
    return ofc_normals_from_matrix(image, NULL, stages.solution.orientation.f_inverse, OFC_NORMALIZATION_NONE, out.normals,
                                   WIDTH * 3 * sizeof(float));
}

static ofc_status compute(const ofc_image *image)
{
    return ofc_normals_compute(image, &stages.solution, out.normals, WIDTH * 3 * sizeof(float));
}

static void normals_refused(void **state)
{
    (void)state;
    refuses_bad_images(from_matrix, &out, sizeof out);
    refuses_bad_images(compute, &out, sizeof out);
    const ofc_image image = ball_image();
    const ofc_inlier_test *inliers = &stages.solution.inlier_test;
    const double *inverse = stages.solution.orientation.f_inverse;
    const size_t row = WIDTH * 3 * sizeof(float);
#define FROM(inliers, inverse, length, normals, stride)                                                                \
    ofc_normals_from_matrix(&image, inliers, inverse, length, normals, stride)
    REFUSED(OFC_STATUS_NULL_POINTER, out, FROM(inliers, NULL, 0, out.normals, row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, FROM(inliers, inverse, 0, NULL, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, FROM(MISALIGNED(inliers), inverse, 0, out.normals, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, FROM(inliers, MISALIGNED(inverse), 0, out.normals, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, FROM(inliers, inverse, 0, MISALIGNED(out.normals), row));
    REFUSED(OFC_STATUS_MISALIGNED, out, FROM(inliers, inverse, 0, out.normals, row + 2));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, FROM(inliers, inverse, 0, out.normals, row - 4));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, FROM(inliers, inverse, 0, out.normals, 0));
    REFUSED(OFC_STATUS_TOO_LARGE, out, FROM(inliers, inverse, 0, out.normals, SIZE_MAX - 3));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, FROM(inliers, inverse, 2, out.normals, row));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, FROM(inliers, inverse, -1, out.normals, row));
    const double infinite[9] = {0, 0, 0, 0, INFINITY};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, FROM(inliers, infinite, 0, out.normals, row));
    static union {
        uint8_t pixels[HEIGHT][WIDTH][3];
        float normals[PIXELS * 3];
    } shared;
    ofc_image same = image;
    same.pixels = shared.pixels;
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_normals_compute(&same, &stages.solution, shared.normals, row));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_normals_from_matrix(&same, inliers, inverse, 0, shared.normals, row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_normals_compute(&image, NULL, out.normals, row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_normals_compute(&image, &stages.solution, NULL, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_normals_compute(&image, MISALIGNED(&stages.solution), out.normals, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_normals_compute(&image, &stages.solution, MISALIGNED(out.normals), row));
    ofc_solution broken = stages.solution;
    broken.outcome = OFC_STATUS_NO_TILT;
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_normals_compute(&image, &broken, out.normals, row));
    memset(&broken, 0, sizeof broken);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_normals_compute(&image, &broken, out.normals, row));
    broken = stages.solution;
    broken.orientation.f_inverse[8] = NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_normals_compute(&image, &broken, out.normals, row));
}

static void normals_written(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    static uint8_t mask[PIXELS];
    assert_int_equal(ofc_inlier_test_apply(&image, &stages.solution.inlier_test, mask, NULL), OFC_STATUS_OK);
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(ofc_normals_compute(&image, &stages.solution, out.normals, PADDED * sizeof(float)), OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            const float *n = out.normals + y * PADDED + 3 * x;
            const double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
            assert_true(mask[y * WIDTH + x] ? fabs(length - 1) < 1e-6 : length == 0);
        }
        assert_true(is_untouched(out.normals + y * PADDED + 3 * WIDTH, 5 * sizeof(float)));
    }
    assert_true(is_untouched(out.normals + HEIGHT * PADDED, 8 * sizeof(float)));
    /* The same by the stage call; and kept lengths differ from one. */
    static float again[PIXELS * 3];
    const double *inverse = stages.solution.orientation.f_inverse;
    assert_int_equal(ofc_normals_from_matrix(&image, &stages.solution.inlier_test, inverse, OFC_NORMALIZATION_UNIT, again,
                                             WIDTH * 3 * sizeof(float)),
                     OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++)
        assert_memory_equal(again + y * WIDTH * 3, out.normals + y * PADDED, WIDTH * 3 * sizeof(float));
    assert_int_equal(from_matrix(&image), OFC_STATUS_OK);
    int unit = 0, other = 0;
    for (int i = 0; i < PIXELS; i++) {
        const float *n = out.normals + 3 * i;
        const double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
        if (length > 0)
            fabs(length - 1) < 1e-6 ? unit++ : other++;
    }
    assert_true(other > unit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tilt_pentland),   cmocka_unit_test(orientation_compose), cmocka_unit_test(integrability_integral),
        cmocka_unit_test(normals_refused), cmocka_unit_test(normals_written),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
