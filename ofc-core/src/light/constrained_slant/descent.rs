//! Damped Newton descent to a minimum of the sum of the squared residuals of eqs. 24, with the slants kept in range.

use super::{Constraints, clamp};
use crate::math::angle::sincos;
use crate::math::mat3::{self, Mat3};
use core::f64::consts::FRAC_PI_2;

/// Steps of one descent.
const MAX_STEPS: usize = 100;
/// Damping at the start, its factor, and where a descent has nowhere to go.
const FIRST_DAMPING: f64 = 1e-3;
const DAMPING_FACTOR: f64 = 8.0;
const LARGEST_DAMPING: f64 = 1e9;
const SMALLEST_DAMPING: f64 = 1e-12;

/// Newton's method for the sum of squares, damped as by Levenberg and Marquardt, with the slants kept in range. (Without
/// the second derivatives of eqs. 24 it would hardly move where residuals stay large.)
pub(super) fn descend(constraints: &Constraints, start: [f64; 3]) -> [f64; 3] {
    let mut slants = start;
    let mut damping = FIRST_DAMPING;
    let (mut f, mut jacobian) = constraints.evaluate(slants);
    for _ in 0..MAX_STEPS {
        let gradient = mat3::apply(&mat3::transpose(&jacobian), f);
        let curvature = curvature(constraints, slants, f, &jacobian);
        let candidate = step(slants, gradient, curvature, damping);
        let (candidate_f, candidate_jacobian) = constraints.evaluate(candidate);
        if mat3::dot(candidate_f, candidate_f) < mat3::dot(f, f) {
            (slants, f, jacobian) = (candidate, candidate_f, candidate_jacobian);
            damping = (damping / DAMPING_FACTOR).max(SMALLEST_DAMPING);
        } else {
            damping *= DAMPING_FACTOR;
            if damping > LARGEST_DAMPING {
                break;
            }
        }
    }
    slants
}

/// The second derivatives of half the sum of squares.
fn curvature(constraints: &Constraints, slants: [f64; 3], f: [f64; 3], jacobian: &Mat3) -> Mat3 {
    let [(sin1, cos1), (sin2, cos2), (sin3, cos3)] = slants.map(sincos);
    let ([f12, f13, f23], [k12, k13, k23], [h12, h13, h23]) = (f, constraints.k, constraints.h);
    let (p12, p13, p23) = (f12 * (f12 + h12), f13 * (f13 + h13), f23 * (f23 + h23));
    let q12 = f12 * (sin1 * sin2 + k12 * cos1 * cos2);
    let q13 = f13 * (sin1 * sin3 + k13 * cos1 * cos3);
    let q23 = f23 * (sin2 * sin3 + k23 * cos2 * cos3);
    let second = [[-p12 - p13, q12, q13], [q12, -p12 - p23, q23], [q13, q23, -p13 - p23]];
    let mut curvature = mat3::multiply(&mat3::transpose(jacobian), jacobian);
    for (entry, second) in curvature.iter_mut().flatten().zip(second.iter().flatten()) {
        *entry += second;
    }
    curvature
}

/// Where the damped Newton step leads; with a singular matrix it leads nowhere. A slant at its limit that the descent would
/// push beyond stays there and leaves the equations.
fn step(slants: [f64; 3], gradient: [f64; 3], curvature: Mat3, damping: f64) -> [f64; 3] {
    let (mut gradient, mut curvature) = (gradient, curvature);
    let mut is_free = [true; 3];
    for ((is_free, slope), slant) in is_free.iter_mut().zip(&mut gradient).zip(slants) {
        *is_free = !((slant <= 0.0 && *slope > 0.0) || (slant >= FRAC_PI_2 && *slope < 0.0));
        if !*is_free {
            *slope = 0.0;
        }
    }
    for (i, (row, row_is_free)) in curvature.iter_mut().zip(is_free).enumerate() {
        for (j, (entry, column_is_free)) in row.iter_mut().zip(is_free).enumerate() {
            if i == j {
                *entry += damping;
            } else if !(row_is_free && column_is_free) {
                *entry = 0.0;
            }
        }
    }
    let Some(inverse) = mat3::inverse(&curvature) else { return slants };
    let [d1, d2, d3] = mat3::apply(&inverse, gradient);
    let [s1, s2, s3] = slants;
    clamp([s1 - d1, s2 - d2, s3 - d3])
}
