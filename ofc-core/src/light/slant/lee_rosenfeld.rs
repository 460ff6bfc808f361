//! Lee and Rosenfeld's slant and strength of a light, from the mean and mean square of the intensity of a sphere's lit part.
//!
//! # Reference
//! Section 3.2, eq. 23, and section 4. C.-H. Lee, A. Rosenfeld, "Improved methods of estimating shape from shading using
//! the light source coordinate system", Artificial Intelligence 26, 1985.

use super::{Estimate, Reach, moments, solve_increasing};
use crate::math::angle::sincos;
use crate::picture::{Image, Window};
use core::f64::consts::PI;
use libm::sqrt;

/// Beyond this slant eq. 23 is lost in rounding.
const LARGEST: f64 = PI - 0.01;

/// The slants of the three channels' lights in [0, pi), and their strengths rho in pixel values. Above pi/2 the light is behind
/// the object, an answer of eq. 23 that Table 1 prints (91.70 degrees).
///
/// The statistic is `<I^2>^(1/2) / <I>`, which is 3/(2 sqrt 2) = 1.0607 at slant 0; below that the slant is 0 and
/// [`Reach::BelowZero`], as in Table 1. The strength is what `<I>` is worth at the slant; beyond the reach of eq. 23 it is as
/// wrong as the slant.
///
/// `inliers` gives the bits of a window's pixels, which should be those that see the light ("non-zero pixels"). `None`
/// when there are none or a channel's mean is not positive.
pub fn slants(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<([Estimate; 3], [f64; 3])> {
    let moments = moments(image, inliers)?;
    let mut estimates = [Estimate { slant: 0.0, statistic: 0.0, reach: Reach::Inside }; 3];
    let mut strengths = [0.0; 3];
    let lights = estimates.iter_mut().zip(&mut strengths);
    let pairs = moments.mean.into_iter().zip(moments.mean_square);
    for ((estimate, strength), (first, second)) in lights.zip(pairs) {
        if first <= 0.0 || !second.is_finite() {
            return None;
        }
        let statistic = sqrt(second) / first;
        let (slant, reach) = solve_increasing(statistic, LARGEST, ratio);
        *estimate = Estimate { slant, statistic, reach };
        *strength = first / mean(slant);
    }
    Some((estimates, strengths))
}

/// `<I^2>^(1/2) / <I>` by eq. 23: it grows with the slant.
#[must_use]
pub fn ratio(slant: f64) -> f64 {
    0.5 * sqrt(1.0 + sincos(slant).1) / mean(slant)
}

/// `<I> / rho` by eq. 23: with the measured `<I>` it gives the strength rho of the light.
#[must_use]
pub fn mean(slant: f64) -> f64 {
    let (s, c) = sincos(slant);
    4.0 / (3.0 * PI) * ((PI - slant) * c + s) / (1.0 + c)
}
