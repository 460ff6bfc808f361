//! Order statistics without moving data: the k-th smallest value, and a stable sort with a second buffer.
//!
//! Both work on the bits of the numbers, eight at a time: the cost is linear whatever the values are, nothing is
//! compared through a closure, and no bound is left to a pivot's luck. NaN sorts above infinity (or below minus
//! infinity when its sign bit is set), so even that input has an answer; the pipeline never feeds it.

use core::mem;

const RADIX_BITS: u32 = 8;
const BUCKETS: usize = 1 << RADIX_BITS;
const PASSES: u32 = u32::BITS / RADIX_BITS;

/// The bits of `value` rearranged so that unsigned order is numeric order.
const fn key(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 0 { bits | 0x8000_0000 } else { !bits }
}

/// The same as a number with a sign, which vector instructions compare.
const fn order(value: f32) -> i32 {
    let bits = value.to_bits().cast_signed();
    bits ^ ((bits >> 31) & i32::MAX)
}

const fn from_key(key: u32) -> f32 {
    f32::from_bits(if key >> 31 == 1 { key & 0x7fff_ffff } else { !key })
}

const fn digit(key: u32, pass: u32) -> usize {
    ((key >> (pass * RADIX_BITS)) & (BUCKETS as u32 - 1)) as usize
}

/// The `rank`-th smallest of `values` (0 is the smallest), or `None` if there are not that many.
#[must_use]
pub fn kth_smallest(values: &[f32], rank: usize) -> Option<f32> {
    if rank >= values.len() {
        return None;
    }
    let mut rank = rank as u32;
    let (mut prefix, mut prefix_mask) = (0_u32, 0_u32);
    for pass in (0..PASSES).rev() {
        // No more values than pixels.
        let mut counts = [0_u32; BUCKETS];
        for &value in values {
            let key = key(value);
            if key & prefix_mask == prefix {
                counts[digit(key, pass)] += 1;
            }
        }
        for (bucket, &count) in counts.iter().enumerate() {
            if rank < count {
                prefix |= (bucket as u32) << (pass * RADIX_BITS);
                break;
            }
            rank -= count;
        }
        prefix_mask |= (BUCKETS as u32 - 1) << (pass * RADIX_BITS);
    }
    Some(from_key(prefix))
}

/// [`kth_smallest`] of values that may be lost. Of many, some say between which two the answer lies almost surely, and only those
/// between are left.
#[must_use]
pub fn take_kth_smallest(values: &mut [f32], rank: usize) -> Option<f32> {
    const ROUNDS: usize = 3;
    let (mut values, mut rank) = (values, rank);
    for _ in 0..ROUNDS {
        let Some((below, left)) = drop_far(values, rank) else { break };
        values = values.get_mut(..left)?;
        rank -= below;
    }
    kth_smallest(values, rank)
}

/// [`take_kth_smallest`], which is fast where the answer lies within these two values.
#[must_use]
pub fn take_kth_smallest_within(values: &mut [f32], rank: usize, [low, high]: [f32; 2]) -> Option<f32> {
    match keep_within(values, rank, low, high) {
        Some((below, left)) => take_kth_smallest(values.get_mut(..left)?, rank - below),
        None => take_kth_smallest(values, rank),
    }
}

/// [`keep_within`] what a sample says. `None` also where there are too few for that to pay.
fn drop_far(values: &mut [f32], rank: usize) -> Option<(usize, usize)> {
    const SAMPLE: usize = 512;
    /// Five deviations of the rank that a median has in a sample.
    const SLACK: usize = 57;
    let stride = values.len() / SAMPLE;
    if stride < 8 {
        return None;
    }
    // It goes to the front, where it takes no room.
    let (sample, others) = values.split_at_mut_checked(SAMPLE)?;
    for (first, value) in sample.iter_mut().zip(others.iter_mut().step_by(stride - 1)) {
        mem::swap(first, value);
    }
    let middle = rank.checked_div(stride)?;
    let low = kth_smallest(sample, middle.saturating_sub(SLACK))?;
    let high = kth_smallest(sample, (middle + SLACK).min(SAMPLE - 1))?;
    keep_within(values, rank, low, high)
}

/// Moves the values that are not outside these to the front: how many are below all of them, and how many they are. `None`, with
/// nothing moved, where the one of this rank is not among them.
fn keep_within(values: &mut [f32], rank: usize, low: f32, high: f32) -> Option<(usize, usize)> {
    const FEW: usize = 16;
    let (low, high) = (order(low), order(high));
    if low > high {
        return None;
    }
    let (mut below, mut above) = (0_u32, 0_u32);
    for &value in values.iter() {
        let place = order(value);
        below += u32::from(place < low);
        above += u32::from(place > high);
    }
    let (below, kept) = (below as usize, values.len() - (below + above) as usize);
    if !(below..below + kept).contains(&rank) {
        return None;
    }
    let (mut from, mut to) = (0, 0);
    while from < values.len() {
        let mut few = [f32::NAN; FEW];
        let len = FEW.min(values.len() - from);
        for (out, value) in few.iter_mut().zip(values.get(from..)?) {
            *out = *value;
        }
        let is_within = |value: f32| (order(value) >= low) & (order(value) <= high);
        if few.iter().fold(false, |any, &value| any | is_within(value)) {
            for &value in few.iter().take(len).filter(|&&value| is_within(value)) {
                if let Some(slot) = values.get_mut(to) {
                    *slot = value;
                }
                to += 1;
            }
        }
        from += len;
    }
    Some((below, to))
}

/// The rank of the median that least median of squares minimizes: `h = floor(n / 2) + 1` of `n` values are at or
/// below it (Rousseeuw and Leroy, chapter 3, without the correction for the number of coefficients).
#[must_use]
pub const fn median_rank(count: usize) -> usize {
    count / 2
}

/// Sorts `values` in ascending order. `scratch` must be at least as long; its contents are overwritten.
///
/// Returns `false`, with `values` untouched, when `scratch` is too short.
#[must_use]
pub fn sort(values: &mut [f32], scratch: &mut [f32]) -> bool {
    let Some(scratch) = scratch.get_mut(..values.len()) else { return false };
    // An even number of passes leaves the result where it started.
    for pass in 0..PASSES {
        if pass % 2 == 0 {
            scatter(values, scratch, pass);
        } else {
            scatter(scratch, values, pass);
        }
    }
    true
}

fn scatter(from: &[f32], to: &mut [f32], pass: u32) {
    let mut starts = [0_u32; BUCKETS];
    for &value in from {
        starts[digit(key(value), pass)] += 1;
    }
    let mut sum = 0;
    for start in &mut starts {
        let count = *start;
        *start = sum;
        sum += count;
    }
    for &value in from {
        let start = &mut starts[digit(key(value), pass)];
        if let Some(slot) = to.get_mut(*start as usize) {
            *slot = value;
        }
        *start += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    fn shuffled(count: usize, seed: u64) -> [f32; 501] {
        let mut rng = Rng::new(seed);
        let mut values = [0.0; 501];
        for value in values.iter_mut().take(count) {
            // Ties and both signs are frequent.
            *value = (rng.below(200) as f32 - 100.0) * 0.37;
        }
        values
    }

    #[test]
    fn agrees_with_the_standard_sort() {
        for count in [1, 2, 3, 10, 257, 501] {
            let values = shuffled(count, count as u64);
            let mut expected = values;
            expected[..count].sort_by(f32::total_cmp);
            let (mut sorted, mut scratch) = (values, [9.0; 501]);
            assert!(sort(&mut sorted[..count], &mut scratch));
            assert_eq!(sorted[..count], expected[..count]);
            for (rank, &value) in expected[..count].iter().enumerate() {
                assert_eq!(kth_smallest(&values[..count], rank), Some(value));
            }
        }
    }

    #[test]
    fn taken_from_many_it_is_the_same() {
        let mut rng = Rng::new(9);
        for count in [5, 4000, 4096, 5000, 40_000, 100_003] {
            for kind in 0..4 {
                let values: std::vec::Vec<f32> = (0..count)
                    .map(|i| match kind {
                        0 => rng.unit() as f32,
                        // Ties, both zeros, and an order that a sample at equal distances does not see.
                        1 => (rng.below(5) as f32 - 2.0) * 0.0_f32.max((i % 3) as f32),
                        2 => (i % 78) as f32,
                        _ if i % 2 == 0 => f32::INFINITY,
                        _ => f32::from_bits(rng.next_u64() as u32),
                    })
                    .collect();
                for rank in [0, 1, count / 3, count / 2, count - 1, count] {
                    let taken = take_kth_smallest(&mut values.clone(), rank).map(f32::to_bits);
                    let expected = kth_smallest(&values, rank).map(f32::to_bits);
                    assert_eq!(taken, expected, "{count} {kind} {rank}");
                    for within in [[0.2, 0.4], [0.0, 1.0], [3.0, 30.0], [1.0, 0.0]] {
                        let taken = take_kth_smallest_within(&mut values.clone(), rank, within);
                        assert_eq!(taken.map(f32::to_bits), expected, "{count} {kind} {rank} {within:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn too_few_values_or_scratch() {
        assert_eq!(kth_smallest(&[], 0), None);
        assert_eq!(kth_smallest(&[1.0], 1), None);
        let mut values = [2.0, 1.0];
        assert!(!sort(&mut values, &mut [0.0]));
        assert_eq!(values, [2.0, 1.0]);
    }

    #[test]
    fn special_values_have_a_place() {
        let values = [f32::INFINITY, -0.0, 0.0, f32::NEG_INFINITY, f32::NAN, f32::MIN_POSITIVE / 2.0];
        assert_eq!(kth_smallest(&values, 0), Some(f32::NEG_INFINITY));
        assert_eq!(kth_smallest(&values, 3), Some(f32::MIN_POSITIVE / 2.0));
        assert_eq!(kth_smallest(&values, 4), Some(f32::INFINITY));
        assert!(kth_smallest(&values, 5).is_some_and(f32::is_nan));
    }
}
