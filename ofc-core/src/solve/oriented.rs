//! F, or why there is none.

use super::choice::{Choice, SlantSource};
use crate::color::ellipsoid::Ellipsoid;
use crate::light::tilt::Tilts;
use crate::math::mat3::{self, Mat3};
use crate::orientation::joint::Joint;
use crate::orientation::matrix::Orientation;
use core::f64::consts::PI;
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

    /// The convex/concave twin: the same colors of a surface whose depth has the other sign, in lights that are turned half
    /// about the line of sight.
    pub fn twin(self) -> Self {
        let Self { mut tilts, mut choice, joint } = self;
        tilts.tilts = tilts.tilts.map(|tilt| if tilt > 0.0 { tilt - PI } else { tilt + PI });
        let opposite = |[x, y, z]: [f64; 3]| [-x, -y, z];
        choice.orientation.f = choice.orientation.f.map(opposite);
        let [x, y, z] = choice.orientation.f_inverse;
        choice.orientation.f_inverse = [mat3::scale(x, -1.0), mat3::scale(y, -1.0), z];
        Self { tilts, choice, joint: joint.map(|joint| joint.twin()) }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orientation::joint::Evidence;
    use crate::orientation::orthogonal::polish::rotation;

    #[test]
    fn the_twin_of_the_twin_is_the_dome_and_its_f_has_its_tilts() {
        let joint = Joint {
            rows: rotation([0.3, -0.2, 0.7]),
            covariance: [[3.0, 0.5, 0.2], [0.5, 2.0, -0.1], [0.2, -0.1, 1.0]],
            evidence: Evidence::Both,
            convexity: 0.7,
            second_best: 9.0,
        };
        let (tilts, choice) = oriented(&joint.rows, &mat3::IDENTITY, 1e-3);
        let dome = Oriented { tilts, choice, joint: Some(joint) };
        let twin = dome.clone().twin();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        for (row, tilt) in twin.choice.orientation.f.iter().zip(twin.tilts.tilts) {
            let [x, y, _] = *row;
            assert!(close(atan2(y, x), tilt) && tilt > -PI && tilt <= PI, "{twin:?}");
        }
        let product = mat3::multiply(&twin.choice.orientation.f, &twin.choice.orientation.f_inverse);
        for (found, wanted) in product.as_flattened().iter().zip(mat3::IDENTITY.as_flattened()) {
            assert!(close(*found, *wanted), "{product:?}");
        }
        // Its rows are those that make its F, and its covariance is seen in its own frame.
        let turned = twin.joint.expect("joint");
        let (_, again) = oriented(&turned.rows, &mat3::IDENTITY, 1e-3);
        assert_eq!(again.orientation.f, twin.choice.orientation.f);
        assert_eq!(turned.covariance, [[3.0, 0.5, -0.2], [0.5, 2.0, 0.1], [-0.2, 0.1, 1.0]]);
        assert!(close(turned.convexity, -0.7));
        let back = twin.twin();
        assert_eq!((back.choice, back.joint), (dome.choice, dome.joint));
    }
}
