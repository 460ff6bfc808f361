/* The same picture as rows, by both methods: a cold start and frames that refine it. */
#include "digest.h"
#include "stages.h"

static ofc_image row_of(const ofc_image *image, int y)
{
    ofc_image row = *image;
    row.height = 1;
    row.pixels = (const uint8_t *)image->pixels + (size_t)y * image->row_stride_bytes;
    if (row.green_plane != NULL)
        row.green_plane = (const uint8_t *)image->green_plane + (size_t)y * image->row_stride_bytes;
    if (row.blue_plane != NULL)
        row.blue_plane = (const uint8_t *)image->blue_plane + (size_t)y * image->row_stride_bytes;
    if (row.mask != NULL)
        row.mask = image->mask + (size_t)y * image->mask_stride_bytes;
    return row;
}

static void mix_method(const ofc_image *image, ofc_orientation_method orientation_method)
{
    static uint64_t memory[OFC_STREAM_SIZE_FOR(WIDTH, HEIGHT, 300) / sizeof(uint64_t) + 1];
    ofc_stream_params params;
    ofc_stream *stream = NULL;
    mix_status(ofc_stream_params_default(&params));
    params.solve.lmeds.sample_size = 300;
    params.solve.lmeds.subsets = 20;
    params.solve.orientation_method = orientation_method;
    mix_status(ofc_stream_init(image->width, image->height, image->format, &params, memory, sizeof memory, &stream));
    for (int frame = 0; stream != NULL && frame < 5; frame++) {
        ofc_stream_pass pass = 0;
        ofc_solution solution = {0};
        ofc_stream_drift drift = {0};
        mix_status(ofc_stream_begin(stream, &pass));
        mix_status(pass);
        for (int y = 0; y < image->height; y++) {
            const ofc_image row = row_of(image, y);
            mix_status(ofc_stream_row(stream, y, &row));
        }
        mix_status(ofc_stream_end(stream, &pass));
        mix_status(pass);
        if (ofc_stream_solution(stream, &solution) >= 0)
            mix_solution(&solution);
        if (ofc_stream_drift_get(stream, &drift) >= 0)
            mix_drift(&drift);
    }
    for (int y = 0; stream != NULL && y < image->height; y += 5) {
        const ofc_image row = row_of(image, y);
        ofc_status status = ofc_stream_normals_row(stream, &row, normals);
        mix_status(status);
        mix_floats(normals, status == OFC_STATUS_OK ? image->width * 3 : 0);
        status = ofc_stream_normals_row_packed(stream, &row, marks);
        mix_status(status);
        mix_bytes(marks, status == OFC_STATUS_OK ? image->width * 3 : 0);
        status = ofc_stream_inliers_row(stream, &row, marks);
        mix_status(status);
        mix_bytes(marks, status == OFC_STATUS_OK ? image->width : 0);
    }
    if (stream != NULL)
        mix_status(ofc_stream_restart(stream));
}

void mix_stream(const ofc_image *image)
{
    mix_method(image, OFC_ORIENTATION_DIRECT);
    mix_method(image, OFC_ORIENTATION_JOINT);
}
