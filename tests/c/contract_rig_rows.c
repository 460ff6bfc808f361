/* A frame that is seen row by row: its normals and its contact, pixels that say nothing, and bad arguments. */
#include "ball.h"

static struct {
    uint8_t classes[DOWN][ACROSS];
    float normals[DOWN][ACROSS + 1][3];
    ofc_rig_contact contact;
    ofc_rig_rows rows;
} out, kept;

static ofc_rig_model model;

/* What is refused changes nothing. */
#define REFUSED_AS_IT_WAS(status, call)                                                                                \
    do {                                                                                                               \
        memcpy(&kept, &out, sizeof out);                                                                               \
        assert_int_equal(call, status);                                                                                \
        assert_memory_equal(&kept, &out, sizeof out);                                                                  \
    } while (0)

/* Learns the model from four presses of a ball. */
static int prepare(void **state)
{
    (void)state;
    ofc_rig rig;
    ofc_rig_balls balls;
    shade(cap, 78, 60);
    int failed = ofc_relief_params_default(&params) != OFC_STATUS_OK;
    params.ball_radius = radius;
    failed |= ofc_rig_init(ACROSS, DOWN, &rig, &balls) != OFC_STATUS_OK;
    for (int i = 0; i < 4; i++) {
        const ofc_image image = image_of(frame), below = image_of(plane);
        shade(cap, places[i][0], places[i][1]);
        failed |= ofc_rig_add(&rig, &balls, &image, &below, &params, NULL, room, sizeof room, NULL, NULL) != OFC_STATUS_OK;
    }
    failed |= ofc_rig_solve(&rig, &balls, &params, &model) != OFC_STATUS_OK;
    shade(cap, 78, 60);
    return failed;
}

static ofc_image row_of(const void *pixels, int y)
{
    ofc_image row = image_of(pixels);
    row.pixels = (const uint8_t *)pixels + (size_t)y * ACROSS * 3;
    row.height = 1;
    return row;
}

static ofc_status looked(const ofc_image *image)
{
    return ofc_rig_row(&model, &out.rows, image, NULL, out.classes[0], out.normals[0][0]);
}

static void rows_are_seen(void **state)
{
    (void)state;
    static uint8_t classes[DOWN][ACROSS];
    static float normals[DOWN][ACROSS + 1][3];
    ofc_rig_contact contact;
    for (int has_background = 0; has_background < 2; has_background++) {
        assert_int_equal(ofc_rig_rows_begin(&out.rows), OFC_STATUS_OK);
        memset(&out.contact, PATTERN, sizeof out.contact);
        REFUSED(OFC_STATUS_NO_RELIEF, out.contact, ofc_rig_rows_contact(&out.rows, 0.5, &out.contact));
        for (int y = 0; y < DOWN; y++) {
            const ofc_image row = row_of(frame, y), below = row_of(plane, y);
            assert_int_equal(ofc_rig_row(&model, &out.rows, &row, has_background ? &below : NULL, classes[y], normals[y][0]),
                             OFC_STATUS_OK);
        }
        assert_true(mean_error(classes, normals, 500) < 0.06);
        assert_true(normals[3][3][2] == 1 && classes[3][3] == OFC_RELIEF_PLANE);
        assert_int_equal(ofc_rig_rows_contact(&out.rows, 0.5, &contact), OFC_STATUS_OK);
        assert_true(fabs(contact.center[0] - 78) < 1 && fabs(contact.center[1] - 60) < 1);
        int pixels = 0;
        for (int i = 0; i < ALL; i++)
            pixels += classes[i / ACROSS][i % ACROSS] == OFC_RELIEF_CONTACT;
        assert_true(fabs(contact.area - 0.25 * pixels) < 1e-9 && isnan(contact.peak) && contact.peak_place[0] == -1);
        assert_true(contact.bounds[0] < 60 && contact.bounds[1] < 42 && contact.bounds[2] > 96 && contact.bounds[3] > 78);
    }
    const ofc_image row = row_of(frame, 0), plain = row_of(plane, 0);
#define ROW(model, rows, image, background, classes, normals) ofc_rig_row(model, rows, image, background, classes, normals)
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(ofc_rig_rows_begin(&out.rows), OFC_STATUS_OK);
    for (int y = 0; y < DOWN; y++)
        assert_int_equal(ROW(&model, &out.rows, &plain, NULL, NULL, NULL), OFC_STATUS_OK);
    /* Whatever it is refused for, the frame stays as it was, and so do classes and normals. */
    const ofc_rig_rows all = out.rows;
    memset(&out, PATTERN, sizeof out);
    out.rows = all;
    REFUSED_AS_IT_WAS(OFC_STATUS_TOO_MANY_ROWS, ROW(&model, &out.rows, &row, NULL, out.classes[0], out.normals[0][0]));
    assert_int_equal(ofc_rig_rows_begin(&out.rows), OFC_STATUS_OK);
    refuses_bad_images(looked, out.classes, sizeof out.classes);
    const ofc_image narrow = {.pixels = frame, .width = ACROSS - 1, .height = 1, .row_stride_bytes = ACROSS * 3, .format = OFC_PIXEL_RGB8};
    const ofc_image whole = image_of(frame);
    REFUSED_AS_IT_WAS(OFC_STATUS_ROW_MISMATCH, looked(&narrow));
    REFUSED_AS_IT_WAS(OFC_STATUS_ROW_MISMATCH, looked(&whole));
    REFUSED_AS_IT_WAS(OFC_STATUS_ROW_MISMATCH, ROW(&model, &out.rows, &row, &narrow, NULL, NULL));
    REFUSED_AS_IT_WAS(OFC_STATUS_NULL_POINTER, ROW(NULL, &out.rows, &row, NULL, NULL, NULL));
    REFUSED_AS_IT_WAS(OFC_STATUS_NULL_POINTER, ROW(&model, NULL, &row, NULL, NULL, NULL));
    REFUSED_AS_IT_WAS(OFC_STATUS_NULL_POINTER, looked(NULL));
    REFUSED_AS_IT_WAS(OFC_STATUS_OVERLAP, ROW(&model, &out.rows, &row, NULL, NULL, (float *)(void *)out.rows.sums));
    REFUSED_AS_IT_WAS(OFC_STATUS_OVERLAP, ROW(&model, &out.rows, &row, NULL, (uint8_t *)frame, NULL));
    REFUSED_AS_IT_WAS(OFC_STATUS_MISALIGNED, ROW(&model, &out.rows, &row, NULL, NULL, (float *)(void *)&out.classes[0][1]));
    ofc_rig_model bad = model;
    bad.terms = 0;
    REFUSED_AS_IT_WAS(OFC_STATUS_NOT_SOLVED, ROW(&bad, &out.rows, &row, NULL, NULL, NULL));
    bad.terms = 4;
    REFUSED_AS_IT_WAS(OFC_STATUS_INVALID_PARAMETER, ROW(&bad, &out.rows, &row, NULL, NULL, NULL));
    double *const numbers[] = {&bad.slopes[7], &bad.plane[3], &bad.noise[1], &bad.saturation};
    for (int i = 0; i < 4; i++) {
        bad = model;
        *numbers[i] = (double)NAN;
        REFUSED_AS_IT_WAS(OFC_STATUS_INVALID_PARAMETER, ROW(&bad, &out.rows, &row, NULL, NULL, NULL));
    }
    bad = model;
    bad.height = 0;
    REFUSED_AS_IT_WAS(OFC_STATUS_INVALID_PARAMETER, ROW(&bad, &out.rows, &row, NULL, NULL, NULL));
    REFUSED_AS_IT_WAS(OFC_STATUS_NULL_POINTER, ofc_rig_rows_begin(NULL));
    REFUSED_AS_IT_WAS(OFC_STATUS_NULL_POINTER, ofc_rig_rows_contact(NULL, 1, &out.contact));
    REFUSED_AS_IT_WAS(OFC_STATUS_NULL_POINTER, ofc_rig_rows_contact(&out.rows, 1, NULL));
    const double sizes[] = {0, -1, INFINITY, (double)NAN};
    for (int i = 0; i < 4; i++)
        REFUSED_AS_IT_WAS(OFC_STATUS_INVALID_PARAMETER, ofc_rig_rows_contact(&out.rows, sizes[i], &out.contact));
    /* A frame that nobody began may hold anything. */
    memset(&out.rows, 0xff, sizeof out.rows);
    assert_int_equal(looked(&row), OFC_STATUS_OK);
}

/* Frame and plane at twice their size, so that cells have two columns and two rows and some pixels are beyond the last whole cell: as floats, which may
   be no numbers, and a mask. */
enum { WIDE = 2 * ACROSS + 3, TALL = 2 * DOWN + 1 };
static float colors[TALL][WIDE][3], untouched[TALL][WIDE][3];
static uint8_t mask[TALL][WIDE], classes[TALL][WIDE];
static float normals[TALL][WIDE][3];

static void reset(void)
{
    for (int y = 0; y < TALL; y++)
        for (int x = 0; x < WIDE; x++)
            for (int c = 0; c < 3; c++) {
                const int from_x = x < 2 * ACROSS ? x / 2 : ACROSS - 1, from_y = y < 2 * DOWN ? y / 2 : DOWN - 1;
                colors[y][x][c] = frame[from_y][from_x][c];
                untouched[y][x][c] = plane[from_y][from_x][c];
            }
    memset(mask, 1, sizeof mask);
}

/* Sets the colors of a patch. */
static void patch(float picture[TALL][WIDE][3], int left, int top, int width, int height, float color)
{
    for (int y = top; y < top + height; y++)
        for (int x = left; x < left + width; x++)
            for (int c = 0; c < 3; c++)
                picture[y][x][c] = color;
}

static ofc_image whole_of(float picture[TALL][WIDE][3], int width)
{
    const ofc_image image = {.pixels = picture, .width = width, .height = TALL, .row_stride_bytes = sizeof picture[0],
                             .format = OFC_PIXEL_RGB32F, .mask = picture == colors ? mask[0] : NULL, .mask_stride_bytes = WIDE};
    return image;
}

static ofc_image float_row_of(float picture[TALL][WIDE][3], int y, int width)
{
    ofc_image row = whole_of(picture, width);
    row.pixels = picture[y];
    row.mask = row.mask == NULL ? NULL : mask[y];
    row.height = 1;
    return row;
}

enum { NO_BACKGROUND, BACKGROUND, EVERY_OTHER_ROW };

/* The contact of a frame this wide. It is what the classes say, and each class has its normals. */
static ofc_rig_contact contact_of(int width, int background)
{
    ofc_rig_model given = model;
    given.width = width;
    given.height = TALL;
    given.saturation = 250;
    ofc_rig_contact contact = {0};
    double count = 0, sums[2] = {0, 0};
    int bounds[4] = {WIDE, TALL, -1, -1};
    assert_int_equal(ofc_rig_rows_begin(&out.rows), OFC_STATUS_OK);
    for (int y = 0; y < TALL; y++) {
        const ofc_image row = float_row_of(colors, y, width), below = float_row_of(untouched, y, width);
        const int has_background = background == BACKGROUND || (background == EVERY_OTHER_ROW && y % 2 == 0);
        assert_int_equal(ofc_rig_row(&given, &out.rows, &row, has_background ? &below : NULL, classes[y], normals[y][0]),
                         OFC_STATUS_OK);
        for (int x = 0; x < width; x++) {
            const float *n = normals[y][x];
            const int class = classes[y][x];
            if (class == OFC_RELIEF_NONE)
                assert_true(isnan(n[0]) && isnan(n[1]) && isnan(n[2]));
            else
                assert_true(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-4);
            if (class == OFC_RELIEF_PLANE)
                assert_true(n[2] == 1);
            if (class != OFC_RELIEF_CONTACT)
                continue;
            count++;
            sums[0] += x;
            sums[1] += y;
            bounds[0] = x < bounds[0] ? x : bounds[0];
            bounds[1] = y < bounds[1] ? y : bounds[1];
            bounds[2] = x > bounds[2] ? x : bounds[2];
            bounds[3] = y > bounds[3] ? y : bounds[3];
        }
    }
    assert_int_equal(ofc_rig_rows_contact(&out.rows, 1, &contact), OFC_STATUS_OK);
    assert_true(contact.area == count && count > 500);
    assert_true(fabs(contact.center[0] - sums[0] / count) < 1e-9 && fabs(contact.center[1] - sums[1] / count) < 1e-9);
    for (int i = 0; i < 4; i++)
        assert_int_equal(contact.bounds[i], bounds[i]);
    return contact;
}

static int count_of(int class, int left, int top, int width, int height)
{
    int count = 0;
    for (int y = top; y < top + height; y++)
        for (int x = left; x < left + width; x++)
            count += classes[y][x] == class;
    return count;
}

static void what_says_nothing_is_no_contact(void **state)
{
    (void)state;
    for (int background = NO_BACKGROUND; background <= BACKGROUND; background++) {
        reset();
        const ofc_rig_contact clean = contact_of(WIDE, background);
        assert_int_equal(count_of(OFC_RELIEF_NONE, 0, 0, WIDE, TALL), 0);
        /* Far from the ball: saturated, no number, infinite; in the mask or not. */
        const float levels[] = {255, NAN, INFINITY};
        for (int i = 0; i < 4; i++) {
            reset();
            patch(colors, 4, 4, 24, 32, levels[i % 3]);
            if (i == 3)
                for (int y = 4; y < 36; y++)
                    memset(&mask[y][4], 0, 24);
            const ofc_rig_contact contact = contact_of(WIDE, background);
            assert_memory_equal(&contact.center, &clean.center, sizeof clean.center);
            assert_true(contact.area == clean.area);
            assert_int_equal(count_of(OFC_RELIEF_NONE, 4, 4, 24, 32), 24 * 32);
            assert_int_equal(count_of(OFC_RELIEF_NONE, 0, 0, WIDE, TALL), 24 * 32);
        }
        /* Of the last cells half is saturated. */
        reset();
        patch(colors, 4, 4, 25, 32, 255);
        assert_true(contact_of(WIDE, background).area == clean.area);
        /* A marker is dark, no contact, and so is what is near it. */
        reset();
        patch(colors, 4, 4, 24, 32, 10);
        assert_true(contact_of(WIDE, background).area == clean.area);
        /* On the ball: highlights, and a hole in the mask. */
        reset();
        patch(colors, 121, 112, 1, 8, 255);
        patch(colors, 190, 112, 1, 8, NAN);
        for (int y = 130; y < 134; y++)
            memset(&mask[y][116], 0, 8);
        assert_true(contact_of(WIDE, background).area == clean.area - 48);
    }
    /* A background that is not known. */
    const float levels[] = {NAN, INFINITY, 0};
    reset();
    const ofc_rig_contact clean = contact_of(WIDE, BACKGROUND);
    for (int i = 0; i < 3; i++) {
        reset();
        patch(untouched, 4, 4, 24, 32, levels[i]);
        const ofc_rig_contact contact = contact_of(WIDE, BACKGROUND);
        assert_true(contact.area == clean.area);
        assert_int_equal(count_of(OFC_RELIEF_NONE, 0, 0, WIDE, TALL), 24 * 32);
    }
}

static void a_background_may_come_and_go(void **state)
{
    (void)state;
    reset();
    const double with = contact_of(WIDE, BACKGROUND).area, every_other = contact_of(WIDE, EVERY_OTHER_ROW).area;
    assert_true(fabs(every_other - with) < 0.1 * with);
    assert_int_equal(count_of(OFC_RELIEF_NONE, 0, 0, WIDE, TALL), 0);
}

/* Pixels beyond the last whole cell are counted too. */
static void widths_are_no_multiples_of_cells(void **state)
{
    (void)state;
    reset();
    for (int width = 201; width > 199; width--)
        assert_true(contact_of(width, BACKGROUND).bounds[2] == width - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_seen),
        cmocka_unit_test(what_says_nothing_is_no_contact),
        cmocka_unit_test(a_background_may_come_and_go),
        cmocka_unit_test(widths_are_no_multiples_of_cells),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
