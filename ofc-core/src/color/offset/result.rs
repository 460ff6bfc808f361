//! What the fit of a center gives.

use super::center::Centered;
use crate::math::mat3::Mat3;
use core::fmt;

/// Colors that a fit needs at least.
pub const LEAST: usize = 60;

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// The ellipsoid and its center, in pixel values.
    pub centered: Centered,
    /// The covariance of the center, in squared pixel values.
    pub covariance: Mat3,
    /// The robust deviation of the colors from the ellipsoid around its center, in pixel values.
    pub deviation: f64,
    /// The robust deviation of the colors from the best ellipsoid around black, in pixel values.
    pub deviation_around_black: f64,
    /// The noise of a channel, by neighbors, in pixel values: what obeys the model deviates by no more.
    pub noise: f64,
    /// The squared length of the center by its covariance: without an offset it is about 3.
    pub chi_squared: f64,
    /// How many colors were fitted.
    pub count: usize,
    /// How many blocks of the picture they are from.
    pub blocks: usize,
}

/// Why there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffsetError {
    /// C is not positive definite, or a number of it is not finite.
    Form,
    /// The workspace is shorter than [`workspace_len`](super::workspace_len) says.
    WorkspaceTooShort,
    /// There are fewer than [`LEAST`] colors, or they are from too few blocks of the picture.
    TooFewPixels,
    /// The colors do not determine a center.
    NotDetermined,
}

impl fmt::Display for OffsetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Form => "C is not positive definite",
            Self::WorkspaceTooShort => "the workspace is too short",
            Self::TooFewPixels => "too few colors, or from too small a part of the picture",
            Self::NotDetermined => "the colors do not determine a center",
        })
    }
}

impl core::error::Error for OffsetError {}
