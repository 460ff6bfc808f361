/* Depth from normals or gradients. */
#include "contract.h"

enum { PADDED = WIDTH + 3 };

static struct {
    float depth[HEIGHT * PADDED + 8];
    ofc_depth_result result;
    ofc_depth_params params;
    float normals[HEIGHT * (WIDTH * 3 + 2) + 8];
} out;

static float normals[HEIGHT][WIDTH][3], p[HEIGHT][WIDTH], q[HEIGHT][WIDTH], ones[HEIGHT][WIDTH], prior[HEIGHT][WIDTH];
static uint8_t mask[HEIGHT][WIDTH];
static uint64_t space[OFC_DEPTH_WORKSPACE_SIZE(WIDTH, HEIGHT) / 8 + 1];
static ofc_depth_input input;
static ofc_depth_params params;

/* z = x^2 / 200 + y / 2, y up, at the middle of each pixel. */
static double truth(int x, int y)
{
    return x * x / 200.0 - y / 2.0;
}

static int prepare(void **state)
{
    (void)state;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            p[y][x] = (float)(x / 100.0);
            q[y][x] = 0.5F;
            normals[y][x][0] = -p[y][x];
            normals[y][x][1] = -q[y][x];
            normals[y][x][2] = 1;
            ones[y][x] = 1;
            mask[y][x] = 1;
            prior[y][x] = NAN;
        }
    input = (ofc_depth_input){
        .normals = &normals[0][0][0], .normals_stride_bytes = sizeof normals[0], .width = WIDTH, .height = HEIGHT};
    return ofc_depth_params_default(&params) == OFC_STATUS_OK ? 0 : -1;
}

#define INTEGRATE(input, params)                                                                                       \
    ofc_depth_integrate(input, params, space, sizeof space, out.depth, PADDED * 4, &out.result)

static void sizes(void **state)
{
    (void)state;
    static const int32_t shapes[][2] = {{1, 1}, {1, 7}, {9, 1}, {WIDTH, HEIGHT}, {640, 480}, {4096, 4096}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        const int32_t width = shapes[i][0], height = shapes[i][1];
        assert_int_equal(ofc_depth_workspace_size(width, height), OFC_DEPTH_WORKSPACE_SIZE(width, height));
    }
    assert_true(ofc_depth_workspace_size(320, 240) <= (size_t)24 * 320 * 240);
    assert_true(ofc_depth_workspace_size(1920, 1080) <= (size_t)24 * 1920 * 1080);
    assert_int_equal(ofc_depth_workspace_size(0, 1), 0);
    assert_int_equal(ofc_depth_workspace_size(1, -1), 0);
    assert_int_equal(ofc_depth_workspace_size(INT32_MAX, INT32_MAX), 0);
    assert_int_equal(ofc_depth_workspace_size(1 << 15, 1 << 14), 0);
}

static void pointers(void **state)
{
    (void)state;
    const size_t need = ofc_depth_workspace_size(WIDTH, HEIGHT);
#define DEPTH(space, bytes, depth, result) ofc_depth_integrate(&input, &params, space, bytes, depth, PADDED * 4, result)
    REFUSED(OFC_STATUS_NULL_POINTER, out, INTEGRATE(NULL, &params));
    REFUSED(OFC_STATUS_NULL_POINTER, out, INTEGRATE(&input, NULL));
    REFUSED(OFC_STATUS_NULL_POINTER, out, DEPTH(NULL, need, out.depth, &out.result));
    REFUSED(OFC_STATUS_NULL_POINTER, out, DEPTH(space, need, NULL, &out.result));
    REFUSED(OFC_STATUS_NULL_POINTER, out, DEPTH(space, need, out.depth, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTEGRATE(MISALIGNED(&input), &params));
    REFUSED(OFC_STATUS_MISALIGNED, out, INTEGRATE(&input, MISALIGNED(&params)));
    REFUSED(OFC_STATUS_MISALIGNED, out, DEPTH(MISALIGNED(space), need, out.depth, &out.result));
    REFUSED(OFC_STATUS_MISALIGNED, out, DEPTH(space, need, MISALIGNED(out.depth), &out.result));
    REFUSED(OFC_STATUS_MISALIGNED, out, DEPTH(space, need, out.depth, MISALIGNED(&out.result)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, DEPTH(space, need - 1, out.depth, &out.result));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, DEPTH(space, 0, out.depth, &out.result));
    REFUSED(OFC_STATUS_OVERLAP, out, DEPTH(space, need, (float *)space, &out.result));
    REFUSED(OFC_STATUS_OVERLAP, out, DEPTH(space, need, &normals[0][0][0], &out.result));
    REFUSED(OFC_STATUS_OVERLAP, out, DEPTH(space, need, out.depth, (ofc_depth_result *)(void *)out.depth));
    REFUSED(OFC_STATUS_OVERLAP, out, DEPTH(space, need, out.depth, (ofc_depth_result *)(void *)&input));
#define STRIDE(stride) ofc_depth_integrate(&input, &params, space, need, out.depth, stride, &out.result)
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, STRIDE(WIDTH * 4 - 4));
    REFUSED(OFC_STATUS_MISALIGNED, out, STRIDE(WIDTH * 4 + 2));
    REFUSED(OFC_STATUS_TOO_LARGE, out, STRIDE(SIZE_MAX - 3));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_depth_params_default(NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_depth_params_default(MISALIGNED(&out.params)));
}

static void inputs(void **state)
{
    (void)state;
    ofc_depth_input bad;
#define BAD(status, field, value)                                                                                      \
    (bad = input, bad.field = (value));                                                                                \
    REFUSED(status, out, INTEGRATE(&bad, &params))
    BAD(OFC_STATUS_EMPTY, width, 0);
    BAD(OFC_STATUS_EMPTY, height, -3);
    BAD(OFC_STATUS_TOO_LARGE, width, INT32_MAX);
    BAD(OFC_STATUS_NULL_POINTER, normals, NULL);
    BAD(OFC_STATUS_MISALIGNED, normals, MISALIGNED(normals));
    BAD(OFC_STATUS_MISALIGNED, normals_stride_bytes, sizeof normals[0] + 1);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, normals_stride_bytes, sizeof normals[0] - 4);
    BAD(OFC_STATUS_TOO_LARGE, normals_stride_bytes, SIZE_MAX - 3);
    BAD(OFC_STATUS_INVALID_PARAMETER, p, &p[0][0]);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, mask, &mask[0][0]);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, weights, &ones[0][0]);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, prior, &prior[0][0]);
    bad = input;
    bad.prior_stride_bytes = sizeof prior[0];
    bad.prior = MISALIGNED(prior);
    REFUSED(OFC_STATUS_MISALIGNED, out, INTEGRATE(&bad, &params));
    bad = input;
    bad.normals = NULL;
    bad.q = &q[0][0];
    bad.q_stride_bytes = sizeof q[0];
    REFUSED(OFC_STATUS_NULL_POINTER, out, INTEGRATE(&bad, &params));
    /* More than 2^29 - 1 pixels: refused by their number, with rows that are all the same. */
    bad = input;
    bad.height = INT32_MAX;
    REFUSED(OFC_STATUS_TOO_LARGE, out, INTEGRATE(&bad, &params));
    /* Nothing to integrate. */
    static uint8_t nothing[HEIGHT][WIDTH];
    bad = input;
    bad.mask = &nothing[0][0];
    bad.mask_stride_bytes = WIDTH;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, INTEGRATE(&bad, &params));
    static float unusable[HEIGHT][WIDTH][3];
    for (int i = 0; i < PIXELS; i++)
        (&unusable[0][0][0])[3 * i + 2] = i % 2 ? NAN : -1;
    bad = input;
    bad.normals = &unusable[0][0][0];
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, INTEGRATE(&bad, &params));
#undef BAD
}

static void parameters(void **state)
{
    (void)state;
    ofc_depth_params bad;
#define BAD(status, field, value)                                                                                      \
    (bad = params, bad.field = (value));                                                                               \
    REFUSED(status, out, INTEGRATE(&input, &bad))
    BAD(OFC_STATUS_INVALID_PARAMETER, pixel_pitch, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, pixel_pitch, INFINITY);
    BAD(OFC_STATUS_INVALID_PARAMETER, tolerance, 1e-7);
    BAD(OFC_STATUS_INVALID_PARAMETER, tolerance, NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, min_n3, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, min_n3, 1.1);
    BAD(OFC_STATUS_INVALID_PARAMETER, prior_weight, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, smoothness, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, method, 3);
    BAD(OFC_STATUS_INVALID_PARAMETER, method, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, max_cycles, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, max_cycles, INT32_MIN);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved[3], 1);
#undef BAD
}

static void same_depth(double tolerance)
{
    const double offset = out.depth[0] - truth(0, 0);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++)
            assert_true(fabs(out.depth[y * PADDED + x] - truth(x, y) - offset) < tolerance);
        assert_true(is_untouched(&out.depth[y * PADDED + WIDTH], (PADDED - WIDTH) * 4));
    }
}

static void depth(void **state)
{
    (void)state;
    ofc_depth_input given = input;
    ofc_depth_params wanted = params;
    for (ofc_depth_method method = OFC_DEPTH_POISSON; method <= OFC_DEPTH_COUPLED; method++) {
        wanted.method = method;
        wanted.smoothness = 1e-3;
        memset(&out, PATTERN, sizeof out);
        memset(space, PATTERN, sizeof space);
        assert_int_equal(INTEGRATE(&given, &wanted), OFC_STATUS_OK);
        same_depth(method == OFC_DEPTH_COUPLED ? 0.5 : 1e-3);
        assert_true(is_untouched(&out.params, sizeof out.params));
        assert_true(out.result.converged == 1 && out.result.regions == 1 && out.result.pixel_count == PIXELS);
        assert_true(out.result.excluded_count == 0 && out.result.residual <= params.tolerance);
    }
    /* Gradients, weights and a mask of everything say the same. */
    given = (ofc_depth_input){.p = &p[0][0],
                              .p_stride_bytes = sizeof p[0],
                              .q = &q[0][0],
                              .q_stride_bytes = sizeof q[0],
                              .mask = &mask[0][0],
                              .mask_stride_bytes = WIDTH,
                              .weights = &ones[0][0],
                              .weights_stride_bytes = sizeof ones[0],
                              .width = WIDTH,
                              .height = HEIGHT};
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(INTEGRATE(&given, &params), OFC_STATUS_OK);
    same_depth(1e-3);
    /* One known depth fixes the constant. */
    prior[0][0] = 1000;
    given.prior = &prior[0][0];
    given.prior_stride_bytes = sizeof prior[0];
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(INTEGRATE(&given, &params), OFC_STATUS_OK);
    same_depth(1e-2);
    assert_true(fabs(out.depth[0] - 1000) < 0.5);
    prior[0][0] = NAN;
    /* An unusable pixel has no depth, and is counted. */
    p[3][4] = INFINITY;
    assert_int_equal(INTEGRATE(&given, &params), OFC_STATUS_OK);
    assert_int_equal(out.result.excluded_count, 1);
    assert_int_equal(out.result.pixel_count, PIXELS - 1);
    assert_true(isnan(out.depth[3 * PADDED + 4]));
    p[3][4] = 0.04F;
    /* Stopped early. */
    for (int i = 0; i < PIXELS; i++)
        (&p[0][0])[i] += (float)(i * 7919 % 101 - 50) / 100;
    wanted = params;
    wanted.tolerance = 1e-6;
    wanted.max_cycles = 1;
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(INTEGRATE(&given, &wanted), OFC_STATUS_NOT_CONVERGED);
    assert_true(out.result.converged == 0 && out.result.cycles == 1 && out.result.residual > 1e-6);
    assert_true(isfinite(out.depth[0]));
}

static void small(void **state)
{
    (void)state;
    static const int32_t shapes[][2] = {{1, 1}, {WIDTH, 1}, {1, HEIGHT}, {2, 2}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (ofc_depth_method method = OFC_DEPTH_POISSON; method <= OFC_DEPTH_COUPLED; method++) {
            ofc_depth_input given = input;
            given.width = shapes[i][0];
            given.height = shapes[i][1];
            ofc_depth_params wanted = params;
            wanted.method = method;
            memset(&out, PATTERN, sizeof out);
            assert_int_equal(INTEGRATE(&given, &wanted), OFC_STATUS_OK);
            assert_int_equal(out.result.pixel_count, given.width * given.height);
            for (int y = 0; y < given.height; y++) {
                for (int x = 0; x < given.width; x++)
                    assert_true(isfinite(out.depth[y * PADDED + x]));
                assert_true(is_untouched(&out.depth[y * PADDED + given.width], (size_t)(PADDED - given.width) * 4));
            }
        }
}

static void normals_of_depth(void **state)
{
    (void)state;
    enum { STRIDE = (WIDTH * 3 + 2) * 4 };
    static float depth[HEIGHT][WIDTH];
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            depth[y][x] = (float)truth(x, y);
    depth[5][6] = NAN;
    const ofc_depth_map map = {
        .depth = &depth[0][0], .width = WIDTH, .height = HEIGHT, .row_stride_bytes = sizeof depth[0], .pixel_pitch = 1};
#define NORMALS(map, normals, stride) ofc_depth_normals(map, normals, stride)
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMALS(NULL, out.normals, STRIDE));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMALS(&map, NULL, STRIDE));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMALS(MISALIGNED(&map), out.normals, STRIDE));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMALS(&map, MISALIGNED(out.normals), STRIDE));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMALS(&map, out.normals, STRIDE + 1));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, NORMALS(&map, out.normals, WIDTH * 12 - 4));
    REFUSED(OFC_STATUS_TOO_LARGE, out, NORMALS(&map, out.normals, SIZE_MAX - 3));
    REFUSED(OFC_STATUS_OVERLAP, out, NORMALS(&map, &depth[0][0], STRIDE));
    ofc_depth_map bad = map;
    bad.width = 0;
    REFUSED(OFC_STATUS_EMPTY, out, NORMALS(&bad, out.normals, STRIDE));
    bad = map;
    bad.pixel_pitch = -1;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(&bad, out.normals, STRIDE));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(NORMALS(&map, out.normals, STRIDE), OFC_STATUS_OK);
    assert_true(is_untouched(out.depth, sizeof out.depth));
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 1; x + 1 < WIDTH; x++) {
            const float *n = &out.normals[y * (STRIDE / 4) + 3 * x];
            if (y == 5 && x == 6)
                assert_true(n[0] == 0 && n[1] == 0 && n[2] == 0);
            else if (y < 3 || y > 7 || x < 4 || x > 8) { /* away from the hole, where differences are one-sided */
                assert_true(fabs(-n[0] / n[2] - x / 100.0) < 1e-4 && fabs(-n[1] / n[2] - 0.5) < 1e-4);
                assert_true(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-6);
            }
        }
        assert_true(is_untouched(&out.normals[y * (STRIDE / 4) + WIDTH * 3], STRIDE - WIDTH * 12));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes),      cmocka_unit_test(pointers), cmocka_unit_test(inputs),
        cmocka_unit_test(parameters), cmocka_unit_test(depth),    cmocka_unit_test(small),
        cmocka_unit_test(normals_of_depth),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
