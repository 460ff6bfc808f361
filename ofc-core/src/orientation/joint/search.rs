//! Minima over rotations.

use super::constants::{
    APART, EVALUATIONS, FOLLOWED, START_DIRECTION, START_SHEAR, START_TIP, START_TURN, STARTS, STEP,
};
use crate::math::mat3::{self, Mat3};
use crate::orientation::orthogonal::polish::{polish, rotation};
use libm::acos;

/// The best minimum, and how much higher the next one is that lies elsewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Minimum {
    pub rows: Mat3,
    pub second: f64,
}

/// A frame about the line of sight and tipped from it.
#[inline(never)]
fn start(i: usize) -> Mat3 {
    let (turn, rest) = ((i % 5) as f64, i / 5);
    let (tip, toward) = ((rest % 3) as f64, (rest / 3) as f64);
    let about = rotation([0.0, 0.0, START_TURN * turn]);
    let tipped = rotation([START_TIP * tip, 0.0, 0.0]);
    let direction = rotation([0.0, 0.0, START_DIRECTION * toward + START_SHEAR * tip]);
    mat3::multiply(&mat3::multiply(&about, &tipped), &direction)
}

/// The least cost that the most promising starts lead to, the two given ones among them.
#[inline(never)]
pub(super) fn minimum(own: [&Mat3; 2], cost: impl Fn(&Mat3) -> f64) -> Minimum {
    let mut promising = [(f64::INFINITY, mat3::IDENTITY); FOLLOWED];
    for i in 0..STARTS {
        let start = own.get(i).map_or_else(|| start(i), |own| **own);
        let mut entry = (cost(&start), start);
        for slot in &mut promising {
            if entry.0 < slot.0 {
                core::mem::swap(slot, &mut entry);
            }
        }
    }
    let mut best = (f64::INFINITY, mat3::IDENTITY);
    for found in &mut promising {
        let (from, start) = *found;
        let (rows, _) = polish(start, from, EVALUATIONS, &cost);
        *found = (cost(&rows), rows);
        if found.0 < best.0 {
            best = *found;
        }
    }
    let elsewhere =
        promising.iter().filter(|(_, rows)| angle(rows, &best.1) > APART).map(|(value, _)| value - best.0);
    Minimum { rows: best.1, second: elsewhere.fold(f64::INFINITY, f64::min) }
}

/// The angle between two frames; twins, whose first rows have the other sign, are the same.
fn angle(a: &Mat3, b: &Mat3) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|i| {
        let row = |m: &Mat3| m.get(i).copied().unwrap_or_default();
        mat3::dot(row(a), row(b))
    });
    let trace = (z + x + y).max(z - x - y);
    acos((0.5 * (trace - 1.0)).clamp(-1.0, 1.0))
}

/// The rotation vector, in the frame of the rows, that leads from `a` to `b` or its twin, as far as it is small.
pub(super) fn turn(a: &Mat3, b: &Mat3) -> [f64; 3] {
    let [a1, a2, a3] = *a;
    let [b1, b2, b3] = *b;
    let sign = if mat3::dot(a1, b1) + mat3::dot(a2, b2) < 0.0 { -1.0 } else { 1.0 };
    let [x, y, z] = [
        mat3::dot(a2, b3) - sign * mat3::dot(a3, b2),
        sign * mat3::dot(a3, b1) - mat3::dot(a1, b3),
        sign * (mat3::dot(a1, b2) - mat3::dot(a2, b1)),
    ];
    mat3::scale([x, y, z], 0.5)
}

/// Second derivatives over small rotations in the frame of the rows: rows -> (1 + [w]) rows.
pub(super) fn hessian(rows: &Mat3, cost: impl Fn(&Mat3) -> f64) -> Mat3 {
    derivatives(rows, cost).1
}

/// First and second derivatives.
#[inline(never)]
pub(super) fn derivatives(rows: &Mat3, cost: impl Fn(&Mat3) -> f64) -> ([f64; 3], Mat3) {
    let at = |turn: [f64; 3]| cost(&mat3::multiply(&rotation(turn), rows));
    let here = cost(rows);
    let axes = [[STEP, 0.0, 0.0], [0.0, STEP, 0.0], [0.0, 0.0, STEP]];
    let plus = axes.map(at);
    let minus = axes.map(|axis| at(mat3::scale(axis, -1.0)));
    let [p1, p2, p3] = plus;
    let [m1, m2, m3] = minus;
    let p12 = at([STEP, STEP, 0.0]) - p1 - p2 + here;
    let p13 = at([STEP, 0.0, STEP]) - p1 - p3 + here;
    let p23 = at([0.0, STEP, STEP]) - p2 - p3 + here;
    let own = |p: f64, m: f64| p + m - 2.0 * here;
    let second = [[own(p1, m1), p12, p13], [p12, own(p2, m2), p23], [p13, p23, own(p3, m3)]];
    let gradient = [p1 - m1, p2 - m2, p3 - m3].map(|difference| difference / (2.0 * STEP));
    (gradient, second.map(|row| row.map(|entry| entry / (STEP * STEP))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn twin([r1, r2, r3]: Mat3) -> Mat3 {
        [mat3::scale(r1, -1.0), mat3::scale(r2, -1.0), r3]
    }

    fn turned(by: [f64; 3], rows: &Mat3) -> Mat3 {
        mat3::multiply(&rotation(by), rows)
    }

    const ROWS: Mat3 = [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]];

    #[test]
    fn a_small_turn_is_found_to_either_twin() {
        let by = [0.01, -0.02, 0.015];
        for other in [turned(by, &ROWS), twin(turned(by, &ROWS))] {
            let found = turn(&ROWS, &other);
            for (found, wanted) in found.into_iter().zip(by) {
                assert!((found - wanted).abs() < 1e-5, "{found:?}");
            }
            assert!((angle(&ROWS, &other) - 0.026_925_8).abs() < 1e-6);
        }
        assert!((angle(&ROWS, &turned([0.0, 2.0, 0.0], &ROWS)) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn derivatives_are_those_of_the_cost() {
        let (slope, curvature) = ([0.3, -0.5, 0.2], [[2.0, 0.4, -0.3], [0.4, 3.0, 0.7], [-0.3, 0.7, 1.5]]);
        let cost = |rows: &Mat3| {
            let w = turn(&ROWS, rows);
            mat3::dot(slope, w) + 0.5 * mat3::dot(w, mat3::apply(&curvature, w))
        };
        let (gradient, second) = derivatives(&ROWS, cost);
        assert_eq!(second, hessian(&ROWS, cost));
        for (found, wanted) in gradient.into_iter().zip(slope) {
            assert!((found - wanted).abs() < 1e-5, "{gradient:?}");
        }
        for (found, wanted) in second.as_flattened().iter().zip(curvature.as_flattened()) {
            assert!((found - wanted).abs() < 0.01, "{second:?}");
        }
    }

    #[test]
    fn the_least_of_several_minima_is_found_and_how_far_above_it_the_next_is() {
        // One minimum among the starts' turns, and one a third of a turn away that is 0.25 higher.
        let (best, next) = (turned([0.3, 0.9, -0.4], &ROWS), turned([0.0, 0.0, 2.1], &ROWS));
        let cost = |rows: &Mat3| {
            let near = |other: &Mat3, depth: f64| {
                let off = angle(other, rows);
                depth + off * off
            };
            near(&best, 0.0).min(near(&next, 0.25))
        };
        let found = minimum([&mat3::IDENTITY; 2], cost);
        assert!(angle(&found.rows, &best) < 1e-4, "{}", angle(&found.rows, &best));
        assert!((found.second - 0.25).abs() < 1e-4, "{}", found.second);
        // A minimum that is alone has no second.
        let alone = minimum([&mat3::IDENTITY; 2], |rows| angle(&best, rows));
        assert!(alone.second > 1e300 && angle(&alone.rows, &best) < 1e-3);
    }
}
