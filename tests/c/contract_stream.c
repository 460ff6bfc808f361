/* ofc_stream_*: rows of a camera, from a cold start to refined models. */
#include "stream.h"

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
        /* A picture's normals are computed in single precision, a row's in double. */
        for (int i = 0; i < 3 * WIDTH; i++)
            assert_true(fabs(out.normals[i] - normals[y][i / 3][i % 3]) < 1e-5);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(answers_are_those_of_solve, fresh),
        cmocka_unit_test_setup(joint_answers_are_those_of_solve, fresh_joint),
        cmocka_unit_test_setup(frames_refine_or_refuse, fresh),
        cmocka_unit_test_setup(frames_refine_or_refuse, fresh_joint),
        cmocka_unit_test_setup(frames_without_an_answer, fresh),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
