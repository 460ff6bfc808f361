//! Tilts of the channels' equivalent lights, one estimator a file.

pub mod chojnacki;
pub mod lee_rosenfeld;
pub mod pentland;
pub mod zheng_chellappa;

use crate::color::inliers::Inliers;
use crate::picture::Image;

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
}

/// Where tilts come from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TiltEstimator {
    /// [`pentland`], along the axes and the diagonals.
    #[default]
    Pentland,
    /// [`lee_rosenfeld`].
    LeeRosenfeld,
    /// [`zheng_chellappa`].
    ZhengChellappa,
    /// [`chojnacki`], over the largest disc inside the inliers.
    Chojnacki,
    /// The caller knows them, radians.
    Given([f64; 3]),
}

impl TiltEstimator {
    /// The tilts of the inliers; `None` where the estimator has none.
    ///
    /// # Scratch
    /// For Chojnacki's [`chojnacki::workspace_len`] `f32`, for the others none.
    pub fn estimate(&self, image: &Image, inliers: &Inliers, workspace: &mut [f32]) -> Option<Tilts> {
        let bits = inliers.selector();
        match *self {
            Self::Pentland => pentland::tilts(image, bits),
            Self::LeeRosenfeld => lee_rosenfeld::tilts(image, bits).map(Tilts::alone),
            Self::ZhengChellappa => zheng_chellappa::tilts(image, bits).map(Tilts::alone),
            Self::Chojnacki => {
                let disc = chojnacki::largest_disc(image, bits, workspace)?;
                chojnacki::tilts(image, bits, &disc).map(Tilts::alone)
            }
            Self::Given(tilts) => Some(Tilts::alone(tilts)),
        }
    }
}

/// Whether a mean gradient points anywhere.
fn has_direction(x: f64, y: f64) -> bool {
    x.is_finite() && y.is_finite() && (x != 0.0 || y != 0.0)
}
