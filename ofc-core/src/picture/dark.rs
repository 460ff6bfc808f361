//! Light that is not ours: what a picture holds beside the light of the model is subtracted, whether it is one color for all pixels
//! or a picture with the lights off.

use super::image::Image;
use super::layout::ImageError;
use super::rows;
use super::window::Window;
use core::fmt;

/// Why nothing was subtracted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DarkError {
    /// The dark frame has another size or stores its samples in another way.
    Frame,
    /// An offset is not finite.
    Offset,
    /// The rows of the output are too short.
    Output(ImageError),
}

impl fmt::Display for DarkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frame => f.write_str("the dark frame has another size or another type of samples"),
            Self::Offset => f.write_str("an offset is not finite"),
            Self::Output(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for DarkError {}

impl From<ImageError> for DarkError {
    fn from(error: ImageError) -> Self {
        Self::Output(error)
    }
}

/// Writes the picture less one color. A pixel that is saturated in a channel keeps its color, and so stays saturated; samples that
/// are not finite become NaN. The mask is not looked at.
///
/// # Shape
/// `pixels` is height rows of width times three `f32`, rows `row_stride` `f32` apart; what lies between rows is left alone.
///
/// # Errors
/// See [`DarkError`]; `pixels` is untouched then.
pub fn subtract_offset(
    image: &Image,
    offset: [f64; 3],
    pixels: &mut [f32],
    row_stride: usize,
) -> Result<(), DarkError> {
    if !offset.iter().all(|value| value.is_finite()) {
        return Err(DarkError::Offset);
    }
    let limit = image.sample().saturation();
    let offset = offset.map(|value| value as f32);
    rows::write(image, pixels, row_stride, |window, out| {
        for (i, slot) in out.iter_mut().enumerate() {
            *slot = difference(window.pixel(i), offset, limit);
        }
    })?;
    Ok(())
}

/// Writes the picture less a picture of the same scene without its lights. A pixel that is saturated in a channel of either keeps
/// the color of the picture, or full scale where only the dark frame is saturated; samples that are not finite in either become NaN.
/// Masks are not looked at.
///
/// # Shape
/// As [`subtract_offset`].
///
/// # Errors
/// See [`DarkError`]; `pixels` is untouched then.
pub fn subtract_frame(
    image: &Image,
    dark: &Image,
    pixels: &mut [f32],
    row_stride: usize,
) -> Result<(), DarkError> {
    let described = |image: &Image| (image.width(), image.height(), image.sample());
    if described(image) != described(dark) {
        return Err(DarkError::Frame);
    }
    let limit = image.sample().saturation();
    let mut below = Window::new();
    rows::write(image, pixels, row_stride, |window, out| {
        dark.read(window.x, window.y, &mut below);
        for (i, slot) in out.iter_mut().enumerate() {
            let dark = below.pixel(i);
            *slot = if dark.iter().any(|&value| value >= limit && value.is_finite()) {
                [limit; 3]
            } else {
                difference(window.pixel(i), dark, limit)
            };
        }
    })?;
    Ok(())
}

fn difference(color: [f32; 3], dark: [f32; 3], limit: f32) -> [f32; 3] {
    let is_saturated = color.iter().any(|&value| value >= limit && value.is_finite());
    let mut left = color;
    for (value, dark) in left.iter_mut().zip(dark) {
        let less = if is_saturated { *value } else { *value - dark };
        *value = if less.is_finite() { less } else { f32::NAN };
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Order, Sample};

    #[test]
    fn what_is_saturated_stays_so_and_the_rest_is_less() {
        let (picture, dark) = ([90, 80, 70, 255, 9, 8, 40, 50, 60], [10, 20, 80, 1, 1, 1, 0, 255, 0]);
        let view = |bytes| Image::interleaved(bytes, 3, 1, 9, Sample::U8, Order::Rgb).unwrap();
        let mut out = [7.0; 9];
        subtract_offset(&view(&picture), [1.5, 0.0, -2.0], &mut out, 9).unwrap();
        assert_eq!(out, [88.5, 80.0, 72.0, 255.0, 9.0, 8.0, 38.5, 50.0, 62.0]);
        subtract_frame(&view(&picture), &view(&dark), &mut out, 9).unwrap();
        assert_eq!(out, [80.0, 60.0, -10.0, 255.0, 9.0, 8.0, 255.0, 255.0, 255.0]);
        let small = Image::interleaved(&dark, 1, 3, 3, Sample::U8, Order::Rgb).unwrap();
        assert_eq!(subtract_frame(&view(&picture), &small, &mut out, 9), Err(DarkError::Frame));
        let bad = [0.0, f64::NAN, 0.0];
        assert_eq!(subtract_offset(&view(&picture), bad, &mut out, 9), Err(DarkError::Offset));
        let short = Err(DarkError::Output(ImageError::TooShort));
        assert_eq!(subtract_offset(&view(&picture), [0.0; 3], &mut out[..8], 9), short);
    }
}
