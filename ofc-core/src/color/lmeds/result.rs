//! What the regression found, or why there is nothing to find.

use super::params::MIN_PIXELS;
use crate::color::ellipsoid::Coefficients;
use crate::color::inliers::Band;
use crate::color::regression::{Estimate, TERMS, Triangle};
use crate::picture::PixelCounts;
use core::fmt;

/// Why there is no fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitError {
    /// A parameter is out of its range.
    Params,
    /// The workspace is shorter than [`workspace_len`](super::workspace_len).
    WorkspaceTooShort,
    /// Fewer than [`MIN_PIXELS`] usable pixels.
    TooFewPixels,
    /// Fewer than [`MIN_PIXELS`] usable pixels, because most pixels are black.
    Dark,
    /// Fewer than [`MIN_PIXELS`] usable pixels, because most pixels are saturated.
    Saturated,
    /// The colors do not determine the six coefficients: they, or the normals, span less than three dimensions.
    RankDeficient {
        /// The singular values of the usable pixels' colors, root mean square, descending, in pixel values.
        color_deviations: [f64; 3],
    },
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Params => f.write_str("a parameter is out of its range"),
            Self::WorkspaceTooShort => f.write_str("the workspace is too short"),
            Self::TooFewPixels => write!(f, "fewer than {MIN_PIXELS} usable pixels"),
            Self::Dark => write!(f, "fewer than {MIN_PIXELS} usable pixels: most are black"),
            Self::Saturated => write!(f, "fewer than {MIN_PIXELS} usable pixels: most are saturated"),
            Self::RankDeficient { .. } => {
                f.write_str("the colors, or the normals, span less than three dimensions")
            }
        }
    }
}

impl core::error::Error for FitError {}

/// What the regression found. Coefficients are in (pixel value)^-2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The z that minimizes the median squared residual; that of least squares where that is the method.
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
    /// on large pictures the first is the smallest. The upper triangle, row by row. NaN, which is not known, in a
    /// stream without the feature `full-streams`.
    pub covariance: Triangle,
    /// The standard deviation of the inliers' residuals under the reweighted fit.
    pub residual_deviation: f64,
    /// The singular values of the inliers' colors, root mean square, descending, in pixel values.
    pub color_deviations: [f64; 3],
    /// The noise in each channel that explains the inliers' residuals, as a standard deviation in pixel values; at least
    /// what rounding to the picture's steps makes.
    pub noise_deviation: f64,
    /// The noise in each channel to expect of single pixels, as a standard deviation in pixel values: from the median of the
    /// residuals, with regard to what the rejection cuts off, and at least what rounding makes. In a stream without
    /// `full-streams` only what rounding makes.
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
    /// Whether pixels counted by how rare their colors are, see [`Weighting`](super::Weighting); all but `usable` and `inliers` is then
    /// of a sample so weighted.
    pub by_colors: bool,
}

impl Fit {
    /// The coefficients of the reweighted fit.
    #[must_use]
    pub fn z(&self) -> Coefficients {
        self.coefficients.map(|estimate| estimate.value)
    }
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
