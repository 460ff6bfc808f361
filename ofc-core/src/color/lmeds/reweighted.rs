//! Least squares over the inliers, and what it says of itself.

use super::{Fit, MIN_PIXELS};
use crate::color::ellipsoid::{Coefficients, quadratic_form};
use crate::color::inliers::Inliers;
use crate::color::regression::{self, Estimate, LeastSquares, Moments, TERMS};
use crate::math::mat3::symmetric_eigen;
use crate::picture::Pixels;
use crate::picture::{Usable, for_each_bit};
use libm::{fabsf, sqrt};

/// The scaled z of all usable pixels.
#[inline(never)]
pub(crate) fn least_squares(pixels: &impl Pixels, usable: Usable, scale: f64) -> Option<Coefficients> {
    moments(pixels, &Inliers::all(usable), scale).solve().map(|fit| fit.coefficients)
}

/// The sums over the inliers' scaled colors.
#[inline(never)]
pub(super) fn moments(pixels: &impl Pixels, inliers: &Inliers, scale: f64) -> Moments {
    let mut moments = Moments::default();
    pixels.for_each_window(|window| {
        let mut sums = Moments::default();
        for_each_bit(inliers.bits(window), |i| sums.add(window.pixel(i).map(|c| f64::from(c) * scale)));
        moments.merge(&sums);
    });
    moments
}

/// Rounding to whole steps is noise of this many steps: 1 / sqrt(12).
const ROUNDING: f64 = 0.288_675_134_594_812_9;

/// The smallest difference in a channel between an inlier and the one before it, other than none: how finely the
/// picture is quantised, whatever the type of its pixels. Zero when there are no differences.
#[inline(never)]
fn smallest_step(pixels: &impl Pixels, inliers: &Inliers) -> f64 {
    let mut smallest = f32::INFINITY;
    let mut previous = None;
    pixels.for_each_window(|window| {
        for_each_bit(inliers.bits(window), |i| {
            let pixel = window.pixel(i);
            for (now, before) in pixel.into_iter().zip(previous.unwrap_or(pixel)) {
                let step = fabsf(now - before);
                if step > 0.0 && step < smallest {
                    smallest = step;
                }
            }
            previous = Some(pixel);
        });
    });
    if smallest.is_finite() { f64::from(smallest) } else { 0.0 }
}

#[inline(never)]
pub(super) fn deviations(moments: &Moments, scale: f64) -> [f64; 3] {
    symmetric_eigen(&moments.second_moments()).values.map(|square| sqrt(square.max(0.0)) / scale)
}

/// The expected squares and products of the errors of a fit made of these sums of colors times `scale`. Its inliers are those
/// of another `form`, which pulls it: as much as the two differ may be left of that form's error.
#[inline(never)]
pub(super) fn covariance(moments: &Moments, scale: f64, form: &Coefficients, fit: &mut Fit) {
    let Some(solved) = moments.solve() else { return };
    let variance = fit.residual_deviation * fit.residual_deviation;
    fit.covariance = moments.error_covariance(&solved, variance, fit.noise_deviation * scale, scale * scale);
    let mut difference = *form;
    for (entry, estimate) in difference.iter_mut().zip(&fit.coefficients) {
        *entry -= estimate.value;
    }
    regression::add_square(&mut fit.covariance, &difference);
}

/// Least squares over inliers.
pub(crate) struct Refit {
    pub coefficients: [Estimate; TERMS],
    pub residual_deviation: f64,
    pub noise_deviation: f64,
    /// What rounding makes: the least that the noise of single pixels can be.
    pub pixel_noise: f64,
    pub degenerate_noise_deviation: f64,
    pub color_deviations: [f64; 3],
    pub count: u32,
}

impl Refit {
    /// The coefficients.
    pub fn z(&self) -> Coefficients {
        self.coefficients.map(|estimate| estimate.value)
    }

    /// From the sums of colors times `scale`, their least squares, and the sum of squares of its residuals. Noise is at least
    /// `rounding`.
    pub fn new(
        moments: &Moments,
        fit: &LeastSquares,
        scale: f64,
        confidence: f64,
        residual_sum: f64,
        rounding: f64,
    ) -> Option<Self> {
        if (moments.count as usize) < MIN_PIXELS {
            return None;
        }
        let variance = residual_sum / (f64::from(moments.count) - TERMS as f64);
        let noise = (moments.noise(&fit.coefficients, residual_sum) / scale).max(rounding);
        let degenerate_noise_deviation = moments.degenerate_noise(fit) / scale;
        let color_deviations = deviations(moments, scale);
        let mut coefficients = regression::estimates(fit, variance, moments.count, confidence);
        for e in &mut coefficients {
            for value in [&mut e.value, &mut e.standard_error, &mut e.low, &mut e.high] {
                *value *= scale * scale;
            }
        }
        Some(Self {
            coefficients,
            residual_deviation: sqrt(variance),
            noise_deviation: noise,
            pixel_noise: rounding,
            degenerate_noise_deviation,
            color_deviations,
            count: moments.count,
        })
    }
}

/// The least-squares fit to the inliers, which are these moments, with its statistics, in pixel values.
#[inline(never)]
pub(super) fn reweighted(
    pixels: &impl Pixels,
    inliers: &Inliers,
    moments: &Moments,
    scale: f64,
    confidence: f64,
) -> Option<Refit> {
    let fit = moments.solve();
    let fit = fit.as_ref()?;
    let residual_sum = residual_sum(pixels, inliers, &fit.coefficients.map(|c| c * (scale * scale)));
    let rounding = smallest_step(pixels, inliers) * ROUNDING;
    Refit::new(moments, fit, scale, confidence, residual_sum, rounding)
}

/// The sum of the squared residuals of the inliers.
#[inline(never)]
fn residual_sum(pixels: &impl Pixels, inliers: &Inliers, z: &Coefficients) -> f64 {
    let mut residual_sum = 0.0;
    pixels.for_each_window(|window| {
        let mut sum = 0.0;
        for_each_bit(inliers.bits(window), |i| {
            let [r, g, b] = window.pixel(i);
            let residual = quadratic_form(z, r, g, b) - 1.0;
            sum += residual * residual;
        });
        residual_sum += sum;
    });
    residual_sum
}
