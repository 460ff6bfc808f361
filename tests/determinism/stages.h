/* The stages of the library on one picture, and those that need none. Each group prints its own digest. */
#ifndef STAGES_H
#define STAGES_H

#include <ofc.h>

/* Without a picture: constants, defaults, sizes, and mathematics on random numbers. */
void digest_constants(void);
void digest_mathematics(void);

/* From depth maps to pictures. */
void digest_rendering(void);

/* The stages up to the ellipsoid, whose results the following ones take. */
struct fitted {
    ofc_color_fit fit;
    ofc_inlier_test inliers;
    ofc_ellipsoid ellipsoid;
    ofc_tilts tilts;
};
void mix_fit(const ofc_image *image, struct fitted *fitted);
void mix_lights(const ofc_image *image, struct fitted *fitted);
void mix_methods(const ofc_image *image, const struct fitted *fitted);
/* `variant`: any number; it chooses among estimators and fallbacks. */
void mix_solve(const ofc_image *image, int variant);
/* Of the normals; the surface that it returns lasts until the next call. */
ofc_depth_map mix_depth(const ofc_image *image);
/* The surface of a picture that is solved once more. */
void mix_surface(const ofc_image *image);
void mix_stream(const ofc_image *image);
void mix_flat_field(const ofc_image *image);
void mix_transfer(const ofc_image *image, const struct fitted *fitted);
void mix_paint(const ofc_image *image);
void mix_segments(const ofc_image *image, const struct fitted *fitted);

/* Of pictures of its own. */
void mix_relief(void);

/* What the stages share: room for the largest workspace, and outputs a pixel. */
extern uint64_t workspace[];
extern const size_t workspace_bytes;
extern float normals[];
extern float angles[];
extern uint8_t marks[];

#endif
