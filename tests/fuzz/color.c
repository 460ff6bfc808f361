/* The regression in color space, inliers, ranks and regions. */
#include "fuzz.h"

void target(void)
{
    const struct picture picture = picture_of(28, 28);
    const int32_t width = picture.width, height = picture.height;
    const size_t pixels = (size_t)width * (size_t)height;
#define IMAGE (picture.bad ? (must_be_refused(), picture.image) : BAD(picture.image, NULL))
    ofc_lmeds_params *const params = TAKE(ofc_lmeds_params, 1);
    ofc_lmeds_params_default(params);
    params->subsets = 8 + (uint32_t)below(24);
    params->method = one_in(4);
    params->weighting = one_in(4);
    params->sample_size = one_in(3) ? 12 + byte() : 10000;
    change_some(params, sizeof *params);
    if (!shorten(params))
        return;
    size_t need = ofc_lmeds_workspace_size(width, height, params);
    if (need == 0 || one_in(64)) {
        need -= need > 0;
        must_be_refused();
    }
    void *const workspace = workspace_of(need);
    ofc_color_fit *const fit = TAKE(ofc_color_fit, 1);
    ofc_inlier_test *const test = TAKE(ofc_inlier_test, 1);
    const ofc_status fitted = CALL(ofc_lmeds_fit(IMAGE, BAD(params, NULL), bad_sometimes(workspace, 8, params), need, BAD(fit, test), BAD(test, params)),
                                   workspace, fit, test);
    if (fitted == OFC_STATUS_OK) {
        check_fit("fit", fit);
        check_inlier_test("fit", test);
    } else {
        memset(fit, 0, sizeof *fit);
        memset(test, 0, sizeof *test);
        test->saturation = test->residual_high = test->norm_high = INFINITY;
        test->residual_low = test->norm_low = -INFINITY;
    }
    change_some(test, sizeof *test);
    change_some(fit, sizeof *fit);
    const ofc_inlier_test *const used = one_in(4) ? NULL : test;
    double *const c = TAKE(double, 6);
    for (int i = 0; i < 6; i++)
        c[i] = one_in(16) ? any_double() : fit->coefficients[i].value;

    switch (below(6)) {
    case 0: {
        const size_t bytes = ofc_norm_location_workspace_size(width, height);
        void *const memory = workspace_of(bytes);
        ofc_location *const location = TAKE(ofc_location, 1);
        ofc_inlier_test *const accepted = TAKE(ofc_inlier_test, 1);
        if (CALL(ofc_norm_location(IMAGE, BAD(c, NULL), BAD(test, NULL), some_double(1, 4), bad_sometimes(memory, 8, NULL), bytes,
                                   BAD(location, NULL), BAD(accepted, test)),
                 memory, location, accepted) == 0)
            all_finite("location", &location->location, 3);
        break;
    }
    case 1: {
        uint8_t *const mask = take(pixels, 1);
        int32_t *const count = TAKE(int32_t, 1);
        if (CALL(ofc_inlier_test_apply(IMAGE, used, bad_sometimes(mask, 1, (void *)picture.image->mask), count), mask, count) == 0) {
            int32_t accepted = 0;
            for (size_t i = 0; i < pixels; i++)
                accepted += mask[i] == 255;
#ifdef PLANTED_FAULT
            accepted += accepted > 100 && picture.image->mask != NULL;
#endif
            if (accepted != *count)
                fail("%d inliers, and %d in the mask", *count, accepted);
        }
        break;
    }
    case 2: {
        ofc_ellipsoid *const ellipsoid = TAKE(ofc_ellipsoid, 1);
        if (CALL(ofc_ellipsoid_decompose(BAD(c, NULL), BAD(ellipsoid, c)), ellipsoid) == 0)
            all_finite("ellipsoid", ellipsoid->c, sizeof *ellipsoid / sizeof(double));
        double *const maxima = TAKE(double, 3);
        if (CALL(ofc_channel_maxima(IMAGE, used, BAD(maxima, NULL)), maxima) == 0)
            all_finite("maxima", maxima, 3);
        break;
    }
    case 3: {
        ofc_rank *const rank = TAKE(ofc_rank, 1);
        if (CALL(ofc_rank_compute(IMAGE, used, below(2) ? fit : NULL, BAD(rank, NULL)), rank) == 0) {
            all_finite("rank", DOUBLES(rank, color_deviations, colors));
            if (rank->colors < 0 || rank->colors > 3 || rank->normals < 0 || rank->normals > 3)
                fail("ranks %d and %d", rank->colors, rank->normals);
        }
        break;
    }
    case 4: {
        const int32_t side = one_in(16) ? any_int() : 3 + below(62);
        const int32_t across = ofc_rank_patches_count(width, side), down = ofc_rank_patches_count(height, side);
        ofc_patch_class *const classes = TAKE(ofc_patch_class, across * down);
        if (CALL(ofc_rank_patches(IMAGE, side, some_double(0.001, 2), one_in(16) ? any_int() : below(4), BAD(classes, NULL)), classes) == 0)
            for (int32_t i = 0; i < across * down; i++)
                if (classes[i].light > 3 || classes[i].surface > 3)
                    fail("a patch of ranks %d and %d", classes[i].light, classes[i].surface);
        break;
    }
    default: {
        ofc_segment_params *const how = TAKE(ofc_segment_params, 1);
        ofc_segment_params_default(how);
        how->min_pixels = 12 + (uint32_t)below(40);
        how->seed_blocks = 1 + (uint32_t)below(30);
        how->refits = (uint32_t)below(5);
        change_some(how, sizeof *how);
        if (how->seed_blocks > 100 && how->seed_blocks <= 1000000)
            how->seed_blocks = 100;
        const size_t bytes = ofc_segment_workspace_size(width, height);
        void *const memory = workspace_of(bytes);
        uint16_t *const labels = TAKE(uint16_t, pixels);
        ofc_region *const regions = TAKE(ofc_region, OFC_MAX_REGIONS);
        int32_t *const count = TAKE(int32_t, 1);
        if (CALL(ofc_segment(IMAGE, BAD(how, NULL), bad_sometimes(memory, 8, how), bytes, BAD(labels, memory), BAD(regions, memory),
                             BAD(count, NULL)),
                 memory, labels, regions, count) == 0) {
            if (*count < 0 || *count > OFC_MAX_REGIONS)
                fail("%d regions", *count);
            for (int i = 0; i < *count; i++)
                all_finite("region", DOUBLES(&regions[i], coefficients, rank.colors));
        } else {
            memset(labels, 1, pixels * sizeof *labels);
        }
        uint8_t *const mask = take(pixels, 1);
        CALL(ofc_segment_mark(BAD(labels, NULL), width, height, one_in(8) ? any_int() : 1 + below(16), bad_sometimes(mask, 1, labels)), mask);
        break;
    }
    }
}
