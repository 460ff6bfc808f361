//! The paint as a picture, and the picture without it.
//!
//! The albedo of a pixel is the length of the normal that C makes of its color, sqrt(rho^T C rho). Its logarithm is averaged over
//! a small neighborhood, twice over a square, so that what is left of a pixel's own length still says whether it obeys the model:
//! a pixel that is divided by its own length passes every test for shadows and highlights.

use crate::color::ellipsoid::{Coefficients, quadratic_form};
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{self, Image, Usable, for_each_bit, span};
use core::fmt;
use libm::{expf, logf};

/// Half the side of the square is the root of the number of usable pixels divided by this. By trial: with wider squares the paint
/// is still in the picture, narrower ones take shadows for paint.
const SHARE_OF_SIZE: usize = 64;
/// Lengths are at least this share of the median one before their logarithm is taken.
const SHORTEST: f64 = 1e-6;

/// Why there is no albedo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlbedoError {
    /// An albedo or output is too short, or its rows are.
    Rows,
    /// The workspace is shorter than [`workspace_len`].
    WorkspaceTooShort,
    /// There is no usable pixel.
    TooFewPixels,
}

impl fmt::Display for AlbedoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rows => "an albedo or output is too short, or its rows are",
            Self::WorkspaceTooShort => "the workspace is too short",
            Self::TooFewPixels => "no usable pixel",
        })
    }
}

impl core::error::Error for AlbedoError {}

/// How many `f32` of workspace [`albedo`] takes: two a pixel, and two lines.
#[must_use]
pub const fn workspace_len(width: usize, height: usize) -> usize {
    let longest = if width > height { width } else { height };
    width.saturating_mul(height).saturating_add(longest).saturating_mul(2)
}

/// Writes the albedo of every usable pixel, with the median 1, and NaN for every other. `form` is C up to its scale.
///
/// # Shape
/// `out` is height rows of width `f32`, rows `row_stride` `f32` apart; what lies between rows is left alone.
///
/// # Errors
/// See [`AlbedoError`]; `out` is untouched then.
///
/// # Scratch
/// [`workspace_len`] `f32`.
pub fn albedo(
    image: &Image,
    usable: Usable,
    form: &Coefficients,
    out: &mut [f32],
    row_stride: usize,
    workspace: &mut [f32],
) -> Result<(), AlbedoError> {
    let (width, height) = (image.width(), image.height());
    fits(out, image, row_stride)?;
    let workspace =
        workspace.get_mut(..workspace_len(width, height)).ok_or(AlbedoError::WorkspaceTooShort)?;
    let (logarithms, rest) = workspace.split_at_mut_checked(width * height).unwrap_or_default();
    let (weights, lines) = rest.split_at_mut_checked(width * height).unwrap_or_default();
    let count = read(image, usable, form, logarithms, weights);
    if count == 0 {
        return Err(AlbedoError::TooFewPixels);
    }
    let radius = (count.isqrt() / SHARE_OF_SIZE).max(1);
    for plane in [&mut *logarithms, &mut *weights] {
        for row in 0..height {
            sum_twice(plane, Line { start: row * width, step: 1, len: width }, lines, radius);
        }
        for column in 0..width {
            sum_twice(plane, Line { start: column, step: width, len: height }, lines, radius);
        }
    }
    for (logarithm, weight) in logarithms.iter_mut().zip(&*weights) {
        *logarithm /= weight.max(f32::MIN_POSITIVE);
    }
    let mut number = 0;
    image.for_each_window(|window| {
        let own = logarithms.get(window.y * width + window.x..).unwrap_or_default();
        for_each_bit(usable.bits(window), |i| {
            if let (Some(slot), Some(&logarithm)) = (weights.get_mut(number), own.get(i)) {
                *slot = logarithm;
                number += 1;
            }
        });
    });
    let all = weights.get(..count).unwrap_or_default();
    let median = kth_smallest(all, median_rank(count)).unwrap_or(0.0);
    image.for_each_window(|window| {
        let bits = usable.bits(window);
        let own = logarithms.get(window.y * width + window.x..).unwrap_or_default();
        let out = out.get_mut(window.y * row_stride + window.x..).unwrap_or_default();
        for (i, (slot, &logarithm)) in out.iter_mut().zip(own).take(window.len).enumerate() {
            *slot = if bits >> i & 1 == 1 { expf(logarithm - median) } else { f32::NAN };
        }
    });
    Ok(())
}

/// The logarithm of the albedo of every usable pixel and the weight 1, zeros elsewhere; how many are usable.
fn read(
    image: &Image,
    usable: Usable,
    form: &Coefficients,
    logarithms: &mut [f32],
    weights: &mut [f32],
) -> usize {
    logarithms.fill(0.0);
    weights.fill(0.0);
    let mut count = 0;
    image.for_each_window(|window| {
        let start = window.y * image.width() + window.x;
        for_each_bit(usable.bits(window), |i| {
            let [r, g, b] = window.pixel(i);
            // A square that is too large for a float is the largest one.
            let square = quadratic_form(form, r, g, b).max(SHORTEST * SHORTEST).min(f64::from(f32::MAX));
            if let (Some(logarithm), Some(weight)) =
                (logarithms.get_mut(start + i), weights.get_mut(start + i))
            {
                *logarithm = 0.5 * logf(square as f32);
                *weight = 1.0;
                count += 1;
            }
        });
    });
    count
}

/// A row or a column of a plane.
#[derive(Clone, Copy)]
struct Line {
    start: usize,
    step: usize,
    len: usize,
}

/// Takes the sum over 2 `radius` + 1 neighbors twice along a line of `plane`, with zeros beyond its ends. `scratch` has room for two
/// lines.
fn sum_twice(plane: &mut [f32], Line { start, step, len }: Line, scratch: &mut [f32], radius: usize) {
    let Some((line, rest)) = scratch.split_at_mut_checked(len) else { return };
    let sums = rest.get_mut(..len).unwrap_or_default();
    for (i, slot) in line.iter_mut().enumerate() {
        *slot = plane.get(start + i * step).copied().unwrap_or(0.0);
    }
    sum(line, radius, |i, sum| {
        if let Some(slot) = sums.get_mut(i) {
            *slot = sum;
        }
    });
    sum(sums, radius, |i, sum| {
        if let Some(slot) = plane.get_mut(start + i * step) {
            *slot = sum;
        }
    });
}

/// The sums over 2 `radius` + 1 neighbors, with zeros beyond the ends.
fn sum(line: &[f32], radius: usize, mut put: impl FnMut(usize, f32)) {
    let at =
        |place: Option<usize>| place.and_then(|place| line.get(place)).map_or(0.0, |&value| f64::from(value));
    let mut sum: f64 = line.iter().take(radius).map(|&value| f64::from(value)).sum();
    for i in 0..line.len() {
        sum += at(i.checked_add(radius)) - at(i.checked_sub(radius + 1));
        put(i, sum as f32);
    }
}

/// Writes the picture divided by the albedo as r, g, b: as if its paint were even. NaN where a pixel is not usable, its albedo is
/// not above zero, or the quotient is too large for a float; returns how many pixels have a value.
///
/// # Shape
/// `albedo` is height rows of width `f32`, rows `albedo_stride` `f32` apart, and `pixels` height rows of width times three `f32`,
/// rows `row_stride` `f32` apart; what lies between rows is left alone.
///
/// # Errors
/// [`AlbedoError::Rows`]; `pixels` is untouched then.
pub fn divide(
    image: &Image,
    usable: Usable,
    albedo: &[f32],
    albedo_stride: usize,
    pixels: &mut [f32],
    row_stride: usize,
) -> Result<usize, AlbedoError> {
    fits(albedo, image, albedo_stride)?;
    let mut count = 0;
    let written = picture::rows::write(image, pixels, row_stride, |window, out| {
        let bits = usable.bits(window);
        let own = albedo.get(window.y * albedo_stride + window.x..).unwrap_or_default();
        for (i, (&albedo, slot)) in own.iter().zip(out).enumerate() {
            let even = window.pixel(i).map(|value| value / albedo);
            let is_finite = albedo.is_finite() && even.iter().all(|value| value.is_finite());
            let has_value = bits >> i & 1 == 1 && albedo > 0.0 && is_finite;
            count += usize::from(has_value);
            *slot = if has_value { even } else { [f32::NAN; 3] };
        }
    });
    written.map_err(|_| AlbedoError::Rows)?;
    Ok(count)
}

/// Whether rows of a number a pixel fit.
fn fits(rows: &[f32], image: &Image, stride: usize) -> Result<(), AlbedoError> {
    let need = span(image.width(), image.height(), 1, stride);
    if need.is_ok_and(|need| rows.len() >= need) { Ok(()) } else { Err(AlbedoError::Rows) }
}
