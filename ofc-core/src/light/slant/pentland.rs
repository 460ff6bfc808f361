//! Pentland's slant, from the mean gradient and the spread of the directional derivatives.
//!
//! # Reference
//! Section 3.2, eq. 22. A. P. Pentland, "Finding the illuminant direction", J. Opt. Soc. Am. 72, 1982; criticized by
//! Chojnacki, Brooks and Gibbins, and Lee and Rosenfeld.

use super::{Estimate, Reach};
use crate::light::differences::color;
use crate::light::gradient::FourDirections;
use crate::picture::cells::for_each_block;
use crate::picture::{Image, Window};
use core::f64::consts::{FRAC_PI_2, SQRT_2};
use libm::{asin, sqrt};

/// The reciprocal of the distance between the pixels of a diagonal pair.
const PER_DIAGONAL: f64 = 1.0 / SQRT_2;

/// The slants of the three channels' lights in [0, pi/2].
///
/// Eq. 22 is `arccos (1 - statistic)^(1/2)`: the statistic, `(<Ix>^2 + <Iy>^2) / K^2`, is the squared sine of the slant. Above 1 the answer is pi/2 and
/// [`Reach::AboveLargest`], as in Table 1. The directions are the axes and the diagonals; K^2, which the method takes to
/// be the same along all, is the mean of their four variances.
///
/// `inliers` gives the bits of a window's pixels. `None` when a direction has no pair of inliers or a channel does not
/// vary at all.
pub fn slants(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<[Estimate; 3]> {
    let mut directions = FourDirections::<2>::NONE;
    for_each_block(image, inliers, |block| directions.add(block, &color));
    let mut estimates = [Estimate { slant: 0.0, statistic: 0.0, reach: Reach::Inside }; 3];
    for (channel, estimate) in estimates.iter_mut().enumerate() {
        let FourDirections { east, north, north_east, north_west } = &directions;
        let [ix, iy] = directions.gradient(channel, PER_DIAGONAL)?;
        let (e, n) = (east.variance(channel, 1.0)?, north.variance(channel, 1.0)?);
        let (ne, nw) =
            (north_east.variance(channel, PER_DIAGONAL)?, north_west.variance(channel, PER_DIAGONAL)?);
        let (gradient, spread) = (ix * ix + iy * iy, 0.25 * (e + n + ne + nw));
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
