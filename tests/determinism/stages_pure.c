/* What needs no picture. */
#include "digest.h"
#include "inputs.h"
#include "stages.h"

void digest_constants(void)
{
    mix_integer(ofc_version());
    mix_integer(OFC_VERSION);
    mix_text(ofc_version_string());
    for (ofc_status status = -60; status < 20; status++)
        mix_text(ofc_status_message(status));
    for (ofc_reason reason = -5; reason < 70; reason++) {
        mix_text(ofc_reason_message(reason));
        mix_text(ofc_reason_advice(reason));
    }
    digest_print("version and messages");

    ofc_lmeds_params lmeds;
    ofc_solve_params solve;
    ofc_render_params render;
    ofc_annealing_params annealing;
    ofc_segment_params segment;
    mix_status(ofc_lmeds_params_default(&lmeds));
    mix_lmeds_params(&lmeds);
    mix_status(ofc_solve_params_default(&solve));
    mix_solve_params(&solve);
    mix_status(ofc_render_params_default(&render));
    mix_render_params(&render);
    mix_status(ofc_annealing_params_default(&annealing));
    mix_annealing_params(&annealing);
    mix_status(ofc_segment_params_default(&segment));
    mix_segment_params(&segment);
    ofc_depth_params depth;
    ofc_stream_params stream;
    mix_status(ofc_depth_params_default(&depth));
    mix_depth_params(&depth);
    mix_status(ofc_stream_params_default(&stream));
    mix_solve_params(&stream.solve);
    mix_doubles(&stream.min_inlier_ratio, 1);
    mix_integer(stream.refine_pixels);
    for (int32_t width = -1; width < 5000; width += 617)
        for (int32_t height = 1; height < 4000; height += 977) {
            mix_integer(ofc_lmeds_workspace_size(width, height, &lmeds));
            mix_integer(ofc_solve_workspace_size(width, height, &solve));
            mix_integer(ofc_norm_location_workspace_size(width, height));
            mix_integer(ofc_location_workspace_size((size_t)height));
            mix_integer(ofc_largest_disc_workspace_size(width, height));
            mix_integer(ofc_check_workspace_size(width, height));
            mix_integer(ofc_segment_workspace_size(width, height));
            mix_integer(ofc_depth_workspace_size(width, height));
            mix_integer(ofc_stream_size(width, height, &stream));
            mix_integer(ofc_orthogonal_annealing_workspace_size(width, height, &annealing));
            mix_integer(ofc_constrained_slants_integrable_workspace_size(width, height, 500));
            mix_integer((uint32_t)ofc_rank_patches_count(width, 7));
        }
    digest_print("defaults and sizes");

    for (int i = 1; i < 40; i++)
        mix_integer(ofc_lmeds_subset_count(i / 40.0, 1 - i / 50.0, (uint32_t)i));
    digest_print("subset counts");
}

static void random_numbers(double *numbers, int count, double scale)
{
    for (int i = 0; i < count; i++)
        numbers[i] = scale * random_number();
}

static void mix_constrained_slants(void)
{
    double tilts[3], cosines[3], along[33][3], f[33];
    ofc_slants candidates[OFC_MAX_CANDIDATES], nearest;
    random_numbers(tilts, 3, 3.14);
    random_numbers(cosines, 3, 1);
    int32_t count = 0;
    mix_status(ofc_constrained_slants_find(tilts, cosines, candidates, &count));
    for (int i = 0; i < count; i++)
        mix_slants(&candidates[i]);
    mix_status(ofc_constrained_slants_least_squares(tilts, cosines, &nearest));
    mix_slants(&nearest);
    for (int branch = 1; branch <= 8; branch += 3) {
        mix_status(ofc_slant_curve_sample(tilts, cosines, branch, 33, along[0], f));
        mix_doubles(along[0], 99);
        mix_doubles(f, 33);
    }
}

static void mix_ellipsoids(void)
{
    /* Around the identity: positive definite, or nearly, or not. */
    double form[6], norms[3], tilts[3], slants[3];
    random_numbers(form, 6, 0.7);
    form[0] += 1;
    form[1] += 1;
    form[2] += 1;
    ofc_ellipsoid ellipsoid;
    const ofc_status decomposed = ofc_ellipsoid_decompose(form, &ellipsoid);
    mix_status(decomposed);
    if (decomposed == OFC_STATUS_OK)
        mix_ellipsoid(&ellipsoid);
    random_numbers(norms, 3, 100);
    random_numbers(tilts, 3, 3.14);
    random_numbers(slants, 3, 0.7);
    ofc_orientation orientation;
    for (int i = 0; i < 3; i++) {
        norms[i] += 101;
        slants[i] += 0.75;
    }
    mix_status(ofc_orientation_compose(norms, tilts, slants, 0.05, &orientation));
    mix_orientation(&orientation);
    tilts[2] = tilts[1];
    slants[2] = slants[1];
    mix_status(ofc_orientation_compose(norms, tilts, slants, 1e-3, &orientation));
    mix_orientation(&orientation);
}

void digest_mathematics(void)
{
    random_seed(17);
    for (int i = 0; i < 24; i++)
        mix_constrained_slants();
    digest_print("constrained slants of random tilts and cosines");
    for (int i = 0; i < 60; i++)
        mix_ellipsoids();
    digest_print("random ellipsoids and orientations");
    for (int count = 2; count < 500; count += 71) {
        float values[500];
        for (int i = 0; i < count; i++)
            values[i] = (float)(random_number() * random_number() * random_number());
        ofc_location location;
        mix_status(ofc_location_fit(values, (size_t)count, workspace, workspace_bytes, &location));
        mix_location(&location);
    }
    digest_print("locations of random numbers");
}
