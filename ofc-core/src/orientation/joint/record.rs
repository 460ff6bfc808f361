//! What one window says of integrability, as numbers in the caller's workspace.

use super::area::Parts;
use super::constants::{INDEPENDENT, SMALLEST_FILL};
use super::form::flat;
use super::moments::{self, Moments, Plane};
use super::noise;
use crate::math::mat3::{self, Mat3};

/// Numbers of a [`Record`].
pub(super) const NUMBERS: usize = 15;

/// Numbers of a window of a size: a record, and two of scratch.
pub(super) const ROOM: usize = NUMBERS + 2;

const _: () =
    assert!(NUMBERS <= moments::NUMBERS, "a record may take the place of the moments that it is made of");

/// One window.
#[derive(Clone, Copy)]
pub(super) struct Record {
    /// N x `N_x` and N x `N_y`.
    pub v: [f64; 6],
    /// Variances of `N_x` and `N_y` and their covariance, as multiples of that of a pixel.
    pub variance: [f64; 3],
    /// The mean of N.
    pub middle: [f64; 3],
    /// `(N.N_x)^2 + (N.N_y)^2`.
    pub radial: f64,
    /// A point of it in pixels, x right and y up from the top left pixel: where in the picture it lies. A multiple of one half, which
    /// is exact in single precision too.
    pub at: [f64; 2],
}

impl Record {
    /// What a window of `side` pixels at that place says, if it is full enough.
    pub fn of(window: &Moments, side: f64, at: [f64; 2]) -> Option<Self> {
        if window.count() < SMALLEST_FILL * side * side {
            return None;
        }
        let Plane { middle, gradient: [along_x, along_y], variance } = window.plane()?;
        let ([a, b, c], [d, e, f]) = (mat3::cross(middle, along_x), mat3::cross(middle, along_y));
        let length = mat3::dot(middle, middle);
        let (p, q) = (mat3::dot(middle, along_x), mat3::dot(middle, along_y));
        (length > 0.0).then_some(Self { v: [a, b, c, d, e, f], variance, middle, radial: p * p + q * q, at })
    }

    pub fn load(numbers: &[f32; NUMBERS]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k, l, radial, x, y] = numbers.map(f64::from);
        Self { v: [a, b, c, d, e, f], variance: [g, h, i], middle: [j, k, l], radial, at: [x, y] }
    }

    pub fn store(&self, numbers: &mut [f32; NUMBERS]) {
        let all =
            self.v.iter().chain(&self.variance).chain(&self.middle).chain([&self.radial]).chain(&self.at);
        for (slot, &value) in numbers.iter_mut().zip(all) {
            *slot = value as f32;
        }
    }

    /// `r1.(N x N_x) + r2.(N x N_y)`, which integrability makes zero.
    pub fn s(&self, rows: &Mat3) -> f64 {
        self.v.iter().zip(flat(rows)).map(|(a, b)| a * b).sum()
    }

    /// What its noise is linear in.
    #[inline]
    pub fn noise_terms(&self) -> noise::Terms {
        noise::terms(self.middle, self.variance)
    }

    /// What noise adds to `radial`.
    pub fn radial_noise(&self, noise: &Mat3) -> f64 {
        let [xx, _, yy] = self.variance;
        mat3::dot(self.middle, mat3::apply(noise, self.middle)) * (xx + yy)
    }
}

/// The records of the windows of one size.
pub(super) struct Records<'r> {
    pub numbers: &'r [[f32; NUMBERS]],
    /// Two numbers for each.
    pub scratch: &'r mut [f32],
    /// The parts of the picture that they lie in.
    pub parts: Parts,
    /// As how many windows that share no pixel one of them counts.
    pub independent: f64,
}

impl Records<'_> {
    pub fn iter(&self) -> impl Iterator<Item = Record> {
        self.numbers.iter().map(Record::load)
    }
}

/// As how many independent windows one counts, where one begins a `share` of its side after the other.
pub(super) fn independent(share: f64) -> f64 {
    INDEPENDENT * (share * share).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_its_numbers() {
        let record = Record {
            v: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
            variance: [7.0, 8.0, 9.0],
            middle: [10.0, 11.0, 12.0],
            radial: 13.0,
            at: [65_535.5, -40_000.5],
        };
        let mut numbers = [f32::NAN; NUMBERS];
        record.store(&mut numbers);
        let mut again = [0.0; NUMBERS];
        Record::load(&numbers).store(&mut again);
        assert_eq!(numbers, again);
        assert_eq!(Record::load(&numbers).at, record.at);
        assert!((record.s(&[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0; 3]]) - (1.0 - 6.0)).abs() < 1e-15);
    }

    #[test]
    fn noise_of_s_is_that_of_its_terms() {
        // N_x = (1, 0, 0) times noise of variance 4, N = z: s = r1.(z x (e, 0, 0)) = r1y e.
        let record = Record {
            v: [0.0; 6],
            variance: [4.0, 1.0, 9.0],
            middle: [0.0, 0.0, 2.0],
            radial: 0.0,
            at: [0.0; 2],
        };
        let along_x = [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        let turned = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        // (2 r1y)^2 of N_x alone: r2y is zero.
        let variance_at = |rows| noise::total(&noise::variance(rows, &along_x), &record.noise_terms());
        assert!((variance_at(&turned) - 16.0).abs() < 1e-12);
        let both = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!((variance_at(&both) - 4.0 * (4.0 - 2.0 + 9.0)).abs() < 1e-12);
        assert!((record.radial_noise(&mat3::IDENTITY) - 4.0 * 13.0).abs() < 1e-12);
    }
}
