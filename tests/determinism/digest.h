/* A digest of outputs that is the same on every target exactly when their values are: FNV-1a over the bits of each
 * number, low byte first, so that neither byte order nor padding enters. */
#ifndef DIGEST_H
#define DIGEST_H

#include <ofc.h>

enum { WIDTH = 32, HEIGHT = 24, PIXELS = WIDTH * HEIGHT };

/* Ends a group and prints its line: digest, how many numbers it is of, name. */
void digest_print(const char *name);

void mix_integer(uint64_t value);
void mix_status(ofc_status status);
void mix_text(const char *text);
void mix_doubles(const double *values, int count);
void mix_floats(const float *values, int count);
void mix_bytes(const uint8_t *values, int count);
void mix_shorts(const uint16_t *values, int count);
void mix_words(const uint32_t *values, int count);

void mix_pixel_counts(const ofc_pixel_counts *pixel_counts);
void mix_color_fit(const ofc_color_fit *fit);
void mix_rank(const ofc_rank *rank);
void mix_covariance(const ofc_covariance *covariance);
void mix_location(const ofc_location *location);
void mix_inliers(const ofc_inlier_test *inliers);
void mix_ellipsoid(const ofc_ellipsoid *ellipsoid);
void mix_tilts(const ofc_tilts *tilts);
void mix_slants(const ofc_slants *slants);
void mix_slant_estimates(const ofc_slant_estimate slants[3]);
void mix_orientation(const ofc_orientation *orientation);
void mix_solution(const ofc_solution *solution);
void mix_check(const ofc_check_result *result);
void mix_disc(const ofc_disc *disc);
void mix_integrability(const ofc_integrability *integrability);
void mix_orthogonal(const ofc_orthogonal *found);
void mix_rendering(const ofc_rendering *rendering);
void mix_region(const ofc_region *region);
void mix_paint_estimate(const ofc_paint *paint);
void mix_lmeds_params(const ofc_lmeds_params *params);
void mix_solve_params(const ofc_solve_params *params);
void mix_render_params(const ofc_render_params *params);
void mix_annealing_params(const ofc_annealing_params *params);
void mix_segment_params(const ofc_segment_params *params);
void mix_depth_params(const ofc_depth_params *params);
void mix_depth_result(const ofc_depth_result *result);
void mix_surface_result(const ofc_surface_result *result);
void mix_drift(const ofc_stream_drift *drift);

#endif
