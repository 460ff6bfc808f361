//! The orthogonal transformation from the linear form of integrability: r1 and r2 together are one eigenvector.
//!
//! Multiplied by n3^2 the condition p_y = q_x reads `r1 . (N x N_x) + r2 . (N x N_y) = 0` at every pixel: linear in the six
//! numbers (r1, r2), and r3 does not appear. So (r1, r2) is, up to a factor, the eigenvector of the smallest eigenvalue of
//! a 6x6 matrix that one pass over the picture sums. It is unique for surfaces as simple as a sphere, and the sign that it
//! leaves open is the convex/concave twin. The nearest orthonormal pair to it, and r3 across both with normals toward the
//! camera, make the answer; which determinant it has is decided by the data.
//!
//! This is not in the paper: it needs no smoothness, and finds the same minimum as the annealing on pictures with little
//! noise. It weighs a pixel by n3^4 relative to (15).
//!
//! # Reference
//! Section 2.3, eq. 15. A. Yuille, D. Snow, "Shape and albedo from multiple images using integrability", CVPR 1997, use
//! the same form for photometric stereo.

use super::closed_form::{remaining_angle, sum_of_normals};
use super::sample::for_each_cell;
use super::{Found, OrthogonalError, Problem};
use crate::image::{Image, Window};
use crate::mat3::{self, Mat3};
use nalgebra::{Matrix6, Vector6};

/// Steps of the inverse iteration: the error falls by the ratio of the two smallest eigenvalues each time.
const STEPS: usize = 64;
/// What is added to the diagonal, as a share of the trace, so that the smallest eigenvalue may be zero.
const SHIFT: f64 = 1e-12;

/// The transformation of the normals `root` rho of the pixels that `inliers` gives the bits of.
///
/// `tilts` of the rows of F, where known, choose between the twins.
///
/// # Units
/// `root` in (pixel value)^-1, tilts in radians, the integral in pixel^-2.
///
/// # Errors
/// See [`OrthogonalError`]; the workspace is never too short.
///
/// # Scratch
/// None but about 8 KiB of stack. Four passes over the picture, and one for each evaluation of the polish.
pub fn linear(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    root: &Mat3,
    tilts: Option<[f64; 3]>,
    polish_evaluations: u32,
) -> Result<Found, OrthogonalError> {
    let problem = Problem::new(image, inliers, root, tilts)?;
    let mut matrix = Matrix6::zeros();
    for_each_cell(image, &problem.inliers, root, |n, n_x, n_y| {
        let ([a1, a2, a3], [b1, b2, b3]) = (mat3::cross(n, n_x), mat3::cross(n, n_y));
        let row = Vector6::new(a1, a2, a3, b1, b2, b3);
        matrix += row * row.transpose();
    });
    let vector = smallest(&matrix).ok_or(OrthogonalError::NoCells)?;
    let [a1, a2, a3, b1, b2, b3]: [f64; 6] = vector.into();
    let across = mat3::cross([a1, a2, a3], [b1, b2, b3]);
    let r3 = super::unit(across).ok_or(OrthogonalError::NoCells)?;
    let toward = mat3::dot(r3, sum_of_normals(image, &problem.inliers, root));
    let r3 = mat3::scale(r3, if toward < 0.0 { -1.0 } else { 1.0 });
    // With r3 known the pair across it is best found from (15) itself.
    let rows = remaining_angle(image, &problem.inliers, root, r3).ok_or(OrthogonalError::NoCells)?;
    problem.finish(rows, polish_evaluations)
}

/// The eigenvector of the smallest eigenvalue of a positive semi-definite matrix, by inverse iteration.
fn smallest(matrix: &Matrix6<f64>) -> Option<Vector6<f64>> {
    let trace = matrix.trace();
    if !(trace > 0.0 && trace.is_finite()) {
        return None;
    }
    let shifted = matrix / trace + Matrix6::identity() * SHIFT;
    let inverse = shifted.cholesky()?.inverse();
    // No symmetric picture is likely to have an eigenvector exactly across this one.
    let mut vector = Vector6::new(1.0, 0.3, -0.2, 0.17, 0.9, 0.41);
    for _ in 0..STEPS {
        let next = inverse * vector;
        let length = next.norm();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        vector = next / length;
    }
    Some(vector)
}
