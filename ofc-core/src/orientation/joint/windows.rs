//! The windows that cells make.

use super::cells::Cells;
use super::constants::{LENGTHS, WINDOW_CELLS};
use super::window::{NUMBERS, Window};
use crate::math::mat3::Mat3;

/// The windows of one scale, one half a side after the other, put into `numbers`; `noise` is the covariance of a pixel's N. What is
/// left of `numbers` comes with them.
pub(super) fn collect<'n>(
    cells: &Cells,
    scale: usize,
    noise: &Mat3,
    numbers: &'n mut [f32],
) -> (&'n [[f32; NUMBERS]], &'n mut [f32]) {
    let [width, height] = cells.size();
    let times = WINDOW_CELLS.get(scale).map_or(1, |times| times.get());
    let length = LENGTHS.get(scale).map_or(1.0, |&length| length as f64);
    let (side, pitch) = ((times * cells.side()) as f64, (times / 2).max(1));
    let (all, _) = numbers.as_chunks_mut();
    let mut n = 0;
    for y in (0..height.saturating_sub(1)).step_by(pitch) {
        for x in (0..width.saturating_sub(1)).step_by(pitch) {
            let (quads, normal) = cells.quads(scale, [x, y], times);
            if let Some(window) = Window::of(&quads, normal, side, length, noise)
                && let Some(slot) = all.get_mut(n)
            {
                window.store(slot);
                n += 1;
            }
        }
    }
    let (own, rest) = numbers.split_at_mut_checked(n * NUMBERS).unwrap_or_default();
    (own.as_chunks().0, rest)
}
