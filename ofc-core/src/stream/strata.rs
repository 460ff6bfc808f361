//! A stratified sample of a frame whose pixels are not counted before they come, and that sample as pixels.
//!
//! A stratum is so many usable pixels one after the other, and each gives one of them at random. It begins with one
//! pixel; whenever the room is full, neighboring strata become one, which keeps the pixel of either. So all pixels are
//! kept, in their windows, where there is room for them, and otherwise one of each 2^k, at least half as many as there is
//! room for.

use crate::math::rng::Rng;
use crate::picture::{Pixels, sum_second_differences};
use crate::picture::{Sample, WINDOW, Window};

/// The column within its window that a place holds.
const COLUMN: u8 = WINDOW as u8 - 1;
/// The bit of a place that begins a window.
const FIRST: u8 = 1 << 7;

/// Where colors are put: channels apart, and the places of their pixels.
pub(super) struct Slots<'a> {
    pub colors: [&'a mut [f32]; 3],
    pub places: &'a mut [u8],
}

impl Slots<'_> {
    fn put(&mut self, slot: usize, color: [f32; 3]) {
        for (channel, value) in self.colors.iter_mut().zip(color) {
            if let Some(out) = channel.get_mut(slot) {
                *out = value;
            }
        }
    }

    fn copy(&mut self, from: usize, to: usize) {
        let color = self.colors.each_ref().map(|channel| channel.get(from).copied().unwrap_or(0.0));
        self.put(to, color);
    }
}

/// How far the sample has come.
#[derive(Clone, Debug)]
pub(super) struct Strata {
    rng: Rng,
    capacity: usize,
    taken: usize,
    /// Pixels of a stratum.
    stride: u32,
    /// Pixels of the present stratum that have come.
    seen: u32,
    /// Which of them is taken.
    wanted: u32,
    /// The window that the last pixel taken is from.
    window: Option<(usize, usize)>,
}

impl Strata {
    /// Room for `capacity` pixels.
    pub fn new(seed: u64, capacity: usize) -> Self {
        // Not the numbers that draw the subsets.
        let rng = Rng::new(!seed);
        Self { rng, capacity, taken: 0, stride: 1, seen: 1, wanted: 0, window: None }
    }

    /// How many pixels are in the sample.
    pub fn len(&self) -> usize {
        self.taken
    }

    /// Whether every pixel is.
    pub fn is_whole(&self) -> bool {
        self.stride == 1
    }

    /// Offers the next usable pixel, column `i` of its window.
    pub fn offer(&mut self, window: &Window, y: usize, i: usize, slots: &mut Slots) {
        if self.seen == self.stride {
            if self.taken == self.capacity {
                self.merge(slots);
            }
            if self.seen == self.stride {
                self.seen = 0;
                self.wanted = self.rng.below(self.stride);
            }
        }
        if self.seen == self.wanted {
            slots.put(self.taken, window.pixel(i));
            let here = Some((window.x, y));
            let first = if self.window == here { 0 } else { FIRST };
            self.window = here;
            if let Some(place) = slots.places.get_mut(self.taken) {
                *place = (i as u8 & COLUMN) | first;
            }
            self.taken += 1;
        }
        self.seen += 1;
    }

    /// Makes one stratum of two.
    fn merge(&mut self, slots: &mut Slots) {
        let pairs = self.taken / 2;
        for pair in 0..pairs {
            slots.copy(2 * pair + self.rng.below(2) as usize, pair);
        }
        let half = self.stride;
        self.stride = half.saturating_mul(2);
        self.seen = self.stride;
        if self.taken % 2 == 1 {
            // The stratum that is left is the first half of one that goes on.
            self.seen = half;
            self.wanted = self.rng.below(self.stride);
            if self.wanted < half {
                slots.copy(self.taken - 1, pairs);
                self.taken = pairs + 1;
                return;
            }
        }
        self.taken = pairs;
    }
}

/// A sample of a frame.
pub(super) struct Sampled<'a> {
    /// The channels.
    pub colors: [&'a [f32]; 3],
    /// The places of the pixels; none where there is not every pixel of the frame.
    pub places: &'a [u8],
    /// How samples were stored.
    pub format: Sample,
    /// The second differences of the frame's usable pixels, for a sample without neighbors.
    pub second_differences: (f64, u64),
}

impl Sampled<'_> {
    fn put(&self, slot: usize, window: &mut Window, column: usize) {
        for (out, channel) in window.color.iter_mut().zip(self.colors) {
            if let (Some(out), Some(&value)) = (out.get_mut(column), channel.get(slot)) {
                *out = value;
            }
        }
        window.masked |= 1 << column;
    }

    /// Fills the window that begins at `slot`, and goes on to the one after it; whether there was one.
    // Compiled once, not for every visitor.
    #[inline(never)]
    fn next(&self, slot: &mut usize, window: &mut Window) -> bool {
        window.masked = 0;
        while *slot < self.len() {
            let (column, first) = match self.places.get(*slot) {
                Some(&place) => (usize::from(place & COLUMN), place & FIRST != 0),
                None => (*slot % WINDOW, slot.is_multiple_of(WINDOW)),
            };
            if first && window.masked != 0 {
                return true;
            }
            self.put(*slot, window, column);
            *slot += 1;
        }
        window.masked != 0
    }
}

impl Pixels for Sampled<'_> {
    fn for_each_window(&self, mut visit: impl FnMut(&Window)) {
        let (mut window, mut slot) = (Window::new(), 0);
        window.len = WINDOW;
        while self.next(&mut slot, &mut window) {
            visit(&window);
        }
    }

    fn sample(&self) -> Sample {
        self.format
    }

    fn len(&self) -> usize {
        let [channel, ..] = self.colors;
        channel.len()
    }

    fn second_differences(&self, selected: impl Fn(&Window) -> u64) -> (f64, u64) {
        if self.places.is_empty() {
            return self.second_differences;
        }
        sum_second_differences(self, selected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Which of `count` pixels, whose color is their number, are kept in `capacity` places, and the stride.
    #[expect(clippy::cast_sign_loss, reason = "numbers of pixels")]
    fn kept(count: usize, capacity: usize, seed: u64) -> (Vec<usize>, usize) {
        let (mut red, mut green, mut blue) =
            (std::vec![9e9; capacity], std::vec![9e9; capacity], std::vec![9e9; capacity]);
        let mut places = std::vec![0; capacity];
        let mut slots = Slots { colors: [&mut red, &mut green, &mut blue], places: &mut places };
        let mut strata = Strata::new(seed, capacity);
        let mut window = Window::new();
        for number in 0..count {
            window.color = [[number as f32; WINDOW]; 3];
            strata.offer(&window, 0, number % WINDOW, &mut slots);
        }
        assert_eq!(red, blue);
        (red.iter().take(strata.len()).map(|&number| number as usize).collect(), strata.stride as usize)
    }

    #[test]
    fn one_pixel_of_each_stratum() {
        for capacity in [24, 25, 30, 31] {
            for count in 0..300 {
                let (numbers, stride) = kept(count, capacity, count as u64);
                for (stratum, number) in numbers.iter().enumerate() {
                    assert_eq!(number / stride, stratum, "{count} in {capacity}: {numbers:?}");
                }
                // Only the last stratum may still be without a pixel.
                assert!(numbers.len() >= count / stride && numbers.len() <= count.div_ceil(stride));
                assert!(stride == 1 || numbers.len() >= capacity / 2);
                assert_eq!(stride == 1, count <= capacity);
            }
        }
    }

    #[test]
    fn every_pixel_is_as_likely() {
        let mut counts = [0; 190];
        for seed in 0..4000 {
            for number in kept(190, 25, seed).0 {
                counts[number] += 1;
            }
        }
        // 4000 / 8 each, with a deviation of 21.
        assert!(counts[..184].iter().all(|count| (400..600).contains(count)), "{counts:?}");
    }
}
