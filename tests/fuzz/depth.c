/* Depth from normals or slopes, normals from depth, and pictures from depth. */
#include "fuzz.h"

static int32_t width, height;

/* A map of floats: a smooth surface's numbers with a few of any value, or all of any. */
static float *map_of(int channels, double amplitude, size_t *stride)
{
    const size_t row = (size_t)width * (size_t)channels * sizeof(float);
    *stride = stride_of(row, sizeof(float));
    float *const map = take_rows(row, *stride, height, sizeof(float));
    const int kind = below(4);
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width * channels; x++) {
            const double place = (double)(x / channels) / width - 0.5, up = 0.5 - (double)y / height;
            double value = channels == 3 && x % 3 == 2 ? 1 : amplitude * (x % 3 == 1 ? up : place + 0.2 * up * place);
            value += kind == 1 ? 0.1 * (random_unit() - 0.5) : kind == 2 ? amplitude * (random_unit() - 0.5) : 0;
            ((float *)((char *)map + (size_t)y * *stride))[x] = kind == 3 && bytes_left() > 40 ? any_float() : (float)value;
        }
    for (int i = one_in(2) ? 1 + below(6) : 0; i > 0; i--) {
        const size_t column = word32() % (uint32_t)(width * channels);
        ((float *)((char *)map + word32() % (uint32_t)height * *stride))[column] = any_float();
    }
    return map;
}

static const uint8_t *any_mask(size_t *stride)
{
    *stride = stride_of((size_t)width, 1);
    uint8_t *const mask = take_rows((size_t)width, *stride, height, 1);
    const int kind = below(4);
    const double ratio = byte() / 255.0;
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            const int values[] = {random_unit() < ratio, x % 5 != 4, (x - width / 2) * (x - width / 2) + (y - height / 2) * (y - height / 2) < width * height / 5,
                                  (x + y) % 2};
            mask[(size_t)y * *stride + (size_t)x] = values[kind] ? 255 : 0;
        }
    return mask;
}

static void check_depth(const float *depth, size_t stride, const ofc_depth_result *result)
{
    int32_t known = 0;
    for (int32_t y = 0; y < height; y++) {
        const float *const row = (const float *)((const char *)depth + (size_t)y * stride);
        floats_finite_or_nan("depth", row, (size_t)width);
        for (int32_t x = 0; x < width; x++)
            known += !isnan(row[x]);
    }
    all_finite("residual", &result->residual, 1);
    if (known != result->pixel_count || result->regions < 0 || result->excluded_count < 0)
        fail("%d pixels of depth, %d known, %d regions", result->pixel_count, known, result->regions);
}

static void integrate(void)
{
    ofc_depth_input *const input = TAKE(ofc_depth_input, 1);
    memset(input, 0, sizeof *input);
    input->width = width;
    input->height = height;
    if (below(2)) {
        input->normals = map_of(3, 1.5, &input->normals_stride_bytes);
    } else {
        input->p = map_of(1, 1.5, &input->p_stride_bytes);
        input->q = map_of(1, 1.5, &input->q_stride_bytes);
    }
    if (one_in(3))
        input->mask = any_mask(&input->mask_stride_bytes);
    if (one_in(4))
        input->weights = map_of(1, 2, &input->weights_stride_bytes);
    if (one_in(4))
        input->prior = map_of(1, 3, &input->prior_stride_bytes);
    if (one_in(32)) {
        must_be_refused();
        switch (below(4)) {
        case 0: input->width = 0; break;
        case 1: input->height = INT32_MIN; break;
        case 2: input->normals = NULL, input->p = NULL; break;
        default: input->width = input->height = 46341; break;
        }
    }
    ofc_depth_params *const params = TAKE(ofc_depth_params, 1);
    ofc_depth_params_default(params);
    params->method = below(3);
    params->max_cycles = 40;
    if (input->prior != NULL && one_in(2))
        params->prior_weight = ldexp(1, -below(256) * 4);
    change_some(params, sizeof *params);
    if (params->max_cycles > 40)
        params->max_cycles = 40;
    size_t need = ofc_depth_workspace_size(width, height);
    if (one_in(64)) {
        need--;
        must_be_refused();
    }
    void *const workspace = workspace_of(need);
    const size_t row = (size_t)width * sizeof(float), stride = stride_of(row, sizeof(float));
    float *const depth = take_rows(row, stride, height, sizeof(float));
    ofc_depth_result *const result = TAKE(ofc_depth_result, 1);
    const ofc_status status = CALL(ofc_depth_integrate(BAD(input, NULL), BAD(params, NULL), bad_sometimes(workspace, 8, params), need,
                                                       BAD(depth, workspace), stride, BAD(result, input)),
                                   workspace, depth, result);
    if (status >= 0)
        check_depth(depth, stride, result);
    if (status >= 0 && one_in(4)) {
        float *const again = take_rows(row, stride, height, sizeof(float));
        make_dirty(workspace);
        CALL(ofc_depth_integrate(input, params, workspace, need, again, stride, result), workspace, again, result);
#ifdef PLANTED_FAULT
        if (params->method == OFC_DEPTH_COUPLED && result->excluded_count > 0)
            again[0] += 1;
#endif
        for (int32_t y = 0; y < height; y++)
            if (memcmp((char *)depth + (size_t)y * stride, (char *)again + (size_t)y * stride, row) != 0)
                fail("another depth of the same input");
    }
}

static ofc_depth_map *any_map(void)
{
    ofc_depth_map *const map = TAKE(ofc_depth_map, 1);
    memset(map, 0, sizeof *map);
    map->width = width;
    map->height = height;
    map->depth = map_of(1, below(2) ? 6 : 1, &map->row_stride_bytes);
    map->pixel_pitch = some_double(0.1, 2);
    if (one_in(3))
        map->mask = any_mask(&map->mask_stride_bytes);
    if (one_in(32)) {
        must_be_refused();
        switch (below(4)) {
        case 0: map->width = 0; break;
        case 1: map->depth = NULL; break;
        case 2: map->width = map->height = INT32_MAX; break;
        default: map->row_stride_bytes = SIZE_MAX & ~(size_t)3, map->height += map->height == 1; break;
        }
    }
    return map;
}

static void normals(void)
{
    const size_t row = (size_t)width * 3 * sizeof(float), stride = stride_of(row, sizeof(float));
    float *const out = take_rows(row, stride, height, sizeof(float));
    ofc_depth_map *const map = any_map();
    if (CALL(ofc_depth_normals(BAD(map, NULL), BAD(out, map), stride), out) == 0)
        unit_normals("normals of a depth", out, stride, width, height);
}

static void render(void)
{
    static const ofc_pixel_format formats[] = {1, 2, 3, 4, 11, 12, 13, 14, 21, 22, 23, 24};
    static const double good[9] = {0.6, 0, 0.8, 0, 0.6, 0.8, -0.6, 0, 0.8};
    const int32_t count = 1 + below(5);
    double *const directions = TAKE(double, 3 * count), *const colors = TAKE(double, 3 * count);
    for (int32_t i = 0; i < 3 * count; i++) {
        directions[i] = good[i % 9];
        colors[i] = some_double(0, 1);
    }
    if (one_in(3))
        directions[below(3 * count)] = any_double();
    ofc_lights *const lights = TAKE(ofc_lights, 1);
    *lights = (ofc_lights){.directions = directions, .colors = colors, .count = count};
    if (one_in(32)) {
        must_be_refused();
        lights->count = 33 + below(200);
    }
    ofc_render_params *const params = TAKE(ofc_render_params, 1);
    ofc_render_params_default(params);
    params->noise = one_in(3) ? some_double(0, 10) : 0;
    params->cast_shadows = below(2);
    change_some(params, sizeof *params);
    const ofc_pixel_format format = one_in(32) ? any_int() : formats[below(12)];
    const int known = format > 0 && format < 25 && format % 10 >= 1 && format % 10 <= 4;
    if (!known)
        must_be_refused();
    const size_t row = pixel_bytes(known ? format : OFC_PIXEL_RGB8) * (size_t)width, stride = stride_of(row, 1);
    uint8_t *const pixels = take_rows(row, stride, height, 1);
    uint32_t *const visible = below(2) ? NULL : TAKE(uint32_t, width * height);
    float *const out = below(2) ? NULL : TAKE(float, 3 * width * height);
    ofc_rendering *const rendering = TAKE(ofc_rendering, 1);
    const ofc_depth_map *const map = any_map();
    const ofc_status status =
        CALL(ofc_render(BAD(map, NULL), BAD(lights, NULL), BAD(params, NULL), bad_sometimes(pixels, 1, (void *)map->depth), format, stride, visible,
                        (size_t)width * sizeof *visible, out, (size_t)width * 3 * sizeof *out, BAD(rendering, lights)),
             pixels, rendering, visible == NULL ? (void *)out : (void *)visible, out);
    if (status != OFC_STATUS_OK)
        return;
    all_finite("rendering", &rendering->largest_modulus, sizeof *rendering / sizeof(double));
    if (out != NULL)
        unit_normals("normals of a rendering", out, (size_t)width * 3 * sizeof *out, width, height);
    for (int32_t y = 0; format > 20 && y < height; y++)
        for (size_t at = 0; at < row; at += sizeof(float)) {
            float sample;
            memcpy(&sample, pixels + (size_t)y * stride + at, sizeof sample);
            if (at / sizeof(float) % (format % 10 > 2 ? 4 : 5) != 3)
                floats_finite("a rendered sample", &sample, 1);
        }
}

void target(void)
{
    static void (*const calls[])(void) = {integrate, integrate, normals, render};
    width = 1 + (byte() + 16) % 24;
    height = 1 + (byte() + 12) % 24;
    random_begin(word32());
    calls[below(sizeof calls / sizeof *calls)]();
}
