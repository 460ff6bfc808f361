/*
 * The smallest complete use of ofc: C99, no library but ofc, static buffers, no malloc.
 *
 * Renders a matte ball under three colored lights into an RGB picture, forgets the lights, recovers them and the
 * normals from the picture, and prints both beside the truth.
 *
 *     cc -std=c99 -Iinclude c_examples/minimal.c libofc.a -lm -Wl,--gc-sections
 */
#include <math.h>
#include <ofc.h>
#include <stdio.h>

#define SIZE 160
#define DEGREES (180.0 / 3.14159265358979323846)

static uint8_t picture[SIZE][SIZE][3];
static float truth[SIZE][SIZE][3]; /* normals: x right, y up, z toward the camera */
static float normals[SIZE][SIZE][3];
static uint8_t inliers[SIZE][SIZE];
static uint64_t workspace[OFC_SOLVE_WORKSPACE_SIZE(SIZE, SIZE) / sizeof(uint64_t)];

/* Three lights: where they are (slant from z, tilt from x) and their colors. Channel c sees the sum over the lights of
 * color[c] * max(0, direction . normal), which makes row c of F the sum of color[c] * direction. */
static const struct {
    double slant, tilt, color[3];
} lights[3] = {
    {35 / DEGREES, 20 / DEGREES, {150, 20, 35}},
    {30 / DEGREES, 140 / DEGREES, {30, 140, 25}},
    {40 / DEGREES, -100 / DEGREES, {25, 40, 150}},
};

static void direction(double slant, double tilt, double out[3])
{
    out[0] = sin(slant) * cos(tilt);
    out[1] = sin(slant) * sin(tilt);
    out[2] = cos(slant);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void render(double f[3][3])
{
    const double radius = 0.45 * SIZE;
    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            double n[3] = {(x + 0.5 - SIZE / 2.0) / radius, (SIZE / 2.0 - y - 0.5) / radius, 0};
            const double rest = 1 - dot(n, n);
            double rho[3] = {0, 0, 0};
            if (rest < 0)
                continue; /* background stays black */
            n[2] = sqrt(rest);
            for (int light = 0; light < 3; light++) {
                double a[3];
                direction(lights[light].slant, lights[light].tilt, a);
                for (int c = 0; c < 3 && dot(a, n) > 0; c++)
                    rho[c] += lights[light].color[c] * dot(a, n);
            }
            for (int c = 0; c < 3; c++) {
                picture[y][x][c] = (uint8_t)(rho[c] + 0.5);
                truth[y][x][c] = (float)n[c];
            }
        }
    }
    for (int light = 0; light < 3; light++) {
        double a[3];
        direction(lights[light].slant, lights[light].tilt, a);
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < 3; i++)
                f[c][i] += lights[light].color[c] * a[i];
    }
}

int main(void)
{
    double f[3][3] = {{0}};
    render(f);

    const ofc_image image = {.pixels = picture,
                             .width = SIZE,
                             .height = SIZE,
                             .row_stride_bytes = sizeof picture[0],
                             .format = OFC_PIXEL_RGB8};
    ofc_solve_params params;
    ofc_solve_params_default(&params);
    ofc_solution solution;
    ofc_status status = ofc_solve(&image, &params, workspace, sizeof workspace, &inliers[0][0], &solution);
    if (status == OFC_STATUS_OK)
        status = ofc_normals_compute(&image, &solution, &normals[0][0][0], sizeof normals[0]);
    if (status != OFC_STATUS_OK) {
        fprintf(stderr, "ofc: %s\n", ofc_status_message(status));
        if (status > 0)
            fprintf(stderr, "%s: %s\n", ofc_reason_message(solution.reason), ofc_reason_advice(solution.reason));
        return 1;
    }

    const ofc_pixel_counts *counts = &solution.pixel_counts;
    printf("ofc %s: %d inliers of %d usable pixels of %d; %d black, %d saturated, %d shaded\n", ofc_version_string(),
           (int)solution.inlier_count, (int)counts->usable, SIZE * SIZE, (int)counts->dark, (int)counts->saturated,
           (int)counts->shadowed);
    printf("channel   tilt (true)        slant (true)      norm (true)\n");
    for (int c = 0; c < 3; c++) {
        const double length = sqrt(dot(f[c], f[c]));
        printf("   %c    %7.2f (%7.2f)   %6.2f (%6.2f)   %6.2f (%6.2f)\n", "rgb"[c],
               solution.tilts.tilt_rad[c] * DEGREES, atan2(f[c][1], f[c][0]) * DEGREES,
               solution.slant_rad[c] * DEGREES, acos(f[c][2] / length) * DEGREES, solution.ellipsoid.norms[c], length);
    }

    double worst = 0, sum = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        const float *n = normals[i / SIZE][i % SIZE], *t = truth[i / SIZE][i % SIZE];
        const double cosine = n[0] * t[0] + n[1] * t[1] + n[2] * t[2];
        const double error = inliers[i / SIZE][i % SIZE] ? acos(fmin(1, cosine)) * DEGREES : 0;
        sum += error;
        worst = fmax(worst, error);
    }
    printf("normals: mean error %.2f degrees, largest %.2f\n", sum / solution.inlier_count, worst);
    return 0;
}
