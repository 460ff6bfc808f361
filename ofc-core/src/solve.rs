//! The whole pipeline of section 3.4 over one workspace.

mod choice;
mod color_model;
mod direct;
mod fallback;
mod joint;
mod parameters;
mod shadow_rejection;
mod solution;

pub use choice::{Candidate, Choice, SlantSource};
pub use fallback::SlantFallback;
pub use parameters::{NormSource, OrientationMethod, Params, ShadowRejection};
pub use solution::{Outcome, Solution};

pub(crate) use color_model::SMALLEST_NOISE_MARGIN;
pub(crate) use direct::orient;
pub(crate) use joint::oriented;

use crate::color::lmeds::{self, FitError};
use crate::light::tilt::Tilts;
use crate::orientation;
use crate::picture::Image;

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
    let mut solution = Solution::unsolved(usable.count(image), usable);
    let fit = lmeds::fit(image, usable, &params.lmeds, workspace).map(|fit| solution.fit = Some(fit));
    if fit.is_ok() && params.rejects_shadows() {
        solution.reject_shadows(image, params, workspace);
    }
    solution.model(image, fit, params, workspace)?;
    if solution.outcome != Outcome::NoTilt {
        return Ok(solution);
    }
    let inliers = solution.inliers;
    if params.is_joint()
        && let Some(ellipsoid) = &solution.ellipsoid
    {
        let joint = orientation::joint::estimate(image, &inliers, &ellipsoid.root, workspace);
        if solution.orient(joint, params) {
            return Ok(solution);
        }
    }
    solution.tilts = params.tilts.estimate(image, &inliers, workspace);
    let (Some(Tilts { tilts, .. }), Some(ellipsoid)) = (solution.tilts, solution.ellipsoid) else {
        return Ok(solution);
    };
    solution.choice = direct::choose(image, &inliers, &ellipsoid, tilts, params, workspace);
    solution.conclude();
    Ok(solution)
}
