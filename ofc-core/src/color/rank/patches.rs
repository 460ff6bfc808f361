//! The class of every small square of a picture: the ranks of its light and of its surface.

use super::class::Class;
use super::colors::{Colors, noise_of_residuals};
use super::conic::Conic;
use super::{COLOR_THRESHOLD, CONIC_THRESHOLD, CONSTANT_THRESHOLD, dimensions};
use crate::picture::{Image, Pixels, Sample, Usable, WINDOW, Window, first_bits};
use core::fmt;

/// Sides of patches, in pixels.
pub const MIN_SIDE: usize = 3;
/// The largest side: a patch is read a row of one window at a time.
pub const MAX_SIDE: usize = WINDOW;

/// A parameter is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused;

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a parameter is out of its range")
    }
}

impl core::error::Error for Refused {}

/// Patches in a row and in a column of a picture.
#[must_use]
pub const fn shape(width: usize, height: usize, side: usize) -> [usize; 2] {
    if side == 0 { [0, 0] } else { [width.div_ceil(side), height.div_ceil(side)] }
}

/// The class of every `side` x `side` patch of `image`, [`shape`] of them, top row first; [`Class::default`], which says nothing, of
/// one with fewer than half of its pixels usable. The patches at the right and lower edges may be smaller.
///
/// `noise` is the deviation of a channel, in pixel values: [`Rank::color_noise`](super::Rank::color_noise) where there is one.
/// Colors and their brightness vary where they do so by more than noise explains, as for the [`rank`](super::rank) of a whole
/// picture. The larger the patches, the less a surface must bend for it to be seen.
///
/// # Errors
/// [`Refused`] for a side outside [`MIN_SIDE`] to [`MAX_SIDE`] and a noise that is not positive.
pub fn patches<'p>(
    image: &'p Image,
    usable: Usable,
    side: usize,
    noise: f64,
) -> Result<impl Iterator<Item = Class> + 'p, Refused> {
    let in_range = (MIN_SIDE..=MAX_SIDE).contains(&side) && noise > 0.0 && noise.is_finite();
    if !in_range {
        return Err(Refused);
    }
    let [across, down] = shape(image.width(), image.height(), side);
    let corners = (0..down).flat_map(move |row| (0..across).map(move |column| [column * side, row * side]));
    Ok(corners.map(move |corner| Patch { image, corner, side }.class(usable, noise)))
}

/// One square of a picture.
struct Patch<'a, 'p> {
    image: &'a Image<'p>,
    /// Column and row of its top left pixel.
    corner: [usize; 2],
    side: usize,
}

impl Patch<'_, '_> {
    fn class(&self, usable: Usable, noise: f64) -> Class {
        let (mut count, mut all) = (0, 0);
        self.for_each_window(|window| {
            count += usable.bits(window).count_ones() as usize;
            all += window.len;
        });
        let inliers = |window: &Window| usable.bits(window);
        match Colors::of(self, inliers) {
            Some(colors) if 2 * count >= all => {
                let dimensions = dimensions(colors.deviations(), COLOR_THRESHOLD * noise);
                Class::of(dimensions, self.normals(&colors, dimensions, inliers, noise))
            }
            _ => Class::default(),
        }
    }

    /// How many dimensions normals span that make colors of so many; `None` where these do not say.
    fn normals(
        &self,
        colors: &Colors,
        dimensions: u32,
        inliers: impl Fn(&Window) -> u64,
        noise: f64,
    ) -> Option<u32> {
        match dimensions {
            3 => Some(3),
            2 => {
                let conic = Conic::of(self, inliers, colors)?;
                let explained = noise_of_residuals(&conic.c, &colors.moments, conic.residual_deviation);
                Some(if explained > CONIC_THRESHOLD * noise { 3 } else { 2 })
            }
            _ => (colors.spread() <= CONSTANT_THRESHOLD * noise).then_some(1),
        }
    }
}

impl Pixels for Patch<'_, '_> {
    fn for_each_window(&self, mut visit: impl FnMut(&Window)) {
        let [x, y] = self.corner;
        let mut window = Window::new();
        for y in y..(y + self.side).min(self.image.height()) {
            self.image.read(x, y, &mut window);
            window.len = window.len.min(self.side);
            window.masked &= first_bits(self.side);
            visit(&window);
        }
    }

    fn sample(&self) -> Sample {
        self.image.sample()
    }

    fn len(&self) -> usize {
        let [x, y] = self.corner;
        let along = |from: usize, size: usize| self.side.min(size.saturating_sub(from));
        along(x, self.image.width()) * along(y, self.image.height())
    }
}
