//! How wrong the coefficients may be: the covariance of least squares, and the bias of noise in the rows of M.

use super::{LeastSquares, Moments, TERMS, apply};
use crate::math::mat6::Mat6;

/// The upper triangle of a symmetric 6x6 matrix, row by row.
pub type Triangle = [f64; 21];

/// No error is taken for larger: its square is finite, and so are sums of such squares.
const LARGEST: f64 = 1e150;

/// The whole matrix.
#[must_use]
pub fn whole(triangle: &Triangle) -> Mat6 {
    let mut matrix = [[0.0; TERMS]; TERMS];
    for (entry, (i, j)) in triangle.iter().zip(places()) {
        for (row, column) in [(i, j), (j, i)] {
            if let Some(place) = matrix.get_mut(row).and_then(|row| row.get_mut(column)) {
                *place = *entry;
            }
        }
    }
    matrix
}

/// Adds the squares and products of errors.
pub fn add_square(triangle: &mut Triangle, errors: &[f64; TERMS]) {
    let errors = errors.map(|error| error.clamp(-LARGEST, LARGEST));
    let errors = &errors;
    let products =
        errors.iter().enumerate().flat_map(|(i, one)| errors.iter().skip(i).map(move |other| one * other));
    for (entry, product) in triangle.iter_mut().zip(products) {
        *entry += product;
    }
}

/// Row and column of each entry.
fn places() -> impl Iterator<Item = (usize, usize)> {
    (0..TERMS).flat_map(|i| (i..TERMS).map(move |j| (i, j)))
}

impl Moments {
    /// What squares and products of the coefficients' errors are expected to be, times `factor`^2: the covariance at this
    /// residual `variance`, and the square of the bias.
    ///
    /// Noise of variance v in each channel adds v K to M^T M and v tr C M^T M z to itself times z (the second derivatives of
    /// rho^T C rho), which moves the solution by -v ((M^T M)^-1 K z + tr C z), however many colors there are.
    #[must_use]
    #[inline(never)]
    pub fn error_covariance(&self, fit: &LeastSquares, variance: f64, noise: f64, factor: f64) -> Triangle {
        let z = &fit.coefficients;
        let [c11, c22, c33, ..] = *z;
        let trace = c11 + c22 + c33;
        let mut bias = apply(&fit.inverse, &apply(&self.noise_matrix(), z, 1.0), 1.0);
        for (entry, z) in bias.iter_mut().zip(z) {
            *entry = noise * noise * factor * (*entry + trace * z);
        }
        let variance = variance * factor * factor;
        let mut triangle = [0.0; 21];
        let columns = fit.inverse.iter().enumerate();
        let entries = columns.flat_map(|(i, column)| column.iter().skip(i).map(|entry| variance * entry));
        for (place, entry) in triangle.iter_mut().zip(entries) {
            *place = entry;
        }
        add_square(&mut triangle, &bias);
        triangle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_of_any_errors_are_finite() {
        let mut triangle = [0.0; 21];
        for errors in [[1e200, -f64::INFINITY, 1e-200, f64::MAX, 0.0, 2.0], [f64::INFINITY; 6]] {
            add_square(&mut triangle, &errors);
        }
        assert!(triangle.iter().all(|entry| entry.is_finite()), "{triangle:?}");
        assert_eq!(whole(&triangle)[4][5], LARGEST * LARGEST);
    }
}
