//! Where slants come from when eqs. 25 have no root.
//!
//! # Reference
//! Section 3.3: "one could fall back on other slant estimators, or else minimize (15) subject to having knowledge of the
//! tilts".

use super::choice::SlantSource;
use crate::color::ellipsoid::Ellipsoid;
use crate::color::inliers::Inliers;
use crate::light::constrained_slant;
use crate::light::slant::{lee_rosenfeld, pentland, zheng_chellappa};
use crate::orientation::orthogonal::tilts_given;
use crate::picture::Image;

/// What to do where eqs. 25 have no root (section 3.3). The lengths of the rows of F are those of the ellipsoid, whatever
/// the slants are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlantFallback {
    /// `Outcome::NoConsistentSlants`.
    Refuse,
    /// The slants that satisfy eqs. 24 best.
    #[default]
    LeastSquares,
    /// The slants that make (15) smallest among those that eqs. 24 do not rule out: [`tilts_given`] with its defaults, on
    /// as many cells as the workspace of `solve` has room for.
    TiltIntegrability,
    /// Pentland's, eq. 22.
    PentlandSlant,
    /// Lee and Rosenfeld's, eq. 23.
    LeeRosenfeldSlant,
    /// Zheng and Chellappa's, over all usable pixels.
    ZhengChellappaSlant,
}

/// The slants of this fallback; `None` where it has none.
// Its stack is needed only where there is no root.
#[inline(never)]
pub(super) fn slants(
    fallback: SlantFallback,
    image: &Image,
    inliers: &Inliers,
    ellipsoid: &Ellipsoid,
    tilts: [f64; 3],
    workspace: &mut [f32],
) -> Option<([f64; 3], SlantSource)> {
    let bits = inliers.selector();
    match fallback {
        SlantFallback::Refuse => None,
        SlantFallback::LeastSquares => {
            let nearest = constrained_slant::least_squares(tilts, ellipsoid.cosines);
            Some((nearest.slants, SlantSource::LeastSquares))
        }
        SlantFallback::TiltIntegrability => {
            let cells = tilts_given::Params::default();
            let room = tilts_given::workspace_len(image.width() * image.height(), cells.sample_cells);
            let workspace = workspace.get_mut(..room.min(workspace.len()))?;
            let (norms, cosines) = (ellipsoid.norms, ellipsoid.cosines);
            let found =
                tilts_given::search(image, bits, norms, cosines, tilts, cells.slack, workspace).ok()?;
            Some((found.slants, SlantSource::TiltIntegrability))
        }
        SlantFallback::PentlandSlant => {
            let estimates = pentland::slants(image, bits)?;
            Some((estimates.map(|estimate| estimate.slant), SlantSource::Pentland))
        }
        SlantFallback::LeeRosenfeldSlant => {
            let (estimates, _) = lee_rosenfeld::slants(image, bits)?;
            Some((estimates.map(|estimate| estimate.slant), SlantSource::LeeRosenfeld))
        }
        SlantFallback::ZhengChellappaSlant => {
            let estimates = zheng_chellappa::slants(image, Inliers::all(inliers.usable).selector())?;
            Some((estimates.map(|estimate| estimate.slant), SlantSource::ZhengChellappa))
        }
    }
}
