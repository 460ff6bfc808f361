//! Pixels that quads are made of: inliers, and what lies among them.

use super::constants::{AMONG, SMALLEST_AMONG};
use crate::color::inliers::{Band, Inliers};
use crate::picture::{Window, first_bits};
use libm::sqrt;

/// The pixels of a window that quads are made of, where `bits` are inliers. A residual above the limit is noise as often as not: among inliers, and with a normal
/// of nearly their length, a pixel is as good as they are; and quads need four neighbors.
pub(super) fn used(inliers: &Inliers, window: &Window, exposed: u64, bits: u64) -> u64 {
    let near = among(bits, window.len);
    near & bits | twice_as_wide(&inliers.norm).bits(window, exposed & near & !bits)
}

/// The pixels of so many around which a large share are set.
fn among(bits: u64, len: usize) -> u64 {
    if bits == 0 || bits == first_bits(len) {
        return bits;
    }
    let is_set = |i: usize| u32::from(i < len && bits >> i & 1 == 1);
    let (mut near, mut count) = (0, (0..AMONG).map(is_set).sum::<u32>());
    for i in 0..len {
        count += is_set(i + AMONG);
        let all = (i + AMONG).min(len - 1) - i.saturating_sub(AMONG) + 1;
        near |= u64::from(f64::from(count) >= SMALLEST_AMONG * all as f64) << i;
        count -= i.checked_sub(AMONG).map_or(0, is_set);
    }
    near
}

/// A band of lengths, twice as wide about its middle.
fn twice_as_wide(norm: &Band) -> Band {
    let [low, high] = [norm.low, norm.high].map(|square| sqrt(square.max(0.0)));
    if !(high > 0.0 && high.is_finite()) {
        return *norm;
    }
    let half = 0.5 * (high - low);
    let [low, high] = [(low - half).max(0.0), high + half];
    Band { low: low * low, high: high * high, ..*norm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::inliers::Inliers;
    use crate::picture::Usable;

    #[test]
    fn pixels_among_inliers_are_used_and_inliers_among_others_are_not() {
        let mut window = Window::new();
        window.len = 40;
        // Red alone: C = diag(1, 1, 1), so that the length of a normal is red. Inliers are those within 0.9 to 1.1.
        let form = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        let norm = Band { form, low: 0.81, high: 1.21 };
        let inliers = Inliers { norm, ..Inliers::all(Usable::below(f32::INFINITY)) };
        let [red, green, blue] = &mut window.color;
        green.fill(0.0);
        blue.fill(0.0);
        red.fill(1.0);
        // One a little beyond among inliers, one far beyond, and beyond column 19 two inliers among others.
        let beyond = [(5, 1.15), (9, 1.3)].into_iter().chain((20..40).map(|i| (i, 1.15)));
        beyond.for_each(|(i, value)| red[i] = value);
        (red[28], red[33]) = (1.0, 1.0);
        let bits = used(&inliers, &window, first_bits(40), inliers.bits_among(&window, first_bits(40)));
        let is_used = |i: usize| bits >> i & 1 == 1;
        assert!((0..9).all(is_used) && !is_used(9) && (10..19).all(is_used));
        assert!(!(22..40).any(is_used), "{bits:b}");
        // Where the lengths are not bounded, as they come.
        let everything = Inliers::all(Usable::below(f32::INFINITY));
        assert_eq!(used(&everything, &window, first_bits(40), first_bits(40)), first_bits(40));
    }
}
