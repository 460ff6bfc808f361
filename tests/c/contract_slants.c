/* Slants from tilts and cosines. */
#include "contract.h"

#define DEGREES (3.14159265358979323846 / 180)

static struct {
    ofc_slants candidates[OFC_MAX_CANDIDATES];
    ofc_slants behind;
    int32_t count;
    double slant[33][3], f[33];
} out;

/* Figure 1: unit vectors at (slant, tilt) (40, 20), (30, -120), (5, 0) degrees. */
static double tilts[3] = {20 * DEGREES, -120 * DEGREES, 0};
static double cosines[3];

static int prepare(void **state)
{
    (void)state;
    static const double slants[3] = {40 * DEGREES, 30 * DEGREES, 5 * DEGREES};
    static const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < 3; i++) {
        const int a = pairs[i][0], b = pairs[i][1];
        cosines[i] = cos(tilts[a] - tilts[b]) * sin(slants[a]) * sin(slants[b]) + cos(slants[a]) * cos(slants[b]);
    }
    return 0;
}

/* Tilts and cosines that every call here refuses. */
typedef ofc_status (*slant_call)(const double *tilts, const double *cosines);
static void refuses_bad_angles(slant_call call)
{
    const double nan[3] = {0, NAN, 1}, infinite[3] = {0, 1, INFINITY}, large[3] = {0.5, 0.5, 1.0000001};
    REFUSED(OFC_STATUS_NULL_POINTER, out, call(NULL, cosines));
    REFUSED(OFC_STATUS_NULL_POINTER, out, call(tilts, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, call(MISALIGNED(tilts), cosines));
    REFUSED(OFC_STATUS_MISALIGNED, out, call(tilts, MISALIGNED(cosines)));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, call(nan, cosines));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, call(infinite, cosines));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, call(tilts, nan));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, call(tilts, large));
}

static ofc_status find(const double *t, const double *h)
{
    return ofc_constrained_slants_find(t, h, out.candidates, &out.count);
}

static ofc_status nearest(const double *t, const double *h)
{
    return ofc_constrained_slants_least_squares(t, h, out.candidates);
}

static ofc_status sample(const double *t, const double *h)
{
    return ofc_slant_curve_sample(t, h, 1, 32, out.slant[0], out.f);
}

static void constrained_slants_find(void **state)
{
    (void)state;
    refuses_bad_angles(find);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_constrained_slants_find(tilts, cosines, NULL, &out.count));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_constrained_slants_find(tilts, cosines, out.candidates, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_constrained_slants_find(tilts, cosines, MISALIGNED(out.candidates), &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_constrained_slants_find(tilts, cosines, out.candidates, MISALIGNED(&out.count)));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_constrained_slants_find(tilts, cosines, out.candidates, (int32_t *)out.candidates));
    static ofc_slants shared[OFC_MAX_CANDIDATES];
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_constrained_slants_find((double *)shared, cosines, shared, &out.count));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_constrained_slants_find(tilts, (double *)shared, shared, &out.count));

    memset(&out, PATTERN, sizeof out);
    assert_int_equal(find(tilts, cosines), OFC_STATUS_OK);
    assert_int_equal(out.count, 2);
    assert_true(is_untouched(&out.candidates[2], sizeof(ofc_slants) * (OFC_MAX_CANDIDATES - 2)));
    assert_true(is_untouched(&out.behind, sizeof out.behind));
    static const double expected[2][3] = {{40, 30, 5}, {64.63, 0.93, 32.29}};
    for (int i = 0; i < 2; i++)
        for (int c = 0; c < 3; c++)
            assert_true(fabs(out.candidates[i].slant_rad[c] / DEGREES - expected[i][c]) < 0.005);

    const double far_apart[3] = {-0.9, -0.9, -0.9};
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(find(tilts, far_apart), OFC_STATUS_NO_CONSISTENT_SLANTS);
    assert_int_equal(out.count, 0);
    assert_true(is_untouched(out.candidates, sizeof out.candidates));
}

static void constrained_slants_nearest(void **state)
{
    (void)state;
    refuses_bad_angles(nearest);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_constrained_slants_least_squares(tilts, cosines, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_constrained_slants_least_squares(tilts, cosines, MISALIGNED(out.candidates)));
    static ofc_slants shared;
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_constrained_slants_least_squares((double *)&shared, cosines, &shared));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(nearest(tilts, cosines), OFC_STATUS_OK);
    assert_true(out.candidates[0].residual < 1e-9);
    assert_int_equal(out.candidates[0].branch, 0);
    assert_true(is_untouched(&out.candidates[1], sizeof out.candidates[1]));
    const double far_apart[3] = {-0.9, -0.9, -0.9};
    assert_int_equal(nearest(tilts, far_apart), OFC_STATUS_OK);
    assert_true(out.candidates[0].residual > 0.1);
}

static void slant_curve_sample(void **state)
{
    (void)state;
    refuses_bad_angles(sample);
#define SAMPLE(branch, count, sigma, f) ofc_slant_curve_sample(tilts, cosines, branch, count, sigma, f)
    REFUSED(OFC_STATUS_NULL_POINTER, out, SAMPLE(1, 32, NULL, out.f));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SAMPLE(1, 32, out.slant[0], NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, SAMPLE(1, 32, MISALIGNED(out.slant), out.f));
    REFUSED(OFC_STATUS_MISALIGNED, out, SAMPLE(1, 32, out.slant[0], MISALIGNED(out.f)));
    REFUSED(OFC_STATUS_OVERLAP, out, SAMPLE(1, 32, out.slant[0], out.slant[31]));
    REFUSED(OFC_STATUS_OVERLAP, out, SAMPLE(1, 3, tilts, out.f));
    REFUSED(OFC_STATUS_EMPTY, out, SAMPLE(1, 1, out.slant[0], out.f));
    REFUSED(OFC_STATUS_EMPTY, out, SAMPLE(1, 0, out.slant[0], out.f));
    REFUSED(OFC_STATUS_EMPTY, out, SAMPLE(1, INT32_MIN, out.slant[0], out.f));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SAMPLE(0, 32, out.slant[0], out.f));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SAMPLE(9, 32, out.slant[0], out.f));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SAMPLE(-1, 32, out.slant[0], out.f));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SAMPLE(257, 32, out.slant[0], out.f));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(SAMPLE(1, 32, out.slant[0], out.f), OFC_STATUS_OK);
    assert_true(is_untouched(out.slant[32], sizeof out.slant[32]) && is_untouched(&out.f[32], sizeof(double)));
    assert_true(out.slant[0][0] == 0 && fabs(out.slant[31][0] / DEGREES - 90) < 1e-12);
    int values = 0, gaps = 0;
    for (int i = 0; i < 32; i++) {
        isnan(out.f[i]) ? gaps++ : values++;
        assert_int_equal(isnan(out.f[i]) != 0, isnan(out.slant[i][1]) != 0 && isnan(out.slant[i][2]) != 0);
        if (!isnan(out.f[i])) { /* slant 2 obeys the first of eqs. 24 */
            const double *s = out.slant[i];
            assert_true(fabs(cos(tilts[0] - tilts[1]) * sin(s[0]) * sin(s[1]) + cos(s[0]) * cos(s[1]) - cosines[0]) < 1e-9);
        }
    }
    assert_true(values > 0 && gaps > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constrained_slants_find),
        cmocka_unit_test(constrained_slants_nearest),
        cmocka_unit_test(slant_curve_sample),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
