//! The lengths of the normals that C gives to the inliers, and where most of them lie.
//!
//! # Reference
//! Section 2.2, the second rejection.

use super::ellipsoid::{Coefficients, quadratic_form};
use super::inliers::Inliers;
use super::location::{Location, shortest_half};
use crate::picture::Pixels;
use core::num::NonZero;
use libm::sqrt;

/// As many lengths say where half of them lie; of several times as many some, evenly apart, are looked at.
const ENOUGH: usize = 1 << 14;

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
    let step = NonZero::new(norms.len() / ENOUGH).unwrap_or(NonZero::<usize>::MIN);
    let len = norms.len() / step;
    for i in 1..len {
        let norm = norms.get(i * step.get()).copied();
        if let (Some(norm), Some(slot)) = (norm, norms.get_mut(i)) {
            *slot = norm;
        }
    }
    shortest_half(norms.get_mut(..len)?, scratch)
}
