//! The transformation, how sure it is, and what decided.

use super::information::trace;
use crate::math::mat3::{self, Mat3};
use libm::sqrt;

/// Which evidence decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// More than three quarters of the information are the outward normals'.
    Outward,
    /// More than three quarters are integrability's.
    Integrability,
    /// Neither.
    Both,
}

/// The transformation, and how sure it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// r1, r2, r3: n = `rows` G0 rho. Its determinant is 1 or -1.
    pub rows: Mat3,
    /// Covariance of the small rotation, a vector in the frame of n, by which `rows` may be wrong; radians squared.
    pub covariance: Mat3,
    /// What decided.
    pub evidence: Evidence,
    /// From 0 (dome and hollow fit alike) to 1 (all of the surface is a dome): how clear the choice between the twins is. The
    /// [`Self::twin`] of a dome has the negative.
    pub convexity: f64,
    /// How much less likely the best of the candidates that are more than [`APART`](super::APART) away is: the difference of the
    /// two negative log likelihoods; infinite where there is none.
    pub second_best: f64,
}

impl Joint {
    /// The root mean square angle, over directions, by which normals are expected to be turned.
    #[must_use]
    pub fn expected_error(&self) -> f64 {
        sqrt(2.0 / 3.0 * trace(&self.covariance))
    }

    /// The convex/concave twin: r1 and r2 have the other sign, and so have the entries of the covariance between them and r3.
    #[must_use]
    pub fn twin(&self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.rows, self.covariance);
        let across = |[x, y, z]: [f64; 3]| [x, y, -z];
        Self {
            rows: [mat3::scale(x, -1.0), mat3::scale(y, -1.0), z],
            covariance: [across(a), across(b), mat3::scale(across(c), -1.0)],
            convexity: -self.convexity,
            ..*self
        }
    }
}
