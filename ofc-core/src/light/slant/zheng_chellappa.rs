//! Zheng and Chellappa's slant, from the mean and mean square of the intensity with the self-shadowed part counted in.
//!
//! The method takes the normals' tilt to be uniform and their slant b to have the density cos b, which is not a
//! sphere's (sin 2b): flat parts count for more, and on a sphere slants of 0, 30, 60 and 85 degrees read 24, 46, 70 and
//! 84. Then f3(s) = `E[I] / E[I^2]^(1/2)`, where I is zero in shadow, falls from
//! 0.962 at s = 0 to 0.551 at pi/2. The paper approximates f3 by a polynomial of degree seven in cos s (0.5577 + 0.6240 c +
//! 0.1882 c^2 - 0.6514 c^3 - ..., as published code has it); this is the integral itself, which that polynomial follows
//! to 0.007.
//!
//! # Reference
//! Q. Zheng, R. Chellappa, "Estimation of illuminant direction, albedo, and shape from shading", PAMI 13, 1991.

use super::{Estimate, Reach, moments, solve_increasing};
use crate::math::angle::sincos;
use crate::picture::{Image, Window};
use core::f64::consts::{FRAC_PI_2, PI};
use libm::{acos, sqrt};

/// Intervals of Simpson's rule: f3 to 1e-6.
const INTERVALS: u32 = 32;

/// The slants of the three channels' lights in [0, pi/2].
///
/// The statistic is `<I> / <I^2>^(1/2)`. Above f3(0) the answer is 0 and [`Reach::BelowZero`], below f3(pi/2) it is pi/2 and
/// [`Reach::AboveLargest`].
///
/// `object` gives the bits of a window's pixels: all of the object, its self-shadowed parts too, which are not inliers.
/// `None` when there are none or a channel's mean is not positive.
pub fn slants(image: &Image, object: impl Fn(&Window) -> u64) -> Option<[Estimate; 3]> {
    let moments = moments(image, object)?;
    let mut estimates = [Estimate { slant: 0.0, statistic: 0.0, reach: Reach::Inside }; 3];
    let pairs = moments.mean.into_iter().zip(moments.mean_square);
    for (estimate, (mean, mean_square)) in estimates.iter_mut().zip(pairs) {
        if mean <= 0.0 || !mean_square.is_finite() {
            return None;
        }
        let statistic = mean / sqrt(mean_square);
        let (slant, reach) = solve_increasing(-statistic, FRAC_PI_2, |slant| -f3(slant));
        *estimate = Estimate { slant, statistic, reach };
    }
    Some(estimates)
}

/// `E[I] / E[I^2]^(1/2)` of a surface whose normals' slants b have the density cos b, under a light at `slant` in
/// [0, pi/2].
#[must_use]
pub fn f3(slant: f64) -> f64 {
    let (s, c) = sincos(slant);
    // Up to this slant a normal sees the light whatever its tilt; there the integrals have closed forms.
    let lit = FRAC_PI_2 - slant;
    let (cl, sl) = (s, c);
    let mut first = c * 0.5 * (lit + sl * cl);
    let mut second = c * c * (sl - sl * sl * sl / 3.0) + s * s * sl * sl * sl / 6.0;
    // From there on b = lit + slant t^2, which makes the integrand smooth where the shadow begins.
    for i in 1..=INTERVALS {
        let t = f64::from(i) / f64::from(INTERVALS);
        let simpson = if i == INTERVALS {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        };
        let b = lit + slant * t * t;
        let (sin_b, cos_b) = sincos(b);
        let weight = simpson / (3.0 * f64::from(INTERVALS)) * 2.0 * slant * t * cos_b / PI;
        let (one, two) = over_tilts(c * cos_b, s * sin_b);
        first += weight * one;
        second += weight * two;
    }
    first / sqrt(second)
}

/// The integrals over a from 0 to pi of I and I^2, I = max(0, along + across cos a).
fn over_tilts(along: f64, across: f64) -> (f64, f64) {
    // Where the shadow begins; without any tilt dependence there is none.
    let end = if across > 0.0 { acos((-along / across).clamp(-1.0, 1.0)) } else { PI };
    let (se, ce) = sincos(end);
    let squares = along * along + 0.5 * across * across;
    let square = squares * end + 2.0 * along * across * se + 0.5 * across * across * se * ce;
    (along * end + across * se, square)
}
