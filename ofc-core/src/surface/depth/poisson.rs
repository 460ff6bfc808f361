//! Least squares over the usable pixels, or, which is the paper's own choice, over the whole rectangle, flat at outliers.
//!
//! # Reference
//! Section 5: "p and q were set to zero" where pixels do not obey the model.

use super::hierarchy::Parts;
use super::job::{Answer, Job};
use super::parameters::{DepthError, DepthResult, Method};
use super::word::ONE;

/// Solves [`Method::Poisson`] and [`Method::Paper`].
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
    let mut pixels = usable;
    if job.params.method == Method::Paper {
        // Slopes of unusable pixels are zero already.
        let Parts { grid, fine, .. } = &mut job.parts;
        for y in 0..grid.height {
            grid.row_mut(fine.words, y).fill(ONE);
        }
        pixels = masked;
    }
    job.depth(DepthResult { pixels, excluded: masked - usable, ..DepthResult::default() }, true)
}
