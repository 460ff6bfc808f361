//! The transformation that was found, its twin, or why there is none.

use crate::math::mat3::{self, Mat3};
use crate::orientation::integrability::Integrability;
use core::fmt;
use libm::{acos, atan2, sqrt};

/// Why there is no transformation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrthogonalError {
    /// A parameter is out of its range, or a tilt is not finite.
    Params,
    /// The workspace is too short.
    WorkspaceTooShort,
    /// The root has no inverse, or is not finite.
    SingularRoot,
    /// There are no cells of four inliers, or the normals do not vary over them.
    NoCells,
}

impl fmt::Display for OrthogonalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Params => "a parameter is out of its range, or a tilt is not finite",
            Self::WorkspaceTooShort => "the workspace is too short",
            Self::SingularRoot => "the root has no inverse, or is not finite",
            Self::NoCells => "there are no cells of four inliers, or the normals do not vary over them",
        })
    }
}

impl core::error::Error for OrthogonalError {}

/// One member of O(3) and the F that follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transformation {
    /// r1, r2, r3: n = `rows` G0 rho. Its determinant is 1 or -1.
    pub rows: Mat3,
    /// F = G0^-1 `rows`^T, in pixel values.
    pub f: Mat3,
    /// F^-1 = `rows` G0.
    pub f_inverse: Mat3,
    /// The tilts of the rows of F in (-pi, pi].
    pub tilts: [f64; 3],
    /// The slants of the rows of F. One above pi/2 is no light of the paper's, and says that this is not the answer.
    pub slants: [f64; 3],
}

impl Transformation {
    pub(super) fn new(rows: Mat3, root: &Mat3, root_inverse: &Mat3) -> Self {
        let f = mat3::multiply(root_inverse, &mat3::transpose(&rows));
        let tilts = f.map(|[x, y, _]| atan2(y, x));
        let slants = f.map(|row| {
            let length = sqrt(mat3::dot(row, row));
            if length > 0.0 { acos((row[2] / length).clamp(-1.0, 1.0)) } else { 0.0 }
        });
        Self { rows, f, f_inverse: mat3::multiply(&rows, root), tilts, slants }
    }
}

/// What chose between the twins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TwinChoice {
    /// No tilts were given: the convex one, for which `n1_x + n2_y` is positive on the whole.
    Convex,
    /// The tilts of the rows of F that are nearer to those given.
    Tilts,
}

/// A minimum of the integral (15) and its convex/concave twin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The one of the two that was chosen.
    pub transformation: Transformation,
    /// The other: rows r1 and r2 with the other sign. Its integral is the same.
    pub twin: Transformation,
    /// What chose.
    pub choice: TwinChoice,
    /// How clear the choice is, from 0 (the twins are equally good) to 1: for tilts, the mean over channels of the
    /// cosine of the difference in tilt, weighted by the sines of the slants; for the convex twin,
    /// `sum(n1_x + n2_y)` over `sum |n1_x + n2_y|`.
    pub clarity: f64,
    /// The integral (15) of both, by [`crate::orientation::integrability::integral`].
    pub integral: Integrability,
    /// The integral (15) of what was found before the polish on the whole picture.
    pub unpolished: Integrability,
    /// Times the integral (15) was computed over the whole picture.
    pub evaluations: u32,
}
