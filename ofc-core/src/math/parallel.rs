//! Work in parts that may run at the same time, on threads of the caller: nothing here knows of threads.
//!
//! What is computed does not depend on how many parts run at once. Parts write to memory of their own, how they are cut depends on
//! the data alone, and what they come to is merged in their order.

/// The largest number of parts that work is cut into: enough to keep 16 threads busy where some parts take longer than others.
pub const MOST_PARTS: usize = 32;

/// What runs the parts of some work.
pub trait Parallel {
    /// Calls `part` once for each item, with its index: in any order, perhaps several at the same time, and all of them before this
    /// returns.
    fn for_each<T: Send, F: Fn(usize, &mut T) + Sync>(&self, items: &mut [T], part: F);
}

/// One part after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Parallel for Serial {
    fn for_each<T: Send, F: Fn(usize, &mut T) + Sync>(&self, items: &mut [T], part: F) {
        for (i, item) in items.iter_mut().enumerate() {
            part(i, item);
        }
    }
}

/// How many of `count` rows are a part, if each part is to have at least `least` of them.
#[must_use]
pub const fn rows_of_part(count: usize, least: usize) -> usize {
    let even = count.div_ceil(MOST_PARTS);
    if even > least { even } else { least }
}

/// Cuts `data` into parts of so many numbers, the last of which may be shorter, and calls `part` for each with its index. What is
/// beyond [`MOST_PARTS`] parts is left out.
pub fn for_each_chunk<T: Send>(
    parallel: &impl Parallel,
    data: &mut [T],
    numbers: usize,
    part: impl Fn(usize, &mut [T]) + Sync,
) {
    let mut chunks = data.chunks_mut(numbers.max(1));
    let count = chunks.len();
    let mut items: [&mut [T]; MOST_PARTS] = [(); MOST_PARTS].map(|()| chunks.next().unwrap_or_default());
    let items = items.get_mut(..count.min(MOST_PARTS)).unwrap_or_default();
    parallel.for_each(items, |i, chunk| part(i, chunk));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn every_number_is_in_one_part() {
        for (count, least) in [(1, 1), (31, 1), (32, 1), (33, 1), (1000, 7), (1000, 400), (5, 64)] {
            let numbers = rows_of_part(count, least);
            assert!(numbers >= least && count.div_ceil(numbers) <= MOST_PARTS);
            let mut data = vec![0; count];
            for_each_chunk(&Serial, &mut data, numbers, |i, part| {
                for slot in part {
                    *slot += i + 1;
                }
            });
            let wanted: Vec<_> = (0..count).map(|k| k / numbers + 1).collect();
            assert_eq!(data, wanted);
        }
    }
}
