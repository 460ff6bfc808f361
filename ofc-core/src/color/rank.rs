//! How many dimensions the colors and the normals of a picture span: 3, 2 or 1.
//!
//! Colors. Their root mean squares along their principal axes are compared with the noise. With the model rho^T C rho = 1
//! fitted, a color off by d has the residual 2 (C rho) . d, so the noise of a channel is
//! sigma = s / (2 rms |C rho|), s being the deviation of the inliers' residuals; whatever the model does not explain
//! counts as noise. A deviation below 1.5 sigma is noise: where it is nothing else it measures 0.2 to 1.3 sigma, on the real
//! photographs 4 and more, on rendered pictures that can be solved 2 and more. Where residuals are smaller than rounding to
//! integers allows (a picture of a few discrete colors fits anything), and where there is no fit, the noise is that of
//! neighbouring pixels instead.
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

use super::ellipsoid::{self, Coefficients};
use super::rounding;
use super::second_moments::SecondMoments;
use crate::math::mat3::{self, Mat3, SymmetricEigen};
use crate::picture::{Pixels, Sample, Window, for_each_bit};
use libm::sqrt;

/// Deviations of the colors below this many times the noise are noise.
const COLOR_THRESHOLD: f64 = 1.5;
/// The same of the normals.
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
    let color_deviations = colors.eigen.values.map(|square| sqrt(square.max(0.0)));
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
    let count =
        color_deviations.iter().filter(|&&deviation| deviation > COLOR_THRESHOLD * color_noise).count();
    let mut rank = Rank {
        colors: (count as u32).max(1),
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
            let extended = |&&deviation: &&f64| deviation > NORMAL_THRESHOLD * rank.normal_noise;
            rank.normals = Some((rank.normal_deviations.iter().filter(extended).count() as u32).max(1));
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

/// First and second moments of colors.
struct Colors {
    mean: [f64; 3],
    moments: Mat3,
    eigen: SymmetricEigen,
}

impl Colors {
    #[inline(never)]
    fn of(pixels: &impl Pixels, inliers: impl Fn(&Window) -> u64) -> Option<Self> {
        let (mut sum, mut moments, mut count) = ([0.0; 3], SecondMoments::default(), 0_u64);
        pixels.for_each_window(|window| {
            let bits = inliers(window);
            for_each_bit(bits, |i| {
                let color = window.pixel(i).map(f64::from);
                for (sum, value) in sum.iter_mut().zip(color) {
                    *sum += value;
                }
                moments.add(color);
            });
            count += u64::from(bits.count_ones());
        });
        if count == 0 {
            return None;
        }
        let moments = moments.mean(count as f64);
        let mean = sum.map(|sum| sum / count as f64);
        Some(Self { mean, moments, eigen: mat3::symmetric_eigen(&moments) })
    }

    /// The deviations of the normals that `c` makes of the colors.
    fn normals(&self, c: &Mat3) -> [f64; 3] {
        let mut root = self.eigen.vectors;
        for (row, value) in root.iter_mut().zip(self.eigen.values) {
            *row = mat3::scale(*row, sqrt(value.max(0.0)));
        }
        let form = mat3::multiply(&root, &mat3::multiply(c, &mat3::transpose(&root)));
        mat3::symmetric_eigen(&form).values.map(|square| sqrt(square.max(0.0)))
    }

    /// The standard deviation of the colors along their longest axis.
    fn spread(&self) -> f64 {
        let ([axis, ..], [square, ..]) = (self.eigen.vectors, self.eigen.values);
        let mean = mat3::dot(axis, self.mean);
        sqrt((square - mean * mean).max(0.0))
    }
}

/// The noise of a channel that explains residuals rho^T c rho - 1 of this deviation.
fn noise_of_residuals(c: &Mat3, moments: &Mat3, deviation: f64) -> f64 {
    let square = mat3::multiply(c, &mat3::multiply(moments, c));
    let trace = square[0][0] + square[1][1] + square[2][2];
    deviation / (2.0 * sqrt(trace)).max(f64::MIN_POSITIVE)
}

/// The noise of a channel by second differences along rows, which a smooth surface does not show in.
fn local_noise(pixels: &impl Pixels, inliers: impl Fn(&Window) -> u64) -> f64 {
    let (sum, count) = pixels.second_differences(inliers);
    // Three channels; the weights 1, -2, 1 have the square sum 6.
    sqrt(sum / (18 * count.max(1)) as f64)
}

/// The plane of the two longest axes of colors, in units of the longest.
struct Plane {
    u: [f64; 3],
    v: [f64; 3],
}

impl Plane {
    fn of(colors: &Colors) -> Self {
        let ([u, v, _], [largest, ..]) = (colors.eigen.vectors, colors.eigen.values);
        let scale = 1.0 / sqrt(largest);
        Self { u: mat3::scale(u, scale), v: mat3::scale(v, scale) }
    }

    /// What the coefficients of a conic are multiplied with at a color.
    fn terms(&self, [r, g, b]: [f32; 3]) -> [f64; 3] {
        let color = [f64::from(r), f64::from(g), f64::from(b)];
        let (x, y) = (mat3::dot(self.u, color), mat3::dot(self.v, color));
        [x * x, 2.0 * x * y, y * y]
    }
}

/// The shortest solution of three equations that may be singular.
#[inline(never)]
fn solve(matrix: &Mat3, right: [f64; 3]) -> [f64; 3] {
    let (inverse, _) = mat3::pseudo_inverse(&mat3::svd(matrix), 1e-14);
    mat3::apply(&inverse, right)
}

/// The conic that colors in a plane lie on, as a form of rank 2 in color space.
struct Conic {
    c: Mat3,
    residual_deviation: f64,
}

impl Conic {
    /// Least squares.
    #[inline(never)]
    fn of(pixels: &impl Pixels, inliers: impl Fn(&Window) -> u64, colors: &Colors) -> Option<Self> {
        let plane = Plane::of(colors);
        let (normal, right, count) = Self::sums(pixels, &inliers, &plane);
        let coefficients = solve(&normal, right);
        let residuals = Self::residuals(pixels, &inliers, &plane, coefficients);
        let (Plane { u, v }, [a, b, d]) = (plane, coefficients);
        let mut c = [[0.0; 3]; 3];
        for (row, (u1, v1)) in c.iter_mut().zip(u.into_iter().zip(v)) {
            for (entry, (u2, v2)) in row.iter_mut().zip(u.into_iter().zip(v)) {
                *entry = a * u1 * u2 + b * (u1 * v2 + v1 * u2) + d * v1 * v2;
            }
        }
        let finite = c.iter().flatten().all(|entry| entry.is_finite());
        (finite && count > 0).then(|| Self { c, residual_deviation: sqrt(residuals / count as f64) })
    }

    /// The normal equations: a window does not lie on the stack while they are solved.
    #[inline(never)]
    fn sums(pixels: &impl Pixels, inliers: &impl Fn(&Window) -> u64, plane: &Plane) -> (Mat3, [f64; 3], u64) {
        let (mut normal, mut right, mut count) = ([[0.0; 3]; 3], [0.0; 3], 0_u64);
        pixels.for_each_window(|window| {
            let bits = inliers(window);
            for_each_bit(bits, |i| {
                let row = plane.terms(window.pixel(i));
                for ((entries, right), a) in normal.iter_mut().zip(&mut right).zip(row) {
                    *right += a;
                    for (entry, b) in entries.iter_mut().zip(row) {
                        *entry += a * b;
                    }
                }
            });
            count += u64::from(bits.count_ones());
        });
        (normal, right, count)
    }

    /// The sum of the squares of the residuals.
    #[inline(never)]
    fn residuals(
        pixels: &impl Pixels,
        inliers: &impl Fn(&Window) -> u64,
        plane: &Plane,
        coefficients: [f64; 3],
    ) -> f64 {
        let mut residuals = 0.0;
        pixels.for_each_window(|window| {
            for_each_bit(inliers(window), |i| {
                let residual = mat3::dot(coefficients, plane.terms(window.pixel(i))) - 1.0;
                residuals += residual * residual;
            });
        });
        residuals
    }
}
