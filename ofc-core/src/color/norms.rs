//! The lengths of the normals that C gives to the inliers, and where most of them lie.
//!
//! # Reference
//! Section 2.2, the second rejection.

use super::ellipsoid::{Coefficients, quadratic_form};
use super::inliers::Inliers;
use super::location::{Location, shortest_half};
use crate::picture::Pixels;
use libm::sqrt;

/// The location of the lengths of the inliers' normals, sqrt(rho^T C rho); `None` for fewer than two inliers.
///
/// # Scratch
/// Two `f32` a pixel.
pub fn location(
    pixels: &impl Pixels,
    inliers: &Inliers,
    form: &Coefficients,
    workspace: &mut [f32],
) -> Option<Location> {
    let (norms, scratch) = workspace.split_at_mut_checked(pixels.len())?;
    let length = |r, g, b| sqrt(quadratic_form(form, r, g, b).max(0.0));
    let norms = pixels.gather(inliers.selector(), norms, length);
    shortest_half(norms, scratch)
}
