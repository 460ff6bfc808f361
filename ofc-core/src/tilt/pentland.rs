//! Pentland's tilt: the mean directional derivatives of a closed convex surface point to the light.
//!
//! # Reference
//! Section 3.2, eqs. 20-21. A. P. Pentland, "Finding the illuminant direction", J. Opt. Soc. Am. 72, 1982.

use crate::cells::{Block, for_each_block};
use crate::image::{Image, Window, for_each_bit};
use core::f64::consts::FRAC_1_SQRT_2;
use libm::atan2;

/// What the derivatives of the three channels say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilts {
    /// The tilt of each channel's light in (-pi, pi], counter-clockwise from x, for a convex surface.
    pub tilts: [f64; 3],
    /// The mean gradient (Ix, Iy) of each channel, in pixel values a pixel, y up.
    pub gradients: [[f64; 2]; 3],
}

/// The mean difference along one direction.
#[derive(Clone, Copy, Default)]
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
        value: impl Fn([f32; 3]) -> [f64; 3],
    ) {
        let mut sums = [0.0; 3];
        for_each_bit(bits, |i| {
            let (to, from) = (value(to.pixel(i + to_shift)), value(from.pixel(i + from_shift)));
            for ((sum, to), from) in sums.iter_mut().zip(to).zip(from) {
                *sum += to - from;
            }
        });
        for (total, sum) in self.sums.iter_mut().zip(sums) {
            *total += sum;
        }
        self.count += u64::from(bits.count_ones());
    }

    fn mean(&self, channel: usize, distance_reciprocal: f64) -> Option<f64> {
        let sum = self.sums.get(channel)?;
        (self.count > 0).then(|| sum / self.count as f64 * distance_reciprocal)
    }
}

/// The tilts from differences between neighbouring inliers along the axes and the diagonals.
///
/// `inliers` gives the bits of a window's inliers. `None` when a direction has no pair of inliers, or a channel's mean
/// gradient is zero: then it has no tilt.
pub fn tilts(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<Tilts> {
    tilts_of(image, inliers, |color| color.map(f64::from))
}

/// The same of the picture that has `value` of every color in its place.
pub fn tilts_of(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    value: impl Fn([f32; 3]) -> [f64; 3],
) -> Option<Tilts> {
    let (mut east, mut north, mut north_east, mut north_west) =
        (Mean::default(), Mean::default(), Mean::default(), Mean::default());
    for_each_block(image, inliers, |block: &Block| {
        let (top, bottom) = (&block.top, &block.bottom);
        east.add(block.horizontal(), (top, 1), (top, 0), &value);
        north.add(block.vertical(), (top, 0), (bottom, 0), &value);
        north_east.add(block.rising(), (top, 1), (bottom, 0), &value);
        north_west.add(block.falling(), (top, 0), (bottom, 1), &value);
    });
    let mut result = Tilts { tilts: [0.0; 3], gradients: [[0.0; 2]; 3] };
    for (channel, (tilt, gradient)) in result.tilts.iter_mut().zip(&mut result.gradients).enumerate() {
        let (e, n) = (east.mean(channel, 1.0)?, north.mean(channel, 1.0)?);
        let (ne, nw) = (north_east.mean(channel, FRAC_1_SQRT_2)?, north_west.mean(channel, FRAC_1_SQRT_2)?);
        // Least squares of eq. 20 over the four unit directions, whose normal matrix is twice the identity.
        let ix = 0.5 * (e + FRAC_1_SQRT_2 * (ne - nw));
        let iy = 0.5 * (n + FRAC_1_SQRT_2 * (ne + nw));
        if ix == 0.0 && iy == 0.0 {
            return None;
        }
        *tilt = atan2(iy, ix);
        *gradient = [ix, iy];
    }
    Some(result)
}
