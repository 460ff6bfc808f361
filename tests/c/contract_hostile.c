/* Numbers and memory that nobody hands in on purpose: what is finite goes in, and what comes out is finite or refused. */
#include "contract.h"

#include <float.h>
#include <stdlib.h>

enum { SIDE = 10, STREAM_HEAD = 32 };

static struct {
    float normals[2 * 2 * 3];
    ofc_integrability integrability;
    ofc_covariance covariance;
    ofc_stream_pass pass;
    ofc_solution solution;
    ofc_orientation orientation;
    ofc_slants slants;
    ofc_location location;
    ofc_inlier_test accepted;
} out;

static uint64_t random_bits(void)
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state * 0x2545F4914F6CDD1Du;
}

/* Numbers from the ends of the range of floats, and some from its middle. */
static float extreme(void)
{
    static const float numbers[] = {0,      1,     -1,  0.5f,  1e-38f, 1e-45f, FLT_MAX, -FLT_MAX, 1e38f,
                                    1e-30f, 1e30f, 255, 65535, 1e6f,   1e-6f,  3.14f,   1e-16f,   1e-3f};
    return numbers[random_bits() % (sizeof numbers / sizeof *numbers)];
}

static int are_finite(const void *numbers, size_t bytes)
{
    for (size_t at = 0; at + sizeof(double) <= bytes; at += sizeof(double)) {
        double number;
        memcpy(&number, (const char *)numbers + at, sizeof number);
        if (!isfinite(number))
            return 0;
    }
    return 1;
}

/* The residuals of most pixels are too large for a float: median_residual was infinite and r_squared -infinity, with OK. */
static void fits_of_extreme_colors(void **state)
{
    (void)state;
    static float pixels[SIDE][SIDE][3];
    const ofc_image image = {
        .pixels = pixels, .width = SIDE, .height = SIDE, .row_stride_bytes = sizeof *pixels, .format = OFC_PIXEL_RGB32F};
    ofc_lmeds_params params = stages.params.lmeds;
    params.subsets = 40;
    int fitted = 0, out_of_range = 0;
    for (int picture = 0; picture < 60; picture++) {
        for (size_t i = 0; i < sizeof pixels / sizeof(float); i++)
            ((float *)pixels)[i] = extreme();
        ofc_color_fit fit;
        ofc_inlier_test test;
        if (ofc_lmeds_fit(&image, &params, workspace, sizeof workspace, &fit, &test) == OFC_STATUS_OK) {
            fitted++;
            assert_true(are_finite(&fit, offsetof(ofc_color_fit, inlier_count)));
            out_of_range += fit.median_residual == DBL_MAX && fit.r_squared == -DBL_MAX;
        }
    }
    assert_true(fitted > 20 && out_of_range > 5);
}

static void matrices(void **state)
{
    (void)state;
    float pixels[12] = {1, 2, 3, 2, 1, 3, 3, 2, 1, 1, 3, 2};
    const ofc_image image = {.pixels = pixels, .width = 2, .height = 2, .row_stride_bytes = 24, .format = OFC_PIXEL_RGB32F};
    const double huge[][9] = {
        {1.7e308, -1.7e308, 1, 0, 1, 0, 0, 0, 1}, /* infinity less infinity */
        {1e160, 0, 0, 0, 1e160, 0, 0, 0, 1e160},  /* a square that is infinite */
        {0, 0, 0, 0, 0, 0, 0, 0, 1.01e100},
        {-DBL_MAX, 0, 0, 0, 1, 0, 0, 0, 1},
    };
#define NORMALS(matrix, normalization) ofc_normals_from_matrix(&image, NULL, matrix, normalization, out.normals, 24)
#define INTEGRAL(matrix) ofc_integrability_integral(&image, NULL, matrix, &out.integrability)
    for (size_t i = 0; i < sizeof huge / sizeof *huge; i++) {
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(huge[i], OFC_NORMALIZATION_UNIT));
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(huge[i], OFC_NORMALIZATION_NONE));
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, INTEGRAL(huge[i]));
        ofc_solution solution = stages.solution;
        memcpy(solution.orientation.f_inverse, huge[i], sizeof huge[i]);
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_normals_compute(&image, &solution, out.normals, 24));
        solution = stages.solution;
        memcpy(solution.orientation.f, huge[i], sizeof huge[i]);
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_normals_compute(&image, &solution, out.normals, 24));
    }
    /* The largest matrices on the largest pixels. */
    const double largest[][9] = {
        {1e100, -1e100, 1e100, -1e100, 1e100, 1, 1e100, 1e100, 1e100},
        {1e100, 1e100, 1e100, 1e100, 1e100, 1e100, -1e100, -1e100, -1e100},
        {1, 0, 0, 0, 1, 0, 0, 0, 1},
    };
    for (int i = 0; i < 12; i++)
        pixels[i] = i % 5 ? FLT_MAX : FLT_MAX / 3;
    for (size_t i = 0; i < sizeof largest / sizeof *largest; i++) {
        assert_int_equal(NORMALS(largest[i], OFC_NORMALIZATION_UNIT), OFC_STATUS_OK);
        for (int n = 0; n < 12; n += 3) {
            const double x = out.normals[n], y = out.normals[n + 1], z = out.normals[n + 2];
            assert_true(fabs(x * x + y * y + z * z - 1) < 1e-6);
        }
        assert_int_equal(NORMALS(largest[i], OFC_NORMALIZATION_NONE), OFC_STATUS_OK);
        for (int n = 0; n < 12; n++)
            assert_true(fabs((double)out.normals[n]) <= FLT_MAX);
        assert_int_equal(INTEGRAL(largest[i]), OFC_STATUS_OK);
        assert_true(isfinite(out.integrability.mean));
    }
}

static void covariances(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    ofc_solve_params params = stages.params;
    params.orientation_method = OFC_ORIENTATION_JOINT;
    params.tilt_estimator = OFC_TILT_PENTLAND;
    static ofc_solution solution;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    assert_int_equal(ofc_solution_covariance(&solution, &out.covariance), OFC_STATUS_OK);
    assert_true(are_finite(&out.covariance, sizeof out.covariance));
    ofc_solution hostile = solution;
    hostile.orientation.f[0] = 1e160;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_solution_covariance(&hostile, &out.covariance));
    hostile = solution;
    hostile.orientation.f[4] = 1e100; /* Its fourth power is not. */
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_solution_covariance(&hostile, &out.covariance));
    hostile = solution;
    hostile.fit.covariance[0] = 1e308;
    hostile.fit.covariance[1] = -1e308;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_solution_covariance(&hostile, &out.covariance));
    hostile = solution;
    hostile.confidence.covariance[0] = DBL_MAX;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_solution_covariance(&hostile, &out.covariance));
}

/* Finite numbers of which what follows is not. */
static void numbers_too_large(void **state)
{
    (void)state;
    const double tilts[] = {0.5, 2.5, -2}, slants[] = {0.6, 0.7, 0.8}, cosines[] = {0.1, -0.2, 0.3};
    const double huge[] = {DBL_MAX, DBL_MAX, DBL_MAX}, tiny[] = {5e-324, 5e-324, 5e-324}, apart[] = {DBL_MAX, -DBL_MAX, 0};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_orientation_compose(huge, tilts, slants, 1e-3, &out.orientation));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_orientation_compose(tiny, tilts, slants, 0, &out.orientation));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_constrained_slants_least_squares(apart, cosines, &out.slants));

    /* Lengths of which some, many, most and all are too large for a float. */
    const ofc_image image = ball_image();
    int refused = 0;
    for (int power = 220; power < 260; power++) {
        const double c[] = {ldexp(1, power), ldexp(1, power), ldexp(1, power), 0, 0, 0};
        memset(&out, PATTERN, sizeof out);
        const ofc_status status =
            ofc_norm_location(&image, c, &stages.inliers, 2.5, workspace, sizeof workspace, &out.location, &out.accepted);
        assert_true(status == OFC_STATUS_OK ? are_finite(&out.location, sizeof out.location) : is_untouched(&out, sizeof out));
        refused += status == OFC_STATUS_INVALID_PARAMETER;
    }
    assert_true(refused > 0);

    /* The albedo of colors whose squares are too large for a float was a NaN of other bits. */
    static float colors[4][4][3], albedo[4][4], even[4][4][3];
    for (int i = 0; i < 48; i++)
        ((float *)colors)[i] = i % 7 ? 1e30f : 1e-30f;
    const ofc_image bright = {
        .pixels = colors, .width = 4, .height = 4, .row_stride_bytes = sizeof colors[0], .format = OFC_PIXEL_RGB32F};
    const double sphere[] = {1, 1, 1, 0, 0, 0};
    ofc_paint_params paint;
    ofc_paint_params_default(&paint);
    assert_int_equal(ofc_paint_albedo(&bright, &paint, sphere, workspace, sizeof workspace, albedo[0], sizeof albedo[0]),
                     OFC_STATUS_OK);
    for (int i = 0; i < 16; i++)
        assert_true(isfinite(((float *)albedo)[i]) && ((float *)albedo)[i] > 0);
    /* A quotient that is too large is none. */
    for (int i = 0; i < 16; i++)
        ((float *)albedo)[i] = 1e-20f;
    assert_int_equal(ofc_paint_divide(&bright, &paint, albedo[0], sizeof albedo[0], even[0][0], sizeof even[0]), OFC_STATUS_OK);
    for (int i = 0; i < 48; i++)
        assert_true(isnan(((float *)even)[i]));
}

/* Anything of 32 bytes can be told from a stream, and no byte behind them is read: the address sanitizer watches. */
static void memory_of_the_length_of_a_head(void **state)
{
    (void)state;
    uint64_t *head = malloc(STREAM_HEAD);
    assert_non_null(head);
    ofc_stream *const stream = (ofc_stream *)(void *)head;
    const ofc_image row = ball_image();
    for (int object = 0; object < 1000; object++) {
        for (size_t word = 0; word < STREAM_HEAD / sizeof *head; word++)
            head[word] = object == 0 ? 0 : object == 1 ? UINT64_MAX : random_bits();
        if (object > 500)
            head[0] = 0x6d6165727473666fu; /* As if the first word were right: the last one checks the others. */
        REFUSED(OFC_STATUS_NO_STREAM, out, ofc_stream_restart(stream));
        REFUSED(OFC_STATUS_NO_STREAM, out, ofc_stream_begin(stream, &out.pass));
        REFUSED(OFC_STATUS_NO_STREAM, out, ofc_stream_row(stream, 0, &row));
        REFUSED(OFC_STATUS_NO_STREAM, out, ofc_stream_end(stream, &out.pass));
        REFUSED(OFC_STATUS_NO_STREAM, out, ofc_stream_solution(stream, &out.solution));
    }
    free(head);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fits_of_extreme_colors),
        cmocka_unit_test(matrices),
        cmocka_unit_test(covariances),
        cmocka_unit_test(numbers_too_large),
        cmocka_unit_test(memory_of_the_length_of_a_head),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
