//! Pentland's tilt: the mean directional derivatives of a closed convex surface point to the light.
//!
//! # Reference
//! Section 3.2, eqs. 20-21. A. P. Pentland, "Finding the illuminant direction", J. Opt. Soc. Am. 72, 1982.

use super::{Tilts, has_direction};
use crate::picture::cells::{Block, for_each_block};
use crate::picture::differences::Differences;
use crate::picture::{Image, WINDOW, Window, for_each_bit};
use core::f64::consts::FRAC_1_SQRT_2;
use libm::{atan2, hypot};

/// The mean difference along one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Mean {
    sums: [f64; 3],
    count: u64,
}

impl Mean {
    /// Adds the differences `to` - `from` of the pairs in `bits`, after `value`.
    fn add(
        &mut self,
        bits: u64,
        (to, to_shift): (&Window, usize),
        (from, from_shift): (&Window, usize),
        value: &impl Fn(&Window, usize) -> [f64; 3],
    ) {
        let [mut red, mut green, mut blue] = [0.0; 3];
        for_each_bit(bits, |i| {
            let ([r, g, b], [r0, g0, b0]) = (value(to, i + to_shift), value(from, i + from_shift));
            (red, green, blue) = (red + (r - r0), green + (g - g0), blue + (b - b0));
        });
        for (total, sum) in self.sums.iter_mut().zip([red, green, blue]) {
            *total += sum;
        }
        self.count += u64::from(bits.count_ones());
    }

    /// Adds `scale` times other differences to `share` of these.
    #[expect(clippy::cast_sign_loss, reason = "counts")]
    fn remember(&mut self, other: &Self, share: f64, scale: f64) {
        for (sum, other) in self.sums.iter_mut().zip(other.sums) {
            *sum = *sum * share + other * scale;
        }
        self.count = (self.count as f64 * share) as u64 + other.count;
    }

    fn mean(&self, channel: usize, distance_reciprocal: f64) -> Option<f64> {
        let sum = self.sums.get(channel)?;
        (self.count > 0).then(|| sum / self.count as f64 * distance_reciprocal)
    }
}

/// The differences between neighbouring inliers along the axes and the diagonals, summed over blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    east: Mean,
    north: Mean,
    north_east: Mean,
    north_west: Mean,
}

impl Sums {
    /// Adds the pairs of one block.
    pub fn add(&mut self, block: &Block) {
        self.add_of(block, &color);
    }

    /// Adds the pairs of inliers along the `lower` of two rows, and those between it and the `upper` one. `left` is the
    /// pixel left of the window where it is an inlier, and then the window's last one.
    pub fn add_rows(
        &mut self,
        (upper, upper_bits): (&Window, u64),
        (lower, lower_bits): (&Window, u64),
        left: &mut Option<[f32; 3]>,
    ) {
        if let (Some(left), 1) = (*left, lower_bits & 1) {
            for ((sum, to), from) in self.east.sums.iter_mut().zip(lower.pixel(0)).zip(left) {
                *sum += f64::from(to) - f64::from(from);
            }
            self.east.count += 1;
        }
        *left = (lower_bits >> (WINDOW - 1) == 1).then(|| lower.pixel(WINDOW - 1));
        self.east.add(lower_bits & lower_bits >> 1, (lower, 1), (lower, 0), &color);
        self.north.add(upper_bits & lower_bits, (upper, 0), (lower, 0), &color);
    }

    fn add_of(&mut self, block: &Block, value: &impl Fn(&Window, usize) -> [f64; 3]) {
        let (top, bottom) = (&block.top, &block.bottom);
        self.east.add(block.horizontal(), (top, 1), (top, 0), value);
        self.north.add(block.vertical(), (top, 0), (bottom, 0), value);
        self.north_east.add(block.rising(), (top, 1), (bottom, 0), value);
        self.north_west.add(block.falling(), (top, 0), (bottom, 1), value);
    }

    /// The tilts; `None` when a direction has no pair of inliers, or a channel's mean gradient is zero.
    #[must_use]
    pub fn tilts(&self) -> Option<Tilts> {
        let mut gradients = [[0.0; 2]; 3];
        for (channel, gradient) in gradients.iter_mut().enumerate() {
            let (e, n) = (self.east.mean(channel, 1.0)?, self.north.mean(channel, 1.0)?);
            let ne = self.north_east.mean(channel, FRAC_1_SQRT_2)?;
            let nw = self.north_west.mean(channel, FRAC_1_SQRT_2)?;
            // Least squares of eq. 20 over the four unit directions, whose normal matrix is twice the identity.
            let ix = 0.5 * (e + FRAC_1_SQRT_2 * (ne - nw));
            let iy = 0.5 * (n + FRAC_1_SQRT_2 * (ne + nw));
            *gradient = [ix, iy];
        }
        of_gradients(gradients)
    }

    /// Adds a frame of which [`Self::add_rows`] saw every `step`-th row, and forgets one in `step` of the frames before.
    pub fn remember(&mut self, frame: &Self, step: usize) {
        let reciprocal = 1.0 / step as f64;
        self.east.remember(&frame.east, 1.0 - reciprocal, 1.0);
        self.north.remember(&frame.north, 1.0 - reciprocal, reciprocal);
    }

    /// The tilts along the axes alone; `None` as for [`Self::tilts`].
    #[must_use]
    pub fn tilts_along_axes(&self) -> Option<Tilts> {
        let mut gradients = [[0.0; 2]; 3];
        for (channel, gradient) in gradients.iter_mut().enumerate() {
            *gradient = [self.east.mean(channel, 1.0)?, self.north.mean(channel, 1.0)?];
        }
        of_gradients(gradients)
    }
}

/// The tilts of the channels' mean gradients; `None` where one is zero.
fn of_gradients(gradients: [[f64; 2]; 3]) -> Option<Tilts> {
    let mut tilts = [0.0; 3];
    for (tilt, [ix, iy]) in tilts.iter_mut().zip(gradients) {
        if !has_direction(ix, iy) {
            return None;
        }
        *tilt = atan2(iy, ix);
    }
    Some(Tilts { tilts, gradients })
}

/// The tilts from differences between neighbouring inliers along the axes and the diagonals.
///
/// `inliers` gives the bits of a window's inliers. `None` when a direction has no pair of inliers, or a channel's mean
/// gradient is zero: then it has no tilt.
pub fn tilts(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<Tilts> {
    tilts_of(image, inliers, color)
}

/// A color in double precision.
#[inline]
fn color(window: &Window, i: usize) -> [f64; 3] {
    // Not by map(), which is a call where code is made small.
    let [r, g, b] = window.pixel(i);
    [f64::from(r), f64::from(g), f64::from(b)]
}

/// The same of the picture that has `value` of every window's pixel in its place.
pub fn tilts_of(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    value: impl Fn(&Window, usize) -> [f64; 3],
) -> Option<Tilts> {
    let mut sums = Sums::default();
    for_each_block(image, inliers, |block: &Block| sums.add_of(block, &value));
    sums.tilts()
}

/// Steps between pixels may be no longer than this along either axis.
pub const MAX_STEP: i32 = 1024;

/// The tilts from differences between inliers along any set of directions, each given as the step (right, up) from one
/// pixel of a pair to the other.
///
/// `None` when a step has no pair of inliers, is zero or too long, all of them are parallel, or a channel's mean gradient
/// is zero.
pub fn tilts_along(image: &Image, inliers: impl Fn(&Window) -> u64, steps: &[[i32; 2]]) -> Option<Tilts> {
    // Least squares of eq. 20: the normal matrix ((xx, xy), (xy, yy)), and the right side of each channel.
    let ([mut xx, mut xy, mut yy], mut right) = ([0.0; 3], [[0.0; 2]; 3]);
    for &[dx, dy] in steps {
        if dx.abs().max(dy.abs()) > MAX_STEP {
            return None;
        }
        let length = hypot(f64::from(dx), f64::from(dy));
        let (x, y) = (f64::from(dx) / length, f64::from(dy) / length);
        for ((mean, _), right) in
            differences(image, &inliers, dx, dy).statistics(length)?.into_iter().zip(&mut right)
        {
            *right = [right[0] + x * mean, right[1] + y * mean];
        }
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let determinant = xx * yy - xy * xy;
    let parallel = determinant.is_nan() || determinant <= 1e-9 * xx.max(yy);
    if parallel {
        return None;
    }
    of_gradients(right.map(|[a, b]| [(yy * a - xy * b) / determinant, (xx * b - xy * a) / determinant]))
}

/// The differences of all pairs of inliers one step apart.
fn differences(image: &Image, inliers: impl Fn(&Window) -> u64, dx: i32, dy: i32) -> Differences {
    // The pixel further up is in an earlier row; a step down is one up backwards.
    let (rows, columns) = (dy.unsigned_abs() as usize, dx.unsigned_abs() as usize);
    let upper_is_right = (dx > 0) == (dy > 0) || dy == 0;
    let (mut upper, mut lower) = (Window::new(), Window::new());
    let mut sums = Differences::default();
    for y in 0..image.height().saturating_sub(rows) {
        for x in (0..image.width().saturating_sub(columns)).step_by(WINDOW) {
            let (left, right) = (x, x + columns);
            let (upper_x, lower_x) = if upper_is_right { (right, left) } else { (left, right) };
            image.read(upper_x, y, &mut upper);
            image.read(lower_x, y + rows, &mut lower);
            let bits = inliers(&upper) & inliers(&lower);
            let ends_above = dy > 0 || (dy == 0 && dx > 0);
            let (to, from) = if ends_above { (&upper, &lower) } else { (&lower, &upper) };
            sums.add(bits, (to, 0), (from, 0));
        }
    }
    sums
}
