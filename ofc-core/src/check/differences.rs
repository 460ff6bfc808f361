//! Differences between tilts.

use crate::light::tilt::Tilts;
use core::f64::consts::{PI, TAU};

/// `a` minus tilts, in (-pi, pi].
pub(super) fn minus(a: [f64; 3], tilts: Tilts) -> [f64; 3] {
    let mut differences = a;
    for (a, b) in differences.iter_mut().zip(tilts.tilts) {
        *a = turn(*a - b);
    }
    differences
}

/// The same angle in (-pi, pi], for differences of two such angles.
fn turn(angle: f64) -> f64 {
    if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    }
}
