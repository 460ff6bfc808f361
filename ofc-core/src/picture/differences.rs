//! Differences between neighbouring pixels along one direction, summed over a picture.

use crate::picture::{Window, for_each_bit};

/// Sums over the pairs of one direction, a channel each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Differences {
    sums: [f64; 3],
    squares: [f64; 3],
    count: u64,
}

impl Differences {
    /// Adds the differences `to` - `from` of the pairs whose pixels `i + shift` the `bits` `i` say.
    pub fn add(&mut self, bits: u64, (to, to_shift): (&Window, usize), (from, from_shift): (&Window, usize)) {
        let (mut sums, mut squares) = ([0.0; 3], [0.0; 3]);
        for_each_bit(bits, |i| {
            let pairs = to.pixel(i + to_shift).into_iter().zip(from.pixel(i + from_shift));
            for ((sum, square), (to, from)) in sums.iter_mut().zip(&mut squares).zip(pairs) {
                let difference = f64::from(to) - f64::from(from);
                *sum += difference;
                *square += difference * difference;
            }
        });
        // A sum a window first: fewer roundings, and the same order everywhere.
        for (total, sum) in self.sums.iter_mut().zip(sums) {
            *total += sum;
        }
        for (total, square) in self.squares.iter_mut().zip(squares) {
            *total += square;
        }
        self.count += u64::from(bits.count_ones());
    }

    /// How many pairs there are.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The mean derivatives and the variances of the derivatives of the three channels, for pixels `distance` apart;
    /// `None` without a pair.
    #[must_use]
    pub fn statistics(&self, distance: f64) -> Option<[(f64, f64); 3]> {
        if self.count == 0 {
            return None;
        }
        let (scale, count) = (1.0 / distance, self.count as f64);
        let mut result = [(0.0, 0.0); 3];
        for (out, (sum, square)) in result.iter_mut().zip(self.sums.iter().zip(&self.squares)) {
            let mean = sum / count;
            *out = (mean * scale, (square / count - mean * mean).max(0.0) * scale * scale);
        }
        Some(result)
    }
}
