//! The integrated surface against the normals that it was made of, and against the picture.

use super::differences::minus;
use crate::color::inliers::Inliers;
use crate::light::tilt::{Tilts, pentland};
use crate::math::mat3;
use crate::math::select::{kth_smallest, median_rank};
use crate::orientation::matrix::Orientation;
use crate::picture::{Image, Window, for_each_bit};
use crate::render::DepthMap;
use crate::surface::normals::{Length, normal};
use libm::{atan2, sqrt};

/// A surface integrated from the normals, against them and the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthCheck {
    /// Inliers that have a depth.
    pub pixels: usize,
    /// The median angle between the surface's normals and those recovered from the colors; `None` where it covers no inlier.
    pub median_angle: Option<f64>,
    /// Pentland's tilts of the surface shaded with F; `None` where there are none.
    pub tilts: Option<Tilts>,
    /// These minus the tilts of the input, in (-pi, pi].
    pub tilt_differences: Option<[f64; 3]>,
}

/// Checks a surface of the picture's size; `input` is the tilts of the picture.
pub(super) fn check(
    image: &Image,
    inliers: &Inliers,
    Orientation { f, f_inverse, .. }: &Orientation,
    depth: &DepthMap,
    input: Option<Tilts>,
    workspace: &mut [f32],
) -> DepthCheck {
    // The inliers of a window that have a depth.
    let surface = |window: &Window| {
        let mut bits = inliers.bits(window);
        for_each_bit(bits, |i| {
            if depth.at(window.x + i, window.y).is_none() {
                bits &= !(1 << i);
            }
        });
        bits
    };
    let normal_at = |window: &Window, i| depth.normal(window.x + i, window.y).unwrap_or_default();
    let mut pixels = 0;
    image.for_each_window(|window| {
        for_each_bit(surface(window), |i| {
            let (a, b) = (normal_at(window, i), normal(f_inverse, window.pixel(i), Length::Unit));
            let cross = mat3::cross(a, b);
            if let Some(slot) = workspace.get_mut(pixels) {
                *slot = atan2(sqrt(mat3::dot(cross, cross)), mat3::dot(a, b)) as f32;
                pixels += 1;
            }
        });
    });
    let angles = workspace.get_mut(..pixels).unwrap_or_default();
    let median_angle = kth_smallest(angles, median_rank(pixels)).map(f64::from);
    let tilts = pentland::tilts_of(image, surface, |window, i| mat3::apply(f, normal_at(window, i)));
    let tilt_differences = tilts.zip(input).map(|(tilts, input)| minus(tilts.tilts, input));
    DepthCheck { pixels, median_angle, tilts, tilt_differences }
}
