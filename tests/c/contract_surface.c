/* The whole surface. */
#include "contract.h"

enum { PADDED = WIDTH + 5 };

static struct {
    ofc_surface_params params;
    ofc_surface_result result;
    float normals[HEIGHT][3 * WIDTH + 2];
    float angles[HEIGHT][PADDED];
    float depths[HEIGHT][PADDED];
    uint8_t classes[HEIGHT][PADDED];
} out;

static ofc_surface_params params;
static ofc_solution solution;
static uint64_t space[OFC_SURFACE_WORKSPACE_SIZE(WIDTH, HEIGHT) / 8 + 1];
static const size_t rows[4] = {sizeof out.normals[0], sizeof out.angles[0], sizeof out.depths[0], PADDED};

static int prepare(void **state)
{
    return prepare_jointly(state, &solution) || ofc_surface_params_default(&params) != OFC_STATUS_OK;
}

#define OUTPUTS out.normals[0], rows[0], out.angles[0], rows[1], out.depths[0], rows[2], out.classes[0], rows[3], &out.result

static ofc_status complete(const ofc_image *image)
{
    return ofc_surface_complete(image, &solution, &params, space, sizeof space, OUTPUTS);
}

static void refused(void **state)
{
    (void)state;
    refuses_bad_images(complete, &out, sizeof out);
    const ofc_image image = ball_image();
    const size_t need = ofc_surface_workspace_size(WIDTH, HEIGHT);
    assert_int_equal(need, OFC_SURFACE_WORKSPACE_SIZE(WIDTH, HEIGHT));
    assert_int_equal(ofc_surface_workspace_size(0, HEIGHT), 0);
    assert_int_equal(ofc_surface_workspace_size(WIDTH, -1), 0);
    assert_int_equal(ofc_surface_workspace_size(INT32_MAX, INT32_MAX), 0);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_surface_params_default(NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_surface_params_default(MISALIGNED(&out.params)));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_surface_complete(&image, NULL, &params, space, need, OUTPUTS));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_surface_complete(&image, &solution, NULL, space, need, OUTPUTS));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_surface_complete(&image, &solution, &params, NULL, need, OUTPUTS));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_surface_complete(&image, MISALIGNED(&solution), &params, space, need, OUTPUTS));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_surface_complete(&image, &solution, MISALIGNED(&params), space, need, OUTPUTS));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_surface_complete(&image, &solution, &params, MISALIGNED(space), need, OUTPUTS));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, ofc_surface_complete(&image, &solution, &params, space, need - 1, OUTPUTS));

    float *const normals = out.normals[0], *const angles = out.angles[0], *const depths = out.depths[0];
    uint8_t *const classes = out.classes[0];
#define WITH(n, s0, a, s1, d, s2, c, s3, r)                                                                            \
    ofc_surface_complete(&image, &solution, &params, space, need, n, s0, a, s1, d, s2, c, s3, r)
    const size_t s0 = rows[0], s1 = rows[1], s2 = rows[2], s3 = rows[3];
    ofc_surface_result *const r = &out.result;
    REFUSED(OFC_STATUS_NULL_POINTER, out, WITH(NULL, s0, angles, s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_NULL_POINTER, out, WITH(normals, s0, NULL, s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_NULL_POINTER, out, WITH(normals, s0, angles, s1, NULL, s2, classes, s3, r));
    REFUSED(OFC_STATUS_NULL_POINTER, out, WITH(normals, s0, angles, s1, depths, s2, NULL, s3, r));
    REFUSED(OFC_STATUS_NULL_POINTER, out, WITH(normals, s0, angles, s1, depths, s2, classes, s3, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, WITH(MISALIGNED(normals), s0, angles, s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_MISALIGNED, out, WITH(normals, s0, MISALIGNED(angles), s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_MISALIGNED, out, WITH(normals, s0, angles, s1, MISALIGNED(depths), s2, classes, s3, r));
    REFUSED(OFC_STATUS_MISALIGNED, out, WITH(normals, s0, angles, s1, depths, s2, classes, s3, MISALIGNED(r)));
    REFUSED(OFC_STATUS_MISALIGNED, out, WITH(normals, s0 + 2, angles, s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_MISALIGNED, out, WITH(normals, s0, angles, s1 + 2, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_MISALIGNED, out, WITH(normals, s0, angles, s1, depths, s2 + 2, classes, s3, r));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, WITH(normals, 12 * WIDTH - 4, angles, s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, WITH(normals, s0, angles, 4 * WIDTH - 4, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, WITH(normals, s0, angles, s1, depths, 4 * WIDTH - 4, classes, s3, r));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, WITH(normals, s0, angles, s1, depths, s2, classes, WIDTH - 1, r));
    REFUSED(OFC_STATUS_TOO_LARGE, out, WITH(normals, SIZE_MAX - 3, angles, s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_OVERLAP, out, WITH(normals, s0, normals, s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_OVERLAP, out, WITH(normals, s0, angles, s1, depths, s2, (uint8_t *)depths, s3, r));
    REFUSED(OFC_STATUS_OVERLAP, out, WITH((float *)space, s0, angles, s1, depths, s2, classes, s3, r));
    REFUSED(OFC_STATUS_OVERLAP, out, WITH(normals, s0, angles, s1, depths, s2, classes, s3, (ofc_surface_result *)angles));

    ofc_surface_params bad = params;
#define BAD_PARAMS(status) REFUSED(status, out, ofc_surface_complete(&image, &solution, &bad, space, need, OUTPUTS))
    const double pitches[] = {0, -1, NAN, INFINITY, 1e31};
    for (size_t i = 0; i < sizeof pitches / sizeof pitches[0]; i++) {
        bad.pixel_pitch = pitches[i];
        BAD_PARAMS(OFC_STATUS_INVALID_PARAMETER);
    }
    bad = params;
    bad.channels_are_lights = 2;
    BAD_PARAMS(OFC_STATUS_INVALID_PARAMETER);
    bad = params;
    bad.reserved[4] = 1;
    BAD_PARAMS(OFC_STATUS_RESERVED_NOT_ZERO);
}

static void bad_solutions_and_masks_refused(void **state)
{
    (void)state;
    ofc_image image = ball_image();
    const size_t need = sizeof space;
    static ofc_solution bad;
#define BAD_SOLUTION(status) REFUSED(status, out, ofc_surface_complete(&image, &bad, &params, space, need, OUTPUTS))
    BAD_SOLUTION(OFC_STATUS_NOT_SOLVED);
    bad = stages.solution;
    BAD_SOLUTION(OFC_STATUS_NO_COVARIANCE);
    bad = solution;
    bad.outcome = OFC_STATUS_NO_TILT;
    BAD_SOLUTION(OFC_STATUS_NOT_SOLVED);
    bad = solution;
    bad.confidence.covariance[4] = NAN;
    BAD_SOLUTION(OFC_STATUS_INVALID_PARAMETER);
    bad = solution;
    bad.orientation.f_inverse[0] = INFINITY;
    BAD_SOLUTION(OFC_STATUS_INVALID_PARAMETER);
    /* The picture with its channels exchanged is another one. */
    image.format = OFC_PIXEL_BGR8;
    REFUSED(OFC_STATUS_NOT_SOLVED, out, complete(&image));
    image = ball_image();
    static uint8_t nothing[HEIGHT][WIDTH];
    image.mask = nothing[0];
    image.mask_stride_bytes = WIDTH;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, complete(&image));
}

static void the_whole_mask_is_completed(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(complete(&image), OFC_STATUS_OK);
    int counts[8] = {0};
    for (int y = 0; y < HEIGHT; y++) {
        assert_true(is_untouched(&out.normals[y][3 * WIDTH], 2 * sizeof(float)));
        assert_true(is_untouched(&out.angles[y][WIDTH], 5 * sizeof(float)));
        assert_true(is_untouched(&out.depths[y][WIDTH], 5 * sizeof(float)));
        assert_true(is_untouched(&out.classes[y][WIDTH], 5));
        for (int x = 0; x < WIDTH; x++) {
            const float *n = &out.normals[y][3 * x];
            counts[out.classes[y][x] & OFC_SURFACE_CLASS]++;
            assert_true(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5 && n[2] > 0);
            assert_true(isfinite(out.depths[y][x]) && out.angles[y][x] > 0);
        }
    }
    for (int k = 0; k < 8; k++)
        assert_int_equal(out.result.class_counts[k], counts[k]);
    assert_true(counts[OFC_SURFACE_THREE_LIGHTS] > 1000 && counts[OFC_SURFACE_OUTSIDE] == 0);
    assert_true(out.result.regions == 1 && out.result.converged == 1 && out.result.reserved == 0);
    assert_true(out.result.light_count >= 0 && out.result.light_count <= 3 && out.result.border_gap_rad >= 0);
    for (int i = 0; i < 3; i++) {
        const double *a = out.result.lights[i].direction;
        const double size = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
        assert_true(size == 0 || fabs(size - 1) < 1e-5);
    }

    /* The channels as lights: nothing is searched for. */
    ofc_surface_params planes = params;
    planes.channels_are_lights = 1;
    assert_int_equal(ofc_surface_complete(&image, &solution, &planes, space, sizeof space, OUTPUTS), OFC_STATUS_OK);
    assert_int_equal(out.result.light_count, 3);
    for (int i = 0; i < 3; i++)
        assert_true(fabs(out.result.lights[i].direction[2] - cos(solution.slant_rad[i])) < 1e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refused),
        cmocka_unit_test(bad_solutions_and_masks_refused),
        cmocka_unit_test(the_whole_mask_is_completed),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
