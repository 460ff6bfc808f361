//! Slants by integrability, the tilts being given: what is left when eqs. 25 have no root.
//!
//! The rows of F have the tilts of an estimator and the lengths of the regression; the three slants are free, and the
//! integral (15) of n = F^-1 rho decides. Left alone it would decide for the wrong thing: as all slants approach 90 degrees
//! the recovered surface becomes flat, and a plane is perfectly integrable. (A root of eqs. 25 cannot drift there, for its
//! normals are of unit length; here they are not.) So the search is over the slants that the angles between the rows of F
//! do not rule out: the root mean square residual of eqs. 24 is at most `slack` above the smallest that these tilts
//! allow. A slack of 0 is the least-squares answer; an infinite one drops the angles altogether.
//!
//! # Reference
//! Section 3.3: "one could ... minimize (15) subject to having knowledge of the tilts".

use super::annealing;
use super::result::OrthogonalError;
use super::sample::{CELL, Sample};
use crate::light::constrained_slant::{self, NearestSlants};
use crate::math::mat3::{self, IDENTITY, Mat3};
use crate::orientation::integrability::{self, Integrability};
use crate::orientation::matrix;
use crate::picture::{Image, Window};
use core::f64::consts::FRAC_PI_2;

/// Points of the grid along each slant, in the middles of their cells.
const GRID: usize = 16;
/// Descents: from the best points of the grid, and from the least-squares slants.
const STARTS: usize = 5;
/// A descent's first step, as long as the grid is fine, is halved this often: down to 0.003 degrees.
const HALVINGS: usize = 10;
/// Moves of one descent at one length of step.
const MOVES: usize = 20;

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// How far the root mean square residual of eqs. 24, cosines, may be above the smallest; at least 0, or infinite.
    /// Default 0.05.
    pub slack: f64,
    /// The cells that slants are evaluated on; all cells when there are fewer. At least 1. Default 2000.
    pub sample_cells: u32,
}

impl Default for Params {
    fn default() -> Self {
        Self { slack: 0.05, sample_cells: 2000 }
    }
}

/// The slants that minimize (15).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltIntegrability {
    /// Slants of f1, f2, f3 in [0, pi/2], radians.
    pub slants: [f64; 3],
    /// The integral (15) over the whole picture.
    pub integral: Integrability,
    /// The root mean square residual of eqs. 24 at these slants.
    pub residual_rms: f64,
    /// The largest that was allowed.
    pub residual_limit: f64,
}

/// How many `f32` [`tilts_given`] uses for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize, sample_cells: u32) -> usize {
    annealing::workspace_len(pixels, sample_cells)
}

/// The slants for which the normals of the pixels that `inliers` gives the bits of are most integrable.
///
/// # Units
/// `norms` are those of the rows of F in pixel values, `cosines` (h12, h13, h23), tilts and slants in radians.
///
/// # Errors
/// [`OrthogonalError::Params`] also for tilts, norms or cosines that are no such thing.
///
/// # Scratch
/// [`workspace_len`] `f32`; what they hold before does not matter. About 12 kB of stack.
pub fn tilts_given(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    norms: [f64; 3],
    cosines: [f64; 3],
    tilts: [f64; 3],
    params: &Params,
    workspace: &mut [f32],
) -> Result<TiltIntegrability, OrthogonalError> {
    let in_range = params.slack >= 0.0
        && params.sample_cells > 0
        && norms.iter().all(|&norm| norm > 0.0 && norm.is_finite());
    if !in_range {
        return Err(OrthogonalError::Params);
    }
    let pixels = image.width() * image.height();
    let workspace = workspace
        .get_mut(..workspace_len(pixels, params.sample_cells))
        .ok_or(OrthogonalError::WorkspaceTooShort)?;
    search(image, inliers, norms, cosines, tilts, params.slack, workspace)
}

/// Does what [`tilts_given`] does, on as many cells as the workspace has room for.
pub(crate) fn search(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    norms: [f64; 3],
    cosines: [f64; 3],
    tilts: [f64; 3],
    slack: f64,
    workspace: &mut [f32],
) -> Result<TiltIntegrability, OrthogonalError> {
    let nearest = constrained_slant::least_squares(tilts, cosines);
    if !nearest.residual_rms.is_finite() {
        return Err(OrthogonalError::Params);
    }
    let cells = workspace.len() / CELL;
    let sample =
        Sample::gather(image, &inliers, &IDENTITY, cells, workspace).ok_or(OrthogonalError::NoCells)?;
    let problem = Problem { sample, norms, cosines, tilts, residual_limit: nearest.residual_rms + slack };
    let mut best: Option<TiltIntegrability> = None;
    let mut consider = |slants| {
        let Some(f_inverse) = problem.f_inverse(slants) else { return };
        let Some(integral) = integrability::integral(image, &inliers, &f_inverse) else { return };
        if integral.mean.is_finite() && best.is_none_or(|best| integral.mean < best.integral.mean) {
            let residual_rms = constrained_slant::residual_rms(tilts, cosines, slants);
            let residual_limit = problem.residual_limit;
            best = Some(TiltIntegrability { slants, integral, residual_rms, residual_limit });
        }
    };
    // Where many normals look away from the camera the sample evaluates by other numbers than the integral does: whatever
    // it leads to, the answer is no worse than the least-squares slants.
    consider(nearest.slants);
    // By reference: dropping the owning iterator could panic, as far as the compiler can tell.
    for &start in &problem.starts(&nearest) {
        consider(problem.descend(start));
    }
    best.ok_or(OrthogonalError::NoCells)
}

#[derive(Clone, Copy)]
struct Start {
    slants: [f64; 3],
    cost: f64,
}

struct Problem<'w> {
    sample: Sample<'w>,
    norms: [f64; 3],
    cosines: [f64; 3],
    tilts: [f64; 3],
    residual_limit: f64,
}

impl Problem<'_> {
    /// `None` where these slants make F singular.
    fn f_inverse(&self, slants: [f64; 3]) -> Option<Mat3> {
        mat3::inverse(&matrix::compose(self.norms, slants, self.tilts))
    }

    /// (15) on the sample; infinite for slants that are not allowed, or make F singular.
    fn cost(&self, slants: [f64; 3]) -> f64 {
        let in_range = slants.iter().all(|slant| (0.0..=FRAC_PI_2).contains(slant));
        // The least-squares slants themselves are allowed, whatever rounding says.
        let limit = self.residual_limit * (1.0 + 1e-9) + 1e-12;
        if !in_range || constrained_slant::residual_rms(self.tilts, self.cosines, slants) > limit {
            return f64::INFINITY;
        }
        let cost = self.f_inverse(slants).map(|f_inverse| self.sample.integral(&f_inverse));
        cost.filter(|cost| cost.is_finite()).unwrap_or(f64::INFINITY)
    }

    /// The best points of the grid, best first, and the least-squares slants.
    fn starts(&self, nearest: &NearestSlants) -> heapless::Vec<Start, STARTS> {
        let at = |index: usize| (index as f64 + 0.5) * (FRAC_PI_2 / GRID as f64);
        let mut starts: heapless::Vec<Start, STARTS> = heapless::Vec::new();
        let first = Start { slants: nearest.slants, cost: self.cost(nearest.slants) };
        // There is room.
        let _ = starts.push(first);
        for i in 0..GRID {
            for j in 0..GRID {
                for k in 0..GRID {
                    let slants = [at(i), at(j), at(k)];
                    let mut carried = Start { slants, cost: self.cost(slants) };
                    if carried.cost == f64::INFINITY {
                        continue;
                    }
                    // The first place belongs to the least-squares slants.
                    for slot in starts.iter_mut().skip(1) {
                        if carried.cost < slot.cost {
                            core::mem::swap(slot, &mut carried);
                        }
                    }
                    // No room: it was the worst.
                    let _ = starts.push(carried);
                }
            }
        }
        starts
    }

    /// The slants to which steps along the axes, shorter and shorter, lead downhill.
    fn descend(&self, start: Start) -> [f64; 3] {
        let mut best = start;
        let mut step = FRAC_PI_2 / GRID as f64;
        for _ in 0..HALVINGS {
            for _ in 0..MOVES {
                let from = best;
                let [s1, s2, s3] = from.slants;
                for d in [step, -step] {
                    let neighbors = [
                        [s1 + d, s2, s3],
                        [s1, s2 + d, s3],
                        [s1, s2, s3 + d],
                        [s1 + d, s2 + d, s3],
                        [s1 + d, s2, s3 + d],
                        [s1, s2 + d, s3 + d],
                        [s1 + d, s2 - d, s3],
                        [s1 + d, s2, s3 - d],
                        [s1, s2 + d, s3 - d],
                        [s1 + d, s2 + d, s3 + d],
                    ];
                    for slants in neighbors {
                        let cost = self.cost(slants);
                        if cost < best.cost {
                            best = Start { slants, cost };
                        }
                    }
                }
                if best.cost >= from.cost {
                    break;
                }
            }
            step *= 0.5;
        }
        best.slants
    }
}
