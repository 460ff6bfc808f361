//! What the pipeline found, and how far it came.

use super::choice::Choice;
use super::color_model::{self, NoModel};
use super::oriented::{NoOrientation, Oriented};
use super::outcome::Outcome;
use super::reason::{Finding, Reason};
use crate::color::ellipsoid::Ellipsoid;
use crate::color::inliers::{Band, Inliers};
use crate::color::lmeds::{Fit, FitError, Method};
use crate::color::location::Location;
use crate::color::norms;
use crate::color::rank::Rank;
use crate::light::tilt::Tilts;
use crate::orientation::joint::Joint;
use crate::picture::{PixelCounts, Pixels, Usable};
use crate::surface::uncertainty::Sources;

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
    /// What a refusal or a doubt comes from; none in a stream, which does not look for it.
    pub finding: Finding,
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

    /// What is known before the regression.
    pub(crate) const fn new(pixel_counts: PixelCounts, usable: Usable) -> Self {
        Self {
            outcome: Outcome::Unfinished,
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
            finding: Finding::NONE,
        }
    }

    /// Becomes [`Self::new`] of these pixels, in its place.
    pub(crate) fn restart(&mut self, pixel_counts: PixelCounts) {
        self.outcome = Outcome::Unfinished;
        self.pixel_counts = pixel_counts;
        self.color_deviations = [0.0; 3];
        self.inliers = Inliers::none(Usable::below(self.inliers.usable.saturation));
        self.inlier_count = 0;
        (self.rank, self.fit, self.norm_location) = (None, None, None);
        (self.ellipsoid, self.tilts, self.joint, self.choice) = (None, None, None, None);
        self.finding = Finding::NONE;
    }

    /// Takes the regression over, whose fit is in its place if there is one.
    ///
    /// # Errors
    /// [`FitError`] but [`FitError::RankDeficient`], which leaves a solution without a fit.
    #[inline(never)]
    pub(crate) fn take_regression(
        &mut self,
        pixels: &impl Pixels,
        regression: Result<(), FitError>,
        method: Method,
    ) -> Result<(), FitError> {
        let usable = self.inliers.usable;
        let mut inliers = Inliers::all(usable);
        match (regression, &self.fit) {
            (Ok(()), Some(fit)) => {
                self.color_deviations = fit.color_deviations;
                inliers.residual = fit.band;
                (self.inliers, self.inlier_count) = (inliers, fit.inliers);
            }
            (Err(FitError::RankDeficient { color_deviations }), _) => {
                (self.fit, self.color_deviations) = (None, color_deviations);
            }
            (Err(error), _) => return Err(error),
            (Ok(()), None) => {}
        }
        self.rank = color_model::ranks(pixels, self.fit.as_ref(), &inliers, method);
        Ok(())
    }

    /// The model of the colors, which also takes its place here.
    ///
    /// # Errors
    /// [`NoModel`]. Where the normals alone span less than three dimensions the ellipsoid is in its place all the same.
    pub(crate) fn model(&mut self, method: Method) -> Result<Ellipsoid, NoModel> {
        let ellipsoid = color_model::ellipsoid(self.fit.as_ref(), self.rank, method)?;
        self.ellipsoid = Some(ellipsoid);
        if self.rank.is_some_and(|rank| !rank.is_full()) {
            Err(NoModel::RankDeficient)
        } else {
            Ok(ellipsoid)
        }
    }

    /// Ends without a model.
    pub(crate) fn end_without_model(&mut self, reason: NoModel) {
        self.outcome = match reason {
            NoModel::RankDeficient => Outcome::RankDeficient,
            NoModel::Undetermined => Outcome::Undetermined,
            NoModel::NotPositiveDefinite => Outcome::NotPositiveDefinite,
        };
    }

    /// The second rejection: leaves out inliers whose normals are too long or too short.
    ///
    /// # Scratch
    /// Two `f32` a pixel.
    #[inline(never)]
    pub(crate) fn reject_lengths(&mut self, pixels: &impl Pixels, rejection: f64, workspace: &mut [f32]) {
        let Some(fit) = &self.fit else { return };
        self.norm_location = pixels.of_part(|part| norms::location(part, &self.inliers, &fit.z(), workspace));
        if let Some(lengths) = &self.norm_location {
            self.inliers.norm = Band::norm(fit.z(), lengths, rejection);
            self.inlier_count = self.inliers.count(pixels);
        }
    }

    /// Takes the reason of a refusal or a doubt, and makes ranks and outcome agree with it: the picture shows more than its colors do.
    /// What cannot be an answer is refused: a plane, and what has one hue or a channel without a signal.
    #[inline(never)]
    pub(crate) fn take_finding(&mut self, finding: Finding) {
        self.finding = finding;
        let is_refused = self.outcome != Outcome::Solved;
        let (outcome, colors, normals) = match finding.reason {
            Reason::Flat => (Outcome::RankDeficient, Some(1), Some(Some(1))),
            Reason::Gray | Reason::Vignette => (Outcome::RankDeficient, Some(1), Some(None)),
            Reason::ChannelDead => (Outcome::Undetermined, None, None),
            Reason::TooFewLights if is_refused => (Outcome::RankDeficient, Some(2), Some(Some(3))),
            Reason::Cylinder if is_refused => (Outcome::RankDeficient, None, Some(Some(2))),
            _ => return,
        };
        if let Some(rank) = &mut self.rank {
            rank.colors = colors.unwrap_or(rank.colors);
            rank.normals = normals.unwrap_or(rank.normals);
            if rank.is_full() || outcome == Outcome::RankDeficient {
                self.outcome = outcome;
            }
        }
        (self.tilts, self.joint, self.choice) = (None, None, None);
    }

    /// Ends with the choice of slants that is in its place.
    pub(crate) fn conclude(&mut self) {
        self.outcome = self.choice.as_ref().map_or(Outcome::NoConsistentSlants, Choice::outcome);
    }

    /// Ends with F, or without one.
    pub(crate) fn take_orientation(&mut self, orientation: Result<Oriented, NoOrientation>) {
        match orientation {
            Ok(Oriented { tilts, choice, joint }) => {
                self.outcome = choice.outcome();
                (self.tilts, self.choice, self.joint) = (Some(tilts), Some(choice), joint);
            }
            Err(NoOrientation::NoTilt) => self.outcome = Outcome::NoTilt,
            Err(NoOrientation::NoConsistentSlants { tilts }) => {
                (self.tilts, self.outcome) = (Some(tilts), Outcome::NoConsistentSlants);
            }
        }
    }
}
