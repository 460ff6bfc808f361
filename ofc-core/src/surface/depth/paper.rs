//! The paper's own choice: the whole rectangle, flat at outliers.
//!
//! # Reference
//! Section 5: "p and q were set to zero" where pixels do not obey the model.

use super::grid::Parts;
use super::parameters::{DepthError, DepthResult};
use super::poisson::{Answer, Job};

pub(super) fn integrate(mut job: Job) -> Answer {
    if let Some(along) = job.rectangle_along()
        && let Some(right) = job.read_rectangle()
    {
        return job.integrate_rectangle(along, &right);
    }
    let [masked, usable] = job.read();
    if usable == 0 {
        return Some(Err(DepthError::Empty));
    }
    // Slopes of unusable pixels are zero already.
    let Parts { grid, fine, .. } = &mut job.parts;
    for y in 0..grid.height {
        grid.row_mut(fine.weights, y).fill(1.0);
    }
    job.depth(DepthResult { pixels: masked, excluded: masked - usable, ..DepthResult::default() }, true)
}
