//! The conic that colors in a plane lie on where the normals that made them lie in a plane too.

use super::colors::Colors;
use crate::math::mat3::{self, Mat3};
use crate::picture::{Pixels, Window, for_each_bit};
use libm::sqrt;

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
pub(super) struct Conic {
    pub c: Mat3,
    pub residual_deviation: f64,
}

impl Conic {
    /// The conic through the inliers' colors by least squares; `None` without any.
    #[inline(never)]
    pub fn of(pixels: &impl Pixels, inliers: impl Fn(&Window) -> u64, colors: &Colors) -> Option<Self> {
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
