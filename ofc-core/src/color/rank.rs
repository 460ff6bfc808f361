//! How many dimensions the colors and the normals of a picture span: 3, 2 or 1.
//!
//! Colors. Their root mean squares along their principal axes are compared with the noise. With the model rho^T C rho = 1
//! fitted, a color off by d has the residual 2 (C rho) . d, so the noise of a channel is
//! sigma = s / (2 rms |C rho|), s being the deviation of the inliers' residuals; whatever the model does not explain
//! counts as noise. A deviation below 1.5 sigma is noise: where it is nothing else it measures 0.2 to 1.3 sigma, on the real
//! photographs 4 and more, on rendered pictures that can be solved 2 and more. Where residuals are smaller than rounding to
//! integers allows (a picture of a few discrete colors fits anything), and where there is no fit, the noise is that of
//! neighboring pixels instead.
//!
//! Normals. Those of three-dimensional colors are N = G0 rho, of unit length on the whole, with deviations nu along their
//! principal axes: the eigenvalues of M^1/2 C M^1/2 are their squares, M being the colors' second moments. Their noise is
//! s / 2; a nu below 3 of it is none, and so is one whose square is negative, where C is no ellipsoid at all.
//! Two-dimensional colors are ambiguous: with normals in a plane (a cylinder) they lie on one conic in their plane, with two
//! lights they fill a part of it. So the conic is fitted, and if its residuals are above twice what the colors' third
//! deviation explains, the normals are not in a plane. One-dimensional colors say of the normals only whether they are all
//! the same (a plane): they are, where the brightness varies no more than the noise.
//!
//! # Reference
//! Section 2: A and B must have rank 3. \[13\]: A. P. Petrov, L. L. Kontsevich, "Properties of color images of surfaces under
//! multiple illuminants", J. Opt. Soc. Am. A 11, 1994.

mod class;
mod colors;
mod conic;
pub mod patches;

pub use class::Class;

use super::ellipsoid::{self, Coefficients};
use super::rounding;
use crate::picture::{Pixels, Sample, Window};
use colors::{Colors, noise_of_residuals};
use conic::Conic;
use libm::sqrt;

/// Deviations of the colors below this many times the noise are noise.
const COLOR_THRESHOLD: f64 = 1.5;
/// Deviations of the normals below this many times their noise are noise.
const NORMAL_THRESHOLD: f64 = 3.0;
/// Residuals of a conic above this many times what noise explains mean that the colors do not lie on it.
const CONIC_THRESHOLD: f64 = 2.0;
/// Brightness that varies less than this many times the noise is constant.
const CONSTANT_THRESHOLD: f64 = 3.0;
/// Noise is at least this share of the largest deviation, with a fit and without one.
const SMALLEST_NOISE: f64 = 1e-6;
const NOISE_WITHOUT_FIT: f64 = 1e-3;

/// Effective ranks, and the singular values behind them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rank {
    /// Of the colors, 1 to 3.
    pub colors: u32,
    /// Of the normals, 1 to 3; `None` where the colors do not say: those of one light, or of a gray picture.
    pub normals: Option<u32>,
    /// The root mean square of the colors along their principal axes, descending, in pixel values.
    pub color_deviations: [f64; 3],
    /// The noise that they are compared with, in pixel values.
    pub color_noise: f64,
    /// The root mean square of the normals along their principal axes, descending; zero in directions that are not seen.
    pub normal_deviations: [f64; 3],
    /// The noise that they are compared with.
    pub normal_noise: f64,
}

impl Rank {
    /// Whether colors and normals both span three dimensions: whether F can be recovered.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.colors == 3 && self.normals == Some(3)
    }

    /// The ranks of the light and of the surface, as far as the colors say.
    #[must_use]
    pub const fn class(&self) -> Class {
        Class::of(self.colors, self.normals)
    }
}

/// The ranks of the pixels that `inliers` gives the bits of. `fit` is the form fitted to them and the standard deviation of
/// its residuals, or `None` where the colors did not determine one. `None` when there are no pixels.
///
/// # Units
/// Pixel values.
///
/// # Scratch
/// None but about 3 KiB of stack; up to four passes over the picture.
// The windows of its passes need not lie on the stack at once, nor on that of the whole pipeline.
#[inline(never)]
pub fn rank(
    pixels: &impl Pixels,
    inliers: impl Fn(&Window) -> u64,
    fit: Option<(Coefficients, f64)>,
) -> Option<Rank> {
    let colors = Colors::of(pixels, &inliers)?;
    let color_deviations = colors.deviations();
    let [largest, second, third] = color_deviations;
    let floor = match pixels.sample() {
        Sample::U8 | Sample::U16 => rounding::DEVIATION,
        Sample::F32 => SMALLEST_NOISE * largest,
    };
    let color_noise = match fit {
        None => floor.max(NOISE_WITHOUT_FIT * largest).max(local_noise(pixels, &inliers)),
        Some((z, deviation)) => {
            let noise = noise_of_residuals(&ellipsoid::matrix(&z), &colors.moments, deviation);
            if noise < 0.5 * floor { floor.max(local_noise(pixels, &inliers)) } else { noise.max(floor) }
        }
    };
    let mut rank = Rank {
        colors: dimensions(color_deviations, COLOR_THRESHOLD * color_noise),
        normals: None,
        color_deviations,
        color_noise,
        normal_deviations: [0.0; 3],
        normal_noise: 0.0,
    };
    match (rank.colors, fit) {
        (3, Some((z, deviation))) => {
            rank.normal_deviations = colors.normals(&ellipsoid::matrix(&z));
            rank.normal_noise = 0.5 * deviation;
            rank.normals = Some(dimensions(rank.normal_deviations, NORMAL_THRESHOLD * rank.normal_noise));
        }
        (2, _) => {
            if let Some(conic) = Conic::of(pixels, &inliers, &colors) {
                rank.normal_deviations = colors.normals(&conic.c);
                rank.normal_noise = 0.5 * conic.residual_deviation;
                let noise = noise_of_residuals(&conic.c, &colors.moments, conic.residual_deviation);
                let explained = CONIC_THRESHOLD * third.max(floor);
                rank.normals = Some(if noise > explained { 3 } else { 2 });
            }
        }
        (1, _) => {
            let spread = colors.spread();
            rank.normal_noise = second.max(floor) / largest.max(f64::MIN_POSITIVE);
            if spread <= CONSTANT_THRESHOLD * second.max(floor) {
                rank.normal_deviations = [1.0, 0.0, 0.0];
                rank.normals = Some(1);
            }
        }
        _ => {}
    }
    Some(rank)
}

/// How many deviations are above what noise makes; one at least.
fn dimensions(deviations: [f64; 3], threshold: f64) -> u32 {
    (deviations.iter().filter(|&&deviation| deviation > threshold).count() as u32).max(1)
}

/// The noise of a channel by second differences along rows, which a smooth surface does not show in.
fn local_noise(pixels: &impl Pixels, inliers: impl Fn(&Window) -> u64) -> f64 {
    let (sum, count) = pixels.second_differences(inliers);
    // Three channels; the weights 1, -2, 1 have the square sum 6.
    sqrt(sum / (18 * count.max(1)) as f64)
}
