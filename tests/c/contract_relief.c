/* A relief on a plane: a bump is solved, paint is refused with its reason, and bad arguments leave everything as it was. */
#include "gel.h"

static struct {
    uint8_t classes[DOWN][ACROSS];
    ofc_relief relief;
    float normals[DOWN][ACROSS + 1][3];
    float uncertainty[DOWN][ACROSS];
} out;


static void bump(double u, double v, double *p, double *q)
{
    const double height = 11 * exp(-(u * u + v * v) / 392.0);
    *p = -u / 196.0 * height;
    *q = -v / 196.0 * height;
}

static int prepare(void **state)
{
    (void)state;
    shade(bump, 78, 61);
    return ofc_relief_params_default(&params) == OFC_STATUS_OK ? 0 : -1;
}

static ofc_status solved(const ofc_image *image)
{
    return ofc_relief_solve(image, NULL, &params, room, sizeof room, out.classes[0], &out.relief);
}

static ofc_status solved_on(const ofc_image *background)
{
    const ofc_image image = image_of(frame);
    return ofc_relief_solve(&image, background, &params, room, sizeof room, out.classes[0], &out.relief);
}

/* The background may be NULL. */
static ofc_status solved_on_a_picture(const ofc_image *background)
{
    return background == NULL ? OFC_STATUS_NULL_POINTER : solved_on(background);
}

static void a_bump_is_solved(void **state)
{
    (void)state;
    const ofc_image image = image_of(frame), below = image_of(plane);
    for (int given = 0; given < 2; given++) {
        const ofc_image *background = given ? &below : NULL;
        memset(&out, PATTERN, sizeof out);
        assert_int_equal(solved_on(background), OFC_STATUS_OK);
        assert_int_equal(out.relief.reason, 0);
        assert_int_equal(out.relief.has_background, given);
        assert_int_equal(out.relief.scale_source, OFC_SCALE_COLORS);
        int cells = 0;
        for (int i = 0; i < 4; i++)
            cells += out.relief.cells[i];
        assert_int_equal(cells, ALL);
        assert_int_equal(ofc_relief_normals(&image, background, &out.relief, out.classes[0], out.normals[0][0],
                                            sizeof out.normals[0], out.uncertainty[0], sizeof out.uncertainty[0]),
                         OFC_STATUS_OK);
        assert_true(mean_error(out.classes, out.normals, 0) < 0.05);
        assert_true(out.relief.expected_error > 0 && out.relief.expected_error < 0.2);
        assert_int_equal(out.classes[5][5], OFC_RELIEF_PLANE);
        assert_true(out.normals[5][5][2] == 1 && out.uncertainty[5][5] == 0);
        for (int y = 0; y < DOWN; y++)
            assert_true(is_untouched(out.normals[y][ACROSS], sizeof out.normals[y][ACROSS]));
        /* A hollow has the other sign. */
        const double before = out.relief.slopes[0];
        params.convexity = OFC_CONVEXITY_HOLLOW;
        assert_int_equal(solved_on(background), OFC_STATUS_OK);
        assert_true(out.relief.slopes[0] == -before);
        params.convexity = OFC_CONVEXITY_AUTO;
    }
}

static void paint_is_refused(void **state)
{
    (void)state;
    static uint8_t spots[DOWN][ACROSS][3];
    memcpy(spots, plane, sizeof spots);
    for (int y = 40; y < 70; y++)
        for (int x = 50; x < 90; x++)
            spots[y][x][1] = (uint8_t)(spots[y][x][1] / 2);
    const ofc_image image = image_of(spots), flat = image_of(plane);
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(solved(&image), OFC_STATUS_NO_RELIEF);
    assert_true(out.relief.reason == OFC_NO_RELIEF_NOT_DETERMINED || out.relief.reason == OFC_NO_RELIEF_NOT_INTEGRABLE ||
                out.relief.reason == OFC_NO_RELIEF_EDGE);
    assert_true(is_untouched(out.classes, sizeof out.classes));
    assert_int_equal(solved(&flat), OFC_STATUS_NO_RELIEF);
    assert_int_equal(out.relief.reason, OFC_NO_RELIEF_UNTOUCHED);
    assert_int_equal(ofc_relief_normals(&flat, NULL, &out.relief, out.classes[0], out.normals[0][0],
                                        sizeof out.normals[0], NULL, 0),
                     OFC_STATUS_NOT_SOLVED);
}

static void bad_arguments(void **state)
{
    (void)state;
    refuses_bad_images(solved, &out, sizeof out);
    refuses_bad_images(solved_on_a_picture, &out, sizeof out);
    const ofc_image image = image_of(frame);
    ofc_relief_params bad;
#define SOLVE(params, room, bytes, classes, relief) ofc_relief_solve(&image, NULL, params, room, bytes, classes, relief)
    REFUSED(OFC_STATUS_NULL_POINTER, out, SOLVE(NULL, room, sizeof room, out.classes[0], &out.relief));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SOLVE(&params, NULL, sizeof room, out.classes[0], &out.relief));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SOLVE(&params, room, sizeof room, NULL, &out.relief));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SOLVE(&params, room, sizeof room, out.classes[0], NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, SOLVE(&params, MISALIGNED(room), sizeof room, out.classes[0], &out.relief));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, SOLVE(&params, room, sizeof room - 1, out.classes[0], &out.relief));
    REFUSED(OFC_STATUS_OVERLAP, out, SOLVE(&params, room, sizeof room, (uint8_t *)room, &out.relief));
    const double radii[] = {-1, (double)NAN, (double)INFINITY};
    for (int i = 0; i < 3; i++) {
        bad = params;
        bad.ball_radius = radii[i];
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SOLVE(&bad, room, sizeof room, out.classes[0], &out.relief));
        bad = params;
        bad.saturation = i < 2 ? radii[i] : -1e-9;
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SOLVE(&bad, room, sizeof room, out.classes[0], &out.relief));
    }
    bad = params;
    bad.convexity = 3;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SOLVE(&bad, room, sizeof room, out.classes[0], &out.relief));
    bad = params;
    bad.reserved[2] = 1;
    REFUSED(OFC_STATUS_RESERVED_NOT_ZERO, out, SOLVE(&bad, room, sizeof room, out.classes[0], &out.relief));
    ofc_image other = image;
    other.height--;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, solved_on(&other));
    other.height = 20;
    REFUSED(OFC_STATUS_EMPTY, out, solved(&other));
    assert_int_equal(ofc_relief_params_default(NULL), OFC_STATUS_NULL_POINTER);
    assert_int_equal(ofc_relief_workspace_size(ACROSS, DOWN), sizeof room);
    assert_int_equal(ofc_relief_workspace_size(ACROSS, 31), 0);
    assert_int_equal(ofc_relief_workspace_size(-1, DOWN), 0);
    assert_true(ofc_relief_workspace_size(20000, 20000) > 0);
}

static void bad_arguments_of_normals(void **state)
{
    (void)state;
    const ofc_image image = image_of(frame), below = image_of(plane);
    static uint8_t classes[DOWN][ACROSS];
    ofc_relief relief, bad;
    assert_int_equal(ofc_relief_solve(&image, NULL, &params, room, sizeof room, classes[0], &relief), OFC_STATUS_OK);
#define NORMALS(background, relief, classes, normals, stride, deviations, other)                                       \
    ofc_relief_normals(&image, background, relief, classes, normals, stride, deviations, other)
    const size_t stride = sizeof out.normals[0], other = sizeof out.uncertainty[0];
    float *normals = out.normals[0][0], *deviations = out.uncertainty[0];
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMALS(NULL, NULL, classes[0], normals, stride, deviations, other));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMALS(NULL, &relief, NULL, normals, stride, deviations, other));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMALS(NULL, &relief, classes[0], NULL, stride, deviations, other));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, NORMALS(NULL, &relief, classes[0], normals, 4, deviations, other));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, NORMALS(NULL, &relief, classes[0], normals, stride, deviations, 4));
    REFUSED(OFC_STATUS_MISALIGNED, out, NORMALS(NULL, &relief, classes[0], normals, stride + 1, deviations, other));
    REFUSED(OFC_STATUS_OVERLAP, out, NORMALS(NULL, &relief, classes[0], normals, stride, normals, other));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(&below, &relief, classes[0], normals, stride, NULL, 0));
    bad = relief;
    bad.reason = OFC_NO_RELIEF_EDGE;
    REFUSED(OFC_STATUS_NOT_SOLVED, out, NORMALS(NULL, &bad, classes[0], normals, stride, NULL, 0));
    bad = relief;
    bad.slopes[3] = (double)NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(NULL, &bad, classes[0], normals, stride, NULL, 0));
    bad = relief;
    bad.plane[44] = (double)INFINITY;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(NULL, &bad, classes[0], normals, stride, NULL, 0));
    bad = relief;
    bad.width = 10;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(NULL, &bad, classes[0], normals, stride, NULL, 0));
    bad = relief;
    bad.scale_source = 9;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(NULL, &bad, classes[0], normals, stride, NULL, 0));
    bad = relief;
    bad.reserved = 1;
    REFUSED(OFC_STATUS_RESERVED_NOT_ZERO, out, NORMALS(NULL, &bad, classes[0], normals, stride, NULL, 0));
    assert_int_equal(NORMALS(NULL, &relief, classes[0], normals, stride, NULL, 0), OFC_STATUS_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bump_is_solved),
        cmocka_unit_test(paint_is_refused),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(bad_arguments_of_normals),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
