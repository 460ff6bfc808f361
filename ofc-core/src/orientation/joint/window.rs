//! What a window says of integrability, as numbers in the caller's workspace.

use super::constants::SMALLEST_FILL;
use super::quads::Quads;
use crate::math::mat3::{self, Mat3};

/// Numbers of a [`Window`].
pub(super) const NUMBERS: usize = 14;

/// One window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// The means of `N x N_x` and of `N x N_y`.
    pub products: [[f64; 3]; 2],
    /// Variances and covariance (xx, xy, yy) of what noise does to them, as multiples of that of a pixel.
    pub variance: [f64; 3],
    /// The mean of N.
    pub normal: [f64; 3],
    /// `|N x N_x|^2 + |N x N_y|^2`: how much the surface bends, noise taken off.
    pub bending: f64,
    /// The share of that in what is seen of it, from 0 to 1.
    pub share: f64,
}

impl Window {
    /// Of the quads of neighbors of `length` pixels in a window of `side`, and its pixels' mean N, if it is full enough and bends.
    pub fn of(quads: &Quads, normal: [f64; 3], side: f64, length: f64, noise: &Mat3) -> Option<Self> {
        let squares = side / length;
        if quads.count < SMALLEST_FILL * squares * squares {
            return None;
        }
        let ([x, y], variance) = quads.means(side, length);
        let [xx, _, yy] = variance;
        let [[a, ..], [_, b, _], [.., c]] = *noise;
        // The trace of [N]x noise [N]x^T.
        let crossed = mat3::dot(normal, normal) * (a + b + c) - mat3::dot(normal, mat3::apply(noise, normal));
        let seen = mat3::dot(x, x) + mat3::dot(y, y);
        // Never negative but by rounding, where all noise is along the normal.
        let expected = ((xx + yy) * crossed).max(0.0);
        let bending = (seen - expected).max(0.0);
        let share = bending / (bending + expected);
        (bending > 0.0).then_some(Self { products: [x, y], variance, normal, bending, share })
    }

    pub fn load(numbers: &[f32; NUMBERS]) -> Self {
        let [a, b, c, d, e, f, xx, xy, yy, n1, n2, n3, bending, share] = numbers.map(f64::from);
        let (products, variance) = ([[a, b, c], [d, e, f]], [xx, xy, yy]);
        Self { products, variance, normal: [n1, n2, n3], bending, share }
    }

    pub fn store(&self, numbers: &mut [f32; NUMBERS]) {
        let [[a, b, c], [d, e, f]] = self.products;
        let ([xx, xy, yy], [n1, n2, n3]) = (self.variance, self.normal);
        let all = [a, b, c, d, e, f, xx, xy, yy, n1, n2, n3, self.bending, self.share];
        *numbers = all.map(|number| number as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn shares_are_shares_where_all_noise_is_along_the_normal() {
        let mut rng = Rng::new(3);
        for _ in 0..100 {
            let normal = [(); 3].map(|()| rng.unit());
            let noise = normal.map(|a| mat3::scale(normal, 1e-3 * a));
            let products = [[1e-12 * f64::from(rng.below(2)), 0.0, 0.0], [0.0; 3]];
            let quads = Quads { count: 256.0, products, ends: [0.0; 3] };
            let share = Window::of(&quads, normal, 16.0, 1.0, &noise).map_or(0.0, |window| window.share);
            assert!((0.0..=1.0).contains(&share), "{share}");
        }
    }
}
