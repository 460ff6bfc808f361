//! The core's solutions of eqs. 24 against elimination to a quartic, on thousands of random configurations.

use ofc_core::light::constrained_slant::{Candidates, roots};
use ofc_core::math::rng::Rng;
use ofc_tests::slant_oracle::{self, determinant, distance, jacobian, residuals};
use std::f64::consts::{FRAC_PI_2, PI};

/// Where |det| of the derivatives at a solution is below this, two solutions are so close to becoming one that either
/// method may see one, two or (beyond the last digit) none: the solution need not be in both. A determinant d means that
/// the partner is about d away, and that a change of about d^2 = 1e-10 in a cosine makes both vanish.
const NEARLY_DOUBLE: f64 = 1e-5;
/// Solutions elsewhere agree to this: rounding in eqs. 24, 1e-16, over the smallest determinant, with room.
const AGREEMENT: f64 = 1e-8;
/// A solution this close to the ends of [0, pi/2] may be inside for one method and outside for the other.
const AT_THE_END: f64 = 1e-7;

#[derive(Debug)]
struct Case {
    tilts: [f64; 3],
    cosines: [f64; 3],
    truth: Option<[f64; 3]>,
}

fn direction(slant: f64, tilt: f64) -> [f64; 3] {
    [slant.sin() * tilt.cos(), slant.sin() * tilt.sin(), slant.cos()]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// True slants and tilts; a third of the cosines perturbed, a third with tilts nearly equal, opposite or perpendicular
/// or slants nearly 0 or 90 degrees.
fn case(rng: &mut Rng, n: u32) -> Case {
    let mut between = |low: f64, high: f64| low + (high - low) * rng.unit();
    let mut slants = [0; 3].map(|_| between(0.0, FRAC_PI_2));
    let mut tilts = [0; 3].map(|_| between(-PI, PI));
    let perturbed = n % 3 == 1;
    if n % 3 == 2 {
        let nearly = 10.0_f64.powf(between(-6.0, -1.0));
        tilts[1] = tilts[0] + FRAC_PI_2 * between(0.0, 4.0).floor() + nearly;
        if n.is_multiple_of(2) {
            slants[2] = if n.is_multiple_of(4) { nearly } else { FRAC_PI_2 - nearly };
        }
    }
    let e = [0, 1, 2].map(|i| direction(slants[i], tilts[i]));
    let mut cosines = [dot(e[0], e[1]), dot(e[0], e[2]), dot(e[1], e[2])];
    if perturbed {
        let size = 10.0_f64.powf(between(-4.0, -0.5));
        cosines = cosines.map(|h| (h + size * between(-1.0, 1.0)).clamp(-1.0, 1.0));
    }
    Case { tilts, cosines, truth: (!perturbed).then_some(slants) }
}

impl Case {
    fn k(&self) -> [f64; 3] {
        let [t1, t2, t3] = self.tilts;
        [(t1 - t2).cos(), (t1 - t3).cos(), (t2 - t3).cos()]
    }

    /// Whether both methods must have this solution.
    fn is_clear(&self, slants: [f64; 3]) -> bool {
        let at_the_end = |s: f64| !(AT_THE_END..=FRAC_PI_2 - AT_THE_END).contains(&s);
        determinant(jacobian(self.k(), slants)).abs() > NEARLY_DOUBLE && !slants.into_iter().any(at_the_end)
    }
}

/// How many of `wanted` must be in `got`, and the first that is not.
fn compare(case: &Case, wanted: &[[f64; 3]], got: &[[f64; 3]]) -> (usize, Option<[f64; 3]>) {
    let clear = || wanted.iter().filter(|slants| case.is_clear(**slants));
    let missing = clear().find(|slants| got.iter().all(|other| distance(**slants, *other) > AGREEMENT));
    (clear().count(), missing.copied())
}

fn slants(found: &Candidates) -> Vec<[f64; 3]> {
    found.iter().map(|root| root.slants).collect()
}

#[test]
fn no_root_is_missed_and_none_invented() {
    let mut rng = Rng::new(2024);
    let (mut all, mut compared, mut noticed) = (0, 0, 0);
    let mut counts = [0; 9];
    for n in 0..12_000 {
        let case = case(&mut rng, n);
        let found = roots(case.tilts, case.cosines);
        let core = slants(&found);
        let oracle = slant_oracle::roots(case.tilts, case.cosines);
        for root in &found {
            let largest =
                residuals(case.k(), case.cosines, root.slants).iter().fold(0.0, |m: f64, r| m.max(r.abs()));
            assert!(largest < 1e-9 && (largest - root.residual).abs() < 1e-14, "{case:?} {root:?}");
            assert!(root.slants.iter().all(|s| (0.0..=FRAC_PI_2).contains(s)));
        }
        let (missed_of, missed) = compare(&case, &oracle, &core);
        assert_eq!(missed, None, "case {n} {case:?}: missed; core {core:?}, oracle {oracle:?}");
        let (invented_of, invented) = compare(&case, &core, &oracle);
        assert_eq!(invented, None, "case {n} {case:?}: invented; core {core:?}, oracle {oracle:?}");
        assert_eq!(missed_of, invented_of, "case {n} {case:?}: core {core:?}, oracle {oracle:?}");
        if let Some(truth) = case.truth {
            let (_, missed) = compare(&case, &[truth], &core);
            assert_eq!(missed, None, "case {n} {case:?}: the truth is missed; core {core:?}");
        }
        counts[found.len()] += 1;
        all += found.len();
        compared += invented_of;
        // The negative control: any clear root taken away is noticed.
        for (i, root) in core.iter().enumerate() {
            let mut fewer = core.clone();
            fewer.remove(i);
            noticed += usize::from(case.is_clear(*root) && compare(&case, &oracle, &fewer).1.is_some());
        }
    }
    println!("{all} roots, {compared} of them compared; cases by number of roots {counts:?}");
    assert_eq!(noticed, compared);
    assert!(compared * 100 > all * 95, "{compared} of {all} roots were clear");
    // Isolated solutions are at most four, and every number up to four has occurred.
    assert!(counts[..5].iter().all(|&count| count > 0), "{counts:?}");
    assert_eq!(counts[5..], [0; 4]);
}

#[test]
fn the_oracle_knows_figure_2() {
    let (tilts, slants) = ([20.0, -120.0, 0.0].map(f64::to_radians), [40.0, 30.0, 5.0].map(f64::to_radians));
    let e = [0, 1, 2].map(|i| direction(slants[i], tilts[i]));
    let found = slant_oracle::roots(tilts, [dot(e[0], e[1]), dot(e[0], e[2]), dot(e[1], e[2])]);
    assert_eq!(found.len(), 2);
    assert!(found.iter().any(|root| distance(*root, slants) < 1e-9));
    assert!(found.iter().any(|root| distance(root.map(f64::to_degrees), [64.63, 0.93, 32.29]) < 0.005));
}
