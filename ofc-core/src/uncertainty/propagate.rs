//! First-order propagation of the errors of C and of a rotation.

use crate::mat3::Mat3;
use crate::regression::{Triangle, whole};

/// The covariance of the nine entries of a 3x3 matrix, row-major.
pub type Covariance9 = [[f64; 9]; 9];

/// Entry (i, j) of each of `COUNT` matrices, as nine rows of `COUNT`: the derivatives of a matrix by `COUNT` numbers.
type Derivatives<const COUNT: usize> = [[f64; COUNT]; 9];

/// The covariance of the matrix T of the parent's head, for F, the covariance of C and that of the rotation.
#[must_use]
#[inline(never)]
pub fn of_turn(f: &Mat3, c: &Triangle, rotation: &Mat3) -> Covariance9 {
    let mut covariance = [[0.0; 9]; 9];
    add(&mut covariance, &by_form(f), &whole(c));
    add(&mut covariance, &BY_ROTATION, rotation);
    covariance
}

/// F^T dC F / 2 by the six coefficients of C.
fn by_form(f: &Mat3) -> Derivatives<6> {
    let [f1, f2, f3] = *f;
    let mut derivatives = [[0.0; 6]; 9];
    for (place, row) in derivatives.iter_mut().enumerate() {
        let (i, j) = (place / 3, place % 3);
        let at = |row: [f64; 3], i: usize| row.get(i).copied().unwrap_or(0.0);
        let product = |a, b| at(a, i) * at(b, j);
        let both = |a, b| product(a, b) + product(b, a);
        *row = [product(f1, f1), product(f2, f2), product(f3, f3), both(f1, f2), both(f1, f3), both(f2, f3)]
            .map(|entry| 0.5 * entry);
    }
    derivatives
}

/// \[w\]x by w.
const BY_ROTATION: Derivatives<3> = [
    [0.0, 0.0, 0.0],
    [0.0, 0.0, -1.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 0.0, 0.0],
];

/// Adds D S D^T.
#[inline(never)]
fn add<const COUNT: usize>(sum: &mut Covariance9, d: &Derivatives<COUNT>, s: &[[f64; COUNT]; COUNT]) {
    let dot = |a: &[f64; COUNT], b: &[f64; COUNT]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
    for (row, left) in sum.iter_mut().zip(d) {
        let product = s.each_ref().map(|line| dot(line, left));
        for (entry, right) in row.iter_mut().zip(d) {
            *entry += dot(&product, right);
        }
    }
}

/// The covariance of F, from that of T: dF = -F T.
#[must_use]
#[inline(never)]
pub fn of_f(f: &Mat3, turn: &Covariance9) -> Covariance9 {
    let mut derivatives = [[0.0; 9]; 9];
    for (place, row) in derivatives.iter_mut().enumerate() {
        let [a, b, c] = f.get(place / 3).copied().unwrap_or_default();
        for (k, factor) in [a, b, c].into_iter().enumerate() {
            if let Some(entry) = row.get_mut(3 * k + place % 3) {
                *entry = -factor;
            }
        }
    }
    let mut covariance = [[0.0; 9]; 9];
    add(&mut covariance, &derivatives, turn);
    covariance
}

/// The covariance of F^-1, from that of T: d F^-1 = T F^-1.
#[must_use]
#[inline(never)]
pub fn of_f_inverse(f_inverse: &Mat3, turn: &Covariance9) -> Covariance9 {
    let mut derivatives = [[0.0; 9]; 9];
    for (place, row) in derivatives.iter_mut().enumerate() {
        for (k, line) in f_inverse.iter().enumerate() {
            if let (Some(entry), Some(factor)) = (row.get_mut(place / 3 * 3 + k), line.get(place % 3)) {
                *entry = *factor;
            }
        }
    }
    let mut covariance = [[0.0; 9]; 9];
    add(&mut covariance, &derivatives, turn);
    covariance
}

/// The six entries (xx, yy, zz, xy, xz, yz) of the covariance of T n as quadratic forms in n.
#[inline(never)]
pub(super) fn forms(turn: &Covariance9) -> [[f64; 6]; 6] {
    const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    let at = |i: usize, a: usize, j: usize, b: usize| {
        turn.get(3 * i + a).and_then(|row| row.get(3 * j + b)).copied().unwrap_or(0.0)
    };
    PLACES.map(|(i, j)| {
        PLACES.map(|(a, b)| if a == b { at(i, a, j, b) } else { at(i, a, j, b) + at(i, b, j, a) })
    })
}
