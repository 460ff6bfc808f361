//! The fixed-point curves of eqs. 25.

use super::Constraints;
use super::branch::{case, signs};
use crate::math::angle::sincos;
use libm::{atan, sqrt};

/// An argument of the square root this little below zero is a zero that rounding has moved.
const ROUNDING: f64 = 1e-15;

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// sigma1, and slants 2 and 3 that follow from it; these are not confined to [0, pi/2].
    pub slants: [f64; 3],
    /// f(sigma1), in [-pi, pi].
    pub f: f64,
}

/// One of the eight cases of eqs. 25 at sigma1: from slant 1 follows slant 2 (25a), from it slant 3 (25b), from it
/// slant 1 again (25c). Where f(sigma1) = sigma1 there is a solution of eqs. 24, of use if all its slants are slants.
///
/// The cases are those of [`SlantRoot::branch`](super::SlantRoot::branch).
///
/// # Units
/// Radians; `cosines` are (h12, h13, h23).
///
/// # Errors
/// `None` where a square root has a negative argument (the gaps in Figure 2), where eqs. 25 say 0/0, for a case not in
/// 1..=8, and for input that is not finite or has a cosine beyond 2.
///
/// # Reference
/// Eqs. 25a-25c, Figures 2, 4(a), 6(d).
#[must_use]
pub fn curve(branch: u8, sigma1: f64, tilts: [f64; 3], cosines: [f64; 3]) -> Option<CurvePoint> {
    let [sign12, sign23, sign31] = signs(branch).filter(|_| sigma1.is_finite())?;
    let Constraints { k: [k12, k13, k23], h: [h12, h13, h23] } = Constraints::new(tilts, cosines)?;
    let sigma2 = next_slant(sigma1, k12, h12, sign12)?;
    let sigma3 = next_slant(sigma2, k23, h23, sign23)?;
    let f = next_slant(sigma3, k13, h13, sign31)?;
    Some(CurvePoint { slants: [sigma1, sigma2, sigma3], f })
}

/// One of eqs. 25: the other channel's slant.
fn next_slant(slant: f64, k: f64, h: f64, sign: f64) -> Option<f64> {
    let (sin, cos) = sincos(slant);
    let b = k * sin;
    let argument = b * b + cos * cos - h * h;
    if argument < -ROUNDING {
        return None;
    }
    let root = sign * sqrt(argument.max(0.0));
    // The same quotient, multiplied by b - root above and below when b + root would cancel.
    let tangent = if b * root >= 0.0 { (b + root) / (cos + h) } else { (h - cos) / (b - root) };
    (!tangent.is_nan()).then(|| 2.0 * atan(tangent))
}

/// The case of eqs. 25 on whose curve these slants lie.
pub(super) fn branch_of([s1, s2, s3]: [f64; 3], constraints: &Constraints) -> u8 {
    let Constraints { k: [k12, k13, k23], h: [h12, h13, h23] } = *constraints;
    case([is_minus(s1, s2, k12, h12), is_minus(s2, s3, k23, h23), is_minus(s3, s1, k13, h13)])
}

/// Whether the square root enters with a minus: it is tan(to/2) (cos from + h) - k sin from.
fn is_minus(from: f64, to: f64, k: f64, h: f64) -> bool {
    // Where the square root is zero, rounding makes it as much as this.
    const NO_SIGN: f64 = 1e-8;
    let (sin, cos) = sincos(from);
    // tan(to/2), for slants.
    let (sin_to, cos_to) = sincos(to);
    sin_to / (1.0 + cos_to) * (cos + h) - k * sin < -NO_SIGN
}

#[cfg(test)]
mod tests {
    use super::super::{roots, tests::random_case};
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn solutions_lie_on_their_curve() {
        let mut rng = Rng::new(5);
        let mut seen = [0; 9];
        for _ in 0..300 {
            let (_, tilts, cosines) = random_case(&mut rng);
            for root in roots(tilts, cosines) {
                let [s1, s2, s3] = root.slants;
                let point = curve(root.branch, s1, tilts, cosines).unwrap();
                let [same, sigma2, sigma3] = point.slants;
                assert_eq!(same, s1);
                // Near a fold the curve is as steep as a square root, and so is the error.
                for (value, slant) in [(sigma2, s2), (sigma3, s3), (point.f, s1)] {
                    assert!((value - slant).abs() < 1e-5, "{root:?} {point:?}");
                }
                seen[usize::from(root.branch)] += 1;
            }
        }
        assert!(seen.iter().filter(|&&count| count > 0).count() >= 6, "{seen:?}");
    }

    #[test]
    fn nothing_where_there_is_nothing() {
        let (tilts, cosines) = ([0.0, 1.0, 2.0], [0.9, 0.8, 0.9]);
        assert!(curve(1, 0.2, tilts, cosines).is_some());
        assert_eq!(curve(0, 0.2, tilts, cosines), None);
        assert_eq!(curve(9, 0.2, tilts, cosines), None);
        assert_eq!(curve(1, 1.5, tilts, cosines), None);
        assert_eq!(curve(1, f64::NAN, tilts, cosines), None);
        assert_eq!(curve(1, f64::INFINITY, tilts, cosines), None);
        assert_eq!(curve(1, 0.2, [f64::NAN, 0.0, 0.0], cosines), None);
        assert_eq!(curve(1, 0.2, tilts, [0.9, f64::INFINITY, 0.7]), None);
    }
}
