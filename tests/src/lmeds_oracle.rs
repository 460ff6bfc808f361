//! Least median of squares by exhaustion and by random restarts, all in f64, and the statistics after it.

use crate::linear::{eliminate, least_squares, median};
use ofc_core::math::rng::Rng;

/// The row of M for a color, the terms of eq. 10 in its order.
#[must_use]
pub fn row([r, g, b]: [f64; 3]) -> [f64; 6] {
    [r * r, g * g, b * b, 2.0 * r * g, 2.0 * r * b, 2.0 * g * b]
}

/// |M z - 1| of every color.
#[must_use]
pub fn residuals(z: [f64; 6], colors: &[[f64; 3]]) -> Vec<f64> {
    let form = |color| row(color).iter().zip(z).map(|(m, z)| m * z).sum::<f64>();
    colors.iter().map(|&color| (form(color) - 1.0).abs()).collect()
}

/// The square root of the objective: the median absolute residual.
#[must_use]
pub fn objective(z: [f64; 6], colors: &[[f64; 3]]) -> f64 {
    median(&residuals(z, colors))
}

fn through(colors: [[f64; 3]; 6]) -> Option<[f64; 6]> {
    eliminate(colors.map(row), [1.0; 6])
}

/// The smallest objective of an ellipsoid through six of the colors, by trying all sixes.
#[must_use]
pub fn exhaustive(colors: &[[f64; 3]]) -> f64 {
    let mut best = f64::INFINITY;
    for bits in 0_u32..1 << colors.len() {
        if bits.count_ones() == 6 {
            let mut chosen = (0..colors.len()).filter(|i| bits >> i & 1 == 1).map(|i| colors[i]);
            let subset = [(); 6].map(|()| chosen.next().unwrap_or([0.0; 3]));
            if let Some(z) = through(subset) {
                best = best.min(objective(z, colors));
            }
        }
    }
    best
}

/// The smallest objective of so many random subsets, the ten best of which are improved by fitting the better half
/// again for as long as that helps.
#[must_use]
pub fn restarts(colors: &[[f64; 3]], subsets: usize, seed: u64) -> f64 {
    let mut rng = Rng::new(seed ^ 0x0dd0_f00d);
    let mut found: Vec<(f64, [f64; 6])> = Vec::new();
    for _ in 0..subsets {
        let subset = [(); 6].map(|()| colors[rng.below(colors.len() as u32) as usize]);
        if let Some(z) = through(subset) {
            found.push((objective(z, colors), z));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(10);
    let mut best = f64::INFINITY;
    for (start, z) in found {
        let (mut value, mut z) = (start, z);
        loop {
            best = best.min(value);
            let better: Vec<[f64; 6]> = colors
                .iter()
                .zip(residuals(z, colors))
                .filter(|&(_, residual)| residual <= value)
                .map(|(&color, _)| row(color))
                .collect();
            (z, _) = least_squares(&better, &vec![1.0; better.len()]);
            let improved = objective(z, colors);
            if !improved.is_finite() || improved >= value {
                break;
            }
            value = improved;
        }
    }
    best
}

/// Integrals of cos^(degrees - 1) over [from, pi/2]: Student's density after x = sqrt(degrees) tan(theta), unscaled.
fn student_tail(from: f64, degrees: f64) -> f64 {
    let intervals = 40_000;
    let width = (std::f64::consts::FRAC_PI_2 - from) / f64::from(intervals);
    let value = |i: i32| (from + f64::from(i) * width).cos().max(0.0).powf(degrees - 1.0);
    let inner: f64 = (1..intervals).map(|i| value(i) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (value(0) + inner + value(intervals)) * width / 3.0
}

/// The two-sided p value of Student's t by Simpson's rule; no gamma function, the whole integral is its own scale.
#[must_use]
pub fn two_sided_p(t: f64, degrees: f64) -> f64 {
    student_tail((t.abs() / degrees.sqrt()).atan(), degrees) / student_tail(0.0, degrees)
}

/// The t at which that p value is 1 - `confidence`.
#[must_use]
pub fn quantile(confidence: f64, degrees: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e4);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if two_sided_p(middle, degrees) > 1.0 - confidence {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
