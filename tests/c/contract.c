#include "contract.h"

uint8_t ball[HEIGHT][WIDTH][3];
struct stages stages;
uint64_t workspace[OFC_SOLVE_WORKSPACE_SIZE(WIDTH, HEIGHT) / sizeof(uint64_t)];

void render_ball(void)
{
    static const double lights[3][3] = {{0.5, 0.2, 0.842615}, {-0.4, 0.4, 0.824621}, {0.1, -0.5, 0.860233}};
    static const double colors[3][3] = {{150, 20, 35}, {30, 140, 25}, {25, 40, 150}};
    const double radius = 0.45 * HEIGHT;
    memset(ball, 0, sizeof ball);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const double u = (x + 0.5 - WIDTH / 2.0) / radius, v = (HEIGHT / 2.0 - y - 0.5) / radius;
            if (u * u + v * v >= 0.8)
                continue;
            const double w = sqrt(1 - u * u - v * v);
            for (int c = 0; c < 3; c++) {
                double value = 0.5;
                for (int l = 0; l < 3; l++)
                    value += colors[l][c] * fmax(0, lights[l][0] * u + lights[l][1] * v + lights[l][2] * w);
                ball[y][x][c] = (uint8_t)value;
            }
        }
}

ofc_image ball_image(void)
{
    ofc_image image = {.pixels = ball,
                       .width = WIDTH,
                       .height = HEIGHT,
                       .row_stride_bytes = sizeof ball[0],
                       .format = OFC_PIXEL_RGB8};
    return image;
}

int prepare_stages(void **state)
{
    (void)state;
    render_ball();
    const ofc_image image = ball_image();
    ofc_solve_params_default(&stages.params);
    stages.params.orientation_method = OFC_ORIENTATION_DIRECT;
    const ofc_status fitted = ofc_lmeds_fit(&image, &stages.params.lmeds, workspace, sizeof workspace, &stages.fit,
                                            &stages.inliers);
    const ofc_status solved =
        ofc_solve(&image, &stages.params, workspace, sizeof workspace, NULL, &stages.solution);
    return fitted == OFC_STATUS_OK && solved == OFC_STATUS_OK ? 0 : -1;
}

int prepare_jointly(void **state, ofc_solution *solution)
{
    const int failed = prepare_stages(state);
    const ofc_image image = ball_image();
    ofc_solve_params params = stages.params;
    params.orientation_method = OFC_ORIENTATION_JOINT;
    params.tilt_estimator = OFC_TILT_PENTLAND;
    return failed || ofc_solve(&image, &params, workspace, sizeof workspace, NULL, solution) != OFC_STATUS_OK;
}

int is_untouched(const void *bytes, size_t count)
{
    const uint8_t *byte = bytes;
    while (count-- > 0)
        if (*byte++ != PATTERN)
            return 0;
    return 1;
}

static void refuses(image_call call, const ofc_image *image, ofc_status expected, void *outputs, size_t size)
{
    memset(outputs, PATTERN, size);
    assert_int_equal(call(image), expected);
    assert_true(is_untouched(outputs, size));
}

void refuses_bad_images(image_call call, void *outputs, size_t size)
{
    static uint8_t mask[PIXELS];
    struct {
        ofc_image image;
        ofc_status expected;
    } bad[19];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        bad[i].image = ball_image();
    size_t n = 0;
#define BAD(status, field, value) (bad[n].image.field = (value), bad[n++].expected = (status))
    BAD(OFC_STATUS_NULL_POINTER, pixels, NULL);
    BAD(OFC_STATUS_EMPTY, width, 0);
    BAD(OFC_STATUS_EMPTY, width, -WIDTH);
    BAD(OFC_STATUS_EMPTY, height, 0);
    BAD(OFC_STATUS_EMPTY, height, INT32_MIN);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, row_stride_bytes, 3 * WIDTH - 1);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, row_stride_bytes, 0);
    BAD(OFC_STATUS_TOO_LARGE, row_stride_bytes, SIZE_MAX);
    BAD(OFC_STATUS_TOO_LARGE, row_stride_bytes, SIZE_MAX / (HEIGHT - 1));
    BAD(OFC_STATUS_TOO_LARGE, row_stride_bytes, PTRDIFF_MAX);
    BAD(OFC_STATUS_UNKNOWN_FORMAT, format, 0);
    BAD(OFC_STATUS_UNKNOWN_FORMAT, format, 6);
    BAD(OFC_STATUS_UNKNOWN_FORMAT, format, -1);
    BAD(OFC_STATUS_UNKNOWN_FORMAT, format, INT32_MAX);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved, 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, green_plane, ball);
    BAD(OFC_STATUS_INVALID_PARAMETER, blue_plane, ball);
    bad[n].image.height = INT32_MAX;
    BAD(OFC_STATUS_TOO_LARGE, width, INT32_MAX);
    bad[n].image.mask = mask;
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, mask_stride_bytes, WIDTH - 1);
#undef BAD
    assert_int_equal(n, sizeof bad / sizeof *bad);
    for (size_t i = 0; i < n; i++)
        refuses(call, &bad[i].image, bad[i].expected, outputs, size);

    ofc_image planes = ball_image();
    planes.format = OFC_PIXEL_PLANES8;
    planes.green_plane = ball;
    refuses(call, &planes, OFC_STATUS_NULL_POINTER, outputs, size);
    planes.green_plane = NULL;
    planes.blue_plane = ball;
    refuses(call, &planes, OFC_STATUS_NULL_POINTER, outputs, size);

    static union {
        ofc_image aligned;
        uint8_t bytes[sizeof(ofc_image) + 1];
    } shifted;
    const ofc_image good = ball_image();
    memcpy(shifted.bytes + 1, &good, sizeof good);
    refuses(call, (const ofc_image *)MISALIGNED(&shifted), OFC_STATUS_MISALIGNED, outputs, size);
    refuses(call, NULL, OFC_STATUS_NULL_POINTER, outputs, size);
}
