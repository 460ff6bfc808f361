//! The rim of the mask: a surface that ends in a silhouette there faces outward.

use super::class::{NOTE, REJECTED, THREE_LIGHTS, class};
use super::distance::{self, FAR, STEP};
use super::histogram::Histogram;
use super::map::{Map, Vectors};
use super::vector::{Vector, dot, unit};

/// Pixels up to so many from what is outside are the rim.
const BREADTH: u32 = 3;
/// Outward is the way to the pixels outside, up to so many away.
const REACH: usize = 5;
/// A rim whose lit normals have at least this cosine to outward, in the median, is a silhouette.
const SILHOUETTE: f32 = 0.55;
/// Fewer lit pixels of the rim say nothing.
const FEWEST: u32 = 30;

/// Marks the pixels of the rim whose normals are unknown with [`NOTE`], if known ones face outward, and returns the cosine of their
/// angle to outward. What ends at the frame of the picture is no rim.
pub(super) fn mark(classes: &mut Map<u8>, normals: &Vectors, distances: &mut [u32]) -> Option<f32> {
    let width = classes.width.max(1);
    let height = distances.len().checked_div(width)?;
    for (y, row) in distances.chunks_exact_mut(width).enumerate() {
        for (slot, &byte) in row.iter_mut().zip(classes.row(y)) {
            *slot = if byte == 0 { 0 } else { FAR };
        }
    }
    distance::spread(distances, width);
    let margin = BREADTH as usize + 1;
    let is_rim = |x: usize, y: usize| {
        let distance = distances.get(y * width + x).copied().unwrap_or(0);
        distance > 0
            && distance <= 2 * STEP * BREADTH
            && (margin..width.saturating_sub(margin)).contains(&x)
            && (margin..height.saturating_sub(margin)).contains(&y)
    };
    let mut cosines = Histogram::over(-1.0, 1.0);
    for y in 0..height {
        for x in 0..width {
            let is_known = matches!(class(classes.at(x, y)), THREE_LIGHTS | REJECTED);
            if is_known && is_rim(x, y) {
                cosines.add(dot(outward(classes, [x, y]), normals.at(x, y)));
            }
        }
    }
    let cosine = cosines.median().filter(|&cosine| cosine > SILHOUETTE && cosines.count() > FEWEST)?;
    for y in 0..height {
        for x in 0..width {
            let byte = classes.at(x, y);
            if is_rim(x, y) && !matches!(class(byte), THREE_LIGHTS | REJECTED) {
                classes.set(x, y, byte | NOTE);
            }
        }
    }
    Some(cosine.clamp(0.7, 0.95))
}

/// The direction in the picture to the pixels outside of the mask.
pub(super) fn outward(classes: &Map<u8>, [x, y]: [usize; 2]) -> Vector {
    let (mut right, mut down) = (0.0, 0.0);
    for dy in 0..=2 * REACH {
        for dx in 0..=2 * REACH {
            if classes.at((x + dx).wrapping_sub(REACH), (y + dy).wrapping_sub(REACH)) == 0 {
                right += dx as f32 - REACH as f32;
                down += dy as f32 - REACH as f32;
            }
        }
    }
    unit([right, -down, 0.0])
}
