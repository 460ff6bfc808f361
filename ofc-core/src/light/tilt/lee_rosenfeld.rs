//! Lee and Rosenfeld's tilt: the mean derivatives along the axes alone.
//!
//! # Reference
//! Section 3.2: "equivalent to Pentland's when only the axes are used for directions s". C.-H. Lee, A. Rosenfeld,
//! "Improved methods of estimating shape from shading using the light source coordinate system", Artificial
//! Intelligence 26, 1985.

use super::Tilts;
use crate::light::differences::{Differences, color};
use crate::picture::cells::for_each_block;
use crate::picture::{Image, Window};

/// The tilts of the three channels' lights in (-pi, pi], counter-clockwise from x, for a convex surface.
///
/// `inliers` gives the bits of a window's pixels; the method wants those that see the light, shadows left out. `None`
/// when the rows or the columns hold no pair of neighboring inliers, or a channel's mean gradient is zero.
///
/// # Accuracy
/// Exact in the mean on a sphere. Means of differences telescope: what decides is the border of the inliers.
pub fn tilts(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<[f64; 3]> {
    let (mut east, mut north) = (Differences::<1>::NONE, Differences::<1>::NONE);
    for_each_block(image, inliers, |block| {
        let (top, bottom) = (&block.top, &block.bottom);
        east.add(block.horizontal(), (top, 1), (top, 0), &color);
        north.add(block.vertical(), (top, 0), (bottom, 0), &color);
    });
    let found = Tilts::of_gradients(|channel| Some([east.mean(channel, 1.0)?, north.mean(channel, 1.0)?]))?;
    Some(found.tilts)
}
