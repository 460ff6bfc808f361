/* ofc_stream_*: rows of a camera, from a cold start to refined models. */
#include "contract.h"

#include <pthread.h>
#include <stdlib.h>

enum { SIZE = OFC_STREAM_SIZE_FOR(WIDTH, HEIGHT, 10000) };

static uint64_t memory[SIZE / sizeof(uint64_t)];
static ofc_stream_params params;
static ofc_stream *stream;

static struct {
    ofc_solution solution;
    ofc_stream_drift drift;
    float normals[3 * WIDTH + 16];
    uint8_t packed[3 * WIDTH + 16];
    uint8_t flags[WIDTH + 16];
    ofc_stream_pass pass;
    ofc_stream *stream;
    ofc_stream_params params;
} out;

static ofc_image row_of(uint8_t picture[HEIGHT][WIDTH][3], int y)
{
    ofc_image row = {.pixels = picture[y],
                     .width = WIDTH,
                     .height = 1,
                     .row_stride_bytes = sizeof picture[0],
                     .format = OFC_PIXEL_RGB8};
    return row;
}

/* Room for every pixel: the answers are those of ofc_solve. */
static int fresh_on(ofc_orientation_method orientation_method)
{
    if (ofc_stream_params_default(&params) != OFC_STATUS_OK)
        return -1;
    params.solve.lmeds.sample_size = 10000;
    params.solve.orientation_method = orientation_method;
    memset(memory, 0xa5, sizeof memory);
    return ofc_stream_init(WIDTH, HEIGHT, OFC_PIXEL_RGB8, &params, memory, sizeof memory, &stream);
}

static int fresh(void **state)
{
    (void)state;
    return fresh_on(OFC_ORIENTATION_DIRECT);
}

static int fresh_joint(void **state)
{
    (void)state;
    return fresh_on(OFC_ORIENTATION_JOINT);
}

static ofc_status frame_of(ofc_stream *s, uint8_t picture[HEIGHT][WIDTH][3], ofc_stream_pass *next)
{
    assert_int_equal(ofc_stream_begin(s, NULL), OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++) {
        const ofc_image row = row_of(picture, y);
        assert_int_equal(ofc_stream_row(s, y, &row), OFC_STATUS_OK);
    }
    return ofc_stream_end(s, next);
}

static void solve_cold(ofc_stream *s)
{
    ofc_stream_pass next = OFC_PASS_COLORS;
    for (int frame = 0; frame < 5 && next != OFC_PASS_REFINE; frame++)
        assert_int_equal(frame_of(s, ball, &next), OFC_STATUS_OK);
    assert_int_equal(next, OFC_PASS_REFINE);
}

static void answers_are_those_of_solve(void **state)
{
    (void)state;
    assert_true((void *)stream == (void *)memory);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_solution(stream, &out.solution));
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_drift_get(stream, &out.drift));
    const ofc_image first = row_of(ball, 0);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_normals_row(stream, &first, out.normals));
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_normals_row_packed(stream, &first, out.packed));
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_inliers_row(stream, &first, out.flags));
    assert_int_equal(frame_of(stream, ball, &out.pass), OFC_STATUS_OK);
    assert_int_equal(out.pass, OFC_PASS_TILTS);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_solution(stream, &out.solution));
    assert_int_equal(ofc_stream_begin(stream, &out.pass), OFC_STATUS_OK);
    assert_int_equal(out.pass, OFC_PASS_TILTS);
    solve_cold(stream);

    memset(&out, 0, sizeof out);
    assert_int_equal(ofc_stream_solution(stream, &out.solution), OFC_STATUS_OK);
    ofc_solution expected = stages.solution;
    if (expected.candidate_count == 1)
        expected.candidates[0].integral = INFINITY;
    assert_memory_equal(&out.solution, &expected, sizeof expected);

    static float normals[HEIGHT][WIDTH][3];
    static uint8_t mask[HEIGHT][WIDTH];
    const ofc_image image = ball_image();
    assert_int_equal(ofc_normals_compute(&image, &stages.solution, normals[0][0], sizeof normals[0]), OFC_STATUS_OK);
    assert_int_equal(ofc_inlier_test_apply(&image, &stages.solution.inlier_test, mask[0], NULL), OFC_STATUS_OK);
    memset(&out, PATTERN, sizeof out);
    for (int y = 0; y < HEIGHT; y++) {
        const ofc_image row = row_of(ball, y);
        assert_int_equal(ofc_stream_normals_row(stream, &row, out.normals), OFC_STATUS_OK);
        assert_int_equal(ofc_stream_normals_row_packed(stream, &row, out.packed), OFC_STATUS_OK);
        assert_int_equal(ofc_stream_inliers_row(stream, &row, out.flags), OFC_STATUS_OK);
        assert_memory_equal(out.normals, normals[y], sizeof normals[y]);
        assert_memory_equal(out.flags, mask[y], sizeof mask[y]);
        for (int i = 0; i < 3 * WIDTH; i++) {
            const double byte = mask[y][i / 3] ? (normals[y][i / 3][i % 3] + 1) * 127.5 : 0;
            assert_true(fabs(out.packed[i] - byte) < 0.501);
        }
    }
    assert_true(is_untouched(out.normals + (size_t)3 * WIDTH, 64));
    assert_true(is_untouched(out.packed + (size_t)3 * WIDTH, 16));
    assert_true(is_untouched(out.flags + WIDTH, 16));
}

static void joint_answers_are_those_of_solve(void **state)
{
    (void)state;
    ofc_solution expected;
    const ofc_image image = ball_image();
    assert_int_equal(ofc_solve(&image, &params.solve, workspace, sizeof workspace, NULL, &expected), OFC_STATUS_OK);
    assert_int_equal(expected.slant_source, OFC_SLANTS_JOINT);
    assert_int_equal(frame_of(stream, ball, &out.pass), OFC_STATUS_OK);
    assert_int_equal(out.pass, OFC_PASS_OUTWARD);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_solution(stream, &out.solution));
    assert_int_equal(frame_of(stream, ball, &out.pass), OFC_STATUS_OK);
    assert_int_equal(out.pass, OFC_PASS_REFINE);
    assert_int_equal(ofc_stream_solution(stream, &out.solution), OFC_STATUS_OK);
    assert_memory_equal(&out.solution, &expected, sizeof expected);

    /* With fewer colors there is not room for all windows, and one pass more. */
    static const uint32_t samples[] = {24, 300, 2048};
    for (int i = 0; i < 3; i++) {
        params.solve.lmeds.sample_size = samples[i];
        assert_int_equal(ofc_stream_init(WIDTH, HEIGHT, OFC_PIXEL_RGB8, &params, memory, sizeof memory, &stream),
                         OFC_STATUS_OK);
        if (samples[i] == 24) /* too few to be sure of anything */
            continue;
        assert_int_equal(frame_of(stream, ball, NULL), OFC_STATUS_OK);
        assert_int_equal(frame_of(stream, ball, &out.pass), OFC_STATUS_OK);
        assert_int_equal(out.pass, OFC_PASS_INTEGRABILITY);
        assert_int_equal(ofc_stream_begin(stream, &out.pass), OFC_STATUS_OK);
        assert_int_equal(out.pass, OFC_PASS_INTEGRABILITY);
        REFUSED(OFC_STATUS_TOO_FEW_ROWS, out, ofc_stream_end(stream, &out.pass));
        assert_int_equal(frame_of(stream, ball, &out.pass), OFC_STATUS_OK);
        assert_int_equal(out.pass, OFC_PASS_REFINE);
        assert_int_equal(ofc_stream_solution(stream, &out.solution), OFC_STATUS_OK);
        for (int k = 0; k < 9; k++)
            assert_true(fabs(out.solution.orientation.f[k] - expected.orientation.f[k]) < 8);
    }
}

static void frames_refine_or_refuse(void **state)
{
    (void)state;
    static uint8_t other[HEIGHT][WIDTH][3];
    solve_cold(stream);
    assert_int_equal(frame_of(stream, ball, &out.pass), OFC_STATUS_OK);
    assert_int_equal(out.pass, OFC_PASS_REFINE);
    assert_int_equal(ofc_stream_drift_get(stream, &out.drift), OFC_STATUS_OK);
    assert_int_equal(out.drift.refined, 1);
    assert_int_equal(out.drift.reserved, 0);
    assert_true(out.drift.inlier_ratio > 0.9 && out.drift.inlier_ratio <= 1);
    for (int i = 0; i < 3; i++) {
        assert_true(out.drift.angle_rad[i] >= 0 && out.drift.angle_rad[i] < 0.02);
        assert_true(fabs(out.drift.strength_ratio[i] - 1) < 0.01);
    }
    assert_true(fabs(out.drift.dispersion_ratio - 1) < 0.2);
    assert_int_equal(ofc_stream_solution(stream, &out.solution), OFC_STATUS_OK);
    assert_int_equal(out.solution.orientation.rank, 3);

    /* Channels changed places: other lights. */
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            (&other[0][0])[i][c] = (uint8_t)((&ball[0][0])[i][(c + 1) % 3] * (c + 2) / 4);
    assert_int_equal(frame_of(stream, other, &out.pass), OFC_STATUS_COLD_START_NEEDED);
    assert_int_equal(out.pass, OFC_PASS_COLORS);
    assert_int_equal(ofc_stream_drift_get(stream, &out.drift), OFC_STATUS_OK);
    assert_int_equal(out.drift.refined, 0);
    assert_true(out.drift.inlier_ratio < 0.5 && isnan(out.drift.dispersion_ratio) && isnan(out.drift.angle_rad[2]));
    static ofc_solution before;
    before = out.solution;
    assert_int_equal(ofc_stream_solution(stream, &out.solution), OFC_STATUS_OK);
    assert_memory_equal(&before, &out.solution, sizeof before);
    /* Whatever it was, it can be forgotten. */
    solve_cold(stream);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_drift_get(stream, &out.drift));
    assert_int_equal(ofc_stream_restart(stream), OFC_STATUS_OK);
    const ofc_image first = row_of(ball, 0);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_normals_row(stream, &first, out.normals));
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_solution(stream, &out.solution));
    assert_int_equal(ofc_stream_begin(stream, &out.pass), OFC_STATUS_OK);
    assert_int_equal(out.pass, OFC_PASS_COLORS);
}

static void frames_without_an_answer(void **state)
{
    (void)state;
    static uint8_t pixels[HEIGHT][WIDTH][3];
    REFUSED(OFC_STATUS_DARK, out, frame_of(stream, pixels, &out.pass));
    assert_int_equal(ofc_stream_begin(stream, &out.pass), OFC_STATUS_OK);
    assert_int_equal(out.pass, OFC_PASS_COLORS);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_stream_solution(stream, &out.solution));
    memset(pixels, 255, sizeof pixels);
    assert_int_equal(frame_of(stream, pixels, NULL), OFC_STATUS_SATURATED);
    memset(pixels, 90, sizeof pixels);
    assert_int_equal(frame_of(stream, pixels, &out.pass), OFC_STATUS_RANK_DEFICIENT);
    assert_int_equal(out.pass, OFC_PASS_COLORS);
    assert_int_equal(ofc_stream_solution(stream, &out.solution), OFC_STATUS_RANK_DEFICIENT);
    assert_int_equal(out.solution.pixel_counts.usable, PIXELS);
    solve_cold(stream);
}

static void rows_out_of_order(void **state)
{
    (void)state;
    ofc_image row = row_of(ball, 0);
    assert_int_equal(ofc_stream_row(stream, 0, &row), OFC_STATUS_NO_FRAME);
    assert_int_equal(ofc_stream_end(stream, NULL), OFC_STATUS_NO_FRAME);
    assert_int_equal(ofc_stream_begin(stream, NULL), OFC_STATUS_OK);
    assert_int_equal(ofc_stream_row(stream, 1, &row), OFC_STATUS_ROW_ORDER);
    assert_int_equal(ofc_stream_row(stream, -1, &row), OFC_STATUS_ROW_ORDER);
    assert_int_equal(ofc_stream_row(stream, INT32_MIN, &row), OFC_STATUS_ROW_ORDER);
    assert_int_equal(ofc_stream_row(stream, 0, &row), OFC_STATUS_OK);
    assert_int_equal(ofc_stream_row(stream, 0, &row), OFC_STATUS_ROW_ORDER);
    row.width--;
    assert_int_equal(ofc_stream_row(stream, 1, &row), OFC_STATUS_ROW_MISMATCH);
    row = ball_image();
    assert_int_equal(ofc_stream_row(stream, 1, &row), OFC_STATUS_ROW_MISMATCH);
    row = row_of(ball, 0);
    row.format = OFC_PIXEL_RGB16;
    row.width /= 2;
    assert_int_equal(ofc_stream_row(stream, 1, &row), OFC_STATUS_ROW_MISMATCH);
    row = row_of(ball, 1);
    row.format = OFC_PIXEL_BGR8;
    assert_int_equal(ofc_stream_row(stream, 1, &row), OFC_STATUS_OK);
    REFUSED(OFC_STATUS_TOO_FEW_ROWS, out, ofc_stream_end(stream, &out.pass));
    REFUSED(OFC_STATUS_NO_FRAME, out, ofc_stream_end(stream, &out.pass));
    assert_int_equal(ofc_stream_begin(stream, &out.pass), OFC_STATUS_OK);
    assert_int_equal(out.pass, OFC_PASS_COLORS);
    for (int y = 0; y < HEIGHT; y++) {
        row = row_of(ball, y);
        assert_int_equal(ofc_stream_row(stream, y, &row), OFC_STATUS_OK);
    }
    assert_int_equal(ofc_stream_row(stream, HEIGHT, &row), OFC_STATUS_TOO_MANY_ROWS);
    assert_int_equal(ofc_stream_end(stream, NULL), OFC_STATUS_OK);
    solve_cold(stream);
    assert_int_equal(ofc_stream_solution(stream, &out.solution), OFC_STATUS_OK);
    assert_memory_equal(&out.solution.orientation, &stages.solution.orientation, sizeof stages.solution.orientation);
    row.width--;
    REFUSED(OFC_STATUS_ROW_MISMATCH, out, ofc_stream_normals_row(stream, &row, out.normals));
    REFUSED(OFC_STATUS_ROW_MISMATCH, out, ofc_stream_normals_row_packed(stream, &row, out.packed));
    REFUSED(OFC_STATUS_ROW_MISMATCH, out, ofc_stream_inliers_row(stream, &row, out.flags));
}

static ofc_status refused_row(const ofc_image *image)
{
    return ofc_stream_row(stream, 0, image);
}

static ofc_status refused_normals(const ofc_image *image)
{
    return ofc_stream_normals_row(stream, image, out.normals);
}

static void bad_rows(void **state)
{
    (void)state;
    solve_cold(stream);
    assert_int_equal(ofc_stream_begin(stream, NULL), OFC_STATUS_OK);
    refuses_bad_images(refused_row, &out, sizeof out);
    refuses_bad_images(refused_normals, &out, sizeof out);
    const ofc_image row = row_of(ball, 0);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_stream_normals_row(stream, &row, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_stream_normals_row(stream, &row, MISALIGNED(out.normals)));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_stream_normals_row_packed(stream, &row, NULL));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_stream_inliers_row(stream, &row, NULL));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_stream_solution(stream, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_stream_solution(stream, MISALIGNED(&out.solution)));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_stream_drift_get(stream, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_stream_begin(stream, MISALIGNED(&out.pass)));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_stream_end(stream, MISALIGNED(&out.pass)));
    /* Nothing may lie inside the stream, or outputs on the row. */
    ofc_image inside = row;
    inside.pixels = memory;
    assert_int_equal(ofc_stream_row(stream, 0, &inside), OFC_STATUS_OVERLAP);
    assert_int_equal(ofc_stream_inliers_row(stream, &row, (uint8_t *)memory + sizeof memory - WIDTH), OFC_STATUS_OVERLAP);
    assert_int_equal(ofc_stream_normals_row_packed(stream, &row, ball[0][WIDTH - 1]), OFC_STATUS_OVERLAP);
    assert_int_equal(ofc_stream_begin(stream, (ofc_stream_pass *)(void *)&memory[8]), OFC_STATUS_OVERLAP);
    assert_int_equal(ofc_stream_end(stream, (ofc_stream_pass *)(void *)&memory[8]), OFC_STATUS_OVERLAP);
    assert_int_equal(ofc_stream_solution(stream, (ofc_solution *)(void *)&memory[8]), OFC_STATUS_OVERLAP);
    assert_int_equal(ofc_stream_drift_get(stream, (ofc_stream_drift *)(void *)&memory[8]), OFC_STATUS_OVERLAP);
}

static ofc_status call_all(ofc_stream *s, int which)
{
    const ofc_image row = row_of(ball, 0);
    switch (which) {
    case 0: return ofc_stream_begin(s, &out.pass);
    case 1: return ofc_stream_row(s, 0, &row);
    case 2: return ofc_stream_end(s, &out.pass);
    case 3: return ofc_stream_solution(s, &out.solution);
    case 4: return ofc_stream_drift_get(s, &out.drift);
    case 5: return ofc_stream_normals_row(s, &row, out.normals);
    case 6: return ofc_stream_normals_row_packed(s, &row, out.packed);
    case 7: return ofc_stream_inliers_row(s, &row, out.flags);
    default: return ofc_stream_restart(s);
    }
}

static void memory_that_is_no_stream(void **state)
{
    (void)state;
    solve_cold(stream);
    static uint64_t saved[4], zeros[SIZE / sizeof(uint64_t)];
    memcpy(saved, memory, sizeof saved);
    for (int call = 0; call < 9; call++) {
        REFUSED(OFC_STATUS_NULL_POINTER, out, call_all(NULL, call));
        REFUSED(OFC_STATUS_MISALIGNED, out, call_all(MISALIGNED(stream), call));
        REFUSED(OFC_STATUS_NO_STREAM, out, call_all((ofc_stream *)zeros, call));
        for (int word = 0; word < 4; word++)
            for (int bit = 0; bit < 64; bit += 7) {
                memory[word] ^= (uint64_t)1 << bit;
                REFUSED(OFC_STATUS_NO_STREAM, out, call_all(stream, call));
                memory[word] = saved[word];
            }
    }
    /* It has no address of its own. */
    static uint64_t moved[SIZE / sizeof(uint64_t)];
    memcpy(moved, memory, sizeof moved);
    memset(memory, 0, sizeof memory);
    assert_int_equal(frame_of((ofc_stream *)moved, ball, NULL), OFC_STATUS_OK);
}

static ofc_status init(int32_t width, int32_t height, ofc_pixel_format format, const ofc_stream_params *p, void *at,
                       size_t bytes)
{
    return ofc_stream_init(width, height, format, p, at, bytes, &out.stream);
}

static void bad_streams(void **state)
{
    (void)state;
    memset(memory, PATTERN, sizeof memory);
    const int rgb = OFC_PIXEL_RGB8;
    REFUSED(OFC_STATUS_EMPTY, out, init(0, HEIGHT, rgb, &params, memory, SIZE));
    REFUSED(OFC_STATUS_EMPTY, out, init(WIDTH, -1, rgb, &params, memory, SIZE));
    REFUSED(OFC_STATUS_TOO_LARGE, out, init(INT32_MAX, 2, rgb, &params, memory, SIZE));
    REFUSED(OFC_STATUS_UNKNOWN_FORMAT, out, init(WIDTH, HEIGHT, 0, &params, memory, SIZE));
    REFUSED(OFC_STATUS_NULL_POINTER, out, init(WIDTH, HEIGHT, rgb, NULL, memory, SIZE));
    REFUSED(OFC_STATUS_MISALIGNED, out, init(WIDTH, HEIGHT, rgb, MISALIGNED(&params), memory, SIZE));
    REFUSED(OFC_STATUS_NULL_POINTER, out, init(WIDTH, HEIGHT, rgb, &params, NULL, SIZE));
    REFUSED(OFC_STATUS_MISALIGNED, out, init(WIDTH, HEIGHT, rgb, &params, (char *)memory + 4, SIZE));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, init(WIDTH, HEIGHT, rgb, &params, memory, SIZE - 1));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, init(WIDTH, HEIGHT, rgb, &params, memory, 0));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_stream_init(WIDTH, HEIGHT, rgb, &params, memory, SIZE, NULL));
    REFUSED(OFC_STATUS_OVERLAP, out,
            ofc_stream_init(WIDTH, HEIGHT, rgb, &params, memory, SIZE, (ofc_stream **)(void *)&memory[9]));
    struct {
        ofc_stream_params params;
        ofc_status expected;
    } bad[14];
    size_t n = 0;
#define BAD(status, field, value)                                                                                      \
    (bad[n].params = params, bad[n].params.field = (value), bad[n++].expected = (status))
    BAD(OFC_STATUS_INVALID_PARAMETER, min_inlier_ratio, -0.1);
    BAD(OFC_STATUS_INVALID_PARAMETER, min_inlier_ratio, 1.1);
    BAD(OFC_STATUS_INVALID_PARAMETER, min_inlier_ratio, NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, solve.lmeds.sample_size, 23);
    BAD(OFC_STATUS_INVALID_PARAMETER, solve.orientation_method, 2);
    BAD(OFC_STATUS_INVALID_PARAMETER, solve.shadow_rejection, 3);
    BAD(OFC_STATUS_INVALID_PARAMETER, solve.norm_source, OFC_NORMS_CHANNEL_MAXIMA);
    BAD(OFC_STATUS_INVALID_PARAMETER, solve.convexity, OFC_CONVEXITY_HOLLOW);
    BAD(OFC_STATUS_INVALID_PARAMETER, solve.tilt_estimator, OFC_TILT_CHOJNACKI);
    BAD(OFC_STATUS_INVALID_PARAMETER, solve.slant_fallback, OFC_FALLBACK_TILT_INTEGRABILITY);
    BAD(OFC_STATUS_INVALID_PARAMETER, solve.rank_threshold, 1);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved[0], 1);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved[2], 1);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, solve.reserved[0], 1);
#undef BAD
    for (size_t i = 0; i < n; i++) {
        REFUSED(bad[i].expected, out, init(WIDTH, HEIGHT, rgb, &bad[i].params, memory, SIZE));
        assert_int_equal(ofc_stream_size(WIDTH, HEIGHT, &bad[i].params), 0);
    }
    assert_true(is_untouched(memory, sizeof memory));
}

static void sizes_and_defaults(void **state)
{
    (void)state;
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_stream_params_default(NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_stream_params_default(MISALIGNED(&out.params)));
    memset(&out, 0, sizeof out);
    assert_int_equal(ofc_stream_params_default(&out.params), OFC_STATUS_OK);
    assert_int_equal(out.params.solve.lmeds.sample_size, 2048);
    assert_true(out.params.min_inlier_ratio == 0.5);
    assert_int_equal(out.params.refine_pixels, 16384);
    ofc_solve_params solve;
    memset(&solve, 0, sizeof solve);
    assert_int_equal(ofc_solve_params_default(&solve), OFC_STATUS_OK);
    solve.lmeds.sample_size = 2048;
    assert_memory_equal(&solve, &out.params.solve, sizeof solve);

    assert_true(OFC_STREAM_SIZE(320, 240) <= 48 << 10);
    static const int32_t edges[] = {1, 2, 7, 45, 46, 64, 99, 320, 640, 3414, 46340};
    static const uint32_t samples[] = {24, 25, 100, 2048, 10000, 1000000};
    const size_t edge_count = sizeof edges / sizeof *edges;
    for (size_t i = 0; i < edge_count * edge_count; i++) {
        const int32_t width = edges[i % edge_count], height = edges[i / edge_count];
        assert_int_equal(ofc_stream_size(width, height, &out.params), OFC_STREAM_SIZE(width, height));
        for (size_t k = 0; k < sizeof samples / sizeof *samples; k++) {
            ofc_stream_params other = out.params;
            other.solve.lmeds.sample_size = samples[k];
            assert_int_equal(ofc_stream_size(width, height, &other), OFC_STREAM_SIZE_FOR(width, height, samples[k]));
            assert_int_equal(ofc_stream_size(width, height, &other) % 8, 0);
            other.solve.orientation_method = OFC_ORIENTATION_DIRECT;
            const size_t less = ofc_stream_size(width, height, &other);
            assert_true(less > 0 && less <= OFC_STREAM_SIZE_FOR(width, height, samples[k]));
        }
    }
    assert_int_equal(ofc_stream_size(0, 10, &out.params), 0);
    assert_int_equal(ofc_stream_size(10, -1, &out.params), 0);
    assert_int_equal(ofc_stream_size(INT32_MAX, 2, &out.params), 0);
    assert_int_equal(ofc_stream_size(10, 10, NULL), 0);
}

static void exact_memory(void **state)
{
    (void)state;
    /* From the heap, so that a sanitizer sees one byte too many: few samples, more rows than them, and one of each. */
    static const uint32_t samples[] = {24, 999, 10000};
    for (int i = 0; i < 3; i++) {
        params.solve.lmeds.sample_size = samples[i];
        const size_t need = ofc_stream_size(WIDTH, HEIGHT, &params);
        void *exact = malloc(need);
        uint8_t *flags = malloc(WIDTH);
        assert_non_null(exact);
        assert_non_null(flags);
        ofc_stream *s;
        assert_int_equal(ofc_stream_init(WIDTH, HEIGHT, OFC_PIXEL_RGB8, &params, exact, need, &s), OFC_STATUS_OK);
        for (int frame = 0; frame < 5; frame++)
            assert_true(frame_of(s, ball, NULL) >= 0);
        const ofc_image row = row_of(ball, HEIGHT / 2);
        if (samples[i] > 24)
            assert_int_equal(ofc_stream_inliers_row(s, &row, flags), OFC_STATUS_OK);
        free(flags);
        free(exact);
    }
}

/* Of the call that ends a pass, with the joint method. */
enum { JOINT_STACK = 20480 };

/* What a call needs of the stack: one thread a call, on a stack whose pattern it wears away. */
enum call { NOTHING, INIT, BEGIN, ROW, END, SOLUTION, DRIFT, NORMALS, PACKED, INLIERS, CALLS };

static struct {
    enum call call;
    int32_t y;
    ofc_status status;
} job;

static void *run_job(void *argument)
{
    (void)argument;
    const ofc_image row = row_of(ball, job.y);
    switch (job.call) {
    case INIT:
        job.status = ofc_stream_init(WIDTH, HEIGHT, OFC_PIXEL_RGB8, &params, memory, sizeof memory, &stream);
        break;
    case BEGIN: job.status = ofc_stream_begin(stream, &out.pass); break;
    case ROW: job.status = ofc_stream_row(stream, job.y, &row); break;
    case END: job.status = ofc_stream_end(stream, &out.pass); break;
    case SOLUTION: job.status = ofc_stream_solution(stream, &out.solution); break;
    case DRIFT: job.status = ofc_stream_drift_get(stream, &out.drift); break;
    case NORMALS: job.status = ofc_stream_normals_row(stream, &row, out.normals); break;
    case PACKED: job.status = ofc_stream_normals_row_packed(stream, &row, out.packed); break;
    case INLIERS: job.status = ofc_stream_inliers_row(stream, &row, out.flags); break;
    default: job.status = OFC_STATUS_OK; break;
    }
    return NULL;
}

static size_t stack_of(enum call call, int32_t y)
{
    static uint8_t stack[128 << 10] __attribute__((aligned(4096)));
    pthread_attr_t attributes;
    pthread_t thread;
    memset(stack, PATTERN, sizeof stack);
    job.call = call;
    job.y = y;
    assert_int_equal(pthread_attr_init(&attributes), 0);
    assert_int_equal(pthread_attr_setstack(&attributes, stack, sizeof stack), 0);
    assert_int_equal(pthread_create(&thread, &attributes, run_job, NULL), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_int_equal(pthread_attr_destroy(&attributes), 0);
    assert_int_equal(job.status, OFC_STATUS_OK);
    size_t left = 0;
    while (left < sizeof stack && stack[left] == PATTERN)
        left++;
    return sizeof stack - left;
}

static void stack_use(void **state)
{
    (void)state;
    static const char *const names[] = {"nothing", "init",  "begin",   "row",    "end",
                                        "solution", "drift", "normals", "packed", "inliers"};
    size_t most[CALLS] = {0};
#define DEEPEST(call, y)                                                                                               \
    do {                                                                                                               \
        const size_t used = stack_of(call, y);                                                                         \
        most[call] = used > most[call] ? used : most[call];                                                            \
    } while (0)
    /* The first round also binds names, which takes stack of its own. */
    for (int round = 0; round < 2; round++) {
        memset(most, 0, sizeof most);
        DEEPEST(NOTHING, 0);
        DEEPEST(INIT, 0);
        for (int frame = 0; frame < 5; frame++) {
            DEEPEST(BEGIN, 0);
            for (int y = 0; y < HEIGHT; y++)
                DEEPEST(ROW, y);
            DEEPEST(END, 0);
        }
        DEEPEST(SOLUTION, 0);
        DEEPEST(DRIFT, 0);
        DEEPEST(NORMALS, HEIGHT / 2);
        DEEPEST(PACKED, HEIGHT / 2);
        DEEPEST(INLIERS, HEIGHT / 2);
    }
    for (int call = 0; call < CALLS; call++) {
        print_message("%s: %zu bytes of stack\n", names[call], most[call] - most[NOTHING]);
#ifndef __SANITIZE_ADDRESS__
        const size_t limit = params.solve.orientation_method == OFC_ORIENTATION_JOINT && call == END ? JOINT_STACK : 4096;
        assert_true(most[call] - most[NOTHING] <= limit);
#endif
    }
    assert_true(most[END] > most[NOTHING] + 1024); /* It is the stack that is measured. */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(answers_are_those_of_solve, fresh),
        cmocka_unit_test_setup(joint_answers_are_those_of_solve, fresh_joint),
        cmocka_unit_test_setup(frames_refine_or_refuse, fresh),
        cmocka_unit_test_setup(frames_refine_or_refuse, fresh_joint),
        cmocka_unit_test_setup(frames_without_an_answer, fresh),
        cmocka_unit_test_setup(rows_out_of_order, fresh),
        cmocka_unit_test_setup(bad_rows, fresh),
        cmocka_unit_test_setup(bad_rows, fresh_joint),
        cmocka_unit_test_setup(memory_that_is_no_stream, fresh),
        cmocka_unit_test_setup(bad_streams, fresh),
        cmocka_unit_test_setup(sizes_and_defaults, fresh),
        cmocka_unit_test_setup(exact_memory, fresh),
        cmocka_unit_test_setup(exact_memory, fresh_joint),
        cmocka_unit_test_setup(stack_use, fresh),
        cmocka_unit_test_setup(stack_use, fresh_joint),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
