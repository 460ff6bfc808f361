/* The seam between pointers and slices against a model of it, over every case of a small domain: where buffers begin, how large they
 * are, how far apart their rows. And sizes: each function against its macro. */
#include "contract.h"

enum { ARENA = 96, PLACES = 40, SIDES = 3, UNTOUCHED = 0x5a };

/* Aligned for everything. */
static union {
    uint64_t aligned[ARENA / 8];
    uint8_t bytes[ARENA];
} arena;

static uint8_t before[ARENA];

static void dirty(void)
{
    for (int i = 0; i < ARENA; i++)
        arena.bytes[i] = (uint8_t)(UNTOUCHED ^ i * 29);
    memcpy(before, arena.bytes, ARENA);
}

/* The address at a place of the arena; NULL for the place after the last. */
static void *address(int place)
{
    return place == PLACES ? NULL : arena.bytes + place;
}

static int overlap(int first, int first_bytes, int second, int second_bytes)
{
    return first < second + second_bytes && second < first + first_bytes;
}

/* Nothing but so many bytes from a place on have changed. */
static void only_these_changed(int place, int bytes)
{
    for (int i = 0; i < ARENA; i++)
        if (i < place || i >= place + bytes)
            assert_int_equal(arena.bytes[i], before[i]);
}

/* Words in, bytes out, rows without gaps. */
static ofc_status expected_mark(int labels, int32_t width, int32_t height, int mask)
{
    if (width <= 0 || height <= 0)
        return OFC_STATUS_EMPTY;
    if (labels == PLACES)
        return OFC_STATUS_NULL_POINTER;
    if (labels % 2 != 0)
        return OFC_STATUS_MISALIGNED;
    if (mask == PLACES)
        return OFC_STATUS_NULL_POINTER;
    return overlap(labels, 2 * width * height, mask, width * height) ? OFC_STATUS_OVERLAP : OFC_STATUS_OK;
}

static void words_and_bytes(void **state)
{
    (void)state;
    int taken = 0, overlapping = 0;
    for (int labels = 0; labels <= PLACES; labels++)
        for (int mask = 0; mask <= PLACES; mask++)
            for (int32_t width = -1; width <= SIDES; width++)
                for (int32_t height = -1; height <= SIDES; height++) {
                    dirty();
                    const ofc_status expected = expected_mark(labels, width, height, mask);
                    assert_int_equal(ofc_segment_mark(address(labels), width, height, 1, address(mask)), expected);
                    only_these_changed(mask, expected == OFC_STATUS_OK ? width * height : 0);
                    taken += expected == OFC_STATUS_OK;
                    overlapping += expected == OFC_STATUS_OVERLAP;
                }
    assert_true(taken > 3000 && overlapping > 1000);
}

/* A picture with rows of any stride in, bytes out. The mask of the picture has rows of its own. */
static ofc_status expected_apply(int pixels, int32_t width, int32_t height, int stride, int out)
{
    if (stride < 3 * width)
        return OFC_STATUS_STRIDE_TOO_SMALL;
    if (pixels == PLACES || out == PLACES)
        return OFC_STATUS_NULL_POINTER;
    return overlap(pixels, stride * (height - 1) + 3 * width, out, width * height) ? OFC_STATUS_OVERLAP : OFC_STATUS_OK;
}

static void rows_with_gaps(void **state)
{
    (void)state;
    int taken = 0, overlapping = 0;
    for (int pixels = 0; pixels <= PLACES; pixels += 8)
        for (int out = 0; out <= PLACES; out++)
            for (int32_t width = 1; width <= SIDES; width++)
                for (int32_t height = 1; height <= SIDES; height++)
                    for (int stride = 0; stride <= 13; stride++) {
                        dirty();
                        const ofc_image image = {.pixels = address(pixels),
                                                 .width = width,
                                                 .height = height,
                                                 .row_stride_bytes = (size_t)stride,
                                                 .format = OFC_PIXEL_RGB8};
                        const ofc_status expected = expected_apply(pixels, width, height, stride, out);
                        const ofc_status status = ofc_inlier_test_apply(&image, NULL, address(out), NULL);
                        /* Which of two faults is told is not said. */
                        if (expected == OFC_STATUS_OK || expected == OFC_STATUS_OVERLAP)
                            assert_int_equal(status, expected);
                        else
                            assert_true(status == OFC_STATUS_STRIDE_TOO_SMALL || status == OFC_STATUS_NULL_POINTER);
                        only_these_changed(out, expected == OFC_STATUS_OK ? width * height : 0);
                        taken += expected == OFC_STATUS_OK;
                        overlapping += expected == OFC_STATUS_OVERLAP;
                    }
    assert_true(taken > 3000 && overlapping > 2000);
}

/* Strides near the ends of their range: the last row ends beyond the address space, or just within. */
static void strides_of_any_size(void **state)
{
    (void)state;
    static uint8_t out[4];
    for (int32_t height = 2; height <= 4; height++)
        for (size_t less = 0; less < 70; less++) {
            const size_t strides[] = {SIZE_MAX - less, SIZE_MAX / (size_t)(height - 1) - less, PTRDIFF_MAX - less % 3,
                                      PTRDIFF_MAX / (size_t)(height - 1) + 1 + less};
            for (size_t i = 0; i < sizeof strides / sizeof *strides; i++) {
                const ofc_image image = {
                    .pixels = arena.bytes, .width = 1, .height = height, .row_stride_bytes = strides[i], .format = OFC_PIXEL_RGB8};
                REFUSED(OFC_STATUS_TOO_LARGE, out, ofc_inlier_test_apply(&image, NULL, out, NULL));
            }
        }
}

static void sizes_of(int32_t width, int32_t height)
{
    const int is_size = width > 0 && height > 0 && (int64_t)width * height <= INT32_MAX;
#define SAME(size, macro) assert_int_equal((size), is_size ? (macro) : 0)
    SAME(ofc_norm_location_workspace_size(width, height), OFC_NORM_LOCATION_WORKSPACE_SIZE(width, height));
    SAME(ofc_largest_disc_workspace_size(width, height), OFC_LARGEST_DISC_WORKSPACE_SIZE(width, height));
    SAME(ofc_check_workspace_size(width, height), OFC_CHECK_WORKSPACE_SIZE(width, height));
    SAME(ofc_segment_workspace_size(width, height), OFC_SEGMENT_WORKSPACE_SIZE(width, height));
    SAME(ofc_paint_albedo_workspace_size(width, height), OFC_PAINT_ALBEDO_WORKSPACE_SIZE(width, height));
    if (!is_size || (int64_t)width * height < 1 << 29) {
        SAME(ofc_depth_workspace_size(width, height), OFC_DEPTH_WORKSPACE_SIZE(width, height));
        SAME(ofc_surface_workspace_size(width, height), OFC_SURFACE_WORKSPACE_SIZE(width, height));
    }
    static const uint32_t samples[] = {24, 25, 1000, 10000, UINT32_MAX};
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
        const uint32_t sample = samples[i];
        ofc_solve_params solve = stages.params;
        ofc_annealing_params annealing;
        ofc_annealing_params_default(&annealing);
        solve.lmeds.sample_size = annealing.sample_cells = sample;
        SAME(ofc_solve_workspace_size(width, height, &solve), OFC_SOLVE_WORKSPACE_SIZE_FOR(width, height, sample));
        SAME(ofc_lmeds_workspace_size(width, height, &solve.lmeds), OFC_LMEDS_WORKSPACE_SIZE_FOR(width, height, sample));
        SAME(ofc_orthogonal_annealing_workspace_size(width, height, &annealing),
             OFC_ORTHOGONAL_ANNEALING_WORKSPACE_SIZE(width, height, sample));
        SAME(ofc_constrained_slants_integrable_workspace_size(width, height, sample),
             OFC_CONSTRAINED_SLANTS_INTEGRABLE_WORKSPACE_SIZE(width, height, sample));
        ofc_stream_params stream;
        ofc_stream_params_default(&stream);
        stream.solve.lmeds.sample_size = sample;
        const size_t memory = ofc_stream_size(width, height, &stream);
        assert_true(is_size ? memory > 0 && memory <= OFC_STREAM_SIZE_FOR(width, height, sample) : memory == 0);
    }
}

static void sizes(void **state)
{
    (void)state;
    static const int32_t ends[] = {INT32_MIN,     -1,    0,     1,     2,      3,       639,     640,          46340,
                                   46341,         65535, 65536, 65537, 1 << 20, 1 << 24, 1 << 30, INT32_MAX - 1, INT32_MAX};
    for (int32_t width = -1; width <= 70; width++)
        for (int32_t height = -1; height <= 70; height++)
            sizes_of(width, height);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        for (size_t k = 0; k < sizeof ends / sizeof *ends; k++)
            sizes_of(ends[i], ends[k]);
    for (size_t count = 1; count < 1000; count++)
        assert_int_equal(ofc_location_workspace_size(count), OFC_LOCATION_WORKSPACE_SIZE(count));
    assert_int_equal(ofc_location_workspace_size(0), 0);
    assert_int_equal(ofc_location_workspace_size(SIZE_MAX), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_and_bytes),
        cmocka_unit_test(rows_with_gaps),
        cmocka_unit_test(strides_of_any_size),
        cmocka_unit_test(sizes),
    };
    return cmocka_run_group_tests(tests, prepare_stages, NULL);
}
