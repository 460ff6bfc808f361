/* Flat fields, paint, and reliefs on a plane. */
#include "fuzz.h"

static struct picture picture;
static int32_t width, height;

static ofc_image *image(void)
{
    if (picture.bad)
        must_be_refused();
    return picture.bad ? picture.image : BAD(picture.image, NULL);
}

static float *floats(int channels, size_t *stride)
{
    const size_t row = (size_t)width * (size_t)channels * sizeof(float);
    *stride = stride_of(row, sizeof(float));
    return take_rows(row, *stride, height, sizeof(float));
}

static void check_rows(const char *what, const float *map, int channels, size_t stride)
{
    for (int32_t y = 0; y < height; y++)
        floats_finite_or_nan(what, (const float *)((const char *)map + (size_t)y * stride), (size_t)(width * channels));
}

/* A picture of the same size; rarely of another, which must be refused. */
static struct picture background(void)
{
    if (!one_in(32))
        return picture_sized(width, height);
    must_be_refused();
    return picture_sized(width + 1, height);
}

static void flat_field(void)
{
    size_t stride;
    float *const out = floats(3, &stride);
    ofc_flat_field_result *const result = TAKE(ofc_flat_field_result, 1);
    const struct picture plane = background();
    if (plane.bad)
        must_be_refused();
    if (CALL(ofc_flat_field(image(), below(2) || plane.bad ? plane.image : BAD(plane.image, NULL), BAD(out, NULL), stride, BAD(result, out)), out,
             result) == 0) {
        check_rows("flat field", out, 3, stride);
        all_finite("mean", result->mean, 3);
    }
}

static void paint(void)
{
    ofc_paint_params *const params = TAKE(ofc_paint_params, 1);
    ofc_paint_params_default(params);
    change_some(params, sizeof *params);
    ofc_paint *const found = TAKE(ofc_paint, 1);
    memset(found, 0, sizeof *found);
    const size_t bytes = ofc_paint_workspace_size();
    void *const workspace = workspace_of(bytes);
    if (!one_in(4)) {
        const ofc_status status = CALL(
            ofc_paint_estimate(image(), BAD(params, NULL), bad_sometimes(workspace, 8, params), bytes, BAD(found, params)), workspace, found);
        if (status >= 0) {
            all_finite("paint", found->coefficients, 6);
            const double numbers[] = {found->margin, found->direction_noise, found->ratio, found->hue_excess, found->gradient[0], found->gradient[1]};
            finite_or_nan("paint", numbers, sizeof numbers / sizeof *numbers);
            if (found->disagreement != INFINITY)
                finite_or_nan("disagreement", &found->disagreement, 1);
            finite_or_nan("variogram", found->variogram, OFC_PAINT_DISTANCES);
        }
    }
    double *const c = TAKE(double, 6);
    for (int i = 0; i < 6; i++)
        c[i] = one_in(8) ? any_double() : found->coefficients[0] > 0 ? found->coefficients[i] : i < 3 ? 1 : 0.1;
    const size_t need = ofc_paint_albedo_workspace_size(width, height);
    void *const memory = workspace_of(need);
    size_t stride, triple;
    float *const albedo = floats(1, &stride);
    if (CALL(ofc_paint_albedo(image(), BAD(params, NULL), BAD(c, NULL), bad_sometimes(memory, 8, c), need, BAD(albedo, memory), stride), memory,
             albedo) == 0) {
#ifdef PLANTED_FAULT
        if (c[3] > c[0])
            albedo[0] = INFINITY;
#endif
        check_rows("albedo", albedo, 1, stride);
    } else {
        for (int32_t i = 0; i < width; i++)
            albedo[i] = any_float();
    }
    float *const even = floats(3, &triple);
    if (CALL(ofc_paint_divide(image(), BAD(params, NULL), BAD(albedo, NULL), stride, BAD(even, albedo), triple), even) == 0)
        check_rows("even", even, 3, triple);
}

static void check_relief(const ofc_relief *relief)
{
    const double numbers[] = {relief->circulation, relief->circulation_ratio, relief->anisotropy,   relief->signal_to_noise,
                              relief->border,      relief->outward,           relief->scale_deviation, relief->disagreement,
                              relief->tilt,        relief->expected_error};
    all_finite("slopes", relief->slopes, 6);
    all_finite("plane", relief->plane, 45);
    finite_or_nan("noise", relief->noise, 3);
    finite_or_nan("relief", numbers, sizeof numbers / sizeof *numbers);
}

static void relief(void)
{
    const struct picture plane = one_in(3) ? background() : (struct picture){0};
    const ofc_image *const behind = plane.image;
    ofc_relief_params *const params = TAKE(ofc_relief_params, 1);
    ofc_relief_params_default(params);
    params->ball_radius = one_in(4) ? some_double(1, 60) : 0;
    params->convexity = one_in(4) ? below(3) : 0;
    change_some(params, sizeof *params);
    const size_t bytes = ofc_relief_workspace_size(width, height);
    void *const workspace = workspace_of(bytes);
    if (bytes == 0)
        must_be_refused();
    uint8_t *const classes = take((size_t)width * (size_t)height, 1);
    ofc_relief *const found = TAKE(ofc_relief, 1);
    memset(found, 0, sizeof *found);
    if (plane.bad)
        must_be_refused();
    const ofc_status status = CALL(ofc_relief_solve(image(), behind, BAD(params, NULL), bad_sometimes(workspace, 8, params), bytes,
                                                    bad_sometimes(classes, 1, params), BAD(found, params)),
                                   workspace, classes, found);
    if (status >= 0)
        check_relief(found);
    if (status != OFC_STATUS_OK) {
        memset(classes, OFC_RELIEF_CONTACT, (size_t)width * (size_t)height);
        found->width = width, found->height = height;
        change(found, sizeof *found, below(12));
    } else {
        change_some(found, sizeof *found);
    }
    size_t stride, single;
    float *const normals = floats(3, &stride), *const uncertainty = floats(1, &single);
    if (plane.bad)
        must_be_refused();
    if (CALL(ofc_relief_normals(image(), behind, BAD(found, NULL), classes, BAD(normals, found), stride, below(2) ? NULL : uncertainty, single),
             normals, uncertainty) == 0) {
        check_rows("relief normals", normals, 3, stride);
        check_rows("uncertainty", uncertainty, 1, single);
    }
}

void target(void)
{
    static void (*const calls[])(void) = {flat_field, paint, relief};
    const int which = below(3);
    picture = which == 0 ? picture_of(28, 28) : picture_sized(which == 1 ? 4 + below(60) : 30 + below(60), which == 1 ? 4 + below(60) : 30 + below(60));
    width = picture.width;
    height = picture.height;
    calls[which]();
}
