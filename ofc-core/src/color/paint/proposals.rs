//! Where to begin: of many forms through five pairs each, the one that most pairs agree with.

use super::pairs::{FEWEST, Pairs, lengths, monomials};
use crate::color::ellipsoid::{Coefficients, is_positive_definite};
use crate::math::mat6;
use crate::math::rng::Rng;
use crate::math::select::{kth_smallest, median_rank};
use libm::log;

/// Forms that are tried.
const PROPOSALS: usize = 300;
/// Pairs that have a say, all together.
const FEWEST_PAIRS: u32 = 50;
/// Of the pairs of each distance every so-many-th is asked.
const STRIDE: usize = 6;
/// Added to the median difference of the logarithms, so that an exact form is no better than paint and noise make it.
const FLOOR: f64 = 1e-3;

/// The best form; `None` where none is an ellipsoid, or pairs are too few. Medians are taken of each distance, for paint is rougher
/// over longer ones, and their logarithms are added.
pub(super) fn best(pairs: &Pairs, rng: &mut Rng, values: &mut [f32]) -> Option<Coefficients> {
    let count: u32 = pairs.counts().iter().sum();
    if count < FEWEST_PAIRS {
        return None;
    }
    let mut best: Option<(f64, Coefficients)> = None;
    for _ in 0..PROPOSALS {
        let Some(z) = proposal(pairs, rng.distinct(count)?) else { continue };
        let score = score(pairs, &z, values);
        if best.is_none_or(|(least, _)| score < least) {
            best = Some((score, z));
        }
    }
    best.map(|(_, z)| z)
}

/// The form with trace 1 for which the colors of each of five pairs are equally long, where it is an ellipsoid.
fn proposal(pairs: &Pairs, numbers: [u32; 5]) -> Option<Coefficients> {
    let mut columns = [[0.0; 6]; 6];
    for (i, number) in numbers.into_iter().enumerate() {
        let [p, q] = monomials(pairs.get(number as usize)?);
        for ((column, p), q) in columns.iter_mut().zip(p).zip(q) {
            *column.get_mut(i)? = p - q;
        }
    }
    for (column, trace) in columns.iter_mut().zip([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]) {
        *column.last_mut()? = trace;
    }
    let z = mat6::solve(&columns, &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0])?;
    (z.iter().all(|c| c.is_finite()) && is_positive_definite(&z)).then_some(z)
}

fn score(pairs: &Pairs, z: &Coefficients, values: &mut [f32]) -> f64 {
    let mut score = 0.0;
    for own in pairs.of {
        if own.len() < FEWEST {
            continue;
        }
        let asked = own.iter().step_by(STRIDE);
        let count = asked.len();
        for (slot, pair) in values.iter_mut().zip(asked) {
            let [p, q] = lengths(z, pair);
            *slot = (p.max(q) / p.min(q).max(f64::MIN_POSITIVE)) as f32;
        }
        let values = values.get(..count).unwrap_or_default();
        let median = kth_smallest(values, median_rank(count)).map_or(f64::INFINITY, f64::from);
        score += log(log(median) + FLOOR);
    }
    score
}
