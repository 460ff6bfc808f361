//! Which of the two images of a normal is right, from integrability.
//!
//! The normals of one surface have n . curl n = 0. Of two images mirrored at a plane only one field has, so the difference of the
//! squares, over their noise, is the logarithm of how many times as likely one is as the other. It is summed over windows of three
//! sizes. The curl of the slopes p and q would not do: its noise grows with the third power of 1 / n3 and prefers the flatter image.

use super::boxes;
use super::class::{TWO_LIGHTS, class, single_light};
use super::map::{Map, Vectors, row_of};
use super::two::Fold;
use super::vector::{Vector, dot};

/// Differences are over so many pixels to either side.
pub(super) const SPAN: usize = 3;
/// The normals are of means of so many pixels a side.
pub(super) const SIDE: f32 = 5.0;
/// Below this part along e the images are the same.
const LEAST_Y: f32 = 0.1;
/// No window of differences says more than this.
const MOST: f32 = 8.0;
/// Noise of n . curl n is at least this: surfaces bend between the pixels that are compared.
const LEAST_NOISE: f32 = 1e-3;
/// Neighboring means share pixels, and the images have more noise than the means.
const EXCESS: f32 = 1.4;

/// The windows' radii and how many independent differences the mean over each is worth.
const WINDOWS: [(usize, f32); 3] = [(3, 2.0), (7, 4.0), (15, 6.0)];
/// What windows have decided by so much, larger ones are not asked about: images change at folds, and what is true of most of a window
/// may be false at its center. Nor do all of them say more: where surfaces end or bend sharply they may be wrong together.
const DECIDED: f32 = 3.0;

/// The logarithm of how many times as likely the image on the side of e is, from the differences around each pixel alone; 0 where
/// there is nothing to compare. `normals` are images of either sign, of means of [`SIDE`] pixels a side; `deviation` is the noise of a
/// raw normal.
pub(super) fn compare(
    folds: &[Option<Fold>; 3],
    deviation: f32,
    normals: &Vectors,
    classes: &Map<u8>,
    ratios: &mut [f32],
) {
    let width = classes.width.max(1);
    for (y, row) in ratios.chunks_exact_mut(width).enumerate() {
        for (x, ratio) in row.iter_mut().enumerate() {
            *ratio = 0.0;
            let byte = classes.at(x, y);
            if class(byte) != TWO_LIGHTS {
                continue;
            }
            let Some(Some(fold)) = folds.get(single_light(byte)) else { continue };
            let neighbors =
                [(x, y), (x + SPAN, y), (x.wrapping_sub(SPAN), y), (x, y.wrapping_sub(SPAN)), (x, y + SPAN)];
            if neighbors.iter().any(|&(x, y)| classes.at(x, y) != byte) {
                continue;
            }
            let images = neighbors.map(|(x, y)| fold.both(normals.at(x, y)));
            let [[here, _], ..] = images;
            let part = dot(here, fold.e);
            if part < LEAST_Y {
                continue;
            }
            let plus = curl(images.map(|[plus, _]| plus));
            let minus = curl(images.map(|[_, minus]| minus));
            let noise = EXCESS * deviation / (SIDE * SPAN as f32 * part.max(0.15));
            let variance = noise * noise + LEAST_NOISE * LEAST_NOISE;
            *ratio = ((minus * minus - plus * plus) / (2.0 * variance)).clamp(-MOST, MOST);
        }
    }
}

/// n . curl n, from the normals here, right, left, above and below.
pub(super) fn curl([here, right, left, above, below]: [Vector; 5]) -> f32 {
    let [n1, n2, n3] = here;
    let ([_, r2, r3], [_, l2, l3], [a1, _, a3], [b1, _, b3]) = (right, left, above, below);
    (n1 * (a3 - b3) - n2 * (r3 - l3) + n3 * ((r2 - l2) - (a1 - b1))) / (2 * SPAN) as f32
}

/// Replaces what the differences around each pixel say by what those in the windows around it say together.
///
/// `planes` are four, of a number a pixel.
pub(super) fn gather(ratios: &mut [f32], classes: &Map<u8>, [sum, support, total, between]: [&mut [f32]; 4]) {
    let width = classes.width.max(1);
    for light in 0..3 {
        // Images of pixels in other shadows are told apart by another e.
        let is_ours = |byte: u8| class(byte) == TWO_LIGHTS && single_light(byte) == light;
        total.fill(0.0);
        let mut any = false;
        for (radius, worth) in WINDOWS {
            for (y, row) in ratios.chunks_exact(width).enumerate() {
                let at = y * width..(y + 1) * width;
                let (Some(sum), Some(support)) = (sum.get_mut(at.clone()), support.get_mut(at)) else {
                    return;
                };
                let row = row.iter().zip(classes.row(y));
                for (((&ratio, &byte), sum), support) in row.zip(sum).zip(support) {
                    *sum = if is_ours(byte) { ratio } else { 0.0 };
                    *support = if *sum == 0.0 { 0.0 } else { 1.0 };
                    any |= *sum != 0.0;
                }
            }
            if !any {
                break;
            }
            boxes::sums(sum, between, width, radius);
            boxes::sums(support, between, width, radius);
            for ((total, sum), support) in total.iter_mut().zip(&*sum).zip(&*support) {
                let open = (1.0 - total.abs() / DECIDED).max(0.0);
                *total += open * worth * sum / support.max(1.0);
            }
        }
        if !any {
            continue;
        }
        for (y, row) in ratios.chunks_exact_mut(width).enumerate() {
            let total = row_of(total, width, y);
            for ((ratio, total), &byte) in row.iter_mut().zip(total).zip(classes.row(y)) {
                if is_ours(byte) {
                    *ratio = total.clamp(-DECIDED, DECIDED);
                }
            }
        }
    }
}
