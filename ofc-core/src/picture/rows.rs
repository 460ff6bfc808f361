//! Colors that are written beside a picture: rows of r, g, b as single-precision numbers.

use super::image::Image;
use super::layout::{ImageError, span};
use super::window::Window;

/// Calls `fill` with every window of the picture and the place of its pixels in the rows, `row_stride` numbers apart. What lies
/// between rows is left alone.
///
/// # Errors
/// What [`span`] refuses, and [`ImageError::TooShort`] where `pixels` ends before the last row; `pixels` is untouched then.
pub(super) fn write(
    image: &Image,
    pixels: &mut [f32],
    row_stride: usize,
    mut fill: impl FnMut(&Window, &mut [[f32; 3]]),
) -> Result<(), ImageError> {
    if pixels.len() < span(image.width(), image.height(), 3, row_stride)? {
        return Err(ImageError::TooShort);
    }
    image.for_each_window(|window| {
        let start = window.y * row_stride + window.x * 3;
        let out = pixels.get_mut(start..start + window.len * 3).unwrap_or_default();
        fill(window, out.as_chunks_mut::<3>().0);
    });
    Ok(())
}
