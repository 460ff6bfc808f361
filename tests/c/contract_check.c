/* Self-checks, ranks and segmentation. */
#include "contract.h"

static struct {
    ofc_check_result result;
    ofc_rank rank;
    ofc_segment_params params;
    ofc_region regions[OFC_MAX_REGIONS];
    int32_t count;
    uint16_t labels[PIXELS + 16];
    uint8_t mask[PIXELS + 16];
    ofc_patch_class classes[200];
} out;

static ofc_segment_params params;
static uint64_t space[OFC_SEGMENT_WORKSPACE_SIZE(WIDTH, HEIGHT) / 8];

static int prepare(void **state)
{
    return prepare_stages(state) == 0 && ofc_segment_params_default(&params) == OFC_STATUS_OK ? 0 : -1;
}

static ofc_status check_of(const ofc_image *image)
{
    return ofc_check(image, &stages.solution, NULL, workspace, sizeof workspace, &out.result);
}

static void check(void **state)
{
    (void)state;
    refuses_bad_images(check_of, &out, sizeof out);
    ofc_image image = ball_image();
    const ofc_solution *solution = &stages.solution;
    const size_t need = ofc_check_workspace_size(WIDTH, HEIGHT);
    assert_int_equal(need, OFC_CHECK_WORKSPACE_SIZE(WIDTH, HEIGHT));
    assert_int_equal(ofc_check_workspace_size(0, 1), 0);
    assert_int_equal(ofc_check_workspace_size(INT32_MAX, INT32_MAX), 0);
#define CHECK(solution, space, bytes, result) ofc_check(&image, solution, NULL, space, bytes, result)
    REFUSED(OFC_STATUS_NULL_POINTER, out, CHECK(NULL, workspace, need, &out.result));
    REFUSED(OFC_STATUS_NULL_POINTER, out, CHECK(solution, NULL, need, &out.result));
    REFUSED(OFC_STATUS_NULL_POINTER, out, CHECK(solution, workspace, need, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, CHECK(MISALIGNED(solution), workspace, need, &out.result));
    REFUSED(OFC_STATUS_MISALIGNED, out, CHECK(solution, MISALIGNED(workspace), need, &out.result));
    REFUSED(OFC_STATUS_MISALIGNED, out, CHECK(solution, workspace, need, MISALIGNED(&out.result)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, CHECK(solution, workspace, need - 1, &out.result));
    REFUSED(OFC_STATUS_OVERLAP, out, CHECK(solution, workspace, need, (ofc_check_result *)workspace));
    ofc_solution broken = *solution;
    broken.outcome = OFC_STATUS_NO_TILT;
    REFUSED(OFC_STATUS_NOT_SOLVED, out, CHECK(&broken, workspace, need, &out.result));
    broken = *solution;
    broken.orientation.rank = 2;
    REFUSED(OFC_STATUS_NOT_SOLVED, out, CHECK(&broken, workspace, need, &out.result));
    broken = *solution;
    broken.orientation.f[4] = NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, CHECK(&broken, workspace, need, &out.result));
    broken = *solution;
    broken.inlier_test.norm_high = -1;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, CHECK(&broken, workspace, need, &out.result));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(check_of(&image), OFC_STATUS_OK);
    assert_true(is_untouched(&out.rank, sizeof out.rank));
    assert_int_equal(out.result.inlier_count, solution->inlier_count);
    assert_int_equal(out.result.has_tilts, 1);
    for (int c = 0; c < 3; c++) {
        assert_true(out.result.correlation[c] > 0.999);
        assert_true(out.result.tilts.tilt_rad[c] == solution->tilts.tilt_rad[c]);
        assert_true(fabs(out.result.tilt_difference_rad[c]) < 0.05);
    }
    assert_true(out.result.norm_min <= out.result.norm_median && out.result.norm_median <= out.result.norm_max);
    assert_true(out.result.depth_pixel_count == 0 && isnan(out.result.depth_angle_median_rad));
    assert_true(isnan(out.result.depth_tilts.tilt_rad[0]) && isnan(out.result.depth_tilt_difference_rad[2]));
    assert_true(out.result.has_turn == 1 && out.result.reserved == 0);
    assert_true(out.result.turn_rad < 0.1 && out.result.turn_expected_rad < 0.1 && out.result.convexity > 0.9);
    /* The convex/concave twin, whose normals are turned half about the line of sight. */
    ofc_solution twin = *solution;
    for (int i = 0; i < 9; i++) {
        twin.orientation.f[i] *= i % 3 < 2 ? -1 : 1;
        twin.orientation.f_inverse[i] *= i / 3 < 2 ? -1 : 1;
    }
    assert_int_equal(CHECK(&twin, workspace, need, &out.result), OFC_STATUS_OK);
    assert_true(out.result.has_turn == 1 && out.result.turn_rad > 1.8);
}

static void check_of_depth(void **state)
{
    (void)state;
    static float normals[PIXELS * 3], depth[PIXELS + 1];
    static uint64_t space[OFC_DEPTH_WORKSPACE_SIZE(WIDTH, HEIGHT) / 8 + 1];
    const ofc_image image = ball_image();
    const ofc_solution *solution = &stages.solution;
    assert_int_equal(ofc_normals_compute(&image, solution, normals, WIDTH * 12), OFC_STATUS_OK);
    const ofc_depth_input input = {
        .normals = normals, .normals_stride_bytes = WIDTH * 12, .width = WIDTH, .height = HEIGHT};
    ofc_depth_params parameters;
    ofc_depth_result result;
    assert_int_equal(ofc_depth_params_default(&parameters), OFC_STATUS_OK);
    assert_int_equal(ofc_depth_integrate(&input, &parameters, space, sizeof space, depth, WIDTH * 4, &result),
                     OFC_STATUS_OK);
    const ofc_depth_map map = {
        .depth = depth, .width = WIDTH, .height = HEIGHT, .row_stride_bytes = WIDTH * 4, .pixel_pitch = 1};
    const size_t need = ofc_check_workspace_size(WIDTH, HEIGHT);
#define CHECK_DEPTH(map, result) ofc_check(&image, solution, map, workspace, need, result)
    ofc_depth_map bad;
#define BAD(status, field, value)                                                                                      \
    (bad = map, bad.field = (value));                                                                                  \
    REFUSED(status, out, CHECK_DEPTH(&bad, &out.result))
    BAD(OFC_STATUS_NULL_POINTER, depth, NULL);
    BAD(OFC_STATUS_MISALIGNED, depth, MISALIGNED(depth));
    BAD(OFC_STATUS_INVALID_PARAMETER, width, WIDTH - 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, height, HEIGHT - 1);
    BAD(OFC_STATUS_EMPTY, height, 0);
    BAD(OFC_STATUS_STRIDE_TOO_SMALL, row_stride_bytes, WIDTH);
    BAD(OFC_STATUS_INVALID_PARAMETER, pixel_pitch, NAN);
    BAD(OFC_STATUS_OVERLAP, depth, (const float *)workspace);
#undef BAD
    REFUSED(OFC_STATUS_MISALIGNED, out, CHECK_DEPTH(MISALIGNED(&map), &out.result));
    REFUSED(OFC_STATUS_OVERLAP, out, CHECK_DEPTH(&map, (ofc_check_result *)(void *)depth));
    assert_int_equal(CHECK_DEPTH(&map, &out.result), OFC_STATUS_OK);
    assert_int_equal(out.result.depth_pixel_count, solution->inlier_count);
    assert_int_equal(out.result.has_depth_tilts, 1);
    assert_true(out.result.depth_angle_median_rad > 0 && out.result.depth_angle_median_rad < 0.05);
    for (int c = 0; c < 3; c++)
        assert_true(fabs(out.result.depth_tilt_difference_rad[c]) < 0.1);
}

static ofc_status rank_of(const ofc_image *image)
{
    return ofc_rank_compute(image, &stages.inliers, &stages.fit, &out.rank);
}

static void rank(void **state)
{
    (void)state;
    refuses_bad_images(rank_of, &out, sizeof out);
    ofc_image image = ball_image();
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rank_compute(&image, NULL, NULL, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_rank_compute(&image, MISALIGNED(&stages.inliers), NULL, &out.rank));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_rank_compute(&image, NULL, MISALIGNED(&stages.fit), &out.rank));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_rank_compute(&image, NULL, NULL, MISALIGNED(&out.rank)));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_rank_compute(&image, NULL, &stages.fit, (ofc_rank *)&stages.fit));
    ofc_color_fit bad = stages.fit;
    bad.coefficients[3].value = NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_compute(&image, NULL, &bad, &out.rank));
    bad = stages.fit;
    bad.residual_deviation = -1;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_compute(&image, NULL, &bad, &out.rank));
    assert_int_equal(rank_of(&image), OFC_STATUS_OK);
    assert_true(out.rank.colors == 3 && out.rank.normals == 3);
    assert_true(stages.solution.rank.colors == 3 && stages.solution.rank.normals == 3);
    static uint8_t gray[HEIGHT][WIDTH][3], mask[PIXELS];
    for (int i = 0; i < PIXELS * 3; i++)
        (&gray[0][0][0])[i] = (uint8_t)(20 + i / 3 % 200);
    image.pixels = gray;
    assert_int_equal(ofc_rank_compute(&image, NULL, NULL, &out.rank), OFC_STATUS_OK);
    assert_true(out.rank.colors == 1 && out.rank.normals == 0);
    image.mask = mask;
    image.mask_stride_bytes = WIDTH;
    REFUSED(OFC_STATUS_TOO_FEW_PIXELS, out, ofc_rank_compute(&image, NULL, NULL, &out.rank));
}

static ofc_status patches_of(const ofc_image *image)
{
    return ofc_rank_patches(image, 10, 0.5, 0, out.classes);
}

static void patches(void **state)
{
    (void)state;
    refuses_bad_images(patches_of, &out, sizeof out);
    const ofc_image image = ball_image();
    assert_int_equal(ofc_rank_patches_count(WIDTH, 10), 9);
    assert_int_equal(ofc_rank_patches_count(WIDTH, 64), 2);
    assert_int_equal(ofc_rank_patches_count(0, 10), 0);
    assert_int_equal(ofc_rank_patches_count(WIDTH, 0), 0);
    assert_int_equal(ofc_rank_patches_count(INT32_MIN, -1), 0);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rank_patches(&image, 10, 0.5, 0, NULL));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_rank_patches(&image, 10, 0.5, 0, (ofc_patch_class *)ball));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_patches(&image, 2, 0.5, 0, out.classes));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_patches(&image, 65, 0.5, 0, out.classes));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_patches(&image, -10, 0.5, 0, out.classes));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_patches(&image, 10, 0, 0, out.classes));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_patches(&image, 10, NAN, 0, out.classes));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_patches(&image, 10, 0.5, -1, out.classes));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rank_patches(&image, 10, 0.5, 4, out.classes));
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(patches_of(&image), OFC_STATUS_OK);
    assert_true(is_untouched(out.classes + 72, sizeof out.classes - 72 * sizeof out.classes[0]));
    assert_true(out.classes[0].light == 0 && out.classes[0].surface == 0);
    assert_true(out.classes[4 * 9 + 4].light == 3 && out.classes[4 * 9 + 4].surface == 3);
    /* One color is a plane's, in whatever light: what the region says fills that in. */
    static uint8_t flat[HEIGHT][WIDTH][3];
    memset(flat, 90, sizeof flat);
    ofc_image plane = image;
    plane.pixels = flat;
    assert_int_equal(patches_of(&plane), OFC_STATUS_OK);
    assert_true(out.classes[4 * 9 + 4].light == 0 && out.classes[4 * 9 + 4].surface == 1);
    assert_int_equal(ofc_rank_patches(&plane, 10, 0.5, 3, out.classes), OFC_STATUS_OK);
    assert_true(out.classes[4 * 9 + 4].light == 3 && out.classes[4 * 9 + 4].surface == 1);
}

static ofc_status segment_of(const ofc_image *image)
{
    return ofc_segment(image, &params, space, sizeof space, out.labels, out.regions, &out.count);
}

static void segmentation(void **state)
{
    (void)state;
    refuses_bad_images(segment_of, &out, sizeof out);
    ofc_image image = ball_image();
    const size_t need = ofc_segment_workspace_size(WIDTH, HEIGHT);
    assert_int_equal(need, OFC_SEGMENT_WORKSPACE_SIZE(WIDTH, HEIGHT));
    assert_int_equal(ofc_segment_workspace_size(WIDTH, 0), 0);
    assert_int_equal(ofc_segment_workspace_size(INT32_MAX, INT32_MAX), 0);
#define SEGMENT(params, space, bytes, labels, regions, count)                                                          \
    ofc_segment(&image, params, space, bytes, labels, regions, count)
    REFUSED(OFC_STATUS_NULL_POINTER, out, SEGMENT(NULL, space, need, out.labels, out.regions, &out.count));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SEGMENT(&params, NULL, need, out.labels, out.regions, &out.count));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SEGMENT(&params, space, need, NULL, out.regions, &out.count));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SEGMENT(&params, space, need, out.labels, NULL, &out.count));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SEGMENT(&params, space, need, out.labels, out.regions, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, SEGMENT(MISALIGNED(&params), space, need, out.labels, out.regions, &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, SEGMENT(&params, MISALIGNED(space), need, out.labels, out.regions, &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, SEGMENT(&params, space, need, MISALIGNED(out.labels), out.regions, &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, SEGMENT(&params, space, need, out.labels, MISALIGNED(out.regions), &out.count));
    REFUSED(OFC_STATUS_MISALIGNED, out, SEGMENT(&params, space, need, out.labels, out.regions, MISALIGNED(&out.count)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, SEGMENT(&params, space, need - 1, out.labels, out.regions, &out.count));
    REFUSED(OFC_STATUS_OVERLAP, out, SEGMENT(&params, space, need, (uint16_t *)space, out.regions, &out.count));
    REFUSED(OFC_STATUS_OVERLAP, out, SEGMENT(&params, space, need, out.labels, out.regions, (int32_t *)(void *)out.labels));
    ofc_segment_params bad;
#define BAD(status, field, value)                                                                                      \
    (bad = params, bad.field = (value));                                                                               \
    REFUSED(status, out, SEGMENT(&bad, space, need, out.labels, out.regions, &out.count))
    BAD(OFC_STATUS_INVALID_PARAMETER, tolerance, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, tolerance, NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, saturation, -1);
    BAD(OFC_STATUS_INVALID_PARAMETER, min_pixels, 11);
    BAD(OFC_STATUS_INVALID_PARAMETER, max_regions, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, max_regions, OFC_MAX_REGIONS + 1);
    BAD(OFC_STATUS_INVALID_PARAMETER, seed_blocks, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, spacing, 65);
    BAD(OFC_STATUS_INVALID_PARAMETER, search_radius, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, refits, 101);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved[0], 1);
#undef BAD
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_segment_params_default(NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_segment_params_default(MISALIGNED(&out.params)));

    memset(&out, PATTERN, sizeof out);
    assert_int_equal(segment_of(&image), OFC_STATUS_OK);
    assert_int_equal(out.count, 1);
    assert_true(is_untouched(out.labels + PIXELS, 32));
    assert_true(is_untouched(&out.regions[1], sizeof out.regions - sizeof out.regions[0]));
    int pixels = 0;
    for (int i = 0; i < PIXELS; i++)
        pixels += out.labels[i] == 1;
    assert_int_equal(out.regions[0].pixel_count, pixels);
    assert_true(pixels > 1000 && out.regions[0].rank.colors == 3);
    /* The label becomes a mask that solve can be pointed at. */
#define MARK(labels, width, height, label, mask) ofc_segment_mark(labels, width, height, label, mask)
    assert_int_equal(MARK(out.labels, WIDTH, HEIGHT, 1, out.mask), OFC_STATUS_OK);
    assert_true(is_untouched(out.mask + PIXELS, 16));
    image.mask = out.mask;
    image.mask_stride_bytes = WIDTH;
    static ofc_solution solution;
    assert_int_equal(ofc_solve(&image, &stages.params, workspace, sizeof workspace, NULL, &solution), OFC_STATUS_OK);
    assert_int_equal(solution.pixel_counts.usable, pixels);
    static uint16_t labels[PIXELS];
    REFUSED(OFC_STATUS_NULL_POINTER, out, MARK(NULL, WIDTH, HEIGHT, 1, out.mask));
    REFUSED(OFC_STATUS_NULL_POINTER, out, MARK(labels, WIDTH, HEIGHT, 1, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, MARK(MISALIGNED(labels), WIDTH, HEIGHT - 1, 1, out.mask));
    REFUSED(OFC_STATUS_EMPTY, out, MARK(labels, 0, HEIGHT, 1, out.mask));
    REFUSED(OFC_STATUS_EMPTY, out, MARK(labels, WIDTH, -1, 1, out.mask));
    REFUSED(OFC_STATUS_TOO_LARGE, out, MARK(labels, INT32_MAX, INT32_MAX, 1, out.mask));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, MARK(labels, WIDTH, HEIGHT, 0, out.mask));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, MARK(labels, WIDTH, HEIGHT, 65536, out.mask));
    REFUSED(OFC_STATUS_OVERLAP, out, MARK(labels, WIDTH, HEIGHT, 1, (uint8_t *)labels));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(check),
        cmocka_unit_test(check_of_depth),
        cmocka_unit_test(rank),
        cmocka_unit_test(patches),
        cmocka_unit_test(segmentation),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
