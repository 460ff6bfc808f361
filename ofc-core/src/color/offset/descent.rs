//! The least sum of bounded squares of distances, by Levenberg's and Marquardt's steps.
//!
//! The valley is curved and nearly flat along the center, so steps must go down in the function itself: the derivatives are exact,
//! and the scale of the distances stays while a valley is followed.
//!
//! # Reference
//! D. W. Marquardt, "An algorithm for least-squares estimation of nonlinear parameters", J. SIAM 11, 1963. A. E. Beaton,
//! J. W. Tukey, "The fitting of power series", Technometrics 16, 1974, for the weights.

use super::center::Centered;
use crate::color::dispersion::CONSISTENCY;
use crate::color::ellipsoid::is_positive_definite;
use crate::math::{cholesky, select};
use libm::fabs;

/// Distances beyond so many deviations count as this one: 95 % efficient for the normal distribution.
const BOUND: f64 = 4.685;
/// The least deviation, of colors about 1.
const LEAST: f64 = 1e-7;
/// How often the deviation is found anew.
const SCALES: usize = 6;
/// Steps with one deviation.
const STEPS: usize = 60;
/// Trials of a step.
const TRIALS: usize = 14;
/// A step that gains less of the sum is the last with this deviation.
const GAIN: f64 = 1e-9;

/// Tukey's weight of a distance.
pub(super) fn weight(distance: f64, deviation: f64) -> f64 {
    let ratio = distance / (BOUND * deviation);
    let left = (1.0 - ratio * ratio).max(0.0);
    left * left
}

/// The robust deviation of the distances.
pub(super) fn scale_of(at: &Centered, colors: &[[f32; 4]], distances: &mut [f32]) -> f64 {
    let distances = distances.get_mut(..colors.len()).unwrap_or_default();
    for (slot, color) in distances.iter_mut().zip(colors) {
        *slot = fabs(at.distance(color)) as f32;
    }
    let median = select::kth_smallest(distances, select::median_rank(distances.len())).unwrap_or(0.0);
    (CONSISTENCY * f64::from(median)).max(LEAST)
}

/// The sum of bounded squares, a color.
fn sum(at: &Centered, colors: &[[f32; 4]], deviation: f64) -> f64 {
    let mut sum = 0.0;
    for color in colors {
        let ratio = at.distance(color) / (BOUND * deviation);
        let left = (1.0 - ratio * ratio).max(0.0);
        sum += 1.0 - left * left * left;
    }
    sum
}

/// Goes down from `start` by the first `N` numbers of C and the center.
pub(super) fn descend<const N: usize>(
    start: Centered,
    colors: &[[f32; 4]],
    distances: &mut [f32],
) -> Centered {
    let (mut at, mut damping) = (start, 1e-3);
    for _ in 0..SCALES {
        let deviation = scale_of(&at, colors, distances);
        let mut least = sum(&at, colors, deviation);
        let mut steps = 0;
        for _ in 0..STEPS {
            let Some((next, sum)) = step::<N>(&at, colors, deviation, least, &mut damping) else { break };
            let gain = least - sum;
            (at, least) = (next, sum);
            steps += 1;
            if gain <= GAIN * least {
                break;
            }
        }
        if steps <= 1 {
            break;
        }
    }
    at
}

/// One step that goes down, and where it leads.
fn step<const N: usize>(
    at: &Centered,
    colors: &[[f32; 4]],
    deviation: f64,
    least: f64,
    damping: &mut f64,
) -> Option<(Centered, f64)> {
    let (mut curvature, mut slope) = ([[0.0; N]; N], [0.0; N]);
    for color in colors {
        let (distance, gradient) = at.distance_and_gradient(color);
        let weight = weight(distance, deviation);
        for ((column, slope), a) in curvature.iter_mut().zip(&mut slope).zip(gradient) {
            *slope -= weight * distance * a;
            for (entry, b) in column.iter_mut().zip(gradient) {
                *entry += weight * a * b;
            }
        }
    }
    for _ in 0..TRIALS {
        let (mut damped, mut step) = (curvature, slope);
        for (i, column) in damped.iter_mut().enumerate() {
            if let Some(entry) = column.get_mut(i) {
                *entry *= 1.0 + *damping;
            }
        }
        if cholesky::factor(&mut damped).is_some() {
            cholesky::solve(&damped, &mut step);
            let next = at.moved(&step);
            if is_positive_definite(&next.form) {
                let sum = sum(&next, colors, deviation);
                if sum <= least {
                    *damping = (*damping * 0.1).max(1e-10);
                    return Some((next, sum));
                }
            }
        }
        *damping = (*damping * 10.0).min(1e8);
    }
    None
}
