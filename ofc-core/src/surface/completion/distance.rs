//! How far the nearest of some pixels is, by chamfer distances.
//!
//! # Reference
//! G. Borgefors, "Distance transformations in digital images", CVGIP 34, 1986.

/// A step along a row or column, in the unit of the distances.
pub(super) const STEP: u32 = 3;
/// A diagonal step.
const DIAGONAL: u32 = 4;
/// Further than anything.
pub(super) const FAR: u32 = u32::MAX >> 2;

/// From distances of 0 at some pixels and [`FAR`] at the others, those to the nearest of these pixels. The lowest bit of every number
/// is a mark that goes along: numbers are twice the distance, plus the mark.
pub(super) fn spread(distances: &mut [u32], width: usize) {
    let width = width.max(1);
    let height = distances.len().checked_div(width).unwrap_or(0);
    for y in 0..height {
        for i in 0..width {
            relax(distances, width, [i, y], false);
        }
    }
    for y in (0..height).rev() {
        for i in (0..width).rev() {
            relax(distances, width, [i, y], true);
        }
    }
}

/// One pixel from the four neighbors that come before it, or after it.
#[inline]
fn relax(distances: &mut [u32], width: usize, [x, y]: [usize; 2], back: bool) {
    let here = y * width + x;
    let mut best = distances.get(here).copied().unwrap_or(FAR);
    if best < 2 {
        return;
    }
    let sign: isize = if back { 1 } else { -1 };
    for (dx, dy, cost) in [(1, 0, STEP), (1, 1, DIAGONAL), (0, 1, STEP), (-1, 1, DIAGONAL)] {
        let (u, v) = (x.wrapping_add_signed(sign * dx), y.wrapping_add_signed(sign * dy));
        if u < width
            && let Some(other) = distances.get(v.wrapping_mul(width).wrapping_add(u))
        {
            best = best.min(other.saturating_add(2 * cost));
        }
    }
    if let Some(slot) = distances.get_mut(here) {
        *slot = best;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_gives_its_mark() {
        let mut distances = [FAR; 9 * 7];
        (distances[2 * 9 + 1], distances[5 * 9 + 8]) = (0, 1);
        spread(&mut distances, 9);
        for y in 0..7_usize {
            for x in 0..9_usize {
                let to = |u: usize, v: usize| {
                    let (a, b) = (x.abs_diff(u) as u32, y.abs_diff(v) as u32);
                    DIAGONAL * a.min(b) + STEP * (a.max(b) - a.min(b))
                };
                assert_eq!(distances[y * 9 + x], (2 * to(1, 2)).min(2 * to(8, 5) + 1));
            }
        }
    }
}
