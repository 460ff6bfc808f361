//! From second derivatives of a negative log likelihood to covariances.

use crate::math::mat3::{self, Mat3};

/// The sum of the diagonal.
pub(super) const fn trace(a: &Mat3) -> f64 {
    let [[a, ..], [_, b, _], [.., c]] = *a;
    a + b + c
}

/// The inverse of a positive semidefinite matrix whose eigenvalues below `least` are taken for that.
pub(super) fn inverse(a: &Mat3, least: f64) -> Mat3 {
    let eigen = mat3::symmetric_eigen(a);
    let mut inverse = [[0.0; 3]; 3];
    for (value, vector) in eigen.values.into_iter().zip(eigen.vectors) {
        let reciprocal = 1.0 / value.max(least);
        for (row, x) in inverse.iter_mut().zip(vector) {
            for (entry, y) in row.iter_mut().zip(vector) {
                *entry += reciprocal * x * y;
            }
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_is_inverted_and_what_is_not_is_bounded() {
        let a = [[4.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 0.0]];
        let product = mat3::multiply(&a, &inverse(&a, 0.5));
        for (i, row) in product.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let wanted = f64::from(u8::from(i == j && i < 2));
                assert!((entry - wanted).abs() < 1e-12, "{product:?}");
            }
        }
        assert!((inverse(&a, 0.5)[2][2] - 2.0).abs() < 1e-12);
        assert!((trace(&a) - 7.0).abs() < 1e-15);
    }
}
