#include "fuzz.h"

/* What a pixel's color is made of. */
enum shape { BALL, WAVES, GROOVE, SPIKES, ANY_COLORS, ANY_BYTES, PLANE_WITH_BUMP, ONE_COLOR, SHAPES };

size_t sample_bytes(ofc_pixel_format format)
{
    return format < 10 ? 1 : format < 20 ? 2 : 4;
}

static int is_planar(ofc_pixel_format format)
{
    return format % 10 == 5;
}

size_t pixel_bytes(ofc_pixel_format format)
{
    const int kind = format % 10;
    return sample_bytes(format) * (kind == 5 ? 1 : kind == 3 || kind == 4 ? 4 : 3);
}

static void store(uint8_t *at, ofc_pixel_format format, double value)
{
    if (format < 10) {
        *at = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value + 0.5);
    } else if (format < 20) {
        const uint16_t sample = (uint16_t)(value < 0 ? 0 : value > 65535 ? 65535 : value + 0.5);
        memcpy(at, &sample, sizeof sample);
    } else {
        const float sample = (float)value;
        memcpy(at, &sample, sizeof sample);
    }
}

/* A normal at a place from -1 to 1, or 0 for the background. */
static int normal_at(enum shape shape, double x, double y, double *normal)
{
    double p = 0, q = 0;
    switch (shape) {
    case BALL:
        if (x * x + y * y >= 1)
            return 0;
        normal[0] = x, normal[1] = y, normal[2] = sqrt(1 - x * x - y * y);
        return 1;
    case WAVES:
        p = x * (1 - 2 * y * y), q = y * (1 - 1.5 * x * x) + 0.3 * x;
        break;
    case GROOVE:
        p = 2 * x;
        break;
    case SPIKES:
        p = 4 * random_unit() - 2, q = 4 * random_unit() - 2;
        break;
    case PLANE_WITH_BUMP:
        if (x * x + y * y < 0.2)
            p = 2 * x, q = 2 * y;
        break;
    default:
        break;
    }
    const double length = sqrt(1 + p * p + q * q);
    normal[0] = p / length, normal[1] = q / length, normal[2] = 1 / length;
    return 1;
}

struct scene {
    enum shape shape;
    double f[9], scale, noise, wild, x, y, radius;
    int clamps, is_float;
};

static struct scene any_scene(ofc_pixel_format format, int32_t width, int32_t height)
{
    static const double directions[9] = {0.7, 0.1, 0.7, -0.3, 0.65, 0.7, -0.4, -0.6, 0.7};
    struct scene scene = {.shape = (enum shape)below(SHAPES), .is_float = format > 20};
    const uint8_t options = byte();
    random_begin(word32());
    scene.scale = format < 10 ? 120 : format < 20 ? 30000 : 0.6;
    if (scene.is_float && options & 1)
        scene.scale = ldexp(1, (int8_t)byte());
    scene.noise = (options >> 1 & 3) * 0.004 * (options & 8 ? 4 : 1);
    scene.wild = options & 64 ? 0.1 : 0;
    scene.clamps = !(options & 32);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            const double color = options & 16 ? random_unit() : c == k ? 1 : 0.15 * random_unit();
            for (int axis = 0; axis < 3; axis++)
                scene.f[3 * c + axis] += color * directions[3 * k + axis];
        }
    scene.x = width / 2.0 + (random_unit() - 0.5) * width * 0.2;
    scene.y = height / 2.0 + (random_unit() - 0.5) * height * 0.2;
    scene.radius = (width < height ? width : height) * (0.4 + 0.2 * random_unit()) + 0.7;
    return scene;
}

static void color_at(const struct scene *scene, int32_t x, int32_t y, double *color)
{
    double normal[3];
    color[0] = color[1] = color[2] = 0;
    if (scene->shape == ANY_BYTES) {
        for (int c = 0; c < 3; c++)
            color[c] = scene->is_float ? any_float() : scene->scale * byte() / 100;
    } else if (scene->shape == ANY_COLORS || random_unit() < scene->wild) {
        for (int c = 0; c < 3; c++)
            color[c] = scene->scale * random_unit() * 1.3;
    } else if (scene->shape == ONE_COLOR) {
        for (int c = 0; c < 3; c++)
            color[c] = scene->scale * (c + 1) / 3;
    } else if (normal_at(scene->shape, (x + 0.5 - scene->x) / scene->radius, (scene->y - y - 0.5) / scene->radius, normal)) {
        for (int c = 0; c < 3; c++) {
            double value = 0;
            for (int axis = 0; axis < 3; axis++)
                value += scene->f[3 * c + axis] * normal[axis];
            value = scene->clamps && value < 0 ? 0 : value;
            color[c] = scene->scale * (value + scene->noise * (random_unit() + random_unit() - 1));
        }
    }
}

static const uint8_t *any_mask(int32_t width, int32_t height, size_t *stride)
{
    *stride = stride_of((size_t)width, 1);
    uint8_t *const mask = take_rows((size_t)width, *stride, height, 1);
    const int kind = below(5);
    const double ratio = byte() / 255.0;
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            const uint8_t values[] = {255, (uint8_t)random_bits(), random_unit() < ratio ? 255 : 0, x % 3 != 0, 0};
            mask[(size_t)y * *stride + (size_t)x] = values[kind];
        }
    return mask;
}

/* Makes one field wrong, so that the picture must be refused. */
static int spoil(ofc_image *image, size_t row_bytes)
{
    const int32_t rows = image->height;
    switch (below(14)) {
    case 0: image->pixels = NULL; return 1;
    case 1: image->width = -image->width; return 1;
    case 2: image->height = one_in(2) ? 0 : INT32_MIN; return 1;
    case 3: image->format += 5 + below(2) * 250; return 1;
    case 4: image->reserved = word32() | 1; return 1;
    case 5: image->row_stride_bytes = row_bytes - 1; return rows > 1;
    case 6: image->row_stride_bytes = 0; return rows > 1;
    case 7: image->row_stride_bytes = SIZE_MAX - byte(); return rows > 1;
    case 8: image->width = image->height = 46341; return 1;
    case 9: image->width = image->height = INT32_MAX; return 1;
    case 10:
        if (image->mask == NULL)
            return 0;
        image->mask_stride_bytes = (size_t)image->width - 1;
        return 1;
    case 11:
        if (is_planar(image->format))
            image->blue_plane = NULL;
        else
            image->green_plane = image->pixels;
        return 1;
    case 12:
        image->mask_stride_bytes = SIZE_MAX;
        return image->mask != NULL && rows > 1;
    default:
        image->row_stride_bytes = SIZE_MAX / 2 / (size_t)(rows > 1 ? rows - 1 : 1) + byte() + 1;
        return rows > 1;
    }
}

struct picture picture_sized(int32_t width, int32_t height)
{
    static const ofc_pixel_format formats[] = {1, 22, 2, 3, 4, 5, 11, 12, 13, 14, 15, 21, 23, 24, 25};
    const ofc_pixel_format format = formats[below(sizeof formats / sizeof *formats)];
    const size_t sample = sample_bytes(format), pixel = pixel_bytes(format), row = pixel * (size_t)width;
    const struct scene scene = any_scene(format, width, height);
    const size_t stride = stride_of(row, 1);
    uint8_t *planes[3];
    for (int c = 0; c < 3; c++)
        planes[c] = c == 0 || is_planar(format) ? take_rows(row, stride, height, 1) : planes[0];
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            double color[3];
            color_at(&scene, x, y, color);
            for (int c = 0; c < 3; c++) {
                const int place = format % 10 == 2 || format % 10 == 4 ? 2 - c : c;
                const size_t at = (size_t)y * stride + (size_t)x * pixel;
                store(planes[c] + at + (is_planar(format) ? 0 : (size_t)place * sample), format, color[c]);
            }
        }
    /* A few samples of any value. */
    for (int i = one_in(3) ? 1 + below(5) : 0; i > 0; i--) {
        uint8_t *const at = planes[below(3)] + word32() % (uint32_t)height * stride + word32() % (row / sample) * sample;
        const float value = any_float();
        if (format > 20)
            memcpy(at, &value, sizeof value);
        else
            *at = byte();
    }
    ofc_image image = {.pixels = planes[0], .width = width, .height = height, .row_stride_bytes = stride, .format = format};
    if (is_planar(format))
        image.green_plane = planes[1], image.blue_plane = planes[2];
    if (one_in(3))
        image.mask = any_mask(width, height, &image.mask_stride_bytes);
    struct picture picture = {.image = TAKE(ofc_image, 1), .width = width, .height = height};
    const ofc_image whole = image;
    if (one_in(16) && !(picture.bad = spoil(&image, row)))
        image = whole;
    *picture.image = image;
    return picture;
}

struct picture picture_of(int max_width, int max_height)
{
    const int32_t width = 1 + (byte() + max_width * 3 / 4) % max_width;
    return picture_sized(width, 1 + (byte() + max_height * 2 / 3) % max_height);
}

ofc_inlier_test *any_inlier_test(void)
{
    const int kind = below(4);
    if (kind == 0)
        return NULL;
    ofc_inlier_test *const test = TAKE(ofc_inlier_test, 1);
    memset(test, 0, sizeof *test);
    test->saturation = INFINITY;
    test->residual_low = test->norm_low = -INFINITY;
    test->residual_high = test->norm_high = INFINITY;
    if (kind > 1)
        change(test, sizeof *test, kind);
    return test;
}

int shorten(ofc_lmeds_params *params)
{
    enum { MOST = 50 };
    if (params->min_subsets > MOST && params->min_subsets <= 10000000)
        params->min_subsets = 1 + params->min_subsets % MOST;
    if (params->subsets > MOST && params->subsets <= 10000000)
        params->subsets = 1 + params->subsets % MOST;
    return params->subsets > 0 ||
           ofc_lmeds_subset_count(params->confidence, params->outlier_ratio, params->min_subsets) <= 2 * MOST;
}
