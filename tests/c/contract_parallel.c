/* Work in parts: the same bits on any number of threads and whatever the caller's function does with the parts. */
#include "contract.h"

#include <pthread.h>

enum { WIDE = 6 * WIDTH, TALL = 6 * HEIGHT, PADDED = WIDE + 3, MOST_THREADS = 16 };

/* The ball, every pixel of it six times as wide and as high. */
static uint8_t large[TALL][WIDE][3], mask[TALL][WIDE];

struct outputs {
    float normals[TALL][PADDED][3];
    float angles[TALL][PADDED];
};
static struct outputs wanted, found;

static ofc_solution solution;

static ofc_image large_image(void)
{
    return (ofc_image){.pixels = large,
                       .width = WIDE,
                       .height = TALL,
                       .row_stride_bytes = sizeof large[0],
                       .format = OFC_PIXEL_RGB8,
                       .mask = mask[0],
                       .mask_stride_bytes = sizeof mask[0]};
}

static int prepare(void **state)
{
    const int failed = prepare_jointly(state, &solution);
    for (int y = 0; y < TALL; y++)
        for (int x = 0; x < WIDE; x++) {
            memcpy(large[y][x], ball[y / 6][x / 6], 3);
            mask[y][x] = (x * y) % 17 != 3;
        }
    return failed;
}

/* Computes all that there is into `found`. */
static void compute(const ofc_parallel *parallel)
{
    const ofc_image image = large_image();
    memset(&found, PATTERN, sizeof found);
    assert_int_equal(ofc_normals_compute_parallel(&image, &solution, found.normals[0][0], sizeof found.normals[0], parallel),
                     OFC_STATUS_OK);
    assert_int_equal(ofc_normals_uncertainty_parallel(&image, &solution, found.angles[0], sizeof found.angles[0], parallel),
                     OFC_STATUS_OK);
}

static void compute_as_a_whole(void)
{
    const ofc_image image = large_image();
    memset(&wanted, PATTERN, sizeof wanted);
    assert_int_equal(ofc_normals_compute(&image, &solution, wanted.normals[0][0], sizeof wanted.normals[0]), OFC_STATUS_OK);
    assert_int_equal(ofc_normals_uncertainty(&image, &solution, wanted.angles[0], sizeof wanted.angles[0]), OFC_STATUS_OK);
}

/* ---- Threads ---------------------------------------------------------------------------------------------------- */

struct batch {
    ofc_part part;
    void *work;
    int32_t next, count;
    pthread_mutex_t lock;
};

static void *take_parts(void *argument)
{
    struct batch *batch = argument;
    for (;;) {
        pthread_mutex_lock(&batch->lock);
        const int32_t i = batch->next++;
        pthread_mutex_unlock(&batch->lock);
        if (i >= batch->count)
            return NULL;
        batch->part(batch->work, i);
    }
}

struct pool {
    int threads, batches, parts;
};

static void run_on_threads(void *context, ofc_part part, void *work, int32_t count)
{
    struct pool *pool = context;
    struct batch batch = {part, work, 0, count, PTHREAD_MUTEX_INITIALIZER};
    pthread_t threads[MOST_THREADS];
    pool->batches++;
    pool->parts += count;
    for (int i = 0; i < pool->threads; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, take_parts, &batch), 0);
    for (int i = 0; i < pool->threads; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
}

static void any_number_of_threads_writes_the_same_bits(void **state)
{
    (void)state;
    compute_as_a_whole();
    compute(NULL);
    assert_memory_equal(&found, &wanted, sizeof found);
    const int threads[] = {1, 2, 3, 16};
    for (int i = 0; i < 4; i++) {
        struct pool pool = {threads[i], 0, 0};
        const ofc_parallel parallel = {.run = run_on_threads, .context = &pool};
        compute(&parallel);
        assert_memory_equal(&found, &wanted, sizeof found);
        assert_true(pool.batches >= 2 && pool.parts > 16 * pool.batches && pool.parts <= 32 * pool.batches);
    }
}

/* ---- Functions that do not do what they should ------------------------------------------------------------------- */

static void run_nothing(void *context, ofc_part part, void *work, int32_t count)
{
    (void)context, (void)part, (void)work, (void)count;
}

static void run_some(void *context, ofc_part part, void *work, int32_t count)
{
    (void)context;
    for (int32_t i = count - 1; i >= 0; i -= 3)
        part(work, i);
}

static void run_twice(void *context, ofc_part part, void *work, int32_t count)
{
    run_on_threads(context, part, work, count);
    run_some(context, part, work, count);
}

static void run_what_is_not_there(void *context, ofc_part part, void *work, int32_t count)
{
    const int32_t wrong[] = {-1, count, 31, 32, 33, 64, 1 << 20, INT32_MIN, INT32_MAX};
    (void)context;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        part(work, wrong[i]);
    part(work, 1);
}

static void run_the_same_at_once(void *context, ofc_part part, void *work, int32_t count)
{
    /* Every thread wants all parts. */
    pthread_t threads[4];
    struct batch batches[4];
    (void)context;
    for (int i = 0; i < 4; i++) {
        batches[i] = (struct batch){part, work, 0, count, PTHREAD_MUTEX_INITIALIZER};
        assert_int_equal(pthread_create(&threads[i], NULL, take_parts, &batches[i]), 0);
    }
    for (int i = 0; i < 4; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
}

static void sloppy_functions_do_no_harm(void **state)
{
    (void)state;
    compute_as_a_whole();
    struct pool pool = {2, 0, 0};
    void (*const sloppy[])(void *, ofc_part, void *, int32_t) = {run_nothing, run_some, run_twice, run_what_is_not_there,
                                                                 run_the_same_at_once};
    for (size_t i = 0; i < sizeof sloppy / sizeof sloppy[0]; i++) {
        const ofc_parallel parallel = {.run = sloppy[i], .context = &pool};
        compute(&parallel);
        assert_memory_equal(&found, &wanted, sizeof found);
    }
}

/* ---- What is refused, and rows without it ------------------------------------------------------------------------- */

#define NORMALS(solution, normals, stride, parallel) ofc_normals_compute_parallel(&image, solution, normals, stride, parallel)
#define ANGLES(solution, angles, stride, parallel) ofc_normals_uncertainty_parallel(&image, solution, angles, stride, parallel)

static const ofc_parallel some = {.run = run_some};

static ofc_status normals(const ofc_image *image)
{
    return ofc_normals_compute_parallel(image, &solution, found.normals[0][0], sizeof found.normals[0], &some);
}

static ofc_status angles(const ofc_image *image)
{
    return ofc_normals_uncertainty_parallel(image, &solution, found.angles[0], sizeof found.angles[0], &some);
}

static void refused(void **state)
{
    (void)state;
    refuses_bad_images(normals, &found, sizeof found);
    refuses_bad_images(angles, &found, sizeof found);
    const ofc_image image = large_image();
    const ofc_parallel without = {.context = &found};
    float *const out = found.normals[0][0], *const flat = found.angles[0];
    const size_t row = sizeof found.normals[0], flat_row = sizeof found.angles[0];
    REFUSED(OFC_STATUS_NULL_POINTER, found, NORMALS(&solution, out, row, &without));
    REFUSED(OFC_STATUS_MISALIGNED, found, NORMALS(&solution, out, row, MISALIGNED(&some)));
    REFUSED(OFC_STATUS_NULL_POINTER, found, NORMALS(NULL, out, row, &some));
    REFUSED(OFC_STATUS_NULL_POINTER, found, NORMALS(&solution, NULL, row, &some));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, found, NORMALS(&solution, out, 12 * WIDE - 4, &some));
    REFUSED(OFC_STATUS_NULL_POINTER, found, ANGLES(&solution, flat, flat_row, &without));
    REFUSED(OFC_STATUS_MISALIGNED, found, ANGLES(&solution, flat, flat_row, MISALIGNED(&some)));
    REFUSED(OFC_STATUS_NULL_POINTER, found, ANGLES(NULL, flat, flat_row, &some));
    REFUSED(OFC_STATUS_NULL_POINTER, found, ANGLES(&solution, NULL, flat_row, &some));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, found, ANGLES(&solution, flat, 4 * WIDE - 4, &some));
    REFUSED(OFC_STATUS_NO_COVARIANCE, found, ANGLES(&stages.solution, flat, flat_row, &some));
    static union {
        ofc_parallel parallel;
        float normals[TALL * WIDE * 3];
    } mixed;
    mixed.parallel = some;
    REFUSED(OFC_STATUS_OVERLAP, found, NORMALS(&solution, mixed.normals, 12 * WIDE, &mixed.parallel));
    REFUSED(OFC_STATUS_OVERLAP, found, ANGLES(&solution, mixed.normals, 4 * WIDE, &mixed.parallel));
}

/* As the header says of threads: a call for each part of the rows. */
static void rows_can_be_split_without_it(void **state)
{
    (void)state;
    compute_as_a_whole();
    memset(&found, PATTERN, sizeof found);
    for (int y = 0; y < TALL; y += 77) {
        ofc_image rows = large_image();
        rows.pixels = large[y];
        rows.mask = mask[y];
        rows.height = y + 77 < TALL ? 77 : TALL - y;
        assert_int_equal(ofc_normals_compute(&rows, &solution, found.normals[y][0], sizeof found.normals[0]), OFC_STATUS_OK);
        assert_int_equal(ofc_normals_uncertainty(&rows, &solution, found.angles[y], sizeof found.angles[0]), OFC_STATUS_OK);
    }
    assert_memory_equal(&found, &wanted, sizeof found);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_writes_the_same_bits),
        cmocka_unit_test(sloppy_functions_do_no_harm),
        cmocka_unit_test(refused),
        cmocka_unit_test(rows_can_be_split_without_it),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
