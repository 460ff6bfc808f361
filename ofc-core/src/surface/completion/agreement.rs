//! Whether a picture agrees with a solution: the lit part of it has raw normals of length 1.

use super::vector::{Matrix, apply, length, transposed, unit};
use crate::picture::{Image, Usable};
use libm::hypotf;

/// Lengths within this many deviations of their noise are 1 ...
const NEAR: f32 = 2.5;
/// ... and up to so many they show how many are by chance.
const BESIDE: f32 = 7.5;
/// Noise is at least this in a length.
const LEAST_NOISE: f32 = 0.01;
/// At least so many times as many are 1 as by chance where F is that of the picture. Of 298 rendered pictures of which a third and more is
/// lit none had less than 3.5, and half of them 13; of 590 pairs with the F of another one, or with channels exchanged in turn, none more
/// than 2.7.
const CONCENTRATION: f32 = 3.0;

/// `root` is such that a raw normal has the noise `root` times that of the color.
pub(super) fn holds(image: &Image, usable: Usable, f_inverse: &Matrix, root: &Matrix) -> bool {
    let (mut near, mut beside) = (0_u32, 0_u32);
    image.for_each_window(|window| {
        let bits = usable.exposed(window);
        for i in (0..window.len).filter(|i| bits >> i & 1 == 1) {
            let v = apply(f_inverse, window.pixel(i));
            let noise = hypotf(length(transposed(root, unit(v))), LEAST_NOISE);
            let off = (length(v) - 1.0).abs();
            near += u32::from(off <= NEAR * noise);
            beside += u32::from(off > NEAR * noise && off <= BESIDE * noise);
        }
    });
    near as f32 >= CONCENTRATION * NEAR / (BESIDE - NEAR) * beside as f32 && near > 0
}
