//! 3x3 matrices, row-major arrays outside and nalgebra inside, and the two decompositions that nalgebra cannot do
//! without panic code in the linked binary: symmetric eigenvalues and singular values, both by Jacobi rotations.
//!
//! nalgebra carries products, the transpose and the inverse. Written out by hand instead they made the shipped library
//! 528 bytes of 704,339 smaller, and 2,500 searches for slants, which invert most, 0.4 % of 315 million instructions shorter;
//! the bits were the same. Nothing that can panic is linked either way. [`super::mat6`] says what it does not carry.
//!
//! # Reference
//! G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed., sections 8.5 (Jacobi) and 8.6.3 (one-sided Jacobi).

use libm::sqrt;
use nalgebra::Matrix3;

/// A 3x3 matrix, row-major.
pub type Mat3 = [[f64; 3]; 3];

/// The identity.
pub const IDENTITY: Mat3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Sweeps of the Jacobi methods: convergence is quadratic and six have always been enough, so this is a bound, not a
/// tolerance.
const SWEEPS: usize = 16;

fn to_nalgebra(m: &Mat3) -> Matrix3<f64> {
    // nalgebra stores columns; the transpose of what it reads our rows as is the matrix itself.
    Matrix3::from(*m).transpose()
}

fn from_nalgebra(m: &Matrix3<f64>) -> Mat3 {
    m.transpose().into()
}

/// `a b`.
#[must_use]
pub fn multiply(a: &Mat3, b: &Mat3) -> Mat3 {
    from_nalgebra(&(to_nalgebra(a) * to_nalgebra(b)))
}

/// `aᵀ`.
#[must_use]
pub fn transpose(a: &Mat3) -> Mat3 {
    from_nalgebra(&to_nalgebra(a).transpose())
}

/// `a⁻¹` by cofactors; `None` where the determinant is zero. Of a matrix with entries that are not finite it is not a number.
#[must_use]
pub fn inverse(a: &Mat3) -> Option<Mat3> {
    to_nalgebra(a).try_inverse().map(|inverse| from_nalgebra(&inverse))
}

/// `a v`.
#[must_use]
pub fn apply(a: &Mat3, v: [f64; 3]) -> [f64; 3] {
    a.map(|row| dot(row, v))
}

/// The dot product.
#[must_use]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    let ([a1, a2, a3], [b1, b2, b3]) = (a, b);
    a1 * b1 + a2 * b2 + a3 * b3
}

/// The cross product.
#[must_use]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let ([a1, a2, a3], [b1, b2, b3]) = (a, b);
    [a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1]
}

/// `v` scaled by `factor`.
#[must_use]
pub fn scale(v: [f64; 3], factor: f64) -> [f64; 3] {
    v.map(|component| component * factor)
}

/// The largest absolute entry.
#[must_use]
pub fn max_abs(a: &Mat3) -> f64 {
    a.iter().flatten().fold(0.0, |largest, entry| entry.abs().max(largest))
}

/// Cosine and sine of the rotation that makes the 2x2 symmetric matrix ((app, apq), (apq, aqq)) diagonal.
pub(super) fn rotation(app: f64, apq: f64, aqq: f64) -> (f64, f64) {
    if apq == 0.0 {
        return (1.0, 0.0);
    }
    let theta = (aqq - app) / (2.0 * apq);
    let t = if theta >= 0.0 {
        1.0 / (theta + sqrt(1.0 + theta * theta))
    } else {
        -1.0 / (-theta + sqrt(1.0 + theta * theta))
    };
    let c = 1.0 / sqrt(1.0 + t * t);
    (c, t * c)
}

/// Rotates rows `P` and `Q` of `m` by (cosine, sine).
fn rotate_rows<const P: usize, const Q: usize>(m: &mut Mat3, (c, s): (f64, f64)) {
    let ([p1, p2, p3], [q1, q2, q3]) = (m[P], m[Q]);
    m[P] = [c * p1 - s * q1, c * p2 - s * q2, c * p3 - s * q3];
    m[Q] = [s * p1 + c * q1, s * p2 + c * q2, s * p3 + c * q3];
}

/// Eigenvalues of a symmetric matrix in descending order, and the unit eigenvectors as the rows of a matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricEigen {
    /// Descending.
    pub values: [f64; 3],
    /// Row `i` belongs to value `i`: the matrix is Uᵀ of A = U Λ Uᵀ.
    pub vectors: Mat3,
}

/// The eigenvalues and vectors of `a`, of which only the symmetric part counts, by cyclic Jacobi rotations.
#[must_use]
pub fn symmetric_eigen(a: &Mat3) -> SymmetricEigen {
    let mut vectors = IDENTITY;
    let mut m = *a;
    for _ in 0..SWEEPS {
        if m[0][1] == 0.0 && m[0][2] == 0.0 && m[1][2] == 0.0 {
            break;
        }
        diagonalize::<0, 1>(&mut m, &mut vectors);
        diagonalize::<0, 2>(&mut m, &mut vectors);
        diagonalize::<1, 2>(&mut m, &mut vectors);
    }
    let (values, vectors, _) = sorted([m[0][0], m[1][1], m[2][2]], vectors, IDENTITY);
    SymmetricEigen { values, vectors }
}

fn diagonalize<const P: usize, const Q: usize>(m: &mut Mat3, vectors: &mut Mat3) {
    let turn = rotation(m[P][P], m[P][Q], m[Q][Q]);
    rotate_rows::<P, Q>(m, turn);
    *m = transpose(m);
    rotate_rows::<P, Q>(m, turn);
    // Exactly zero in exact arithmetic: say so, and the sweeps end.
    m[P][Q] = 0.0;
    m[Q][P] = 0.0;
    rotate_rows::<P, Q>(vectors, turn);
}

/// Sorts the rows of two matrices by descending value.
fn sorted(values: [f64; 3], first: Mat3, second: Mat3) -> ([f64; 3], Mat3, Mat3) {
    let [mut a, mut b, mut c] = [
        (values[0], first[0], second[0]),
        (values[1], first[1], second[1]),
        (values[2], first[2], second[2]),
    ];
    if a.0 < b.0 {
        core::mem::swap(&mut a, &mut b);
    }
    if b.0 < c.0 {
        core::mem::swap(&mut b, &mut c);
    }
    if a.0 < b.0 {
        core::mem::swap(&mut a, &mut b);
    }
    ([a.0, b.0, c.0], [a.1, b.1, c.1], [a.2, b.2, c.2])
}

/// The singular value decomposition A = U Σ Vᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Svd {
    /// Descending, none negative.
    pub values: [f64; 3],
    /// Row `i` is the left singular vector of value `i` (Uᵀ); zero where the value is zero.
    pub left: Mat3,
    /// Row `i` is the right singular vector of value `i` (Vᵀ).
    pub right: Mat3,
}

/// The singular value decomposition of `a`, by one-sided Jacobi rotations of its columns: small singular values keep
/// their relative accuracy, because the product of A with its transpose is never formed.
#[must_use]
pub fn svd(a: &Mat3) -> Svd {
    let size = max_abs(a);
    if size == 0.0 || !size.is_finite() {
        return Svd { values: [size; 3], left: [[0.0; 3]; 3], right: IDENTITY };
    }
    let mut columns = transpose(a).map(|column| column.map(|entry| entry / size));
    let mut right = IDENTITY;
    for _ in 0..SWEEPS {
        let turned = orthogonalize::<0, 1>(&mut columns, &mut right)
            | orthogonalize::<0, 2>(&mut columns, &mut right)
            | orthogonalize::<1, 2>(&mut columns, &mut right);
        if !turned {
            break;
        }
    }
    let lengths = columns.map(|column| sqrt(dot(column, column)));
    let (values, mut left, right) = sorted(lengths, columns, right);
    for (vector, length) in left.iter_mut().zip(values) {
        *vector = scale(*vector, if length > 0.0 { 1.0 / length } else { 0.0 });
    }
    Svd { values: values.map(|value| value * size), left, right }
}

fn orthogonalize<const P: usize, const Q: usize>(columns: &mut Mat3, right: &mut Mat3) -> bool {
    let (p, q) = (columns[P], columns[Q]);
    let (pp, pq, qq) = (dot(p, p), dot(p, q), dot(q, q));
    if pq.abs() <= f64::EPSILON * sqrt(pp * qq) {
        return false;
    }
    let turn = rotation(pp, pq, qq);
    rotate_rows::<P, Q>(columns, turn);
    rotate_rows::<P, Q>(right, turn);
    true
}

/// The pseudo-inverse of a decomposed matrix over its singular values above `threshold` times the largest, and how
/// many those are.
#[must_use]
pub fn pseudo_inverse(svd: &Svd, threshold: f64) -> (Mat3, u32) {
    let mut inverse = [[0.0; 3]; 3];
    let mut rank = 0;
    for ((&value, left), right) in svd.values.iter().zip(&svd.left).zip(&svd.right) {
        if value > 0.0 && value > threshold * svd.values[0] {
            rank += 1;
            for (row, &v) in inverse.iter_mut().zip(right) {
                for (entry, &u) in row.iter_mut().zip(left) {
                    *entry += v * u / value;
                }
            }
        }
    }
    (inverse, rank)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    fn random(rng: &mut Rng) -> Mat3 {
        let mut m = IDENTITY;
        for entry in m.iter_mut().flatten() {
            *entry = rng.unit() * 2.0 - 1.0;
        }
        m
    }

    fn diagonal(values: [f64; 3]) -> Mat3 {
        let mut m = [[0.0; 3]; 3];
        for (i, value) in values.into_iter().enumerate() {
            m[i][i] = value;
        }
        m
    }

    fn assert_close(a: &Mat3, b: &Mat3, tolerance: f64) {
        for (x, y) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((x - y).abs() <= tolerance, "{a:?} is not {b:?}");
        }
    }

    #[test]
    fn products_and_inverses() {
        let (a, b) = (
            [[2.0, 1.0, 0.0], [0.5, 0.0, 3.0], [0.0, -1.0, 1.0]],
            [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 10.0]],
        );
        assert_eq!(multiply(&a, &b), [[6.0, 9.0, 12.0], [21.5, 25.0, 31.5], [3.0, 3.0, 4.0]]);
        assert_eq!(transpose(&a), [[2.0, 0.5, 0.0], [1.0, 0.0, -1.0], [0.0, 3.0, 1.0]]);
        assert_eq!(apply(&a, [1.0, 2.0, 3.0]), [4.0, 9.5, 1.0]);
        assert_eq!(cross([1.0, 2.0, 3.0], [4.0, 5.0, 7.0]), [-1.0, 5.0, -3.0]);
        assert_eq!(
            inverse(&b),
            Some([[-2.0 / 3.0, -4.0 / 3.0, 1.0], [-2.0 / 3.0, 11.0 / 3.0, -2.0], [1.0, -2.0, 1.0]])
        );
        assert_close(&multiply(&a, &inverse(&a).unwrap()), &IDENTITY, 1e-15);
        assert_eq!(inverse(&[[1.0; 3]; 3]), None);
        assert!(inverse(&[[f64::NAN; 3]; 3]).unwrap().iter().flatten().all(|entry| entry.is_nan()));
    }

    #[test]
    fn eigen_puts_the_matrix_together_again() {
        let mut rng = Rng::new(3);
        for _ in 0..500 {
            let half = random(&mut rng);
            let a = multiply(&half, &transpose(&half));
            let eigen = symmetric_eigen(&a);
            assert!(eigen.values[0] >= eigen.values[1] && eigen.values[1] >= eigen.values[2]);
            let again =
                multiply(&transpose(&eigen.vectors), &multiply(&diagonal(eigen.values), &eigen.vectors));
            assert_close(&a, &again, 1e-14);
            assert_close(&multiply(&eigen.vectors, &transpose(&eigen.vectors)), &IDENTITY, 1e-14);
        }
    }

    #[test]
    fn svd_puts_the_matrix_together_again_and_inverts_it() {
        let mut rng = Rng::new(4);
        for _ in 0..500 {
            let a = random(&mut rng).map(|row| row.map(|entry| entry * 1e150));
            let svd = svd(&a);
            let again = multiply(&transpose(&svd.left), &multiply(&diagonal(svd.values), &svd.right));
            assert_close(&a, &again, 1e136);
            let (inverse, rank) = pseudo_inverse(&svd, 1e-12);
            assert_eq!(rank, 3);
            assert_close(&multiply(&a, &inverse), &IDENTITY, 1e-10);
        }
    }

    #[test]
    fn small_singular_values_keep_their_accuracy() {
        let rank_two = svd(&[[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 1.0, 1.0]]);
        assert!(rank_two.values[2] < 1e-15);
        assert_eq!(pseudo_inverse(&rank_two, 1e-6).1, 2);
        let graded = svd(&diagonal([1e-20, 1.0, 1e-9]));
        assert_eq!(graded.values, [1.0, 1e-9, 1e-20]);
    }

    #[test]
    fn what_is_not_a_number_ends_too() {
        let nan = [[f64::NAN; 3]; 3];
        assert!(symmetric_eigen(&nan).values[0].is_nan());
        assert_eq!(svd(&[[f64::INFINITY; 3]; 3]).left, [[0.0; 3]; 3]);
        assert_eq!(svd(&[[0.0; 3]; 3]).values, [0.0; 3]);
    }
}
