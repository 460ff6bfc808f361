//! Least median of squares (LMS in the paper) for M z = 1, and the reweighted fit after it.
//!
//! Seeded random subsets of six pixels propose ellipsoids; each is evaluated by the median residual over a stratified
//! sample of the picture; concentration steps polish the best; the objective that counts is then the exact median over
//! all usable pixels. Pixels with a residual within 2.5 dispersions are inliers and are fitted by least squares.
//!
//! # Reference
//! Sections 2.1-2.2, eqs. 10-12. P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier Detection", Wiley 1987.
//! P. J. Rousseeuw, K. Van Driessen, "Computing LTS regression for large data sets", 2006 (concentration steps).

mod evaluate;
mod noise;
mod reweighted;
mod search;

pub(crate) use evaluate::evaluate;
pub(crate) use reweighted::{Refit, least_squares};
pub(crate) use search::search;

use crate::color::ellipsoid::Coefficients;
use crate::color::inliers::Band;
use crate::color::regression::{Estimate, TERMS, Triangle};
use crate::math::rng::Rng;
use crate::picture::{Image, PixelCounts, Usable};
use libm::{ceil, log, log1p};
use search::Sample;

/// Fewer usable pixels than this are refused: half of them must still hold the six of a subset.
pub const MIN_PIXELS: usize = 12;

/// Proposals are never more than this, whatever the parameters ask for.
pub const MAX_SUBSETS: u32 = 10_000_000;

/// What fits the form to the pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Least median of squares, rejection, and least squares over what is left.
    #[default]
    LeastMedian,
    /// Least squares over all usable pixels, none rejected: photometric stereo with unknown lights as R. J. Woodham, Y.
    /// Iwahori and R. A. Barman (TR 91-18, 1991) have it. For pictures in which every pixel obeys the model.
    LeastSquares,
}

/// How to search, and what to reject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// What fits. Default [`Method::LeastMedian`]; the search's parameters mean nothing to the other.
    pub method: Method,
    /// The probability that at least one subset is free of outliers, in (0, 1). Default 0.9999.
    pub confidence: f64,
    /// The share of outliers for which that holds, in [0, 1). Default 0.5.
    pub outlier_share: f64,
    /// At least this many subsets are drawn. Default 500.
    pub min_subsets: u32,
    /// Exactly this many subsets, or 0 for the number that `confidence` and `outlier_share` ask for. Default 0.
    pub subsets: u32,
    /// Pixels that the search looks at; all are looked at when there are fewer. Default 10,000.
    pub sample_size: u32,
    /// Fixes every random choice. Default 0.
    pub seed: u64,
    /// Residuals above this many dispersions are outliers. Default 2.5.
    pub rejection: f64,
    /// The confidence of the limits given with each coefficient, in (0, 1). Default 0.95.
    pub limits_confidence: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            method: Method::LeastMedian,
            confidence: 0.9999,
            outlier_share: 0.5,
            min_subsets: 500,
            subsets: 0,
            sample_size: 10_000,
            seed: 0,
            rejection: 2.5,
            limits_confidence: 0.95,
        }
    }
}

impl Params {
    /// How many subsets these parameters ask for, or `None` when one of them is out of its range.
    #[must_use]
    pub fn subset_count(&self) -> Option<u32> {
        let in_range = self.rejection > 0.0
            && self.rejection.is_finite()
            && self.limits_confidence > 0.0
            && self.limits_confidence < 1.0
            && self.sample_size as usize >= MIN_PIXELS
            && self.subsets <= MAX_SUBSETS;
        let count = subset_count(self.confidence, self.outlier_share, self.min_subsets)?;
        in_range.then_some(if self.subsets > 0 { self.subsets } else { count })
    }
}

/// The number of random six-pixel subsets of which, with probability `confidence`, at least one holds no outlier when
/// the share of outliers is `outlier_share`; at least `min_subsets` and at least 1.
///
/// `None` when a parameter is out of range (see [`Params`]) or the answer is above [`MAX_SUBSETS`].
#[must_use]
#[expect(clippy::cast_sign_loss, reason = "a count of at least 1")]
pub fn subset_count(confidence: f64, outlier_share: f64, min_subsets: u32) -> Option<u32> {
    let in_range = confidence > 0.0
        && confidence < 1.0
        && (0.0..1.0).contains(&outlier_share)
        && min_subsets <= MAX_SUBSETS;
    if !in_range {
        return None;
    }
    let share = 1.0 - outlier_share;
    let good = (share * share * share) * (share * share * share);
    // log1p(-1) is -infinity when every subset is good, and then the quotient is 0.
    let count = ceil(log(1.0 - confidence) / log1p(-good)).max(1.0).max(f64::from(min_subsets));
    (count <= f64::from(MAX_SUBSETS)).then_some(count as u32)
}

/// Why there is no fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitError {
    /// A parameter is out of its range.
    Params,
    /// The workspace is shorter than [`workspace_len`].
    WorkspaceTooShort,
    /// Fewer than [`MIN_PIXELS`] usable pixels.
    TooFewPixels,
    /// As [`FitError::TooFewPixels`], because most pixels are black.
    Dark,
    /// As [`FitError::TooFewPixels`], because most pixels are saturated.
    Saturated,
    /// The colors do not determine the six coefficients: they, or the normals, span less than three dimensions.
    RankDeficient {
        /// As [`Fit::color_deviations`], over all usable pixels.
        color_deviations: [f64; 3],
    },
}

/// What the regression found. Coefficients are in (pixel value)^-2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The z that minimises the median squared residual; that of least squares where that is the method.
    pub robust: Coefficients,
    /// The square root of that median, over all usable pixels.
    pub median_residual: f64,
    /// The robust dispersion s0 of eq. 12.
    pub dispersion: f64,
    /// The robust coefficient of determination, 1 - `median_residual`^2.
    pub r_squared: f64,
    /// The rejection that follows from `robust` and `dispersion`; everything is accepted under least squares.
    pub band: Band,
    /// The reweighted fit: least squares over the inliers.
    pub coefficients: [Estimate; TERMS],
    /// What squares and products of the errors of these coefficients are expected to be: the covariance of least squares,
    /// the square of the bias that noise makes, and that of the difference from `robust`, toward which its inliers pull the fit;
    /// on large pictures the first is the smallest. The upper triangle, row by row. Zero in a
    /// stream without the feature `full-streams`.
    pub covariance: Triangle,
    /// The standard deviation of the inliers' residuals under the reweighted fit.
    pub residual_deviation: f64,
    /// The singular values of the inliers' colors, root mean square, descending, in pixel values.
    pub color_deviations: [f64; 3],
    /// The noise in each channel that explains the inliers' residuals, as a standard deviation in pixel values; at least
    /// what rounding to the picture's steps makes.
    pub noise_deviation: f64,
    /// The same from the median of the residuals, with regard to what the rejection cuts off: what to expect of single pixels. In
    /// a stream without `full-streams` only what rounding makes.
    pub pixel_noise: f64,
    /// The noise in each channel with which colors that do not determine C could look like these. The coefficients are
    /// biased by about (`noise_deviation` / `degenerate_noise_deviation`)^2, whatever their standard errors say.
    pub degenerate_noise_deviation: f64,
    /// Usable pixels.
    pub usable: usize,
    /// Usable pixels within the band.
    pub inliers: usize,
    /// Subsets drawn; none under least squares.
    pub subsets: u32,
}

impl Fit {
    /// The coefficients of the reweighted fit.
    #[must_use]
    pub fn z(&self) -> Coefficients {
        self.coefficients.map(|estimate| estimate.value)
    }
}

/// How many `f32` [`fit`] needs for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize, sample_size: u32) -> usize {
    let sample = if pixels < sample_size as usize { pixels } else { sample_size as usize };
    let search = sample.saturating_mul(4);
    if pixels > search { pixels } else { search }
}

/// Fits the colour-space quadratic form to the usable pixels of `image`.
///
/// # Errors
/// See [`FitError`].
///
/// # Scratch
/// [`workspace_len`] `f32`; what they hold before does not matter.
pub fn fit(image: &Image, usable: Usable, params: &Params, workspace: &mut [f32]) -> Result<Fit, FitError> {
    let subsets = params.subset_count().ok_or(FitError::Params)?;
    let pixels = image.width() * image.height();
    let workspace =
        workspace.get_mut(..workspace_len(pixels, params.sample_size)).ok_or(FitError::WorkspaceTooShort)?;

    let pixel_counts = usable.count(image);
    enough(&pixel_counts, pixels)?;
    // A power of two, so that scaling is exact.
    let scale = reciprocal_power_of_two(pixel_counts.largest);
    let scaled = match params.method {
        Method::LeastMedian => {
            let mut rng = Rng::new(params.seed);
            let sample_len = pixel_counts.usable.min(params.sample_size as usize);
            Sample::gather(image, usable, pixel_counts.usable, sample_len, scale, &mut rng, workspace)
                .ok_or(FitError::WorkspaceTooShort)?
                .best(subsets, &mut rng)
        }
        Method::LeastSquares => least_squares(image, usable, scale),
    };
    let mut fit = None;
    evaluate::<true>(image, usable, pixel_counts.usable, scale, scaled, params, workspace, &mut fit)?;
    fit.ok_or(FitError::TooFewPixels)
}

/// Whether there are enough usable pixels for a fit, out of `pixels`.
pub(crate) fn enough(pixel_counts: &PixelCounts, pixels: usize) -> Result<(), FitError> {
    if pixel_counts.usable >= MIN_PIXELS {
        return Ok(());
    }
    let offered = pixels - pixel_counts.masked_out;
    Err(if pixel_counts.dark * 2 > offered {
        FitError::Dark
    } else if pixel_counts.saturated * 2 > offered {
        FitError::Saturated
    } else {
        FitError::TooFewPixels
    })
}

/// 2^-k for the k that brings `largest` into [1, 2).
pub(crate) fn reciprocal_power_of_two(largest: f32) -> f64 {
    libm::ldexp(1.0, -libm::ilogbf(largest))
}
