//! Sine and cosine of angles that are rarely more than a turn.
//!
//! `libm`'s take any number, and for those above 2^20 carry two kilobytes of 2 / pi along: too much for a flash memory of
//! 64. The polynomials are the same.
//!
//! # Reference
//! `FreeBSD`'s msun (`k_sin.c`, `k_cos.c`, `e_rem_pio2.c`), Sun Microsystems 1993. W. J. Cody, W. Waite, "Software Manual for the
//! Elementary Functions", Prentice-Hall 1980 (the reduction).

use core::f64::consts::{FRAC_2_PI, TAU};
use libm::{fabs, floor};

/// The largest angle whose quarters of a turn are taken off without an error, in radians.
const LARGEST: f64 = 1e5;

/// From here on an angle's own rounding is more than a turn: it may as well be zero.
const MEANINGLESS: f64 = 1e17;

/// Half of pi in three parts, the first two of 33 bits.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_7e-21];

/// Of the sine from the third power on, of the cosine from the fourth.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sine and cosine of an angle in radians: to the last bit or the one before it up to 100,000, and above that as good as
/// the angle's own rounding; NaN for what is not finite.
#[must_use]
#[inline(never)]
pub fn sincos(angle: f64) -> (f64, f64) {
    let size = fabs(angle);
    let angle = if size <= LARGEST {
        angle
    } else if size < MEANINGLESS {
        angle - TAU * floor(angle / TAU)
    } else {
        0.0 * angle
    };
    let quarters = floor(angle * FRAC_2_PI + 0.5);
    let [first, second, third] = HALF_PI;
    let x = ((angle - quarters * first) - quarters * second) - quarters * third;
    let square = x * x;
    let horner = |terms: [f64; 6]| terms.iter().rev().fold(0.0, |sum, term| sum * square + term);
    let sine = x + x * square * horner(SINE);
    let half = 0.5 * square;
    let one = 1.0 - half;
    let cosine = one + (((1.0 - one) - half) + square * square * horner(COSINE));
    // Modulo four, for either sign.
    match quarters as i64 & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn as_libm_has_them() {
        let mut rng = Rng::new(1);
        for n in 0..200_000 {
            let size = [0.8, 7.0, 1e3, LARGEST][n % 4];
            let angle = size * (2.0 * rng.unit() - 1.0);
            let ((s, c), (sine, cosine)) = (sincos(angle), libm::sincos(angle));
            // The reduced angle is off by no more than the rounding of its last part.
            let slack = 2.3e-16 * (1.0 + 1e-6 * size);
            assert!(
                (s - sine).abs() <= slack && (c - cosine).abs() <= slack,
                "{angle} {s} {sine} {c} {cosine}"
            );
        }
        assert_eq!(sincos(0.0), (0.0, 1.0));
        for angle in [1e6, -1e9, 1e16, 1e300] {
            let (s, c) = sincos(angle);
            assert!((s * s + c * c - 1.0).abs() < 1e-12, "{angle}");
        }
        assert!([f64::NAN, f64::INFINITY].iter().all(|&angle| sincos(angle).0.is_nan()));
    }
}
