//! Least median of squares (LMS in the paper) for M z = 1, and the reweighted fit after it.
//!
//! Seeded random subsets of six pixels propose ellipsoids; each is evaluated by the median residual over a stratified
//! sample of the picture; concentration steps polish the best; the objective that counts is then the exact median over
//! all usable pixels. Where one color is the majority, pixels may be weighted by how rare their colors are, see [`Weighting`].
//! Pixels with a residual within 2.5 dispersions are inliers and are fitted by least squares.
//!
//! # Reference
//! Sections 2.1-2.2, eqs. 10-12. P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier Detection", Wiley 1987.
//! P. J. Rousseeuw, K. Van Driessen, "Computing LTS regression for large data sets", 2006 (concentration steps).

mod by_colors;
mod evaluate;
mod noise;
mod params;
mod problem;
mod result;
mod reweighted;
mod search;

pub use params::{MAX_SUBSETS, MIN_PIXELS, Method, Params, Weighting, subset_count};
pub use result::{Fit, FitError};

pub(crate) use problem::Problem;
pub(crate) use result::enough;
pub(crate) use reweighted::Refit;
pub(crate) use search::Sample;

use crate::color::scale::reciprocal_power_of_two;
use crate::math::rng::Rng;
use crate::picture::{Image, PixelCounts, Usable};

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
    fit_counted(image, usable, &usable.count(image), params, workspace)
}

/// [`fit`], where the pixels are counted already.
pub(crate) fn fit_counted(
    image: &Image,
    usable: Usable,
    pixel_counts: &PixelCounts,
    params: &Params,
    workspace: &mut [f32],
) -> Result<Fit, FitError> {
    let subsets = params.subset_count().ok_or(FitError::Params)?;
    let pixels = image.width() * image.height();
    let workspace =
        workspace.get_mut(..workspace_len(pixels, params.sample_size)).ok_or(FitError::WorkspaceTooShort)?;

    enough(pixel_counts, pixels)?;
    let scale = reciprocal_power_of_two(pixel_counts.largest);
    let problem = Problem { pixels: image, usable, count: pixel_counts.usable, scale, params };
    let scaled = match params.method {
        Method::LeastMedian => {
            let mut rng = Rng::new(params.seed);
            let sample = problem.sample(&mut rng, workspace).ok_or(FitError::WorkspaceTooShort)?;
            sample.best(subsets, &mut rng)
        }
        Method::LeastSquares => problem.least_squares(),
    };
    let mut fit = None;
    let by_pixels =
        problem.evaluate::<true>(scaled, workspace, &mut fit).and(fit.ok_or(FitError::TooFewPixels));
    if params.method == Method::LeastMedian
        && params.weighting == Weighting::Auto
        && let Some(by_colors) = problem.fit_by_colors(by_pixels.as_ref().ok(), subsets, workspace)
    {
        return Ok(by_colors);
    }
    by_pixels
}
