/* Calls without a picture: sizes and their macros, messages, and what follows from a few numbers. */
#include "fuzz.h"

static void messages(void)
{
    const int32_t number = byte() < 200 ? byte() - 100 : any_int();
    const char *const texts[] = {ofc_status_message(number), ofc_reason_message(number), ofc_reason_advice(number), ofc_version_string()};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (texts[i] == NULL || strnlen(texts[i], 400) >= 400)
            fail("text %zu of %d", i, number);
    if (ofc_version() != OFC_VERSION)
        fail("version %u", ofc_version());
}

/* A size is what its macro says, at most with `is_bound`, and 0 only for what must be refused. */
static void same_size(const char *what, size_t size, size_t macro, int is_valid, int is_bound)
{
    if (size == 0 ? is_valid : is_bound ? size > macro : size != macro)
        fail("%s: %zu, and %zu by the macro", what, size, macro);
}

static void sizes(void)
{
    const int32_t width = any_int(), height = any_int();
    const uint32_t sample = (uint32_t)any_int();
    const int plain = width >= 1 && height >= 1 && width <= 20000 && height <= 20000;
#define SAME(name, macro, is_valid, is_bound, ...) same_size(#name, name(__VA_ARGS__), macro, is_valid, is_bound)
    ofc_lmeds_params lmeds;
    ofc_lmeds_params_default(&lmeds);
    lmeds.sample_size = sample;
    SAME(ofc_lmeds_workspace_size, OFC_LMEDS_WORKSPACE_SIZE_FOR(width, height, sample), plain && sample >= 12, 0, width, height, &lmeds);
    ofc_solve_params solve;
    ofc_solve_params_default(&solve);
    SAME(ofc_solve_workspace_size, OFC_SOLVE_WORKSPACE_SIZE(width, height), plain, 0, width, height, &solve);
    solve.lmeds.sample_size = sample;
    SAME(ofc_solve_workspace_size, OFC_SOLVE_WORKSPACE_SIZE_FOR(width, height, sample), plain && sample >= 12, 0, width, height, &solve);
    ofc_annealing_params annealing;
    ofc_annealing_params_default(&annealing);
    annealing.sample_cells = sample;
    SAME(ofc_orthogonal_annealing_workspace_size, OFC_ORTHOGONAL_ANNEALING_WORKSPACE_SIZE(width, height, sample), plain && sample >= 1, 0,
         width, height, &annealing);
    SAME(ofc_constrained_slants_integrable_workspace_size, OFC_CONSTRAINED_SLANTS_INTEGRABLE_WORKSPACE_SIZE(width, height, sample),
         plain && sample >= 1, 0, width, height, sample);
    SAME(ofc_depth_workspace_size, OFC_DEPTH_WORKSPACE_SIZE(width, height), plain, 0, width, height);
    SAME(ofc_surface_workspace_size, OFC_SURFACE_WORKSPACE_SIZE(width, height), plain, 0, width, height);
    SAME(ofc_norm_location_workspace_size, OFC_NORM_LOCATION_WORKSPACE_SIZE(width, height), plain, 0, width, height);
    SAME(ofc_largest_disc_workspace_size, OFC_LARGEST_DISC_WORKSPACE_SIZE(width, height), plain, 0, width, height);
    SAME(ofc_check_workspace_size, OFC_CHECK_WORKSPACE_SIZE(width, height), plain, 0, width, height);
    SAME(ofc_segment_workspace_size, OFC_SEGMENT_WORKSPACE_SIZE(width, height), plain, 0, width, height);
    SAME(ofc_paint_albedo_workspace_size, OFC_PAINT_ALBEDO_WORKSPACE_SIZE(width, height), plain, 0, width, height);
    SAME(ofc_location_workspace_size, OFC_LOCATION_WORKSPACE_SIZE(sample), sample > 0, 0, sample);
    same_size("ofc_paint_workspace_size", ofc_paint_workspace_size(), OFC_PAINT_WORKSPACE_SIZE, 1, 0);
    const size_t relief = ofc_relief_workspace_size(width, height);
    if (relief > 2100000)
        fail("a relief of %d x %d needs %zu bytes", width, height, relief);
    ofc_stream_params stream;
    ofc_stream_params_default(&stream);
    SAME(ofc_stream_size, OFC_STREAM_SIZE(width, height), plain, 1, width, height, &stream);
    stream.solve.lmeds.sample_size = sample;
    SAME(ofc_stream_size, OFC_STREAM_SIZE_FOR(width, height, sample), plain && sample >= 24, 1, width, height, &stream);
    const int32_t patches = ofc_rank_patches_count(width, height);
    if (patches != (width < 1 || height < 1 ? 0 : (int32_t)(((int64_t)width + height - 1) / height)))
        fail("%d patches", patches);
    (void)ofc_lmeds_workspace_size(width, height, NULL);
}

static void subsets(void)
{
    const double confidence = some_double(0, 1), outliers = some_double(0, 1);
    const uint32_t least = (uint32_t)any_int(), count = ofc_lmeds_subset_count(confidence, outliers, least);
    if (count > 10000000 || (count > 0 && (count < least || !(confidence > 0 && confidence < 1 && outliers >= 0 && outliers < 1))))
        fail("%u subsets", count);
}

static void location(void)
{
    const size_t count = (size_t)below(70), need = ofc_location_workspace_size(count);
    float *const values = TAKE(float, count);
    random_begin(word32());
    const double scale = some_double(0, 100);
    for (size_t i = 0; i < count; i++)
        values[i] = (float)(scale * (random_unit() - 0.3) * (i % 5 == 0 ? 3 : 1));
    if (count > 0 && one_in(4))
        values[word32() % count] = any_float();
    const size_t given = need > 0 && one_in(32) ? (must_be_refused(), need - 1) : need;
    void *const workspace = workspace_of(given);
    ofc_location *const found = TAKE(ofc_location, 1);
    if (CALL(ofc_location_fit(BAD(values, NULL), count, bad_sometimes(workspace, 8, NULL), given, BAD(found, NULL)), workspace, found) == 0)
        all_finite("location", &found->location, 3);
}

static double *numbers(size_t count, double low, double high)
{
    double *const all = TAKE(double, count);
    for (size_t i = 0; i < count; i++)
        all[i] = some_double(low, high);
    return all;
}

static void slants(void)
{
    double *const tilts = numbers(3, -3.2, 3.2), *const cosines = numbers(3, -0.9, 0.9);
    ofc_slants *const candidates = TAKE(ofc_slants, OFC_MAX_CANDIDATES), *const best = TAKE(ofc_slants, 1);
    int32_t *const count = TAKE(int32_t, 1);
    const ofc_status status =
        CALL(ofc_constrained_slants_find(BAD(tilts, NULL), cosines, BAD(candidates, cosines), BAD(count, NULL)), candidates, count);
    if (status >= 0) {
        if (*count < 0 || *count > OFC_MAX_CANDIDATES || (*count == 0) != (status == OFC_STATUS_NO_CONSISTENT_SLANTS))
            fail("%d candidates with status %d", *count, status);
        for (int i = 0; i < *count; i++) {
            all_finite("candidate", candidates[i].slant_rad, 5);
            for (int k = 0; k < 3; k++)
                if (candidates[i].slant_rad[k] < 0 || candidates[i].slant_rad[k] > 1.5707963267948968)
                    fail("slant %g", candidates[i].slant_rad[k]);
        }
    }
    if (CALL(ofc_constrained_slants_least_squares(tilts, BAD(cosines, NULL), BAD(best, tilts)), best) == 0)
        all_finite("least squares", best->slant_rad, 5);
    const int32_t samples = one_in(16) ? any_int() : 2 + below(60);
    const int room = samples > 0 && samples <= 10000 ? samples : 2;
    double *const curve = TAKE(double, 3 * room), *const f = TAKE(double, room);
    if (samples > 10000)
        return;
    if (CALL(ofc_slant_curve_sample(tilts, cosines, below(10), samples, BAD(curve, f), BAD(f, curve)), curve, f) == 0) {
        finite_or_nan("curve", curve, 3 * (size_t)room);
        finite_or_nan("curve", f, (size_t)room);
    }
}

static void matrices(void)
{
    double *const c = numbers(6, -0.5, 2), *const norms = numbers(3, 0.1, 300), *const tilts = numbers(3, -3.2, 3.2),
                  *const slants = numbers(3, 0, 1.6);
    ofc_ellipsoid *const ellipsoid = TAKE(ofc_ellipsoid, 1);
    if (CALL(ofc_ellipsoid_decompose(BAD(c, NULL), BAD(ellipsoid, c)), ellipsoid) == 0)
        all_finite("ellipsoid", ellipsoid->c, sizeof *ellipsoid / sizeof(double));
    ofc_orientation *const orientation = TAKE(ofc_orientation, 1);
    const double threshold = some_double(0, 0.01);
    ofc_status status = CALL(ofc_orientation_compose(BAD(norms, NULL), tilts, slants, threshold, BAD(orientation, tilts)), orientation);
#ifdef PLANTED_FAULT
    if (status == OFC_STATUS_RANK_DEFICIENT && orientation->rank == 1)
        orientation->f_inverse[8] = INFINITY;
#endif
    if (status >= 0) {
        all_finite("orientation", DOUBLES(orientation, f, rank));
        if (orientation->rank < 0 || orientation->rank > 3 || (orientation->rank == 3) != (status == OFC_STATUS_OK))
            fail("rank %d with status %d", orientation->rank, status);
    }
}

/* A solution that nobody computed. */
static void made_up_solution(void)
{
    ofc_solution *const solution = TAKE(ofc_solution, 1);
    memset(solution, 0, sizeof *solution);
    for (int i = 0; i < 9; i++)
        solution->orientation.f[i] = solution->orientation.f_inverse[i] = i % 4 == 0;
    solution->orientation.rank = 3;
    solution->slant_source = OFC_SLANTS_JOINT;
    for (int i = 0; i < 6; i++) {
        solution->fit.coefficients[i].value = i < 3;
        solution->inlier_test.norm_form[i] = solution->ellipsoid.c[i] = some_double(0, 1);
    }
    change(solution, sizeof *solution, below(12));
    ofc_covariance *const covariance = TAKE(ofc_covariance, 1);
    if (CALL(ofc_solution_covariance(BAD(solution, NULL), BAD(covariance, solution)), covariance) == 0)
        all_finite("covariance", covariance->c, sizeof *covariance / sizeof(double));
}

static void defaults(void)
{
    ofc_solve_params *const solve = TAKE(ofc_solve_params, 1);
    ofc_lmeds_params *const lmeds = TAKE(ofc_lmeds_params, 1);
    ofc_depth_params *const depth = TAKE(ofc_depth_params, 1);
    ofc_annealing_params *const annealing = TAKE(ofc_annealing_params, 1);
    ofc_render_params *const render = TAKE(ofc_render_params, 1);
    ofc_segment_params *const segment = TAKE(ofc_segment_params, 1);
    ofc_paint_params *const paint = TAKE(ofc_paint_params, 1);
    ofc_relief_params *const relief = TAKE(ofc_relief_params, 1);
    ofc_stream_params *const stream = TAKE(ofc_stream_params, 1);
    ofc_surface_params *const surface = TAKE(ofc_surface_params, 1);
    CALL(ofc_surface_params_default(BAD(surface, NULL)), surface);
    CALL(ofc_solve_params_default(BAD(solve, NULL)), solve);
    CALL(ofc_lmeds_params_default(BAD(lmeds, NULL)), lmeds);
    CALL(ofc_depth_params_default(BAD(depth, NULL)), depth);
    CALL(ofc_annealing_params_default(BAD(annealing, NULL)), annealing);
    CALL(ofc_render_params_default(BAD(render, NULL)), render);
    CALL(ofc_segment_params_default(BAD(segment, NULL)), segment);
    CALL(ofc_paint_params_default(BAD(paint, NULL)), paint);
    CALL(ofc_relief_params_default(BAD(relief, NULL)), relief);
    CALL(ofc_stream_params_default(BAD(stream, NULL)), stream);
}

void target(void)
{
    static void (*const calls[])(void) = {messages, sizes, subsets, location, slants, matrices, made_up_solution, defaults};
    calls[below(sizeof calls / sizeof *calls)]();
}
