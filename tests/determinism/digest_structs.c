/* Every field of every struct, in the header's order. */
#include "digest.h"

/* An array of doubles, one double, and integers of 32 bits. */
#define ARRAY(field) mix_doubles(field, (int)(sizeof(field) / sizeof(double)))
#define NUMBER(field) mix_doubles(&(field), 1)
#define INTEGER(field) mix_status((int32_t)(field))
#define INTEGERS(field) mix_words((const uint32_t *)(field), (int)(sizeof(field) / sizeof(uint32_t)))

void mix_pixel_counts(const ofc_pixel_counts *pixel_counts)
{
    INTEGER(pixel_counts->usable);
    INTEGER(pixel_counts->masked_out);
    INTEGER(pixel_counts->dark);
    INTEGER(pixel_counts->saturated);
    INTEGER(pixel_counts->non_finite);
    INTEGER(pixel_counts->shadowed);
    mix_floats(&pixel_counts->largest, 1);
}

void mix_color_fit(const ofc_color_fit *fit)
{
    ARRAY(fit->robust);
    NUMBER(fit->median_residual);
    NUMBER(fit->dispersion);
    NUMBER(fit->r_squared);
    for (int i = 0; i < 6; i++) {
        const ofc_estimate *estimate = &fit->coefficients[i];
        NUMBER(estimate->value);
        NUMBER(estimate->standard_error);
        NUMBER(estimate->t);
        NUMBER(estimate->p);
        NUMBER(estimate->low);
        NUMBER(estimate->high);
    }
    ARRAY(fit->covariance);
    NUMBER(fit->residual_deviation);
    ARRAY(fit->color_deviations);
    NUMBER(fit->noise_deviation);
    NUMBER(fit->pixel_noise);
    NUMBER(fit->degenerate_noise_deviation);
    INTEGER(fit->inlier_count);
    INTEGER(fit->subsets);
    INTEGER(fit->by_colors);
}

void mix_covariance(const ofc_covariance *covariance)
{
    ARRAY(covariance->c);
    ARRAY(covariance->f);
    ARRAY(covariance->f_inverse);
    ARRAY(covariance->rotation);
    NUMBER(covariance->pixel_noise);
}

void mix_rank(const ofc_rank *rank)
{
    ARRAY(rank->color_deviations);
    NUMBER(rank->color_noise);
    ARRAY(rank->normal_deviations);
    NUMBER(rank->normal_noise);
    INTEGER(rank->colors);
    INTEGER(rank->normals);
}

void mix_location(const ofc_location *location)
{
    NUMBER(location->location);
    NUMBER(location->median_distance);
    NUMBER(location->dispersion);
}

void mix_inliers(const ofc_inlier_test *inliers)
{
    NUMBER(inliers->saturation);
    ARRAY(inliers->residual_form);
    NUMBER(inliers->residual_low);
    NUMBER(inliers->residual_high);
    ARRAY(inliers->norm_form);
    NUMBER(inliers->norm_low);
    NUMBER(inliers->norm_high);
    for (int i = 0; i < 3; i++) {
        mix_floats(inliers->shadow_planes[i].normal, 3);
        mix_floats(&inliers->shadow_planes[i].threshold, 1);
    }
}

void mix_ellipsoid(const ofc_ellipsoid *ellipsoid)
{
    ARRAY(ellipsoid->c);
    ARRAY(ellipsoid->eigenvalues);
    ARRAY(ellipsoid->root);
    ARRAY(ellipsoid->f_f_transposed);
    ARRAY(ellipsoid->norms);
    ARRAY(ellipsoid->cosines);
}

void mix_tilts(const ofc_tilts *tilts)
{
    ARRAY(tilts->tilt_rad);
    ARRAY(tilts->mean_gradient);
}

void mix_slants(const ofc_slants *slants)
{
    ARRAY(slants->slant_rad);
    NUMBER(slants->residual);
    NUMBER(slants->integral);
    INTEGER(slants->branch);
    INTEGER(slants->reserved);
}

void mix_slant_estimates(const ofc_slant_estimate slants[3])
{
    for (int c = 0; c < 3; c++) {
        NUMBER(slants[c].slant_rad);
        NUMBER(slants[c].statistic);
        INTEGER(slants[c].clamping);
        INTEGER(slants[c].reserved);
    }
}

void mix_orientation(const ofc_orientation *orientation)
{
    ARRAY(orientation->f);
    ARRAY(orientation->f_inverse);
    ARRAY(orientation->singular_values);
    INTEGER(orientation->rank);
    INTEGER(orientation->reserved);
}

void mix_solution(const ofc_solution *solution)
{
    INTEGER(solution->outcome);
    INTEGER(solution->slant_source);
    INTEGER(solution->candidate_count);
    INTEGER(solution->chosen);
    INTEGER(solution->inlier_count);
    INTEGER(solution->lights_from_behind);
    INTEGER(solution->reason);
    INTEGER(solution->reason_channel);
    NUMBER(solution->reason_value);
    NUMBER(solution->reason_limit);
    mix_pixel_counts(&solution->pixel_counts);
    mix_color_fit(&solution->fit);
    mix_rank(&solution->rank);
    mix_location(&solution->norm_location);
    mix_inliers(&solution->inlier_test);
    mix_ellipsoid(&solution->ellipsoid);
    mix_tilts(&solution->tilts);
    ARRAY(solution->slant_rad);
    ARRAY(solution->confidence.covariance);
    NUMBER(solution->confidence.error_rad);
    NUMBER(solution->confidence.convexity);
    NUMBER(solution->confidence.log_likelihood_margin);
    INTEGER(solution->confidence.evidence);
    INTEGER(solution->confidence.reserved);
    for (int i = 0; i < OFC_MAX_CANDIDATES; i++)
        mix_slants(&solution->candidates[i]);
    mix_orientation(&solution->orientation);
}

void mix_check(const ofc_check_result *result)
{
    ARRAY(result->correlation);
    NUMBER(result->norm_median);
    NUMBER(result->norm_min);
    NUMBER(result->norm_max);
    mix_tilts(&result->tilts);
    mix_tilts(&result->relit_tilts);
    ARRAY(result->tilt_difference_rad);
    ARRAY(result->tilt_residual_rad);
    NUMBER(result->depth_angle_median_rad);
    mix_tilts(&result->depth_tilts);
    ARRAY(result->depth_tilt_difference_rad);
    NUMBER(result->largest_p);
    NUMBER(result->turn_rad);
    NUMBER(result->turn_expected_rad);
    NUMBER(result->convexity);
    INTEGER(result->inlier_count);
    INTEGER(result->has_tilts);
    INTEGER(result->depth_pixel_count);
    INTEGER(result->has_depth_tilts);
    INTEGER(result->has_turn);
    INTEGER(result->reserved);
}

void mix_disc(const ofc_disc *disc)
{
    INTEGER(disc->x);
    INTEGER(disc->y);
    mix_integer(disc->radius_squared);
}

void mix_integrability(const ofc_integrability *integrability)
{
    NUMBER(integrability->mean);
    INTEGER(integrability->cells);
    INTEGER(integrability->reserved);
}

static void mix_transformation(const ofc_transformation *transformation)
{
    ARRAY(transformation->rows);
    ARRAY(transformation->f);
    ARRAY(transformation->f_inverse);
    ARRAY(transformation->tilt_rad);
    ARRAY(transformation->slant_rad);
}

void mix_orthogonal(const ofc_orthogonal *found)
{
    mix_transformation(&found->chosen);
    mix_transformation(&found->twin);
    NUMBER(found->margin);
    mix_integrability(&found->integral);
    mix_integrability(&found->unpolished);
    INTEGER(found->choice);
    INTEGER(found->evaluations);
}

void mix_rendering(const ofc_rendering *rendering)
{
    NUMBER(rendering->largest_modulus);
    NUMBER(rendering->scale);
    ARRAY(rendering->f);
}

void mix_paint_estimate(const ofc_paint *paint)
{
    ARRAY(paint->coefficients);
    NUMBER(paint->margin);
    NUMBER(paint->direction_noise);
    NUMBER(paint->ratio);
    NUMBER(paint->disagreement);
    NUMBER(paint->hue_excess);
    ARRAY(paint->gradient);
    ARRAY(paint->variogram);
    mix_pixel_counts(&paint->pixel_counts);
    INTEGERS(paint->distances);
    INTEGERS(paint->pair_counts);
    INTEGER(paint->verdict);
    INTEGER(paint->reserved);
}

void mix_region(const ofc_region *region)
{
    ARRAY(region->coefficients);
    NUMBER(region->residual_deviation);
    mix_rank(&region->rank);
    INTEGER(region->pixel_count);
    INTEGER(region->label);
    INTEGERS(region->seed_block);
    INTEGER(region->spacing);
    INTEGER(region->reserved);
}

void mix_lmeds_params(const ofc_lmeds_params *params)
{
    NUMBER(params->confidence);
    NUMBER(params->outlier_ratio);
    NUMBER(params->rejection);
    NUMBER(params->limits_confidence);
    NUMBER(params->saturation);
    mix_integer(params->seed);
    INTEGER(params->min_subsets);
    INTEGER(params->subsets);
    INTEGER(params->sample_size);
    INTEGER(params->method);
    INTEGER(params->weighting);
    INTEGERS(params->reserved);
}

void mix_solve_params(const ofc_solve_params *params)
{
    mix_lmeds_params(&params->lmeds);
    NUMBER(params->rank_threshold);
    ARRAY(params->tilt_rad);
    INTEGER(params->tilt_estimator);
    INTEGER(params->slant_fallback);
    INTEGER(params->orientation_method);
    INTEGER(params->norm_source);
    INTEGER(params->convexity);
    INTEGERS(params->reserved);
}

void mix_render_params(const ofc_render_params *params)
{
    NUMBER(params->peak);
    NUMBER(params->noise);
    mix_integer(params->seed);
    INTEGER(params->cast_shadows);
    INTEGERS(params->reserved);
}

void mix_annealing_params(const ofc_annealing_params *params)
{
    ARRAY(params->temperatures);
    ARRAY(params->angles_rad);
    mix_integer(params->seed);
    INTEGER(params->proposals);
    INTEGER(params->chains);
    INTEGER(params->sample_cells);
    INTEGER(params->polish_evaluations);
    INTEGERS(params->reserved);
}

void mix_segment_params(const ofc_segment_params *params)
{
    NUMBER(params->tolerance);
    NUMBER(params->saturation);
    mix_integer(params->seed);
    INTEGER(params->min_pixels);
    INTEGER(params->max_regions);
    INTEGER(params->seed_blocks);
    INTEGER(params->spacing);
    INTEGER(params->search_radius);
    INTEGER(params->refits);
    INTEGERS(params->reserved);
}

void mix_depth_params(const ofc_depth_params *params)
{
    NUMBER(params->pixel_pitch);
    NUMBER(params->tolerance);
    NUMBER(params->min_n3);
    NUMBER(params->prior_weight);
    NUMBER(params->smoothness);
    INTEGER(params->method);
    INTEGER(params->max_cycles);
    INTEGERS(params->reserved);
}

void mix_depth_result(const ofc_depth_result *result)
{
    NUMBER(result->residual);
    INTEGER(result->cycles);
    INTEGER(result->regions);
    INTEGER(result->pixel_count);
    INTEGER(result->excluded_count);
    INTEGER(result->converged);
    INTEGER(result->reserved);
}

void mix_drift(const ofc_stream_drift *drift)
{
    NUMBER(drift->inlier_ratio);
    ARRAY(drift->angle_rad);
    ARRAY(drift->strength_ratio);
    NUMBER(drift->dispersion_ratio);
    INTEGER(drift->refined);
    INTEGER(drift->reserved);
}

void mix_surface_result(const ofc_surface_result *result)
{
    for (int i = 0; i < 3; i++) {
        const ofc_surface_light *light = &result->lights[i];
        ARRAY(light->direction);
        ARRAY(light->color);
        INTEGER(light->dual_source);
        INTEGER(light->reserved);
    }
    NUMBER(result->border_gap_rad);
    INTEGERS(result->class_counts);
    INTEGER(result->light_count);
    INTEGER(result->regions);
    INTEGER(result->converged);
    INTEGER(result->reserved);
}
