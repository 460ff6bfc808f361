//! Where a picture saturates below the largest value that its samples can have: twelve bits in sixteen, floats that were clipped
//! at 1, video that ends at 235.
//!
//! What is clipped piles up at one value, the largest there is. Colors of a surface do not: where a channel is brightest it varies
//! least, but then the other channels hardly vary either.

use super::image::Image;
use super::window::for_each_bit;
use libm::sqrt;

/// Pixels are near the largest value if they are within this share of it.
const NEAR: f32 = 0.03;
/// So many times as many pixels are at the largest value as near it: without clipping there are at most a few levels there, and
/// at the highest of them no more pixels than at all others together.
const PILE: f64 = 2.0;
/// Fewer pixels are no pile.
const LEAST: usize = 16;

/// A level at which the picture saturates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Saturation {
    /// The largest value of a channel; none is above.
    pub level: f32,
    /// How many pixels of the mask are at that value in a channel.
    pub pixels: usize,
}

/// Finds the level at which the picture saturates below the largest value of its sample type. `None` where nothing piles up, and
/// where the largest value of the type is reached, which is the level anyway.
#[must_use]
pub fn find(image: &Image) -> Option<Saturation> {
    let level = largest(image);
    if !(level > 0.0 && level < image.sample().saturation()) {
        return None;
    }
    let near = level * (1.0 - NEAR);
    let (mut pixels, mut several, mut below) = (0_usize, 0_usize, 0_usize);
    let (mut sum, mut squares) = (0.0, 0.0);
    image.for_each_window(|window| {
        for_each_bit(window.masked & window.bits(|r, g, b| r >= near || g >= near || b >= near), |i| {
            let color = window.pixel(i);
            if color.iter().any(|value| !value.is_finite()) {
                return;
            }
            match color.iter().filter(|&&value| value >= level).count() {
                0 => below += 1,
                1 => {
                    pixels += 1;
                    let others = color.iter().fold(0.0, |sum, &value| sum + f64::from(value / level)) - 1.0;
                    sum += others;
                    squares += others * others;
                }
                _ => several += 1,
            }
        });
    });
    // A flat surface has one color, and noise aside it is at its largest value everywhere.
    let count = pixels.max(1) as f64;
    let deviation = sqrt((squares / count - (sum / count) * (sum / count)).max(0.0));
    let clipped = several + if deviation > f64::from(NEAR) { pixels } else { 0 };
    let is_pile = clipped >= LEAST && clipped as f64 > PILE * below as f64;
    is_pile.then_some(Saturation { level, pixels: pixels + several })
}

/// The largest finite value of a channel in the mask; 0 where none is above.
fn largest(image: &Image) -> f32 {
    let mut largest = 0.0_f32;
    image.for_each_window(|window| {
        for_each_bit(window.masked, |i| {
            for value in window.pixel(i) {
                if value > largest && value < f32::INFINITY {
                    largest = value;
                }
            }
        });
    });
    largest
}

#[cfg(test)]
#[expect(clippy::cast_sign_loss, reason = "samples")]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::picture::{Order, Sample};
    use std::vec;
    use std::vec::Vec;

    /// A ball under three lights, of which `gain` of full scale is kept, clipped at `limit` of it.
    fn ball(gain: f64, limit: f64) -> Vec<[f64; 3]> {
        let mut rng = Rng::new(3);
        let mut pixels = Vec::new();
        for y in 0..60 {
            for x in 0..60 {
                let (u, v) = (f64::from(x) / 30.0 - 1.0, f64::from(y) / 30.0 - 1.0);
                let inside = u * u + v * v < 1.0;
                let n3 = (1.0 - u * u - v * v).max(0.0).sqrt();
                let shade = |a: f64, b: f64| (gain * (a * u + b * v + 0.8 * n3)).max(0.0);
                let color = [shade(0.6, 0.0), shade(-0.3, 0.5), shade(-0.3, -0.5)];
                let [first, second] = rng.normal_pair();
                let noise = [first, second, first];
                let noisy = core::array::from_fn(|c| (color[c] + 0.002 * noise[c]).clamp(0.0, limit));
                pixels.push(if inside { noisy } else { [0.0; 3] });
            }
        }
        pixels
    }

    fn found(pixels: &[[f64; 3]], sample: Sample, full: f64) -> Option<Saturation> {
        let bytes: Vec<u8> = pixels
            .iter()
            .flatten()
            .flat_map(|&share| match sample {
                Sample::U8 => Vec::from([(share * full).round() as u8]),
                Sample::U16 => Vec::from(((share * full).round() as u16).to_ne_bytes()),
                Sample::F32 => Vec::from(((share * full) as f32).to_ne_bytes()),
            })
            .collect();
        find(&Image::interleaved(&bytes, 60, 60, 180 * sample.bytes(), sample, Order::Rgb).unwrap())
    }

    #[test]
    fn a_pile_at_the_largest_value_is_a_level() {
        for (sample, full) in [(Sample::U8, 235.0), (Sample::U16, 4095.0), (Sample::F32, 1.0)] {
            for gain in [1.3, 2.0, 4.0] {
                let found = found(&ball(gain, 1.0), sample, full).expect("a level");
                assert_eq!(f64::from(found.level), full);
                assert!(found.pixels > 100);
            }
            for gain in [0.2, 0.7, 0.9] {
                assert_eq!(found(&ball(gain, 1.0), sample, full), None, "{sample:?} {gain}");
            }
        }
        assert_eq!(found(&ball(2.0, 1.0), Sample::U8, 255.0), None);
    }

    #[test]
    fn a_flat_surface_is_no_pile() {
        let flat = vec![[0.8, 0.5, 0.4]; 3600];
        assert_eq!(found(&flat, Sample::F32, 1.0), None);
        assert_eq!(found(&vec![[0.0; 3]; 3600], Sample::F32, 1.0), None);
    }
}
