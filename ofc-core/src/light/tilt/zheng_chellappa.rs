//! Zheng and Chellappa's tilt: every neighborhood votes with the direction of its gradient, whatever its strength.
//!
//! In each neighborhood the derivatives along several directions are fitted by the gradient `(x_L, y_L)`, and the tilt
//! is that of the mean of `(x_L, y_L) / sqrt(x_L^2 + y_L^2)`. Here a neighborhood is a cell of 2 x 2 pixels and the
//! directions are the axes and the diagonals; for these the least squares fit is the mean of the two rows' (columns')
//! differences, which the diagonals only confirm. A vote counts the same however strong the gradient is, so neither
//! the steep border nor a highlight decides alone, but noise has as loud a voice as shading where the picture is flat.
//!
//! # Reference
//! Q. Zheng, R. Chellappa, "Estimation of illuminant direction, albedo, and shape from shading", PAMI 13, 1991, the
//! local estimate. The paper's neighborhoods are larger; their size, and its second estimate from occluding contours,
//! are not followed here.

use super::angle;
use crate::picture::cells::for_each_block;
use crate::picture::{Image, Window, for_each_bit};
use libm::sqrt;

/// The tilts of the three channels' lights in (-pi, pi], counter-clockwise from x, for a convex surface.
///
/// `inliers` gives the bits of a window's pixels. Cells without a gradient do not vote. `None` when no cell is all inliers,
/// or the votes of a channel cancel.
pub fn tilts(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<[f64; 3]> {
    let mut votes = [[0.0; 2]; 3];
    for_each_block(image, inliers, |block| {
        for_each_bit(block.cells(), |i| {
            let (top, bottom) =
                ([0, 1].map(|k| block.top.pixel(i + k)), [0, 1].map(|k| block.bottom.pixel(i + k)));
            let ([top_left, top_right], [bottom_left, bottom_right]) = (top, bottom);
            let left = top_left.into_iter().zip(bottom_left);
            let right = top_right.into_iter().zip(bottom_right);
            for (vote, ((tl, bl), (tr, br))) in votes.iter_mut().zip(left.zip(right)) {
                let (falling, rising) = (f64::from(tl) - f64::from(br), f64::from(tr) - f64::from(bl));
                // Twice the gradient; its length does not matter.
                let (x, y) = (rising - falling, rising + falling);
                let length = sqrt(x * x + y * y);
                if length > 0.0 {
                    let [sum_x, sum_y] = vote;
                    *sum_x += x / length;
                    *sum_y += y / length;
                }
            }
        });
    });
    let [red, green, blue] = votes.map(angle);
    Some([red?, green?, blue?])
}
