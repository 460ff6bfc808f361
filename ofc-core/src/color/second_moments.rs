//! Sums of the squares and products of colors.

use super::ellipsoid::{Coefficients, matrix};
use crate::math::mat3::Mat3;

/// The sums of rr, gg, bb, rg, rb and gb over colors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SecondMoments(Coefficients);

impl SecondMoments {
    /// Adds a color.
    #[inline]
    pub fn add(&mut self, [r, g, b]: [f64; 3]) {
        for (sum, value) in self.0.iter_mut().zip([r * r, g * g, b * b, r * g, r * b, g * b]) {
            *sum += value;
        }
    }

    /// The sum of rho rho^T.
    pub const fn sum(&self) -> Mat3 {
        matrix(&self.0)
    }

    /// The mean of rho rho^T over `count` colors.
    pub fn mean(&self, count: f64) -> Mat3 {
        matrix(&self.0.map(|sum| sum / count))
    }
}
