//! Least median of squares (LMS in the paper) for M z = 1, and the reweighted fit after it.
//!
//! Seeded random subsets of six pixels propose ellipsoids; each is evaluated by the median residual over a stratified
//! sample of the picture; concentration steps polish the best, the last of them on a larger sample; the objective that counts is then
//! the exact median over all usable pixels, which a large picture is read for once (`bracketed`). Where one color is the majority, pixels may be weighted by how rare their colors are, see [`Weighting`].
//! Pixels with a residual within 2.5 dispersions are inliers and are fitted by least squares.
//!
//! # Reference
//! Sections 2.1-2.2, eqs. 10-12. P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier Detection", Wiley 1987.
//! P. J. Rousseeuw, K. Van Driessen, "Computing LTS regression for large data sets", 2006 (concentration steps).

mod bracketed;
mod by_colors;
mod draw;
mod evaluate;
mod noise;
mod params;
mod problem;
mod rejection;
mod result;
mod reweighted;
mod search;

pub use params::{MAX_SUBSETS, MIN_PIXELS, Method, Params, Weighting, subset_count};
pub use result::{Fit, FitError};

pub(crate) use bracketed::Bracket;
pub(crate) use problem::Problem;
pub(crate) use result::enough;
pub(crate) use reweighted::Refit;
pub(crate) use search::Sample;

use crate::color::ellipsoid::Coefficients;
use crate::color::scale::reciprocal_power_of_two;
use crate::math::rng::Rng;
use crate::picture::{Image, PixelCounts, Pixels as _, Usable};

/// How many `f32` [`fit`] needs for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize, sample_size: u32) -> usize {
    let sample = if pixels < sample_size as usize { pixels } else { sample_size as usize };
    let search = sample.saturating_mul(4);
    if pixels > search { pixels } else { search }
}

/// Fits the color-space quadratic form to the usable pixels of `image`.
///
/// # Errors
/// See [`FitError`].
///
/// # Scratch
/// [`workspace_len`] `f32`; what they hold before does not matter.
pub fn fit(image: &Image, usable: Usable, params: &Params, workspace: &mut [f32]) -> Result<Fit, FitError> {
    let problem = Problem::of(image, usable, &usable.count(image), params)?;
    let found = problem.search(workspace)?;
    problem.fit(&found, workspace)
}

/// What the search found, in a sample of a large picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    /// The scaled z; `None` where the pixels determine none.
    pub scaled: Option<Coefficients>,
    /// Where its median residual lies; `None` where all pixels were looked at.
    bracket: Option<Bracket>,
    /// Whether some color may be the majority.
    pub is_concentrated: bool,
}

impl<'a> Problem<'a, Image<'a>> {
    /// The usable pixels of a picture, which are counted already.
    ///
    /// # Errors
    /// [`FitError`] where the parameters are bad or the pixels too few.
    pub fn of(
        image: &'a Image<'a>,
        usable: Usable,
        pixel_counts: &PixelCounts,
        params: &'a Params,
    ) -> Result<Self, FitError> {
        params.subset_count().ok_or(FitError::Params)?;
        enough(pixel_counts, image.width() * image.height())?;
        let scale = reciprocal_power_of_two(pixel_counts.largest);
        Ok(Self { pixels: image, usable, count: pixel_counts.usable, scale, params })
    }

    /// The z with the least median residual, or that of least squares.
    ///
    /// # Errors
    /// [`FitError::WorkspaceTooShort`].
    ///
    /// # Scratch
    /// [`workspace_len`] `f32`.
    pub fn search(&self, workspace: &mut [f32]) -> Result<Found, FitError> {
        if self.params.method == Method::LeastSquares {
            return Ok(Found { scaled: self.least_squares(), bracket: None, is_concentrated: false });
        }
        let mut rng = Rng::new(self.params.seed);
        let workspace = self.own(workspace)?;
        let mut sample = self.sample(&mut rng, workspace).ok_or(FitError::WorkspaceTooShort)?;
        let scaled = sample.best_of_part(self.params.subset_count().unwrap_or(0), &mut rng);
        let is_concentrated = self.params.weighting == Weighting::Auto && sample.may_be_concentrated();
        let is_part = sample.len() < self.count;
        let bracket = scaled.filter(|_| is_part).and_then(|scaled| sample.bracket(&scaled));
        Ok(Found { scaled, bracket, is_concentrated })
    }

    /// The fit that follows from what was found.
    ///
    /// # Errors
    /// [`FitError`].
    ///
    /// # Scratch
    /// [`workspace_len`] `f32`.
    pub fn fit(&self, found: &Found, workspace: &mut [f32]) -> Result<Fit, FitError> {
        let workspace = self.own(workspace)?;
        let mut fit = None;
        let by_pixels = self
            .evaluate_within::<true>(found.scaled, found.bracket, workspace, &mut fit)
            .and(fit.ok_or(FitError::TooFewPixels));
        let subsets = self.params.subset_count().unwrap_or(0);
        if found.is_concentrated
            && let Some(by_colors) = self.fit_by_colors(by_pixels.as_ref().ok(), subsets, workspace)
        {
            return Ok(by_colors);
        }
        by_pixels
    }

    /// As much of the workspace as is used: more must not change the answer.
    fn own<'w>(&self, workspace: &'w mut [f32]) -> Result<&'w mut [f32], FitError> {
        let len = workspace_len(self.pixels.len(), self.params.sample_size);
        workspace.get_mut(..len).ok_or(FitError::WorkspaceTooShort)
    }
}
