/* The forward model. */
#include "contract.h"

enum { PADDED = WIDTH * 3 + 7, SEEN_PADDED = WIDTH + 3 };

static struct {
    uint8_t pixels[HEIGHT * PADDED + 16];
    uint32_t seen[HEIGHT * SEEN_PADDED + 8];
    float normals[PIXELS * 3 + 8];
    ofc_rendering rendering;
    ofc_render_params params;
} out;

static float depth[HEIGHT][WIDTH];
static uint8_t mask[HEIGHT][WIDTH];
static double a[6] = {0.6, 0, 0.8, 0, 0.6, 0.8}, b[6] = {100, 10, 20, 90, 30, 40};
static ofc_depth_map map;
static ofc_lights lights;
static ofc_render_params params;

static int prepare(void **state)
{
    (void)state;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const double u = (x - WIDTH / 2) / 30.0, v = (y - HEIGHT / 2) / 30.0;
            mask[y][x] = u * u + v * v < 0.9;
            depth[y][x] = mask[y][x] ? (float)(30 * sqrt(1 - u * u - v * v)) : NAN;
        }
    map = (ofc_depth_map){.depth = &depth[0][0],
                          .width = WIDTH,
                          .height = HEIGHT,
                          .row_stride_bytes = sizeof depth[0],
                          .pixel_pitch = 1,
                          .mask = &mask[0][0],
                          .mask_stride_bytes = WIDTH};
    lights = (ofc_lights){.directions = a, .colors = b, .count = 2};
    return ofc_render_params_default(&params) == OFC_STATUS_OK ? 0 : -1;
}

#define RENDER(map, lights, params)                                                                                    \
    ofc_render(map, lights, params, out.pixels, OFC_PIXEL_BGR8, PADDED, out.seen, SEEN_PADDED * 4, out.normals,        \
               WIDTH * 12, &out.rendering)

static void bad_surfaces(void **state)
{
    (void)state;
    ofc_depth_map bad = map;
#define BAD(status, field, value)                                                                                      \
    (bad = map, bad.field = (value));                                                                                  \
    REFUSED(status, out, RENDER(&bad, &lights, &params))
    BAD(OFC_STATUS_NULL_POINTER, depth, NULL);
    BAD(OFC_STATUS_MISALIGNED, depth, MISALIGNED(depth));
    BAD(OFC_STATUS_MISALIGNED, row_stride_bytes, sizeof depth[0] + 2);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, row_stride_bytes, sizeof depth[0] - 4);
    BAD(OFC_STATUS_TOO_LARGE, row_stride_bytes, SIZE_MAX - 3);
    BAD(OFC_STATUS_EMPTY, width, 0);
    BAD(OFC_STATUS_EMPTY, height, -1);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, mask_stride_bytes, WIDTH - 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, pixel_pitch, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, pixel_pitch, NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, mask, NULL); /* depths outside the mask are not finite */
    bad = map;
    bad.width = INT32_MAX;
    BAD(OFC_STATUS_TOO_LARGE, height, INT32_MAX);
#undef BAD
    REFUSED(OFC_STATUS_NULL_POINTER, out, RENDER(NULL, &lights, &params));
    REFUSED(OFC_STATUS_MISALIGNED, out, RENDER(MISALIGNED(&map), &lights, &params));
}

static void bad_lights_and_parameters(void **state)
{
    (void)state;
    ofc_lights bad = lights;
    ofc_render_params wrong = params;
    double changed[6];
#define BAD(status, field, value)                                                                                      \
    (bad = lights, bad.field = (value));                                                                               \
    REFUSED(status, out, RENDER(&map, &bad, &params))
    BAD(OFC_STATUS_NULL_POINTER, directions, NULL);
    BAD(OFC_STATUS_NULL_POINTER, colors, NULL);
    BAD(OFC_STATUS_MISALIGNED, directions, MISALIGNED(a));
    BAD(OFC_STATUS_MISALIGNED, colors, MISALIGNED(b));
    BAD(OFC_STATUS_INVALID_PARAMETER, count, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, count, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, count, OFC_MAX_LIGHTS + 1);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved, 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, directions, b); /* not unit vectors */
    memcpy(changed, b, sizeof b);
    changed[5] = NAN;
    BAD(OFC_STATUS_INVALID_PARAMETER, colors, changed);
    changed[5] = -1;
    BAD(OFC_STATUS_INVALID_PARAMETER, colors, changed);
#undef BAD
#define WRONG(status, field, value)                                                                                    \
    (wrong = params, wrong.field = (value));                                                                           \
    REFUSED(status, out, RENDER(&map, &lights, &wrong))
    WRONG(OFC_STATUS_INVALID_PARAMETER, peak, -1);
    WRONG(OFC_STATUS_INVALID_PARAMETER, peak, INFINITY);
    WRONG(OFC_STATUS_INVALID_PARAMETER, noise, -1);
    WRONG(OFC_STATUS_INVALID_PARAMETER, noise, NAN);
    WRONG(OFC_STATUS_INVALID_PARAMETER, cast_shadows, 2);
    WRONG(OFC_STATUS_RESERVED_NOT_ZERO, reserved[4], 1);
#undef WRONG
    REFUSED(OFC_STATUS_NULL_POINTER, out, RENDER(&map, NULL, &params));
    REFUSED(OFC_STATUS_NULL_POINTER, out, RENDER(&map, &lights, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, RENDER(&map, MISALIGNED(&lights), &params));
    REFUSED(OFC_STATUS_MISALIGNED, out, RENDER(&map, &lights, MISALIGNED(&params)));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_render_params_default(NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_render_params_default(MISALIGNED(&out.params)));
}

static void bad_outputs(void **state)
{
    (void)state;
#define INTO(pixels, format, stride, seen, seen_stride, normals, normals_stride, rendering)                            \
    ofc_render(&map, &lights, &params, pixels, format, stride, seen, seen_stride, normals, normals_stride, rendering)
    REFUSED(OFC_STATUS_NULL_POINTER, out, INTO(NULL, OFC_PIXEL_RGB8, PADDED, NULL, 0, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_NULL_POINTER, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, NULL, 0, NULL, 0, NULL));
    REFUSED(OFC_STATUS_UNKNOWN_FORMAT, out, INTO(out.pixels, OFC_PIXEL_PLANES8, PADDED, NULL, 0, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_UNKNOWN_FORMAT, out, INTO(out.pixels, 0, PADDED, NULL, 0, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, INTO(out.pixels, OFC_PIXEL_RGB8, WIDTH * 3 - 1, NULL, 0, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, out.seen, WIDTH * 4 - 4, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, NULL, 0, out.normals, WIDTH * 12 - 4, &out.rendering));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, out.seen, WIDTH * 4 + 1, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, MISALIGNED(out.seen), WIDTH * 4, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, NULL, 0, MISALIGNED(out.normals), WIDTH * 12, &out.rendering));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, NULL, 0, NULL, 0, MISALIGNED(&out.rendering)));
    REFUSED(OFC_STATUS_OVERLAP, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, NULL, 0, (float *)(void *)out.pixels, WIDTH * 12, &out.rendering));
    REFUSED(OFC_STATUS_OVERLAP, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, (uint32_t *)out.normals, WIDTH * 4, out.normals, WIDTH * 12, &out.rendering));
    REFUSED(OFC_STATUS_OVERLAP, out, INTO(depth, OFC_PIXEL_RGB8, WIDTH * 3, NULL, 0, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_OVERLAP, out, INTO(mask, OFC_PIXEL_RGB8, WIDTH * 3, NULL, 0, NULL, 0, &out.rendering));
    REFUSED(OFC_STATUS_OVERLAP, out, INTO(out.pixels, OFC_PIXEL_RGB8, PADDED, NULL, 0, NULL, 0, (ofc_rendering *)(void *)&lights));
}

static void renders(void **state)
{
    (void)state;
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(RENDER(&map, &lights, &params), OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++) {
        if (y + 1 < HEIGHT) {
            assert_true(is_untouched(out.pixels + y * PADDED + WIDTH * 3, PADDED - WIDTH * 3));
            assert_true(is_untouched(out.seen + y * SEEN_PADDED + WIDTH, 3 * 4));
        }
        for (int x = 0; x < WIDTH; x++) {
            const float *n = out.normals + 3 * (y * WIDTH + x);
            const uint8_t *bgr = out.pixels + y * PADDED + 3 * x;
            const uint32_t seen = out.seen[y * SEEN_PADDED + x];
            if (!mask[y][x]) {
                assert_true(n[2] == 0 && bgr[0] == 0 && bgr[1] == 0 && bgr[2] == 0 && seen == 0);
                continue;
            }
            for (int c = 0; c < 3 && seen == 3; c++) {
                const double *f = out.rendering.f + 3 * c;
                assert_true(fabs(f[0] * n[0] + f[1] * n[1] + f[2] * n[2] - bgr[2 - c]) <= 0.51);
            }
        }
    }
    assert_true(is_untouched(out.pixels + HEIGHT * PADDED, 16));
    assert_true(is_untouched(out.seen + HEIGHT * SEEN_PADDED, 32));
    assert_true(is_untouched(out.normals + PIXELS * 3, 32));
    assert_true(is_untouched(&out.params, sizeof out.params));
    /* Without the outputs that may be missing, the same picture. */
    static uint8_t again[HEIGHT * PADDED];
    memset(again, PATTERN, sizeof again);
    assert_int_equal(INTO(again, OFC_PIXEL_BGR8, PADDED, NULL, 0, NULL, 0, &out.rendering), OFC_STATUS_OK);
    assert_memory_equal(again, out.pixels, sizeof again);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_surfaces),
        cmocka_unit_test(bad_lights_and_parameters),
        cmocka_unit_test(bad_outputs),
        cmocka_unit_test(renders),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
