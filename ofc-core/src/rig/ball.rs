//! Balls of known radius: slopes by regression.

use super::terms::{TERMS, terms};
use crate::orientation::relief::{Inner, Memory, Survey};

/// How many products of two terms there are.
pub const PACKED: usize = TERMS * (TERMS + 1) / 2;

/// How many products of a term and a slope there are.
pub const SIDES: usize = 2 * TERMS;

/// Cells that are at least this share of the largest distance away from the border of the contact lie on the ball.
const SHARE: f64 = 0.55;

/// A ball has at least so many cells.
const FEWEST: f64 = 30.0;

/// The slopes of a ball, as the frame itself gives them, miss at most this share of their variance from a constant curvature.
const LARGEST_MISS: f64 = 0.3;

/// A ball that is pressed in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its radius in pixels, positive.
    pub radius: f64,
    /// Its center in pixels, x to the right and y down from the middle of the top left pixel, where it is known.
    pub center: Option<[f64; 2]>,
}

impl Ball {
    /// Whether its numbers are in their ranges.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.radius.is_finite()
            && self.radius > 0.0
            && self.center.is_none_or(|center| center.iter().all(|along| along.is_finite()))
    }
}

/// Sums over balls.
#[derive(Clone, Copy, Debug)]
pub struct Balls<'b> {
    /// How many balls there are.
    pub count: u32,
    /// How many of them have a known center.
    pub centers: u32,
    /// Sums of the covariances of the terms, the lower triangle row by row.
    pub products: &'b [f64; PACKED],
    /// Sums of the covariances of the terms and both slopes.
    pub sides: &'b [f64; SIDES],
    /// Sum of the variances of both slopes.
    pub squares: f64,
}

impl Balls<'_> {
    /// Whether every number is finite.
    #[must_use]
    pub fn are_valid(&self) -> bool {
        let mut numbers = self.products.iter().chain(self.sides).chain([&self.squares]);
        numbers.all(|number| number.is_finite())
    }

    /// The product of two terms, averaged over the balls.
    pub(super) fn product(&self, i: usize, j: usize) -> f64 {
        let (i, j) = if i < j { (j, i) } else { (i, j) };
        self.products.get(i * (i + 1) / 2 + j).map_or(0.0, |sum| sum / f64::from(self.count.max(1)))
    }

    /// The product of a term and a slope, averaged over the balls.
    pub(super) fn side(&self, component: usize, i: usize) -> f64 {
        self.sides.get(component * TERMS + i).map_or(0.0, |sum| sum / f64::from(self.count.max(1)))
    }
}

/// Sums over balls that grow, in the caller's memory.
#[derive(Debug)]
pub struct BallsMut<'b> {
    /// As in [`Balls`].
    pub count: &'b mut u32,
    /// As in [`Balls`].
    pub centers: &'b mut u32,
    /// As in [`Balls`].
    pub products: &'b mut [f64; PACKED],
    /// As in [`Balls`].
    pub sides: &'b mut [f64; SIDES],
    /// As in [`Balls`].
    pub squares: &'b mut f64,
}

impl BallsMut<'_> {
    /// The sums as they are.
    #[must_use]
    pub const fn get(&self) -> Balls<'_> {
        let Self { count, centers, products, sides, squares } = self;
        Balls { count: **count, centers: **centers, products, sides, squares: **squares }
    }

    /// Adds the balls of another rig of the same sensor.
    pub fn merge(&mut self, other: &Balls) {
        *self.count = self.count.saturating_add(other.count);
        *self.centers = self.centers.saturating_add(other.centers);
        *self.squares += other.squares;
        self.products.iter_mut().zip(other.products).for_each(|(sum, value)| *sum += value);
        self.sides.iter_mut().zip(other.sides).for_each(|(sum, value)| *sum += value);
    }

    /// Adds the ball of a survey whose distances from the border are known; `None` where too little of it is seen.
    pub(super) fn add(&mut self, survey: &mut Survey, ball: &Ball, w: [[f64; 3]; 2]) -> Option<()> {
        let Survey { grid, memory, .. } = survey;
        let Memory { color: [red, green, blue], scratch, classes, other, .. } = memory;
        let inner = Inner { grid, delta: [red, green, blue], classes, distances: other, w };
        let largest = inner.largest(scratch)?;
        let side = grid.side as f64;
        let slopes = |cell: usize| {
            let [column, row] = grid.place(cell).map(|along| (along as f64 + 0.5) * side - 0.5);
            let [x, y] = ball.center.unwrap_or_default();
            [(column - x) / ball.radius, (y - row) / ball.radius]
        };
        let cells = || inner.deeper(largest, SHARE);
        let (mut means, mut slope_means, mut count) = ([0.0; TERMS], [0.0; 2], 0.0);
        for cell in cells() {
            let terms = terms(grid.middle(cell), inner.delta(cell));
            means.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            slope_means.iter_mut().zip(slopes(cell)).for_each(|(sum, slope)| *sum += slope);
            count += 1.0;
        }
        let is_ball = count >= FEWEST && miss(cells(), &inner) <= LARGEST_MISS;
        if !is_ball {
            return None;
        }
        let shift = if ball.center.is_some() { 0.0 } else { 1.0 / count };
        for mean in means.iter_mut().chain(&mut slope_means) {
            *mean *= shift;
        }
        let weight = 1.0 / count;
        for cell in cells() {
            let mut terms = terms(grid.middle(cell), inner.delta(cell));
            terms.iter_mut().zip(means).for_each(|(term, mean)| *term -= mean);
            let mut slopes = slopes(cell);
            slopes.iter_mut().zip(slope_means).for_each(|(slope, mean)| *slope -= mean);
            let mut products = self.products.iter_mut();
            for (i, factor) in terms.iter().enumerate() {
                let row = products.by_ref().take(i + 1);
                row.zip(terms).for_each(|(sum, term)| *sum += weight * factor * term);
            }
            for (half, slope) in self.sides.chunks_exact_mut(TERMS).zip(slopes) {
                half.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * slope * term);
            }
            *self.squares += weight * (slopes[0] * slopes[0] + slopes[1] * slopes[1]);
        }
        *self.count = self.count.saturating_add(1);
        *self.centers = self.centers.saturating_add(u32::from(ball.center.is_some()));
        Some(())
    }
}

/// The share of the variance of the slopes in these cells that no sphere explains, wherever its center is.
fn miss(cells: impl Iterator<Item = usize>, inner: &Inner) -> f64 {
    let (mut sums, mut products, mut slopes, mut places, mut count) = ([0.0; 4], 0.0, 0.0, 0.0, 0.0);
    for cell in cells {
        let [u, v] = inner.slope(cell);
        let [x, y] = inner.grid.place(cell).map(|along| along as f64);
        products += u * x - v * y;
        slopes += u * u + v * v;
        places += x * x + y * y;
        sums.iter_mut().zip([u, v, x, y]).for_each(|(sum, value)| *sum += value);
        count += 1.0;
    }
    let [u, v, x, y] = sums;
    let products = products - (u * x - v * y) / count;
    let (slopes, places) = (slopes - (u * u + v * v) / count, places - (x * x + y * y) / count);
    1.0 - products * products / (slopes * places)
}
