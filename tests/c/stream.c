#include "stream.h"

uint64_t memory[SIZE / sizeof(uint64_t)];
ofc_stream_params params;
ofc_stream *stream;
struct stream_outputs out;

ofc_image row_of(uint8_t picture[HEIGHT][WIDTH][3], int y)
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

int fresh(void **state)
{
    (void)state;
    return fresh_on(OFC_ORIENTATION_DIRECT);
}

int fresh_joint(void **state)
{
    (void)state;
    return fresh_on(OFC_ORIENTATION_JOINT);
}

ofc_status frame_of(ofc_stream *s, uint8_t picture[HEIGHT][WIDTH][3], ofc_stream_pass *next)
{
    assert_int_equal(ofc_stream_begin(s, NULL), OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++) {
        const ofc_image row = row_of(picture, y);
        assert_int_equal(ofc_stream_row(s, y, &row), OFC_STATUS_OK);
    }
    return ofc_stream_end(s, next);
}

void solve_cold(ofc_stream *s)
{
    ofc_stream_pass next = OFC_PASS_COLORS;
    for (int frame = 0; frame < 5 && next != OFC_PASS_REFINE; frame++)
        assert_int_equal(frame_of(s, ball, &next), OFC_STATUS_OK);
    assert_int_equal(next, OFC_PASS_REFINE);
}
