//! Frames that searches start from, and the minimum of a cost that is cheap.

use super::constants::{EVALUATIONS, FOLLOWED, START_DIRECTION, START_SHEAR, START_TIP, START_TURN, STARTS};
use crate::math::mat3::{self, Mat3};
use crate::orientation::orthogonal::polish::{polish, rotation};
use libm::acos;

/// A frame about the line of sight and tipped from it.
#[inline(never)]
pub(super) fn start(i: usize) -> Mat3 {
    let (turn, rest) = ((i % 5) as f64, i / 5);
    let (tip, toward) = ((rest % 3) as f64, (rest / 3) as f64);
    let about = rotation([0.0, 0.0, START_TURN * turn]);
    let tipped = rotation([START_TIP * tip, 0.0, 0.0]);
    let direction = rotation([0.0, 0.0, START_DIRECTION * toward + START_SHEAR * tip]);
    mat3::multiply(&mat3::multiply(&about, &tipped), &direction)
}

/// Where the cost is least, as far as the most promising starts lead there.
#[inline(never)]
pub(super) fn minimum(cost: impl Fn(&Mat3) -> f64) -> Mat3 {
    let mut promising = [(f64::INFINITY, mat3::IDENTITY); FOLLOWED];
    for i in 0..STARTS {
        let start = start(i);
        let mut entry = (cost(&start), start);
        for slot in &mut promising {
            if entry.0 < slot.0 {
                core::mem::swap(slot, &mut entry);
            }
        }
    }
    let mut best = (f64::INFINITY, mat3::IDENTITY);
    for (from, start) in promising {
        let (rows, _) = polish(start, from, EVALUATIONS, &cost);
        let found = cost(&rows);
        if found < best.0 {
            best = (found, rows);
        }
    }
    best.1
}

/// The angle between two frames; twins, whose first rows have the other sign, are the same.
pub(super) fn angle(a: &Mat3, b: &Mat3) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|i| {
        let row = |m: &Mat3| m.get(i).copied().unwrap_or_default();
        mat3::dot(row(a), row(b))
    });
    let trace = (z + x + y).max(z - x - y);
    acos((0.5 * (trace - 1.0)).clamp(-1.0, 1.0))
}
