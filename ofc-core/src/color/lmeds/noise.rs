//! The noise in the colors from the median residual, for errors of single pixels.
//!
//! Noise of deviation s in every channel makes a residual of rho^T C rho - 1 that is normal with deviation 2 s |C rho|:
//! |residual| / (2 |C rho|) has the same distribution for all colors, but that the rejection cuts it off where |C rho| is
//! large. The median of what is left is compared with what the normal distribution, cut off likewise, has for a median.
//! Sums of squares, as in [`Moments::noise`](crate::color::regression::Moments::noise), come out up to 30 % too low by the cutting,
//! and up to 40 % too high by pixels that do not obey the model and pass for inliers.

use crate::color::dispersion::CONSISTENCY;
use crate::color::ellipsoid::{Coefficients, matrix, quadratic_form};
use crate::color::inliers::Inliers;
use crate::math::mat3;
use crate::math::select::{median_rank, take_kth_smallest};
use crate::picture::Pixels;
use core::cell::Cell;
use core::f64::consts::FRAC_1_SQRT_2;
use libm::sqrt;

/// Classes of |C rho|^2, four to an octave, from the largest: of what is sixteen octaves smaller nothing is cut off.
const CLASSES: usize = 64;

/// The noise is at most so many times what the median says without regard to the cutting.
const LARGEST_CORRECTION: f64 = 3.0;

/// Bisections for the correction.
const STEPS: u32 = 24;

/// The standard deviation of the noise in each channel, in pixel values. `scale` brings these to about 1: squares of what they differ
/// by may be too large or too small for single precision, and those of scaled ones are not.
///
/// # Scratch
/// One `f32` an inlier.
#[inline(never)]
pub(super) fn noise(
    pixels: &impl Pixels,
    inliers: &Inliers,
    z: &Coefficients,
    scale: f64,
    workspace: &mut [f32],
) -> f64 {
    let c = matrix(z);
    // No square is above 4 tr C rho^T C rho where C is positive definite.
    let [c11, c22, c33, ..] = *z;
    let top = class(4.0 * (c11 + c22 + c33) * inliers.residual.high.max(1.0));
    let counts = [const { Cell::new(0_u32) }; CLASSES];
    // Squares, whose median is that of what they are squares of, take no root a pixel.
    let squares = pixels.gather(inliers.selector(), workspace, |r, g, b| {
        let half = mat3::apply(&c, [r, g, b].map(f64::from));
        let slope = 4.0 * mat3::dot(half, half);
        if let Some(count) = counts.get(top.saturating_sub(class(slope)).min(CLASSES - 1)) {
            count.set(count.get() + 1);
        }
        let residual = quadratic_form(z, r, g, b) - 1.0;
        residual * residual / slope.max(f64::MIN_POSITIVE) * (scale * scale)
    });
    let rank = median_rank(squares.len());
    let median = take_kth_smallest(squares, rank).map_or(0.0, |square| sqrt(f64::from(square)) / scale);
    let limit = 0.5 * (inliers.residual.high - inliers.residual.low);
    if !(median > 0.0 && limit.is_finite()) {
        return CONSISTENCY * median;
    }
    corrected(median, |place| limit / sqrt(middle(top.saturating_sub(place))), &counts)
}

/// Quarters of octaves: the exponent and two bits of the fraction.
fn class(square: f64) -> usize {
    (square.to_bits() >> 50) as usize
}

/// The middle of a class.
fn middle(class: usize) -> f64 {
    f64::from_bits(((class as u64) << 50) | (1 << 49))
}

/// The deviation of which half of the values are below `median`, when those of each class are cut off at its `cut`.
fn corrected(median: f64, cut: impl Fn(usize) -> f64, counts: &[Cell<u32>; CLASSES]) -> f64 {
    let half = 0.5 * counts.iter().map(|count| f64::from(count.get())).sum::<f64>();
    let below = |deviation: f64| {
        let classes = counts.iter().enumerate().filter(|(_, count)| count.get() > 0);
        classes.fold(0.0, |sum, (place, count)| {
            let part = share(median / deviation) / share(cut(place).max(median) / deviation);
            sum + f64::from(count.get()) * part
        })
    };
    let (mut low, mut high) = (CONSISTENCY * median, LARGEST_CORRECTION * CONSISTENCY * median);
    for _ in 0..STEPS {
        let deviation = 0.5 * (low + high);
        *(if below(deviation) > half { &mut low } else { &mut high }) = deviation;
    }
    0.5 * (low + high)
}

/// The share of a normal distribution within so many deviations, good to 0.0005.
///
/// # Reference
/// M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions", 1964, eq. 7.1.27.
fn share(deviations: f64) -> f64 {
    let x = FRAC_1_SQRT_2 * deviations;
    let power = 1.0 + x * (0.278_393 + x * (0.230_389 + x * (0.000_972 + x * 0.078_108)));
    let square = power * power;
    1.0 - 1.0 / (square * square)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_the_normal_distribution() {
        for (deviations, expected) in
            [(0.0, 0.0), (0.5, 0.382_925), (1.0, 0.682_689), (2.5, 0.987_581), (6.0, 1.0)]
        {
            assert!((share(deviations) - expected).abs() < 6e-4, "{deviations}");
        }
    }

    #[test]
    fn what_is_cut_off_is_made_up_for() {
        let counts = [const { Cell::new(0) }; CLASSES];
        counts[3].set(100);
        // Half of what lies within one deviation lies within 0.4399 deviations, and within 0.6745 of what is not cut off.
        assert!((corrected(0.4399, |_| 1.0, &counts) - 1.0).abs() < 0.01);
        assert!((corrected(0.6745, |_| 100.0, &counts) - 1.0).abs() < 0.01);
    }

    #[test]
    fn classes_are_quarters_of_octaves() {
        assert_eq!(class(8.0) - class(1.0), 12);
        for square in [0.37, 1.0, 5.2, 1e6] {
            assert!((middle(class(square)) / square - 1.0).abs() < 0.13);
        }
    }
}
