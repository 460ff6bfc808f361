//! Numbers of every inlier, written into the caller's rows.

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
