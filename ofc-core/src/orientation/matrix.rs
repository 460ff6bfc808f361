//! The color-orientation matrix F, rho = F n, and its inverse.
//!
//! # Reference
//! Sections 1.1 and 3.4 (steps 5 and 6), eqs. 7, 8 and 19.

use crate::math::angle::sincos;
use crate::math::mat3::{self, Mat3};

/// Singular values of F below this share of the largest are zero, unless the caller says otherwise.
pub const RANK_THRESHOLD: f64 = 1e-3;

/// F with what its singular values say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Row i is `f_i`, the strength and direction of the one light that channel i could have been lit by, in pixel values.
    pub f: Mat3,
    /// The inverse of F over its singular values above the threshold; all of them when `rank` is 3.
    pub f_inverse: Mat3,
    /// The singular values of F, descending.
    pub singular_values: [f64; 3],
    /// How many singular values are above the threshold.
    pub rank: u32,
}

impl Orientation {
    /// Where there is no F.
    pub(crate) const NONE: Self =
        Self { f: [[0.0; 3]; 3], f_inverse: [[0.0; 3]; 3], singular_values: [0.0; 3], rank: 0 };

    /// F and its inverse through the singular values above `rank_threshold` times the largest.
    #[must_use]
    pub fn new(f: Mat3, rank_threshold: f64) -> Self {
        let svd = mat3::svd(&f);
        let (f_inverse, rank) = mat3::pseudo_inverse(&svd, rank_threshold);
        Self { f, f_inverse, singular_values: svd.values, rank }
    }
}

/// The unit vector at a slant from z and a tilt from x (eq. 19), angles in radians.
#[must_use]
pub fn direction(slant: f64, tilt: f64) -> [f64; 3] {
    let ((sin_slant, cos_slant), (sin_tilt, cos_tilt)) = (sincos(slant), sincos(tilt));
    [sin_slant * cos_tilt, sin_slant * sin_tilt, cos_slant]
}

/// F from the lengths, slants and tilts of its rows.
#[must_use]
pub fn compose(norms: [f64; 3], slants: [f64; 3], tilts: [f64; 3]) -> Mat3 {
    let row = |norm, slant, tilt| mat3::scale(direction(slant, tilt), norm);
    let ([n1, n2, n3], [s1, s2, s3], [t1, t2, t3]) = (norms, slants, tilts);
    [row(n1, s1, t1), row(n2, s2, t2), row(n3, s3, t3)]
}
