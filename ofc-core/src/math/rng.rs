//! The seeded generator behind every random choice: `SplitMix64`.
//!
//! Small state, integer arithmetic only, the same sequence on every target.
//!
//! # Reference
//! G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014. G. E. P. Box,
//! M. E. Muller, "A note on the generation of random normal deviates", Ann. Math. Stat. 29, 1958.

use core::f64::consts::TAU;
use libm::{cos, log, sin, sqrt};

const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// A seeded sequence of random numbers.
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    /// A generator whose whole sequence is fixed by `seed`; every seed is good, 0 included.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub const fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Goes on as if `draws` numbers of 64 bits had been drawn.
    pub const fn skip(&mut self, draws: u64) {
        self.0 = self.0.wrapping_add(draws.wrapping_mul(STEP));
    }

    /// Two independent numbers of the standard normal distribution, by Box and Muller's method: two draws, no retry.
    pub fn normal_pair(&mut self) -> [f64; 2] {
        // 1 - unit is in (0, 1]: its logarithm is finite.
        let radius = sqrt(-2.0 * log(1.0 - self.unit()));
        let angle = TAU * self.unit();
        [radius * cos(angle), radius * sin(angle)]
    }

    /// A number from 0 up to but not including `bound`, without a retry loop; 0 when `bound` is 0.
    ///
    /// The multiply-high method without rejection: its bias is below `bound / 2^32`.
    pub const fn below(&mut self, bound: u32) -> u32 {
        let bits = self.next_u64() >> 32;
        ((bits * bound as u64) >> 32) as u32
    }

    /// A number uniform in [0, 1).
    pub const fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// `N` different numbers below `bound`, by Floyd's algorithm: exactly `N` draws, no retry.
    ///
    /// Returns `None` when there are fewer than `N` numbers to choose from.
    pub fn distinct<const N: usize>(&mut self, bound: u32) -> Option<[u32; N]> {
        let first = bound.checked_sub(u32::try_from(N).ok()?)?;
        let mut chosen = [u32::MAX; N];
        for i in 0..N {
            let limit = first + i as u32;
            let draw = self.below(limit + 1);
            let pick = if chosen.contains(&draw) { limit } else { draw };
            if let Some(slot) = chosen.get_mut(i) {
                *slot = pick;
            }
        }
        Some(chosen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_outputs_are_the_published_ones() {
        // The reference implementation's first outputs for seed 1234567 (prng.di.unimi.it/splitmix64.c).
        let mut rng = Rng::new(1_234_567);
        assert_eq!(rng.next_u64(), 6_457_827_717_110_365_317);
        assert_eq!(rng.next_u64(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn distinct_numbers_are_distinct_and_cover_the_range() {
        let mut rng = Rng::new(1);
        let mut seen = [false; 8];
        for _ in 0..200 {
            let chosen = rng.distinct::<6>(8).unwrap();
            for (i, &a) in chosen.iter().enumerate() {
                seen[a as usize] = true;
                assert!(!chosen[..i].contains(&a));
            }
        }
        assert_eq!(seen, [true; 8]);
        assert_eq!(rng.distinct::<6>(5), None);
        let mut all = rng.distinct::<6>(6).unwrap();
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn skipping_is_drawing() {
        let (mut drawn, mut skipped) = (Rng::new(5), Rng::new(5));
        for _ in 0..7 {
            drawn.next_u64();
        }
        skipped.skip(7);
        assert_eq!(drawn.next_u64(), skipped.next_u64());
    }

    #[test]
    fn normal_pairs_are_normal_and_independent() {
        const PAIRS: u32 = 100_000;
        let mut rng = Rng::new(11);
        let (mut sums, mut powers, mut product, mut beyond) = ([0.0; 2], [[0.0; 3]; 2], 0.0, 0);
        for _ in 0..PAIRS {
            let pair = rng.normal_pair();
            for ((sum, powers), x) in sums.iter_mut().zip(&mut powers).zip(pair) {
                *sum += x;
                for (sum, power) in powers.iter_mut().zip([x * x, x * x * x, x * x * x * x]) {
                    *sum += power;
                }
                beyond += u32::from(x.abs() > 1.959_964);
            }
            product += pair[0] * pair[1];
        }
        let count = f64::from(PAIRS);
        // Five standard errors of each moment.
        for (sum, [second, third, fourth]) in sums.iter().zip(powers) {
            assert!((sum / count).abs() < 0.016, "{sum}");
            assert!((second / count - 1.0).abs() < 0.023, "{second}");
            assert!((third / count).abs() < 0.062, "{third}");
            assert!((fourth / count - 3.0).abs() < 0.16, "{fourth}");
        }
        assert!((product / count).abs() < 0.016, "{product}");
        assert!((f64::from(beyond) / (2.0 * count) - 0.05).abs() < 0.0025, "{beyond}");
    }

    #[test]
    fn below_stays_below() {
        let mut rng = Rng::new(7);
        assert_eq!(rng.below(0), 0);
        assert_eq!(rng.below(1), 0);
        assert!((0..1000).all(|_| rng.below(10) < 10));
        assert!((0..1000).all(|_| (0.0..1.0).contains(&rng.unit())));
    }
}
