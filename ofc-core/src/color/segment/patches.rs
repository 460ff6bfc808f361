//! The rank of the colors of every small square of a picture.
//!
//! By \[13\] a patch has rank-3 colors where surface and lights both have rank 3, and rank 2 or 1 where either has: on
//! cylinders, on planes, in the light of two lamps or one. Which of the two it is, a patch alone does not say for rank 1;
//! `rank` over a whole region says more.
//!
//! # Reference
//! Section 1.2. \[13\]: A. P. Petrov, L. L. Kontsevich, "Properties of color images of surfaces under multiple illuminants",
//! J. Opt. Soc. Am. A 11, 1994.

use crate::color::ellipsoid;
use crate::math::mat3;
use crate::picture::{Image, Usable, WINDOW, Window, first_bits, for_each_bit};
use core::fmt;
use libm::sqrt;

/// Sides of patches, in pixels.
pub const MIN_SIDE: usize = 3;
/// The largest side: a patch is read a row of one window at a time.
pub const MAX_SIDE: usize = WINDOW;

/// A parameter is out of its range, or the output is too short.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused;

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a parameter is out of its range, or the output is too short")
    }
}

impl core::error::Error for Refused {}

/// Patches in a row and in a column of a picture.
#[must_use]
pub const fn shape(width: usize, height: usize, side: usize) -> [usize; 2] {
    if side == 0 { [0, 0] } else { [width.div_ceil(side), height.div_ceil(side)] }
}

/// Writes the rank, 1 to 3, of every `side` x `side` patch, or 0 for one with fewer than half of its pixels usable. A
/// direction counts where the root mean square of the colors along it is above 1.5 times `noise`, the deviation of a
/// channel, in pixel values: `Rank::color_noise` where there is one.
///
/// # Shape
/// `ranks` has [`shape`] entries, top row first. The patches at the right and lower edges may be smaller.
///
/// # Errors
/// [`Refused`] for a side outside [`MIN_SIDE`] to [`MAX_SIDE`], a noise that is not positive, too few `ranks`.
pub fn patches(
    image: &Image,
    usable: Usable,
    side: usize,
    noise: f64,
    ranks: &mut [u8],
) -> Result<(), Refused> {
    let [across, down] = shape(image.width(), image.height(), side);
    let in_range = (MIN_SIDE..=MAX_SIDE).contains(&side) && noise > 0.0 && noise.is_finite();
    let ranks = ranks.get_mut(..across * down).ok_or(Refused)?;
    if !in_range {
        return Err(Refused);
    }
    let mut window = Window::new();
    for (index, slot) in ranks.iter_mut().enumerate() {
        let column = index.checked_rem(across).unwrap_or(0) * side;
        let row = index.checked_div(across).unwrap_or(0) * side;
        let (mut sums, mut count, mut total) = ([0.0; 6], 0, 0);
        for y in row..row + side {
            image.read(column, y, &mut window);
            let own = first_bits(side);
            let bits = usable.bits(&window) & own;
            for_each_bit(bits, |i| {
                let [r, g, b] = window.pixel(i).map(f64::from);
                for (sum, value) in sums.iter_mut().zip([r * r, g * g, b * b, r * g, r * b, g * b]) {
                    *sum += value;
                }
            });
            count += bits.count_ones();
            total += window.len.min(side) as u32;
        }
        *slot = if count * 2 < total || count == 0 {
            0
        } else {
            let moments = ellipsoid::matrix(&sums.map(|sum| sum / f64::from(count)));
            let deviations = mat3::symmetric_eigen(&moments).values.map(|square| sqrt(square.max(0.0)));
            let thick = deviations.iter().filter(|&&deviation| deviation > 1.5 * noise).count();
            (thick as u8).max(1)
        };
    }
    Ok(())
}
