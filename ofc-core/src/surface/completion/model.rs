//! How sure a normal is, apart from the noise of its pixels: what C and the orientation leave open.

use super::three;
use super::vector::{Matrix, Vector};
use crate::math::mat3::{self, Mat3};
use crate::surface::uncertainty::{Sources, Uncertainty, one_sigma};
use libm::hypotf;

/// The errors that all pixels share, and the noise of each.
pub(super) struct Model {
    shared: Uncertainty,
    f: Mat3,
    noise: Matrix,
}

impl Model {
    /// `noise` is the covariance of a pixel's raw normal.
    pub fn new(sources: &Sources, noise: &Matrix) -> Self {
        Self { shared: Uncertainty::new(&Sources { noise: 0.0, ..*sources }), f: sources.f, noise: *noise }
    }

    /// The angle in radians below which 68 % of errors are expected, for a normal that had no noise.
    pub fn shared(&self, n: Vector) -> f32 {
        self.shared.angle(mat3::apply(&self.f, n.map(f64::from)).map(|x| x as f32)) as f32
    }

    /// The same for a pixel that sees three lights.
    pub fn of_three(&self, n: Vector) -> f32 {
        let noise = three::left(&self.noise, n).map(|row| row.map(f64::from));
        hypotf(self.shared(n), one_sigma(&noise, n.map(f64::from)) as f32)
    }
}
