/* Tilts, slants and strengths of lights, and the orthogonal transformation. */
#include "fuzz.h"

static struct picture picture;
static ofc_inlier_test *test;

static ofc_image *image(void)
{
    if (picture.bad)
        must_be_refused();
    return picture.bad ? picture.image : BAD(picture.image, NULL);
}

static double *numbers(size_t count, double low, double high)
{
    double *const all = TAKE(double, count);
    for (size_t i = 0; i < count; i++)
        all[i] = some_double(low, high);
    return all;
}

/* A root of C or an inverse of F that is mostly well conditioned. */
static double *matrix(void)
{
    double *const all = numbers(9, -0.3, 0.3);
    for (int i = 0; i < 9; i += 4)
        all[i] += 1;
    return all;
}

static void check_tilts(ofc_status status, const ofc_tilts *tilts)
{
    if (status == OFC_STATUS_OK)
        all_finite("tilts", tilts->tilt_rad, sizeof *tilts / sizeof(double));
}

static void tilts(void)
{
    ofc_tilts *const found = TAKE(ofc_tilts, 1);
    check_tilts(CALL(ofc_tilt_pentland(image(), test, BAD(found, NULL)), found), found);
    check_tilts(CALL(ofc_tilt_lee_rosenfeld(image(), test, BAD(found, NULL)), found), found);
    check_tilts(CALL(ofc_tilt_zheng_chellappa(image(), test, BAD(found, NULL)), found), found);
}

static void tilts_along(void)
{
    ofc_tilts *const found = TAKE(ofc_tilts, 1);
    const int32_t count = one_in(16) ? any_int() : 2 + below(6), room = count > 0 && count <= 64 ? count : 1;
    int32_t *const steps = TAKE(int32_t, 2 * room);
    for (int32_t i = 0; i < 2 * room; i++)
        steps[i] = one_in(8) ? any_int() : (int8_t)byte() % 4;
    if (count > 64)
        must_be_refused();
    check_tilts(CALL(ofc_tilt_pentland_along(image(), test, BAD(steps, NULL), count, BAD(found, steps)), found), found);
}

static void tilts_in_disc(void)
{
    ofc_tilts *const found = TAKE(ofc_tilts, 1);
    const size_t bytes = ofc_largest_disc_workspace_size(picture.width, picture.height);
    void *const workspace = workspace_of(bytes);
    ofc_disc *const disc = TAKE(ofc_disc, 1);
    if (CALL(ofc_largest_disc(image(), test, bad_sometimes(workspace, 8, NULL), bytes, BAD(disc, workspace)), workspace, disc) != 0)
        *disc = (ofc_disc){.x = below(30), .y = below(30), .radius_squared = byte()};
    else if (disc->x < 0 || disc->x >= picture.width || disc->y < 0 || disc->y >= picture.height)
        fail("a disc at %d, %d", disc->x, disc->y);
    change_some(disc, sizeof *disc);
    check_tilts(CALL(ofc_tilt_chojnacki(image(), test, BAD(disc, NULL), BAD(found, disc)), found), found);
}

static void check_slants(ofc_status status, const ofc_slant_estimate *slants)
{
    for (int i = 0; status == OFC_STATUS_OK && i < 3; i++)
        if (!isfinite(slants[i].slant_rad) || !(slants[i].statistic >= 0))
            fail("a slant of %g from %g", slants[i].slant_rad, slants[i].statistic);
}

static void slants(void)
{
    ofc_slant_estimate *const found = TAKE(ofc_slant_estimate, 3);
    double *const strengths = TAKE(double, 3), *const norms = TAKE(double, 3);
    check_slants(CALL(ofc_slant_pentland(image(), test, BAD(found, NULL)), found), found);
    check_slants(CALL(ofc_slant_zheng_chellappa(image(), BAD(found, NULL)), found), found);
    const ofc_status status = CALL(ofc_slant_lee_rosenfeld(image(), test, BAD(found, NULL), below(2) ? NULL : strengths), found, strengths);
    check_slants(status, found);
    if (CALL(ofc_channel_maxima(image(), test, BAD(norms, NULL)), norms) == 0)
        all_finite("maxima", norms, 3);
}

static void check_transformation(const ofc_orthogonal *found)
{
    all_finite("chosen", found->chosen.rows, sizeof found->chosen / sizeof(double));
    all_finite("twin", found->twin.rows, sizeof found->twin / sizeof(double));
    all_finite("margin", &found->margin, 1);
    all_finite("integral", &found->integral.mean, 1);
    all_finite("unpolished", &found->unpolished.mean, 1);
}

static void closed_form(void)
{
    double *const root = matrix(), *const given = numbers(3, -3.2, 3.2);
    ofc_orthogonal *const found = TAKE(ofc_orthogonal, 1);
    if (CALL(ofc_orthogonal_closed_form(image(), test, BAD(root, NULL), below(2) ? given : NULL, (uint32_t)below(30), BAD(found, root)),
             found) == 0)
        check_transformation(found);
}

static void annealing(void)
{
    double *const root = matrix(), *const given = numbers(3, -3.2, 3.2);
    ofc_annealing_params *const params = TAKE(ofc_annealing_params, 1);
    ofc_annealing_params_default(params);
    params->proposals = 40;
    params->polish_evaluations = 5;
    params->sample_cells = 1 + byte();
    change_some(params, sizeof *params);
    if (params->proposals > 200 && params->proposals <= 10000000)
        params->proposals = 200;
    if (params->polish_evaluations > 40 && params->polish_evaluations <= 10000000)
        params->polish_evaluations = 40;
    if (params->chains > 1000)
        return;
    const size_t bytes = ofc_orthogonal_annealing_workspace_size(picture.width, picture.height, params);
    void *const workspace = workspace_of(bytes);
    ofc_orthogonal *const found = TAKE(ofc_orthogonal, 1);
    if (CALL(ofc_orthogonal_annealing(image(), test, BAD(root, NULL), below(2) ? given : NULL, BAD(params, NULL),
                                      bad_sometimes(workspace, 8, root), bytes, BAD(found, workspace)),
             workspace, found) == 0)
        check_transformation(found);
}

static void integrable_slants(void)
{
    double *const norms = numbers(3, 0.1, 200), *const tilt = numbers(3, -3.2, 3.2), *const cosines = numbers(3, -0.9, 0.9);
    const uint32_t sample = one_in(16) ? word32() : 1 + byte();
    const size_t bytes = ofc_constrained_slants_integrable_workspace_size(picture.width, picture.height, sample);
    void *const workspace = workspace_of(bytes);
    ofc_slants *const found = TAKE(ofc_slants, 1);
    if (CALL(ofc_constrained_slants_integrable(image(), test, BAD(norms, NULL), BAD(tilt, NULL), BAD(cosines, NULL), some_double(0, 0.1),
                                               sample, bad_sometimes(workspace, 8, tilt), bytes, BAD(found, norms)),
             workspace, found) == 0)
        all_finite("slants", found->slant_rad, 5);
}

static void normals(void)
{
    double *const inverse = matrix();
    ofc_integrability *const integral = TAKE(ofc_integrability, 1);
    if (CALL(ofc_integrability_integral(image(), test, BAD(inverse, NULL), BAD(integral, inverse)), integral) == 0)
        all_finite("integral", &integral->mean, 1);
    const size_t row = (size_t)picture.width * 3 * sizeof(float), stride = stride_of(row, sizeof(float));
    float *const out = take_rows(row, stride, picture.height, sizeof(float));
    const ofc_normalization normalization = one_in(16) ? any_int() : below(2);
    if (CALL(ofc_normals_from_matrix(image(), test, BAD(inverse, NULL), normalization, BAD(out, NULL), stride), out) == 0) {
#ifdef PLANTED_FAULT
        if (normalization == OFC_NORMALIZATION_NONE && stride > row && out[0] > 100 && picture.height > 1)
            out[row / sizeof(float)] = 1;
        call_end("planted", 0, (void *const[]){out, NULL});
#endif
        if (normalization == OFC_NORMALIZATION_UNIT)
            unit_normals("normals", out, stride, picture.width, picture.height);
        for (int32_t y = 0; y < picture.height; y++)
            floats_finite("normals", (const float *)((const char *)out + (size_t)y * stride), row / sizeof(float));
    }
}

void target(void)
{
    static void (*const calls[])(void) = {tilts, tilts_along, tilts_in_disc, slants, closed_form, annealing, integrable_slants, normals};
    picture = picture_of(28, 28);
    test = any_inlier_test();
    calls[below(sizeof calls / sizeof *calls)]();
}
