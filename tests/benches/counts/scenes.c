#include "scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t state;

/* SplitMix64. */
static uint64_t random_bits(void)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static void *room(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (memory == NULL) {
        fputs("out of memory\n", stderr);
        exit(1);
    }
    return memory;
}

static void check(ofc_status status)
{
    if (status != OFC_STATUS_OK) {
        fprintf(stderr, "a scene: %s\n", ofc_status_message(status));
        exit(1);
    }
}

/* Renders depths under three lights of clean colors whose directions are as far from the camera's as `spread` says. */
static struct scene rendered(float *depth, uint8_t *mask, int32_t width, int32_t height, double spread, uint64_t seed)
{
    const double z = sqrt(1 - spread * spread), half = spread / 2, side = sqrt(0.75) * spread;
    const double directions[9] = {0, spread, z, side, -half, z, -side, -half, z};
    static const double colors[9] = {150, 25, 20, 30, 150, 35, 20, 30, 150};
    const ofc_lights lights = {.directions = directions, .colors = colors, .count = 3};
    const ofc_depth_map map = {.depth = depth, .width = width, .height = height, .row_stride_bytes = sizeof(float) * (size_t)width,
                               .pixel_pitch = 1, .mask = mask, .mask_stride_bytes = (size_t)width};
    ofc_render_params params;
    check(ofc_render_params_default(&params));
    params.noise = 1;
    params.seed = seed;
    params.cast_shadows = 0;
    uint8_t *pixels = room((size_t)width * (size_t)height, 3);
    ofc_rendering rendering;
    check(ofc_render(&map, &lights, &params, pixels, OFC_PIXEL_RGB8, 3 * (size_t)width, NULL, 0, NULL, 0, &rendering));
    free(depth);
    const struct scene scene = {.image = {.pixels = pixels, .width = width, .height = height,
                                          .row_stride_bytes = 3 * (size_t)width, .format = OFC_PIXEL_RGB8},
                                .mask = mask};
    return scene;
}

/* An ellipsoid that fills the picture, out to where its height above the rim is the share `rim` of all of it. */
static struct scene ellipsoid(int32_t width, int32_t height, double fill, double rim, double spread)
{
    const size_t count = (size_t)width * (size_t)height;
    float *depth = room(count, sizeof *depth);
    uint8_t *mask = room(count, 1);
    const double a = fill * width, b = fill * height, c = (a + b) / 2;
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            const double u = (x + 0.5 - width / 2.0) / a, v = (y + 0.5 - height / 2.0) / b, rest = 1 - u * u - v * v;
            const size_t at = (size_t)y * (size_t)width + (size_t)x;
            mask[at] = rest > rim * rim ? 255 : 0;
            depth[at] = (float)(rest > 0 ? c * sqrt(rest) : 0);
        }
    struct scene scene = rendered(depth, mask, width, height, spread, 1);
    uint8_t *pixels = (uint8_t *)scene.image.pixels;
    state = 2;
    for (size_t i = 0; i < count; i++)
        if (mask[i] && random_bits() % 10 == 0)
            for (int c3 = 0; c3 < 3; c3++)
                pixels[3 * i + c3] = (uint8_t)(pixels[3 * i + c3] / 2 + 110);
    return scene;
}

struct scene dome(int32_t width, int32_t height)
{
    return ellipsoid(width, height, 0.7, 0.74, 0.5);
}

struct scene egg(int32_t width, int32_t height)
{
    struct scene scene = ellipsoid(width, height, 0.45, 0, 0.6);
    uint8_t *pixels = (uint8_t *)scene.image.pixels;
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
        for (int c = 0; c < 3 && !scene.mask[i]; c++)
            pixels[3 * i + c] = (uint8_t)(random_bits() % 4);
    return scene;
}

struct scene gel(int32_t width, int32_t height, double radius, double x0, double y0, uint64_t seed)
{
    const size_t count = (size_t)width * (size_t)height;
    float *depth = room(count, sizeof *depth);
    /* The cap out to 0.4 of the radius, and then a parabola with its slope at the rim down to the plane. */
    const double rim = 0.4 * radius, steepest = radius > 0 ? rim / sqrt(radius * radius - rim * rim) : 0, skirt = radius / 4;
    const double above = radius > 0 ? sqrt(radius * radius - rim * rim) : 0;
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            const double u = x - x0, v = y - y0, r = sqrt(u * u + v * v), rest = rim + skirt - r;
            const double low = radius > 0 ? steepest * skirt / 2 : 0;
            depth[(size_t)y * (size_t)width + (size_t)x] =
                (float)(r < rim ? low + sqrt(radius * radius - r * r) - above : rest > 0 && radius > 0 ? steepest * rest * rest / (2 * skirt) : 0);
        }
    uint8_t *mask = room(count, 1);
    for (size_t i = 0; i < count; i++)
        mask[i] = 255;
    return rendered(depth, mask, width, height, 0.8, seed);
}

struct scene points(int32_t width, int32_t height, int share)
{
    const size_t count = (size_t)width * (size_t)height;
    /* Enough pixels of a square dome, in the order of its rows. */
    int32_t side = 16;
    while ((size_t)side * (size_t)side < 2 * count)
        side *= 2;
    const struct scene from = ellipsoid(side, side, 0.7, 0.74, 0.5);
    const uint8_t *source = from.image.pixels;
    float *pixels = room(count, 3 * sizeof *pixels);
    state = 3;
    size_t at = 0;
    for (size_t i = 0; i < count; i++) {
        while (!from.mask[at])
            at = (at + 1) % ((size_t)side * (size_t)side);
        const uint64_t bits = random_bits();
        const int is_outlier = (int)(bits % 100) < share, is_random = (int)(bits >> 63);
        for (int c = 0; c < 3; c++) {
            /* Uniform noise in place of rounding, which would leave many colors equal. */
            const double value = source[3 * at + (size_t)c] + (double)(random_bits() % 1024) / 1024.0 - 0.5;
            pixels[3 * i + (size_t)c] = (float)(!is_outlier ? fmax(value, 0.5) : is_random ? 1 + (double)(random_bits() % 254) : value / 2 + 100);
        }
        at = (at + 1) % ((size_t)side * (size_t)side);
    }
    free((void *)from.image.pixels);
    free(from.mask);
    const struct scene scene = {.image = {.pixels = pixels, .width = width, .height = height,
                                          .row_stride_bytes = 12 * (size_t)width, .format = OFC_PIXEL_RGB32F}};
    return scene;
}

ofc_image converted(const ofc_image *image, ofc_pixel_format format)
{
    const size_t count = (size_t)image->width * (size_t)image->height;
    const int kind = format / 10, layout = format % 10, is_planar = layout == OFC_PIXEL_PLANES8 % 10;
    const size_t size = kind == 0 ? 1 : kind == 1 ? 2 : 4;
    const size_t samples = layout == OFC_PIXEL_RGBA8 || layout == OFC_PIXEL_BGRA8 ? 4 : 3;
    const int is_bgr = layout == OFC_PIXEL_BGR8 || layout == OFC_PIXEL_BGRA8;
    const uint8_t *source = image->pixels;
    uint8_t *pixels = room(count, samples * size);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++) {
            const size_t at = is_planar ? c * count + i : i * samples + (is_bgr ? 2 - c : c);
            const uint8_t value = source[3 * i + c];
            if (kind == 0)
                pixels[at] = value;
            else if (kind == 1)
                ((uint16_t *)(void *)pixels)[at] = (uint16_t)(257 * value);
            else
                ((float *)(void *)pixels)[at] = value;
        }
    ofc_image result = *image;
    result.pixels = pixels;
    result.format = format;
    result.row_stride_bytes = (size_t)image->width * size * (is_planar ? 1 : samples);
    if (is_planar) {
        result.green_plane = pixels + count * size;
        result.blue_plane = pixels + 2 * count * size;
    }
    return result;
}

float *hills(int32_t size, uint8_t *mask)
{
    const size_t count = (size_t)size * (size_t)size;
    float *normals = room(count, 3 * sizeof *normals);
    state = 4;
    for (int32_t y = 0; y < size; y++)
        for (int32_t x = 0; x < size; x++) {
            const double u = (2.0 * x + 1 - size) / size, v = (size - 2.0 * y - 1) / size;
            const double bell = 1 / (1 + 4 * (u * u + v * v)), p = -2 * u * bell * bell + u * v, q = -2 * v * bell * bell + u * u / 2;
            const double n[3] = {-p, -q, 1}, length = sqrt(p * p + q * q + 1);
            const size_t at = (size_t)y * (size_t)size + (size_t)x;
            for (size_t c = 0; c < 3; c++)
                normals[3 * at + c] = (float)(n[c] / length + ((double)(random_bits() % 1024) / 1024.0 - 0.5) / 50);
            if (mask != NULL)
                mask[at] = u * u + v * v < 0.92 ? 255 : 0;
        }
    return normals;
}
