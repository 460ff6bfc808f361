//! Slants from tilts: the constrained slant estimator.
//!
//! Each channel's equivalent light is a unit vector e = (sin s cos t, sin s sin t, cos s) of known tilt t. The angles
//! between the three are known as well, so the three slants s solve three equations,
//!
//! ```text
//! k_ij sin s_i sin s_j + cos s_i cos s_j = h_ij,   k_ij = cos(t_i - t_j),   ij = 12, 13, 23.            (24)
//! ```
//!
//! [`roots()`] finds every solution with slants in [0, pi/2], [`least_squares()`] the slants that come closest when there
//! is none, and [`curve()`] is what the paper's Figures 2 and 4(a) plot: eqs. 25, each of which has two signs. How their eight
//! cases are numbered says [`SlantRoot::branch`], with a table in `branch.rs`. Pairs of channels are in the order 12, 13, 23
//! everywhere.
//!
//! There are at most four isolated solutions: as equations in tan(s/2), (24) has sixteen complex solutions, and of the
//! four that s -> -s and s -> s + pi make of each other at most one lies inside the range of slants.
//!
//! # Reference
//! Sections 3.2-3.3, eqs. 24-25.

mod branch;
mod cell;
mod curve;
mod descent;
mod least_squares;
mod roots;
mod subdivision;
mod work_list;

pub use curve::{CurvePoint, curve};
pub use least_squares::{NearestSlants, least_squares, without_roots};
pub use roots::{roots, roots_within};
pub use work_list::WORKSPACE_LEN;

use crate::math::angle::sincos;
use crate::math::mat3::{self, Mat3};
use core::f64::consts::FRAC_PI_2;

/// Room for solutions: twice as many as there can be isolated ones.
pub const MAX_CANDIDATES: usize = 8;

/// One simultaneous solution of eqs. 24.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlantRoot {
    /// The slants of the three channels, in [0, pi/2], radians.
    pub slants: [f64; 3],
    /// Which of the eight cases of eqs. 25 this is, by the signs that the square roots of 25a, 25b and 25c have here:
    /// 1 is (+,+,+), 2 (+,+,-), 3 (+,-,+), 4 (+,-,-), 5 (-,+,+), 6 (-,+,-), 7 (-,-,+) and 8 (-,-,-). A sign is + where
    /// the square root is zero, since both are right there.
    pub branch: u8,
    /// The largest absolute difference between the two sides of eqs. 24.
    pub residual: f64,
}

/// The solutions, ascending by the first slant.
pub type Candidates = heapless::Vec<SlantRoot, MAX_CANDIDATES>;

/// A cosine beyond this is not one, whatever the noise.
const LARGEST_COSINE: f64 = 2.0;

/// Eqs. 24 for given tilts and angles.
#[derive(Clone, Copy, Debug)]
struct Constraints {
    /// (k12, k13, k23)
    k: [f64; 3],
    /// (h12, h13, h23)
    h: [f64; 3],
}

impl Constraints {
    /// `None` for numbers that are not finite, or no cosines.
    fn new([t1, t2, t3]: [f64; 3], cosines: [f64; 3]) -> Option<Self> {
        let differences = [t1 - t2, t1 - t3, t2 - t3];
        // Finite tilts of opposite sign may still differ by infinity.
        let meaningful =
            differences.iter().all(|d| d.is_finite()) && cosines.iter().all(|h| h.abs() <= LARGEST_COSINE);
        meaningful.then(|| Self { k: differences.map(|d| sincos(d).1), h: cosines })
    }

    /// Left side minus right side of eqs. 24, and the derivatives by the slants.
    fn evaluate(&self, slants: [f64; 3]) -> ([f64; 3], Mat3) {
        let ([k12, k13, k23], [h12, h13, h23]) = (self.k, self.h);
        let [one, two, three] = slants.map(sincos);
        let (f12, [a12, b12]) = pair(k12, one, two);
        let (f13, [a13, b13]) = pair(k13, one, three);
        let (f23, [a23, b23]) = pair(k23, two, three);
        let jacobian = [[a12, b12, 0.0], [a13, 0.0, b13], [0.0, a23, b23]];
        ([f12 - h12, f13 - h13, f23 - h23], jacobian)
    }

    /// The largest residual.
    fn residual(&self, slants: [f64; 3]) -> f64 {
        max_abs(self.evaluate(slants).0)
    }
}

/// The cosine of the angle between two lights, and its derivatives by the two slants.
fn pair(k: f64, (sin_a, cos_a): (f64, f64), (sin_b, cos_b): (f64, f64)) -> (f64, [f64; 2]) {
    let derivatives = [k * cos_a * sin_b - sin_a * cos_b, k * sin_a * cos_b - cos_a * sin_b];
    (k * sin_a * sin_b + cos_a * cos_b, derivatives)
}

/// The root mean square of the differences between the two sides of eqs. 24; infinite for input that is not finite.
#[must_use]
pub fn residual_rms(tilts: [f64; 3], cosines: [f64; 3], slants: [f64; 3]) -> f64 {
    Constraints::new(tilts, cosines).map_or(f64::INFINITY, |constraints| {
        let (residuals, _) = constraints.evaluate(slants);
        libm::sqrt(mat3::dot(residuals, residuals) / 3.0)
    })
}

fn max_abs(v: [f64; 3]) -> f64 {
    v.iter().fold(0.0, |largest, component| component.abs().max(largest))
}

fn difference([a1, a2, a3]: [f64; 3], [b1, b2, b3]: [f64; 3]) -> [f64; 3] {
    [a1 - b1, a2 - b2, a3 - b3]
}

fn sum([a1, a2, a3]: [f64; 3], [b1, b2, b3]: [f64; 3]) -> [f64; 3] {
    [a1 + b1, a2 + b2, a3 + b3]
}

/// The nearest slants in the range that slants can have.
fn clamp(slants: [f64; 3]) -> [f64; 3] {
    slants.map(|slant| slant.clamp(0.0, FRAC_PI_2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    /// Random slants and tilts, and the cosines that belong to them.
    pub(super) fn random_case(rng: &mut Rng) -> ([f64; 3], [f64; 3], [f64; 3]) {
        let slants = [rng.unit(), rng.unit(), rng.unit()].map(|unit| unit * FRAC_PI_2);
        let tilts = [rng.unit(), rng.unit(), rng.unit()].map(|unit| unit * core::f64::consts::TAU);
        (slants, tilts, cosines_of(slants, tilts))
    }

    /// (h12, h13, h23) from vectors, not from eq. 24.
    pub(super) fn cosines_of(slants: [f64; 3], tilts: [f64; 3]) -> [f64; 3] {
        let e = [0, 1, 2].map(|i| {
            let (s, c) = sincos(slants[i]);
            let (st, ct) = sincos(tilts[i]);
            [s * ct, s * st, c]
        });
        [mat3::dot(e[0], e[1]), mat3::dot(e[0], e[2]), mat3::dot(e[1], e[2])]
    }

    #[test]
    fn residuals_vanish_at_the_truth_and_derivatives_are_differences() {
        let mut rng = Rng::new(1);
        for _ in 0..100 {
            let (slants, tilts, cosines) = random_case(&mut rng);
            let constraints = Constraints::new(tilts, cosines).unwrap();
            assert!(constraints.residual(slants) < 1e-14);
            let (_, jacobian) = constraints.evaluate(slants);
            for column in 0..3 {
                let (mut above, mut below) = (slants, slants);
                above[column] += 1e-6;
                below[column] -= 1e-6;
                let (above, below) = (constraints.evaluate(above).0, constraints.evaluate(below).0);
                for row in 0..3 {
                    let difference = (above[row] - below[row]) / 2e-6;
                    assert!((jacobian[row][column] - difference).abs() < 1e-9);
                }
            }
        }
    }
}
