/* counts PART: runs calls of the library under callgrind, which begins to count where a call begins and dumps the count under its name
 * where the call ends. Without callgrind it only says what became of the calls. Parts are there to run at the same time. */
#include "scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <valgrind/callgrind.h>

/* Counts a call, which must succeed. */
#define COUNT(pixels, name, call)                                                                                                  \
    do {                                                                                                                           \
        CALLGRIND_START_INSTRUMENTATION;                                                                                           \
        CALLGRIND_ZERO_STATS;                                                                                                      \
        const ofc_status status = (call);                                                                                          \
        char label[128];                                                                                                           \
        snprintf(label, sizeof label, "%ld %s", (long)(pixels), name);                                                             \
        CALLGRIND_DUMP_STATS_AT(label);                                                                                            \
        CALLGRIND_STOP_INSTRUMENTATION;                                                                                            \
        if (status != OFC_STATUS_OK) {                                                                                             \
            fprintf(stderr, "%s: %s\n", name, ofc_status_message(status));                                                         \
            exit(1);                                                                                                               \
        }                                                                                                                          \
    } while (0)

static ofc_solve_params params;
static ofc_solution solution;

static void *room(size_t bytes)
{
    void *memory = malloc(bytes);
    if (memory == NULL)
        exit(1);
    /* Pages that are not there yet would cost the system's time, but no instructions of ours. */
    return memset(memory, 1, bytes);
}

static void solve(const ofc_image *image, const char *name)
{
    const size_t need = ofc_solve_workspace_size(image->width, image->height, &params);
    void *workspace = room(need);
    COUNT(image->width * image->height, name, ofc_solve(image, &params, workspace, need, NULL, &solution));
    free(workspace);
}

/* Normals of every pixel format, and what belongs to them. */
static void normals(const struct scene *scene)
{
    static const struct {
        const char *name;
        ofc_pixel_format format;
    } formats[] = {
        {"normals dome RGB8", OFC_PIXEL_RGB8},       {"normals dome BGRA8", OFC_PIXEL_BGRA8},
        {"normals dome PLANES8", OFC_PIXEL_PLANES8}, {"normals dome RGB16", OFC_PIXEL_RGB16},
        {"normals dome BGRA16", OFC_PIXEL_BGRA16},   {"normals dome PLANES16", OFC_PIXEL_PLANES16},
        {"normals dome RGB32F", OFC_PIXEL_RGB32F},   {"normals dome BGRA32F", OFC_PIXEL_BGRA32F},
        {"normals dome PLANES32F", OFC_PIXEL_PLANES32F},
    };
    const int32_t pixels = scene->image.width * scene->image.height;
    const size_t stride = sizeof(float) * (size_t)scene->image.width;
    float *out = room((size_t)pixels * 3 * sizeof *out);
    const ofc_solution of_bytes = solution;
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        ofc_image image = converted(&scene->image, formats[i].format);
        solution = of_bytes;
        /* Values of 16 bits are 257 times as large: another picture with another solution. */
        if (formats[i].format / 10 == 1) {
            const size_t need = ofc_solve_workspace_size(image.width, image.height, &params);
            void *workspace = room(need);
            if (ofc_solve(&image, &params, workspace, need, NULL, &solution) != OFC_STATUS_OK)
                exit(1);
            free(workspace);
        }
        COUNT(pixels, formats[i].name, ofc_normals_compute(&image, &solution, out, 3 * stride));
        if (formats[i].format == OFC_PIXEL_RGB8) {
            image.mask = scene->mask;
            image.mask_stride_bytes = (size_t)image.width;
            COUNT(pixels, "normals dome RGB8 mask", ofc_normals_compute(&image, &solution, out, 3 * stride));
            COUNT(pixels, "uncertainty dome", ofc_normals_uncertainty(&image, &solution, out, stride));
        }
        free((void *)image.pixels);
    }
    free(out);
}

static void fit(int share, const char *name)
{
    const struct scene scene = points(640, 480, share);
    ofc_lmeds_params given = params.lmeds;
    const size_t need = ofc_lmeds_workspace_size(640, 480, &given);
    void *workspace = room(need);
    ofc_color_fit found;
    ofc_inlier_test test;
    COUNT(640 * 480, name, ofc_lmeds_fit(&scene.image, &given, workspace, need, &found, &test));
    free(workspace);
    free((void *)scene.image.pixels);
}

static void depth(int32_t size, int has_mask, const char *name)
{
    uint8_t *mask = room((size_t)size * (size_t)size);
    float *slopes = hills(size, mask), *out = room((size_t)size * (size_t)size * sizeof *out);
    const ofc_depth_input input = {.normals = slopes, .normals_stride_bytes = 12 * (size_t)size, .width = size, .height = size,
                                   .mask = has_mask ? mask : NULL, .mask_stride_bytes = (size_t)size};
    ofc_depth_params how;
    ofc_depth_result result;
    if (ofc_depth_params_default(&how) != OFC_STATUS_OK)
        exit(1);
    const size_t need = ofc_depth_workspace_size(size, size);
    void *workspace = room(need);
    COUNT(size * size, name, ofc_depth_integrate(&input, &how, workspace, need, out, 4 * (size_t)size, &result));
    free(workspace);
    free(mask);
    free(slopes);
    free(out);
}

static void complete(void)
{
    enum { SIDE = 160 };
    const struct scene scene = egg(SIDE, SIDE);
    ofc_image image = scene.image;
    image.mask = scene.mask;
    image.mask_stride_bytes = SIDE;
    solve(&image, "solve egg mask");
    ofc_surface_params how;
    ofc_surface_result result;
    if (ofc_surface_params_default(&how) != OFC_STATUS_OK)
        exit(1);
    const size_t need = ofc_surface_workspace_size(SIDE, SIDE);
    void *workspace = room(need);
    static float unit[SIDE * SIDE * 3], angle[SIDE * SIDE], height[SIDE * SIDE];
    static ofc_surface_class classes[SIDE * SIDE];
    COUNT(SIDE * SIDE, "complete egg",
          ofc_surface_complete(&image, &solution, &how, workspace, need, unit, 12 * SIDE, angle, 4 * SIDE, height, 4 * SIDE, classes,
                               SIDE, &result));
    free(workspace);
}

/* A rig of four presses, and what a frame costs then. */
static void rig(void)
{
    enum { W = 320, H = 240, RADIUS = 80 };
    static const double places[4][2] = {{110, 90}, {210, 90}, {110, 150}, {210, 150}};
    static ofc_rig rig;
    static ofc_rig_balls balls;
    static ofc_rig_model model;
    static ofc_relief relief;
    static ofc_relief_class classes[W * H];
    static float unit[W * H * 3], sigma[W * H];
    ofc_relief_params how;
    if (ofc_relief_params_default(&how) != OFC_STATUS_OK || ofc_rig_init(W, H, &rig, &balls) != OFC_STATUS_OK)
        exit(1);
    const size_t need = ofc_relief_workspace_size(W, H);
    void *workspace = room(need);
    const struct scene plane = gel(W, H, 0, 0, 0, 9), press = gel(W, H, RADIUS, 160, 120, 5);
    COUNT(W * H, "relief gel",
          ofc_relief_solve(&press.image, &plane.image, &how, workspace, need, classes, &relief));
    how.ball_radius = RADIUS;
    for (int i = 0; i < 4; i++) {
        const struct scene frame = gel(W, H, RADIUS, places[i][0], places[i][1], (uint64_t)(i + 1));
        ofc_no_relief reason;
        const ofc_image *image = &frame.image, *below = &plane.image;
        if (ofc_rig_add(&rig, &balls, image, below, &how, places[i], workspace, need, classes, &reason) != OFC_STATUS_OK)
            exit(1);
    }
    if (ofc_rig_solve(&rig, &balls, &how, &model) != OFC_STATUS_OK)
        exit(1);
    COUNT(W * H, "rig classify gel", ofc_rig_classify(&model, &press.image, &plane.image, workspace, need, classes));
    COUNT(W * H, "rig normals gel",
          ofc_rig_normals(&model, &press.image, &plane.image, classes, unit, 12 * W, sigma, 4 * W));
    free(workspace);
}

int main(int count, char **arguments)
{
    if (count != 2 || ofc_solve_params_default(&params) != OFC_STATUS_OK)
        return 2;
    if (strcmp(arguments[1], "solve") == 0) {
        const struct scene small = dome(256, 256), lit = dome(640, 480), shaded = egg(640, 480);
        solve(&small.image, "solve dome");
        solve(&shaded.image, "solve egg");
        params.orientation_method = OFC_ORIENTATION_DIRECT;
        solve(&lit.image, "solve dome direct");
        params.orientation_method = OFC_ORIENTATION_JOINT;
        solve(&lit.image, "solve dome");
        normals(&lit);
    } else {
        fit(0, "fit 0 % outliers");
        fit(40, "fit 40 % outliers");
        depth(512, 0, "depth rectangle");
        depth(512, 1, "depth disc");
        rig();
        complete();
    }
    return 0;
}
