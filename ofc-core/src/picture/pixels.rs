//! Pixels that are visited a window at a time, whether they are a whole picture or a sample of one.

use crate::picture::{Sample, Window, for_each_bit};

/// Pixels in picture order.
pub trait Pixels {
    /// Calls `visit` with all pixels, at most [`WINDOW`](crate::picture::WINDOW) at a time, top row first.
    fn for_each_window(&self, visit: impl FnMut(&Window));

    /// How samples were stored: what rounding there is to expect.
    fn sample(&self) -> Sample;

    /// How many pixels there are, usable or not.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Calls `visit` with a part of the pixels that is large enough to say what they are like as a whole.
    fn of_part<R>(&self, visit: impl FnOnce(&Self) -> R) -> R
    where
        Self: Sized,
    {
        visit(self)
    }

    /// Writes `value` of every selected pixel into `out`, in picture order, as far as it holds, and returns what was
    /// written. `selected` gives the bits of a window.
    fn gather<'w>(
        &self,
        selected: impl Fn(&Window) -> u64,
        out: &'w mut [f32],
        value: impl Fn(f32, f32, f32) -> f64,
    ) -> &'w mut [f32] {
        let mut count = 0;
        self.for_each_window(|window| {
            for_each_bit(selected(window), |i| {
                let [r, g, b] = window.pixel(i);
                if let Some(slot) = out.get_mut(count) {
                    *slot = value(r, g, b) as f32;
                    count += 1;
                }
            });
        });
        out.get_mut(..count).unwrap_or_default()
    }

    /// The sum of the squared second differences along rows of neighboring selected pixels, over the three channels, and
    /// how many triples of pixels it is a sum over.
    fn second_differences(&self, selected: impl Fn(&Window) -> u64) -> (f64, u64) {
        sum_second_differences(self, selected)
    }
}

/// [`Pixels::second_differences`], window by window.
#[inline(never)]
pub(crate) fn sum_second_differences(
    pixels: &(impl Pixels + ?Sized),
    selected: impl Fn(&Window) -> u64,
) -> (f64, u64) {
    let (mut sum, mut count) = (0.0, 0_u64);
    pixels.for_each_window(|window| second_differences(window, selected(window), &mut sum, &mut count));
    (sum, count)
}

/// Adds the second differences of one window's `bits`.
pub(crate) fn second_differences(window: &Window, bits: u64, sum: &mut f64, count: &mut u64) {
    let triples = bits & (bits >> 1) & (bits >> 2);
    for_each_bit(triples, |i| {
        let (left, middle, right) = (window.pixel(i), window.pixel(i + 1), window.pixel(i + 2));
        for ((left, middle), right) in left.into_iter().zip(middle).zip(right) {
            let difference = f64::from(left) - 2.0 * f64::from(middle) + f64::from(right);
            *sum += difference * difference;
        }
    });
    *count += u64::from(triples.count_ones());
}
