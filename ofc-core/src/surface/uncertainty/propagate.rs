//! First-order propagation of the errors of C and of a rotation.

use crate::color::regression::{Triangle, whole};
use crate::math::mat3::Mat3;

/// The covariance of the nine entries of a 3x3 matrix, row-major.
pub type Covariance9 = [[f64; 9]; 9];

/// Entry (i, j) of each of `COUNT` matrices, as nine rows of `COUNT`: the derivatives of a matrix by `COUNT` numbers.
type Derivatives<const COUNT: usize> = [[f64; COUNT]; 9];

/// The covariance of the matrix T of [`uncertainty`](super), from F, the covariance of C, and the covariance of the rotation
/// for a given C.
///
/// Normals bent by an error of C have another best rotation. How far off it is depends on the surface; the mean square
/// taken here is that of the bending itself, which is what it comes to over many surfaces.
#[must_use]
#[inline(never)]
pub fn of_turn(f: &Mat3, c: &Triangle, rotation: &Mat3) -> Covariance9 {
    let mut covariance = [[0.0; 9]; 9];
    add(&mut covariance, &by_form(f), &whole(c));
    let bending = bending(&covariance) / 3.0;
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = *rotation;
    let rotation = [[xx + bending, xy, xz], [yx, yy + bending, yz], [zx, zy, zz + bending]];
    add(&mut covariance, &BY_ROTATION, &rotation);
    covariance
}

/// The mean square of a symmetric matrix, by the sum of the squares of its entries, without the part that changes lengths
/// alone.
fn bending(covariance: &Covariance9) -> f64 {
    let at = |i: usize, j: usize| covariance.get(i).and_then(|row| row.get(j)).copied().unwrap_or(0.0);
    let squares = (0..9).fold(0.0, |sum, i| sum + at(i, i));
    let lengths = (0..9).fold(0.0, |sum, k| sum + at(k / 3 * 4, k % 3 * 4));
    (squares - lengths / 3.0).max(0.0)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::ellipsoid::matrix;
    use crate::math::mat3;

    const F: Mat3 = [[90.0, 20.0, 60.0], [-40.0, 80.0, 70.0], [-30.0, -70.0, 95.0]];

    fn inverse(a: &Mat3) -> Mat3 {
        mat3::pseudo_inverse(&mat3::svd(a), 1e-12).0
    }

    /// A triangle for one error, with its products.
    fn of_one(errors: &[f64; 6]) -> Triangle {
        let mut triangle = [0.0; 21];
        crate::color::regression::add_square(&mut triangle, errors);
        triangle
    }

    #[test]
    fn an_error_of_c_bends_as_the_derivative_says() {
        let g = inverse(&F);
        let c = mat3::multiply(&mat3::transpose(&g), &g);
        let size = mat3::max_abs(&c);
        let errors = [0.3, -0.2, 0.4, 0.1, -0.5, 0.2].map(|e| 1e-5 * size * e);
        let mut turn = [[0.0; 9]; 9];
        add(&mut turn, &by_form(&F), &whole(&of_one(&errors)));
        // (I + T)^T-turned normals obey C + dC: G^T (I + T)^T (I + T) G = C + dC, with the signs that one pair of entries has.
        let mut t = [[0.0; 3]; 3];
        let sign = |k: usize| 1.0_f64.copysign(turn[0][k]);
        for k in 0..9 {
            t[k / 3][k % 3] = turn[k][k].sqrt() * sign(k);
        }
        let first =
            (mat3::dot(F.map(|row| row[0]), mat3::apply(&matrix(&errors), F.map(|row| row[0])))).signum();
        for (i, row) in t.iter_mut().enumerate() {
            *row = mat3::scale(*row, first);
            row[i] += 1.0;
        }
        let bent = mat3::multiply(&t, &g);
        let found = mat3::multiply(&mat3::transpose(&bent), &bent);
        let wanted = matrix(&errors);
        for i in 0..3 {
            for j in 0..3 {
                assert!((found[i][j] - c[i][j] - wanted[i][j]).abs() < 1e-9 * size, "{i} {j}");
            }
        }
    }

    #[test]
    fn forms_are_the_covariance_of_the_turned_normal() {
        let mut turn = [[0.0; 9]; 9];
        for (i, row) in turn.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = 0.1 * (i + j) as f64 + 0.01 * (i * j) as f64;
            }
        }
        let n = [0.3, -0.5, 0.8];
        let [x, y, z] = n;
        let monomials = [x * x, y * y, z * z, x * y, x * z, y * z];
        let places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        for (form, (i, j)) in forms(&turn).iter().zip(places) {
            let found: f64 = form.iter().zip(monomials).map(|(entry, term)| entry * term).sum();
            let mut wanted = 0.0;
            for a in 0..3 {
                for b in 0..3 {
                    wanted += n[a] * n[b] * turn[3 * i + a][3 * j + b];
                }
            }
            assert!((found - wanted).abs() < 1e-14, "{i} {j}");
        }
    }

    #[test]
    fn f_and_its_inverse_err_together() {
        // A rotation about z alone by 1e-5: F^-1 becomes T F^-1.
        let rotation = [[0.0; 3], [0.0; 3], [0.0, 0.0, 1e-10]];
        let turn = of_turn(&F, &[0.0; 21], &rotation);
        let g = inverse(&F);
        let turned = mat3::multiply(&[[0.0, -1e-5, 0.0], [1e-5, 0.0, 0.0], [0.0; 3]], &g);
        let back = mat3::multiply(&F, &[[0.0, -1e-5, 0.0], [1e-5, 0.0, 0.0], [0.0; 3]]);
        let (of_g, of_f) = (of_f_inverse(&g, &turn), of_f(&F, &turn));
        for i in 0..9 {
            for j in 0..9 {
                let (a, b) =
                    (turned[i / 3][i % 3] * turned[j / 3][j % 3], back[i / 3][i % 3] * back[j / 3][j % 3]);
                assert!((of_g[i][j] - a).abs() < 1e-12 * 1e-10 && (of_f[i][j] - b).abs() < 1e-10 * 1e-4);
            }
        }
    }

    #[test]
    fn a_change_of_length_does_not_bend() {
        let g = inverse(&F);
        let c = mat3::multiply(&mat3::transpose(&g), &g);
        let z = [c[0][0], c[1][1], c[2][2], c[0][1], c[0][2], c[1][2]];
        let mut turn = [[0.0; 9]; 9];
        add(&mut turn, &by_form(&F), &whole(&of_one(&z.map(|entry| 0.02 * entry))));
        assert!((turn[0][0] - 1e-4).abs() < 1e-12 && bending(&turn) < 1e-12);
        let other = of_turn(&F, &of_one(&[0.02 * c[0][0], 0.0, 0.0, 0.0, 0.0, 0.0]), &[[0.0; 3]; 3]);
        assert!((other[1][1] - other[3][3]).abs() < 1e-15 && other[1][1] > 0.0);
    }
}
