//! Which rows of a frame refine the model: every n-th one.

use crate::picture::PixelCounts;

/// Rows looked at in a frame, at least, where it has so many.
const FEWEST_ROWS: usize = 16;
/// What a pixel that cannot be used takes: a third of one that can.
const UNUSABLE: usize = 3;

/// Rows `first`, `first + step`, ...
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rows {
    step: usize,
    first: usize,
    frames: u32,
}

impl Rows {
    /// So many rows of a frame like that of `pixel counts` that about `pixels` are looked at; all rows for no pixels.
    pub fn new(height: usize, pixel_counts: &PixelCounts, pixels: u32) -> Self {
        let unusable =
            pixel_counts.masked_out + pixel_counts.non_finite + pixel_counts.dark + pixel_counts.saturated;
        let work = pixel_counts.usable + unusable / UNUSABLE;
        let step = if pixels == 0 { 1 } else { work.div_ceil(pixels as usize) };
        Self { step: step.min(height / FEWEST_ROWS).max(1), first: 0, frames: 0 }
    }

    /// Other rows for the next frame.
    pub fn advance(&mut self) {
        // Multiples of the golden ratio, modulo 1, of a step: frames one after the other lie far apart.
        const GOLDEN: u32 = 0x9e37_79b9;
        self.frames = self.frames.wrapping_add(1);
        let fraction = u64::from(self.frames.wrapping_mul(GOLDEN));
        self.first = ((fraction * self.step as u64) >> u32::BITS) as usize;
    }

    /// Whether this row is one of them.
    pub fn hold(&self, y: usize) -> bool {
        y.checked_rem(self.step) == Some(self.first)
    }

    /// The first of them.
    pub fn first(&self) -> usize {
        self.first
    }

    /// How far they lie apart.
    pub fn step(&self) -> usize {
        self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn of(usable: usize, dark: usize, height: usize, pixels: u32) -> Rows {
        Rows::new(height, &PixelCounts { usable, dark, ..PixelCounts::default() }, pixels)
    }

    #[test]
    fn as_many_rows_as_wanted() {
        assert_eq!(of(76_800, 0, 240, 16_384).step(), 5);
        assert_eq!(of(36_000, 40_800, 240, 16_384).step(), 4);
        assert_eq!(of(76_800, 0, 240, 0).step(), 1);
        assert_eq!(of(76_800, 0, 240, 76_800).step(), 1);
        assert_eq!(of(76_800, 0, 240, u32::MAX).step(), 1);
        assert_eq!(of(76_800, 0, 240, 1).step(), 15);
        assert_eq!(of(300, 0, 1, 1).step(), 1);
    }

    #[test]
    fn every_row_has_its_turn() {
        for step in 1..=15 {
            let mut rows = Rows { step, ..of(1, 0, 240, 0) };
            let mut counts = Vec::from([0; 240]);
            for _ in 0..10 * step {
                rows.advance();
                for (y, count) in counts.iter_mut().enumerate() {
                    *count += i32::from(rows.hold(y));
                }
            }
            assert!(counts.iter().all(|count| (8..=12).contains(count)), "{step}: {counts:?}");
        }
    }
}
