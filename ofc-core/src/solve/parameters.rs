//! What to do: how F is oriented, where tilts and slants come from, which pixels count.

use super::fallback::SlantFallback;
use crate::color::lmeds;
use crate::light::tilt::TiltEstimator;
use crate::orientation::matrix::RANK_THRESHOLD;
use crate::picture::{Image, Usable};

/// How the orthogonal transformation that the regression leaves open is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrientationMethod {
    /// From integrability and outward normals together, see [`crate::orientation::joint`].
    Joint,
    /// The paper's: slants from tilts (section 3).
    Direct,
}

/// Whether colors that one of the lights does not reach are looked for and left out before the fit that counts. The paper
/// has no such step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadowRejection {
    /// On with the joint method, off with the direct one: that is the paper's.
    #[default]
    Auto,
    /// Whatever the method.
    On,
    /// Whatever the method.
    Off,
}

/// Where the lengths of F's rows, the strengths of the channels' lights, come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormSource {
    /// From C, eq. 18.
    #[default]
    Fit,
    /// They are the largest value of each channel over the inliers, see [`channel_maxima`](crate::light::channel_maxima).
    /// Slants do not change with it, the lengths of the normals do (section 4).
    ChannelMaxima,
}

/// Whether the surface is a dome or a hollow, which its colors cannot tell: a surface and its twin, whose depth has the other
/// sign, have the same colors under lights that are turned half about the line of sight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Convexity {
    /// Whichever of the two is more of a dome; how clear that is, the solution says.
    #[default]
    Auto,
    /// The same, by the caller's word.
    Convex,
    /// The other one.
    Hollow,
}

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// The regression in color space.
    pub lmeds: lmeds::Params,
    /// A pixel is saturated if a channel is at or above this; `None` for the largest value of the pixel type, and no
    /// limit for f32. Default `None`.
    pub saturation: Option<f32>,
    /// Whether colors that one of the lights does not reach are left out. Default [`ShadowRejection::Auto`].
    pub shadow_rejection: ShadowRejection,
    /// How F is oriented. Given tilts, and a picture that is too small for [`OrientationMethod::Joint`], take the direct method whatever
    /// this is. Default [`OrientationMethod::Joint`].
    pub orientation_method: OrientationMethod,
    /// Where the tilts come from, with the direct method. Default [`TiltEstimator::Pentland`].
    pub tilts: TiltEstimator,
    /// Singular values of F below this share of the largest are zero, in [0, 1). Default 1e-3.
    pub rank_threshold: f64,
    /// Where the slants come from when eqs. 25 have no root. Default [`SlantFallback::LeastSquares`].
    pub fallback: SlantFallback,
    /// Where the lengths of F's rows come from, with the direct method. Default [`NormSource::Fit`].
    pub norms: NormSource,
    /// Which of a surface and its twin is taken; given tilts choose by themselves. Default [`Convexity::Auto`].
    pub convexity: Convexity,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            lmeds: lmeds::Params::default(),
            saturation: None,
            shadow_rejection: ShadowRejection::Auto,
            orientation_method: OrientationMethod::Joint,
            tilts: TiltEstimator::Pentland,
            rank_threshold: RANK_THRESHOLD,
            fallback: SlantFallback::LeastSquares,
            norms: NormSource::Fit,
            convexity: Convexity::Auto,
        }
    }
}

impl Params {
    /// Whether every parameter is in its range.
    #[must_use]
    pub fn are_valid(&self) -> bool {
        self.lmeds.subset_count().is_some()
            && self.saturation.is_none_or(|level| level > 0.0)
            && (0.0..1.0).contains(&self.rank_threshold)
            && match self.tilts {
                TiltEstimator::Given(tilts) => tilts.iter().all(|tilt| tilt.is_finite()),
                _ => true,
            }
    }

    /// Whether F is oriented as a whole, where it can be.
    pub(crate) const fn is_joint(&self) -> bool {
        matches!(self.orientation_method, OrientationMethod::Joint)
            && !matches!(self.tilts, TiltEstimator::Given(_))
    }

    /// Whether the twin of the dome is taken.
    pub(crate) const fn is_hollow(&self) -> bool {
        matches!(self.convexity, Convexity::Hollow) && !matches!(self.tilts, TiltEstimator::Given(_))
    }

    /// Whether colors that one of the lights does not reach are left out.
    pub(crate) const fn rejects_shadows(&self) -> bool {
        match self.shadow_rejection {
            ShadowRejection::Auto => self.is_joint(),
            ShadowRejection::On => true,
            ShadowRejection::Off => false,
        }
    }

    /// Which pixels of `image` can be used.
    #[must_use]
    pub fn usable(&self, image: &Image) -> Usable {
        Usable::below(self.saturation.unwrap_or(image.sample().saturation()))
    }
}
