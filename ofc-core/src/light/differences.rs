//! Differences between pixels a step apart, summed over a picture.

use crate::picture::{Window, for_each_bit};

/// Sums of the first `POWERS` powers of the differences along one direction, a channel each: 1 for means, 2 for variances too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differences<const POWERS: usize> {
    sums: [[f64; 3]; POWERS],
    count: u64,
}

impl<const POWERS: usize> Differences<POWERS> {
    /// No pairs yet.
    pub const NONE: Self = Self { sums: [[0.0; 3]; POWERS], count: 0 };

    /// Adds the differences `to` - `from` of the pairs whose pixels `i + shift` the `bits` `i` say, of which `value` makes
    /// numbers.
    pub fn add(
        &mut self,
        bits: u64,
        (to, to_shift): (&Window, usize),
        (from, from_shift): (&Window, usize),
        value: &impl Fn(&Window, usize) -> [f64; 3],
    ) {
        let mut sums = [[0.0; 3]; POWERS];
        for_each_bit(bits, |i| {
            let ([r, g, b], [r0, g0, b0]) = (value(to, i + to_shift), value(from, i + from_shift));
            let difference @ [red, green, blue] = [r - r0, g - g0, b - b0];
            let mut power = difference;
            for [red_sum, green_sum, blue_sum] in &mut sums {
                let [r, g, b] = power;
                (*red_sum, *green_sum, *blue_sum) = (*red_sum + r, *green_sum + g, *blue_sum + b);
                power = [r * red, g * green, b * blue];
            }
        });
        // A sum a window first: fewer roundings, and the same order everywhere.
        for (totals, sums) in self.sums.iter_mut().zip(sums) {
            for (total, sum) in totals.iter_mut().zip(sums) {
                *total += sum;
            }
        }
        self.count += u64::from(bits.count_ones());
    }

    /// The mean derivative of a channel, for pixels whose distance has the reciprocal `per_step`; `None` without a pair.
    #[must_use]
    pub fn mean(&self, channel: usize, per_step: f64) -> Option<f64> {
        let sum = self.sums.first()?.get(channel)?;
        (self.count > 0).then(|| sum / self.count as f64 * per_step)
    }
}

impl Differences<1> {
    /// Adds the difference of one pair.
    pub fn add_pair(&mut self, to: [f32; 3], from: [f32; 3]) {
        let [sums] = &mut self.sums;
        for ((sum, to), from) in sums.iter_mut().zip(to).zip(from) {
            *sum += f64::from(to) - f64::from(from);
        }
        self.count += 1;
    }

    /// Keeps `share` of these differences and adds others, each counted as one and worth `scale`.
    #[expect(clippy::cast_sign_loss, reason = "counts")]
    pub fn blend(&mut self, other: &Self, share: f64, scale: f64) {
        let ([sums], [others]) = (&mut self.sums, &other.sums);
        for (sum, other) in sums.iter_mut().zip(others) {
            *sum = *sum * share + other * scale;
        }
        self.count = (self.count as f64 * share) as u64 + other.count;
    }
}

impl Differences<2> {
    /// The variance of the derivative of a channel, for pixels whose distance has the reciprocal `per_step`; `None` without a
    /// pair.
    #[must_use]
    pub fn variance(&self, channel: usize, per_step: f64) -> Option<f64> {
        let [_, squares] = &self.sums;
        let (mean, count) = (self.mean(channel, 1.0)?, self.count as f64);
        Some((squares.get(channel)? / count - mean * mean).max(0.0) * per_step * per_step)
    }
}

/// A pixel's color in double precision.
#[inline]
#[must_use]
pub fn color(window: &Window, i: usize) -> [f64; 3] {
    // Not by map(), which is a call where code is made small.
    let [r, g, b] = window.pixel(i);
    [f64::from(r), f64::from(g), f64::from(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many pairs whose differences are these.
    fn pairs(differences: &[[f32; 3]]) -> Differences<1> {
        let mut sums = Differences::NONE;
        for &[r, g, b] in differences {
            sums.add_pair([r + 5.0, g + 6.0, b + 7.0], [5.0, 6.0, 7.0]);
        }
        sums
    }

    #[test]
    fn blended_differences_are_weighted_and_counted() {
        let mut sums = pairs(&[[1.0, -2.0, 4.0]; 8]);
        sums.blend(&pairs(&[[3.0, 8.0, -1.0], [5.0, 0.0, -1.0]]), 0.75, 0.5);
        // Sums 8 x difference x 3/4 + half of the others, over 6 + 2 pairs.
        let wanted = [(6.0 + 4.0) / 8.0, (-12.0 + 4.0) / 8.0, (24.0 - 1.0) / 8.0];
        for (channel, wanted) in wanted.into_iter().enumerate() {
            assert_eq!(sums.mean(channel, 1.0), Some(wanted));
            assert_eq!(sums.mean(channel, 0.25), Some(0.25 * wanted));
        }
        assert_eq!(sums.mean(3, 1.0), None);
        assert_eq!(Differences::<1>::NONE.mean(0, 1.0), None);
    }
}
