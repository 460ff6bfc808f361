//! The robust dispersion of residuals, from their median.
//!
//! # Reference
//! Section 2.2, eq. 12. P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier Detection", Wiley 1987, p. 202.

/// The normal distribution's median absolute deviation is 1 / 1.4826 standard deviations: f of eq. 12.
pub(crate) const CONSISTENCY: f64 = 1.482_602_218_505_602;

/// The root of the sum of the squares of 1, -2, 1, the weights of a second difference.
pub(crate) const SECOND_DIFFERENCE: f64 = 2.449_489_742_783_178;

/// Eq. 12: f (1 + 5 / (n - p)) times the median absolute residual of `count` numbers n, of which a fit with
/// `parameters` parameters p leaves these residuals.
pub(crate) fn dispersion(median: f64, count: usize, parameters: usize) -> f64 {
    CONSISTENCY * (1.0 + 5.0 / (count as f64 - parameters as f64)) * median
}
