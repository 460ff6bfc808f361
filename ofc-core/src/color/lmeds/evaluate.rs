//! From the z that was found to the fit: the objective over all pixels, and the rejection that follows from it.

use super::bracketed::Bracket;
use super::noise::noise;
use super::params::Method;
use super::problem::Problem;
use super::rejection::Rejection;
use super::result::{Fit, FitError};
use super::reweighted::{Refit, deviations, put_covariance};
use crate::color::ellipsoid::{Coefficients, quadratic_form};
use crate::color::inliers::Inliers;
use crate::color::regression::Moments;
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{Image, Pixels};
use libm::fabs;

impl<P: Pixels> Problem<'_, P> {
    /// Puts the fit that follows from the `scaled` z into `out`: rejection, and the reweighted fit to what is left. Its covariance
    /// and the noise of single pixels are there if `ERRORS`; without, the one is zero and the other what rounding makes.
    ///
    /// A fit is a kilobyte almost: it is made where it is to stay, and never lies on a small stack.
    ///
    /// # Errors
    /// [`FitError::RankDeficient`] where no z was found, and where the pixels that are left determine none. `out` means nothing then.
    ///
    /// # Scratch
    /// One `f32` a usable pixel.
    #[inline(never)]
    pub fn evaluate<const ERRORS: bool>(
        &self,
        scaled: Option<Coefficients>,
        workspace: &mut [f32],
        out: &mut Option<Fit>,
    ) -> Result<(), FitError> {
        let scaled = scaled.ok_or_else(|| self.rank_deficient())?;
        let robust = scaled.map(|c| c * self.scale * self.scale);
        let rejection = self.rejection(robust, self.median_residual(&robust, workspace));
        let moments = self.moments(&self.inliers(&rejection));
        self.conclude::<ERRORS>(&rejection, &moments, workspace, out)
    }

    /// The fit that follows from a rejection and the sums over what it leaves.
    fn conclude<const ERRORS: bool>(
        &self,
        rejection: &Rejection,
        moments: &Moments,
        workspace: &mut [f32],
        out: &mut Option<Fit>,
    ) -> Result<(), FitError> {
        let inliers = self.inliers(rejection);
        self.reweighted(rejection, &inliers, moments, out).ok_or_else(|| self.rank_deficient())?;
        if let (true, Some(fit)) = (ERRORS, out) {
            put_covariance(moments, self.scale, fit);
            let noise = self.pixels.of_part(|part| noise(part, &inliers, &fit.z(), self.scale, workspace));
            fit.pixel_noise = fit.pixel_noise.max(noise);
        }
        Ok(())
    }

    /// The scaled z of the reweighted fit that follows from the `scaled` z, and nothing else of it; `None` where the pixels that are
    /// left determine none.
    ///
    /// # Scratch
    /// One `f32` a usable pixel.
    pub fn reweighted_z(&self, scaled: &Coefficients, workspace: &mut [f32]) -> Option<Coefficients> {
        let robust = scaled.map(|c| c * self.scale * self.scale);
        let rejection = self.rejection(robust, self.median_residual(&robust, workspace));
        self.moments(&self.inliers(&rejection)).solve().map(|fit| fit.coefficients)
    }

    pub(super) fn inliers(&self, rejection: &Rejection) -> Inliers {
        Inliers { residual: rejection.band, ..Inliers::all(self.usable) }
    }

    /// The median absolute residual of the usable pixels.
    #[inline(never)]
    pub(super) fn median_residual(&self, z: &Coefficients, workspace: &mut [f32]) -> f64 {
        let residual = |r, g, b| fabs(quadratic_form(z, r, g, b) - 1.0);
        let residuals = self.pixels.gather(Inliers::all(self.usable).selector(), workspace, residual);
        kth_smallest(residuals, median_rank(residuals.len())).map_or(0.0, f64::from)
    }

    /// The fit to the inliers, whose moments are given, but for what its errors are; `None` where they determine none.
    #[inline(never)]
    fn reweighted(
        &self,
        rejection: &Rejection,
        inliers: &Inliers,
        moments: &Moments,
        out: &mut Option<Fit>,
    ) -> Option<()> {
        let refit = self.refit(inliers, moments);
        self.finish(rejection, refit.as_ref()?, out);
        Some(())
    }

    #[inline(never)]
    fn finish(&self, rejection: &Rejection, refit: &Refit, out: &mut Option<Fit>) {
        *out = Some(Fit {
            robust: rejection.band.form,
            median_residual: rejection.median_residual,
            dispersion: rejection.dispersion,
            r_squared: 1.0 - rejection.median_residual * rejection.median_residual,
            band: rejection.band,
            coefficients: refit.coefficients,
            // Not known yet.
            covariance: [f64::NAN; 21],
            residual_deviation: refit.residual_deviation,
            color_deviations: refit.color_deviations,
            noise_deviation: refit.noise_deviation,
            pixel_noise: refit.pixel_noise,
            degenerate_noise_deviation: refit.degenerate_noise_deviation,
            usable: self.count,
            inliers: refit.count as usize,
            subsets: match self.params.method {
                Method::LeastMedian => self.params.subset_count().unwrap_or(0),
                Method::LeastSquares => 0,
            },
            by_colors: false,
        });
    }

    /// The error where the usable pixels determine no z.
    #[inline(never)]
    fn rank_deficient(&self) -> FitError {
        let moments = self.moments(&Inliers::all(self.usable));
        FitError::RankDeficient { color_deviations: deviations(&moments, self.scale) }
    }
}

impl Problem<'_, Image<'_>> {
    /// [`Self::evaluate`], in one pass where there is a bracket, and it is good; the count may then be an estimate.
    pub fn evaluate_within<const ERRORS: bool>(
        &self,
        scaled: Option<Coefficients>,
        bracket: Option<Bracket>,
        workspace: &mut [f32],
        out: &mut Option<Fit>,
    ) -> Result<(), FitError> {
        if let (Some(z), Some(bracket)) = (&scaled, bracket)
            && let Some((count, rejection, moments)) = self.bracketed(z, bracket, workspace)
        {
            let counted = Problem { count, ..*self };
            return counted.conclude::<ERRORS>(&rejection, &moments, workspace, out);
        }
        let is_exact = bracket.is_none();
        let count = if is_exact { self.count } else { Inliers::all(self.usable).count(self.pixels) };
        Problem { count, ..*self }.evaluate::<ERRORS>(scaled, workspace, out)
    }
}
