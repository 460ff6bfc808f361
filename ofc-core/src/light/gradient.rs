//! The mean gradient of each channel, by least squares from its mean derivatives along several directions:
//!
//! ```text
//! <Is> = s1 <Ix> + s2 <Iy>   for every unit direction s = (s1, s2).                                     (20)
//! ```
//!
//! # Reference
//! Section 3.2, eq. 20; section 4 for the directions, "the axes directions and the 45 degree directions".

use super::differences::Differences;
use crate::picture::Window;
use crate::picture::cells::Block;
use core::f64::consts::FRAC_1_SQRT_2;

/// What is known along each of four directions: the axes and the diagonals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourDirections<const POWERS: usize> {
    /// Differences along (1, 0).
    pub east: Differences<POWERS>,
    /// Differences along (0, 1).
    pub north: Differences<POWERS>,
    /// Differences along (1, 1).
    pub north_east: Differences<POWERS>,
    /// Differences along (-1, 1).
    pub north_west: Differences<POWERS>,
}

impl<const POWERS: usize> FourDirections<POWERS> {
    /// No pairs yet.
    pub const NONE: Self = Self {
        east: Differences::NONE,
        north: Differences::NONE,
        north_east: Differences::NONE,
        north_west: Differences::NONE,
    };

    /// Adds the pairs of one block, of whose pixels `value` makes numbers.
    pub fn add(&mut self, block: &Block, value: &impl Fn(&Window, usize) -> [f64; 3]) {
        let (top, bottom) = (&block.top, &block.bottom);
        self.east.add(block.horizontal(), (top, 1), (top, 0), value);
        self.north.add(block.vertical(), (top, 0), (bottom, 0), value);
        self.north_east.add(block.rising(), (top, 1), (bottom, 0), value);
        self.north_west.add(block.falling(), (top, 0), (bottom, 1), value);
    }

    /// Least squares of eq. 20 for one channel; `None` where a direction has no pair. `per_diagonal` is the reciprocal of a
    /// diagonal's length, which the tilts and the slants, whose bits are promised, do not round alike.
    #[must_use]
    pub fn gradient(&self, channel: usize, per_diagonal: f64) -> Option<[f64; 2]> {
        let (e, n) = (self.east.mean(channel, 1.0)?, self.north.mean(channel, 1.0)?);
        let ne = self.north_east.mean(channel, per_diagonal)?;
        let nw = self.north_west.mean(channel, per_diagonal)?;
        // The normal matrix of these four unit directions is twice the identity.
        Some([0.5 * (e + FRAC_1_SQRT_2 * (ne - nw)), 0.5 * (n + FRAC_1_SQRT_2 * (ne + nw))])
    }
}

/// Eq. 20 for any set of directions, as its normal equations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Regression {
    /// The normal matrix ((xx, xy), (xy, yy)).
    normal: [f64; 3],
    /// The right side of each channel.
    right: [[f64; 2]; 3],
}

impl Regression {
    /// Adds the equation of the unit direction (x, y) and the channels' mean derivatives along it.
    pub fn add(&mut self, [x, y]: [f64; 2], means: [f64; 3]) {
        let [xx, xy, yy] = self.normal;
        self.normal = [xx + x * x, xy + x * y, yy + y * y];
        for ([a, b], mean) in self.right.iter_mut().zip(means) {
            (*a, *b) = (*a + x * mean, *b + y * mean);
        }
    }

    /// The mean gradient of a channel; `None` where all directions are parallel.
    #[must_use]
    pub fn gradient(&self, channel: usize) -> Option<[f64; 2]> {
        let ([xx, xy, yy], &[a, b]) = (self.normal, self.right.get(channel)?);
        let determinant = xx * yy - xy * xy;
        let independent = determinant > 1e-9 * xx.max(yy);
        independent.then(|| [(yy * a - xy * b) / determinant, (xx * b - xy * a) / determinant])
    }
}
