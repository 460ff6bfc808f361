/* The whole surface of a picture that was solved, and of solutions of any bits. */
#include "fuzz.h"

static int32_t width, height;

/* Rows of an output, of so many bytes a pixel. */
static void *rows(size_t pixel, size_t unit, size_t *stride)
{
    const size_t row = (size_t)width * pixel;
    *stride = stride_of(row, unit);
    return take_rows(row, *stride, height, unit);
}

void target(void)
{
    const struct picture picture = picture_of(40, 40);
    width = picture.width;
    height = picture.height;
    ofc_solve_params *const how = TAKE(ofc_solve_params, 1);
    ofc_solve_params_default(how);
    how->lmeds.subsets = 8 + (uint32_t)below(24);
    how->shadow_rejection = below(3);
    const size_t need = ofc_solve_workspace_size(width, height, how);
    void *const memory = workspace_of(need);
    ofc_solution *const solution = TAKE(ofc_solution, 1);
    memset(solution, 0, sizeof *solution);
    if (picture.bad)
        must_be_refused();
    if (CALL(ofc_solve(picture.image, how, memory, need, NULL, solution), memory, solution) == OFC_STATUS_OK)
        change_some(solution, sizeof *solution);
    else
        change(solution, sizeof *solution, below(8));

    ofc_surface_params *const params = TAKE(ofc_surface_params, 1);
    ofc_surface_params_default(params);
    params->channels_are_lights = below(2);
    change_some(params, sizeof *params);
    size_t bytes = ofc_surface_workspace_size(width, height), triple, single, floats, singles;
    if (one_in(64)) {
        bytes--;
        must_be_refused();
    }
    void *const workspace = workspace_of(bytes);
    float *const normals = rows(3 * sizeof(float), sizeof(float), &triple);
    float *const angle = rows(sizeof(float), sizeof(float), &single), *const depth = rows(sizeof(float), sizeof(float), &floats);
    uint8_t *const classes = rows(1, 1, &singles);
    ofc_surface_result *const result = TAKE(ofc_surface_result, 1);
    if (picture.bad)
        must_be_refused();
    const ofc_status status =
        CALL(ofc_surface_complete(picture.bad ? picture.image : BAD(picture.image, NULL), BAD(solution, NULL), BAD(params, NULL),
                                  bad_sometimes(workspace, 8, params), bytes, BAD(normals, workspace), triple, BAD(angle, normals), single,
                                  BAD(depth, angle), floats, bad_sometimes(classes, 1, normals), singles, BAD(result, params)),
             workspace, normals, angle, depth, classes, result);
    if (status < 0)
        return;
    unit_normals("the whole surface", normals, triple, width, height);
    int64_t counted = 0;
    for (int32_t y = 0; y < height; y++) {
        floats_finite_or_nan("depth", (const float *)((const char *)depth + (size_t)y * floats), (size_t)width);
        for (int32_t x = 0; x < width; x++) {
            const float one = ((const float *)((const char *)angle + (size_t)y * single))[x];
            if (!(one >= 0 && one <= 3.1415928f))
                fail("an uncertainty of %g", (double)one);
        }
    }
    for (int i = 0; i < 8; i++)
        counted += result->class_counts[i];
#ifdef PLANTED_FAULT
    counted += result->class_counts[OFC_SURFACE_INTERPOLATED] > 9;
#endif
    if (counted != (int64_t)width * height)
        fail("classes of %lld pixels", (long long)counted);
    all_finite("gap", &result->border_gap_rad, 1);
    for (int i = 0; i < 3; i++)
        all_finite("light", result->lights[i].direction, 6);
}
