//! How far normals are from being those of a surface: the mean of (dp/dy - dq/dx)^2.
//!
//! # Reference
//! Section 2.3, eq. 15.

use crate::math::mat3::{self, Mat3};
use crate::picture::cells::{Block, for_each_block};
use crate::picture::{Image, Window, for_each_bit};

/// The integral (15) as a mean over cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrability {
    /// The mean of the squared difference, in pixel^-2.
    pub mean: f64,
    /// The cells of four inliers it is a mean over.
    pub cells: usize,
}

/// The smallest n3 that slopes are divided by: steeper normals, and those that look away from the camera, count with
/// this slope, so that a few grazing pixels do not decide between candidates.
pub(crate) const SMALLEST_N3: f64 = 0.05;

/// The integral (15), summed over blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    sum: f64,
    cells: usize,
}

impl Sum {
    /// Adds the cells of one block, their normals being `f_inverse` rho.
    pub fn add(&mut self, block: &Block, f_inverse: &Mat3) {
        let slopes = |window: &Window, i| {
            let [n1, n2, n3] = mat3::apply(f_inverse, window.pixel(i).map(f64::from));
            let n3 = n3.max(SMALLEST_N3);
            (-n1 / n3, -n2 / n3)
        };
        let bits = block.cells();
        let mut block_sum = 0.0;
        for_each_bit(bits, |i| {
            let ((p_nw, q_nw), (p_ne, q_ne)) = (slopes(&block.top, i), slopes(&block.top, i + 1));
            let ((p_sw, q_sw), (p_se, q_se)) = (slopes(&block.bottom, i), slopes(&block.bottom, i + 1));
            let p_y = 0.5 * ((p_nw - p_sw) + (p_ne - p_se));
            let q_x = 0.5 * ((q_ne - q_nw) + (q_se - q_sw));
            block_sum += (p_y - q_x) * (p_y - q_x);
        });
        self.sum += block_sum;
        self.cells += bits.count_ones() as usize;
    }

    /// The mean; `None` when there are no cells.
    #[must_use]
    pub fn mean(&self) -> Option<Integrability> {
        (self.cells > 0).then(|| Integrability { mean: self.sum / self.cells as f64, cells: self.cells })
    }
}

/// The integral (15) of the normals `f_inverse` rho, by finite differences on cells of four inliers.
///
/// `inliers` gives the bits of a window's inliers. `None` when there is no such cell.
pub fn integral(image: &Image, inliers: impl Fn(&Window) -> u64, f_inverse: &Mat3) -> Option<Integrability> {
    let mut sum = Sum::default();
    for_each_block(image, inliers, |block| sum.add(block, f_inverse));
    sum.mean()
}
