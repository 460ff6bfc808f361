//! The color-space quadratic form: colors of a matte surface lie on the ellipsoid rho^T C rho = 1.
//!
//! # Reference
//! Section 2.1, eqs. 8-10 and 18.

use crate::math::mat3::{self, Mat3};
use core::fmt;
use libm::sqrt;

/// The six coefficients z = (c11, c22, c33, c12, c13, c23) of eq. 10, in (pixel value)^-2.
pub type Coefficients = [f64; 6];

/// The symmetric matrix C of the coefficients.
#[must_use]
pub const fn matrix(z: &Coefficients) -> Mat3 {
    let [c11, c22, c33, c12, c13, c23] = *z;
    [[c11, c12, c13], [c12, c22, c23], [c13, c23, c33]]
}

/// rho^T C rho, the squared length of the normal that C makes of a color (eq. 9).
#[must_use]
#[inline]
pub fn quadratic_form(z: &Coefficients, r: f32, g: f32, b: f32) -> f64 {
    let [c11, c22, c33, c12, c13, c23] = *z;
    let (r, g, b) = (f64::from(r), f64::from(g), f64::from(b));
    let cross = c12 * r * g + c13 * r * b + c23 * g * b;
    c11 * r * r + c22 * g * g + c33 * b * b + 2.0 * cross
}

/// rho^T C rho - 1 in single precision, for what compares residuals of scaled colors and needs no digit of them.
#[inline]
pub(crate) fn single_residual(z: &[f32; 6], [r, g, b]: [f32; 3]) -> f32 {
    let [c11, c22, c33, c12, c13, c23] = *z;
    let red = r * (c11 * r + 2.0 * (c12 * g + c13 * b));
    let green = g * (c22 * g + 2.0 * c23 * b);
    red + green + c33 * b * b - 1.0
}

/// Whether C is positive definite, by its leading minors: cheap enough for every candidate of a search.
#[must_use]
pub fn is_positive_definite(z: &Coefficients) -> bool {
    let [c11, c22, c33, c12, c13, c23] = *z;
    let minor2 = c11 * c22 - c12 * c12;
    let determinant = c33 * minor2 - c11 * c23 * c23 - c22 * c13 * c13 + 2.0 * c12 * c13 * c23;
    c11 > 0.0 && minor2 > 0.0 && determinant > 0.0
}

/// What C says of the color-orientation matrix F before its orthogonal transformation is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// C itself.
    pub c: Mat3,
    /// The eigenvalues of C, descending: the squared inverse semi-axes.
    pub eigenvalues: [f64; 3],
    /// The root G0 = sqrt(Lambda) U^T of C = G0^T G0: it turns colors into normals, up to an orthogonal transformation.
    pub root: Mat3,
    /// F F^T = C^-1 (eq. 18), in (pixel value)^2.
    pub f_f_transposed: Mat3,
    /// The lengths of the rows f1, f2, f3 of F: the strength of each channel's equivalent light, in pixel values.
    pub norms: [f64; 3],
    /// The cosines (h12, h13, h23) of the angles between the rows of F.
    pub cosines: [f64; 3],
}

impl Ellipsoid {
    /// The inverse of the root.
    #[must_use]
    pub fn root_inverse(&self) -> Mat3 {
        mat3::pseudo_inverse(&mat3::svd(&self.root), f64::EPSILON).0
    }
}

/// C has an eigenvalue that is not positive: the colors do not lie on an ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotPositiveDefinite {
    /// The eigenvalues of C, descending.
    pub eigenvalues: [f64; 3],
}

impl fmt::Display for NotPositiveDefinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the colors do not lie on an ellipsoid: C is not positive definite")
    }
}

impl core::error::Error for NotPositiveDefinite {}

/// An eigenvalue below this share of the largest is zero in f64.
const SMALLEST_EIGENVALUE_RATIO: f64 = 1e-14;

/// Decomposes C.
///
/// # Errors
/// [`NotPositiveDefinite`], also when a coefficient is not finite.
pub fn decompose(z: &Coefficients) -> Result<Ellipsoid, NotPositiveDefinite> {
    let c = matrix(z);
    let eigen = mat3::symmetric_eigen(&c);
    let [largest, middle, smallest] = eigen.values;
    // Numbers of extreme range may have no eigenvalues: the middle one is a number where it is no less than another.
    let positive = smallest > largest * SMALLEST_EIGENVALUE_RATIO
        && smallest > 0.0
        && largest.is_finite()
        && middle >= smallest;
    if !positive {
        return Err(NotPositiveDefinite { eigenvalues: eigen.values });
    }
    let (mut root, mut inverse_root) = (eigen.vectors, eigen.vectors);
    for ((row, inverse_row), value) in root.iter_mut().zip(&mut inverse_root).zip(eigen.values) {
        *row = mat3::scale(*row, sqrt(value));
        *inverse_row = mat3::scale(*inverse_row, 1.0 / sqrt(value));
    }
    let f_f_transposed = mat3::multiply(&mat3::transpose(&inverse_root), &inverse_root);
    let [[f11, f12, f13], [_, f22, f23], [_, _, f33]] = f_f_transposed;
    let norms = [sqrt(f11), sqrt(f22), sqrt(f33)];
    let [n1, n2, n3] = norms;
    let cosines = [f12 / (n1 * n2), f13 / (n1 * n3), f23 / (n2 * n3)];
    Ok(Ellipsoid { c, eigenvalues: eigen.values, root, f_f_transposed, norms, cosines })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn a_known_f_comes_back_as_norms_and_cosines() {
        // Rows of lengths 2, 3 and 6 with known angles between them.
        let f = [[2.0, 0.0, 0.0], [1.8, 2.4, 0.0], [0.0, 4.8, 3.6]];
        let inverse = mat3::pseudo_inverse(&mat3::svd(&f), 1e-9).0;
        let c = mat3::multiply(&mat3::transpose(&inverse), &inverse);
        let ellipsoid = decompose(&[c[0][0], c[1][1], c[2][2], c[0][1], c[0][2], c[1][2]]).unwrap();
        for (got, want) in ellipsoid.norms.iter().zip([2.0, 3.0, 6.0]) {
            assert!((got - want).abs() < 1e-12);
        }
        for (got, want) in ellipsoid.cosines.iter().zip([0.6, 0.0, 0.64]) {
            assert!((got - want).abs() < 1e-12);
        }
        let f_f_transposed = mat3::multiply(&f, &mat3::transpose(&f));
        let root_squared = mat3::multiply(&mat3::transpose(&ellipsoid.root), &ellipsoid.root);
        let unity = mat3::multiply(&ellipsoid.root, &ellipsoid.root_inverse());
        for (found, wanted) in
            [(ellipsoid.f_f_transposed, f_f_transposed), (root_squared, c), (unity, mat3::IDENTITY)]
        {
            for (found, wanted) in found.as_flattened().iter().zip(wanted.as_flattened()) {
                assert!((found - wanted).abs() < 1e-12, "{found:?} {wanted:?}");
            }
        }
        assert_eq!(ellipsoid.c, matrix(&[c[0][0], c[1][1], c[2][2], c[0][1], c[0][2], c[1][2]]));
    }

    #[test]
    fn forms_are_positive_definite_where_their_eigenvalues_are() {
        let mut rng = Rng::new(9);
        let mut definite = 0;
        for _ in 0..2000 {
            let [c11, c22, c33] = [(); 3].map(|()| 1.2 * rng.unit() - 0.1);
            let [c12, c13, c23] = [(); 3].map(|()| 1.2 * rng.unit() - 0.6);
            let z = [c11, c22, c33, c12, c13, c23];
            let [.., smallest] = mat3::symmetric_eigen(&matrix(&z)).values;
            if smallest.abs() > 1e-6 {
                assert_eq!(is_positive_definite(&z), smallest > 0.0, "{z:?}");
                assert_eq!(decompose(&z).is_ok(), smallest > 0.0);
                definite += u32::from(smallest > 0.0);
            }
        }
        assert!((200..1800).contains(&definite), "{definite}");
    }

    #[test]
    fn the_form_is_the_matrix_between_colors() {
        let mut rng = Rng::new(10);
        for _ in 0..100 {
            let z: Coefficients = [(); 6].map(|()| 2.0 * rng.unit() - 1.0);
            let color = [(); 3].map(|()| rng.unit() as f32);
            let [r, g, b] = color;
            let rho = color.map(f64::from);
            let wanted = mat3::dot(rho, mat3::apply(&matrix(&z), rho));
            assert!((quadratic_form(&z, r, g, b) - wanted).abs() < 1e-14);
            let single = f64::from(single_residual(&z.map(|c| c as f32), color));
            assert!((single - (wanted - 1.0)).abs() < 2e-6, "{single} {wanted}");
        }
    }

    #[test]
    fn an_indefinite_form_is_refused() {
        assert!(decompose(&[1.0, 1.0, -1.0, 0.0, 0.0, 0.0]).is_err());
        assert!(decompose(&[1.0, 1.0, 0.0, 0.0, 0.0, 0.0]).is_err());
        assert!(decompose(&[1.0, 1.0, f64::NAN, 0.0, 0.0, 0.0]).is_err());
        assert!(!is_positive_definite(&[1.0, 1.0, 1.0, 2.0, 0.0, 0.0]));
        assert!(is_positive_definite(&[1.0, 2.0, 3.0, 0.1, 0.2, 0.3]));
    }
}
