//! F as a whole, from the transformation that [`crate::orientation::joint`] finds.

use super::choice::{Choice, SlantSource};
use crate::light::tilt::Tilts;
use crate::math::mat3::{self, Mat3};
use crate::orientation::matrix::Orientation;
use heapless::Vec;
use libm::{atan2, hypot};

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
