//! The coupled depth/slope model against an independent solution.

use ofc_core::math::rng::Rng;
use ofc_core::surface::depth::{DepthInput, DepthParams, DepthResult, Method, Plane};
use ofc_tests::depth_oracle::{self as oracle, Field};
use ofc_tests::depth_scenes::{Scene, all, bumps, disc, distance, messy, precise, rms, run, scene};

/// Weight of the misfit between depth and slopes in units of the smoothness, as documented.
const MISFIT: f64 = 10.0;

/// The default.
const SMOOTHNESS: f64 = 0.1;

/// Distance from the oracle as a part of the depth's RMS at a tolerance of 1e-6: the rounding of depths that are hundreds of
/// times as large as what a pixel adds to them.
const NEAR_ORACLE: f64 = 1e-4;

fn coupled(params: DepthParams) -> DepthParams {
    DepthParams { method: Method::Coupled, ..params }
}

/// A scene with weights.
struct Weighted {
    scene: Scene,
    weights: Vec<f32>,
}

impl Weighted {
    fn new(scene: Scene, weight: impl Fn(usize, usize, f64) -> f32) -> Self {
        let mut rng = Rng::new(1);
        let weights =
            (0..scene.mask.len()).map(|i| weight(i % scene.width, i / scene.width, rng.unit())).collect();
        Self { scene, weights }
    }

    fn input(&self) -> DepthInput<'_> {
        let (w, h) = (self.scene.width, self.scene.height);
        DepthInput { weights: Some(Plane::new(&self.weights, w, h, 1, w).unwrap()), ..self.scene.input() }
    }

    fn field(&self) -> Field {
        let mut field = self.scene.field();
        for (weight, &w) in field.weight.iter_mut().zip(&self.weights) {
            *weight *= f64::from(w);
        }
        field
    }

    fn domain(&self) -> Vec<bool> {
        self.scene.mask.iter().map(|&m| m != 0).collect()
    }
}

fn square_gap(size: usize, gap: usize) -> impl Fn(usize, usize, f64) -> f32 {
    let (from, to) = ((size - gap) / 2, (size - gap) / 2 + gap);
    move |x, y, _| if (from..to).contains(&x) && (from..to).contains(&y) { 0.0 } else { 1.0 }
}

/// A gap, pixels missing at random, and weights of all kinds.
fn mixed(x: usize, y: usize, random: f64) -> f32 {
    let gap = (50..62).contains(&x) && (20..32).contains(&y);
    if gap || random < 0.1 { 0.0 } else { 0.5 + random as f32 }
}

/// Depth and the minimum of the energy.
fn both(case: &Weighted, params: DepthParams, prior: Option<&[f32]>) -> (Vec<f32>, DepthResult, Vec<f64>) {
    let params = coupled(params);
    let mut input = case.input();
    let (w, h) = (case.scene.width, case.scene.height);
    input.prior = prior.map(|prior| Plane::new(prior, w, h, 1, w).unwrap());
    let (depth, result) = run(&input, &params).unwrap();
    let prior: Option<Vec<f64>> = prior.map(|prior| prior.iter().map(|&z| f64::from(z)).collect());
    let prior = prior.as_deref().map(|prior| (prior, params.prior_weight));
    let misfit = MISFIT * params.smoothness;
    (depth, result, oracle::coupled(&case.field(), &case.domain(), params.smoothness, misfit, prior))
}

fn check(case: &Weighted, params: DepthParams, prior: Option<&[f32]>) {
    let (depth, result, exact) = both(case, params, prior);
    assert!(result.converged, "{params:?} {result:?}");
    let error = distance(&depth, &exact);
    // A surface without depth has its slopes for a scale.
    assert!(error <= NEAR_ORACLE * rms(&exact) + 1e-6, "{params:?} {result:?} {error}");
}

fn apart(case: &Weighted) -> Vec<f32> {
    oracle::uncoupled(&case.field(), &case.domain(), SMOOTHNESS).iter().map(|&z| z as f32).collect()
}

#[test]
fn depth_is_the_minimum_of_the_energy() {
    let cases = [
        Weighted::new(scene([72, 60], bumps, 0.0, messy(72)), mixed),
        Weighted::new(scene([72, 60], bumps, 0.1, messy(72)), mixed),
        Weighted::new(scene([64, 64], bumps, 0.0, disc(64)), square_gap(64, 25)),
        // Lines one pixel wide.
        Weighted::new(scene([60, 60], bumps, 0.0, |x, y| x % 20 == 3 || y % 20 == 7), mixed),
        // Weights over all their range.
        Weighted::new(scene([36, 30], bumps, 0.0, disc(36)), |x, y, random| {
            if x % 20 > 12 && y > 20 { 0.0 } else { 10.0_f32.powf(8.0 * random as f32 - 4.0) }
        }),
    ];
    for case in &cases {
        for smoothness in [SMOOTHNESS, 10.0] {
            check(case, DepthParams { smoothness, ..precise() }, None);
        }
    }
    check(&cases[0], DepthParams { smoothness: 1e-3, ..precise() }, None);
    check(&cases[0], DepthParams { smoothness: 100.0, ..precise() }, None);
    // The control: smoothing p and q apart is not it.
    let (_, _, exact) = both(&cases[0], precise(), None);
    assert!(distance(&apart(&cases[0]), &exact) > 10.0 * NEAR_ORACLE * rms(&exact));
}

#[test]
fn one_row_one_column_and_little_more() {
    for size in [[1, 2], [2, 1], [100, 1], [1, 100], [2, 2], [3, 3], [90, 2]] {
        let gap = |x: usize, y: usize, _: f64| if (30..60).contains(&(x + y)) { 0.0 } else { 1.0 };
        check(&Weighted::new(scene(size, bumps, 0.0, all), gap), precise(), None);
    }
}

#[test]
fn a_prior_pulls_at_slopes_too() {
    let case = Weighted::new(scene([72, 60], bumps, 0.0, messy(72)), mixed);
    let truth = case.scene.truth.iter().enumerate();
    // It contradicts itself by some pixels, so that its weight matters.
    let prior: Vec<f32> = truth
        .map(|(i, &z)| if i % 37 == 5 { (100.0 + z + (i % 5) as f64) as f32 } else { f32::NAN })
        .collect();
    for prior_weight in [1e-3, 1.0] {
        check(&case, DepthParams { prior_weight, ..precise() }, Some(&prior));
    }
    // In the unit of the pitch.
    let scaled: Vec<f32> = prior.iter().map(|z| 0.25 * z).collect();
    let (plain, ..) = both(&case, precise(), Some(&prior));
    let mut input = case.input();
    input.prior = Some(Plane::new(&scaled, 72, 60, 1, 72).unwrap());
    let (quarter, _) = run(&input, &coupled(DepthParams { pixel_pitch: 0.25, ..precise() })).unwrap();
    let plain: Vec<f64> = plain.iter().map(|&z| 0.25 * f64::from(z)).collect();
    assert!(distance(&quarter, &plain) < NEAR_ORACLE * rms(&plain));
}

#[test]
fn gaps_are_closed_better_than_by_smoothing_apart() {
    // Factors a little below those of a prototype in another language (4.7 and 22).
    let cases = [
        (Weighted::new(scene([96, 80], bumps, 0.0, messy(96)), mixed), 4.0),
        (Weighted::new(scene([96, 96], bumps, 0.0, disc(96)), square_gap(96, 30)), 15.0),
    ];
    for (case, factor) in cases {
        let (depth, result) = run(&case.input(), &coupled(DepthParams::default())).unwrap();
        assert!(result.converged && result.excluded > 400, "{result:?}");
        let truth = case.scene.truth();
        let (error, other) = (distance(&depth, &truth), distance(&apart(&case), &truth));
        assert!(factor * error < other, "{error} {other}");
        let (flat, _) = run(&case.input(), &DepthParams { method: Method::Paper, ..precise() }).unwrap();
        assert!(factor * error < distance(&flat, &truth));
    }
}

#[test]
fn converged_means_that_depth_moves_no_more() {
    // The tolerance's part of the depth, twice: the rest is that of the last step, from slopes to depth.
    for gap in [0, 12, 40] {
        let case = Weighted::new(scene([80, 80], bumps, 0.0, disc(80)), square_gap(80, gap));
        let (depth, result, exact) = both(&case, DepthParams::default(), None);
        let most = 2.0 * DepthParams::default().tolerance;
        assert!(result.converged && result.cycles <= 40, "{result:?}");
        assert!(distance(&depth, &exact) < most * rms(&exact), "{gap} {}", distance(&depth, &exact));
        let (depth, result, _) = both(&case, DepthParams { max_cycles: 4, ..DepthParams::default() }, None);
        assert!(!result.converged, "{result:?}");
        // The control: so much does matter where there is a gap.
        assert!(gap == 0 || distance(&depth, &exact) > most * rms(&exact));
    }
    // Corridors narrower than the period of their walls: the coarse grids are of little use, and it says so.
    let comb = Weighted::new(scene([40, 40], bumps, 0.0, |x, y| x % 3 != 1 || y == 0), mixed);
    let (depth, result, exact) = both(&comb, DepthParams { max_cycles: 100, ..DepthParams::default() }, None);
    assert!(!result.converged && distance(&depth, &exact) > 1e-3 * rms(&exact), "{result:?}");
}
