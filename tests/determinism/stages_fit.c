/* The regression in color space, and the lights as the estimators see them. */
#include "digest.h"
#include "stages.h"

static void fit(const ofc_image *image, ofc_fit_method method, uint64_t seed, struct fitted *fitted)
{
    ofc_lmeds_params params;
    mix_status(ofc_lmeds_params_default(&params));
    params.subsets = 20;
    params.sample_size = 400;
    params.method = method;
    params.seed = seed;
    mix_status(ofc_lmeds_fit(image, &params, workspace, workspace_bytes, &fitted->fit, &fitted->inliers));
    mix_color_fit(&fitted->fit);
    mix_inliers(&fitted->inliers);
}

void mix_fit(const ofc_image *image, struct fitted *fitted)
{
    fit(image, OFC_FIT_LEAST_SQUARES, 0, fitted);
    fit(image, OFC_FIT_LEAST_MEDIAN, UINT64_MAX, fitted);
    double form[6];
    for (int i = 0; i < 6; i++)
        form[i] = fitted->fit.coefficients[i].value;
    ofc_location location = {0};
    ofc_inlier_test accepted = {0};
    int32_t count = 0;
    mix_status(ofc_norm_location(image, form, &fitted->inliers, 2.5, workspace, workspace_bytes, &location,
                                 &accepted));
    mix_location(&location);
    mix_inliers(&accepted);
    mix_status(ofc_inlier_test_apply(image, &accepted, marks, &count));
    mix_status(count);
    mix_bytes(marks, count > 0 ? image->width * image->height : 0);
    mix_status(ofc_inlier_test_apply(image, NULL, marks, &count));
    mix_status(count);
    mix_status(ofc_ellipsoid_decompose(form, &fitted->ellipsoid));
    mix_ellipsoid(&fitted->ellipsoid);
}

static void mix_tilt_estimates(const ofc_image *image, const ofc_inlier_test *inliers)
{
    static const int32_t steps[] = {1, 0, 0, 1, 2, 1, -1, 3};
    ofc_tilts tilts = {0};
    ofc_disc disc = {0};
    mix_status(ofc_tilt_pentland(image, inliers, &tilts));
    mix_tilts(&tilts);
    mix_status(ofc_tilt_pentland_along(image, inliers, steps, 4, &tilts));
    mix_tilts(&tilts);
    mix_status(ofc_tilt_lee_rosenfeld(image, inliers, &tilts));
    mix_tilts(&tilts);
    mix_status(ofc_tilt_zheng_chellappa(image, inliers, &tilts));
    mix_tilts(&tilts);
    mix_status(ofc_largest_disc(image, inliers, workspace, workspace_bytes, &disc));
    mix_disc(&disc);
    mix_status(ofc_tilt_chojnacki(image, inliers, &disc, &tilts));
    mix_tilts(&tilts);
}

static void mix_slants_alone(const ofc_image *image, const ofc_inlier_test *inliers)
{
    static const ofc_slant_estimate nothing[3];
    ofc_slant_estimate slants[3] = {nothing[0], nothing[1], nothing[2]};
    double norms[3] = {0};
    mix_status(ofc_slant_pentland(image, inliers, slants));
    mix_slant_estimates(slants);
    mix_status(ofc_slant_lee_rosenfeld(image, inliers, slants, norms));
    mix_slant_estimates(slants);
    mix_doubles(norms, 3);
    mix_status(ofc_slant_zheng_chellappa(image, slants));
    mix_slant_estimates(slants);
    mix_status(ofc_channel_maxima(image, inliers, norms));
    mix_doubles(norms, 3);
}

void mix_lights(const ofc_image *image, struct fitted *fitted)
{
    const ofc_inlier_test *inliers[2] = {&fitted->inliers, NULL};
    for (int i = 0; i < 2; i++) {
        mix_tilt_estimates(image, inliers[i]);
        mix_slants_alone(image, inliers[i]);
    }
    mix_status(ofc_tilt_pentland(image, &fitted->inliers, &fitted->tilts));
}
