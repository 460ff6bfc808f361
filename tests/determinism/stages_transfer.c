/* What files hold, made what the model wants. */
#include "digest.h"
#include "stages.h"

enum { SAMPLE = 120 };

void mix_transfer(const ofc_image *image, const struct fitted *fitted)
{
    const int values = image->width * image->height * 3;
    const size_t row = (size_t)image->width * 3 * sizeof(float);
    static float table[256];
    mix_status(ofc_transfer_table(OFC_TRANSFER_GAMMA, 2.2, 256, table));
    mix_floats(table, 256);
    mix_status(ofc_transfer_linearize(image, OFC_TRANSFER_SRGB, 0, NULL, 0, normals, row));
    mix_floats(normals, values);
    const double room[3] = {1.5, 2, 3};
    mix_status(ofc_offset_subtract(image, room, normals, row));
    mix_floats(normals, values);
    mix_status(ofc_dark_subtract(image, image, normals, row));
    mix_floats(normals, values);
    double level = 0;
    int32_t count = 0;
    mix_status(ofc_saturation_find(image, &level, &count));
    mix_doubles(&level, 1);
    mix_status(count);
    const double *const c = fitted->ellipsoid.c;
    const double around_black[6] = {c[0], c[4], c[8], c[1], c[2], c[5]};
    static ofc_offset found;
    mix_integer(ofc_offset_workspace_size(SAMPLE));
    const ofc_status status =
        ofc_offset_fit(image, &fitted->inliers, around_black, SAMPLE, workspace, workspace_bytes, &found);
    mix_status(status);
    if (status != OFC_STATUS_OK)
        return;
    mix_doubles(found.offset, 3);
    mix_doubles(found.covariance, 9);
    mix_doubles(found.coefficients, 6);
    const double numbers[] = {found.deviation, found.deviation_around_black, found.noise, found.chi_squared};
    mix_doubles(numbers, 4);
    mix_status(found.count);
    mix_status(found.blocks);
}
