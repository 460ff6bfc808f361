//! Which residuals are too large, from their median.

use super::params::Method;
use super::problem::Problem;
use crate::color::dispersion::dispersion;
use crate::color::ellipsoid::Coefficients;
use crate::color::inliers::Band;
use crate::color::regression::TERMS;

/// Which residuals are too large, and the numbers that this follows from.
pub(super) struct Rejection {
    pub median_residual: f64,
    pub dispersion: f64,
    pub band: Band,
}

impl<P> Problem<'_, P> {
    /// What follows from the robust z and its median residual.
    pub(super) fn rejection(&self, robust: Coefficients, median_residual: f64) -> Rejection {
        let dispersion = dispersion(median_residual, self.count, TERMS);
        let band = match self.params.method {
            Method::LeastMedian => Band::residual(robust, dispersion, self.params.rejection),
            Method::LeastSquares => Band { form: robust, ..Band::EVERYTHING },
        };
        Rejection { median_residual, dispersion, band }
    }
}
