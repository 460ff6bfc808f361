//! From the z that was found to the fit: the objective over all pixels, and the rejection that follows from it.

use super::noise::noise;
use super::reweighted::{Refit, covariance, deviations, moments, reweighted};
use super::{Fit, FitError, Method, Params};
use crate::color::dispersion::dispersion;
use crate::color::ellipsoid::{Coefficients, quadratic_form};
use crate::color::inliers::{Band, Inliers};
use crate::color::regression::{Moments, TERMS};
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::Pixels;
use crate::picture::Usable;
use libm::fabs;

/// The fit that follows from the `scaled` z that was found: rejection and the reweighted fit, over the `count` usable ones
/// of these pixels. It is in `out` unless there is an error. Its covariance and the noise of its pixels are there if `ERRORS`,
/// and zero otherwise.
#[inline(never)]
#[expect(clippy::too_many_arguments, reason = "what a search leaves, and what it was given")]
pub(crate) fn evaluate<const ERRORS: bool>(
    pixels: &impl Pixels,
    usable: Usable,
    count: usize,
    scale: f64,
    scaled: Option<Coefficients>,
    params: &Params,
    workspace: &mut [f32],
    out: &mut Option<Fit>,
) -> Result<(), FitError> {
    let degenerate = || degenerate(pixels, usable, scale);
    let robust = scaled.ok_or_else(degenerate)?.map(|c| c * scale * scale);
    let rejection =
        Rejection::new(robust, count, median_residual(pixels, usable, &robust, workspace), params);
    let inliers = Inliers { residual: rejection.band, ..Inliers::all(usable) };
    let moments = moments(pixels, &inliers, scale);
    rejection.refit(pixels, &inliers, &moments, scale, count, params, out).ok_or_else(degenerate)?;
    if let (true, Some(fit)) = (ERRORS, out) {
        covariance(&moments, scale, &robust, fit);
        fit.pixel_noise = fit.pixel_noise.max(noise(pixels, &inliers, &fit.z(), workspace));
    }
    Ok(())
}

/// What follows from the robust z alone.
struct Rejection {
    median_residual: f64,
    dispersion: f64,
    band: Band,
}

impl Rejection {
    fn new(robust: Coefficients, count: usize, median_residual: f64, params: &Params) -> Self {
        let dispersion = dispersion(median_residual, count, TERMS);
        let band = match params.method {
            Method::LeastMedian => Band::residual(robust, dispersion, params.rejection),
            Method::LeastSquares => Band { form: robust, ..Band::EVERYTHING },
        };
        Self { median_residual, dispersion, band }
    }

    /// The fit to the inliers, but for its covariance; `None` where they determine none.
    #[inline(never)]
    #[expect(clippy::too_many_arguments, reason = "as above")]
    fn refit(
        &self,
        pixels: &impl Pixels,
        inliers: &Inliers,
        moments: &Moments,
        scale: f64,
        count: usize,
        params: &Params,
        out: &mut Option<Fit>,
    ) -> Option<()> {
        let refit = reweighted(pixels, inliers, moments, scale, params.limits_confidence);
        self.finish(refit.as_ref()?, count, params, out);
        Some(())
    }

    /// The whole fit, where it is wanted.
    #[inline(never)]
    fn finish(&self, refit: &Refit, count: usize, params: &Params, out: &mut Option<Fit>) {
        *out = Some(Fit {
            robust: self.band.form,
            median_residual: self.median_residual,
            dispersion: self.dispersion,
            r_squared: 1.0 - self.median_residual * self.median_residual,
            band: self.band,
            coefficients: refit.coefficients,
            covariance: [0.0; 21],
            residual_deviation: refit.residual_deviation,
            color_deviations: refit.color_deviations,
            noise_deviation: refit.noise_deviation,
            pixel_noise: refit.pixel_noise,
            degenerate_noise_deviation: refit.degenerate_noise_deviation,
            usable: count,
            inliers: refit.count as usize,
            subsets: match params.method {
                Method::LeastMedian => params.subset_count().unwrap_or(0),
                Method::LeastSquares => 0,
            },
        });
    }
}

/// The error where the usable pixels determine no z.
#[inline(never)]
fn degenerate(pixels: &impl Pixels, usable: Usable, scale: f64) -> FitError {
    let moments = moments(pixels, &Inliers::all(usable), scale);
    FitError::RankDeficient { color_deviations: deviations(&moments, scale) }
}

/// The median absolute residual of the usable pixels.
#[inline(never)]
fn median_residual(pixels: &impl Pixels, usable: Usable, z: &Coefficients, workspace: &mut [f32]) -> f64 {
    let residuals = pixels
        .gather(Inliers::all(usable).selector(), workspace, |r, g, b| fabs(quadratic_form(z, r, g, b) - 1.0));
    kth_smallest(residuals, median_rank(residuals.len())).map_or(0.0, f64::from)
}
