//! Numbers that are written beside a picture: rows of as many for each pixel, in single precision.

use super::image::Image;
use super::layout::{ImageError, span};
use super::window::Window;

/// Calls `fill` with every window of the picture and the place of its pixels in the rows, `row_stride` numbers apart. What lies
/// between rows is left alone.
///
/// # Errors
/// What [`span`] refuses, and [`ImageError::TooShort`] where `out` ends before the last row; `out` is untouched then.
pub(crate) fn write<const N: usize>(
    image: &Image,
    out: &mut [f32],
    row_stride: usize,
    mut fill: impl FnMut(&Window, &mut [[f32; N]]),
) -> Result<(), ImageError> {
    if out.len() < span(image.width(), image.height(), N, row_stride)? {
        return Err(ImageError::TooShort);
    }
    image.for_each_window(|window| {
        let start = window.y * row_stride + window.x * N;
        let out = out.get_mut(start..start + window.len * N).unwrap_or_default();
        fill(window, out.as_chunks_mut::<N>().0);
    });
    Ok(())
}
