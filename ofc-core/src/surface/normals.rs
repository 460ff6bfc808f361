//! Normals from colors, n = F^-1 rho.
//!
//! # Reference
//! Section 2.1, eq. 8, and section 3.4, step 7.

use super::rows;
use super::unit_normals::UnitNormals;
use crate::math::mat3::{self, Mat3};
use crate::math::parallel::{Parallel, Serial};
use crate::picture::{Image, Window};
use libm::sqrt;

pub use super::rows::TooShort;

const LARGEST: f64 = f32::MAX as f64;

/// What becomes of a normal's length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// As the color gives it: near 1 where the model holds. A component that is too large for an `f32` is the largest one.
    Kept,
    /// Set to 1.
    Unit,
}

/// Writes the normal of every inlier and zeros everywhere else.
///
/// # Shape
/// `normals` is height rows of width times (x, y, z), rows `row_stride` `f32` apart, row 0 at the top; what lies between
/// rows is left alone. Frame: x right, y up, z toward the camera.
///
/// # Errors
/// [`TooShort`], also when a row stride is smaller than a row.
pub fn compute(
    image: &Image,
    inliers: impl Fn(&Window) -> u64 + Sync,
    f_inverse: &Mat3,
    length: Length,
    normals: &mut [f32],
    row_stride: usize,
) -> Result<(), TooShort> {
    compute_in_parts(image, inliers, f_inverse, length, normals, row_stride, &Serial)
}

/// What [`compute`] writes, by whatever runs parts.
///
/// # Shape
/// As [`compute`].
///
/// # Errors
/// As [`compute`].
pub fn compute_in_parts(
    image: &Image,
    inliers: impl Fn(&Window) -> u64 + Sync,
    f_inverse: &Mat3,
    length: Length,
    normals: &mut [f32],
    row_stride: usize,
    parallel: &impl Parallel,
) -> Result<(), TooShort> {
    let single = UnitNormals::new(f_inverse);
    let value = |color| normal(f_inverse, color, length).map(|component| component as f32);
    let many = |window: &Window, bits, normals: &mut [_]| match length {
        Length::Unit => single.write(window, bits, normals),
        Length::Kept => {
            normals.fill([0.0; 3]);
            bits
        }
    };
    rows::write_in_parts(image, inliers, many, value, normals, row_stride, parallel)
}

/// What [`compute`] writes of unit length, but in double precision and a pixel after the other: less code, and as fast where there are
/// no vectors.
///
/// # Shape
/// As [`compute`].
///
/// # Errors
/// As [`compute`].
pub fn compute_each(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    f_inverse: &Mat3,
    normals: &mut [f32],
    row_stride: usize,
) -> Result<(), TooShort> {
    let value = |color| normal(f_inverse, color, Length::Unit).map(|component| component as f32);
    rows::write(image, inliers, value, 0.0, normals, row_stride)
}

/// The normal of one color.
#[must_use]
#[inline]
pub fn normal(f_inverse: &Mat3, color: [f32; 3], length: Length) -> [f64; 3] {
    let n = mat3::apply(f_inverse, color.map(f64::from));
    match length {
        Length::Kept => n.map(|component| component.clamp(-LARGEST, LARGEST)),
        // Of no color nothing comes: zero times the largest factor there is.
        Length::Unit => mat3::scale(n, 1.0 / sqrt(mat3::dot(n, n).max(f64::MIN_POSITIVE))),
    }
}
