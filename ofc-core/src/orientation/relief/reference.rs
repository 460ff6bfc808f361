//! The color of the untouched plane: a polynomial of each channel through the majority of the cells.
//!
//! The polynomial is of low order, because near lights fall off smoothly. It is fitted by least squares to the cells that do
//! not differ from it by more than four times the median distance in any channel, from order 0 upward, so that a relief that
//! covers nearly half of the picture does not bend it.

use super::grid::{Cell, Grid};
use crate::math::cholesky;
use crate::math::select::{kth_smallest, median_rank};
use libm::fabs;

/// The order of the polynomial.
pub const ORDER: usize = 4;

/// Its coefficients a channel.
pub const TERMS: usize = (ORDER + 1) * (ORDER + 2) / 2;

/// Rounds with each order: the cells that count follow from the fit before.
const ROUNDS: [usize; ORDER + 1] = [1, 2, 2, 2, 4];

/// Cells that differ by more medians than this are left out.
const REJECTION: f64 = 4.0;

/// At most about so many cells are fitted.
const MOST_CELLS: usize = 6000;

/// Rows of coefficients of the terms that `terms` lists, in pixel values: one row a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Polynomial {
    /// Red, green, blue.
    pub coefficients: [[f64; TERMS]; 3],
}

impl Polynomial {
    /// The color at a place in [-1, 1] across and down the picture.
    #[must_use]
    pub fn at(&self, place: [f64; 2]) -> [f64; 3] {
        let terms = terms(place);
        self.coefficients.each_ref().map(|row| cholesky::dot(row, &terms))
    }

    /// Each channel along the row at this height in [-1, 1].
    pub(crate) fn along(&self, y: f64) -> [Along; 3] {
        self.coefficients.each_ref().map(|row| Along::of(row, y))
    }
}

/// A channel along a row: the coefficients of the powers of x.
#[derive(Clone, Copy)]
pub(crate) struct Along([f64; ORDER + 1]);

impl Along {
    /// Of a channel with these coefficients, at this height in [-1, 1].
    pub fn of(coefficients: &[f64], y: f64) -> Self {
        let mut along = [0.0; ORDER + 1];
        let mut coefficients = coefficients.iter();
        for order in 0..=ORDER {
            // Of order n: x^n, x^(n - 1) y, ... y^n.
            let mut power = 1.0;
            let powers = along.iter_mut().take(order + 1).rev();
            for (sum, coefficient) in powers.zip(&mut coefficients) {
                *sum += coefficient * power;
                power *= y;
            }
        }
        Self(along)
    }

    /// In single precision.
    pub fn singles(&self) -> [f32; ORDER + 1] {
        self.0.map(|coefficient| coefficient as f32)
    }

    /// The color at x in [-1, 1].
    pub fn at(&self, x: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
    }
}

/// The products of powers of x and y, by ascending order.
fn terms([x, y]: [f64; 2]) -> [f64; TERMS] {
    let mut terms = [1.0; TERMS];
    let (mut i, mut before) = (1, 0);
    for order in 1..=ORDER {
        // Of order n: x times all of order n - 1, and y^n.
        for j in 0..=order {
            let (factor, from) = if j < order { (x, before + j) } else { (y, before + order - 1) };
            let value = terms.get(from).map_or(0.0, |term| factor * term);
            terms.iter_mut().skip(i).take(1).for_each(|term| *term = value);
            i += 1;
        }
        before = i - order - 1;
    }
    terms
}

/// The polynomial through the majority of the known cells; `None` where too few are known.
///
/// # Scratch
/// One `f32` a cell.
pub(super) fn fit(
    grid: &Grid,
    planes: &[&mut [f32]; 3],
    states: &[u32],
    scratch: &mut [f32],
) -> Option<Polynomial> {
    let is_known = |cell: &usize| states.get(*cell) == Some(&(Cell::Known as u32));
    let step = grid.step(MOST_CELLS);
    let cells = || {
        let rows = (0..grid.height).step_by(step.get());
        let all = rows.flat_map(|y| (0..grid.width).step_by(step.get()).map(move |x| y * grid.width + x));
        all.filter(is_known)
    };
    let color = |cell: usize| {
        [0, 1, 2].map(|k| planes.get(k).and_then(|plane| plane.get(cell)).map_or(0.0, |&c| f64::from(c)))
    };
    let (mut polynomial, mut limits) = (Polynomial::default(), [f64::INFINITY; 3]);
    for (order, &rounds) in ROUNDS.iter().enumerate() {
        let used = (order + 1) * (order + 2) / 2;
        for _ in 0..rounds {
            let (mut normal, mut sides) = ([[0.0; TERMS]; TERMS], [[0.0; TERMS]; 3]);
            for cell in cells() {
                let (place, color) = (grid.middle(cell), color(cell));
                let fitted = polynomial.at(place);
                let close = color
                    .iter()
                    .zip(fitted)
                    .zip(limits)
                    .all(|((value, fitted), limit)| fabs(value - fitted) <= limit);
                if !close {
                    continue;
                }
                let terms = terms(place);
                for (column, factor) in normal.iter_mut().zip(&terms) {
                    for (entry, term) in column.iter_mut().zip(&terms) {
                        *entry += factor * term;
                    }
                }
                for (side, value) in sides.iter_mut().zip(color) {
                    for (entry, term) in side.iter_mut().zip(&terms) {
                        *entry += value * term;
                    }
                }
            }
            restrict(&mut normal, &mut sides, used);
            cholesky::factor(&mut normal)?;
            for side in &mut sides {
                cholesky::solve(&normal, side);
            }
            polynomial.coefficients = sides;
            for (channel, limit) in limits.iter_mut().enumerate() {
                let mut count = 0;
                for (cell, slot) in cells().zip(scratch.iter_mut()) {
                    let (value, fitted) = (color(cell), polynomial.at(grid.middle(cell)));
                    let distance = value
                        .iter()
                        .zip(fitted)
                        .skip(channel)
                        .map(|(value, fitted)| fabs(value - fitted))
                        .next();
                    *slot = distance.unwrap_or(0.0) as f32;
                    count += 1;
                }
                let median = kth_smallest(scratch.get(..count)?, median_rank(count))?;
                *limit = (REJECTION * f64::from(median)).max(f64::MIN_POSITIVE);
            }
        }
    }
    Some(polynomial)
}

/// Makes every coefficient from `used` on zero.
fn restrict(normal: &mut [[f64; TERMS]; TERMS], sides: &mut [[f64; TERMS]; 3], used: usize) {
    for (i, column) in normal.iter_mut().enumerate() {
        for (j, entry) in column.iter_mut().enumerate() {
            if i >= used || j >= used {
                *entry = if i == j { 1.0 } else { 0.0 };
            }
        }
    }
    for side in sides {
        side.iter_mut().skip(used).for_each(|entry| *entry = 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_all_products_up_to_the_order() {
        let (x, y) = (0.7_f64, -0.4_f64);
        let mut expected = std::vec::Vec::new();
        for order in 0..=ORDER as i32 {
            for j in 0..=order {
                expected.push(x.powi(order - j) * y.powi(j));
            }
        }
        let found = terms([x, y]);
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?} {expected:?}");
        assert_eq!(expected.len(), TERMS);
    }
    #[test]
    fn along_a_row_a_polynomial_is_what_it_is_at_each_place() {
        let coefficients = [0, 1, 2].map(|k| core::array::from_fn(|i| ((k * 31 + i * 7) % 13) as f64 - 6.0));
        let polynomial = Polynomial { coefficients };
        for y in [-0.9, 0.1, 0.8] {
            let along = polynomial.along(y);
            for x in [-1.0, -0.3, 0.6] {
                for (along, value) in along.iter().zip(polynomial.at([x, y])) {
                    assert!((along.at(x) - value).abs() < 1e-13);
                }
            }
        }
    }
}
