//! Chojnacki, Brooks and Gibbins' tilt: Pentland's over a disc without shadows.
//!
//! Means of differences are decided by the border of the pixels they are taken over (they telescope). A disc's border
//! favors no direction, so on a sphere, or any surface whose normals are spread evenly about the disc's middle one,
//! the mean gradient points to the light exactly.
//!
//! # Reference
//! Section 3.1: "which uses a shadow-free circular subregion of the image". W. Chojnacki, M. J. Brooks, D. Gibbins,
//! "Revisiting Pentland's estimator of light source direction", J. Opt. Soc. Am. A 11, 1994, for the validity of
//! eq. 21. How to choose the disc is not said in Drew's paper; the largest one inside the inliers is our choice.

use super::lee_rosenfeld;
use crate::picture::{Image, Window, for_each_bit};

/// A disc of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Disc {
    /// Column of the middle pixel.
    pub x: usize,
    /// Row of the middle pixel.
    pub y: usize,
    /// The disc's pixels are less than the root of this many pixels away from the middle one.
    pub radius_squared: u64,
}

impl Disc {
    /// The bits of `window`'s pixels in the disc.
    #[must_use]
    pub fn bits(&self, window: &Window) -> u64 {
        let square = |distance: usize| (distance as u64).saturating_mul(distance as u64);
        let across = square(window.y.abs_diff(self.y));
        let mut bits = 0;
        for i in 0..window.len {
            let distance = across.saturating_add(square((window.x + i).abs_diff(self.x)));
            bits |= u64::from(distance < self.radius_squared) << i;
        }
        bits
    }
}

/// The tilts of the three channels' lights in (-pi, pi], counter-clockwise from x, for a convex surface, from the inliers
/// inside `disc`, by eq. 21 with the axes for directions.
///
/// `None` when the disc holds no pair of neighboring inliers in a row or a column, or a channel's mean gradient is
/// zero.
pub fn tilts(image: &Image, inliers: impl Fn(&Window) -> u64, disc: &Disc) -> Option<[f64; 3]> {
    lee_rosenfeld::tilts(image, |window| {
        let bits = disc.bits(window);
        if bits == 0 { 0 } else { bits & inliers(window) }
    })
}

/// How many `f32` [`largest_disc`] needs for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize) -> usize {
    pixels
}

/// The largest disc, the first one in picture order, inside the inliers. Noise makes single outliers everywhere, and no
/// disc would be large if they counted: those that are not part of a square of 2 x 2 outliers do not. What is beside
/// the picture is an outlier. `None` when there is no inlier or
/// `workspace` is shorter than [`workspace_len`].
///
/// # Scratch
/// `workspace` is overwritten. Time grows with the pixels times the radius.
pub fn largest_disc(image: &Image, inliers: impl Fn(&Window) -> u64, workspace: &mut [f32]) -> Option<Disc> {
    let (width, height) = (image.width(), image.height());
    let workspace = workspace.get_mut(..width.checked_mul(height)?)?;
    column_distances(image, inliers, workspace);
    let mut best: Option<Disc> = None;
    for (y, row) in workspace.chunks_exact(width.max(1)).enumerate() {
        for x in 0..width {
            let floor = best.map_or(0, |disc| disc.radius_squared);
            let radius_squared = distance_squared(row, x, floor);
            if radius_squared > floor {
                best = Some(Disc { x, y, radius_squared });
            }
        }
    }
    best
}

/// Makes ones of the zeros that are not part of a square of four zeros. What is beside the picture is zero.
fn fill_holes(values: &mut [f32], width: usize) {
    const FILLED: f32 = -1.0;
    let height = values.len() / width.max(1);
    for y in 0..height {
        for x in 0..width {
            // Filled in a row above or on the left is still a zero here.
            let is_zero = |dx: isize, dy: isize| {
                let place = x.checked_add_signed(dx).zip(y.checked_add_signed(dy));
                let inside = place.filter(|&(x, y)| x < width && y < height);
                inside.and_then(|(x, y)| values.get(y * width + x)).is_none_or(|&value| value <= 0.0)
            };
            let square = |dx: isize, dy: isize| is_zero(dx, 0) && is_zero(0, dy) && is_zero(dx, dy);
            let alone = is_zero(0, 0) && !square(1, 1) && !square(1, -1) && !square(-1, 1) && !square(-1, -1);
            if let Some(value) = values.get_mut(y * width + x).filter(|_| alone) {
                *value = FILLED;
            }
        }
    }
    for value in values {
        *value = value.abs();
    }
}

/// How far each pixel is from the nearest one in its column that is no inlier and no hole; the rows above and below the picture
/// hold none. f32 holds such distances exactly up to 2^24 rows.
fn column_distances(image: &Image, inliers: impl Fn(&Window) -> u64, distances: &mut [f32]) {
    let width = image.width();
    distances.fill(0.0);
    image.for_each_window(|window| {
        let start = window.y * width + window.x;
        for_each_bit(inliers(window), |i| {
            if let Some(slot) = distances.get_mut(start + i) {
                *slot = 1.0;
            }
        });
    });
    fill_holes(distances, width);
    for y in 1..image.height() {
        let Some((above, below)) = distances.split_at_mut_checked(y * width) else { break };
        let above = above.iter().skip((y - 1) * width);
        for (distance, above) in below.iter_mut().zip(above) {
            if *distance > 0.0 {
                *distance = 1.0 + above;
            }
        }
    }
    let last = image.height() - 1;
    for distance in distances.iter_mut().skip(last * width) {
        *distance = distance.min(1.0);
    }
    for y in (0..last).rev() {
        let Some((above, below)) = distances.split_at_mut_checked((y + 1) * width) else { break };
        for (distance, below) in above.iter_mut().skip(y * width).zip(below.iter()) {
            *distance = distance.min(1.0 + below);
        }
    }
}

/// The squared distance from pixel `x` of a row to the nearest pixel that is no inlier, from the column distances of its
/// row, or any number up to `floor` where it is not above that.
fn distance_squared(row: &[f32], x: usize, floor: u64) -> u64 {
    let square =
        |column: usize| row.get(column).map_or(0, |&distance| (distance as i64).pow(2).unsigned_abs());
    let mut nearest = square(x);
    for offset in 1..=row.len() {
        let away = (offset as u64).pow(2);
        if nearest <= floor || away >= nearest {
            break;
        }
        let left = x.checked_sub(offset).map_or(0, square);
        nearest = nearest.min(away + left).min(away + square(x + offset));
    }
    nearest
}
