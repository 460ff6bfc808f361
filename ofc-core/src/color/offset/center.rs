//! An ellipsoid around a center, and how far a color is from it.

use crate::color::ellipsoid::{Coefficients, is_positive_definite, matrix};
use crate::math::mat3;
use libm::sqrt;

/// Numbers that describe it: C and the center.
pub(super) const GRADIENT: usize = 9;

/// The ellipsoid (rho - a)^T C (rho - a) = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centered {
    /// C.
    pub form: Coefficients,
    /// a, the color of the light that is not the model's.
    pub center: [f64; 3],
}

impl Centered {
    pub(super) const fn around_black(form: &Coefficients) -> Self {
        Self { form: *form, center: [0.0; 3] }
    }

    /// The same in a unit of so many of the present one; `None` where that is no ellipsoid of finite numbers.
    pub(super) fn scaled(&self, unit: f64) -> Option<Self> {
        let scaled = Self { form: self.form.map(|c| c * unit * unit), center: self.center.map(|a| a / unit) };
        let numbers = scaled.form.iter().chain(&scaled.center);
        (is_positive_definite(&scaled.form) && numbers.into_iter().all(|number| number.is_finite()))
            .then_some(scaled)
    }

    /// Moved by a step, or as many numbers of it as there are.
    pub(super) fn moved(&self, step: &[f64]) -> Self {
        let mut moved = *self;
        for (number, step) in moved.form.iter_mut().chain(&mut moved.center).zip(step) {
            *number += step;
        }
        moved
    }

    /// The color from the center, C times that, and how long that is.
    fn parts(&self, [r, g, b, _]: &[f32; 4]) -> ([f64; 3], [f64; 3], f64) {
        let [a, b0, c] = self.center;
        let from = [f64::from(*r) - a, f64::from(*g) - b0, f64::from(*b) - c];
        let slope = mat3::apply(&matrix(&self.form), from);
        (from, slope, sqrt(mat3::dot(slope, slope)).max(f64::MIN_POSITIVE))
    }

    /// The distance of a color, positive outside, to first order.
    pub(super) fn distance(&self, color: &[f32; 4]) -> f64 {
        let (from, slope, steepness) = self.parts(color);
        let square = mat3::dot(from, slope).max(0.0);
        (square - sqrt(square)) / steepness
    }

    /// The distance, and its derivatives by the numbers of C and of the center.
    pub(super) fn distance_and_gradient(&self, color: &[f32; 4]) -> (f64, [f64; GRADIENT]) {
        let (from, slope, steepness) = self.parts(color);
        let square = mat3::dot(from, slope).max(f64::MIN_POSITIVE);
        let length = sqrt(square);
        let distance = (square - length) / steepness;
        // Of the square, and of the steepness.
        let (by_square, by_steepness) = ((1.0 - 0.5 / length) / steepness, -distance / steepness);
        let ([x, y, z], [p, q, s]) = (from, slope);
        let share = by_steepness / steepness;
        let twice = 2.0 * by_square;
        let bent = mat3::apply(&matrix(&self.form), slope);
        let [a, b, c] = bent;
        let gradient = [
            by_square * x * x + share * p * x,
            by_square * y * y + share * q * y,
            by_square * z * z + share * s * z,
            twice * x * y + share * (p * y + q * x),
            twice * x * z + share * (p * z + s * x),
            twice * y * z + share * (q * z + s * y),
            -(twice * p + share * a),
            -(twice * q + share * b),
            -(twice * s + share * c),
        ];
        (distance, gradient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_differences() {
        let at = Centered { form: [1.1, 0.9, 1.4, 0.2, -0.3, 0.1], center: [0.2, -0.1, 0.15] };
        for color in [[0.9, 0.4, 0.7, 0.0], [0.2, 1.1, 0.4, 0.0], [1.4, 0.1, 1.0, 0.0]] {
            let (distance, gradient) = at.distance_and_gradient(&color);
            assert!((distance - at.distance(&color)).abs() < 1e-15);
            for i in 0..GRADIENT {
                let mut step = [0.0; GRADIENT];
                step[i] = 1e-6;
                let up = at.moved(&step).distance(&color);
                let down = at.moved(&step.map(|entry| -entry)).distance(&color);
                assert!(((up - down) / 2e-6 - gradient[i]).abs() < 1e-8, "{i}");
            }
        }
    }

    #[test]
    fn the_distance_of_a_sphere_is_that_from_its_center() {
        let sphere = Centered { form: [0.25, 0.25, 0.25, 0.0, 0.0, 0.0], center: [1.0, 2.0, 3.0] };
        for (color, expected) in
            [([1.0, 2.0, 5.0, 0.0], 0.0), ([1.0, 4.5, 3.0, 0.0], 0.5), ([2.5, 2.0, 3.0, 0.0], -0.5)]
        {
            assert!((sphere.distance(&color) - expected).abs() < 1e-12);
        }
    }
}
