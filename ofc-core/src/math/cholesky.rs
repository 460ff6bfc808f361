//! Cholesky's factors of a symmetric matrix of any fixed size, by columns, and what they solve.
//!
//! # Reference
//! G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed., sections 3.1 and 4.2.

use core::cmp::Ordering;
use libm::sqrt;

/// The dot product, of as many entries as both have.
#[must_use]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// Makes L of L Lᵀ: its columns, zero above the diagonal; `None` when the matrix is not positive definite.
pub fn factor<const N: usize>(matrix: &mut [[f64; N]; N]) -> Option<()> {
    for j in 0..N {
        let (done, rest) = matrix.split_at_mut_checked(j)?;
        let column = rest.first_mut()?;
        for before in done {
            let share = *before.get(j)?;
            for (entry, known) in column.iter_mut().zip(before).skip(j) {
                *entry -= share * *known;
            }
        }
        let pivot = sqrt(Some(*column.get(j)?).filter(|&square| square > 0.0)?);
        for (i, entry) in column.iter_mut().enumerate() {
            *entry = match i.cmp(&j) {
                Ordering::Less => 0.0,
                Ordering::Equal => pivot,
                Ordering::Greater => *entry / pivot,
            };
        }
    }
    Some(())
}

/// (L Lᵀ)⁻¹ for the columns of L.
#[must_use]
pub fn inverse<const N: usize>(factor: &[[f64; N]; N]) -> [[f64; N]; N] {
    let mut columns = [[0.0; N]; N];
    for (i, column) in columns.iter_mut().enumerate() {
        if let Some(entry) = column.get_mut(i) {
            *entry = 1.0;
        }
        solve(factor, column);
    }
    columns
}

/// Solves L Lᵀ x = b in place.
pub fn solve<const N: usize>(factor: &[[f64; N]; N], b: &mut [f64; N]) {
    forward(factor, b);
    backward(factor, b);
}

/// Solves L x = b in place.
pub fn forward<const N: usize>(factor: &[[f64; N]; N], b: &mut [f64; N]) {
    for (i, column) in factor.iter().enumerate() {
        let (Some(&pivot), Some(x)) = (column.get(i), b.get_mut(i)) else { return };
        *x /= pivot;
        let x = *x;
        for (entry, known) in b.iter_mut().zip(column).skip(i + 1) {
            *entry -= x * known;
        }
    }
}

/// Solves Lᵀ x = b in place.
pub fn backward<const N: usize>(factor: &[[f64; N]; N], b: &mut [f64; N]) {
    for (i, column) in factor.iter().enumerate().rev() {
        let known = dot(column.get(i + 1..).unwrap_or_default(), b.get(i + 1..).unwrap_or_default());
        let (Some(&pivot), Some(x)) = (column.get(i), b.get_mut(i)) else { return };
        *x = (*x - known) / pivot;
    }
}
