//! Numbers of every inlier, written into the caller's rows.

use crate::math::parallel::{Parallel, for_each_chunk, rows_of_part};
use crate::picture::{self, Image, Window, for_each_bit};
use core::fmt;

/// The output buffer ends before the last row, or its rows are shorter than those of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooShort;

impl fmt::Display for TooShort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the output buffer ends before the last row")
    }
}

impl core::error::Error for TooShort {}

/// Writes the `N` numbers that `value` makes of the color of every inlier, and `nothing` everywhere else.
///
/// # Shape
/// `out` is height rows of width times `N`, rows `row_stride` `f32` apart, row 0 at the top; what lies between rows is left alone.
///
/// # Errors
/// [`TooShort`]; nothing is written then.
pub(super) fn write<const N: usize>(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    value: impl Fn([f32; 3]) -> [f32; N],
    nothing: f32,
    out: &mut [f32],
    row_stride: usize,
) -> Result<(), TooShort> {
    let none = |_: &Window, bits, out: &mut [[f32; N]]| {
        out.fill([nothing; N]);
        bits
    };
    write_windows(image, inliers, none, value, out, row_stride)
}

/// [`write`], where `many` writes the numbers of a window, given the bits of its inliers, and returns the bits of those that it
/// leaves to `value`.
///
/// # Errors
/// [`TooShort`]; nothing is written then.
pub(super) fn write_windows<const N: usize>(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    many: impl Fn(&Window, u64, &mut [[f32; N]]) -> u64,
    value: impl Fn([f32; 3]) -> [f32; N],
    out: &mut [f32],
    row_stride: usize,
) -> Result<(), TooShort> {
    let written = picture::rows::write(image, out, row_stride, |window, out| {
        for_each_bit(many(window, inliers(window), out), |i| {
            if let Some(slot) = out.get_mut(i) {
                *slot = value(window.pixel(i));
            }
        });
    });
    written.map_err(|_| TooShort)
}

/// Parts with fewer pixels than this are not worth a thread's waking up.
const PIXELS_OF_PART: usize = 1 << 12;

/// [`write_windows`], some rows at a time. No number depends on which those are.
///
/// # Errors
/// [`TooShort`]; nothing is written then.
pub(super) fn write_in_parts<const N: usize>(
    image: &Image,
    inliers: impl Fn(&Window) -> u64 + Sync,
    many: impl Fn(&Window, u64, &mut [[f32; N]]) -> u64 + Sync,
    value: impl Fn([f32; 3]) -> [f32; N] + Sync + Copy,
    out: &mut [f32],
    row_stride: usize,
    parallel: &impl Parallel,
) -> Result<(), TooShort> {
    let (width, height) = (image.width(), image.height());
    let need = picture::span(width, height, N, row_stride).map_err(|_| TooShort)?;
    let out = out.get_mut(..need).ok_or(TooShort)?;
    let rows = rows_of_part(height, PIXELS_OF_PART.div_ceil(width.max(1)));
    for_each_chunk(parallel, out, rows.saturating_mul(row_stride), |part, out| {
        let y = part * rows;
        if let Some(image) = image.crop([0, y], [width, rows.min(height - y)]) {
            // Long enough: it has been cut so.
            let _ = write_windows(&image, &inliers, &many, value, out, row_stride);
        }
    });
    Ok(())
}

/// [`write_in_parts`] of the numbers that [`write`] writes.
///
/// # Errors
/// [`TooShort`]; nothing is written then.
pub(super) fn write_each_in_parts<const N: usize>(
    image: &Image,
    inliers: impl Fn(&Window) -> u64 + Sync,
    value: impl Fn([f32; 3]) -> [f32; N] + Sync + Copy,
    nothing: f32,
    out: &mut [f32],
    row_stride: usize,
    parallel: &impl Parallel,
) -> Result<(), TooShort> {
    let none = |_: &Window, bits, out: &mut [[f32; N]]| {
        out.fill([nothing; N]);
        bits
    };
    write_in_parts(image, inliers, none, value, out, row_stride, parallel)
}
