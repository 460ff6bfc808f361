//! Which lights each pixel sees.
//!
//! The strength `t_i` = `a_i . v` that light i has at a pixel is `a_i . n` where it shines and zero in its shadow. Means of 3 x 3 pixels are
//! compared with their noise; what the majority around says holds, except of a pixel that is surely lit.

use super::class::{FIRST_LIGHT, mean_around};
use super::map::{Map, Vectors};
use super::vector::{Vector, dot};

/// Below this many deviations of its noise a light does not shine.
const SHADOW: f32 = 3.0;
/// Nor below this strength: light that surfaces send to each other.
const LEAST: f32 = 0.03;
/// A light of so many times that strength surely shines, whatever the pixels around say.
const SURELY: f32 = 2.0;
/// The majority is that of `2 RADIUS + 1` pixels a side.
const RADIUS: usize = 2;

/// A light of which the direction is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shadow {
    /// Toward the light.
    pub direction: Vector,
    /// The deviation of `a_i . v` of a single pixel.
    pub deviation: f32,
    /// That of means of 3 x 3 pixels.
    pub deviation_of_means: f32,
}

impl Shadow {
    /// Below this strength the light does not shine.
    pub fn least(&self) -> f32 {
        (SHADOW * self.deviation_of_means).max(LEAST)
    }
}

/// Sets the bits of the lights that each pixel of the mask sees. A light that is not known to leave shadows is seen everywhere.
///
/// `votes` is a number a pixel.
pub(super) fn mark(shadows: &[Option<Shadow>; 3], raw: &Vectors, classes: &mut Map<u8>, votes: &mut [u32]) {
    let width = classes.width.max(1);
    // A byte of each number for each light, and one for pixels that vote at all.
    for (y, row) in votes.chunks_exact_mut(width).enumerate() {
        for (x, vote) in row.iter_mut().enumerate() {
            let byte = classes.at(x, y);
            *vote = 0;
            if byte == 0 {
                continue;
            }
            let mut surely = 0;
            if let Some(mean) = mean_around(raw, classes, [x, y], 1, |byte| byte != 0) {
                *vote = 1 << 24;
                for (i, shadow) in shadows.iter().enumerate() {
                    let Some(shadow) = shadow else { continue };
                    let (strength, least) = (dot(shadow.direction, mean), shadow.least());
                    *vote |= u32::from(strength < least) << (8 * i);
                    surely |= u8::from(strength > SURELY * least) << i;
                }
            }
            classes.set(x, y, byte | surely << 4);
        }
    }
    for (y, row) in classes.data.chunks_mut(classes.row_stride.max(1)).enumerate() {
        for (x, byte) in row.iter_mut().take(width).enumerate() {
            if *byte == 0 {
                continue;
            }
            let mut sum = 0;
            for row in y.saturating_sub(RADIUS)..=y + RADIUS {
                let row = votes.get(row * width..(row + 1) * width).unwrap_or_default();
                let last = (x + RADIUS + 1).min(row.len());
                let row = row.get(x.saturating_sub(RADIUS)..last).unwrap_or_default();
                sum += row.iter().sum::<u32>();
            }
            let voters = sum >> 24;
            for i in 0..3 {
                let shaded = sum >> (8 * i) & 255;
                if 2 * shaded <= voters {
                    *byte |= FIRST_LIGHT << i;
                }
            }
        }
    }
}
