#include "fuzz.h"

static int is_our_nan(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits == 0x7ff8000000000000u;
}

static int is_our_nan_float(float number)
{
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits == 0x7fc00000u;
}

void all_finite(const char *what, const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]))
            fail("%s: number %zu is %g", what, i, numbers[i]);
}

void finite_or_nan(const char *what, const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]) && !is_our_nan(numbers[i]))
            fail("%s: number %zu is %g", what, i, numbers[i]);
}

void floats_finite(const char *what, const float *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]))
            fail("%s: number %zu is %g", what, i, (double)numbers[i]);
}

void floats_finite_or_nan(const char *what, const float *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]) && !is_our_nan_float(numbers[i]))
            fail("%s: number %zu is %g", what, i, (double)numbers[i]);
}

void unit_normals(const char *what, const float *normals, size_t stride, int32_t width, int32_t height)
{
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            const float *const n = (const float *)((const char *)normals + (size_t)y * stride) + 3 * x;
            const double square = (double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2];
            if (!(square == 0 || fabs(square - 1) < 1e-5))
                fail("%s: normal (%g, %g, %g) at %d, %d", what, (double)n[0], (double)n[1], (double)n[2], x, y);
        }
}

void check_fit(const char *what, const ofc_color_fit *fit)
{
    all_finite(what, DOUBLES(fit, robust, coefficients));
    for (int i = 0; i < 6; i++) {
        const ofc_estimate *const one = &fit->coefficients[i];
        const double numbers[] = {one->value, one->standard_error, one->p, one->low, one->high, one->standard_error == 0 ? 0 : one->t};
        all_finite(what, numbers, sizeof numbers / sizeof *numbers);
        if (isnan(one->t))
            fail("%s: t of coefficient %d", what, i);
    }
    all_finite(what, DOUBLES(fit, covariance, inlier_count));
    if (fit->reserved != 0 || fit->inlier_count < 0)
        fail("%s: the counts of the fit", what);
}

void check_inlier_test(const char *what, const ofc_inlier_test *test)
{
    all_finite(what, test->residual_form, 6);
    all_finite(what, test->norm_form, 6);
    const double limits[] = {test->saturation, test->residual_low, test->residual_high, test->norm_low, test->norm_high};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++)
        if (isnan(limits[i]))
            fail("%s: limit %zu of the test is NaN", what, i);
    floats_finite(what, test->shadow_planes[0].normal, 12);
}

void check_solution(const char *what, const ofc_solution *solution, ofc_status status)
{
    if (solution->outcome != status)
        fail("%s: outcome %d and status %d", what, solution->outcome, status);
    all_finite(what, &solution->reason_value, 2);
    floats_finite(what, &solution->pixel_counts.largest, 1);
    check_fit(what, &solution->fit);
    all_finite(what, DOUBLES(&solution->rank, color_deviations, colors));
    all_finite(what, &solution->norm_location.location, 3);
    check_inlier_test(what, &solution->inlier_test);
    all_finite(what, solution->ellipsoid.c, sizeof(ofc_ellipsoid) / sizeof(double));
    all_finite(what, solution->tilts.tilt_rad, sizeof(ofc_tilts) / sizeof(double));
    all_finite(what, solution->slant_rad, 3);
    finite_or_nan(what, DOUBLES(&solution->confidence, covariance, log_likelihood_margin));
    const double margin = solution->confidence.log_likelihood_margin;
    if (margin != INFINITY)
        finite_or_nan(what, &margin, 1);
    if (solution->candidate_count < 0 || solution->candidate_count > OFC_MAX_CANDIDATES)
        fail("%s: %d candidates", what, solution->candidate_count);
    for (int i = 0; i < OFC_MAX_CANDIDATES; i++) {
        all_finite(what, solution->candidates[i].slant_rad, 4);
        if (solution->candidates[i].integral != INFINITY)
            all_finite(what, &solution->candidates[i].integral, 1);
    }
    all_finite(what, DOUBLES(&solution->orientation, f, rank));
    if (status == OFC_STATUS_OK && (solution->orientation.rank != 3 || solution->chosen >= solution->candidate_count))
        fail("%s: rank %d, candidate %d of %d", what, solution->orientation.rank, solution->chosen, solution->candidate_count);
}
