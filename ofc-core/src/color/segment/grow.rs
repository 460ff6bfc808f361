//! Growing one region from a seed: breadth first, with a queue that holds every pixel at most once.

use super::field::{FREE, Field};
use super::params::Params;
use super::seed::Seed;
use crate::color::ellipsoid::{Coefficients, is_positive_definite, single_residual};
use crate::color::regression::Moments;
use libm::sqrt;

/// At most about so many pixels of a region take part in a fit, evenly spaced in the order of growth: six coefficients are as
/// well known from these as the model holds.
const FIT_PIXELS: usize = 8192;
/// A region that a refit does not make larger than this many 256ths of itself is done: less than one percent.
const GROWTH_256: usize = 258;

/// A grown region; its pixels are the first ones of the queue.
pub(super) struct Grown {
    pub(super) pixels: usize,
    pub(super) form: Coefficients,
    pub(super) residual_deviation: f64,
}

/// The region around `seed`: grown, fitted, and grown again for as long as it becomes larger.
pub(super) fn region(field: &mut Field, seed: &Seed, label: u16, params: &Params) -> Grown {
    let mut form = seed.form;
    let mut pixels = field.grow(seed.index, &form, label, params.tolerance);
    for _ in 0..params.refits {
        let Some(refit) = field.fit(pixels) else { break };
        field.relabel(pixels, FREE);
        let larger = field.grow(seed.index, &refit, label, params.tolerance);
        // A fit that loses the region is not followed.
        if larger < pixels {
            field.relabel(larger, FREE);
            pixels = field.grow(seed.index, &form, label, params.tolerance);
            break;
        }
        let done = larger * 256 <= pixels * GROWTH_256;
        (form, pixels) = (refit, larger);
        if done {
            break;
        }
    }
    let residual_deviation = field.deviation(pixels, &form);
    Grown { pixels, form, residual_deviation }
}

impl Field<'_> {
    /// Labels what is connected with the pixel `start` through free pixels within the tolerance, and returns how many
    /// pixels that is; `start` itself is taken as it is.
    fn grow(&mut self, start: usize, form: &Coefficients, label: u16, tolerance: f64) -> usize {
        let form = form.map(|c| c as f32);
        let tolerance = tolerance as f32;
        let Self { width, labels, colors, queue } = self;
        let width = *width;
        let (mut head, mut tail) = (0, 0);
        let mut take = |index: usize, labels: &mut [u16], queue: &mut [u32]| {
            if let (Some(own), Some(slot)) = (labels.get_mut(index), queue.get_mut(tail)) {
                *own = label;
                *slot = index as u32;
                tail += 1;
            }
            tail
        };
        let mut end = take(start, labels, queue);
        while head < end {
            let Some(&index) = queue.get(head) else { break };
            head += 1;
            let index = index as usize;
            let column = index.checked_rem(width).unwrap_or(0);
            let west = if column > 0 { index.wrapping_sub(1) } else { usize::MAX };
            let east = if column + 1 < width { index + 1 } else { usize::MAX };
            // Above the first row the index wraps around and is outside, as it is below the last.
            for neighbor in [west, east, index.wrapping_sub(width), index + width] {
                if let (Some(&FREE), Some(&color)) = (labels.get(neighbor), colors.get(neighbor))
                    && single_residual(&form, color).abs() <= tolerance
                {
                    end = take(neighbor, labels, queue);
                }
            }
        }
        end
    }

    /// The least-squares form over the first `pixels` of the queue, where it is an ellipsoid.
    fn fit(&self, pixels: usize) -> Option<Coefficients> {
        let mut moments = Moments::default();
        for color in self.some(pixels) {
            moments.add(color.map(f64::from));
        }
        let form = moments.solve()?.coefficients;
        is_positive_definite(&form).then_some(form)
    }

    fn deviation(&self, pixels: usize, form: &Coefficients) -> f64 {
        let form = form.map(|c| c as f32);
        let (mut sum, mut count) = (0.0, 0_u32);
        for color in self.some(pixels) {
            let residual = f64::from(single_residual(&form, color));
            sum += residual * residual;
            count += 1;
        }
        sqrt(sum / f64::from(count.max(1)))
    }

    /// Evenly spaced colors of the first `pixels` of the queue.
    fn some(&self, pixels: usize) -> impl Iterator<Item = [f32; 3]> {
        let stride = (pixels / FIT_PIXELS).max(1);
        let region = self.queue.iter().take(pixels).step_by(stride);
        region.filter_map(|&index| self.colors.get(index as usize).copied())
    }
}
