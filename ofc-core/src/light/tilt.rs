//! Tilts of the channels' equivalent lights, one estimator a file.

mod estimator;

pub mod chojnacki;
pub mod lee_rosenfeld;
pub mod pentland;
pub mod zheng_chellappa;

pub use estimator::TiltEstimator;

use libm::atan2;

/// Tilts, and what they come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilts {
    /// The tilt of each channel's light in (-pi, pi], counter-clockwise from x, for a convex surface.
    pub tilts: [f64; 3],
    /// The mean gradient (Ix, Iy) of each channel, in pixel values a pixel, y up; zero where the estimator has none.
    pub gradients: [[f64; 2]; 3],
}

impl Tilts {
    /// Tilts that come from no gradient.
    pub(crate) const fn alone(tilts: [f64; 3]) -> Self {
        Self { tilts, gradients: [[0.0; 2]; 3] }
    }

    /// The tilts of the channels' mean gradients, eq. 21; `None` where one is unknown or zero.
    fn of_gradients(gradient: impl Fn(usize) -> Option<[f64; 2]>) -> Option<Self> {
        let mut found = Self::alone([0.0; 3]);
        let channels = found.tilts.iter_mut().zip(&mut found.gradients);
        for (channel, (tilt, slot)) in channels.enumerate() {
            *slot = gradient(channel)?;
            *tilt = angle(*slot)?;
        }
        Some(found)
    }
}

/// The angle of a vector in (-pi, pi], counter-clockwise from x; `None` where it points nowhere.
fn angle([x, y]: [f64; 2]) -> Option<f64> {
    let has_direction = x.is_finite() && y.is_finite() && (x != 0.0 || y != 0.0);
    has_direction.then(|| atan2(y, x))
}
