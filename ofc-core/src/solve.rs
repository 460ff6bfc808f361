//! The whole pipeline of section 3.4 over one workspace. Its steps, and where they are:
//!
//! | step | what | where |
//! | --- | --- | --- |
//! | 1 | regression in color space: C and the outliers | [`lmeds`], `shadow_rejection` |
//! | 2 | lengths of the rows of F and cosines of their angles, from C | `color_model`, [`ellipsoid`](crate::color::ellipsoid) |
//! | 3 | tilts of the rows, from the inliers | [`tilt`](crate::light::tilt) |
//! | 4 | slants that agree with both | [`constrained_slant`](crate::light::constrained_slant), `fallback` |
//! | 5, 6 | F and its inverse | [`matrix`](crate::orientation::matrix) |
//! | 7 | normals | [`normals`](crate::surface::normals) |
//! | 8 | of several solutions the most integrable one | `direct`, [`integrability`](crate::orientation::integrability) |
//!
//! With [`OrientationMethod::Joint`] the transformation that [`joint`](mod@crate::orientation::joint) finds takes the place of
//! steps 3 to 8.

mod choice;
mod color_model;
mod direct;
mod fallback;
mod oriented;
mod outcome;
mod parameters;
pub mod reason;
mod shadow_rejection;
mod solution;

pub use choice::{Candidate, Choice, SlantSource};
pub use fallback::SlantFallback;
pub use outcome::Outcome;
pub use parameters::{Convexity, NormSource, OrientationMethod, Params, ShadowRejection};
pub use reason::{Finding, Reason};
pub use solution::Solution;

pub(crate) use color_model::SMALLEST_NOISE_MARGIN;
pub(crate) use direct::orient;
pub(crate) use oriented::{Oriented, oriented};

use crate::color::ellipsoid::Ellipsoid;
use crate::color::inliers::Inliers;
use crate::color::lmeds::{self, FitError};
use crate::orientation::joint;
use crate::picture::Image;
use oriented::NoOrientation;

/// How many `f32` [`solve`] needs for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize, sample_size: u32) -> usize {
    let location = pixels.saturating_mul(2);
    let fit = lmeds::workspace_len(pixels, sample_size);
    if location > fit { location } else { fit }
}

/// From a picture to F, or as far as the picture allows.
///
/// # Errors
/// [`FitError`] where nothing can be computed at all; [`FitError::RankDeficient`] is an [`Outcome`] here.
///
/// # Scratch
/// [`workspace_len`] `f32`; what they hold before does not matter.
pub fn solve(image: &Image, params: &Params, workspace: &mut [f32]) -> Result<Solution, FitError> {
    if !params.are_valid() {
        return Err(FitError::Params);
    }
    let pixels = image.width() * image.height();
    let workspace = workspace
        .get_mut(..workspace_len(pixels, params.lmeds.sample_size))
        .ok_or(FitError::WorkspaceTooShort)?;
    let usable = params.usable(image);
    let mut solution = Solution::new(usable.count(image), usable);
    // Step 1: C, the outliers, and the colors that a light does not reach.
    let regression = solution.fit_lit(image, params, workspace);
    solution.take_regression(image, regression, params.lmeds.method)?;
    // Step 2: the lengths of the rows of F, and the angles between them.
    match solution.model(params.lmeds.method) {
        Ok(ellipsoid) => {
            solution.reject_lengths(image, params.lmeds.rejection, workspace);
            // Steps 3 to 8.
            let orientation = orientation(image, &ellipsoid, &solution.inliers, params, workspace);
            solution.take_orientation(
                orientation.map(|dome| if params.is_hollow() { dome.twin() } else { dome }),
            );
        }
        Err(reason) => solution.end_without_model(reason),
    }
    // What a refusal or a doubt comes from.
    let finding = reason::find(image, params, &solution, workspace);
    solution.take_finding(finding);
    Ok(solution)
}

/// F of a model of the colors, from its inliers; or why there is none.
fn orientation(
    image: &Image,
    ellipsoid: &Ellipsoid,
    inliers: &Inliers,
    params: &Params,
    workspace: &mut [f32],
) -> Result<Oriented, NoOrientation> {
    if params.is_joint()
        && let Some(joint) = joint::estimate(image, inliers, &ellipsoid.root, workspace)
    {
        return Ok(Oriented::jointly(joint, ellipsoid, params.rank_threshold));
    }
    // Step 3.
    let tilts = params.tilts.estimate(image, inliers, workspace).ok_or(NoOrientation::NoTilt)?;
    // Steps 4 to 8.
    let choice = direct::choose(image, ellipsoid, inliers, tilts.tilts, params, workspace)
        .ok_or(NoOrientation::NoConsistentSlants { tilts })?;
    Ok(Oriented { tilts, choice, joint: None })
}
