//! Growing one region from a seed: breadth first, with a queue that holds every pixel at most once.

use super::seed::Seed;
use super::{FREE, Params};
use crate::color::ellipsoid::{Coefficients, is_positive_definite};
use crate::color::regression::Moments;
use libm::sqrt;

/// At most about so many pixels of a region take part in a fit, evenly spaced in the order of growth.
const FIT_PIXELS: usize = 8192;
/// A region that a refit does not make larger than this many 256ths of itself is done.
const GROWTH_256: usize = 258;

/// The picture while it is being divided.
pub(super) struct Field<'a> {
    pub(super) width: usize,
    pub(super) labels: &'a mut [u16],
    /// Scaled so that the largest value is about 1; those of unusable pixels mean nothing.
    pub(super) colors: &'a [[f32; 3]],
    pub(super) queue: &'a mut [u32],
}

/// A grown region; its pixels are the first ones of the queue.
pub(super) struct Grown {
    pub(super) pixels: usize,
    pub(super) form: Coefficients,
    pub(super) residual_deviation: f64,
}

/// rho^T C rho - 1.
#[inline]
pub(super) fn residual(form: &[f32; 6], [r, g, b]: [f32; 3]) -> f32 {
    let [c11, c22, c33, c12, c13, c23] = *form;
    let red = r * (c11 * r + 2.0 * (c12 * g + c13 * b));
    let green = g * (c22 * g + 2.0 * c23 * b);
    red + green + c33 * b * b - 1.0
}

impl Field<'_> {
    /// Label and color of a pixel; `None` outside the picture.
    pub(super) fn at(&self, x: usize, y: usize) -> Option<(u16, [f32; 3])> {
        if x >= self.width {
            return None;
        }
        let index = y.checked_mul(self.width)?.checked_add(x)?;
        Some((*self.labels.get(index)?, *self.colors.get(index)?))
    }

    /// Fills the queue with the free pixels, and returns how many there are.
    pub(super) fn gather_free(&mut self) -> usize {
        let mut count = 0;
        for (index, &label) in self.labels.iter().enumerate() {
            if label == FREE {
                if let Some(slot) = self.queue.get_mut(count) {
                    *slot = index as u32;
                }
                count += 1;
            }
        }
        count
    }

    /// Gives the pixels of a region, the first of the queue, another label.
    pub(super) fn relabel(&mut self, grown: &Grown, label: u16) {
        for &index in self.queue.iter().take(grown.pixels) {
            if let Some(slot) = self.labels.get_mut(index as usize) {
                *slot = label;
            }
        }
    }

    /// The region around `seed`: grown, fitted, and grown again for as long as it becomes larger.
    pub(super) fn region(&mut self, seed: &Seed, label: u16, params: &Params) -> Grown {
        let mut form = seed.form;
        let mut pixels = self.grow(seed.index, &form, label, params.tolerance);
        for _ in 0..params.refits {
            let Some(refit) = self.fit(pixels) else { break };
            let before = Grown { pixels, form, residual_deviation: 0.0 };
            self.relabel(&before, FREE);
            let larger = self.grow(seed.index, &refit, label, params.tolerance);
            // A fit that loses the region is not followed.
            if larger < pixels {
                let lost = Grown { pixels: larger, form: refit, residual_deviation: 0.0 };
                self.relabel(&lost, FREE);
                pixels = self.grow(seed.index, &form, label, params.tolerance);
                break;
            }
            let done = larger * 256 <= pixels * GROWTH_256;
            (form, pixels) = (refit, larger);
            if done {
                break;
            }
        }
        let residual_deviation = self.deviation(pixels, &form);
        Grown { pixels, form, residual_deviation }
    }

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
            for neighbour in [west, east, index.wrapping_sub(width), index + width] {
                if let (Some(&FREE), Some(&color)) = (labels.get(neighbour), colors.get(neighbour))
                    && residual(&form, color).abs() <= tolerance
                {
                    end = take(neighbour, labels, queue);
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
            let residual = f64::from(residual(&form, color));
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
