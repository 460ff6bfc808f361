//! What a stream is to do.

use crate::color::lmeds::{self, MIN_PIXELS};
use crate::light::tilt::TiltEstimator;
use crate::solve::{self, Convexity, NormSource, OrientationMethod, SlantFallback};

/// Whether streams do all that [`solve`](crate::solve::solve) does.
pub const FULL: bool = cfg!(feature = "full-streams");

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// The pipeline's. `lmeds.sample_size` is how many colors the sample has room for, at least 24, here 2048 by default;
    /// tilts are Pentland's or given, and without a root slants are refused or fitted by least squares; the convexity is
    /// [`Convexity::Auto`]. Unless [`FULL`], the
    /// method is the direct one and shadows are not looked for.
    pub solve: solve::Params,
    /// Where less than this share of the usable pixels has a residual that the model accepts, in [0, 1], a frame does not
    /// refine it: a cold start is needed. Default 0.5, what least median of squares rests on.
    pub smallest_share: f64,
    /// About how many pixels a frame that refines the model looks at, those that the cold start could not use counting a
    /// third: every n-th row, at least 16, others from frame to frame. 0 looks at all rows. Default 16,384.
    pub refine_pixels: u32,
}

impl Default for Params {
    fn default() -> Self {
        let lmeds = lmeds::Params { sample_size: 2048, ..lmeds::Params::default() };
        let orientation_method = if FULL { OrientationMethod::Joint } else { OrientationMethod::Direct };
        let solve = solve::Params { lmeds, orientation_method, ..solve::Params::default() };
        Self { solve, smallest_share: 0.5, refine_pixels: 16_384 }
    }
}

impl Params {
    /// Whether every parameter is in its range, and one that rows can serve.
    #[must_use]
    pub fn are_valid(&self) -> bool {
        self.solve.are_valid()
            && (0.0..=1.0).contains(&self.smallest_share)
            // Merged strata leave half of the sample.
            && self.solve.lmeds.sample_size as usize >= 2 * MIN_PIXELS
            && (FULL || self.solve.orientation_method == OrientationMethod::Direct && !self.solve.rejects_shadows())
            && matches!(self.solve.tilts, TiltEstimator::Pentland | TiltEstimator::Given(_))
            && matches!(self.solve.fallback, SlantFallback::Refuse | SlantFallback::LeastSquares)
            && self.solve.norms == NormSource::Fit
            && self.solve.convexity == Convexity::Auto
    }
}
