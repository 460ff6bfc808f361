//! Least squares over the inliers, and what it says of itself.

use super::params::MIN_PIXELS;
use super::problem::Problem;
use super::result::Fit;
use crate::color::ellipsoid::{Coefficients, quadratic_form};
use crate::color::inliers::Inliers;
use crate::color::regression::{self, Estimate, LeastSquares, Moments, TERMS};
use crate::color::rounding;
use crate::math::mat3::symmetric_eigen;
use crate::picture::{Pixels, for_each_bit};
use libm::{fabsf, sqrt};

impl<P: Pixels> Problem<'_, P> {
    /// The scaled z of all usable pixels by least squares; `None` where they determine none.
    #[inline(never)]
    pub fn least_squares(&self) -> Option<Coefficients> {
        self.moments(&Inliers::all(self.usable)).solve().map(|fit| fit.coefficients)
    }

    /// The sums over the inliers' scaled colors.
    #[inline(never)]
    pub(super) fn moments(&self, inliers: &Inliers) -> Moments {
        let mut moments = Moments::default();
        self.pixels.for_each_window(|window| {
            let mut sums = Moments::default();
            for_each_bit(inliers.bits(window), |i| {
                sums.add(window.pixel(i).map(|c| f64::from(c) * self.scale));
            });
            moments.merge(&sums);
        });
        moments
    }

    /// The least-squares fit to the inliers, whose moments are given, with its statistics, in pixel values; `None` where they
    /// determine none.
    #[inline(never)]
    pub(super) fn refit(&self, inliers: &Inliers, moments: &Moments) -> Option<Refit> {
        let fit = moments.solve();
        let fit = fit.as_ref()?;
        let scale = self.scale;
        let z = fit.coefficients.map(|c| c * (scale * scale));
        let (mean_square, smallest_step) = self.pixels.of_part(|part| residuals_and_steps(part, inliers, &z));
        let residual_sum = mean_square * f64::from(moments.count);
        let rounding = smallest_step * rounding::DEVIATION;
        Refit::new(moments, fit, scale, self.params.limits_confidence, residual_sum, rounding)
    }
}

/// The mean of the squared residuals of the inliers; and the smallest difference in a channel between an inlier and the one
/// before it, other than none: how finely the picture is quantized, whatever the type of its pixels. Zero when there are no
/// differences.
#[inline(never)]
fn residuals_and_steps(pixels: &impl Pixels, inliers: &Inliers, z: &Coefficients) -> (f64, f64) {
    let (mut residual_sum, mut count, mut smallest, mut previous) = (0.0, 0_u32, f32::INFINITY, None);
    pixels.for_each_window(|window| {
        let (bits, mut sum) = (inliers.bits(window), 0.0);
        for_each_bit(bits, |i| {
            let pixel = window.pixel(i);
            let [r, g, b] = pixel;
            let residual = quadratic_form(z, r, g, b) - 1.0;
            sum += residual * residual;
            for (now, before) in pixel.into_iter().zip(previous.unwrap_or(pixel)) {
                let step = fabsf(now - before);
                if step > 0.0 && step < smallest {
                    smallest = step;
                }
            }
            previous = Some(pixel);
        });
        residual_sum += sum;
        count += bits.count_ones();
    });
    let mean = residual_sum / f64::from(count.max(1));
    (mean, if smallest.is_finite() { f64::from(smallest) } else { 0.0 })
}

/// The root mean squares of colors along their principal axes, from the sums of them times `scale`, in pixel values.
#[inline(never)]
pub(super) fn deviations(moments: &Moments, scale: f64) -> [f64; 3] {
    symmetric_eigen(&moments.second_moments()).values.map(|square| sqrt(square.max(0.0)) / scale)
}

/// Puts the expected squares and products of the errors of a fit made of these sums of colors times `scale` into it. Its inliers are
/// those of its robust form, which pulls it: as much as the two differ may be left of that form's error.
#[inline(never)]
pub(super) fn put_covariance(moments: &Moments, scale: f64, fit: &mut Fit) {
    let Some(solved) = moments.solve() else {
        fit.covariance = [0.0; 21];
        return;
    };
    let variance = fit.residual_deviation * fit.residual_deviation;
    fit.covariance = moments.error_covariance(&solved, variance, fit.noise_deviation * scale, scale * scale);
    let mut difference = fit.robust;
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
