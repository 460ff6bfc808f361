//! Flat-fielding: a picture divided by a picture of the same flat, uniform surface without the object.
//!
//! Near lights fall off across the field, each channel's in its own way, so that F changes from place to place. A flat surface
//! shows by how much: divided by it, and scaled by its mean, the picture is as under distant lights.

use super::rows;
use crate::picture::{Image, Window};
use core::fmt;

/// A background pixel is dark, and says nothing, if a channel is below this share of the channel's mean.
pub const DARK_SHARE: f64 = 0.05;

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlatField {
    /// The mean of each channel of the background, that the quotients are scaled by.
    pub mean: [f64; 3],
    /// Pixels that have a value.
    pub used: usize,
    /// Pixels left out because the background is dark or not finite there.
    pub dark: usize,
    /// Pixels left out because the background, or else the picture, is saturated there.
    pub saturated: usize,
}

/// Why nothing was divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlatFieldError {
    /// The background has another size.
    Size,
    /// The output is too short, or its rows are.
    Output,
    /// Every pixel of the background is dark, saturated or masked out, or a channel of it is black.
    Background,
}

impl fmt::Display for FlatFieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Size => "the background has another size",
            Self::Output => "the output is too short, or its rows are",
            Self::Background => {
                "every pixel of the background is dark, saturated or masked out, or a channel of it is black"
            }
        })
    }
}

impl core::error::Error for FlatFieldError {}

/// Writes the divided picture as r, g, b, in the picture's own pixel values; NaN where the background, or the picture by
/// being saturated, says nothing. Pixels that are not finite stay so. Both views may have masks: pixels outside the background's
/// mask count for nothing, and pixels outside the picture's mask have values all the same.
///
/// # Shape
/// `pixels` is height rows of width times three `f32`, rows `row_stride` `f32` apart; what lies between rows is left alone.
///
/// # Errors
/// See [`FlatFieldError`]; `pixels` is untouched then.
///
/// # Example
/// ```
/// use ofc_core::picture::flat_field::divide;
/// use ofc_core::{Image, Order, Sample};
///
/// // Light that falls off to the right, on a plane and on the same plane a tenth darker.
/// let plane: Vec<u8> = (0..8 * 8).flat_map(|i| [200 - 10 * (i % 8) as u8; 3]).collect();
/// let darker: Vec<u8> = plane.iter().map(|&v| v / 10 * 9).collect();
/// let view = |bytes| Image::interleaved(bytes, 8, 8, 24, Sample::U8, Order::Rgb).unwrap();
/// let mut even = [0.0; 3 * 8 * 8];
/// let done = divide(&view(&darker), &view(&plane), &mut even, 24).unwrap();
/// assert!(even.iter().all(|&v| (f64::from(v) / done.mean[0] - 0.9).abs() < 1e-6));
/// ```
pub fn divide(
    image: &Image,
    background: &Image,
    pixels: &mut [f32],
    row_stride: usize,
) -> Result<FlatField, FlatFieldError> {
    if [image.width(), image.height()] != [background.width(), background.height()] {
        return Err(FlatFieldError::Size);
    }
    let limits = [image.sample().saturation(), background.sample().saturation()];
    let mut result = FlatField { mean: mean(background, limits[1])?, ..FlatField::default() };
    let darkest = result.mean.map(|mean| (DARK_SHARE * mean) as f32);
    let scale = result.mean.map(|mean| mean as f32);
    let mut flat = Window::new();
    let written = rows::write(image, pixels, row_stride, |window, out| {
        background.read(window.x, window.y, &mut flat);
        for (i, slot) in out.iter_mut().enumerate() {
            let (color, below) = (window.pixel(i), flat.pixel(i));
            let is_seen = flat.masked >> i & 1 == 1;
            *slot = [f32::NAN; 3];
            if !is_seen || below.iter().zip(darkest).any(|(&b, darkest)| !(b >= darkest && b.is_finite())) {
                result.dark += 1;
            } else if below.iter().any(|&b| b >= limits[1]) || color.iter().any(|&c| c >= limits[0]) {
                result.saturated += 1;
            } else {
                for (((slot, c), b), mean) in slot.iter_mut().zip(color).zip(below).zip(scale) {
                    *slot = if c.is_finite() { (c / b * mean).clamp(-f32::MAX, f32::MAX) } else { f32::NAN };
                }
                result.used += 1;
            }
        }
    });
    written.map_or(Err(FlatFieldError::Output), |()| Ok(result))
}

/// The mean of each channel over the pixels of the background that are finite and not saturated.
fn mean(background: &Image, limit: f32) -> Result<[f64; 3], FlatFieldError> {
    let (mut sums, mut count) = ([0.0; 3], 0_u64);
    background.for_each_window(|window| {
        for i in 0..window.len {
            let color = window.pixel(i);
            let is_seen = window.masked >> i & 1 == 1;
            if is_seen && color.iter().all(|&c| c.is_finite() && c >= 0.0 && c < limit) {
                for (sum, value) in sums.iter_mut().zip(color) {
                    *sum += f64::from(value);
                }
                count += 1;
            }
        }
    });
    let mean = sums.map(|sum| sum / count.max(1) as f64);
    let is_lit = mean.iter().all(|&mean| mean > 0.0 && mean <= f64::from(f32::MAX));
    if is_lit { Ok(mean) } else { Err(FlatFieldError::Background) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Order, Sample};
    use std::vec::Vec;

    fn view(pixels: &[u8]) -> Image<'_> {
        Image::interleaved(pixels, 4, 2, 12, Sample::U8, Order::Rgb).unwrap()
    }

    #[test]
    fn a_picture_times_its_field_is_flat_again() {
        let field = [10_u8, 20, 30, 40, 50, 60, 70, 80];
        let background: Vec<u8> = field.iter().flat_map(|&f| [f, f / 2, f * 2]).collect();
        let picture: Vec<u8> = field.iter().flat_map(|&f| [f, f / 2, f * 2]).collect();
        let mut out = [7.0; 30];
        let found = divide(&view(&picture), &view(&background), &mut out, 15).unwrap();
        assert_eq!(found, FlatField { mean: [45.0, 22.5, 90.0], used: 8, dark: 0, saturated: 0 });
        for row in out.chunks(15) {
            for pixel in row[..12].as_chunks::<3>().0 {
                assert_eq!(*pixel, [45.0, 22.5, 90.0]);
            }
            assert_eq!(row[12..], [7.0; 3]);
        }
    }

    #[test]
    fn what_the_background_does_not_show_is_left_out_and_counted() {
        let mut background = [100_u8; 24];
        let mut picture = [50_u8; 24];
        background[0] = 1;
        background[4] = 255;
        picture[8] = 255;
        let mut out = [7.0; 24];
        let found = divide(&view(&picture), &view(&background), &mut out, 12).unwrap();
        assert_eq!((found.used, found.dark, found.saturated), (5, 1, 2));
        assert!(out[..9].iter().all(|v| v.is_nan()) && out[9..].iter().all(|v| v.is_finite()));
    }

    #[test]
    fn bad_input_is_refused() {
        let (black, gray) = ([0_u8; 24], [100_u8; 24]);
        let mut out = [7.0; 24];
        assert_eq!(divide(&view(&gray), &view(&black), &mut out, 12), Err(FlatFieldError::Background));
        assert_eq!(divide(&view(&gray), &view(&gray), &mut out[..23], 12), Err(FlatFieldError::Output));
        assert_eq!(divide(&view(&gray), &view(&gray), &mut out, 11), Err(FlatFieldError::Output));
        assert_eq!(divide(&view(&gray), &view(&gray), &mut out, usize::MAX), Err(FlatFieldError::Output));
        let other = Image::interleaved(&gray, 2, 4, 6, Sample::U8, Order::Rgb).unwrap();
        assert_eq!(divide(&view(&gray), &other, &mut out, 12), Err(FlatFieldError::Size));
        assert_eq!(out, [7.0; 24]);
    }
}
