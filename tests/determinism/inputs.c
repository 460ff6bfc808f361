#include "inputs.h"

#include "digest.h"

static union {
    uint8_t bytes[HEIGHT][WIDTH][4];
    uint16_t shorts[HEIGHT][WIDTH][4];
    float floats[HEIGHT][WIDTH][3];
    uint8_t planes8[3][HEIGHT][WIDTH];
    float planes[3][HEIGHT][WIDTH];
} pixels;
static uint8_t mask[HEIGHT][WIDTH];
static float depth[HEIGHT][WIDTH];
static uint64_t state;

void random_seed(uint64_t seed)
{
    state = seed;
}

uint64_t random_bits(void)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

double random_number(void)
{
    return ((double)(random_bits() >> 12) - (double)(UINT64_C(1) << 51)) / (double)(UINT64_C(1) << 51);
}

uint32_t integer_root(uint32_t square)
{
    uint32_t result = 0;
    for (uint32_t bit = 1u << 15; bit > 0; bit >>= 1)
        if ((result + bit) * (result + bit) <= square)
            result += bit;
    return result;
}

ofc_depth_map surface(void)
{
    const ofc_depth_map map = {.depth = depth[0],
                               .width = WIDTH,
                               .height = HEIGHT,
                               .row_stride_bytes = sizeof depth[0],
                               .pixel_pitch = 1,
                               .mask = mask[0],
                               .mask_stride_bytes = sizeof mask[0]};
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const int u = 2 * x + 1 - WIDTH, v = 2 * y + 1 - HEIGHT;
            const int rest = 23 * 23 - u * u - v * v;
            mask[y][x] = rest > 0 ? 255 : 0;
            /* Half of a ball's height in 1/256 of a pixel, and a saddle. */
            const int height = rest > 0 ? (int)integer_root((uint32_t)rest << 14) : 0;
            depth[y][x] = (float)(height + (u * u - v * v) / 16) / 256;
        }
    return map;
}

ofc_lights lamps(void)
{
    static const double directions[9] = {0.5, 0.2, 0.842615, -0.4, 0.4, 0.824621, 0.1, -0.5, 0.860233};
    static const double colors[9] = {150, 30, 25, 20, 140, 40, 35, 25, 150};
    const ofc_lights lights = {.directions = directions, .colors = colors, .count = 3};
    return lights;
}

/* The surface under the first `lights` of the lamps, in one of the interleaved formats. */
static ofc_image rendered(ofc_pixel_format format, size_t stride, int lights, double noise, int with_mask)
{
    const ofc_depth_map map = surface();
    ofc_lights lit = lamps();
    double colors[9] = {0};
    for (int c = 0; c < 3; c++)
        for (int l = 0; l < lights; l++)
            colors[c * 3 + l] = lit.colors[c * 3 + l];
    lit.colors = colors;
    ofc_render_params params;
    ofc_rendering rendering;
    mix_status(ofc_render_params_default(&params));
    params.noise = noise;
    params.seed = 5;
    params.peak = format == OFC_PIXEL_RGBA16 ? 60000 : 250;
    mix_status(ofc_render(&map, &lit, &params, &pixels, format, stride, NULL, 0, NULL, 0, &rendering));
    mix_rendering(&rendering);
    const ofc_image image = {.pixels = &pixels,
                             .width = WIDTH,
                             .height = HEIGHT,
                             .row_stride_bytes = stride,
                             .format = format,
                             .mask = with_mask ? mask[0] : NULL,
                             .mask_stride_bytes = sizeof mask[0]};
    return image;
}

static ofc_image ball(void)
{
    return rendered(OFC_PIXEL_RGB8, sizeof pixels.bytes[0], 3, 0, 0);
}

static ofc_image noisy(void)
{
    return rendered(OFC_PIXEL_BGRA8, sizeof pixels.bytes[0], 3, 2, 1);
}

static ofc_image deep(void)
{
    return rendered(OFC_PIXEL_RGBA16, sizeof pixels.shorts[0], 3, 20, 1);
}

static ofc_image floating(void)
{
    return rendered(OFC_PIXEL_BGR32F, sizeof pixels.floats[0], 3, 0.5, 1);
}

static ofc_image one_light(void)
{
    return rendered(OFC_PIXEL_RGB8, sizeof pixels.bytes[0], 1, 0, 1);
}

static ofc_image two_lights(void)
{
    return rendered(OFC_PIXEL_RGB32F, sizeof pixels.floats[0], 2, 0.25, 1);
}

static ofc_image outliers(void)
{
    const ofc_image image = rendered(OFC_PIXEL_RGBA8, sizeof pixels.bytes[0], 3, 1, 1);
    random_seed(11);
    for (int i = 0; i < PIXELS; i++) {
        const uint64_t bits = random_bits();
        for (int c = 0; c < 4 && bits >> 62 == 0; c++)
            pixels.bytes[i / WIDTH][i % WIDTH][c] = (uint8_t)(bits >> (8 * c));
    }
    return image;
}

/* Two halves under different lights. */
static ofc_image two_regions(void)
{
    const ofc_image image = rendered(OFC_PIXEL_RGBA8, sizeof pixels.bytes[0], 3, 0, 1);
    for (int i = 0; i < PIXELS; i++)
        if (i % WIDTH > WIDTH / 2) {
            uint8_t *pixel = pixels.bytes[i / WIDTH][i % WIDTH];
            pixel[0] = (uint8_t)(pixel[0] / 3);
            pixel[2] = (uint8_t)((pixel[2] + pixel[1]) / 2);
        }
    return image;
}

static ofc_image planes_of(ofc_pixel_format format, const void *plane[3], size_t stride)
{
    const ofc_image image = {.pixels = plane[0],
                             .width = WIDTH,
                             .height = HEIGHT,
                             .row_stride_bytes = stride,
                             .format = format,
                             .green_plane = plane[1],
                             .blue_plane = plane[2]};
    return image;
}

static ofc_image random_bytes(void)
{
    random_seed(1);
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            pixels.planes8[c][i / WIDTH][i % WIDTH] = (uint8_t)random_bits();
    const void *plane[3] = {pixels.planes8[0], pixels.planes8[1], pixels.planes8[2]};
    return planes_of(OFC_PIXEL_PLANES8, plane, sizeof pixels.planes8[0][0]);
}

/* Colors of every size and sign. */
static ofc_image random_floats(void)
{
    random_seed(2);
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            pixels.planes[c][i / WIDTH][i % WIDTH] = (float)(random_number() * random_number() * 3e4);
    const void *plane[3] = {pixels.planes[2], pixels.planes[0], pixels.planes[1]};
    return planes_of(OFC_PIXEL_PLANES32F, plane, sizeof pixels.planes[0][0]);
}

/* Any bits: NaN, infinities, subnormal and huge numbers. */
static ofc_image random_float_bits(void)
{
    const union {
        uint32_t bits;
        float value;
    } special[6] = {{0x7fc00001}, {0xff800000}, {0x00000001}, {0x7f7fffff}, {0x80000000}, {0xffc00000}};
    const ofc_image image = rendered(OFC_PIXEL_RGB32F, sizeof pixels.floats[0], 3, 0.5, 0);
    random_seed(3);
    for (int i = 0; i < PIXELS; i++) {
        const uint64_t bits = random_bits();
        if (bits >> 60 == 0)
            pixels.floats[i / WIDTH][i % WIDTH][bits % 3] = special[bits / 3 % 6].value;
    }
    return image;
}

static ofc_image filled(uint8_t r, uint8_t g, uint8_t b)
{
    for (int i = 0; i < PIXELS; i++) {
        uint8_t *pixel = pixels.bytes[i / WIDTH][i % WIDTH];
        pixel[0] = r;
        pixel[1] = g;
        pixel[2] = b;
    }
    const ofc_image image = {.pixels = &pixels,
                             .width = WIDTH,
                             .height = HEIGHT,
                             .row_stride_bytes = sizeof pixels.bytes[0],
                             .format = OFC_PIXEL_BGRA8};
    return image;
}

static ofc_image black(void)
{
    return filled(0, 0, 0);
}

static ofc_image saturated(void)
{
    return filled(255, 255, 200);
}

static ofc_image uniform(void)
{
    return filled(90, 120, 60);
}

static ofc_image few_pixels(void)
{
    ofc_image image = ball();
    image.pixels = pixels.bytes[HEIGHT / 2][WIDTH / 3];
    image.width = 5;
    image.height = 4;
    return image;
}

static ofc_image one_pixel(void)
{
    ofc_image image = few_pixels();
    image.width = 1;
    image.height = 1;
    return image;
}

const struct scene scenes[SCENES] = {
    {"ball", ball},
    {"noisy", noisy},
    {"16 bits", deep},
    {"floats", floating},
    {"outliers", outliers},
    {"two regions", two_regions},
    {"one light", one_light},
    {"two lights", two_lights},
    {"random bytes", random_bytes},
    {"random floats", random_floats},
    {"special floats", random_float_bits},
    {"black", black},
    {"saturated", saturated},
    {"uniform", uniform},
    {"few pixels", few_pixels},
    {"one pixel", one_pixel},
};
