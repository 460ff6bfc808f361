//! Pentland's tilt: the mean directional derivatives of a closed convex surface point to the light.
//!
//! # Reference
//! Section 3.2, eqs. 20-21. A. P. Pentland, "Finding the illuminant direction", J. Opt. Soc. Am. 72, 1982.

use super::Tilts;
use crate::light::differences::{Differences, color};
use crate::light::gradient::{FourDirections, Regression};
use crate::picture::cells::{Block, for_each_block};
use crate::picture::{Image, WINDOW, Window};
use core::f64::consts::FRAC_1_SQRT_2;
use libm::hypot;

/// The differences between neighboring inliers along the axes and the diagonals, summed over blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sums(FourDirections<1>);

impl Default for Sums {
    fn default() -> Self {
        Self(FourDirections::NONE)
    }
}

impl Sums {
    /// Adds the pairs of one block.
    pub fn add(&mut self, block: &Block) {
        self.0.add(block, &color);
    }

    /// Adds the pairs of inliers along the `lower` of two rows, and those between it and the `upper` one. `left` is the
    /// pixel left of the window where it is an inlier, and then the window's last one.
    pub fn add_rows(
        &mut self,
        (upper, upper_bits): (&Window, u64),
        (lower, lower_bits): (&Window, u64),
        left: &mut Option<[f32; 3]>,
    ) {
        let FourDirections { east, north, .. } = &mut self.0;
        if let (Some(left), 1) = (*left, lower_bits & 1) {
            east.add_pair(lower.pixel(0), left);
        }
        *left = (lower_bits >> (WINDOW - 1) == 1).then(|| lower.pixel(WINDOW - 1));
        east.add(lower_bits & lower_bits >> 1, (lower, 1), (lower, 0), &color);
        north.add(upper_bits & lower_bits, (upper, 0), (lower, 0), &color);
    }

    /// The tilts; `None` when a direction has no pair of inliers, or a channel's mean gradient is zero.
    #[must_use]
    pub fn tilts(&self) -> Option<Tilts> {
        Tilts::of_gradients(|channel| self.0.gradient(channel, FRAC_1_SQRT_2))
    }

    /// Adds a frame of which [`Self::add_rows`] saw every `step`-th row, and forgets one in `step` of the frames before.
    pub fn remember(&mut self, frame: &Self, step: usize) {
        let reciprocal = 1.0 / step as f64;
        self.0.east.blend(&frame.0.east, 1.0 - reciprocal, 1.0);
        self.0.north.blend(&frame.0.north, 1.0 - reciprocal, reciprocal);
    }

    /// The tilts along the axes alone; `None` when one has no pair of inliers, or a channel's mean gradient is zero.
    #[must_use]
    pub fn tilts_along_axes(&self) -> Option<Tilts> {
        let FourDirections { east, north, .. } = &self.0;
        Tilts::of_gradients(|channel| Some([east.mean(channel, 1.0)?, north.mean(channel, 1.0)?]))
    }
}

/// The tilts from differences between neighboring inliers along the axes and the diagonals.
///
/// `inliers` gives the bits of a window's inliers. `None` when a direction has no pair of inliers, or a channel's mean
/// gradient is zero: then it has no tilt.
pub fn tilts(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<Tilts> {
    tilts_of(image, inliers, color)
}

/// The tilts of the picture that has `value` in the place of every window's pixel.
pub fn tilts_of(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    value: impl Fn(&Window, usize) -> [f64; 3],
) -> Option<Tilts> {
    let mut sums = FourDirections::NONE;
    for_each_block(image, inliers, |block: &Block| sums.add(block, &value));
    Sums(sums).tilts()
}

/// Steps between pixels may be no longer than this along either axis.
pub const MAX_STEP: i32 = 1024;

/// The tilts from differences between inliers along any set of directions, each given as the step (right, up) from one
/// pixel of a pair to the other.
///
/// `None` when a step has no pair of inliers, is zero or too long, all of them are parallel, or a channel's mean gradient
/// is zero.
pub fn tilts_along(image: &Image, inliers: impl Fn(&Window) -> u64, steps: &[[i32; 2]]) -> Option<Tilts> {
    let mut regression = Regression::default();
    for &[dx, dy] in steps {
        if dx.unsigned_abs().max(dy.unsigned_abs()) > MAX_STEP.unsigned_abs() {
            return None;
        }
        let length = hypot(f64::from(dx), f64::from(dy));
        let pairs = differences(image, &inliers, dx, dy);
        let mean = |channel| pairs.mean(channel, 1.0 / length);
        let means = [mean(0)?, mean(1)?, mean(2)?];
        regression.add([f64::from(dx) / length, f64::from(dy) / length], means);
    }
    Tilts::of_gradients(|channel| regression.gradient(channel))
}

/// The differences of all pairs of inliers one step apart.
fn differences(image: &Image, inliers: impl Fn(&Window) -> u64, dx: i32, dy: i32) -> Differences<1> {
    // The pixel further up is in an earlier row; a step down is one up backwards.
    let (rows, columns) = (dy.unsigned_abs() as usize, dx.unsigned_abs() as usize);
    let upper_is_right = (dx > 0) == (dy > 0) || dy == 0;
    let (mut upper, mut lower) = (Window::new(), Window::new());
    let mut sums = Differences::NONE;
    for y in 0..image.height().saturating_sub(rows) {
        for x in (0..image.width().saturating_sub(columns)).step_by(WINDOW) {
            let (left, right) = (x, x + columns);
            let (upper_x, lower_x) = if upper_is_right { (right, left) } else { (left, right) };
            image.read(upper_x, y, &mut upper);
            image.read(lower_x, y + rows, &mut lower);
            let bits = inliers(&upper) & inliers(&lower);
            let ends_above = dy > 0 || (dy == 0 && dx > 0);
            let (to, from) = if ends_above { (&upper, &lower) } else { (&lower, &upper) };
            sums.add(bits, (to, 0), (from, 0), &color);
        }
    }
    sums
}
