//! F, or why there is none.

use super::choice::{Choice, SlantSource};
use crate::color::ellipsoid::Ellipsoid;
use crate::light::tilt::Tilts;
use crate::math::mat3::{self, Mat3};
use crate::orientation::joint::Joint;
use crate::orientation::matrix::Orientation;
use heapless::Vec;
use libm::{atan2, hypot};

/// F, and what it was found from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Oriented {
    pub tilts: Tilts,
    pub choice: Choice,
    /// How sure the orientation is, where it is known.
    pub joint: Option<Joint>,
}

/// Why there is no F.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NoOrientation {
    /// A channel's mean gradient over the inliers is zero, or there are no neighboring inliers.
    NoTilt,
    /// No slants agree with these tilts and the angles between the rows of F, and there was to be no fallback.
    NoConsistentSlants { tilts: Tilts },
}

impl Oriented {
    /// F as a whole, from the transformation that [`crate::orientation::joint`] found.
    pub fn jointly(joint: Joint, ellipsoid: &Ellipsoid, rank_threshold: f64) -> Self {
        let (tilts, choice) = oriented(&joint.rows, &ellipsoid.root_inverse(), rank_threshold);
        Self { tilts, choice, joint: Some(joint) }
    }
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
