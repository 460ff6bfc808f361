//! Sums over square windows.

use super::map::row_of;

/// Replaces every number by the sum over the window of `2 radius + 1` pixels a side around it, of what lies in the picture.
///
/// Sums run along, one number coming and one going: the cost does not depend on the size of the window.
pub(super) fn sums(values: &mut [f32], between: &mut [f32], width: usize, radius: usize) {
    let step = width.max(1);
    let rows = values.len().checked_div(step).unwrap_or(0);
    for (y, out) in between.chunks_exact_mut(step).enumerate().take(rows) {
        let row = row_of(values, step, y);
        let mut sum: f32 = row.iter().take(radius).sum();
        let coming = row.iter().skip(radius).copied().chain(core::iter::repeat(0.0));
        let going = core::iter::repeat_n(0.0, radius + 1).chain(row.iter().copied());
        for ((out, coming), going) in out.iter_mut().zip(coming).zip(going) {
            sum = sum + coming - going;
            *out = sum;
        }
    }
    // The first row is summed in place, each next one from the one above it.
    for y in 0..rows {
        let (above, rest) = values.split_at_mut_checked(y * step).unwrap_or_default();
        let Some(out) = rest.get_mut(..step) else { return };
        let row = |y: usize| row_of(between, step, y);
        if y == 0 {
            out.fill(0.0);
            for coming in 0..=radius {
                out.iter_mut().zip(row(coming)).for_each(|(out, value)| *out += value);
            }
            continue;
        }
        let before = above.get((y - 1) * step..).unwrap_or_default();
        out.iter_mut().zip(before).for_each(|(out, before)| *out = *before);
        out.iter_mut().zip(row(y + radius)).for_each(|(out, coming)| *out += coming);
        if let Some(going) = y.checked_sub(radius + 1) {
            out.iter_mut().zip(row(going)).for_each(|(out, going)| *out -= going);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use std::vec::Vec;

    #[test]
    fn sums_are_those_of_the_windows() {
        let mut rng = Rng::new(4);
        for (width, height, radius) in [(1, 1, 3), (7, 5, 1), (5, 9, 2), (4, 30, 7), (40, 3, 15)] {
            let values: Vec<f32> = (0..width * height).map(|_| (rng.below(64) as f32) - 32.0).collect();
            let (mut out, mut between) = (values.clone(), values.clone());
            sums(&mut out, &mut between, width, radius);
            for y in 0..height {
                for x in 0..width {
                    let mut wanted = 0.0;
                    for v in y.saturating_sub(radius)..(y + radius + 1).min(height) {
                        for u in x.saturating_sub(radius)..(x + radius + 1).min(width) {
                            wanted += values[v * width + u];
                        }
                    }
                    // Small integers: exact.
                    assert_eq!(out[y * width + x], wanted, "{width} x {height}, {radius}: {x} {y}");
                }
            }
        }
    }
}
