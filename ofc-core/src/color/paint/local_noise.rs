//! The noise in the colors, from second differences along rows: in all directions, and across the color's own.

use super::sampler::Sampler;
use crate::color::dispersion::{CONSISTENCY, SECOND_DIFFERENCE};
use crate::color::rounding;
use crate::math::mat3::{dot, scale};
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::Sample;
use libm::{fabs, sqrt};

/// Triples of neighbors that are looked at: a median of so many is good to three percent.
const TRIPLES: usize = 2048;
/// Pixels that are drawn for them at most.
const DRAWS: usize = 16 * TRIPLES;

/// Means of three by three pixels have a third of the noise of single ones where noise is independent. Cameras and compression
/// make it less so: half is what the photographs have.
const OF_MEANS: f64 = 0.5;

/// In pixel values.
pub(super) struct LocalNoise {
    /// Of a channel of the mean of three by three pixels.
    pub(super) of_means: f64,
    /// Of a channel, across the direction of the color.
    pub(super) across: f64,
}

/// The noise of single channels by the median, so that the steps of the surface and of its paint do not count.
pub(super) fn local_noise(sampler: &mut Sampler, workspace: &mut [f32]) -> LocalNoise {
    let (along, across) = workspace.split_at_mut(workspace.len() / 2);
    let (along, _) = along.as_chunks_mut::<3>();
    let (across, _) = across.as_chunks_mut::<3>();
    let (mut count, mut largest) = (0, 0.0_f64);
    for _ in 0..DRAWS {
        if count == TRIPLES {
            break;
        }
        let at = sampler.draw();
        let Some(colors) = sampler.row::<3>(at) else { continue };
        let colors = colors.map(|color| color.map(f64::from));
        let lengths = colors.map(|color| sqrt(dot(color, color)));
        let [left, middle, right] = colors;
        if let (Some(along), Some(across)) = (along.get_mut(count), across.get_mut(count)) {
            *along = second_difference([left, middle, right]);
            let mut directions = colors;
            for (direction, length) in directions.iter_mut().zip(lengths) {
                *direction = scale(*direction, lengths[1] / length);
            }
            *across = second_difference(directions);
            count += 1;
        }
        largest = largest.max(lengths[1]);
    }
    let floor = match sampler.sample() {
        Sample::U8 | Sample::U16 => rounding::DEVIATION,
        Sample::F32 => f64::from(f32::EPSILON) * largest,
    };
    let median = |values: &[[f32; 3]]| {
        let values = values.get(..count).unwrap_or_default().as_flattened();
        let median = kth_smallest(values, median_rank(values.len())).map_or(0.0, f64::from);
        CONSISTENCY * median / SECOND_DIFFERENCE
    };
    // Of the three channels' noise one part in three lies along the color.
    let across = sqrt(1.5) * median(across);
    LocalNoise { of_means: OF_MEANS * median(along).max(floor), across: across.max(floor) }
}

fn second_difference([left, middle, right]: [[f64; 3]; 3]) -> [f32; 3] {
    let mut differences = [0.0; 3];
    for (((slot, left), middle), right) in differences.iter_mut().zip(left).zip(middle).zip(right) {
        *slot = fabs(left - 2.0 * middle + right) as f32;
    }
    differences
}
