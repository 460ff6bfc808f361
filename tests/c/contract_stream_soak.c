/* Thousands of frames through a stream as a bad line gives them: rows lost, given twice or out of order, rows and whole frames of
 * noise, frames that end early. OFC_SOAK_FRAMES makes them more. A twin gets the same and lies elsewhere: what both say is equal. */
#include "stream.h"

#include <stdio.h>
#include <stdlib.h>

enum { FRAMES = 2000, CANARY = 64 };

static uint64_t random_bits(void)
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state * 0x2545F4914F6CDD1Du >> 16;
}

static int one_in(unsigned n)
{
    return random_bits() % n == 0;
}

/* Memory for a twin between bytes that nobody may write; it moves to the other place and back. */
static struct {
    uint8_t before[CANARY];
    uint64_t memory[SIZE / sizeof(uint64_t)];
    uint8_t behind[CANARY];
} places[2];

static int place;
static ofc_stream *twin;
static uint8_t picture[HEIGHT][WIDTH][3];

static void guard(void)
{
    for (int i = 0; i < 2; i++) {
        memset(places[i].before, PATTERN, CANARY);
        memset(places[i].behind, PATTERN, CANARY);
    }
}

static void check_guard(void)
{
    for (int i = 0; i < 2; i++)
        assert_true(is_untouched(places[i].before, CANARY) && is_untouched(places[i].behind, CANARY));
}

static void move_twin(void)
{
    memcpy(places[1 - place].memory, places[place].memory, SIZE);
    memset(places[place].memory, 0xee, SIZE);
    place = 1 - place;
    twin = (ofc_stream *)(void *)places[place].memory;
}

static ofc_status row(int32_t y, int from)
{
    const ofc_image image = row_of(picture, from);
    const ofc_status status = ofc_stream_row(stream, y, &image);
    assert_int_equal(ofc_stream_row(twin, y, &image), status);
    return status;
}

/* The ball with noise of its own, and now and then rows or all of it of any bytes. Returns whether it is the ball. */
static int expose(void)
{
    const int all = one_in(40), some = one_in(12);
    for (int y = 0; y < HEIGHT; y++) {
        const int any = all || (some && one_in(6));
        for (int i = 0; i < 3 * WIDTH; i++) {
            const uint8_t exact = (&ball[y][0][0])[i];
            const uint64_t bits = random_bits();
            (&picture[y][0][0])[i] = (uint8_t)(any ? bits : exact == 0 ? 0 : exact - 1u + bits % 3);
        }
    }
    return !all && !some;
}

/* Gives the rows of a frame, and returns whether they were all. */
static int give_rows(void)
{
    const int32_t end = one_in(25) ? (int32_t)(random_bits() % HEIGHT) : HEIGHT;
    for (int32_t y = 0; y < end; y++) {
        if (one_in(400)) {
            const int32_t other = (int32_t)(random_bits() % (2 * HEIGHT)) - HEIGHT / 2;
            if (other != y)
                assert_true(row(other, y) < 0);
        }
        assert_int_equal(row(y, y), OFC_STATUS_OK);
        if (one_in(400))
            assert_int_equal(row(y, y), y + 1 < HEIGHT ? OFC_STATUS_ROW_ORDER : OFC_STATUS_TOO_MANY_ROWS);
    }
    return end == HEIGHT;
}

static ofc_status end_frame(ofc_stream_pass *pass)
{
    ofc_stream_pass other = 0;
    *pass = 0;
    const ofc_status status = ofc_stream_end(stream, pass);
    assert_int_equal(ofc_stream_end(twin, &other), status);
    assert_int_equal(other, *pass);
    return status;
}

static void begin_frame(void)
{
    ofc_stream_pass pass, other;
    assert_int_equal(ofc_stream_begin(stream, &pass), OFC_STATUS_OK);
    assert_int_equal(ofc_stream_begin(twin, &other), OFC_STATUS_OK);
    assert_int_equal(pass, other);
}

/* Both say the same, and where there is a solution it is that of the ball within what noise does. */
static int compare(const ofc_solution *truth)
{
    static ofc_solution one, other;
    static float normals[2][WIDTH][3];
    const ofc_status status = ofc_stream_solution(stream, &one);
    assert_int_equal(ofc_stream_solution(twin, &other), status);
    if (status != OFC_STATUS_OK)
        return 0;
    assert_memory_equal(&one, &other, sizeof one);
    const ofc_image image = row_of(ball, HEIGHT / 2);
    assert_int_equal(ofc_stream_normals_row(stream, &image, normals[0][0]), OFC_STATUS_OK);
    assert_int_equal(ofc_stream_normals_row(twin, &image, normals[1][0]), OFC_STATUS_OK);
    assert_memory_equal(normals[0], normals[1], sizeof normals[0]);
    for (int i = 0; i < 3; i++) {
        double dot = 0, own = 0, theirs = 0;
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            dot += one.orientation.f[k] * truth->orientation.f[k];
            own += one.orientation.f[k] * one.orientation.f[k];
            theirs += truth->orientation.f[k] * truth->orientation.f[k];
        }
        assert_true(dot > 0.98 * sqrt(own * theirs)); /* 11 degrees. */
        assert_true(fabs(sqrt(own / theirs) - 1) < 0.2);
    }
    return 1;
}

static void soak(int (*setup)(void **state), long frames)
{
    assert_int_equal(setup(NULL), 0);
    guard();
    place = 0;
    assert_int_equal(ofc_stream_init(WIDTH, HEIGHT, OFC_PIXEL_RGB8, &params, places[0].memory, SIZE, &twin), OFC_STATUS_OK);
    solve_cold(stream);
    solve_cold(twin);
    static ofc_solution truth;
    assert_int_equal(ofc_stream_solution(stream, &truth), OFC_STATUS_OK);
    long whole = 0, refined = 0, cold = 0, compared = 0, clean = 0;
    for (long frame = 0; frame < frames; frame++) {
        clean = expose() ? clean + 1 : 0;
        begin_frame();
        if (one_in(50))
            begin_frame();
        if (one_in(100))
            move_twin();
        ofc_stream_pass pass;
        const int is_whole = give_rows();
        const ofc_status status = end_frame(&pass);
        assert_int_equal(status == OFC_STATUS_TOO_FEW_ROWS, !is_whole);
        whole += is_whole;
        refined += status == OFC_STATUS_OK && pass == OFC_PASS_REFINE;
        cold += status == OFC_STATUS_COLD_START_NEEDED;
        /* After enough frames of the ball, nothing is left of the others. */
        if (clean > 8)
            compared += compare(&truth);
        if (one_in(500)) {
            assert_int_equal(ofc_stream_restart(stream), OFC_STATUS_OK);
            assert_int_equal(ofc_stream_restart(twin), OFC_STATUS_OK);
        }
        check_guard();
    }
    printf("%ld frames: %ld whole, %ld refined the model, %ld asked for a cold start, %ld solutions compared\n", frames, whole, refined,
           cold, compared);
    assert_true(refined > frames / 2 && cold > frames / 200 && compared > frames / 10);
}

static long frames_to_give(void)
{
    const char *const text = getenv("OFC_SOAK_FRAMES");
    return text != NULL ? strtol(text, NULL, 10) : FRAMES;
}

static void soak_direct(void **state)
{
    (void)state;
    soak(fresh, frames_to_give());
}

static void soak_joint(void **state)
{
    (void)state;
    soak(fresh_joint, frames_to_give() / 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(soak_direct), cmocka_unit_test(soak_joint)};
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
