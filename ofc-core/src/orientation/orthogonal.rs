//! The orthogonal transformation that the regression leaves open, by integrability: no estimator of light direction.
//!
//! The root G0 of C turns colors into N = G0 rho, the normals up to a member of O(3). With rows r1, r2, r3 of that
//! member as in section 2.4 the normal is n = (r1.N, r2.N, r3.N); the paper's R of eqs. 13-14 is the matrix that has
//! r1, r2, r3 as columns. So F^-1 = (rows) G0 and F = G0^-1 (rows)^T.
//!
//! [`annealing`] minimizes the integral (15) itself; [`closed_form`] takes r3 from the smoothness condition (16) and the
//! remaining angle from (15). Both end in [`Found`]: neither can tell a surface from its convex/concave twin, for which
//! rows r1 and r2 have the other sign (section 2.4), so both are given, and tilts from elsewhere choose between them
//! where there are any.
//!
//! In both the slope condition is taken in the form
//!
//! ```text
//! n3^2 (p_y - q_x) = -(c1 . (N x N_x) + c2 . (N x N_y)),   c1 = r2 x r3,  c2 = r3 x r1,
//! ```
//!
//! which is the quotient rule written with cross products; c1 = r1 and c2 = r2 up to the sign of the determinant.
//!
//! # Reference
//! Sections 2.3-2.4, eqs. 13-16.

pub mod annealing;
pub mod closed_form;
pub(crate) mod polish;
mod problem;
mod result;
pub(crate) mod sample;
pub mod tilts_given;

pub use result::{Found, OrthogonalError, Transformation, TwinChoice};
