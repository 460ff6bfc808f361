//! From the covariance of a unit normal to one angle.

use crate::math::mat3::{self, Mat3};
use libm::sqrt;

/// The angle below which 68.3 % of errors lie, for a unit vector `n` whose normally distributed error has this covariance.
///
/// Only the part across `n` counts. With its principal variances a >= b, errors below 2 and 3 times the angle are 95.4 % and
/// 99.7 % where b = 0 and 99.0 % and 100.0 % where b = a.
#[must_use]
pub fn one_sigma(covariance: &Mat3, n: [f64; 3]) -> f64 {
    let [[xx, xy, xz], [_, yy, yz], [.., zz]] = *covariance;
    // Across n, the sum of the two variances and their product, without a basis: trace and determinant of the covariance
    // cut down to the plane.
    let sum = xx + yy + zz - mat3::dot(n, mat3::apply(covariance, n));
    let [x, y, z] = n;
    let squares = x * x * (yy * zz - yz * yz) + y * y * (xx * zz - xz * xz) + z * z * (xx * yy - xy * xy);
    let products = x * y * (xz * yz - xy * zz) + x * z * (xy * yz - xz * yy) + y * z * (xy * xz - yz * xx);
    let product = squares + 2.0 * products;
    let half = 0.5 * sum;
    let larger = half + sqrt((half * half - product).max(0.0));
    if larger.is_nan() {
        return f64::INFINITY;
    }
    if larger > 0.0 { sqrt(larger) * quantile((sum - larger) / larger) } else { 0.0 }
}

/// The 68.3 % quantile of the length of a vector with variances 1 and `ratio`, from 0 to 1: 1 to 1.515, good to 0.2 %.
fn quantile(ratio: f64) -> f64 {
    let r = ratio.clamp(0.0, 1.0);
    sqrt(1.0 + r * (1.036_485 + r * (1.6 + r * (-2.419_137 + r * 1.083_259))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn shares_are_those_of_the_normal_distribution() {
        let mut rng = Rng::new(3);
        let mut normal = || (0..12).map(|_| rng.unit()).sum::<f64>() - 6.0;
        // n is not along an axis, and the error has a part along n that must not count.
        let (n, u, v) = ([0.48, 0.6, 0.64], [0.8, 0.0, -0.6], [-0.36, 0.8, -0.48]);
        for second in [0.0, 0.3, 0.7, 1.0] {
            let mut covariance = [[0.0; 3]; 3];
            let parts = [(0.01, u), (0.01 * second, v), (0.02, n)];
            for (deviation, axis) in parts {
                for (i, row) in covariance.iter_mut().enumerate() {
                    for (j, entry) in row.iter_mut().enumerate() {
                        *entry += deviation * deviation * axis[i] * axis[j];
                    }
                }
            }
            let sigma = one_sigma(&covariance, n);
            let mut below = [0; 3];
            for _ in 0..20_000 {
                let (a, b) = (0.01 * normal(), 0.01 * second * normal());
                let angle = sqrt(a * a + b * b);
                for (below, times) in below.iter_mut().zip([1.0, 2.0, 3.0]) {
                    *below += i32::from(angle < times * sigma);
                }
            }
            let [one, two, three] = below.map(|count| f64::from(count) / 20_000.0);
            // 20,000 draws know the share to 0.0033; the sum of twelve has thinner tails than the normal distribution.
            assert!((one - 0.683).abs() < 0.013, "{second}: {one}");
            assert!((0.945..0.995).contains(&two) && three > 0.995, "{second}: {two} {three}");
        }
    }

    #[test]
    fn no_error_is_no_angle() {
        let n = [0.0, 0.6, 0.8];
        assert!(one_sigma(&[[0.0; 3]; 3], n).abs() < 1e-300);
        // An error along n alone.
        let along = [[0.0, 0.0, 0.0], [0.0, 0.36, 0.48], [0.0, 0.48, 0.64]];
        assert!(one_sigma(&along, n) < 1e-7);
        assert!(one_sigma(&[[f64::MAX; 3]; 3], n) > 1e100);
    }
}
