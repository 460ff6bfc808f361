/* A relief on a plane: a bump, with the background and without it. */
#include "digest.h"
#include "inputs.h"
#include "stages.h"

enum { ACROSS = 72, DOWN = 56, ALL = ACROSS * DOWN };

static uint8_t frame[DOWN][ACROSS][3], plane[DOWN][ACROSS][3], classes[DOWN][ACROSS];
static float found[DOWN][ACROSS][3], uncertainty[DOWN][ACROSS];
static uint64_t room[36 * ALL / sizeof(uint64_t)];

/* A bump of (28^2 - r^2)^2 within the radius 28, in integers. */
static void render(void)
{
    static const int lights[3][3] = {{110, 20, 140}, {-80, 100, 130}, {-40, -110, 120}};
    for (int y = 0; y < DOWN; y++)
        for (int x = 0; x < ACROSS; x++) {
            const int u = x - 34, v = 27 - y, rest = 18 * 18 - u * u - v * v;
            const int p = rest > 0 ? -u * rest / 14 : 0, q = rest > 0 ? -v * rest / 14 : 0;
            const int length = (int)integer_root((uint32_t)(256 * 256 + p * p + q * q));
            for (int c = 0; c < 3; c++) {
                const int lit = (256 * lights[c][2] - p * lights[c][0] - q * lights[c][1]) / length;
                frame[y][x][c] = (uint8_t)((lit > 0 ? lit : 0) + (int)(random_bits() & 1));
                plane[y][x][c] = (uint8_t)(lights[c][2] + (int)(random_bits() & 1));
            }
        }
}

static void mix_found(const ofc_relief *relief)
{
    mix_doubles(relief->slopes, 6);
    mix_doubles(relief->plane, 45);
    mix_doubles(relief->noise, 3);
    mix_doubles(&relief->circulation, 10);
    const int32_t numbers[] = {relief->scale_source, relief->has_background, relief->reason, relief->width, relief->height};
    for (int i = 0; i < 5; i++)
        mix_status(numbers[i]);
    for (int i = 0; i < 4; i++)
        mix_status(relief->cells[i]);
}

static void mix_model(const ofc_rig_model *model)
{
    mix_doubles(model->slopes, 108);
    mix_doubles(model->plane, 45);
    mix_doubles(model->noise, 3);
    mix_doubles(&model->circulation, 7);
    const int32_t numbers[] = {model->terms, model->scale_source, model->advice, model->region};
    for (int i = 0; i < 4; i++)
        mix_status(numbers[i]);
}

/* The frame row by row. */
static void mix_rows(const ofc_rig_model *model, const ofc_image *image)
{
    static ofc_rig_rows rows;
    ofc_rig_contact contact = {.area = 0};
    ofc_image row = *image;
    row.height = 1;
    mix_status(ofc_rig_rows_begin(&rows));
    for (int y = 0; y < DOWN; y++) {
        row.pixels = (const uint8_t *)image->pixels + (size_t)y * image->row_stride_bytes;
        mix_status(ofc_rig_row(model, &rows, &row, NULL, classes[0], found[0][0]));
        mix_bytes(classes[0], ACROSS);
        mix_floats(found[0][0], 3 * ACROSS);
    }
    mix_status(ofc_rig_rows_contact(&rows, 0.0625, &contact));
    mix_doubles(&contact.area, 3);
}

/* The bump as the frame of a rig, and as a ball. */
static void mix_rig(const ofc_image *image, const ofc_image *background, const ofc_relief_params *params)
{
    static ofc_rig rig;
    static ofc_rig_balls balls;
    static ofc_rig_model model;
    const double center[2] = {34, 27};
    mix_status(ofc_rig_init(ACROSS, DOWN, &rig, &balls));
    mix_status(ofc_rig_add(&rig, &balls, image, background, params, center, room, sizeof room, NULL, NULL));
    const ofc_rig once = rig;
    mix_status(ofc_rig_merge(&rig, NULL, &once, NULL));
    mix_status(ofc_rig_solve(&rig, NULL, params, &model));
    mix_model(&model);
    mix_status(ofc_rig_set_scale(&rig, &model, 1.25, 0.125));
    mix_status(ofc_rig_solve(&rig, &balls, params, &model));
    mix_model(&model);
    mix_status(ofc_rig_classify(&model, image, background, room, sizeof room, classes[0]));
    mix_bytes(classes[0], ALL);
    mix_status(ofc_rig_normals(&model, image, background, classes[0], found[0][0], sizeof found[0], uncertainty[0],
                               sizeof uncertainty[0]));
    mix_floats(found[0][0], 3 * ALL);
    mix_floats(uncertainty[0], ALL);
    static uint8_t saved[OFC_RIG_MODEL_BYTES];
    mix_status(ofc_rig_model_save(&model, saved, sizeof saved));
    mix_bytes(saved, sizeof saved);
    mix_status(ofc_rig_model_load(saved, sizeof saved, &model));
    mix_model(&model);
    /* Any map will do for a depth. */
    ofc_rig_contact contact = {.area = 0};
    mix_status(ofc_rig_contact_measure(classes[0], ACROSS, DOWN, uncertainty[0], sizeof uncertainty[0], 0.0625, NULL,
                                       &contact));
    mix_doubles(&contact.area, 5);
    mix_status(ofc_rig_background_follow(image, classes[0], 0, 0.25, found[0][0], sizeof found[0]));
    mix_floats(found[0][0], 3 * ALL);
    mix_rows(&model, image);
}

void mix_relief(void)
{
    render();
    const ofc_image image = {
        .pixels = frame, .width = ACROSS, .height = DOWN, .row_stride_bytes = ACROSS * 3, .format = OFC_PIXEL_RGB8};
    ofc_image below = image;
    below.pixels = plane;
    ofc_relief_params params;
    mix_status(ofc_relief_params_default(&params));
    mix_integer(ofc_relief_workspace_size(ACROSS, DOWN));
    for (int given = 0; given < 2; given++) {
        const ofc_image *const background = given ? &below : NULL;
        ofc_relief relief;
        params.ball_radius = given ? 30 : 0;
        const ofc_status status =
            ofc_relief_solve(&image, background, &params, room, sizeof room, classes[0], &relief);
        mix_status(status);
        mix_found(&relief);
        if (status != OFC_STATUS_OK)
            continue;
        mix_bytes(classes[0], ALL);
        mix_status(ofc_relief_normals(&image, background, &relief, classes[0], found[0][0], sizeof found[0],
                                      uncertainty[0], sizeof uncertainty[0]));
        mix_floats(found[0][0], 3 * ALL);
        mix_floats(uncertainty[0], ALL);
    }
    /* Two planes differ by nothing. */
    ofc_relief relief;
    mix_status(ofc_relief_solve(&below, NULL, &params, room, sizeof room, classes[0], &relief));
    mix_found(&relief);
    params.ball_radius = 30;
    mix_rig(&image, &below, &params);
}
