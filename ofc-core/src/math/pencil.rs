//! The generalized eigenproblem a z = λ n z of two symmetric 6x6 matrices, `a` without negative and `n` with positive eigenvalues
//! alone.
//!
//! With n = L Lᵀ it is the eigenproblem of L⁻¹ a L⁻ᵀ, whose columns are made orthogonal by one-sided Jacobi rotations.
//!
//! # Reference
//! G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed., sections 8.5 and 8.7.

use super::mat3::rotation;
use super::mat6::{Mat6, backward, dot, factor, forward};
use core::array;
use libm::{fabs, sqrt};

/// Rotations of all pairs of columns; well conditioned matrices take about six.
const SWEEPS: usize = 30;

/// What is smallest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smallest {
    /// The eigenvector z of the smallest eigenvalue, with zᵀ n z = 1; of either sign.
    pub vector: [f64; 6],
    /// The two smallest eigenvalues, the smallest first.
    pub values: [f64; 2],
}

/// The two smallest eigenvalues, and the vector of the first; `None` where `n` is not positive definite.
#[must_use]
pub fn smallest(a: &Mat6, n: &Mat6) -> Option<Smallest> {
    let mut lower = *n;
    factor(&mut lower)?;
    let mut columns = *a;
    for column in &mut columns {
        forward(&lower, column);
    }
    // L⁻¹ a, transposed: its columns become those of L⁻¹ a L⁻ᵀ, which is symmetric.
    columns = transpose(&columns);
    for column in &mut columns {
        forward(&lower, column);
    }
    let mut vectors: Mat6 = array::from_fn(|i| array::from_fn(|j| f64::from(u8::from(i == j))));
    for _ in 0..SWEEPS {
        if !sweep(&mut columns, &mut vectors) {
            break;
        }
    }
    let mut pairs = columns.each_ref().map(|column| sqrt(dot(column, column)));
    let first = pairs.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?.0;
    let value = *pairs.get(first)?;
    let mut vector = *vectors.get(first)?;
    *pairs.get_mut(first)? = f64::INFINITY;
    let second = pairs.iter().copied().fold(f64::INFINITY, f64::min);
    backward(&lower, &mut vector);
    let is_finite = value.is_finite() && vector.iter().all(|entry| entry.is_finite());
    is_finite.then_some(Smallest { vector, values: [value, second] })
}

fn transpose(a: &Mat6) -> Mat6 {
    array::from_fn(|i| a.each_ref().map(|column| column.get(i).copied().unwrap_or(0.0)))
}

/// Makes every two columns orthogonal once, and says whether any were not.
fn sweep(columns: &mut Mat6, vectors: &mut Mat6) -> bool {
    let mut turned = false;
    for last in 1..columns.len() {
        let (Some((before, [column, ..])), Some((first, [vector, ..]))) =
            (columns.split_at_mut_checked(last), vectors.split_at_mut_checked(last))
        else {
            break;
        };
        for (other, other_vector) in before.iter_mut().zip(first) {
            let (pp, pq, qq) = (dot(other, other), dot(other, column), dot(column, column));
            if fabs(pq) > f64::EPSILON * sqrt(pp * qq) {
                let turn = rotation(pp, pq, qq);
                rotate(other, column, turn);
                rotate(other_vector, vector, turn);
                turned = true;
            }
        }
    }
    turned
}

fn rotate(a: &mut [f64; 6], b: &mut [f64; 6], (cosine, sine): (f64, f64)) {
    for (a, b) in a.iter_mut().zip(b) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mat6::apply;
    use crate::math::rng::Rng;

    /// Xᵀ diag X for a random X, and X.
    fn with_values(values: [f64; 6], rng: &mut Rng) -> (Mat6, Mat6) {
        let rows: Mat6 = [(); 6].map(|()| [(); 6].map(|()| 2.0 * rng.unit() - 1.0));
        let matrix =
            array::from_fn(|i| array::from_fn(|j| (0..6).map(|k| values[k] * rows[k][i] * rows[k][j]).sum()));
        (matrix, rows)
    }

    #[test]
    fn eigenvalues_are_those_that_it_was_made_of() {
        let mut rng = Rng::new(21);
        for _ in 0..200 {
            let values = [3.0, 0.25, 7.0, 1.0, 0.5, 20.0];
            let mut state = rng.clone();
            // The same X: a = Xᵀ V X and n = Xᵀ X have the eigenvalues V.
            let (a, _) = with_values(values, &mut rng);
            let (n, rows) = with_values([1.0; 6], &mut state);
            let found = smallest(&a, &n).unwrap();
            // Random matrices have condition numbers up to 1e3, n their squares.
            assert!(
                (found.values[0] - 0.25).abs() < 1e-6 && (found.values[1] - 0.5).abs() < 1e-6,
                "{found:?}"
            );
            // X z is the unit vector of that value.
            for (k, row) in rows.iter().enumerate() {
                let wanted = if k == 1 { 1.0 } else { 0.0 };
                assert!((dot(row, &found.vector).abs() - wanted).abs() < 1e-5);
            }
            let (left, right) = (apply(&a, &found.vector), apply(&n, &found.vector));
            let scale = dot(&left, &left).sqrt();
            assert!(left.iter().zip(right).all(|(l, r)| (l - found.values[0] * r).abs() < 1e-6 * scale));
        }
    }

    #[test]
    fn a_null_vector_has_the_value_zero() {
        let mut rng = Rng::new(22);
        let (a, _) = with_values([0.0, 1.0, 1.0, 2.0, 2.0, 5.0], &mut rng);
        let (n, _) = with_values([1.0; 6], &mut rng);
        let found = smallest(&a, &n).unwrap();
        assert!(found.values[0] < 1e-9 * found.values[1]);
        assert!(apply(&a, &found.vector).iter().all(|entry| entry.abs() < 1e-9));
        assert_eq!(smallest(&a, &[[0.0; 6]; 6]), None);
        assert_eq!(smallest(&[[f64::NAN; 6]; 6], &n), None);
    }
}
