//! The whole pipeline of section 3.4 over one workspace.

mod fallback;
mod shadow_rejection;

pub use fallback::SlantFallback;

use crate::color::ellipsoid::{self, Ellipsoid};
use crate::color::inliers::{Band, Inliers};
use crate::color::lmeds::{self, Fit, FitError, Method};
use crate::color::location::Location;
use crate::color::norms;
use crate::color::rank::{self, Rank};
use crate::light::constrained_slant::{self, Candidates, MAX_CANDIDATES, SlantRoot};
use crate::light::tilt::{TiltEstimator, Tilts};
use crate::math::mat3::{self, Mat3};
use crate::orientation::integrability;
use crate::orientation::joint::{self, Joint};
use crate::orientation::matrix::{self, Orientation, RANK_THRESHOLD};
use crate::picture::Pixels;
use crate::picture::{Image, PixelCounts, Usable};
use crate::surface::uncertainty::Sources;
use heapless::Vec;
use libm::{atan2, hypot};

/// The noise that would make a degenerate scene look like this one must be so many times the noise there is. Degenerate
/// scenes (cylinders, planes, cones, ramps, mixtures of colors, with and without noise) come to 0.2-1.1, photographs
/// that give good normals to 1.19-6.7; at the limit a coefficient of C can be mostly bias.
pub(crate) const SMALLEST_NOISE_MARGIN: f64 = 1.15;

/// How the orthogonal transformation that the regression leaves open is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrientationMethod {
    /// From integrability and outward normals together, see [`crate::orientation::joint`].
    Joint,
    /// The paper's: slants from tilts (section 3).
    Direct,
}

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// The regression in color space.
    pub lmeds: lmeds::Params,
    /// A pixel is saturated if a channel is at or above this; `None` for the largest value of the pixel type, and no
    /// limit for f32. Default `None`.
    pub saturation: Option<f32>,
    /// Whether colors that a light does not reach are looked for and left out. Default true.
    pub reject_shadows: bool,
    /// How F is oriented. Given tilts, and a picture that is too small for [`OrientationMethod::Joint`], take the direct method whatever
    /// this is. Default [`OrientationMethod::Joint`].
    pub orientation_method: OrientationMethod,
    /// Where the tilts come from, with the direct method. Default [`TiltEstimator::Pentland`].
    pub tilts: TiltEstimator,
    /// Singular values of F below this share of the largest are zero, in [0, 1). Default 1e-3.
    pub rank_threshold: f64,
    /// Where the slants come from when eqs. 25 have no root. Default [`SlantFallback::LeastSquares`].
    pub fallback: SlantFallback,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            lmeds: lmeds::Params::default(),
            saturation: None,
            reject_shadows: true,
            orientation_method: OrientationMethod::Joint,
            tilts: TiltEstimator::Pentland,
            rank_threshold: RANK_THRESHOLD,
            fallback: SlantFallback::LeastSquares,
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

    /// Which pixels of `image` can be used.
    #[must_use]
    pub fn usable(&self, image: &Image) -> Usable {
        Usable::below(self.saturation.unwrap_or(image.sample().saturation()))
    }
}

/// How far the pipeline came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// To F.
    Solved,
    /// The colors, or the normals, span less than three dimensions: C is not determined.
    RankDeficient,
    /// The colors do not lie on an ellipsoid: C is not positive definite.
    NotPositiveDefinite,
    /// A channel's mean gradient over the inliers is zero, or there are no neighbouring inliers: no tilts.
    NoTilt,
    /// No slants agree with the tilts and the angles between the rows of F, and there was to be no fallback.
    NoConsistentSlants,
}

/// Where the slants come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlantSource {
    /// A root of eqs. 25, chosen by integrability.
    Root,
    /// There is no root: least squares over eqs. 24.
    LeastSquares,
    /// There is no root: the least integral (15) that eqs. 24 allow.
    TiltIntegrability,
    /// There is no root: Pentland's slants, eq. 22.
    Pentland,
    /// There is no root: Lee and Rosenfeld's slants, eq. 23.
    LeeRosenfeld,
    /// There is no root: Zheng and Chellappa's slants.
    ZhengChellappa,
    /// F was oriented as a whole ([`OrientationMethod::Joint`]): its slants follow from it.
    Joint,
}

/// Slants that are consistent with the tilts, and how integrable their normals are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Slants of f1, f2, f3 in radians.
    pub slants: [f64; 3],
    /// Which of the eight branches of eqs. 25 they lie on, 1 to 8; 0 for least squares.
    pub branch: u8,
    /// The largest residual of eqs. 24.
    pub residual: f64,
    /// The integral (15) as a mean over cells; infinite when F is rank-deficient or there are no cells.
    pub integral: f64,
}

/// The candidates and the choice among them.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The slants of F.
    pub slants: [f64; 3],
    /// Where they come from.
    pub source: SlantSource,
    /// All candidates, by ascending first slant.
    pub candidates: Vec<Candidate, MAX_CANDIDATES>,
    /// Which of them was chosen.
    pub chosen: usize,
    /// F.
    pub orientation: Orientation,
}

/// What the pipeline found. What comes after the stage that `outcome` names is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// How far it came.
    pub outcome: Outcome,
    /// What became of the pixels before the fit.
    pub pixel_counts: PixelCounts,
    /// The root mean square of the colors along their principal axes, descending, in pixel values.
    pub color_deviations: [f64; 3],
    /// The ranks of colors and normals, of the inliers where there is a fit; `None` where there are no usable pixels.
    pub rank: Option<Rank>,
    /// The regression; `None` where the colors do not determine C.
    pub fit: Option<Fit>,
    /// The location of the norms of the normals.
    pub norm_location: Option<Location>,
    /// The pixels that obey the model; none without a fit.
    pub inliers: Inliers,
    /// How many they are.
    pub inlier_count: usize,
    /// C, its root, and the norms and angles of the rows of F.
    pub ellipsoid: Option<Ellipsoid>,
    /// The tilts of the rows of F.
    pub tilts: Option<Tilts>,
    /// How sure the orientation is; `None` with the direct method.
    pub joint: Option<Joint>,
    /// Slants and F.
    pub choice: Option<Choice>,
}

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
    if fit.is_ok() && params.reject_shadows {
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
        let joint = joint::estimate(image, &inliers, &ellipsoid.root, workspace);
        if solution.orient(joint, params) {
            return Ok(solution);
        }
    }
    solution.tilts = params.tilts.estimate(image, &inliers, workspace);
    let (Some(Tilts { tilts, .. }), Some(ellipsoid)) = (solution.tilts, solution.ellipsoid) else {
        return Ok(solution);
    };
    solution.choice = choose(image, &inliers, &ellipsoid, tilts, params, workspace);
    solution.conclude();
    Ok(solution)
}

/// F as a whole: the inverse of `rows` times the root of C, of which the inverse is given.
#[inline(never)]
pub(crate) fn oriented(rows: &Mat3, root_inverse: &Mat3, rank_threshold: f64) -> (Tilts, Choice) {
    let f = mat3::multiply(root_inverse, &mat3::transpose(rows));
    let orientation = Orientation::new(f, rank_threshold);
    let tilts = Tilts::alone(f.map(|[x, y, _]| atan2(y, x)));
    let slants = f.map(|[x, y, z]| atan2(hypot(x, y), z));
    let choice =
        Choice { slants, source: SlantSource::Joint, candidates: Vec::new(), chosen: 0, orientation };
    (tilts, choice)
}

impl Solution {
    /// What the uncertainty of its normals comes from; `None` where there is no F, or nothing is known of how sure its
    /// rotation is (with the direct method).
    #[must_use]
    pub fn uncertainty_sources(&self) -> Option<Sources> {
        let (fit, joint, choice) = (self.fit.as_ref()?, self.joint.as_ref()?, self.choice.as_ref()?);
        (choice.orientation.rank == 3).then_some(Sources {
            f: choice.orientation.f,
            f_inverse: choice.orientation.f_inverse,
            c: fit.covariance,
            rotation: joint.covariance,
            noise: fit.pixel_noise,
        })
    }

    /// As [`Self::unsolved`], in place.
    pub(crate) fn restart(&mut self, pixel_counts: PixelCounts) {
        self.outcome = Outcome::RankDeficient;
        self.pixel_counts = pixel_counts;
        self.color_deviations = [0.0; 3];
        self.inliers = Inliers::none(Usable::below(self.inliers.usable.saturation));
        self.inlier_count = 0;
        (self.rank, self.fit, self.norm_location) = (None, None, None);
        (self.ellipsoid, self.tilts, self.joint, self.choice) = (None, None, None, None);
    }

    /// What is known before the fit.
    pub(crate) fn unsolved(pixel_counts: PixelCounts, usable: Usable) -> Self {
        Self {
            outcome: Outcome::RankDeficient,
            pixel_counts,
            color_deviations: [0.0; 3],
            rank: None,
            fit: None,
            norm_location: None,
            inliers: Inliers::none(usable),
            inlier_count: 0,
            ellipsoid: None,
            tilts: None,
            joint: None,
            choice: None,
        }
    }

    /// From the fit, which is in its place unless it failed, to the inliers: everything that the places of the pixels mean nothing to. The outcome is
    /// [`Outcome::NoTilt`] where tilts come next.
    ///
    /// # Errors
    /// Those of the fit but [`FitError::RankDeficient`], which is an outcome.
    ///
    /// # Scratch
    /// Two `f32` a pixel.
    pub(crate) fn model(
        &mut self,
        pixels: &impl Pixels,
        fit: Result<(), FitError>,
        params: &Params,
        workspace: &mut [f32],
    ) -> Result<(), FitError> {
        let usable = self.inliers.usable;
        let fit = match (fit, &self.fit) {
            (Ok(()), Some(fit)) => fit,
            (Err(FitError::RankDeficient { color_deviations }), _) => {
                self.color_deviations = color_deviations;
                self.rank = rank::rank(pixels, Inliers::all(usable).selector(), None);
                return Ok(());
            }
            (Err(error), _) => return Err(error),
            (Ok(()), None) => return Ok(()),
        };
        self.color_deviations = fit.color_deviations;
        self.inliers = Inliers { residual: fit.band, ..Inliers::all(usable) };
        self.inlier_count = fit.inliers;
        // Outliers that least squares keeps are no noise: the robust dispersion leaves them out.
        let deviation = match params.lmeds.method {
            Method::LeastMedian => fit.residual_deviation,
            Method::LeastSquares => fit.residual_deviation.min(fit.dispersion),
        };
        self.rank = rank::rank(pixels, self.inliers.selector(), Some((fit.z(), deviation)));
        let share = if deviation < fit.residual_deviation { deviation / fit.residual_deviation } else { 1.0 };
        let noise = fit.noise_deviation * share;
        let is_determined = fit.degenerate_noise_deviation > SMALLEST_NOISE_MARGIN * noise;
        if !is_determined || self.rank.is_some_and(|rank| rank.colors < 3) {
            return Ok(());
        }

        self.outcome = Outcome::NotPositiveDefinite;
        let Ok(ellipsoid) = ellipsoid::decompose(&fit.z()) else { return Ok(()) };
        self.ellipsoid = Some(ellipsoid);
        if self.rank.is_some_and(|rank| !rank.is_full()) {
            self.outcome = Outcome::RankDeficient;
            return Ok(());
        }
        self.norm_location = norms::location(pixels, &self.inliers, &fit.z(), workspace);
        if let Some(norms) = self.norm_location {
            self.inliers.norm = Band::norm(fit.z(), &norms, params.lmeds.rejection);
            self.inlier_count = self.inliers.count(pixels);
        }
        self.outcome = Outcome::NoTilt;
        Ok(())
    }

    /// Ends with this transformation, if there is one; whether there is.
    pub(crate) fn orient(&mut self, joint: Option<Joint>, params: &Params) -> bool {
        self.joint = joint;
        let (Some(joint), Some(ellipsoid)) = (joint, &self.ellipsoid) else { return false };
        let (tilts, choice) = oriented(&joint.rows, &ellipsoid.root_inverse(), params.rank_threshold);
        (self.tilts, self.choice) = (Some(tilts), Some(choice));
        self.conclude();
        true
    }

    /// Ends with the choice of slants that is in its place.
    pub(crate) fn conclude(&mut self) {
        self.outcome = match &self.choice {
            None => Outcome::NoConsistentSlants,
            Some(choice) if choice.orientation.rank < 3 => Outcome::RankDeficient,
            Some(_) => Outcome::Solved,
        };
    }
}

/// The candidate slants for these tilts, and the one whose normals are most integrable (section 3.4, steps 4-8).
fn choose(
    image: &Image,
    inliers: &Inliers,
    ellipsoid: &Ellipsoid,
    tilts: [f64; 3],
    params: &Params,
    workspace: &mut [f32],
) -> Option<Choice> {
    let orient = |slants| orient(ellipsoid, slants, tilts, params);
    let selector = inliers.selector();
    let mut choice = Choice::none();
    choice.set_candidates(&constrained_slant::roots(tilts, ellipsoid.cosines));
    for candidate in &mut choice.candidates {
        let orientation = orient(candidate.slants);
        if orientation.rank == 3 {
            #[expect(
                clippy::needless_borrows_for_generic_args,
                reason = "so that one instance serves tilts_given too"
            )]
            let integral = integrability::integral(image, &selector, &orientation.f_inverse);
            candidate.integral = integral.map_or(f64::INFINITY, |integral| integral.mean);
        }
    }
    if let Some((chosen, slants)) = choice.most_integrable() {
        (choice.chosen, choice.slants) = (chosen, slants);
    } else {
        let fallback = params.fallback;
        (choice.slants, choice.source) =
            fallback::slants(fallback, image, inliers, ellipsoid, tilts, workspace)?;
    }
    choice.orientation = orient(choice.slants);
    Some(choice)
}

impl Choice {
    /// No choice yet.
    pub(crate) const fn none() -> Self {
        Self {
            slants: [0.0; 3],
            source: SlantSource::Root,
            candidates: Vec::new(),
            chosen: 0,
            orientation: Orientation::NONE,
        }
    }

    /// Takes these roots of eqs. 25 for candidates, their integrals not known yet.
    pub(crate) fn set_candidates(&mut self, roots: &Candidates) {
        self.candidates.clear();
        for &SlantRoot { slants, branch, residual } in roots {
            // There are no more roots than candidates have room.
            let _ = self.candidates.push(Candidate { slants, branch, residual, integral: f64::INFINITY });
        }
    }

    /// Which candidate has the least integral, and its slants.
    pub(crate) fn most_integrable(&self) -> Option<(usize, [f64; 3])> {
        let candidates = self.candidates.iter().enumerate();
        let least = candidates.min_by(|(_, a), (_, b)| a.integral.total_cmp(&b.integral));
        least.map(|(chosen, candidate)| (chosen, candidate.slants))
    }
}

/// F from the lengths of its rows, their slants and tilts.
#[inline(never)]
pub(crate) fn orient(
    ellipsoid: &Ellipsoid,
    slants: [f64; 3],
    tilts: [f64; 3],
    params: &Params,
) -> Orientation {
    Orientation::new(matrix::compose(ellipsoid.norms, slants, tilts), params.rank_threshold)
}
