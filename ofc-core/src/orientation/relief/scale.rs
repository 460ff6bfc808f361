//! The scale of the slopes, which integrability leaves open.
//!
//! The colors of the inner contact, relative to the plane's, lie on an ellipsoid (eq. 10) well enough where they bend enough: its
//! C turns them into unit vectors, up to a rotation. The scale s is the one with which the normals (s u1, s u2, sqrt(1 - s^2 |u|^2))
//! agree best with these vectors after the best orthogonal transformation. What is left of the disagreement, relative to the
//! variance of the slopes, is as much as the scale's logarithm may be off: the two models err independently.

use super::grid::{Grid, Planes, class};
use super::result::PixelClass;
use super::spread::LARGEST_SQUARE;
use crate::color::dispersion::dispersion;
use crate::color::ellipsoid::{self, single_residual};
use crate::color::lmeds::{MIN_PIXELS, Sample};
use crate::color::regression::{Moments, TERMS};
use crate::math::mat3::{self, Mat3};
use crate::math::rng::Rng;
use crate::math::select::{kth_smallest, median_rank};
use libm::{exp, log, sqrt};

/// The inner contact begins at these shares of the largest distance from its border: the one that agrees best counts.
const SHARES: [f64; 3] = [0.3, 0.45, 0.6];

/// For a ball of known radius only the innermost part counts: near its border the gel leaves the ball.
const BALL_SHARE: f64 = 0.6;

/// The largest distance is that of the cells but for one in so many that are still farther.
const FARTHEST: usize = 50;

/// Fewer cells have no ellipsoid.
const FEWEST: usize = 60;

/// Subsets of six that propose ellipsoids.
const SUBSETS: u32 = 500;

/// Scales that are tried, and between which root mean squares of the slopes' sines.
const STEPS: u32 = 60;
const SMALLEST_TILT: f64 = 0.05;
const LARGEST_TILT: f64 = 1.2;

/// The share of the cells that may be beyond the largest squared sine that a normal can have.
const MOST_BEYOND: f64 = 0.1;

/// A scale, and how far both models disagree with it.
#[derive(Clone, Copy)]
pub(crate) struct Scale {
    pub factor: f64,
    pub disagreement: f64,
}

/// The inner contact and its slopes at an arbitrary scale.
pub(crate) struct Inner<'a> {
    pub grid: &'a Grid,
    pub delta: [&'a [f32]; 3],
    pub classes: &'a [u32],
    pub distances: &'a [u32],
    pub w: [[f64; 3]; 2],
}

impl Inner<'_> {
    pub fn delta(&self, cell: usize) -> [f64; 3] {
        self.delta.map(|plane| plane.get(cell).map_or(0.0, |&value| f64::from(value)))
    }

    pub fn slope(&self, cell: usize) -> [f64; 2] {
        let delta = self.delta(cell);
        self.w.map(|row| mat3::dot(row, delta))
    }

    pub fn is_contact(&self, cell: usize) -> bool {
        self.classes.get(cell).is_some_and(|&state| class(state) == PixelClass::Contact as u32)
    }

    pub fn contact(&self) -> impl Iterator<Item = usize> {
        (0..self.grid.len()).filter(|&cell| self.is_contact(cell))
    }

    /// The cells that are at least this share of the largest distance away from the border.
    pub fn deeper(&self, largest: f64, share: f64) -> impl Iterator<Item = usize> {
        let limit = share * largest;
        self.contact().filter(move |&cell| self.distances.get(cell).is_some_and(|&d| f64::from(d) > limit))
    }

    /// The largest distance but for a few cells.
    pub fn largest(&self, scratch: &mut [f32]) -> Option<f64> {
        let mut count = 0_usize;
        for (cell, slot) in self.contact().zip(scratch.iter_mut()) {
            *slot = self.distances.get(cell).map_or(0.0, |&d| d as f32);
            count += 1;
        }
        let rank = count - count.div_ceil(FARTHEST);
        kth_smallest(scratch.get(..count)?, rank).map(f64::from)
    }

    /// The scale of a ball of this radius in cells, wherever its center is: least squares of the slopes on the position.
    pub fn of_ball(&self, radius: f64, scratch: &mut [f32]) -> Option<f64> {
        let largest = self.largest(scratch)?;
        let (mut count, mut sums, mut products, mut squares) = (0.0, [0.0; 4], 0.0, 0.0);
        for cell in self.deeper(largest, BALL_SHARE) {
            let [u, v] = self.slope(cell);
            let [column, row] = self.grid.place(cell);
            let (x, y) = (column as f64 / radius, -(row as f64) / radius);
            products += u * x + v * y;
            squares += u * u + v * v;
            sums.iter_mut().zip([u, v, x, y]).for_each(|(sum, value)| *sum += value);
            count += 1.0;
        }
        let [u, v, x, y] = sums;
        let (products, squares) = (products - (u * x + v * y) / count, squares - (u * u + v * v) / count);
        (count >= FEWEST as f64 && squares > 0.0).then(|| products / squares).filter(|scale| *scale > 0.0)
    }

    /// The scale with which the slopes agree best with the ellipsoid of the colors; `None` where there is none.
    ///
    /// # Scratch
    /// Three planes and one more of one `f32` a cell.
    pub fn of_colors(&self, planes: &mut Planes, scratch: &mut [f32], seed: u64) -> Option<Scale> {
        let largest = self.largest(scratch)?;
        let mut best: Option<Scale> = None;
        for share in SHARES {
            let found = self.beyond(largest, share, planes, scratch, seed);
            if let Some(found) = found
                && best.is_none_or(|best| found.disagreement < best.disagreement)
            {
                best = Some(found);
            }
        }
        best
    }

    fn beyond(
        &self,
        largest: f64,
        share: f64,
        planes: &mut Planes,
        scratch: &mut [f32],
        seed: u64,
    ) -> Option<Scale> {
        let mut count = 0;
        let [red, green, blue] = planes;
        for (((cell, r), g), b) in
            self.deeper(largest, share).zip(red.iter_mut()).zip(green.iter_mut()).zip(blue.iter_mut())
        {
            [*r, *g, *b] = self.delta(cell).map(|value| (1.0 + value) as f32);
            count += 1;
        }
        if count < FEWEST.max(MIN_PIXELS) {
            return None;
        }
        let colors = [red.get(..count)?, green.get(..count)?, blue.get(..count)?];
        let z = Sample::new(colors, scratch.get_mut(..count)?).best(SUBSETS, &mut Rng::new(seed))?;
        let residual = |z: &[f64; TERMS], color| single_residual(&z.map(|c| c as f32), color).abs();
        let color = |cell: usize| self.delta(cell).map(|value| (1.0 + value) as f32);
        for (cell, slot) in self.deeper(largest, share).zip(scratch.iter_mut()) {
            *slot = residual(&z, color(cell));
        }
        let median = kth_smallest(scratch.get(..count)?, median_rank(count))?;
        let limit = 2.5 * dispersion(f64::from(median), count, TERMS);
        let inliers =
            || self.deeper(largest, share).filter(|&cell| f64::from(residual(&z, color(cell))) <= limit);
        let mut moments = Moments::default();
        for cell in inliers() {
            moments.add(color(cell).map(f64::from));
        }
        let ellipsoid = ellipsoid::decompose(&moments.solve()?.coefficients).ok()?;
        self.agreement(&ellipsoid.root, inliers)
    }

    /// The scale with which the normals of `cells` agree best with the unit vectors that `root` makes of their colors.
    fn agreement<I: Iterator<Item = usize>>(&self, root: &Mat3, cells: impl Fn() -> I) -> Option<Scale> {
        let vector = |cell| mat3::apply(root, self.delta(cell).map(|value| 1.0 + value));
        let [mut squares, mut count, mut lengths] = [0.0; 3];
        for cell in cells() {
            let ([u, v], a) = (self.slope(cell), vector(cell));
            squares += u * u + v * v;
            lengths += mat3::dot(a, a);
            count += 1.0;
        }
        let slope = sqrt(squares / count);
        if !(slope > 0.0 && slope.is_finite()) {
            return None;
        }
        let mut best: Option<Scale> = None;
        for step in 0..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            let tilt = SMALLEST_TILT * exp(share * log(LARGEST_TILT / SMALLEST_TILT));
            let factor = tilt / slope;
            let (mut products, mut beyond, mut sums, mut energy) = ([[0.0; 3]; 3], 0.0, [0.0; 2], 0.0);
            for cell in cells() {
                let (normal, is_beyond) = unit(self.slope(cell).map(|slope| factor * slope));
                beyond += f64::from(u8::from(is_beyond));
                let a = vector(cell);
                for (row, n) in products.iter_mut().zip(normal) {
                    row.iter_mut().zip(a).for_each(|(entry, a)| *entry += n * a);
                }
                let [n1, n2, _] = normal;
                sums = [sums[0] + n1, sums[1] + n2];
                energy += n1 * n1 + n2 * n2;
            }
            if beyond > MOST_BEYOND * count {
                break;
            }
            let variance = (energy - (sums[0] * sums[0] + sums[1] * sums[1]) / count) / count;
            let [first, second, third] = mat3::svd(&products).values;
            let disagreement = (lengths + count - 2.0 * (first + second + third)) / count / variance;
            if best.is_none_or(|best| disagreement < best.disagreement) {
                best = Some(Scale { factor, disagreement: disagreement.max(0.0) });
            }
        }
        best
    }
}

/// The unit vector of these first two components, shortened where they are too long, and whether they were.
pub(crate) fn unit([n1, n2]: [f64; 2]) -> ([f64; 3], bool) {
    let square = n1 * n1 + n2 * n2;
    let shorter = if square > LARGEST_SQUARE { sqrt(LARGEST_SQUARE / square) } else { 1.0 };
    let n3 = sqrt(1.0 - square.min(LARGEST_SQUARE));
    ([n1 * shorter, n2 * shorter, n3], square > LARGEST_SQUARE)
}
