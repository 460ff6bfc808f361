//! Boxes of slants, and what eqs. 24 leave of one.
//!
//! The bound on second derivatives is loose for tilts nearly equal or opposite (k near 1 or -1): then an equation hardly
//! depends on the sum, or the difference, of its slants. Boxes whose sides are such sums and differences make it sharp.

use super::{Constraints, difference, max_abs, sum};
use crate::math::mat3::{self, Mat3};
use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// A residual up to this is a zero: curves that touch within it have a (double) root.
pub(super) const ZERO: f64 = 4e-12;
/// A solution this far outside [0, pi/2] is one at its end, radians.
pub(super) const OVERHANG: f64 = 1e-9;
/// |k| from which two tilts count as nearly equal or opposite.
const SHEARED: f64 = 0.8;

#[derive(Clone, Copy)]
pub(super) struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    pub(super) const fn between(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    pub(super) const fn ends(self) -> [f64; 2] {
        [self.low, self.high]
    }

    pub(super) fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }

    fn half_width(self) -> f64 {
        0.5 * (self.high - self.low)
    }
}

/// A box, in the coordinates of a [`Frame`].
pub(super) type Cell = [Interval; 3];

pub(super) fn half_width(cell: Cell) -> f64 {
    max_abs(cell.map(Interval::half_width))
}

/// Halves the box across its widest side.
pub(super) fn halves(cell: Cell) -> (Cell, Cell) {
    let (mut low, mut high) = (cell, cell);
    let widest = half_width(cell);
    for (low, high) in low.iter_mut().zip(&mut high) {
        if low.half_width() >= widest {
            let middle = low.middle();
            low.high = middle;
            high.low = middle;
            break;
        }
    }
    (low, high)
}

/// Coordinates v in which boxes are cut: slants = axes v.
///
/// One slant is a coordinate itself, the one that takes part in the two pairs with the largest |k|. Each of the others
/// has as its coordinate its difference from that one where k is near 1, their sum where it is near -1, itself between.
pub(super) struct Frame<'a> {
    constraints: &'a Constraints,
    pub(super) axes: Mat3,
}

impl<'a> Frame<'a> {
    pub(super) fn new(constraints: &'a Constraints) -> Self {
        let [k12, k13, k23] = constraints.k;
        let slope = |k: f64| if k.abs() < SHEARED { 0.0 } else { k.signum() };
        let mut axes = mat3::IDENTITY;
        if k23.abs() <= k12.abs().min(k13.abs()) {
            axes[1][0] = slope(k12);
            axes[2][0] = slope(k13);
        } else if k13.abs() <= k12.abs() {
            axes[0][1] = slope(k12);
            axes[2][1] = slope(k23);
        } else {
            axes[0][2] = slope(k13);
            axes[1][2] = slope(k23);
        }
        Self { constraints, axes }
    }

    /// The box that holds all slants in [0, pi/2].
    pub(super) fn everything(&self) -> Cell {
        self.axes.map(|row| {
            // 1 on the diagonal; beside it -1, 0 or 1, with the opposite sign in the inverse.
            let sum = row.iter().sum::<f64>();
            let (below, above) = (if sum > 1.0 { 1.0 } else { 0.0 }, if sum < 1.0 { 2.0 } else { 1.0 });
            Interval { low: -below * FRAC_PI_2 - 2.0 * OVERHANG, high: above * FRAC_PI_2 + 2.0 * OVERHANG }
        })
    }

    /// The part of a box outside which it holds no solution, `None` when that is all of it.
    pub(super) fn narrow(&self, cell: Cell) -> Option<Cell> {
        let (middle, r) = (cell.map(Interval::middle), cell.map(Interval::half_width));
        let reach = |row: [f64; 3]| mat3::dot(row.map(f64::abs), r);
        let slants = mat3::apply(&self.axes, middle);
        let outside =
            |(slant, row): (&f64, &[f64; 3])| (slant - FRAC_PI_4).abs() > FRAC_PI_4 + OVERHANG + reach(*row);
        if slants.iter().zip(&self.axes).any(outside) {
            return None;
        }
        let (f, jacobian) = self.constraints.evaluate(slants);
        let jacobian = mat3::multiply(&jacobian, &self.axes);
        // f = (1 + k)/2 cos(s_i - s_j) + (1 - k)/2 cos(s_i + s_j) - h, and the second derivatives of a cosine are at
        // most 1.
        let rest = |a: [f64; 3], b: [f64; 3], k: f64| {
            let (minus, plus) = (reach(difference(a, b)), reach(sum(a, b)));
            0.25 * ((1.0 + k) * minus * minus + (1.0 - k) * plus * plus) + ZERO
        };
        let ([one, two, three], [k12, k13, k23]) = (self.axes, self.constraints.k);
        let rest = [rest(one, two, k12), rest(one, three, k13), rest(two, three, k23)];
        for ((value, row), rest) in f.iter().zip(&jacobian).zip(rest) {
            if value.abs() > reach(*row) + rest {
                return None;
            }
        }
        // Singular derivatives do not say where in the box a solution can be.
        let Some(inverse) = mat3::inverse(&jacobian) else { return Some(cell) };
        let mut narrowed = cell;
        for ((side, row), middle) in narrowed.iter_mut().zip(inverse).zip(middle) {
            let newton = middle - mat3::dot(row, f);
            let spread = mat3::dot(row.map(f64::abs), rest);
            // With nearly singular ones these may not be numbers, and max and min leave the side as it is.
            side.low = side.low.max(newton - spread);
            side.high = side.high.min(newton + spread);
            if side.low > side.high {
                return None;
            }
        }
        Some(narrowed)
    }
}
