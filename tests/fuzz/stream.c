/* Any sequence of calls on a stream, made twice in memories of different dirt. */
#include "fuzz.h"

enum { TWO = 2, HEAD = 32 };

static ofc_stream *streams[TWO];
static void *memories[TWO];
static size_t need;
static ofc_image frame, *row;
static int32_t width, height, next_row;
static int is_open;

/* Makes a call on both streams, whose outcomes must be the same. */
#define BOTH(status, call, out0, out1)                                                                                 \
    do {                                                                                                               \
        ofc_status each[TWO];                                                                                          \
        for (int i = 0; i < TWO; i++) {                                                                                \
            ofc_stream *const stream = streams[i];                                                                     \
            each[i] = CALL(call, memories[i], i == 0 ? (out0) : (out1));                                               \
        }                                                                                                              \
        if (each[0] != each[1])                                                                                        \
            fail(#call ": %d and %d", each[0], each[1]);                                                               \
        (status) = each[0];                                                                                            \
    } while (0)

static void row_at(int32_t y)
{
    const size_t at = (size_t)y * frame.row_stride_bytes;
    *row = frame;
    row->height = 1;
    row->pixels = (const uint8_t *)frame.pixels + at;
    if (frame.green_plane != NULL) {
        row->green_plane = (const uint8_t *)frame.green_plane + at;
        row->blue_plane = (const uint8_t *)frame.blue_plane + at;
    }
    if (frame.mask != NULL)
        row->mask = frame.mask + (size_t)y * frame.mask_stride_bytes;
}

static void give_row(int32_t y, int spoiled)
{
    ofc_status status;
    row_at(y >= 0 && y < height ? y : 0);
    if (spoiled)
        row->width -= 1 + below(3);
    BOTH(status, ofc_stream_row(stream, y, row), memories[i], memories[i]);
    if (status == OFC_STATUS_OK && (!is_open || y != next_row || y >= height || spoiled))
        fail("row %d was taken, and %d was next of %d", y, next_row, height);
    if (status != OFC_STATUS_OK && is_open && y == next_row && y < height && !spoiled)
        fail("row %d of %d was refused: %d", y, height, status);
    next_row += status == OFC_STATUS_OK;
}

static void begin(void)
{
    ofc_status status;
    ofc_stream_pass *const pass[TWO] = {TAKE(ofc_stream_pass, 1), TAKE(ofc_stream_pass, 1)};
    BOTH(status, ofc_stream_begin(stream, pass[i]), pass[0], pass[1]);
    if (status != OFC_STATUS_OK || *pass[0] != *pass[1] || *pass[0] < OFC_PASS_COLORS || *pass[0] > OFC_PASS_INTEGRABILITY)
        fail("a frame began with %d, passes %d and %d", status, *pass[0], *pass[1]);
    is_open = 1;
    next_row = 0;
}

static ofc_stream_pass end(void)
{
    ofc_status status;
    ofc_stream_pass *const pass[TWO] = {TAKE(ofc_stream_pass, 1), TAKE(ofc_stream_pass, 1)};
    *pass[0] = *pass[1] = 0;
    BOTH(status, ofc_stream_end(stream, pass[i]), pass[0], pass[1]);
    const int whole = is_open && next_row == height;
    if ((status == OFC_STATUS_TOO_FEW_ROWS) != (is_open && !whole) || (status == OFC_STATUS_NO_FRAME) == is_open || *pass[0] != *pass[1])
        fail("a frame with %d rows of %d ended with %d", next_row, height, status);
    is_open = 0;
    return *pass[0];
}

static void whole_frame(void)
{
    begin();
    for (int32_t y = 0; y < height; y++)
        give_row(y, 0);
    (void)end();
}

static void results(void)
{
    ofc_status status;
    ofc_solution *const solutions[TWO] = {TAKE(ofc_solution, 1), TAKE(ofc_solution, 1)};
    BOTH(status, ofc_stream_solution(stream, solutions[i]), solutions[0], solutions[1]);
    if (status >= 0) {
        check_solution("stream", solutions[0], status);
        if (memcmp(solutions[0], solutions[1], sizeof *solutions[0]) != 0)
            fail("two solutions of the same frames");
    }
    ofc_stream_drift *const drifts[TWO] = {TAKE(ofc_stream_drift, 1), TAKE(ofc_stream_drift, 1)};
    BOTH(status, ofc_stream_drift_get(stream, drifts[i]), drifts[0], drifts[1]);
    if (status >= 0) {
        finite_or_nan("drift", DOUBLES(drifts[0], inlier_ratio, refined));
        if (memcmp(drifts[0], drifts[1], sizeof *drifts[0]) != 0)
            fail("two drifts of the same frames");
    }
}

static void normals(void)
{
    ofc_status status;
    const size_t pixels = (size_t)width;
    row_at(below(height));
    if (one_in(16))
        row->format = any_int();
    float *const floats[TWO] = {TAKE(float, 3 * pixels), TAKE(float, 3 * pixels)};
    BOTH(status, ofc_stream_normals_row(stream, row, floats[i]), floats[0], floats[1]);
    if (status == OFC_STATUS_OK) {
        unit_normals("stream", floats[0], 0, width, 1);
#ifdef PLANTED_FAULT
        if (floats[0][pixels / 2 * 3 + 2] > 0.9f)
            floats[1][3 * pixels - 1] = 2;
#endif
        if (memcmp(floats[0], floats[1], 3 * pixels * sizeof(float)) != 0)
            fail("two rows of normals of the same frames");
    }
    uint8_t *const bytes[TWO] = {take(3 * pixels, 1), take(3 * pixels, 1)};
    BOTH(status, ofc_stream_normals_row_packed(stream, row, bytes[i]), bytes[0], bytes[1]);
    if (status == OFC_STATUS_OK && memcmp(bytes[0], bytes[1], 3 * pixels) != 0)
        fail("two rows of packed normals of the same frames");
    uint8_t *const flags[TWO] = {take(pixels, 1), take(pixels, 1)};
    BOTH(status, ofc_stream_inliers_row(stream, row, flags[i]), flags[0], flags[1]);
    if (status == OFC_STATUS_OK && memcmp(flags[0], flags[1], pixels) != 0)
        fail("two rows of inliers of the same frames");
}

/* A stream goes on at another address. */
static void move(void)
{
    void *const memory = workspace_of(need);
    memcpy(memory, memories[0], need);
    memset(memories[0], 0xee, need);
    memories[0] = memory;
    streams[0] = memory;
}

/* A head that is no stream's is told, and nothing is followed. */
static void overwrite_head(void)
{
    uint8_t head[HEAD];
    memcpy(head, memories[0], HEAD);
    ((uint8_t *)memories[0])[below(HEAD)] ^= (uint8_t)(1 + below(255));
    if (CALL(ofc_stream_end(streams[0], NULL), NULL) != OFC_STATUS_NO_STREAM)
        fail("an overwritten head passed for a stream");
    memcpy(memories[0], head, HEAD);
}

static int make(const struct picture *picture)
{
    ofc_stream_params *const params = TAKE(ofc_stream_params, 1);
    ofc_stream_params_default(params);
    params->solve.lmeds.subsets = 8 + (uint32_t)below(24);
    params->solve.orientation_method = below(2);
    params->solve.lmeds.sample_size = one_in(2) ? 24 + byte() : 2048;
    params->refine_pixels = one_in(2) ? 16 * byte() : params->refine_pixels;
    change_some(params, sizeof *params);
    if (!shorten(&params->solve.lmeds))
        return 0;
    const ofc_pixel_format format = one_in(64) ? any_int() : picture->image->format;
    need = ofc_stream_size(width, height, params);
    const size_t given = need > 0 && one_in(64) ? (must_be_refused(), need - 1) : need;
    ofc_stream **const made = TAKE(ofc_stream *, 1);
    for (int i = 0; i < TWO; i++) {
        memories[i] = workspace_of(given);
        if (CALL(ofc_stream_init(width, height, format, BAD(params, NULL), bad_sometimes(memories[i], 8, params), given, BAD(made, params)),
                 memories[i], made) != OFC_STATUS_OK)
            return 0;
        streams[i] = *made;
        if ((void *)streams[i] != memories[i])
            fail("a stream is not where its memory is");
    }
    /* Any integer may be another format, whose rows these are not. */
    return format == picture->image->format;
}

void target(void)
{
    const int large = one_in(4);
    const struct picture picture = large ? picture_sized(60 + below(16), 60 + below(16)) : picture_of(28, 28);
    width = picture.width;
    height = picture.height;
    frame = *picture.image;
    row = TAKE(ofc_image, 1);
    *row = frame;
    is_open = next_row = 0;
    if (picture.bad || !make(&picture))
        return;
    const int first_frames = below(6);
    for (int i = 0; i < first_frames; i++)
        whole_frame();
    for (int step = 0; step < 4; step++) {
        ofc_status status;
        switch (below(16)) {
        case 0: results(); break;
        case 1: normals(); break;
        case 2: whole_frame(); break;
        case 3: begin(); break;
        case 4: give_row(next_row, 0); break;
        case 5: give_row(any_int(), 0); break;
        case 6: give_row(next_row, 1); break;
        case 7: (void)end(); break;
        case 8:
            BOTH(status, ofc_stream_restart(stream), memories[i], memories[i]);
            is_open = 0;
            if (status != OFC_STATUS_OK)
                fail("restart: %d", status);
            break;
        case 9: move(); break;
        case 10: overwrite_head(); break;
        case 11:
            begin();
            for (int32_t y = below(height); next_row < y;)
                give_row(next_row, 0);
            break;
        default: results(); break;
        }
    }
}
