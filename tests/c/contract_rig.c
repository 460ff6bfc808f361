/* A rig: bumps are added, merged and solved, the scale is known, set or unknown, and bad arguments leave everything as it was. */
#include "ball.h"

static struct {
    ofc_rig rig;
    ofc_rig_balls balls;
    ofc_rig_model model;
    ofc_no_relief no_relief;
    uint8_t classes[DOWN][ACROSS];
    float normals[DOWN][ACROSS + 1][3];
    float uncertainty[DOWN][ACROSS];
    uint8_t saved[OFC_RIG_MODEL_BYTES + 1];
    ofc_rig_contact contact;
} out;

static int prepare(void **state)
{
    (void)state;
    shade(cap, 78, 60);
    return ofc_relief_params_default(&params) == OFC_STATUS_OK ? 0 : -1;
}

static ofc_status add(const ofc_image *image, const ofc_image *background, double ball, const double *center)
{
    ofc_relief_params given = params;
    given.ball_radius = ball;
    return ofc_rig_add(&out.rig, &out.balls, image, background, &given, center, room, sizeof room, out.classes[0],
                       &out.no_relief);
}

/* Four presses of a ball. */
static void press(double ball, int has_center)
{
    const ofc_image image = image_of(frame), below = image_of(plane);
    assert_int_equal(ofc_rig_init(ACROSS, DOWN, &out.rig, &out.balls), OFC_STATUS_OK);
    for (int i = 0; i < 4; i++) {
        shade(cap, places[i][0], places[i][1]);
        assert_int_equal(add(&image, &below, ball, has_center ? places[i] : NULL), OFC_STATUS_OK);
        assert_int_equal(out.no_relief, 0);
    }
    assert_int_equal(out.rig.frames, 4);
    shade(cap, 78, 60);
}

static double error(void)
{
    const ofc_image image = image_of(frame), below = image_of(plane);
    assert_int_equal(ofc_rig_classify(&out.model, &image, &below, room, sizeof room, out.classes[0]), OFC_STATUS_OK);
    assert_int_equal(ofc_rig_normals(&out.model, &image, &below, out.classes[0], out.normals[0][0],
                                     sizeof out.normals[0], out.uncertainty[0], sizeof out.uncertainty[0]),
                     OFC_STATUS_OK);
    assert_true(out.normals[3][3][2] == 1 && out.uncertainty[3][3] == 0);
    return mean_error(out.classes, out.normals, 500);
}

static void presses_are_learned(void **state)
{
    (void)state;
    for (int has_center = 0; has_center < 2; has_center++) {
        memset(&out, PATTERN, sizeof out);
        press(radius, has_center);
        assert_int_equal(out.balls.count, 4);
        assert_int_equal(out.balls.centers, 4 * has_center);
        assert_int_equal(ofc_rig_solve(&out.rig, &out.balls, &params, &out.model), OFC_STATUS_OK);
        assert_int_equal(out.model.scale_source, OFC_SCALE_BALL);
        assert_int_equal(out.model.terms, 18);
        assert_true(error() < 0.05);
        for (int y = 0; y < DOWN; y++)
            assert_true(is_untouched(out.normals[y][ACROSS], sizeof out.normals[y][ACROSS]));
    }
    /* Without labels, up to a scale that is set. */
    const ofc_rig_model with_balls = out.model;
    out.rig.bend_weight = 0;
    assert_int_equal(ofc_rig_solve(&out.rig, NULL, &params, &out.model), OFC_STATUS_SCALE_UNKNOWN);
    assert_int_equal(out.model.scale_source, OFC_SCALE_UNKNOWN);
    assert_int_equal(out.model.advice, OFC_RIG_ADVICE_SCALE);
    const double factor = with_balls.tilt / out.model.tilt;
    assert_int_equal(ofc_rig_set_scale(&out.rig, &out.model, factor, 0.05), OFC_STATUS_OK);
    assert_int_equal(ofc_rig_solve(&out.rig, NULL, &params, &out.model), OFC_STATUS_OK);
    assert_int_equal(out.model.scale_source, OFC_SCALE_GIVEN);
    assert_true(out.model.terms == 3 && out.model.scale_deviation == 0.05);
    assert_true(error() < 0.05);
    /* Twice the frames are the same frames. */
    const ofc_rig once = out.rig;
    const ofc_rig_balls balls = out.balls;
    const ofc_rig_model before = out.model;
    assert_int_equal(ofc_rig_merge(&out.rig, &out.balls, &once, &balls), OFC_STATUS_OK);
    assert_int_equal(out.rig.frames, 8);
    assert_int_equal(out.balls.count, 8);
    assert_int_equal(ofc_rig_solve(&out.rig, NULL, &params, &out.model), OFC_STATUS_OK);
    assert_true(fabs(out.model.slopes[0] - before.slopes[0]) < 1e-12);
    params.convexity = OFC_CONVEXITY_HOLLOW;
    assert_int_equal(ofc_rig_solve(&out.rig, NULL, &params, &out.model), OFC_STATUS_OK);
    assert_true(fabs(out.model.slopes[0] + before.slopes[0]) < 1e-12);
    params.convexity = OFC_CONVEXITY_AUTO;
}

static void what_adds_nothing_has_a_reason(void **state)
{
    (void)state;
    const ofc_image flat = image_of(plane);
    assert_int_equal(ofc_rig_init(ACROSS, DOWN, &out.rig, &out.balls), OFC_STATUS_OK);
    const ofc_rig empty = out.rig;
    memset(&out.classes, PATTERN, sizeof out.classes);
    assert_int_equal(add(&flat, NULL, 0, NULL), OFC_STATUS_NO_RELIEF);
    assert_int_equal(out.no_relief, OFC_NO_RELIEF_UNTOUCHED);
    assert_memory_equal(&out.rig, &empty, sizeof empty);
    assert_true(is_untouched(out.classes, sizeof out.classes));
    memset(&out.model, PATTERN, sizeof out.model);
    assert_int_equal(ofc_rig_solve(&out.rig, &out.balls, &params, &out.model), OFC_STATUS_NO_RELIEF);
    assert_true(is_untouched(&out.model, sizeof out.model));
}

static ofc_rig some_rig;
static ofc_rig_balls some_balls;
static ofc_rig_model some_model;

/* Nothing is added to a rig by a call that is refused. */
static ofc_status added(const ofc_image *image)
{
    ofc_rig rig = some_rig;
    const ofc_status status =
        ofc_rig_add(&rig, NULL, image, NULL, &params, NULL, room, sizeof room, out.classes[0], &out.no_relief);
    assert_memory_equal(&rig, &some_rig, sizeof rig);
    return status;
}

static ofc_status classified(const ofc_image *image)
{
    return ofc_rig_classify(&some_model, image, NULL, room, sizeof room, out.classes[0]);
}

static ofc_status classified_on(const ofc_image *background)
{
    const ofc_image image = image_of(frame);
    return background == NULL
               ? OFC_STATUS_NULL_POINTER
               : ofc_rig_classify(&some_model, &image, background, room, sizeof room, out.classes[0]);
}

static ofc_status normals_of(const ofc_image *image)
{
    static uint8_t classes[DOWN][ACROSS];
    return ofc_rig_normals(&some_model, image, NULL, classes[0], out.normals[0][0], sizeof out.normals[0], NULL, 0);
}

static void bad_arguments(void **state)
{
    (void)state;
    press(radius, 0);
    assert_int_equal(ofc_rig_solve(&out.rig, &out.balls, &params, &out.model), OFC_STATUS_OK);
    some_rig = out.rig;
    some_balls = out.balls;
    some_model = out.model;
    refuses_bad_images(added, &out, sizeof out);
    refuses_bad_images(classified, &out, sizeof out);
    refuses_bad_images(classified_on, &out, sizeof out);
    refuses_bad_images(normals_of, &out, sizeof out);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_init(ACROSS, DOWN, NULL, &out.balls));
    REFUSED(OFC_STATUS_EMPTY, out, ofc_rig_init(0, DOWN, &out.rig, &out.balls));
    REFUSED(OFC_STATUS_EMPTY, out, ofc_rig_init(ACROSS, 31, &out.rig, NULL));
    REFUSED(OFC_STATUS_TOO_LARGE, out, ofc_rig_init(INT32_MAX, INT32_MAX, &out.rig, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_rig_init(ACROSS, DOWN, MISALIGNED(&out.rig), NULL));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_rig_init(ACROSS, DOWN, &out.rig, (ofc_rig_balls *)(void *)&out.rig));
    const ofc_image image = image_of(frame);
    ofc_image smaller = image;
    smaller.height--;
    ofc_rig rig = some_rig;
    ofc_rig_balls balls = some_balls;
    ofc_relief_params ball = params;
    ball.ball_radius = radius;
    const double center[2] = {78, 60}, no_center[2] = {(double)NAN, 60};
#define ADD(rig, balls, image, params, center, room, bytes)                                                            \
    ofc_rig_add(rig, balls, image, NULL, params, center, room, bytes, out.classes[0], &out.no_relief)
    REFUSED(OFC_STATUS_NULL_POINTER, out, ADD(NULL, NULL, &image, &params, NULL, room, sizeof room));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ADD(&rig, NULL, &image, NULL, NULL, room, sizeof room));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ADD(&rig, NULL, &image, &params, NULL, NULL, sizeof room));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, ADD(&rig, NULL, &image, &params, NULL, room, sizeof room - 1));
    REFUSED(OFC_STATUS_MISALIGNED, out, ADD(&rig, NULL, &image, &params, NULL, MISALIGNED(room), sizeof room));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ADD(&rig, NULL, &smaller, &params, NULL, room, sizeof room));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ADD(&rig, NULL, &image, &ball, NULL, room, sizeof room));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ADD(&rig, &balls, &image, &params, center, room, sizeof room));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ADD(&rig, &balls, &image, &ball, no_center, room, sizeof room));
    ball.ball_radius = (double)INFINITY;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ADD(&rig, &balls, &image, &ball, NULL, room, sizeof room));
    rig.energy[4] = (double)NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ADD(&rig, NULL, &image, &params, NULL, room, sizeof room));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rig_solve(&rig, NULL, &params, &out.model));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rig_merge(&rig, NULL, &some_rig, NULL));
    rig = some_rig;
    balls.sides[100] = (double)INFINITY;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rig_solve(&rig, &balls, &params, &out.model));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rig_merge(&rig, &balls, &some_rig, &some_balls));
    balls = some_balls;
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_rig_merge(&rig, NULL, &rig, NULL));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_merge(&rig, NULL, &some_rig, &some_balls));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_merge(&rig, NULL, NULL, NULL));
    ofc_rig other = some_rig;
    other.width = ACROSS + 1;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rig_merge(&rig, NULL, &other, NULL));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_solve(NULL, NULL, &params, &out.model));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_solve(&rig, NULL, NULL, &out.model));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_solve(&rig, NULL, &params, NULL));
    const double factors[] = {0, -1, (double)NAN, (double)INFINITY};
    for (int i = 0; i < 4; i++)
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rig_set_scale(&rig, &some_model, factors[i], 0.1));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ofc_rig_set_scale(&rig, &some_model, 1, -0.1));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_set_scale(NULL, &some_model, 1, 0.1));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_set_scale(&rig, NULL, 1, 0.1));
    assert_memory_equal(&rig, &some_rig, sizeof rig);
    assert_memory_equal(&balls, &some_balls, sizeof balls);
}

static void bad_models(void **state)
{
    (void)state;
    const ofc_image image = image_of(frame);
    static uint8_t classes[DOWN][ACROSS];
    ofc_rig_model bad = some_model;
#define CLASSIFY(model) ofc_rig_classify(model, &image, NULL, room, sizeof room, out.classes[0])
#define NORMALS(model, classes, normals, stride, deviations, other)                                                    \
    ofc_rig_normals(model, &image, NULL, classes, normals, stride, deviations, other)
    const size_t stride = sizeof out.normals[0], other = sizeof out.uncertainty[0];
    float *normals = out.normals[0][0], *deviations = out.uncertainty[0];
    bad.terms = 0;
    REFUSED(OFC_STATUS_NOT_SOLVED, out, CLASSIFY(&bad));
    REFUSED(OFC_STATUS_NOT_SOLVED, out, NORMALS(&bad, classes[0], normals, stride, NULL, 0));
    bad.terms = 4;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, CLASSIFY(&bad));
    bad = some_model;
    bad.slopes[107] = (double)NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, CLASSIFY(&bad));
    bad = some_model;
    bad.noise[1] = -1;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(&bad, classes[0], normals, stride, NULL, 0));
    bad = some_model;
    bad.height = DOWN - 1;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, CLASSIFY(&bad));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, NORMALS(&bad, classes[0], normals, stride, NULL, 0));
    bad = some_model;
    bad.advice = 77;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, CLASSIFY(&bad));
    REFUSED(OFC_STATUS_NULL_POINTER, out, CLASSIFY(NULL));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_classify(&some_model, &image, NULL, room, sizeof room, NULL));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_classify(&some_model, &image, NULL, NULL, sizeof room, out.classes[0]));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out,
            ofc_rig_classify(&some_model, &image, NULL, room, sizeof room - 1, out.classes[0]));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMALS(NULL, classes[0], normals, stride, deviations, other));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMALS(&some_model, NULL, normals, stride, deviations, other));
    REFUSED(OFC_STATUS_NULL_POINTER, out, NORMALS(&some_model, classes[0], NULL, stride, deviations, other));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, NORMALS(&some_model, classes[0], normals, 4, deviations, other));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, NORMALS(&some_model, classes[0], normals, stride, deviations, 4));
    REFUSED(OFC_STATUS_OVERLAP, out, NORMALS(&some_model, classes[0], normals, stride, normals, other));
    assert_int_equal(NORMALS(&some_model, classes[0], normals, stride, NULL, 0), OFC_STATUS_OK);
}

static void models_are_kept(void **state)
{
    (void)state;
    const size_t all = OFC_RIG_MODEL_BYTES;
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(ofc_rig_model_save(&some_model, out.saved, sizeof out.saved), OFC_STATUS_OK);
    assert_true(is_untouched(out.saved + all, 1));
    assert_int_equal(ofc_rig_model_load(out.saved, all, &out.model), OFC_STATUS_OK);
    assert_memory_equal(&out.model, &some_model, sizeof some_model);
    static uint8_t bytes[OFC_RIG_MODEL_BYTES + 1];
    memcpy(bytes, out.saved, sizeof bytes);
    REFUSED(OFC_STATUS_NOT_SOLVED, out, ofc_rig_model_save(&(ofc_rig_model){.terms = 0}, out.saved, all));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_model_save(NULL, out.saved, all));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_model_save(&some_model, NULL, all));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, ofc_rig_model_save(&some_model, out.saved, all - 1));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_model_load(NULL, all, &out.model));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_rig_model_load(bytes, all, NULL));
    REFUSED(OFC_STATUS_EMPTY, out, ofc_rig_model_load(bytes, 0, &out.model));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_rig_model_load((const uint8_t *)&out.model, all, &out.model));
    REFUSED(OFC_STATUS_MODEL_DAMAGED, out, ofc_rig_model_load(bytes, all + 1, &out.model));
    for (size_t size = 1; size < all; size++)
        REFUSED(size < 12   ? OFC_STATUS_NOT_A_MODEL
                : size < 16 ? OFC_STATUS_MODEL_VERSION
                            : OFC_STATUS_MODEL_DAMAGED,
                out.model, ofc_rig_model_load(bytes, size, &out.model));
    /* Every changed byte is seen. */
    for (size_t i = 0; i < all; i++) {
        bytes[i] ^= (uint8_t)(1 + i % 255);
        REFUSED(i < 12   ? OFC_STATUS_NOT_A_MODEL
                : i < 16 ? OFC_STATUS_MODEL_VERSION
                         : OFC_STATUS_MODEL_DAMAGED,
                out.model, ofc_rig_model_load(bytes, all, &out.model));
        bytes[i] ^= (uint8_t)(1 + i % 255);
    }
    /* Numbers that no model has, with the right checksum: the bytes after the header at random. */
    uint32_t random = 7;
    int refused = 0;
    for (int round = 0; round < 2000; round++) {
        const int changes = 1 + round % 40;
        static uint8_t hostile[OFC_RIG_MODEL_BYTES];
        memcpy(hostile, bytes, sizeof hostile);
        for (int i = 0; i < changes; i++) {
            random = random * 1664525U + 1013904223U;
            hostile[24 + random % (all - 32)] = (uint8_t)(random >> 24);
        }
        uint64_t hash = 0xcbf29ce484222325U;
        for (size_t i = 0; i < all - 8; i++)
            hash = (hash ^ hostile[i]) * 0x100000001b3U;
        for (size_t i = 0; i < 8; i++)
            hostile[all - 8 + i] = (uint8_t)(hash >> (8 * i));
        const ofc_status status = ofc_rig_model_load(hostile, all, &out.model);
        assert_true(status == OFC_STATUS_OK || status == OFC_STATUS_INVALID_PARAMETER || status == OFC_STATUS_TOO_LARGE);
        refused += status != OFC_STATUS_OK;
        if (status == OFC_STATUS_OK && round % 100 == 0 && out.model.width == ACROSS && out.model.height == DOWN) {
            const ofc_image image = image_of(frame);
            (void)ofc_rig_classify(&out.model, &image, NULL, room, sizeof room, out.classes[0]);
        }
    }
    assert_true(refused > 20 && refused < 1990);
}

static void a_contact_is_measured(void **state)
{
    (void)state;
    static float depth[DOWN][ACROSS];
    static uint8_t classes[DOWN][ACROSS], mask[DOWN][ACROSS];
    for (int y = 0; y < DOWN; y++)
        for (int x = 0; x < ACROSS; x++) {
            const double u = x - 70, v = y - 50, rise = 10 - (u * u + v * v) / 40;
            depth[y][x] = (float)(3 + fmax(0, rise));
            classes[y][x] = rise > 0 ? OFC_RELIEF_CONTACT : OFC_RELIEF_PLANE;
        }
    const size_t stride = sizeof depth[0];
    memset(&out, PATTERN, sizeof out);
#define MEASURE(classes, depth, stride, size, mask, contact)                                                               ofc_rig_contact_measure(classes, ACROSS, DOWN, depth, stride, size, mask, contact)
    assert_int_equal(MEASURE(classes[0], depth[0], stride, 0.5, mask[0], &out.contact), OFC_STATUS_OK);
    const double radius_square = 40 * 10 * 0.84, pi = 3.14159265358979;
    assert_true(fabs(out.contact.area - pi * radius_square * 0.25) < 2);
    assert_true(fabs(out.contact.center[0] - 70) < 1e-9 && fabs(out.contact.center[1] - 50) < 1e-9);
    assert_true(fabs(out.contact.peak - 5) < 1e-9);
    assert_true(out.contact.peak_place[0] == 70 && out.contact.peak_place[1] == 50);
    assert_true(out.contact.bounds[0] == 52 && out.contact.bounds[2] == 88);
    assert_true(mask[50][70] == 255 && mask[50][51] == 0 && mask[0][0] == 0);
    REFUSED(OFC_STATUS_NULL_POINTER, out, MEASURE(NULL, depth[0], stride, 1, NULL, &out.contact));
    REFUSED(OFC_STATUS_NULL_POINTER, out, MEASURE(classes[0], NULL, stride, 1, NULL, &out.contact));
    REFUSED(OFC_STATUS_NULL_POINTER, out, MEASURE(classes[0], depth[0], stride, 1, NULL, NULL));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, MEASURE(classes[0], depth[0], stride - 4, 1, NULL, &out.contact));
    REFUSED(OFC_STATUS_MISALIGNED, out, MEASURE(classes[0], depth[0], stride + 1, 1, NULL, &out.contact));
    REFUSED(OFC_STATUS_OVERLAP, out, MEASURE(classes[0], depth[0], stride, 1, classes[0], &out.contact));
    const double sizes[] = {0, -1, (double)NAN, (double)INFINITY};
    for (int i = 0; i < 4; i++)
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, MEASURE(classes[0], depth[0], stride, sizes[i], NULL, &out.contact));
    REFUSED(OFC_STATUS_EMPTY, out,
            ofc_rig_contact_measure(classes[0], 0, DOWN, depth[0], stride, 1, NULL, &out.contact));
    REFUSED(OFC_STATUS_TOO_LARGE, out,
            ofc_rig_contact_measure(classes[0], INT32_MAX, INT32_MAX, depth[0], stride, 1, NULL, &out.contact));
    memset(classes, OFC_RELIEF_PLANE, sizeof classes);
    REFUSED(OFC_STATUS_NO_RELIEF, out, MEASURE(classes[0], depth[0], stride, 1, NULL, &out.contact));
}

static ofc_status followed(const ofc_image *image)
{
    return ofc_rig_background_follow(image, NULL, 0, 0.5, out.normals[0][0], sizeof out.normals[0]);
}

static void a_background_is_followed(void **state)
{
    (void)state;
    static float background[DOWN][ACROSS][3];
    static uint8_t classes[DOWN][ACROSS];
    const size_t stride = sizeof background[0];
    float *const all = background[0][0];
    for (int i = 0; i < 3 * ALL; i++)
        all[i] = NAN;
    const ofc_image image = image_of(frame), below = image_of(plane);
#define FOLLOW(image, classes, level, rate, background, stride)                                                            ofc_rig_background_follow(image, classes, level, rate, background, stride)
    assert_int_equal(FOLLOW(&below, NULL, 0, 0.25, background[0][0], stride), OFC_STATUS_OK);
    assert_true(background[60][78][1] == (float)plane[60][78][1]);
    memset(classes, OFC_RELIEF_PLANE, sizeof classes);
    classes[60][78] = OFC_RELIEF_CONTACT;
    assert_int_equal(FOLLOW(&image, classes[0], 0, 0.25, background[0][0], stride), OFC_STATUS_OK);
    assert_true(background[60][78][1] == (float)plane[60][78][1]);
    assert_true(fabs(background[60][90][0] - (0.75 * plane[60][90][0] + 0.25 * frame[60][90][0])) < 1e-4);
    refuses_bad_images(followed, &out, sizeof out);
    float *target = out.normals[0][0];
    REFUSED(OFC_STATUS_NULL_POINTER, out, FOLLOW(&image, classes[0], 0, 0.25, NULL, stride));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, FOLLOW(&image, classes[0], 0, 0.25, target, 12));
    REFUSED(OFC_STATUS_MISALIGNED, out, FOLLOW(&image, classes[0], 0, 0.25, target, stride + 2));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, FOLLOW(&image, classes[0], -1, 0.25, target, stride));
    const double rates[] = {0, -0.5, 1.5, (double)NAN};
    for (int i = 0; i < 4; i++)
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, FOLLOW(&image, classes[0], 0, rates[i], target, stride));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(presses_are_learned), cmocka_unit_test(what_adds_nothing_has_a_reason),
        cmocka_unit_test(bad_arguments),       cmocka_unit_test(bad_models),
        cmocka_unit_test(models_are_kept),     cmocka_unit_test(a_contact_is_measured),
        cmocka_unit_test(a_background_is_followed),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
