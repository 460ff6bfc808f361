//! Which pixels of a picture a method may use at all, and what becomes of the others.

use super::faces::Faces;
use super::image::Image;
use super::window::{Window, for_each_bit};

/// Which pixels of a picture a method may use at all: in the mask, finite, not black, not saturated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Usable {
    /// A pixel is saturated if any of its channels is at or above this.
    pub saturation: f32,
    /// Colors that a light does not reach.
    pub shadow_faces: Faces,
}

impl Usable {
    /// Pixels below this saturation, none of them left out as shaded.
    #[must_use]
    pub const fn below(saturation: f32) -> Self {
        Self { saturation, shadow_faces: Faces::NONE }
    }

    /// The bits of `window`'s usable pixels.
    #[must_use]
    pub fn bits(&self, window: &Window) -> u64 {
        self.shadow_faces.lit(window, self.exposed(window))
    }

    /// The bits of `window`'s pixels that are usable but for shadows.
    #[must_use]
    #[expect(clippy::needless_bitwise_bool, reason = "vector instructions do not branch")]
    #[inline(never)]
    pub fn exposed(&self, window: &Window) -> u64 {
        window.masked
            & window.bits(|r, g, b| {
                let brighter = if r > g { r } else { g };
                let largest = if brighter > b { brighter } else { b };
                // Zero times what is not finite is no number.
                let zero = 0.0 * r + 0.0 * g + 0.0 * b;
                (zero == 0.0) & (largest > 0.0) & (largest < self.saturation)
            })
    }

    /// Whether a pixel of this color, if it is in the mask, is usable: for those that are looked at one by one.
    pub(crate) fn accepts(&self, color: [f32; 3]) -> bool {
        color.iter().all(|value| value.is_finite() && *value < self.saturation)
            && color.iter().any(|&value| value > 0.0)
            && self.shadow_faces.is_lit(color)
    }

    /// Counts the pixels of a picture by what becomes of them.
    #[must_use]
    pub fn count(&self, image: &Image) -> PixelCounts {
        let mut pixel_counts = PixelCounts::default();
        image.for_each_window(|window| {
            self.count_window(window, &mut pixel_counts);
        });
        pixel_counts
    }

    /// Adds the pixels of one window to the counts, and returns the bits of the usable ones.
    pub fn count_window(&self, window: &Window, pixel_counts: &mut PixelCounts) -> u64 {
        let usable = self.bits(window);
        pixel_counts.usable += usable.count_ones() as usize;
        pixel_counts.masked_out += window.len - window.masked.count_ones() as usize;
        for_each_bit(window.masked & !usable, |i| {
            let [r, g, b] = window.pixel(i);
            let brightest = r.max(g).max(b);
            if !(r.is_finite() && g.is_finite() && b.is_finite()) {
                pixel_counts.non_finite += 1;
            } else if brightest <= 0.0 {
                pixel_counts.dark += 1;
            } else if brightest >= self.saturation {
                pixel_counts.saturated += 1;
            } else {
                pixel_counts.shaded += 1;
            }
        });
        let mut largest = pixel_counts.largest.to_bits();
        for_each_bit(usable, |i| {
            let [r, g, b] = window.pixel(i);
            // Finite floats without a sign are in the order of their bits.
            let [r, g, b] = [r.abs().to_bits(), g.abs().to_bits(), b.abs().to_bits()];
            largest = largest.max(r).max(g).max(b);
        });
        pixel_counts.largest = f32::from_bits(largest);
        usable
    }
}

/// What becomes of the pixels of a picture before any fit; the counts add up to all its pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelCounts {
    /// Pixels that a method may use.
    pub usable: usize,
    /// Left out by the mask.
    pub masked_out: usize,
    /// NaN or infinite in a channel.
    pub non_finite: usize,
    /// Zero (or negative) in all channels.
    pub dark: usize,
    /// At or above the saturation threshold in a channel.
    pub saturated: usize,
    /// In the shadow of one of the lights, see [`crate::color::shadows`].
    pub shaded: usize,
    /// The largest absolute channel value of the usable pixels.
    pub largest: f32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::picture::WINDOW;

    #[test]
    fn usable_is_what_the_comparisons_say() {
        let special =
            [0.0, -0.0, 1e-45, -1e-45, 1.0, -1.0, 254.9, 255.0, f32::MAX, f32::MIN, f32::NAN, -f32::NAN];
        let infinite =
            [f32::INFINITY, f32::NEG_INFINITY, f32::from_bits(0x7f80_0001), f32::from_bits(0xff80_0001)];
        let values: std::vec::Vec<f32> = special.into_iter().chain(infinite).collect();
        let mut rng = Rng::new(2);
        for saturation in [255.0, 1e-45, f32::MAX, f32::INFINITY, 0.0, -1.0, f32::NAN] {
            for _ in 0..200 {
                let mut window = Window::new();
                window.masked = rng.next_u64() | rng.next_u64();
                for channel in &mut window.color {
                    channel.fill_with(|| values[rng.below(values.len() as u32) as usize]);
                }
                let bits = Usable::below(saturation).bits(&window);
                for i in 0..WINDOW {
                    let color = window.pixel(i);
                    let expected = window.masked >> i & 1 == 1
                        && color.iter().all(|c| c.is_finite() && *c < saturation)
                        && color.iter().any(|&c| c > 0.0);
                    assert_eq!(bits >> i & 1 == 1, expected, "{color:?} below {saturation}");
                    let accepted = window.masked >> i & 1 == 1 && Usable::below(saturation).accepts(color);
                    assert_eq!(accepted, expected, "{color:?} below {saturation}");
                }
            }
        }
    }
}
