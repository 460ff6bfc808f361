//! The choice of an estimator of tilts.

use super::{Tilts, chojnacki, lee_rosenfeld, pentland, zheng_chellappa};
use crate::color::inliers::Inliers;
use crate::picture::Image;

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
