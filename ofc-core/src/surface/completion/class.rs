//! What is known of a pixel, in one byte: its class in the lowest three bits, the lights that it sees in bits 4 to 6, and whether its
//! mirror image may be the right one in bit 7.

use super::map::{Map, Vectors};
use super::vector::{Vector, ZERO, add, scale};

/// Not in the mask.
pub const OUTSIDE: u8 = 0;
/// Sees all three lights: the color determines the normal.
pub const THREE_LIGHTS: u8 = 1;
/// Sees two lights: the color determines the normal and its mirror image at the plane of both lights, and integrability chooses.
pub const TWO_LIGHTS: u8 = 2;
/// Sees one light: the color determines the angle to it.
pub const ONE_LIGHT: u8 = 3;
/// Of the color nothing is known, and the surface is interpolated.
pub const INTERPOLATED: u8 = 4;
/// Sees all three lights, and is rejected for its noise, an interreflection or a soft shadow: the normal is that of its color, with
/// an uncertainty that holds the misfit.
pub const REJECTED: u8 = 5;

/// The bits that hold the class.
pub const CLASS: u8 = 7;
/// The bit of a pixel that sees light 0; the next two bits are lights 1 and 2.
pub const FIRST_LIGHT: u8 = 1 << 4;
/// The bit of a pixel of two lights whose mirror image may be the right one: with a probability above 0.1.
pub const DOUBTFUL: u8 = 1 << 7;

/// The bits of all three lights.
pub(super) const ALL_LIGHTS: u8 = 7 * FIRST_LIGHT;
/// A note of the steps to each other, which is zero in the end.
pub(super) const NOTE: u8 = 1 << 3;

/// The class of this byte.
#[must_use]
pub const fn class(byte: u8) -> u8 {
    byte & CLASS
}

/// The light that a pixel of two lights does not see, or that a pixel of one light sees, as an index.
pub(super) const fn single_light(byte: u8) -> usize {
    let seen = byte >> 4 & 7;
    let one = if seen.count_ones() == 2 { !seen & 7 } else { seen };
    one.trailing_zeros() as usize
}

/// The mean of the vectors around a pixel, up to `radius` away, that are known and of whose class byte `holds` says so.
#[inline]
pub(super) fn mean_around(
    vectors: &Vectors,
    classes: &Map<u8>,
    [x, y]: [usize; 2],
    radius: usize,
    holds: impl Fn(u8) -> bool,
) -> Option<Vector> {
    let (mut sum, mut count) = (ZERO, 0.0);
    let (first, last) = (x.saturating_sub(radius), x + radius + 1);
    for row in y.saturating_sub(radius)..=y + radius {
        let last = last.min(vectors.width);
        let bytes = classes.row(row).get(first..last).unwrap_or_default();
        let row = vectors.row(row).get(first..last).unwrap_or_default();
        for (&byte, &vector) in bytes.iter().zip(row) {
            let [first, ..] = vector;
            if holds(byte) && !first.is_nan() {
                sum = add(sum, 1.0, vector);
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| scale(sum, 1.0 / count))
}
