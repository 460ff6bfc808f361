//! From the regression to the inliers: whether the colors determine C, and the second rejection.

use super::parameters::Params;
use super::solution::{Outcome, Solution};
use crate::color::ellipsoid;
use crate::color::inliers::{Band, Inliers};
use crate::color::lmeds::{FitError, Method};
use crate::color::{norms, rank};
use crate::picture::Pixels;

/// The noise that would make a degenerate scene look like this one must be so many times the noise there is. Degenerate
/// scenes (cylinders, planes, cones, ramps, mixtures of colors, with and without noise) come to 0.2-1.1, photographs
/// that give good normals to 1.19-6.7; at the limit a coefficient of C can be mostly bias.
pub(crate) const SMALLEST_NOISE_MARGIN: f64 = 1.15;

impl Solution {
    /// From the fit, which is in its place unless it failed, to the inliers: everything that the places of the pixels mean nothing to. The outcome is
    /// [`Outcome::NoTilt`] where tilts come next.
    ///
    /// # Errors
    /// Those of the fit but [`FitError::RankDeficient`], which is an outcome.
    ///
    /// # Scratch
    /// Two `f32` a pixel.
    pub(crate) fn model(
        &mut self,
        pixels: &impl Pixels,
        fit: Result<(), FitError>,
        params: &Params,
        workspace: &mut [f32],
    ) -> Result<(), FitError> {
        let usable = self.inliers.usable;
        let fit = match (fit, &self.fit) {
            (Ok(()), Some(fit)) => fit,
            (Err(FitError::RankDeficient { color_deviations }), _) => {
                self.color_deviations = color_deviations;
                self.rank = rank::rank(pixels, Inliers::all(usable).selector(), None);
                return Ok(());
            }
            (Err(error), _) => return Err(error),
            (Ok(()), None) => return Ok(()),
        };
        self.color_deviations = fit.color_deviations;
        self.inliers = Inliers { residual: fit.band, ..Inliers::all(usable) };
        self.inlier_count = fit.inliers;
        // Outliers that least squares keeps are no noise: the robust dispersion leaves them out.
        let deviation = match params.lmeds.method {
            Method::LeastMedian => fit.residual_deviation,
            Method::LeastSquares => fit.residual_deviation.min(fit.dispersion),
        };
        self.rank = rank::rank(pixels, self.inliers.selector(), Some((fit.z(), deviation)));
        let share = if deviation < fit.residual_deviation { deviation / fit.residual_deviation } else { 1.0 };
        let noise = fit.noise_deviation * share;
        let is_determined = fit.degenerate_noise_deviation > SMALLEST_NOISE_MARGIN * noise;
        if !is_determined || self.rank.is_some_and(|rank| rank.colors < 3) {
            return Ok(());
        }

        self.outcome = Outcome::NotPositiveDefinite;
        let Ok(ellipsoid) = ellipsoid::decompose(&fit.z()) else { return Ok(()) };
        self.ellipsoid = Some(ellipsoid);
        if self.rank.is_some_and(|rank| !rank.is_full()) {
            self.outcome = Outcome::RankDeficient;
            return Ok(());
        }
        self.norm_location = norms::location(pixels, &self.inliers, &fit.z(), workspace);
        if let Some(norms) = self.norm_location {
            self.inliers.norm = Band::norm(fit.z(), &norms, params.lmeds.rejection);
            self.inlier_count = self.inliers.count(pixels);
        }
        self.outcome = Outcome::NoTilt;
        Ok(())
    }
}
