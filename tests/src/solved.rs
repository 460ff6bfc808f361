//! Solutions of pictures, and how far their normals are from the truth.

use crate::linear::{Matrix, apply, degrees_between, dot, median, unit};
use ofc_core::picture::{Image, Window, for_each_bit};
use ofc_core::solve::{Params, Solution, solve, workspace_len};

/// How many random light triples a table has beside Table 1's lights: what `OFC_LIGHTS` says, or `otherwise`.
pub fn light_triples(otherwise: u64) -> u64 {
    std::env::var("OFC_LIGHTS").map_or(otherwise, |text| text.parse().expect("OFC_LIGHTS is a number"))
}

/// The solution of a picture that has enough pixels for one, from a workspace of NaN.
pub fn solved(image: &Image, params: &Params) -> Solution {
    let pixels = image.width() * image.height();
    let mut workspace = vec![f32::NAN; workspace_len(pixels, params.lmeds.sample_size)];
    solve(image, params, &mut workspace).expect("enough pixels")
}

/// Colors and true normals of the selected pixels that have one, `truth` being width x height.
pub fn with_truth(
    image: &Image,
    selected: impl Fn(&Window) -> u64,
    truth: &[[f32; 3]],
) -> Vec<([f32; 3], [f64; 3])> {
    let mut pixels = Vec::new();
    image.for_each_window(|window| {
        for_each_bit(selected(window), |i| {
            let normal = truth[window.y * image.width() + window.x + i].map(f64::from);
            if dot(normal, normal) > 0.0 {
                pixels.push((window.pixel(i), normal));
            }
        });
    });
    pixels
}

/// The median angle in degrees between `f_inverse` rho and the true normals.
pub fn median_error(pixels: &[([f32; 3], [f64; 3])], f_inverse: Matrix) -> f64 {
    let error = |&(color, truth): &([f32; 3], _)| {
        degrees_between(unit(apply(f_inverse, color.map(f64::from))), truth)
    };
    median(&pixels.iter().map(error).collect::<Vec<_>>())
}
