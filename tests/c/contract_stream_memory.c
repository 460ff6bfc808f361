/* ofc_stream_*: the memory and the stack that streams take, and no more. */
#include "stream.h"

#include <pthread.h>
#include <stdlib.h>

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
        cmocka_unit_test_setup(sizes_and_defaults, fresh),
        cmocka_unit_test_setup(exact_memory, fresh),
        cmocka_unit_test_setup(exact_memory, fresh_joint),
        cmocka_unit_test_setup(stack_use, fresh),
        cmocka_unit_test_setup(stack_use, fresh_joint),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
