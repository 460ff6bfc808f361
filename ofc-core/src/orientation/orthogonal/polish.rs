//! A bounded local search among rotations of a frame: Newton steps from differences, for as long as the value falls.

use crate::math::angle::sincos;
use crate::math::mat3::{self, IDENTITY, Mat3};
use libm::sqrt;

/// Values of the objective that one round needs: six along the axes, three for the mixed derivatives, one at the end.
const ROUND: u32 = 10;
/// Where the differences begin, and where the search ends, in radians.
const FIRST_STEP: f64 = 0.02;
const LAST_STEP: f64 = 1e-6;
/// A Newton step is never longer than this many steps of the differences.
const TRUST: f64 = 8.0;

/// The frame near `start`, whose objective is `value`, at which `objective` is smallest, and how often it was computed:
/// at most `evaluations` times.
pub(crate) fn polish(
    start: Mat3,
    value: f64,
    evaluations: u32,
    mut objective: impl FnMut(&Mat3) -> f64,
) -> (Mat3, u32) {
    let (mut best, mut least) = (start, value);
    let (mut used, mut h) = (0, FIRST_STEP);
    while used + ROUND <= evaluations && h > LAST_STEP {
        let center = best;
        let here = least;
        let mut at = |turn: [f64; 3]| {
            let rows = mat3::multiply(&center, &rotation(turn));
            let value = objective(&rows);
            if value < least {
                (best, least) = (rows, value);
            }
            value
        };
        let plus = [at([h, 0.0, 0.0]), at([0.0, h, 0.0]), at([0.0, 0.0, h])];
        let minus = [at([-h, 0.0, 0.0]), at([0.0, -h, 0.0]), at([0.0, 0.0, -h])];
        let mixed = [at([h, h, 0.0]), at([h, 0.0, h]), at([0.0, h, h])];
        let step = newton(here, plus, mixed, minus, h);
        let length = sqrt(mat3::dot(step, step));
        let before = mixed.iter().chain(&plus).chain(&minus).fold(here, |least, &value| value.min(least));
        let reached = if length > 0.0 { at(step) } else { f64::INFINITY };
        used += ROUND;
        if reached < before {
            h = (2.0 * length).max(h / 16.0).min(h);
        } else if before >= here {
            h *= 0.25;
        }
    }
    (best, used)
}

/// The step to the minimum of the parabola through the values, no longer than the trust radius; zero where it has none.
fn newton(here: f64, plus: [f64; 3], mixed: [f64; 3], minus: [f64; 3], h: f64) -> [f64; 3] {
    let ([p1, p2, p3], [m1, m2, m3], [p12, p13, p23]) = (plus, minus, mixed);
    let gradient = [0.5 * (p1 - m1), 0.5 * (p2 - m2), 0.5 * (p3 - m3)];
    let [d1, d2, d3] = [p1 + m1 - 2.0 * here, p2 + m2 - 2.0 * here, p3 + m3 - 2.0 * here];
    let (d12, d13, d23) = (p12 - p1 - p2 + here, p13 - p1 - p3 + here, p23 - p2 - p3 + here);
    let eigen = mat3::symmetric_eigen(&[[d1, d12, d13], [d12, d2, d23], [d13, d23, d3]]);
    let [largest, ..] = eigen.values;
    let mut step = [0.0; 3];
    if !(largest > 0.0 && largest.is_finite()) {
        return step;
    }
    for (value, vector) in eigen.values.iter().zip(eigen.vectors) {
        // A direction that curves the wrong way, or not at all, is followed downhill no further than trust allows.
        let curvature = value.abs().max(1e-9 * largest);
        let along = -h * mat3::dot(vector, gradient) / curvature;
        for (component, direction) in step.iter_mut().zip(vector) {
            *component += along * direction;
        }
    }
    let length = sqrt(mat3::dot(step, step));
    if !length.is_finite() {
        return [0.0; 3];
    }
    mat3::scale(step, if length > TRUST * h { TRUST * h / length } else { 1.0 })
}

/// The rotation by |turn| about `turn` (Rodrigues).
pub(crate) fn rotation(turn: [f64; 3]) -> Mat3 {
    let angle = sqrt(mat3::dot(turn, turn));
    if angle == 0.0 {
        return IDENTITY;
    }
    let [x, y, z] = mat3::scale(turn, 1.0 / angle);
    let (s, c) = sincos(angle);
    let k = 1.0 - c;
    [
        [c + k * x * x, k * x * y - s * z, k * x * z + s * y],
        [k * x * y + s * z, c + k * y * y, k * y * z - s * x],
        [k * x * z - s * y, k * y * z + s * x, c + k * z * z],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_finds_the_frame_that_it_is_measured_against() {
        let truth = rotation([0.3, -0.2, 0.4]);
        let mut calls = 0;
        let distance = |rows: &Mat3| {
            let difference =
                rows.iter().flatten().zip(truth.iter().flatten()).map(|(a, b)| (a - b) * (a - b));
            difference.sum::<f64>()
        };
        let (found, used) = polish(IDENTITY, distance(&IDENTITY), 200, |rows| {
            calls += 1;
            distance(rows)
        });
        assert!(distance(&found) < 1e-12, "{}", distance(&found));
        assert!(calls <= used && used <= 200);
    }

    #[test]
    fn no_budget_no_move() {
        assert_eq!(polish(IDENTITY, 1.0, 9, |_| 0.0), (IDENTITY, 0));
        let (rows, _) = polish(IDENTITY, 1.0, 100, |_| f64::NAN);
        assert_eq!(rows, IDENTITY);
    }
}
