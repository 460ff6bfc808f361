/* ofc_solve() and what takes a solution: one that it found, and one of which some bits have changed. */
#include "fuzz.h"

static ofc_solve_params *any_params(void)
{
    ofc_solve_params *const params = TAKE(ofc_solve_params, 1);
    ofc_solve_params_default(params);
    params->lmeds.subsets = 8 + (uint32_t)below(24);
    params->orientation_method = below(2);
    params->tilt_estimator = below(5);
    params->slant_fallback = below(6);
    params->norm_source = one_in(4);
    params->convexity = one_in(4) ? below(3) : 0;
    params->shadow_rejection = below(3);
    params->lmeds.method = one_in(4);
    params->lmeds.sample_size = one_in(3) ? 12 + byte() : 10000;
    for (int i = 0; i < 3; i++)
        params->tilt_rad[i] = 2.1 * i + byte() / 256.0;
    change_some(params, sizeof *params);
    return params;
}

/* Some parts, some of them twice, and some that are none. */
static void run_some(void *context, ofc_part part, void *work, int32_t count)
{
    (void)context;
    for (int i = below(8); i > 0; i--)
        part(work, below(16) ? (int32_t)(word32() % (uint32_t)count) : (int32_t)word32());
}

static const ofc_parallel *any_parallel(void)
{
    ofc_parallel *const parallel = TAKE(ofc_parallel, 1);
    *parallel = (ofc_parallel){.run = run_some};
    return parallel;
}

static void check_counts(const struct picture *picture, const ofc_pixel_counts *counts)
{
    const int64_t all =
        (int64_t)counts->usable + counts->masked_out + counts->dark + counts->saturated + counts->non_finite + counts->shadowed;
    if (all != (int64_t)picture->width * picture->height || counts->usable < 0)
        fail("the counts of pixels make %lld", (long long)all);
}

/* What is made of a solution. */
static void use(const struct picture *picture, const ofc_solution *solution)
{
    const int32_t width = picture->width, height = picture->height;
    const size_t row = (size_t)width * sizeof(float), stride = stride_of(row, sizeof(float)), triple = stride_of(3 * row, sizeof(float));
    float *const normals = take_rows(3 * row, triple, height, sizeof(float));
#define IMAGE (picture->bad ? (must_be_refused(), picture->image) : BAD(picture->image, NULL))
    if (CALL(ofc_normals_compute(IMAGE, BAD(solution, NULL), BAD(normals, NULL), triple), normals) == 0)
        unit_normals("normals", normals, triple, width, height);
    const ofc_parallel *const parallel = any_parallel();
    if (CALL(ofc_normals_compute_parallel(IMAGE, BAD(solution, NULL), BAD(normals, NULL), triple, parallel), normals) == 0)
        unit_normals("normals in parts", normals, triple, width, height);
    float *const angle = take_rows(row, stride, height, sizeof(float));
    CALL(ofc_normals_uncertainty_parallel(IMAGE, BAD(solution, NULL), BAD(angle, NULL), stride, parallel), angle);
    if (CALL(ofc_normals_uncertainty(IMAGE, BAD(solution, NULL), BAD(angle, NULL), stride), angle) == 0)
        for (int32_t y = 0; y < height; y++)
            for (int32_t x = 0; x < width; x++) {
                const float one = ((const float *)((const char *)angle + (size_t)y * stride))[x];
                if (!(one >= 0 && one <= 3.1415928f))
                    fail("an uncertainty of %g", (double)one);
            }
    ofc_covariance *const covariance = TAKE(ofc_covariance, 1);
    if (CALL(ofc_solution_covariance(BAD(solution, NULL), BAD(covariance, NULL)), covariance) == 0)
        all_finite("covariance", covariance->c, sizeof *covariance / sizeof(double));
    float *const weight = take_rows(row, stride, height, sizeof(float));
    if (CALL(ofc_normals_matte_weight(IMAGE, BAD(solution, NULL), some_double(1, 2), BAD(weight, NULL), stride), weight) == 0)
        for (int32_t y = 0; y < height; y++)
            for (int32_t x = 0; x < width; x++) {
                const float one = ((const float *)((const char *)weight + (size_t)y * stride))[x];
                if (!(one >= 0 && one <= 1))
                    fail("a weight of %g", (double)one);
            }

    ofc_depth_map *const map = TAKE(ofc_depth_map, 1);
    float *const depth = TAKE(float, width * height);
    for (int i = 0; i < width * height; i++)
        depth[i] = (float)random_unit();
    for (int i = one_in(3) ? below(4) : 0; i > 0; i--)
        depth[word32() % (uint32_t)(width * height)] = any_float();
    *map = (ofc_depth_map){.depth = depth, .width = width, .height = height, .row_stride_bytes = row, .pixel_pitch = some_double(0.5, 2)};
    const size_t need = ofc_check_workspace_size(width, height);
    void *const workspace = workspace_of(need);
    ofc_check_result *const result = TAKE(ofc_check_result, 1);
    if (CALL(ofc_check(IMAGE, BAD(solution, NULL), below(2) ? map : NULL, bad_sometimes(workspace, 8, NULL), need, BAD(result, NULL)),
             workspace, result) == 0)
        finite_or_nan("check", DOUBLES(result, correlation, inlier_count));
}

void target(void)
{
    const struct picture picture = picture_of(28, 28);
    ofc_solve_params *const params = any_params();
    if (!shorten(&params->lmeds))
        return;
    size_t need = ofc_solve_workspace_size(picture.width, picture.height, params);
    if (need == 0 && !picture.bad)
        must_be_refused();
    if (need > 0 && one_in(64)) {
        need--;
        must_be_refused();
    }
    void *const workspace = workspace_of(need);
    uint8_t *const inliers = below(2) ? take((size_t)picture.width * (size_t)picture.height, 1) : NULL;
    ofc_solution *const solution = TAKE(ofc_solution, 1);
    ofc_status status = CALL(ofc_solve(picture.bad ? (must_be_refused(), picture.image) : BAD(picture.image, NULL), BAD(params, NULL),
                                       bad_sometimes(workspace, 8, params), need, inliers, BAD(solution, params)),
                             workspace, solution, inliers);
    ofc_pixel_counts *const counts = TAKE(ofc_pixel_counts, 1);
    ofc_reason *const reason = TAKE(ofc_reason, 1);
    if (CALL(ofc_pixel_counts_compute(picture.bad ? (must_be_refused(), picture.image) : BAD(picture.image, NULL), BAD(params, NULL),
                                      bad_sometimes(workspace, 8, NULL), need, BAD(counts, NULL), BAD(reason, NULL)),
             workspace, counts, reason) == 0)
        check_counts(&picture, counts);
    if (status >= 0) {
#ifdef PLANTED_FAULT
        if (status == OFC_STATUS_OK && picture.image->mask != NULL && picture.image->format >= OFC_PIXEL_RGB16)
            ((uint8_t *)solution)[sizeof *solution] = 1;
#endif
        check_solution("solution", solution, status);
        check_counts(&picture, &solution->pixel_counts);
        int32_t accepted = 0;
        for (int32_t i = 0; inliers != NULL && i < picture.width * picture.height; i++) {
            accepted += inliers[i] == 255;
            if (inliers[i] != 0 && inliers[i] != 255)
                fail("an inlier of %d", inliers[i]);
        }
        if (inliers != NULL && status == OFC_STATUS_OK && accepted != solution->inlier_count)
            fail("%d inliers, and %d in the mask", solution->inlier_count, accepted);
        if (one_in(4)) {
            ofc_solution *const again = TAKE(ofc_solution, 1);
            make_dirty(workspace);
            if (CALL(ofc_solve(picture.image, params, workspace, need, NULL, again), workspace, again) != status ||
                memcmp(solution, again, sizeof *again) != 0)
                fail("another solution of the same picture");
        }
        change_some(solution, sizeof *solution);
    } else {
        memset(solution, 0, sizeof *solution);
        change(solution, sizeof *solution, below(8));
    }
    use(&picture, solution);
}
