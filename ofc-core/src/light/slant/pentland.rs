//! Pentland's slant, from the mean gradient and the spread of the directional derivatives.
//!
//! # Reference
//! Section 3.2, eq. 22. A. P. Pentland, "Finding the illuminant direction", J. Opt. Soc. Am. 72, 1982; criticised by
//! Chojnacki, Brooks and Gibbins, and Lee and Rosenfeld.

use super::{Estimate, Reach};
use crate::picture::cells::for_each_block;
use crate::picture::differences::Differences;
use crate::picture::{Image, Window};
use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, SQRT_2};
use libm::{asin, sqrt};

/// The slants of the three channels' lights in [0, pi/2].
///
/// The statistic is (<Ix>^2 + <Iy>^2) / K^2, the squared sine of the slant; above 1 the answer is pi/2 and
/// [`Reach::AboveLargest`], as in Table 1. The directions are the axes and the diagonals; K^2, which the method takes to
/// be the same along all, is the mean of their four variances.
///
/// `inliers` gives the bits of a window's pixels. `None` when a direction has no pair of inliers or a channel does not
/// vary at all.
pub fn slants(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<[Estimate; 3]> {
    let [mut east, mut north, mut north_east, mut north_west] = [Differences::default(); 4];
    for_each_block(image, inliers, |block| {
        let (top, bottom) = (&block.top, &block.bottom);
        east.add(block.horizontal(), (top, 1), (top, 0));
        north.add(block.vertical(), (top, 0), (bottom, 0));
        north_east.add(block.rising(), (top, 1), (bottom, 0));
        north_west.add(block.falling(), (top, 0), (bottom, 1));
    });
    let axes = east.statistics(1.0)?.into_iter().zip(north.statistics(1.0)?);
    let diagonals = north_east.statistics(SQRT_2)?.into_iter().zip(north_west.statistics(SQRT_2)?);
    let mut estimates = [Estimate { slant: 0.0, statistic: 0.0, reach: Reach::Inside }; 3];
    for (estimate, ((e, n), (ne, nw))) in estimates.iter_mut().zip(axes.zip(diagonals)) {
        // Least squares of eq. 20 over the four unit directions, whose normal matrix is twice the identity.
        let ix = 0.5 * (e.0 + FRAC_1_SQRT_2 * (ne.0 - nw.0));
        let iy = 0.5 * (n.0 + FRAC_1_SQRT_2 * (ne.0 + nw.0));
        let (gradient, spread) = (ix * ix + iy * iy, 0.25 * (e.1 + n.1 + ne.1 + nw.1));
        let varies = gradient > 0.0 || spread > 0.0;
        if !(varies && spread.is_finite()) {
            return None;
        }
        let statistic = gradient / spread;
        *estimate = if statistic <= 1.0 {
            Estimate { slant: asin(sqrt(statistic)), statistic, reach: Reach::Inside }
        } else {
            Estimate { slant: FRAC_PI_2, statistic, reach: Reach::AboveLargest }
        };
    }
    Some(estimates)
}
