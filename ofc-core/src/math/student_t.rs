//! Student's t distribution: two-sided p values and the quantile behind confidence limits.
//!
//! The ratio of gamma functions is a series of its own: as a difference of `libm`'s `lgamma` it loses digits, 3e-9 of p instead
//! of 2e-10 at a million degrees of freedom. `lgamma`, with `erfc` in place of the fraction for larger samples, would also
//! take 2,664 bytes of a firmware that has 65,536.
//!
//! # Reference
//! M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions", 26.7.1 and 26.5.8 (the continued fraction of
//! the incomplete beta function, evaluated by Lentz's method) and 6.1.47 (the asymptotic series of a ratio of gammas).

use libm::{exp, fabs, log, sqrt};

/// With so many degrees of freedom t is normal to seven digits, and the continued fraction is long: more count as so many.
const MOST_DEGREES: f64 = 1e6;

const SQRT_PI: f64 = 1.772_453_850_905_516;

/// The fraction converges in about the square root of the degrees of freedom.
const MAX_TERMS: usize = 4000;

/// The probability that |T| exceeds |t| with `degrees` degrees of freedom; NaN when `degrees` is not positive.
#[must_use]
pub fn two_sided_p(t: f64, degrees: f64) -> f64 {
    if t.is_nan() || degrees.is_nan() || degrees <= 0.0 {
        return f64::NAN;
    }
    let degrees = degrees.min(MOST_DEGREES);
    let squared = t * t;
    if squared.is_infinite() {
        return 0.0;
    }
    incomplete_beta(0.5 * degrees, degrees / (degrees + squared), squared / (degrees + squared))
}

/// The t whose two-sided p value is 1 - `confidence`: the half-width of a confidence interval in standard errors.
///
/// NaN when `confidence` is not in (0, 1) or `degrees` is not positive.
#[must_use]
pub fn quantile(confidence: f64, degrees: f64) -> f64 {
    if !(confidence > 0.0 && confidence < 1.0 && degrees > 0.0) {
        return f64::NAN;
    }
    let p = 1.0 - confidence;
    let (mut low, mut high) = (0.0, 1.0);
    // One degree of freedom and p = 1e-16 need t = 6e15, fifty-three doublings.
    for _ in 0..64 {
        if two_sided_p(high, degrees) <= p {
            break;
        }
        low = high;
        high *= 2.0;
    }
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if two_sided_p(middle, degrees) > p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The regularised incomplete beta function `I_x(a, 1/2)`, given x and 1 - x apart so that neither loses its digits.
fn incomplete_beta(a: f64, x: f64, one_minus_x: f64) -> f64 {
    const B: f64 = 0.5;
    if x <= 0.0 {
        return 0.0;
    }
    if one_minus_x <= 0.0 {
        return 1.0;
    }
    let front = gamma_ratio(a) / SQRT_PI * exp(a * log(x)) * sqrt(one_minus_x);
    if x < (a + 1.0) / (a + B + 2.0) {
        front * continued_fraction(a, B, x) / a
    } else {
        1.0 - front * continued_fraction(B, a, one_minus_x) / B
    }
}

/// Gamma(a + 1/2) / Gamma(a) for a > 0: the recurrence up to where five terms of the asymptotic series are exact.
fn gamma_ratio(a: f64) -> f64 {
    const EXACT_FROM: usize = 16;
    let (mut a, mut ratio) = (a, 1.0);
    for _ in 0..EXACT_FROM {
        if a < EXACT_FROM as f64 {
            ratio *= a / (a + 0.5);
            a += 1.0;
        }
    }
    let square = 1.0 / (a * a);
    let mut series = 31.0 / 18432.0;
    for coefficient in [17.0 / 14336.0, 1.0 / 640.0, 1.0 / 192.0, 1.0 / 8.0] {
        series = coefficient - series * square;
    }
    ratio * sqrt(a) * exp(-series / a)
}

fn continued_fraction(a: f64, b: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let away_from_zero = |value: f64| if fabs(value) < TINY { TINY } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut value = d;
    for m in 1..MAX_TERMS {
        let m = m as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / away_from_zero(1.0 + even * d);
        c = away_from_zero(1.0 + even / c);
        value *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away_from_zero(1.0 + odd * d);
        c = away_from_zero(1.0 + odd / c);
        value *= d * c;
        if fabs(d * c - 1.0) < 1e-15 {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_tables() {
        // Abramowitz and Stegun, table 26.10, and Cauchy's closed form for one degree of freedom.
        for (degrees, confidence, t) in [
            (1.0, 0.95, 12.706),
            (2.0, 0.95, 4.303),
            (10.0, 0.99, 3.169),
            (30.0, 0.95, 2.042),
            (120.0, 0.9, 1.658),
        ] {
            assert!((quantile(confidence, degrees) - t).abs() < 5e-4, "{degrees} {confidence}");
        }
        let cauchy = 1.0 - 2.0 * libm::atan(3.0) / core::f64::consts::PI;
        assert!((two_sided_p(3.0, 1.0) - cauchy).abs() < 1e-14);
        assert!((two_sided_p(-3.0, 1.0) - cauchy).abs() < 1e-14);
    }

    #[test]
    fn as_forty_digits_have_them() {
        // The regularised incomplete beta function by mpmath with forty digits.
        for (degrees, t, p, tolerance) in [
            (1.0, 0.1, 0.936_548_965_138_892_9, 1e-14),
            (1.0, 1.5, 0.374_334_083_621_997_6, 1e-14),
            (1.0, 6.0, 0.105_136_913_422_506_9, 1e-14),
            (2.5, 0.1, 0.927_806_544_062_489_6, 1e-14),
            (2.5, 6.0, 0.015_281_729_885_522_9, 1e-14),
            (7.0, 0.1, 0.923_148_059_604_792_4, 1e-14),
            (7.0, 6.0, 5.422_583_420_028_101e-4, 1e-14),
            (100.0, 1.5, 0.136_765_058_124_688_9, 1e-12),
            (100.0, 6.0, 3.172_491_502_802_857e-8, 1e-12),
            (9994.0, 1.5, 0.133_645_990_776_185_6, 1e-12),
            (9994.0, 6.0, 2.041_660_169_652_388e-9, 1e-12),
            (1e6, 0.1, 0.920_344_345_492_043_2, 5e-10),
            (1e6, 1.5, 0.133_614_718_236_792_8, 5e-10),
            (1e6, 6.0, 1.973_849_812_354_435e-9, 5e-10),
        ] {
            let found = two_sided_p(t, degrees);
            assert!((found / p - 1.0).abs() < tolerance, "{degrees} {t}: {found} {p}");
        }
    }

    #[test]
    fn ratios_of_gammas() {
        for a in 1..400 {
            let a = 0.25 * f64::from(a);
            let expected = exp(libm::lgamma(a + 0.5) - libm::lgamma(a));
            // The logarithms lose digits as they grow.
            assert!((gamma_ratio(a) / expected - 1.0).abs() < 2e-13, "{a}");
        }
        assert!((gamma_ratio(0.5) * SQRT_PI - 1.0).abs() < 1e-15);
    }

    #[test]
    fn large_samples_join_the_normal_distribution() {
        for t in [0.1, 1.0, 2.0, 5.0, 20.0] {
            let (student, normal) = (two_sided_p(t, 1e9), libm::erfc(t / core::f64::consts::SQRT_2));
            // The tails part by the factor exp(t^4 / 4 degrees) to first order.
            let apart = 1e-6 + t.powi(4) / (2.0 * MOST_DEGREES);
            assert!((student / normal - 1.0).abs() < apart, "{t}: {student} {normal}");
            assert_eq!(student, two_sided_p(t, MOST_DEGREES));
        }
        assert!((quantile(0.95, 1e9) - 1.959_964).abs() < 1e-5);
    }

    #[test]
    fn edges() {
        assert_eq!(two_sided_p(0.0, 5.0), 1.0);
        assert_eq!(two_sided_p(f64::INFINITY, 5.0), 0.0);
        assert!(two_sided_p(f64::NAN, 5.0).is_nan());
        assert!(two_sided_p(1.0, 0.0).is_nan());
        assert!(quantile(1.0, 5.0).is_nan());
        assert!(quantile(0.5, f64::NAN).is_nan());
    }
}
