//! Slants of the channels' equivalent lights from one channel at a time, one estimator a file.
//!
//! None of them is reliable on real surfaces (sections 3.1 and 4); the constrained slants of section 3.2 are what the
//! pipeline uses. They stand for comparison, and for pictures without consistent constrained slants.

pub mod lee_rosenfeld;
pub mod pentland;
pub mod zheng_chellappa;

use crate::picture::{Image, Window, for_each_bit};

/// Where the statistic that a slant is computed from lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// In the range of the method's equation: the slant solves it.
    Inside,
    /// Beyond the value at slant 0, which is the answer.
    BelowZero,
    /// Beyond the value at the largest slant, which is the answer.
    AboveLargest,
}

/// The slant of one channel's light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The slant in radians.
    pub slant: f64,
    /// What it was computed from, as the method defines it: a squared sine for Pentland (eq. 22), the ratio of root mean square
    /// to mean for Lee and Rosenfeld, the ratio of mean to root mean square for Zheng and Chellappa.
    pub statistic: f64,
    /// Whether the method's equation has a root.
    pub reach: Reach,
}

/// Mean and mean square of each channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// `<I>`, of eq. 23.
    pub mean: [f64; 3],
    /// `<I^2>`, of eq. 23.
    pub mean_square: [f64; 3],
}

/// The moments over the pixels whose bits `selected` gives; `None` when there are none.
pub fn moments(image: &Image, selected: impl Fn(&Window) -> u64) -> Option<Moments> {
    let (mut sums, mut squares, mut count) = ([0.0; 3], [0.0; 3], 0_u64);
    image.for_each_window(|window| {
        let (mut window_sums, mut window_squares) = ([0.0; 3], [0.0; 3]);
        let bits = selected(window);
        for_each_bit(bits, |i| {
            let slots = window_sums.iter_mut().zip(&mut window_squares);
            for ((sum, square), value) in slots.zip(window.pixel(i).map(f64::from)) {
                *sum += value;
                *square += value * value;
            }
        });
        for (total, sum) in sums.iter_mut().zip(window_sums) {
            *total += sum;
        }
        for (total, square) in squares.iter_mut().zip(window_squares) {
            *total += square;
        }
        count += u64::from(bits.count_ones());
    });
    let per_pixel = |sum: f64| sum / count as f64;
    (count > 0).then(|| Moments { mean: sums.map(per_pixel), mean_square: squares.map(per_pixel) })
}

/// Where in [0, `largest`] a function that grows with the slant takes the value `statistic`.
fn solve_increasing(statistic: f64, largest: f64, function: impl Fn(f64) -> f64) -> (f64, Reach) {
    /// Halvings: to the last bits of an angle.
    const STEPS: usize = 50;
    if statistic < function(0.0) {
        return (0.0, Reach::BelowZero);
    }
    if statistic > function(largest) {
        return (largest, Reach::AboveLargest);
    }
    let (mut low, mut high) = (0.0, largest);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if function(middle) <= statistic {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high), Reach::Inside)
}
