/* ofc_solve, its parameters and sizes, status messages and version. */
#include "contract.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

static struct {
    ofc_solution solution;
    uint8_t mask[PIXELS + 64];
    ofc_solve_params params;
    uint8_t before_workspace[64];
} out;

static ofc_status solve(const ofc_image *image)
{
    return ofc_solve(image, &stages.params, workspace, sizeof workspace, out.mask, &out.solution);
}

static void bad_images(void **state)
{
    (void)state;
    refuses_bad_images(solve, &out, sizeof out);
}

static void bad_pointers(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    const ofc_solve_params *params = &stages.params;
    const size_t need = ofc_solve_workspace_size(WIDTH, HEIGHT, params);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_solve(&image, NULL, workspace, need, out.mask, &out.solution));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_solve(&image, params, NULL, need, out.mask, &out.solution));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_solve(&image, params, workspace, need, out.mask, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out,
            ofc_solve(&image, MISALIGNED(params), workspace, need, out.mask, &out.solution));
    REFUSED(OFC_STATUS_MISALIGNED, out,
            ofc_solve(&image, params, MISALIGNED(workspace), need, out.mask, &out.solution));
    REFUSED(OFC_STATUS_MISALIGNED, out,
            ofc_solve(&image, params, (char *)workspace + 4, need, out.mask, &out.solution));
    REFUSED(OFC_STATUS_MISALIGNED, out,
            ofc_solve(&image, params, workspace, need, out.mask, MISALIGNED(&out.solution)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, ofc_solve(&image, params, workspace, 0, out.mask, &out.solution));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out,
            ofc_solve(&image, params, workspace, need - 1, out.mask, &out.solution));
}

static void overlaps(void **state)
{
    (void)state;
    ofc_image image = ball_image();
    const ofc_solve_params *params = &stages.params;
    static union {
        uint64_t words[sizeof workspace / 8 + sizeof(ofc_solution) / 8];
        ofc_solution solution;
        ofc_solve_params params;
        uint8_t mask[PIXELS];
    } shared;
    REFUSED(OFC_STATUS_OVERLAP, out,
            ofc_solve(&image, params, shared.words, sizeof shared.words, out.mask, &shared.solution));
    REFUSED(OFC_STATUS_OVERLAP, out,
            ofc_solve(&image, params, shared.words, sizeof shared.words, shared.mask, &out.solution));
    REFUSED(OFC_STATUS_OVERLAP, out,
            ofc_solve(&image, params, workspace, sizeof workspace, shared.mask, &shared.solution));
    REFUSED(OFC_STATUS_OVERLAP, out,
            ofc_solve(&image, params, workspace, sizeof workspace, &ball[0][0][0], &out.solution));
    memset(out.mask, 255, PIXELS);
    image.mask = out.mask;
    image.mask_stride_bytes = WIDTH;
    assert_int_equal(ofc_solve(&image, params, workspace, sizeof workspace, out.mask, &out.solution),
                     OFC_STATUS_OVERLAP);
    shared.params = *params;
    REFUSED(OFC_STATUS_OVERLAP, out,
            ofc_solve(&image, &shared.params, workspace, sizeof workspace, NULL, &shared.solution));
    REFUSED(OFC_STATUS_OVERLAP, out,
            ofc_solve(&image, &shared.params, shared.words, sizeof shared.words, NULL, &out.solution));
}

static void bad_parameters(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    struct {
        ofc_solve_params params;
        ofc_status expected;
    } bad[38];
    size_t n = 0;
#define BAD(status, field, value)                                                                                      \
    (bad[n].params = stages.params, bad[n].params.field = (value), bad[n++].expected = (status))
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.confidence, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.confidence, 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.confidence, NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.outlier_ratio, -0.1);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.outlier_ratio, 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.outlier_ratio, 0.999); /* more subsets than there may be */
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.outlier_ratio, NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.rejection, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.rejection, -2.5);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.rejection, INFINITY);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.limits_confidence, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.limits_confidence, 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.saturation, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.saturation, NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.min_subsets, 10000001);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.subsets, UINT32_MAX);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.sample_size, 11);
    BAD(OFC_STATUS_INVALID_PARAMETER, rank_threshold, -1e-3);
    BAD(OFC_STATUS_INVALID_PARAMETER, rank_threshold, 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, rank_threshold, NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, slant_fallback, 6);
    BAD(OFC_STATUS_INVALID_PARAMETER, tilt_estimator, 5);
    BAD(OFC_STATUS_INVALID_PARAMETER, tilt_estimator, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, lmeds.method, 2);
    BAD(OFC_STATUS_INVALID_PARAMETER, slant_fallback, -1);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved[0], 1);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved[1], 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, convexity, 3);
    BAD(OFC_STATUS_INVALID_PARAMETER, convexity, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, shadow_rejection, 3);
    BAD(OFC_STATUS_INVALID_PARAMETER, shadow_rejection, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, norm_source, 2);
    BAD(OFC_STATUS_INVALID_PARAMETER, norm_source, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, orientation_method, 2);
    BAD(OFC_STATUS_INVALID_PARAMETER, orientation_method, -1);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, lmeds.reserved[0], 1);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, lmeds.reserved[2], 1);
#undef BAD
    for (size_t i = 0; i < n; i++) {
        REFUSED(bad[i].expected, out,
                ofc_solve(&image, &bad[i].params, workspace, sizeof workspace, out.mask, &out.solution));
        assert_int_equal(ofc_solve_workspace_size(WIDTH, HEIGHT, &bad[i].params), 0);
    }
}

static void pictures_without_an_answer(void **state)
{
    (void)state;
    static uint8_t pixels[HEIGHT][WIDTH][3], mask[PIXELS];
    ofc_image image = ball_image();
    image.mask = mask;
    image.mask_stride_bytes = WIDTH;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, solve(&image));
    mask[HEIGHT / 2 * WIDTH + WIDTH / 2] = 1;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, solve(&image));
    image.mask = NULL;
    image.pixels = pixels;
    REFUSED(OFC_STATUS_DARK, out, solve(&image));
    memset(pixels, 255, sizeof pixels);
    REFUSED(OFC_STATUS_SATURATED, out, solve(&image));

    /* One color: nothing is determined, and the solution says what was seen. */
    memset(pixels, 90, sizeof pixels);
    assert_int_equal(solve(&image), OFC_STATUS_RANK_DEFICIENT);
    assert_int_equal(out.solution.outcome, OFC_STATUS_RANK_DEFICIENT);
    assert_int_equal(out.solution.pixel_counts.usable, PIXELS);
    assert_int_equal(out.solution.orientation.rank, 0);
    assert_int_equal(out.solution.slant_source, OFC_SLANTS_NONE);
    assert_int_equal(out.solution.chosen, -1);
    assert_int_equal(out.solution.inlier_count, 0);
    assert_true(out.solution.fit.color_deviations[0] > 0);
    assert_true(isnan(out.solution.confidence.error_rad));

    static float floats[HEIGHT][WIDTH][3];
    for (int i = 0; i < PIXELS * 3; i++)
        (&floats[0][0][0])[i] = i % 2 ? NAN : INFINITY;
    image.pixels = floats;
    image.format = OFC_PIXEL_RGB32F;
    image.row_stride_bytes = sizeof floats[0];
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, solve(&image));
}

static void answers(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(solve(&image), OFC_STATUS_OK);
    assert_true(is_untouched(out.mask + PIXELS, 64));
    assert_true(is_untouched(&out.params, sizeof out.params));
    int32_t inliers = 0;
    for (int i = 0; i < PIXELS; i++) {
        assert_true(out.mask[i] == 0 || out.mask[i] == 255);
        inliers += out.mask[i] != 0;
    }
    assert_int_equal(out.solution.inlier_count, inliers);
    const ofc_pixel_counts *pixel_counts = &out.solution.pixel_counts;
    assert_int_equal(pixel_counts->usable + pixel_counts->masked_out + pixel_counts->dark + pixel_counts->saturated + pixel_counts->non_finite +
                         pixel_counts->shadowed,
                     PIXELS);
    /* A mask is a wish, and the answer does not depend on it. */
    static ofc_solution again;
    memset(&again, 0, sizeof again);
    memset(workspace, 0xff, sizeof workspace);
    assert_int_equal(ofc_solve(&image, &stages.params, workspace, sizeof workspace, NULL, &again), OFC_STATUS_OK);
    assert_memory_equal(&again, &out.solution, sizeof again);
    /* Refusing to guess changes nothing where there is a root. */
    ofc_solve_params strict = stages.params;
    strict.slant_fallback = 0;
    assert_int_equal(ofc_solve(&image, &strict, workspace, sizeof workspace, NULL, &again), OFC_STATUS_OK);
    assert_memory_equal(&again, &out.solution, sizeof again);
}

static void methods(void **state)
{
    (void)state;
    /* The default: F as a whole, with how sure it is. */
    const ofc_image image = ball_image();
    ofc_solve_params params;
    assert_int_equal(ofc_solve_params_default(&params), OFC_STATUS_OK);
    assert_int_equal(params.orientation_method, OFC_ORIENTATION_JOINT);
    static ofc_solution joint;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &joint), OFC_STATUS_OK);
    assert_int_equal(joint.slant_source, OFC_SLANTS_JOINT);
    assert_true(joint.candidate_count == 0 && joint.chosen == -1);
    const ofc_confidence *confidence = &joint.confidence;
    assert_true(confidence->evidence >= OFC_EVIDENCE_OUTWARD && confidence->evidence <= OFC_EVIDENCE_BOTH);
    assert_true(confidence->error_rad > 0 && confidence->error_rad < 0.2);
    assert_true(confidence->convexity > 0.9 && confidence->convexity <= 1 && confidence->log_likelihood_margin > 0);
    for (int c = 0; c < 3; c++) /* the ball suits the direct method too */
        assert_true(fabs(joint.slant_rad[c] - stages.solution.slant_rad[c]) < 0.2);
    /* The direct method claims no certainty; given tilts take it. */
    assert_int_equal(stages.solution.slant_source, OFC_SLANTS_ROOT);
    assert_true(stages.solution.confidence.evidence == OFC_EVIDENCE_TILTS_ALONE);
    assert_true(isnan(stages.solution.confidence.error_rad) && isnan(stages.solution.confidence.covariance[8]));
    assert_true(isnan(stages.solution.confidence.convexity) && isnan(stages.solution.confidence.log_likelihood_margin));
    /* The border of the ball is in the shadow of one light or another: left out by the joint method, kept by the direct
     * one unless asked. */
    assert_true(joint.pixel_counts.shadowed > 0 && joint.inlier_test.shadow_planes[0].threshold > 0);
    assert_true(stages.solution.pixel_counts.shadowed == 0 && stages.solution.inlier_test.shadow_planes[0].threshold == 0);
    assert_int_equal(joint.pixel_counts.usable + joint.pixel_counts.shadowed, stages.solution.pixel_counts.usable);
    static ofc_solution other;
    params.shadow_rejection = OFC_SHADOW_REJECTION_OFF;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &other), OFC_STATUS_OK);
    assert_int_equal(other.pixel_counts.shadowed, 0);
    params.orientation_method = OFC_ORIENTATION_DIRECT;
    params.shadow_rejection = OFC_SHADOW_REJECTION_ON;
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &other), OFC_STATUS_OK);
    assert_int_equal(other.pixel_counts.shadowed, joint.pixel_counts.shadowed);
    params.orientation_method = OFC_ORIENTATION_JOINT;
    params.shadow_rejection = OFC_SHADOW_REJECTION_AUTO;
    params.tilt_estimator = OFC_TILT_GIVEN;
    memcpy(params.tilt_rad, stages.solution.tilts.tilt_rad, sizeof params.tilt_rad);
    assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &joint), OFC_STATUS_OK);
    assert_int_equal(joint.slant_source, OFC_SLANTS_ROOT);
    assert_true(joint.slant_rad[0] == stages.solution.slant_rad[0]);
}

static void hollow(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    for (int32_t method = OFC_ORIENTATION_JOINT; method <= OFC_ORIENTATION_DIRECT; method++) {
        ofc_solve_params params;
        ofc_solve_params_default(&params);
        assert_int_equal(params.convexity, OFC_CONVEXITY_AUTO);
        params.orientation_method = method;
        static ofc_solution found[3];
        memset(found, 0, sizeof found);
        for (int i = 0; i < 3; i++) {
            params.convexity = i;
            assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &found[i]), OFC_STATUS_OK);
        }
        const ofc_solution *dome = &found[OFC_CONVEXITY_AUTO], *hollow = &found[OFC_CONVEXITY_HOLLOW];
        assert_memory_equal(dome, &found[OFC_CONVEXITY_CONVEX], sizeof *dome);
        for (int i = 0; i < 9; i++) {
            assert_true(hollow->orientation.f[i] == (i % 3 < 2 ? -1 : 1) * dome->orientation.f[i]);
            assert_true(hollow->orientation.f_inverse[i] == (i / 3 < 2 ? -1 : 1) * dome->orientation.f_inverse[i]);
        }
        for (int c = 0; c < 3; c++) {
            assert_true(fabs(fabs(hollow->tilts.tilt_rad[c] - dome->tilts.tilt_rad[c]) - acos(-1)) < 1e-12);
            assert_true(hollow->slant_rad[c] == dome->slant_rad[c]);
        }
        if (method == OFC_ORIENTATION_JOINT)
            assert_true(hollow->confidence.convexity == -dome->confidence.convexity &&
                        hollow->confidence.error_rad == dome->confidence.error_rad);
        /* Given tilts choose by themselves. */
        params.tilt_estimator = OFC_TILT_GIVEN;
        memcpy(params.tilt_rad, dome->tilts.tilt_rad, sizeof params.tilt_rad);
        assert_int_equal(ofc_solve(&image, &params, workspace, sizeof workspace, NULL, &found[1]), OFC_STATUS_OK);
        assert_true(found[1].tilts.tilt_rad[0] == dome->tilts.tilt_rad[0]);
    }
}

static void exact_workspace(void **state)
{
    (void)state;
    /* From the heap, so that a sanitizer sees one byte too many. */
    const ofc_image image = ball_image();
    const size_t need = ofc_solve_workspace_size(WIDTH, HEIGHT, &stages.params);
    void *exact = malloc(need);
    uint8_t *mask = malloc(PIXELS);
    assert_non_null(exact);
    assert_non_null(mask);
    assert_int_equal(ofc_solve(&image, &stages.params, exact, need, mask, &out.solution), OFC_STATUS_OK);
    free(mask);
    free(exact);
}

static void sizes(void **state)
{
    (void)state;
    ofc_solve_params params = stages.params;
    static const int32_t edges[] = {1, 2, 7, 64, 99, 100, 101, 141, 142, 200, 480, 640, 4000, 46340};
    static const uint32_t samples[] = {12, 100, 10000, 20000, 1000000};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++)
        for (size_t j = 0; j < sizeof edges / sizeof *edges; j++) {
            params.lmeds.sample_size = 10000;
            assert_int_equal(ofc_lmeds_workspace_size(edges[i], edges[j], &params.lmeds),
                             OFC_LMEDS_WORKSPACE_SIZE(edges[i], edges[j]));
            assert_int_equal(ofc_norm_location_workspace_size(edges[i], edges[j]),
                             OFC_NORM_LOCATION_WORKSPACE_SIZE(edges[i], edges[j]));
            assert_int_equal(ofc_location_workspace_size((size_t)edges[i]), OFC_LOCATION_WORKSPACE_SIZE(edges[i]));
            assert_int_equal(ofc_solve_workspace_size(edges[i], edges[j], &params),
                             OFC_SOLVE_WORKSPACE_SIZE(edges[i], edges[j]));
            for (size_t k = 0; k < sizeof samples / sizeof *samples; k++) {
                params.lmeds.sample_size = samples[k];
                assert_int_equal(ofc_solve_workspace_size(edges[i], edges[j], &params),
                                 OFC_SOLVE_WORKSPACE_SIZE_FOR(edges[i], edges[j], samples[k]));
                assert_int_equal(ofc_lmeds_workspace_size(edges[i], edges[j], &params.lmeds),
                                 OFC_LMEDS_WORKSPACE_SIZE_FOR(edges[i], edges[j], samples[k]));
            }
        }
    assert_int_equal(ofc_solve_workspace_size(0, 10, &params), 0);
    assert_int_equal(ofc_solve_workspace_size(10, -1, &params), 0);
    assert_int_equal(ofc_solve_workspace_size(INT32_MAX, 2, &params), 0);
    assert_int_equal(ofc_solve_workspace_size(10, 10, NULL), 0);
    assert_int_equal(ofc_solve_workspace_size(10, 10, MISALIGNED(&params)), 0);
}

static void defaults(void **state)
{
    (void)state;
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_solve_params_default(NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_solve_params_default(MISALIGNED(&out.params)));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(ofc_solve_params_default(&out.params), OFC_STATUS_OK);
    assert_true(is_untouched(out.before_workspace, sizeof out.before_workspace));
    const ofc_solve_params *params = &out.params;
    assert_true(params->lmeds.confidence == 0.9999 && params->lmeds.outlier_ratio == 0.5);
    assert_true(params->lmeds.rejection == 2.5 && params->lmeds.limits_confidence == 0.95);
    assert_true(params->lmeds.saturation == 0 && params->rank_threshold == 1e-3);
    assert_int_equal(params->lmeds.seed, 0);
    assert_int_equal(params->lmeds.min_subsets, 500);
    assert_int_equal(params->lmeds.subsets, 0);
    assert_int_equal(params->lmeds.sample_size, 10000);
    assert_int_equal(params->slant_fallback, OFC_FALLBACK_LEAST_SQUARES);
    assert_int_equal(params->tilt_estimator, OFC_TILT_PENTLAND);
    assert_int_equal(params->lmeds.method, OFC_FIT_LEAST_MEDIAN);
    ofc_lmeds_params lmeds;
    memset(&lmeds, 0, sizeof lmeds);
    assert_int_equal(ofc_lmeds_params_default(&lmeds), OFC_STATUS_OK);
    assert_memory_equal(&lmeds, &params->lmeds, sizeof lmeds);
    assert_int_equal(ofc_lmeds_params_default(NULL), OFC_STATUS_NULL_POINTER);
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_lmeds_params_default(MISALIGNED(&out.params)));
}

static void messages_and_version(void **state)
{
    (void)state;
    static const ofc_status all[] = {0,   1,   2,   3,   4,   7,   -10, -11, -12, -20, -21, -22,
                                     -23, -30, -31, -32, -33, -40, -41, -42, -43, -50, -51, -52, -53, -54, -55, 5, 6, 8, 9};
    const size_t count = sizeof all / sizeof *all;
    const char *unknown = ofc_status_message(12345);
    assert_string_equal(unknown, ofc_status_message(INT32_MIN));
    for (size_t i = 0; i < count; i++) {
        assert_string_not_equal(ofc_status_message(all[i]), unknown);
        for (size_t j = 0; j < i; j++)
            assert_string_not_equal(ofc_status_message(all[i]), ofc_status_message(all[j]));
    }
    assert_int_equal(ofc_version(), OFC_VERSION);
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", OFC_VERSION_MAJOR, OFC_VERSION_MINOR, OFC_VERSION_PATCH);
    assert_string_equal(ofc_version_string(), text);
}

struct job {
    ofc_image image;
    ofc_solution solution;
    uint64_t workspace[sizeof workspace / sizeof(uint64_t)];
    ofc_status status;
};

static void *run(void *argument)
{
    struct job *job = argument;
    job->status = ofc_solve(&job->image, &stages.params, job->workspace, sizeof job->workspace, NULL, &job->solution);
    return NULL;
}

static void threads_at_once(void **state)
{
    (void)state;
    static struct job jobs[4];
    pthread_t threads[4];
    for (int i = 0; i < 4; i++) {
        jobs[i].image = ball_image();
        assert_int_equal(pthread_create(&threads[i], NULL, run, &jobs[i]), 0);
    }
    for (int i = 0; i < 4; i++) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
        assert_int_equal(jobs[i].status, OFC_STATUS_OK);
        assert_memory_equal(&jobs[i].solution, &jobs[0].solution, sizeof jobs[0].solution);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_images),      cmocka_unit_test(bad_pointers),
        cmocka_unit_test(overlaps),        cmocka_unit_test(bad_parameters),
        cmocka_unit_test(answers),         cmocka_unit_test(pictures_without_an_answer),
        cmocka_unit_test(exact_workspace), cmocka_unit_test(sizes),
        cmocka_unit_test(defaults),        cmocka_unit_test(messages_and_version),
        cmocka_unit_test(threads_at_once), cmocka_unit_test(methods),
        cmocka_unit_test(hollow),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
