//! Every solution of eqs. 24, by branch and bound over boxes of slants.
//!
//! Eqs. 25 walk from channel to channel and meet folds, gaps and 0/0 on the way; the three equations themselves have
//! none of these. Their second derivatives are at most 1, so around the middle m of a box of half-widths r
//!
//! ```text
//! f_ij(s) = f_ij(m) + f_ij'(m) (s - m) + rest,   |rest| <= (r_i + r_j)^2 / 2,
//! ```
//!
//! which says of most boxes that they hold no solution, and multiplied by the inverse of the derivatives it says where
//! in the box one can be. Near a simple root that is Newton's method with a proof and boxes shrink quadratically;
//! elsewhere a box is halved. A pair of roots cannot be stepped over: nothing is discarded without a bound.
//!
//! # Reference
//! R. E. Moore, R. B. Kearfott, M. J. Cloud, "Introduction to Interval Analysis", SIAM 2009, chapter 8.

use super::cell::{OVERHANG, ZERO};
use super::curve::branch_of;
use super::descent::descend;
use super::subdivision::{MAX_BOXES, Subdivision};
use super::work_list::{WORKSPACE_LEN, WorkList};
use super::{Candidates, Constraints, SlantRoot, clamp, difference, max_abs};
use crate::math::mat3;

/// How far boxes are divided, and which solutions count as one, radians.
struct Resolution {
    /// Half-width of a box that is not divided further.
    leaf: f64,
    /// Solutions closer than this are the same.
    same: f64,
    /// Leaves after which it is clear that solutions are not isolated.
    max_leaves: usize,
}

/// At a double root, residuals in a leaf are below [`ZERO`].
const FINE: Resolution = Resolution { leaf: 5e-7, same: 1e-7, max_leaves: 1000 };
/// For solutions that are not isolated, where small boxes are too many: a few members of the family will do.
const COARSE: Resolution = Resolution { leaf: 0.02, same: 0.2, max_leaves: MAX_BOXES };
/// Newton steps from a leaf.
const MAX_STEPS: usize = 12;
/// Singular values below this share of the largest are not inverted.
const SINGULAR: f64 = 1e-9;

/// Every solution of eqs. 24 with all slants in [0, pi/2], ascending by the first slant; empty when there is none.
///
/// A double root, where two solutions are about to vanish, is one solution. When solutions are not isolated (the three
/// tilts equal or opposite and the lights in one plane, for instance, or one light level and perpendicular to both
/// others), a straight family of them is reported by one member, a curved one by several. Lights so nearly in one
/// plane that solutions are isolated only on paper count as such a family (none of 200,000 random cases), and one of
/// several may be left out.
///
/// # Units
/// Radians; `cosines` are (h12, h13, h23), the angles' between the rows of F.
///
/// # Errors
/// Empty for input that is not finite or has a cosine beyond 2.
///
/// # Scratch
/// About 6 kB of stack.
///
/// # Reference
/// Eqs. 24-25; the method is described at the top of the module.
#[must_use]
pub fn roots(tilts: [f64; 3], cosines: [f64; 3]) -> Candidates {
    let mut found = Candidates::new();
    roots_within(tilts, cosines, &mut [0.0; WORKSPACE_LEN], &mut found);
    found
}

/// [`roots`] with less than 3 kB of stack, into `found`; false, with nothing done, where `workspace` is too short.
///
/// # Scratch
/// [`WORKSPACE_LEN`] `f64`; what they hold before does not matter.
pub fn roots_within(
    tilts: [f64; 3],
    cosines: [f64; 3],
    workspace: &mut [f64],
    found: &mut Candidates,
) -> bool {
    let Some(mut work_list) = WorkList::new(workspace) else { return false };
    found.clear();
    if let Some(constraints) = Constraints::new(tilts, cosines) {
        let complete = search(&constraints, &FINE, &mut work_list, found);
        if !complete {
            found.clear();
            search(&constraints, &COARSE, &mut work_list, found);
        }
    }
    sort(found);
    true
}

/// Collects the solutions; false when the boxes or the leaves were too many.
fn search(
    constraints: &Constraints,
    resolution: &Resolution,
    work_list: &mut WorkList,
    found: &mut Candidates,
) -> bool {
    let mut boxes = Subdivision::new(constraints, resolution.leaf, work_list);
    let mut leaves = 0;
    while let Some(middle) = boxes.next_leaf() {
        leaves += 1;
        if leaves > resolution.max_leaves {
            return false;
        }
        if let Some(root) = polish(constraints, middle) {
            insert(constraints, root, resolution.same, found);
        }
    }
    boxes.is_complete()
}

/// The solution that Newton's method reaches, if it is one.
fn polish(constraints: &Constraints, start: [f64; 3]) -> Option<SlantRoot> {
    let (best, best_residual) = newton(constraints, start);
    let inside = clamp(best);
    let valid = |slants: [f64; 3], limit: f64| {
        let residual = constraints.residual(slants);
        let root = SlantRoot { slants, branch: branch_of(slants, constraints), residual };
        (residual <= limit).then_some(root)
    };
    if best_residual <= ZERO && max_abs(difference(best, inside)) <= OVERHANG {
        return valid(inside, OVERHANG);
    }
    // Newton's method went astray from a coarse leaf, or outside along singular derivatives.
    valid(descend(constraints, clamp(start)), ZERO)
}

/// Where Newton's method ends, and its residual. The steps are the shortest that solve the linear equations, so singular
/// derivatives are no obstacle.
#[inline(never)]
fn newton(constraints: &Constraints, start: [f64; 3]) -> ([f64; 3], f64) {
    let (mut best, mut best_residual) = (start, f64::INFINITY);
    let mut slants = start;
    for _ in 0..MAX_STEPS {
        let (f, jacobian) = constraints.evaluate(slants);
        let residual = max_abs(f);
        if residual >= best_residual {
            break;
        }
        (best, best_residual) = (slants, residual);
        let (inverse, _) = mat3::pseudo_inverse(&mat3::svd(&jacobian), SINGULAR);
        let [d1, d2, d3] = mat3::apply(&inverse, f);
        let [s1, s2, s3] = slants;
        slants = [s1 - d1, s2 - d2, s3 - d3];
    }
    (best, best_residual)
}

/// Adds a root, or lets it stand for one that is the same. When there is no room it is dropped: that many roots are
/// never isolated.
fn insert(constraints: &Constraints, root: SlantRoot, same: f64, found: &mut Candidates) {
    let known = found.iter_mut().find(|known| is_same(constraints, known.slants, root.slants, same));
    match known {
        Some(known) if root.residual < known.residual => *known = root,
        Some(_) => {}
        None => {
            let _ = found.push(root);
        }
    }
}

/// Whether two solutions are close, or everything between them is a solution too: then they are one double root, or
/// members of one family.
fn is_same(constraints: &Constraints, a: [f64; 3], b: [f64; 3], same: f64) -> bool {
    let [d1, d2, d3] = difference(b, a);
    let [a1, a2, a3] = a;
    let between = |share: f64| constraints.residual([a1 + share * d1, a2 + share * d2, a3 + share * d3]);
    max_abs([d1, d2, d3]) <= same || [0.25, 0.5, 0.75].into_iter().all(|share| between(share) <= ZERO)
}

/// Ascending by the first slant.
fn sort(found: &mut Candidates) {
    for end in 2..=found.len() {
        for last in (2..=end).rev() {
            if let Some([.., before, after]) = found.get_mut(..last)
                && after.slants < before.slants
            {
                core::mem::swap(before, after);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{cosines_of, random_case};
    use super::super::{curve, roots, sum};
    use super::*;
    use crate::math::rng::Rng;

    fn degrees(angles: [f64; 3]) -> [f64; 3] {
        angles.map(f64::to_degrees)
    }

    fn radians(angles: [f64; 3]) -> [f64; 3] {
        angles.map(f64::to_radians)
    }

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        max_abs(difference(a, b))
    }

    fn contains(found: &Candidates, slants: [f64; 3], tolerance: f64) -> bool {
        found.iter().any(|root| distance(root.slants, slants) <= tolerance)
    }

    #[test]
    fn figures_1_and_2() {
        let tilts = radians([20.0, -120.0, 0.0]);
        let cosines = cosines_of(radians([40.0, 30.0, 5.0]), tilts);
        let angles = degrees(cosines.map(libm::acos));
        assert!(distance(angles, [65.3, 35.3, 32.8]) < 0.05, "{angles:?}");
        let found = roots(tilts, cosines);
        assert_eq!(found.len(), 2);
        assert!(distance(degrees(found[0].slants), [40.0, 30.0, 5.0]) < 1e-9);
        assert!(distance(degrees(found[1].slants), [64.63, 0.93, 32.29]) < 0.005);
        for root in found {
            assert!(root.residual < 1e-14);
            let value = curve(root.branch, root.slants[0], tilts, cosines).unwrap();
            assert!((value.f - root.slants[0]).abs() < 1e-12);
        }
    }

    #[test]
    fn table_1_with_pentlands_tilts() {
        let b = [[59.0, 13.0, 55.0], [7.0, 51.0, 49.0], [32.0, 43.0, 40.0]];
        let a = [(60.0, 20.0), (40.0, 160.0), (50.0, -110.0)].map(|(slant, tilt): (f64, f64)| {
            let ((s, c), (st, ct)) = (libm::sincos(slant.to_radians()), libm::sincos(tilt.to_radians()));
            [s * ct, s * st, c]
        });
        let f = mat3::multiply(&b, &a).map(|row| mat3::scale(row, 1.0 / libm::sqrt(mat3::dot(row, row))));
        let cosines = [mat3::dot(f[0], f[1]), mat3::dot(f[0], f[2]), mat3::dot(f[1], f[2])];
        let found = roots(radians([-30.0, -154.60, -141.01]), cosines);
        assert!(found.iter().any(|root| distance(degrees(root.slants), [24.03, 26.75, 6.80]) < 0.005));
        // The other crossing in Figure 4(a) has negative slants.
        assert_eq!(found.len(), 1);
    }

    #[test]
    fn the_truth_is_always_among_them_and_they_are_at_most_four() {
        let mut rng = Rng::new(8);
        let mut counts = [0; 9];
        for _ in 0..2000 {
            let (slants, tilts, cosines) = random_case(&mut rng);
            let found = roots(tilts, cosines);
            assert!(contains(&found, slants, 1e-6), "{slants:?} {tilts:?} {found:?}");
            assert!(found.iter().all(|root| root.residual <= 1e-9));
            assert!(found.windows(2).all(|pair| pair[0].slants[0] <= pair[1].slants[0]));
            counts[found.len()] += 1;
        }
        assert_eq!(counts[5..], [0; 4]);
        assert!(counts[1] > 0 && counts[2] > 0, "{counts:?}");
    }

    /// Tilts that make k 0, 1 or -1 and slants at both ends of the range, in every combination.
    #[test]
    fn the_truth_is_among_them_in_degenerate_cases() {
        let (tilts, slants) = ([0.0, 90.0, 180.0, -90.0, 50.0], [0.0, 90.0, 30.0]);
        for n in 0..3375 {
            let pick = |list: &[f64], unit: usize| list[(n / unit) % list.len()].to_radians();
            let tilts = [pick(&tilts, 1), pick(&tilts, 5), pick(&tilts, 25)];
            let slants = [pick(&slants, 125), pick(&slants, 375), pick(&slants, 1125)];
            let cosines = cosines_of(slants, tilts);
            let found = roots(tilts, cosines);
            let constraints = Constraints::new(tilts, cosines).unwrap();
            // A straight family is reported by one member: then all between it and the truth is a solution. A curved
            // one, which takes lights in one plane, is reported by some members.
            let [h12, h13, h23] = cosines;
            let volume = mat3::dot([1.0, h12, h13], mat3::cross([h12, 1.0, h23], [h13, h23, 1.0]));
            let tolerance = if volume < 1e-9 { 0.3 } else { 2e-6 };
            let between = |root: &SlantRoot, share: f64| {
                let [d1, d2, d3] = difference(slants, root.slants).map(|d| d * share);
                constraints.residual(sum(root.slants, [d1, d2, d3]))
            };
            let known = found.iter().any(|root| {
                distance(root.slants, slants) < tolerance
                    || [0.25, 0.5, 0.75].iter().all(|&share| between(root, share) < 1e-9)
            });
            assert!(known, "tilts {:?} slants {:?}: {found:?}", degrees(tilts), degrees(slants));
        }
    }

    #[test]
    fn a_double_root_is_found_once_and_vanishes() {
        // Equal tilts: with s1 = s2 + 1 and s3 on the mirror line, s1 is as large as it can be for these angles.
        let tilts = [0.0, 0.0, core::f64::consts::FRAC_PI_2];
        // cos s1 cos s3 = h13 and cos s2 cos s3 = h23 with s1 - s2 = 0.5 and s3 = 0 (where d cos s3 = 0).
        let cosines = cosines_of([0.9, 0.4, 0.0], tilts);
        assert!(contains(&roots(tilts, cosines), [0.9, 0.4, 0.0], 2e-6));
        assert!(roots(tilts, cosines).len() <= 2);
        let [h12, h13, h23] = cosines;
        assert!(roots(tilts, [h12, h13 * (1.0 + 1e-8), h23 * (1.0 + 1e-8)]).is_empty());
        assert!(!roots(tilts, [h12, h13 * (1.0 - 1e-8), h23 * (1.0 - 1e-8)]).is_empty());
    }

    #[test]
    fn nothing_for_impossible_angles_or_no_numbers() {
        assert!(roots([0.0, 1.0, 2.0], [-0.99, 0.99, 0.99]).is_empty());
        assert!(roots([0.0, 1.0, 2.0], [1.1, 0.9, 0.9]).is_empty());
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
            assert!(roots([0.0, 1.0, 2.0], [0.5, bad, 0.5]).is_empty());
        }
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(roots([0.0, bad, 2.0], [0.5; 3]).is_empty());
        }
        assert!(roots([f64::MAX, f64::MIN, 2.0], [0.5; 3]).is_empty());
    }

    #[test]
    fn boxes_are_few_and_a_family_ends() {
        let mut rng = Rng::new(9);
        for _ in 0..500 {
            let (_, tilts, cosines) = random_case(&mut rng);
            let constraints = Constraints::new(tilts, cosines).unwrap();
            let mut workspace = [f64::NAN; WORKSPACE_LEN];
            let mut work_list = WorkList::new(&mut workspace).unwrap();
            assert!(search(&constraints, &FINE, &mut work_list, &mut Candidates::new()));
        }
        // Three equal lights: any common slant will do.
        let found = roots([1.0; 3], [1.0; 3]);
        assert!(!found.is_empty() && found.iter().all(|root| root.residual <= ZERO));
        // One light level and perpendicular to the others, which turn around it.
        let found = roots(radians([0.0, 90.0, 90.0]), [0.0, 0.0, 0.8]);
        assert!(!found.is_empty() && found.iter().all(|root| root.residual <= ZERO));
        // Two parallel lights: a curve.
        let found = roots(radians([0.0, 0.0, 50.0]), [1.0, 0.8, 0.8]);
        assert!(!found.is_empty() && found.iter().all(|root| root.residual <= ZERO));
    }
}
