//! 6x6 matrices by columns: products, and Householder's QR; [`super::cholesky`] has Cholesky's factors.
//!
//! nalgebra's decompositions work on views whose sizes it compares at run time, and with some optimizations the panic for
//! sizes that do not fit stays in the linked binary: its QR where code is made small, its LU always. Its Cholesky
//! factors and inverse did not panic in the shipped library and gave the same bits, but made it 2,816 bytes larger, and every
//! byte counts in the firmware.
//!
//! # Reference
//! G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed., sections 3.1, 4.2, 5.1 and 5.2.

pub use super::cholesky::{backward, dot, factor, forward, inverse};

use libm::{fabs, sqrt};

const N: usize = 6;

/// Six columns.
pub type Mat6 = [[f64; N]; N];

/// `a v`.
#[must_use]
pub fn apply(a: &Mat6, v: &[f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    for (column, factor) in a.iter().zip(v) {
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum += factor * entry;
        }
    }
    sum
}

/// `a b`.
#[must_use]
pub fn multiply(a: &Mat6, b: &Mat6) -> Mat6 {
    b.each_ref().map(|column| apply(a, column))
}

/// The largest absolute entry.
#[must_use]
pub fn max_abs(a: &Mat6) -> f64 {
    a.iter().flatten().fold(0.0, |largest, entry| fabs(*entry).max(largest))
}

/// Multiplies row and column i by `factors`\[i\].
pub fn scale(a: &mut Mat6, factors: &[f64; N]) {
    for (column, column_factor) in a.iter_mut().zip(factors) {
        for (entry, row_factor) in column.iter_mut().zip(factors) {
            *entry = *row_factor * *entry * *column_factor;
        }
    }
}

/// The diagonal.
#[must_use]
pub fn diagonal(a: &Mat6) -> [f64; N] {
    let mut diagonal = [0.0; N];
    for (i, (entry, column)) in diagonal.iter_mut().zip(a).enumerate() {
        *entry = column.get(i).copied().unwrap_or(0.0);
    }
    diagonal
}

/// x of a x = b by Householder's reflections; `None` when a reflection finds nothing to reflect.
#[must_use]
pub fn solve(a: &Mat6, b: &[f64; N]) -> Option<[f64; N]> {
    let (mut columns, mut x, mut lengths) = (*a, *b, [0.0; N]);
    for (i, length) in lengths.iter_mut().enumerate() {
        let (done, rest) = columns.split_at_mut_checked(i + 1)?;
        let axis = done.last_mut()?.get_mut(i..)?;
        let reflected = reflection_axis(axis)?;
        *length = fabs(reflected);
        let sign = 1.0_f64.copysign(reflected);
        for column in rest.iter_mut().chain([&mut x]) {
            let column = column.get_mut(i..)?;
            let factor = dot(axis, column) * (-2.0 * sign);
            for (entry, axis) in column.iter_mut().zip(axis.iter()) {
                *entry = factor * axis + sign * *entry;
            }
        }
    }
    for (i, (column, length)) in columns.iter().zip(&lengths).enumerate().rev() {
        let (done, rest) = x.split_at_mut_checked(i)?;
        let value = rest.first_mut()?;
        *value /= length;
        for (entry, known) in done.iter_mut().zip(column) {
            *entry -= *value * known;
        }
    }
    Some(x)
}

/// Turns a column into the unit axis of the reflection that leaves only its first entry, and returns that entry; `None`
/// for a column of zeros.
fn reflection_axis(column: &mut [f64]) -> Option<f64> {
    let square = dot(column, column);
    let norm = sqrt(square);
    let first = column.first_mut()?;
    let signed = if *first >= 0.0 { norm } else { -norm };
    let factor = (square + fabs(*first) * norm) * 2.0;
    *first += signed;
    if factor == 0.0 {
        return None;
    }
    // A second time, because the factor of a small column is not exact.
    let roughly = sqrt(factor);
    for entry in column.iter_mut() {
        *entry /= roughly;
    }
    let length = sqrt(dot(column, column));
    for entry in column.iter_mut() {
        *entry /= length;
    }
    Some(-signed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    /// Positive definite, with entries of order 1.
    fn random_matrix(rng: &mut Rng) -> Mat6 {
        let columns = [(); N].map(|()| [(); N].map(|()| 2.0 * rng.unit() - 1.0));
        let mut matrix = columns.map(|a| columns.map(|b| dot(&a, &b)));
        for (i, column) in matrix.iter_mut().enumerate() {
            column[i] += 0.1;
        }
        matrix
    }

    #[test]
    fn the_inverse_is_one() {
        let mut rng = Rng::new(3);
        for _ in 0..100 {
            let matrix = random_matrix(&mut rng);
            let mut lower = matrix;
            factor(&mut lower).unwrap();
            let product = multiply(&matrix, &inverse(&lower));
            for (i, column) in product.iter().enumerate() {
                for (j, entry) in column.iter().enumerate() {
                    let expected = if i == j { 1.0 } else { 0.0 };
                    // The smallest eigenvalue is above 0.1.
                    assert!((entry - expected).abs() < 1e-12, "{i} {j}: {entry}");
                }
            }
        }
    }

    #[test]
    fn rows_and_columns_are_scaled_by_their_own_factors() {
        let mut rng = Rng::new(6);
        let matrix = random_matrix(&mut rng);
        let factors = [1.0, -2.0, 4.0, 0.5, 8.0, -0.25];
        let mut scaled = matrix;
        scale(&mut scaled, &factors);
        for (j, (column, before)) in scaled.iter().zip(&matrix).enumerate() {
            for (i, (entry, before)) in column.iter().zip(before).enumerate() {
                // Powers of two: exact.
                assert_eq!(*entry, before * factors[i] * factors[j]);
            }
            assert_eq!(diagonal(&scaled)[j], scaled[j][j]);
        }
        let largest = scaled.iter().flatten().map(|entry| entry.abs()).fold(0.0, f64::max);
        assert_eq!(max_abs(&scaled), largest);
    }

    #[test]
    fn a_solution_solves() {
        let mut rng = Rng::new(5);
        for _ in 0..100 {
            let matrix = [(); N].map(|()| [(); N].map(|()| 2.0 * rng.unit() - 1.0));
            let truth = [(); N].map(|()| rng.unit());
            let x = solve(&matrix, &apply(&matrix, &truth)).unwrap();
            for (x, truth) in x.iter().zip(truth) {
                // The worst of these matrices has a condition number of about 1e3.
                assert!((x - truth).abs() < 1e-11, "{x} {truth}");
            }
        }
        assert_eq!(solve(&[[0.0; N]; N], &[1.0; N]), None);
    }

    #[test]
    fn what_is_not_positive_definite_has_no_factor() {
        let mut matrix = random_matrix(&mut Rng::new(4));
        matrix[3][3] = -1.0;
        assert_eq!(factor(&mut { matrix }), None);
        assert_eq!(factor(&mut [[1.0; N]; N]), None);
        matrix[0][0] = f64::NAN;
        assert_eq!(factor(&mut matrix), None);
    }
}
