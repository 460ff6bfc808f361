//! What the pipeline found, and how far it came.

use super::choice::Choice;
use super::joint::oriented;
use super::parameters::Params;
use crate::color::ellipsoid::Ellipsoid;
use crate::color::inliers::Inliers;
use crate::color::lmeds::Fit;
use crate::color::location::Location;
use crate::color::rank::Rank;
use crate::light::tilt::Tilts;
use crate::orientation::joint::Joint;
use crate::picture::{PixelCounts, Usable};
use crate::surface::uncertainty::Sources;

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
