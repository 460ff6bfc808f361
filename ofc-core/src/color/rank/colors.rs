//! First and second moments of colors, and what normals they make.

use crate::color::second_moments::SecondMoments;
use crate::math::mat3::{self, Mat3, SymmetricEigen};
use crate::picture::{Pixels, Window, for_each_bit};
use libm::sqrt;

/// First and second moments of colors.
pub(super) struct Colors {
    mean: [f64; 3],
    /// The mean of rho rho^T.
    pub moments: Mat3,
    pub eigen: SymmetricEigen,
}

impl Colors {
    /// The moments of the inliers' colors; `None` without any.
    #[inline(never)]
    pub fn of(pixels: &impl Pixels, inliers: impl Fn(&Window) -> u64) -> Option<Self> {
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

    /// The root mean squares of the colors along their principal axes, descending.
    pub fn deviations(&self) -> [f64; 3] {
        self.eigen.values.map(|square| sqrt(square.max(0.0)))
    }

    /// The deviations of the normals that `c` makes of the colors.
    pub fn normals(&self, c: &Mat3) -> [f64; 3] {
        let mut root = self.eigen.vectors;
        for (row, value) in root.iter_mut().zip(self.eigen.values) {
            *row = mat3::scale(*row, sqrt(value.max(0.0)));
        }
        let form = mat3::multiply(&root, &mat3::multiply(c, &mat3::transpose(&root)));
        mat3::symmetric_eigen(&form).values.map(|square| sqrt(square.max(0.0)))
    }

    /// The standard deviation of the colors along their longest axis.
    pub fn spread(&self) -> f64 {
        let ([axis, ..], [square, ..]) = (self.eigen.vectors, self.eigen.values);
        let mean = mat3::dot(axis, self.mean);
        sqrt((square - mean * mean).max(0.0))
    }
}

/// The noise of a channel that explains residuals rho^T c rho - 1 of this deviation.
pub(super) fn noise_of_residuals(c: &Mat3, moments: &Mat3, deviation: f64) -> f64 {
    let square = mat3::multiply(c, &mat3::multiply(moments, c));
    let trace = square[0][0] + square[1][1] + square[2][2];
    deviation / (2.0 * sqrt(trace)).max(f64::MIN_POSITIVE)
}
