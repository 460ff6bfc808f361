/* ofc_stream_*: rows, memory and parameters that are refused, and what a refusal leaves as it was. */
#include "stream.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(rows_out_of_order, fresh),
        cmocka_unit_test_setup(bad_rows, fresh),
        cmocka_unit_test_setup(bad_rows, fresh_joint),
        cmocka_unit_test_setup(memory_that_is_no_stream, fresh),
        cmocka_unit_test_setup(bad_streams, fresh),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
