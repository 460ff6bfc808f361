//! Where the shadow of a light is attached: the surface turns away from the light there, where a cast shadow says nothing of it.
//!
//! Light that ends slowly ends at an attached shadow, light that ends at once at a cast one. A pixel in shadow belongs to the nearest
//! end.

use super::class::{DOUBTFUL, FIRST_LIGHT, NOTE, ONE_LIGHT, class, mean_around};
use super::distance::{self, FAR};
use super::lights::Shadow;
use super::map::{Map, Vectors};
use super::vector::{Vector, dot};

/// The light is looked at so many pixels from its shadow.
const SPAN: usize = 4;
/// Light that is weaker than this there ends slowly.
const SLOW: f32 = 0.15;
/// So is light below so many deviations of its noise.
const SLOW_BY_NOISE: f32 = 8.0;

/// Notes at pixels of one light which of the other two are hidden by an attached shadow: the first in [`NOTE`], the second in
/// [`DOUBTFUL`], which is free as long as nothing is chosen.
pub(super) fn mark(
    shadows: &[Option<Shadow>; 3],
    raw: &Vectors,
    classes: &mut Map<u8>,
    distances: &mut [u32],
) {
    let width = classes.width.max(1);
    for (light, shadow) in shadows.iter().enumerate() {
        let Some(shadow) = shadow else { continue };
        let bit = FIRST_LIGHT << light;
        let slow = SLOW.max(SLOW_BY_NOISE * shadow.deviation);
        for (y, row) in distances.chunks_exact_mut(width).enumerate() {
            for (x, slot) in row.iter_mut().enumerate() {
                *slot = FAR;
                let byte = classes.at(x, y);
                if byte == 0 || byte & bit != 0 {
                    continue;
                }
                let sides =
                    [(x + SPAN, y), (x.wrapping_sub(SPAN), y), (x, y + SPAN), (x, y.wrapping_sub(SPAN))];
                for (x, y) in sides {
                    if classes.at(x, y) & bit == 0 {
                        continue;
                    }
                    let Some(mean) = mean_around(raw, classes, [x, y], 1, |byte| byte != 0) else { continue };
                    // Distances are doubled; the lowest bit says that the shadow is attached.
                    let attached = dot(shadow.direction, mean) < slow;
                    *slot = (*slot).min(u32::from(attached));
                }
            }
        }
        distance::spread(distances, width);
        for (y, row) in distances.chunks_exact(width).enumerate() {
            for (x, &distance) in row.iter().enumerate() {
                let byte = classes.at(x, y);
                if class(byte) == ONE_LIGHT && byte & bit == 0 && distance < FAR && distance & 1 == 1 {
                    classes.set(x, y, byte | note_of(byte, light));
                }
            }
        }
    }
}

/// The bit that notes this light, one of the two that a pixel does not see.
const fn note_of(byte: u8, light: usize) -> u8 {
    let before = (1 << light) - 1;
    let seen = byte >> 4 & 7;
    if (!seen & before) == 0 { NOTE } else { DOUBTFUL }
}

/// The lights that are hidden from a pixel of one light by attached shadows.
pub(super) fn hidden(byte: u8, directions: &[Option<Vector>; 3]) -> [Option<Vector>; 3] {
    let mut hidden = *directions;
    for (light, direction) in hidden.iter_mut().enumerate() {
        if byte & (FIRST_LIGHT << light) != 0 || byte & note_of(byte, light) == 0 {
            *direction = None;
        }
    }
    hidden
}
