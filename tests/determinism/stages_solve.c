/* From a picture to F by every method, and what follows from F. */
#include "digest.h"
#include "stages.h"

void mix_methods(const ofc_image *image, const struct fitted *fitted)
{
    const ofc_inlier_test *inliers = &fitted->inliers;
    const double *root = fitted->ellipsoid.root, *tilts = fitted->tilts.tilt_rad;
    ofc_annealing_params params;
    ofc_orthogonal found = {0};
    ofc_slants slants = {0};
    ofc_integrability integral = {0};
    mix_status(ofc_annealing_params_default(&params));
    params.proposals = 20;
    params.chains = 2;
    params.sample_cells = 60;
    params.polish_evaluations = 2;
    params.seed = 3;
    mix_status(ofc_orthogonal_annealing(image, inliers, root, tilts, &params, workspace, workspace_bytes, &found));
    mix_orthogonal(&found);
    mix_status(ofc_orthogonal_closed_form(image, inliers, root, NULL, 2, &found));
    mix_orthogonal(&found);
    mix_status(ofc_constrained_slants_integrable(image, inliers, fitted->ellipsoid.norms, tilts,
                                                 fitted->ellipsoid.cosines, 0.05, 40, workspace, workspace_bytes,
                                                 &slants));
    mix_slants(&slants);
    mix_status(ofc_integrability_integral(image, inliers, found.chosen.f_inverse, &integral));
    mix_integrability(&integral);
    for (ofc_normalization length = OFC_NORMALIZATION_UNIT; length <= OFC_NORMALIZATION_NONE; length++) {
        const ofc_status status = ofc_normals_from_matrix(image, inliers, found.chosen.f_inverse, length, normals,
                                                          WIDTH * 3 * sizeof(float));
        mix_status(status);
        mix_floats(normals, status == OFC_STATUS_OK ? image->height * WIDTH * 3 : 0);
    }
}

static void run_backwards(void *context, ofc_part part, void *work, int32_t count)
{
    (void)context;
    for (int32_t i = count - 1; i >= 0; i--)
        part(work, i);
}

/* Calls in parts write what calls as a whole have written; where they do not, the digest changes. */
static void mix_parts(const ofc_image *image, const ofc_solution *solution, ofc_status known)
{
    static float again[PIXELS * 3];
    const ofc_parallel parallel = {.run = run_backwards};
    int alike = ofc_normals_compute_parallel(image, solution, again, WIDTH * 3 * sizeof(float), &parallel) == OFC_STATUS_OK;
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < 3 * image->width; x++)
            alike &= again[3 * WIDTH * y + x] == normals[3 * WIDTH * y + x];
    alike &= ofc_normals_uncertainty_parallel(image, solution, again, WIDTH * sizeof(float), &parallel) == known;
    for (int y = 0; known == OFC_STATUS_OK && y < image->height; y++)
        for (int x = 0; x < image->width; x++)
            alike &= again[WIDTH * y + x] == angles[WIDTH * y + x];
    if (!alike)
        mix_text("other bits");
}

static void solve(const ofc_image *image, const ofc_solve_params *params)
{
    ofc_solution solution = {0};
    ofc_check_result result = {0};
    const ofc_status solved = ofc_solve(image, params, workspace, workspace_bytes, marks, &solution);
    mix_status(solved);
    mix_solution(&solution);
    mix_bytes(marks, solved >= 0 ? image->width * image->height : 0);
    if (solved != OFC_STATUS_OK)
        return;
    mix_status(ofc_normals_compute(image, &solution, normals, WIDTH * 3 * sizeof(float)));
    mix_floats(normals, image->height * image->width * 3);
    ofc_covariance covariance = {0};
    mix_status(ofc_solution_covariance(&solution, &covariance));
    mix_covariance(&covariance);
    const ofc_status known = ofc_normals_uncertainty(image, &solution, angles, WIDTH * sizeof(float));
    mix_status(known);
    mix_floats(angles, known == OFC_STATUS_OK ? image->height * image->width : 0);
    mix_parts(image, &solution, known);
    mix_status(ofc_normals_matte_weight(image, &solution, 1.5, angles, WIDTH * sizeof(float)));
    mix_floats(angles, image->height * image->width);
    mix_status(ofc_check(image, &solution, NULL, workspace, workspace_bytes, &result));
    mix_check(&result);
    const ofc_depth_map surface = mix_depth(image);
    mix_status(ofc_check(image, &solution, &surface, workspace, workspace_bytes, &result));
    mix_check(&result);
}

void mix_solve(const ofc_image *image, int variant)
{
    ofc_solve_params params;
    mix_status(ofc_solve_params_default(&params));
    params.lmeds.subsets = 20;
    params.lmeds.sample_size = 400;
    params.lmeds.seed = 9;
    solve(image, &params);
    params.orientation_method = OFC_ORIENTATION_DIRECT;
    params.tilt_estimator = OFC_TILT_PENTLAND;
    solve(image, &params);
    params.tilt_estimator = OFC_TILT_LEE_ROSENFELD + variant % 3;
    solve(image, &params);
    /* Three equal tilts agree with no angles between the lights: every fallback has its turn. */
    params.tilt_estimator = OFC_TILT_GIVEN;
    params.slant_fallback = OFC_FALLBACK_REFUSE + variant % 6;
    solve(image, &params);
}

void mix_flat_field(const ofc_image *image)
{
    ofc_flat_field_result result = {0};
    const ofc_status status = ofc_flat_field(image, image, normals, (size_t)image->width * 3 * sizeof(float), &result);
    mix_status(status);
    mix_floats(normals, status == OFC_STATUS_OK ? image->width * image->height * 3 : 0);
    mix_doubles(result.mean, 3);
    mix_status(result.used);
    mix_status(result.dark);
    mix_status(result.saturated);
}

void mix_segments(const ofc_image *image, const struct fitted *fitted)
{
    static uint16_t labels[PIXELS];
    static ofc_region regions[OFC_MAX_REGIONS];
    ofc_segment_params params;
    ofc_rank rank = {0};
    int32_t count = 0;
    mix_status(ofc_segment_params_default(&params));
    params.min_pixels = 40;
    params.seed_blocks = 60;
    params.refits = 3;
    params.max_regions = 3;
    mix_status(ofc_segment(image, &params, workspace, workspace_bytes, labels, regions, &count));
    mix_status(count);
    mix_shorts(labels, image->width * image->height);
    for (int i = 0; i < count; i++)
        mix_region(&regions[i]);
    mix_status(ofc_segment_mark(labels, image->width, image->height, 1, marks));
    mix_bytes(marks, image->width * image->height);
    mix_status(ofc_rank_compute(image, &fitted->inliers, &fitted->fit, &rank));
    mix_rank(&rank);
    mix_status(ofc_rank_compute(image, NULL, NULL, &rank));
    mix_rank(&rank);
    ofc_patch_class *const classes = (ofc_patch_class *)marks;
    const ofc_status ranked = ofc_rank_patches(image, 8, 1.5, 0, classes);
    mix_status(ranked);
    const int32_t patches = ofc_rank_patches_count(image->width, 8) * ofc_rank_patches_count(image->height, 8);
    mix_bytes(marks, ranked == OFC_STATUS_OK ? 2 * patches : 0);
}
