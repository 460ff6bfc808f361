/* What files hold, made what the model wants: transfer curves, clipping, dark frames and offsets. */
#include "fuzz.h"

static struct picture picture;
static float *out;
static size_t stride;

static ofc_image *image(void)
{
    if (picture.bad)
        must_be_refused();
    return picture.bad ? picture.image : BAD(picture.image, NULL);
}

static void check_picture(const char *what, ofc_status status)
{
    for (int32_t y = 0; status == OFC_STATUS_OK && y < picture.height; y++)
        floats_finite_or_nan(what, (const float *)((const char *)out + (size_t)y * stride), 3 * (size_t)picture.width);
}

static ofc_transfer any_transfer(void)
{
    return one_in(16) ? any_int() : 1 + below(3);
}

static void transfer(void)
{
    const int32_t usual = one_in(16) ? 65536 : 256, said = one_in(32) ? any_int() : usual;
    const int32_t count = said == 256 || said == 65536 ? said : usual;
    float *const table = TAKE(float, count);
    if (said != count)
        must_be_refused();
    if (CALL(ofc_transfer_table(any_transfer(), some_double(0.2, 4), said, BAD(table, NULL)), table) == OFC_STATUS_OK)
        floats_finite("table", table, (size_t)count);
    else
        for (int32_t i = 0; i < count; i++)
            table[i] = (float)i;
    if (one_in(8))
        table[below(256)] = any_float();
    const ofc_transfer curve = any_transfer();
    const int has_table = one_in(16) ? below(2) : curve == OFC_TRANSFER_TABLE;
    check_picture("linear", CALL(ofc_transfer_linearize(image(), curve, some_double(0.2, 4), has_table ? table : NULL, has_table ? count : 0,
                                                        BAD(out, NULL), stride),
                                 out));
}

static void saturation(void)
{
    double *const level = TAKE(double, 1);
    int32_t *const count = TAKE(int32_t, 1);
    if (CALL(ofc_saturation_find(image(), BAD(level, NULL), below(2) ? NULL : count), level, count) == OFC_STATUS_OK)
        all_finite("level", level, 1);
}

static void dark(void)
{
    const struct picture other = one_in(16) ? picture_of(28, 28) : picture_sized(picture.width, picture.height);
    if (other.bad)
        must_be_refused();
    check_picture("without its dark frame", CALL(ofc_dark_subtract(image(), other.image, BAD(out, NULL), stride), out));
}

static void offset(void)
{
    double *const color = TAKE(double, 3), *const c = TAKE(double, 6);
    for (int i = 0; i < 3; i++)
        color[i] = some_double(-5, 30);
    check_picture("without its offset", CALL(ofc_offset_subtract(image(), BAD(color, NULL), BAD(out, color), stride), out));
    const double scale = some_double(0, 2) * (picture.image->format < 10 ? 1e-4 : 1);
    for (int i = 0; i < 6; i++)
        c[i] = one_in(16) ? any_double() : i < 3 ? scale : 0.1 * scale;
    const int32_t sample = one_in(16) ? any_int() : 60 + byte();
    const size_t need = ofc_offset_workspace_size(sample), room = need > 100000 ? 8 : need;
    if (need == 0 || room < need)
        must_be_refused();
    void *const workspace = workspace_of(room);
    const ofc_inlier_test *const test = any_inlier_test();
    ofc_offset *const found = TAKE(ofc_offset, 1);
    const ofc_status status = CALL(ofc_offset_fit(image(), test, BAD(c, NULL), sample, bad_sometimes(workspace, 8, c), room,
                                                  BAD(found, c)),
                                   workspace, found);
#ifdef PLANTED_FAULT
    if (picture.image->format > 20 && sample < 100 && status < 0)
        found->count = 1, call_end("planted", status, (void *const[]){found, NULL});
#endif
    if (status == OFC_STATUS_OK)
        all_finite("offset", DOUBLES(found, offset, count));
}

void target(void)
{
    static void (*const calls[])(void) = {transfer, saturation, dark, offset};
    picture = picture_of(28, 28);
    const size_t row = (size_t)picture.width * 3 * sizeof(float);
    stride = stride_of(row, sizeof(float));
    out = take_rows(row, stride, picture.height, sizeof(float));
    calls[below(sizeof calls / sizeof *calls)]();
}
