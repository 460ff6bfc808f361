//! Products of neighbors: `N x N_x` and `N x N_y`, summed over a surface without the bias that its curvature gives to planes.
//!
//! In a quad, two by two neighbors, `N x N_x` is the product of the means of its left and its right side, and `N x N_y` that of its lower
//! and its upper one. However N curves, their sum over a window is that of the surface, where `N x N_x` of a plane through the window is
//! not. Neighbors have independent noise, so that noise adds nothing to the mean of a product; and within a window their noise cancels
//! but where quads end. Both products belong to the middle of the quad: at a border neither goes further out than the other.

use super::constants::JUMP;
use crate::math::mat3;

/// Numbers of [`Quads`].
pub(super) const NUMBERS: usize = 10;

/// Sums over quads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Quads {
    /// How many there are.
    pub count: f64,
    /// Of the products, for sides of squares as the unit of length, y up.
    pub products: [[f64; 3]; 2],
    /// Of the squares of what multiplies a square's noise in the sums of products, where quads end: along x, x and y, along y.
    pub ends: [f64; 3],
}

impl Quads {
    /// Adds that of four neighbors, upper left, upper right, lower left and lower right, unless the surface jumps between them; whether
    /// it was added.
    #[inline]
    pub fn add_quad(&mut self, a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> bool {
        let [left, right, low, up] = [mean(a, c), mean(b, d), mean(c, d), mean(a, b)];
        let is_smooth = square_of_step(left, right).max(square_of_step(low, up)) < JUMP;
        if is_smooth {
            self.count += 1.0;
            let [x, y] = &mut self.products;
            add_to(x, mat3::cross(left, right));
            add_to(y, mat3::cross(low, up));
        }
        is_smooth
    }

    /// Adds what the noise of one neighbor does, which is the upper left, upper right, lower left and lower right one of quads or not.
    pub fn add_end(&mut self, [upper_left, upper_right, lower_left, lower_right]: [bool; 4], times: f64) {
        let [a, b, c, d] =
            [lower_right, lower_left, upper_right, upper_left].map(|is| f64::from(u8::from(is)));
        // It is on the right of one quad and on the left of the next, with one half each.
        let (x, y) = (0.5 * (a + c - b - d), 0.5 * (c + d - a - b));
        add_to(&mut self.ends, [x * x, x * y, y * y].map(|square| times * square));
    }

    /// Adds others.
    pub fn add(&mut self, other: &Self) {
        self.count += other.count;
        add_to(&mut self.ends, other.ends);
        for (sum, term) in self.products.iter_mut().zip(other.products) {
            add_to(sum, term);
        }
    }

    pub fn load(numbers: &[f32; NUMBERS]) -> Self {
        let [count, a, b, c, d, e, f, xx, xy, yy] = numbers.map(f64::from);
        Self { count, products: [[a, b, c], [d, e, f]], ends: [xx, xy, yy] }
    }

    pub fn store(&self, numbers: &mut [f32; NUMBERS]) {
        let [[a, b, c], [d, e, f]] = self.products;
        let [xx, xy, yy] = self.ends;
        *numbers = [self.count, a, b, c, d, e, f, xx, xy, yy].map(|number| number as f32);
    }

    /// The means of `N x N_x` and `N x N_y` a pixel over a window of so many pixels along a side, where neighbors are means over
    /// `length` by `length` pixels; and the variances and the covariance (xx, xy, yy) that noise gives them, as multiples of that of a pixel.
    pub fn means(&self, side: f64, length: f64) -> ([[f64; 3]; 2], [f64; 3]) {
        let n = self.count;
        let [xx, xy, yy] = self.ends;
        // Every row and every column of quads ends at both borders of the window too.
        let border = 2.0 * n * length / side;
        let variance = [xx + border, xy, yy + border];
        let products = self.products.map(|sum| mat3::scale(sum, 1.0 / (n * length)));
        let times = n * length * length;
        (products, variance.map(|sum| sum / (times * times)))
    }
}

fn mean([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> [f64; 3] {
    [0.5 * (a + d), 0.5 * (b + e), 0.5 * (c + f)]
}

fn add_to(sum: &mut [f64; 3], term: [f64; 3]) {
    for (sum, term) in sum.iter_mut().zip(term) {
        *sum += term;
    }
}

fn square_of_step([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> f64 {
    let step = [d - a, e - b, f - c];
    mat3::dot(step, step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use libm::sqrt;

    /// The means over a square of so many quads along a side, of neighbors one apart, of N at a column and a row.
    fn over(size: usize, normal: impl Fn(usize, usize) -> [f64; 3]) -> ([[f64; 3]; 2], [f64; 3]) {
        let mut quads = Quads::default();
        for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
            let [a, b] = [normal(x, y), normal(x + 1, y)];
            let [c, d] = [normal(x, y + 1), normal(x + 1, y + 1)];
            assert!(quads.add_quad(a, b, c, d));
        }
        quads.means(size as f64, 1.0)
    }

    #[test]
    fn products_are_those_of_a_surface_however_it_curves() {
        // A bowl with a wave, whose slopes are p and q: r1.(N x N_x) + r2.(N x N_y) = 0 in its own frame.
        let normal = |x: usize, y: usize| {
            let (x, y) = (x as f64, -(y as f64));
            let wave = libm::sin(0.4 * x + 0.2 * y);
            let (p, q) = (0.02 * x + 0.3 * wave, 0.03 * y + 0.15 * wave);
            let length = sqrt(1.0 + p * p + q * q);
            [-p / length, -q / length, 1.0 / length]
        };
        let ([[a, b, c], [d, e, f]], _) = over(16, normal);
        let size = sqrt(a * a + b * b + c * c + d * d + e * e + f * f);
        assert!(size > 0.01 && (a + e).abs() < 0.01 * size, "{} {size}", a + e);
    }

    #[test]
    fn noise_has_no_mean_and_the_variance_that_is_told() {
        const TIMES: usize = 4000;
        let mut rng = Rng::new(7);
        let (mut sums, mut squares, mut variance) = ([0.0; 2], [0.0; 2], [0.0; 3]);
        for _ in 0..TIMES {
            let noise: std::vec::Vec<f64> = (0..81).map(|_| 0.02 * (rng.unit() - 0.5)).collect();
            // Noise along x of an N along z: N x N_x has it along y.
            let ([[_, x, _], [_, y, _]], told) = over(8, |x, y| [noise[9 * y + x], 0.0, 1.0]);
            sums = [sums[0] + x, sums[1] + y];
            squares = [squares[0] + x * x, squares[1] + y * y];
            variance = told;
        }
        let [xx, xy, yy] = variance.map(|factor| factor * 0.02 * 0.02 / 12.0);
        for ((sum, square), told) in sums.iter().zip(squares).zip([xx, yy]) {
            let (mean, seen) = (sum / TIMES as f64, square / TIMES as f64);
            assert!(mean.abs() < 4.0 * sqrt(told / TIMES as f64), "{mean}");
            assert!((seen / told - 1.0).abs() < 0.15, "{seen} {told}");
        }
        assert_eq!(xy, 0.0);
    }

    #[test]
    fn a_step_is_no_quad_and_a_lone_end_counts() {
        let (flat, steep) = ([0.0, 0.0, 1.0], [0.8, 0.0, 0.6]);
        let mut quads = Quads::default();
        assert!(!quads.add_quad(flat, steep, flat, steep) && quads.count == 0.0);
        // In the middle of four quads noise cancels; on one side of two it counts one along x.
        quads.add_end([true; 4], 1.0);
        assert_eq!(quads.ends, [0.0; 3]);
        quads.add_end([false, true, false, true], 2.0);
        assert_eq!(quads.ends, [2.0, 0.0, 0.0]);
        let mut numbers = [f32::NAN; NUMBERS];
        quads.store(&mut numbers);
        assert_eq!(Quads::load(&numbers), quads);
    }
}
