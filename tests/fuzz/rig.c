/* Rigs: frames added, merged and solved, and rigs and models of any bits. */
#include "fuzz.h"

static int32_t width, height;

static void *map_of(int channels, size_t *stride)
{
    const size_t row = (size_t)width * (size_t)channels * sizeof(float);
    *stride = stride_of(row, sizeof(float));
    return take_rows(row, *stride, height, sizeof(float));
}

static void check_model(const ofc_rig_model *model)
{
    all_finite("slopes", model->slopes, 108);
    all_finite("plane", model->plane, 45);
    finite_or_nan("model", DOUBLES(model, noise, terms));
}

/* A frame into the rig. */
static void add(ofc_rig *rig, ofc_rig_balls *balls)
{
    const struct picture frame = picture_sized(width, height);
    const struct picture plane = one_in(3) ? picture_sized(width, height) : (struct picture){0};
    ofc_relief_params *const params = TAKE(ofc_relief_params, 1);
    ofc_relief_params_default(params);
    params->ball_radius = balls != NULL ? some_double(4, 40) : 0;
    change_some(params, sizeof *params);
    double *const center = TAKE(double, 2);
    center[0] = some_double(0, width), center[1] = some_double(0, height);
    const size_t bytes = ofc_relief_workspace_size(width, height);
    void *const workspace = workspace_of(bytes);
    uint8_t *const classes = take((size_t)width * (size_t)height, 1);
    ofc_no_relief *const reason = TAKE(ofc_no_relief, 1);
    const ofc_rig old = *rig;
    if (frame.bad || plane.bad)
        must_be_refused();
    const ofc_status status =
        CALL(ofc_rig_add(BAD(rig, params), balls, frame.bad ? frame.image : BAD(frame.image, NULL), plane.image, BAD(params, NULL),
                         below(2) ? NULL : center, bad_sometimes(workspace, 8, params), bytes, below(2) ? NULL : classes, reason),
             workspace, rig, reason, classes, balls);
    if (status == OFC_STATUS_OK)
        all_finite("rig", DOUBLES(rig, circulation, coverage));
    else if (memcmp(&old, rig, sizeof old) != 0)
        fail("a rig changed with status %d", status);
}

static void use(const ofc_rig_model *model)
{
    const struct picture frame = picture_sized(width, height);
    const size_t bytes = ofc_relief_workspace_size(width, height);
    void *const workspace = workspace_of(bytes);
    uint8_t *const classes = take((size_t)width * (size_t)height, 1);
#define IMAGE (frame.bad ? (must_be_refused(), frame.image) : BAD(frame.image, NULL))
    if (CALL(ofc_rig_classify(BAD(model, NULL), IMAGE, NULL, bad_sometimes(workspace, 8, NULL), bytes, bad_sometimes(classes, 1, NULL)),
             workspace, classes) != OFC_STATUS_OK)
        memset(classes, OFC_RELIEF_CONTACT, (size_t)width * (size_t)height);
    size_t stride, single;
    float *const normals = map_of(3, &stride), *const uncertainty = map_of(1, &single);
    if (CALL(ofc_rig_normals(BAD(model, NULL), IMAGE, NULL, classes, BAD(normals, NULL), stride, below(2) ? NULL : uncertainty, single),
             normals, uncertainty) == OFC_STATUS_OK)
        for (int32_t y = 0; y < height; y++) {
            floats_finite_or_nan("normals of a rig", (const float *)((const char *)normals + (size_t)y * stride), 3 * (size_t)width);
            floats_finite_or_nan("uncertainty of a rig", (const float *)((const char *)uncertainty + (size_t)y * single), (size_t)width);
        }
}

/* A frame row by row, which may have been begun or hold any numbers. */
static void look(const ofc_rig_model *model)
{
    ofc_rig_rows *const rows = TAKE(ofc_rig_rows, 1);
    uint8_t *const classes = take((size_t)width, 1);
    float *const normals = TAKE(float, 3 * (size_t)width);
    if (CALL(ofc_rig_rows_begin(BAD(rows, NULL)), rows) != OFC_STATUS_OK || one_in(4))
        change(rows, sizeof *rows, 1 + below(8));
    for (int i = 0; i < 3; i++) {
        const struct picture frame = picture_sized(width, 1);
        if (CALL(ofc_rig_row(BAD(model, NULL), BAD(rows, NULL), IMAGE, NULL, below(2) ? NULL : classes, one_in(4) ? NULL : normals), rows, classes,
                 normals) == OFC_STATUS_OK)
            floats_finite_or_nan("normals of a row", normals, 3 * (size_t)width);
    }
    ofc_rig_contact *const contact = TAKE(ofc_rig_contact, 1);
    CALL(ofc_rig_rows_contact(BAD(rows, NULL), some_double(0.01, 10), BAD(contact, rows)), contact);
}

/* A model as bytes, changed and read again. */
static void keep(const ofc_rig_model *model)
{
    uint8_t *const bytes = take(OFC_RIG_MODEL_BYTES, 1);
    const size_t size = OFC_RIG_MODEL_BYTES - (size_t)one_in(16);
    if (CALL(ofc_rig_model_save(BAD(model, NULL), bad_sometimes(bytes, 1, NULL), size), bytes) != OFC_STATUS_OK)
        return;
    const int changed = one_in(2);
    if (changed)
        change(bytes, OFC_RIG_MODEL_BYTES, 1 + below(4));
    ofc_rig_model *const read = TAKE(ofc_rig_model, 1);
    const ofc_status status = CALL(ofc_rig_model_load(bad_sometimes(bytes, 1, NULL), size, BAD(read, bytes)), read);
    if (status == OFC_STATUS_OK)
        check_model(read);
    if (status == OFC_STATUS_OK && !changed && memcmp(read->slopes, model->slopes, sizeof read->slopes) != 0)
        fail("a model is another one after it was kept");
}

/* What is pressed in, of any depths, and a background of any numbers. */
static void measure(void)
{
    const size_t pixels = (size_t)width * (size_t)height;
    uint8_t *const classes = take(pixels, 1), *const mask = take(pixels, 1);
    for (size_t i = 0; i < pixels; i++)
        classes[i] = i % 7 < 3 ? OFC_RELIEF_CONTACT : OFC_RELIEF_PLANE;
    change_some(classes, pixels);
    size_t stride, wide;
    float *const depth = map_of(1, &stride), *const background = map_of(3, &wide);
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++)
            ((float *)((char *)depth + (size_t)y * stride))[x] = one_in(64) ? any_float() : (float)(x % 5);
    ofc_rig_contact *const contact = TAKE(ofc_rig_contact, 1);
    if (CALL(ofc_rig_contact_measure(classes, width, height, BAD(depth, NULL), stride, some_double(0.01, 10),
                                     below(2) ? NULL : mask, BAD(contact, classes)),
             contact, mask) == OFC_STATUS_OK)
        all_finite("contact", DOUBLES(contact, area, peak_place));
    const struct picture frame = picture_sized(width, height);
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < 3 * width; x++)
            ((float *)((char *)background + (size_t)y * wide))[x] = one_in(64) ? any_float() : 100;
    CALL(ofc_rig_background_follow(IMAGE, below(2) ? NULL : classes, some_double(0, 250), some_double(0.01, 1), BAD(background, NULL),
                                   wide),
         background);
}

void target(void)
{
    width = 32 + below(24);
    height = 32 + below(24);
    ofc_rig *const rig = TAKE(ofc_rig, 1), *const other = TAKE(ofc_rig, 1);
    ofc_rig_balls *const balls = below(2) ? TAKE(ofc_rig_balls, 1) : NULL, *const other_balls = balls != NULL ? TAKE(ofc_rig_balls, 1) : NULL;
    const int32_t any_width = one_in(32) ? any_int() : width;
    if (CALL(ofc_rig_init(any_width, height, BAD(rig, NULL), balls), rig, balls) != OFC_STATUS_OK || any_width != width)
        return;
    if (CALL(ofc_rig_init(width, height, other, other_balls), other, other_balls) != OFC_STATUS_OK)
        fail("no rig of %d x %d", width, height);
    for (int i = below(3); i > 0; i--)
        add(rig, balls);
    if (one_in(4))
        change(rig, sizeof *rig, 1 + below(8));
    if (balls != NULL && one_in(4))
        change(balls, sizeof *balls, 1 + below(8));
    if (one_in(3)) {
        change_some(other, sizeof *other);
        if (CALL(ofc_rig_merge(BAD(rig, other), balls, BAD(other, NULL), other_balls), rig, balls) == OFC_STATUS_OK)
            all_finite("merged", DOUBLES(rig, circulation, coverage));
    }
    ofc_relief_params *const params = TAKE(ofc_relief_params, 1);
    ofc_relief_params_default(params);
    change_some(params, sizeof *params);
    ofc_rig_model *const model = TAKE(ofc_rig_model, 1);
    memset(model, 0, sizeof *model);
    model->width = width, model->height = height, model->terms = 3, model->frames = 1;
    for (int i = 0; i < 6; i++)
        model->slopes[i] = i % 4 == 0 ? 0.5 : 0.1;
    model->plane[0] = model->plane[15] = model->plane[30] = 100;
    const ofc_rig_model old = *model;
    const ofc_status status = CALL(ofc_rig_solve(BAD(rig, NULL), balls, BAD(params, NULL), BAD(model, rig)), model);
#ifdef PLANTED_FAULT
    if (status == OFC_STATUS_NO_RELIEF && balls != NULL)
        model->terms ^= 1;
#endif
    if (status == OFC_STATUS_NO_RELIEF || status == OFC_STATUS_UNDETERMINED) {
        if (memcmp(&old, model, sizeof old) != 0)
            fail("a model of no rig, with status %d", status);
    } else if (status >= 0) {
        check_model(model);
    }
    if (one_in(2))
        change(model, sizeof *model, 1 + below(8));
    if (CALL(ofc_rig_set_scale(BAD(rig, model), BAD(model, NULL), some_double(0.1, 3), some_double(0, 1)), rig) == OFC_STATUS_OK)
        all_finite("scale", &rig->scale, 2);
    use(model);
    look(model);
    keep(model);
    measure();
}
