//! Pixels that see all three lights: v = n.

use super::vector::{Matrix, Vector, add, apply, dot, form, length, unit};
use libm::{hypotf, sqrtf};

/// Up to so many deviations of its noise a length is 1.
const REJECTION: f32 = 2.5;
/// Noise is at least this in a length.
const LEAST_NOISE: f32 = 0.01;
/// Up to so many deviations the noise alone may explain a rejected pixel...
const BY_NOISE: f32 = 8.0;
/// ... if the mean of 3 x 3 pixels is within so many of its own noise.
const BY_NOISE_OF_MEANS: f32 = 4.0;
/// Noise of a mean is at least this: neighbors are not one normal.
const LEAST_NOISE_OF_MEANS: f32 = 0.02;
/// A length further from 1 than this says nothing of the normal.
const FURTHEST: f32 = 0.6;
/// Of |v| - 1, the angle that it stands for where a pixel was rejected.
const MISFIT: f32 = 0.8;

/// The normal of a pixel that sees three lights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal {
    pub n: Vector,
    /// Whether its length agrees with the noise.
    pub fits: bool,
    /// The angle in radians that its misfit stands for; 0 where it fits.
    pub misfit: f32,
}

/// The normal of a raw normal `v` whose noise has the covariance `noise`; `mean` is that of 3 x 3 pixels. `None` where it is none.
///
/// Noise moves v off the unit sphere along its own directions: it is moved back along these where noise explains the length, and
/// only scaled where an interreflection or a soft shadow does.
pub(super) fn normal(v: Vector, mean: Vector, noise: &Matrix) -> Option<Normal> {
    let (size, direction) = (length(v), unit(v));
    let off = size - 1.0;
    let variance = form(noise, direction);
    let deviation = sqrtf(variance);
    let fits = off.abs() <= REJECTION * hypotf(deviation, LEAST_NOISE);
    if !(fits || off.abs() < FURTHEST) {
        return None;
    }
    let of_mean = (length(mean) - 1.0).abs();
    let deviation_of_mean = sqrtf(form(noise, unit(mean))) / 3.0;
    let by_noise = off.abs() <= BY_NOISE * hypotf(deviation, LEAST_NOISE)
        && of_mean < BY_NOISE_OF_MEANS * hypotf(deviation_of_mean, LEAST_NOISE_OF_MEANS);
    let is_moved = (fits || by_noise) && off.abs() < BY_NOISE * deviation;
    let n = if is_moved {
        let along = apply(noise, direction);
        unit(add(v, -off / dot(along, direction).max(1e-12), along))
    } else {
        direction
    };
    let [.., z] = n;
    (z > 0.0).then_some(Normal { n, fits, misfit: if fits { 0.0 } else { misfit(v) } })
}

/// The covariance of the noise that is left when a raw normal near `n` was moved back to the unit sphere along its noise.
pub(super) fn left(noise: &Matrix, n: Vector) -> Matrix {
    let along = apply(noise, n);
    let scale = 1.0 / dot(along, n).max(1e-18);
    let mut left = *noise;
    for (row, a) in left.iter_mut().zip(along) {
        for (entry, b) in row.iter_mut().zip(along) {
            *entry -= scale * a * b;
        }
    }
    left
}

/// The angle in radians that the misfit of a rejected pixel stands for.
pub(super) fn misfit(v: Vector) -> f32 {
    MISFIT * (length(v) - 1.0).abs()
}
