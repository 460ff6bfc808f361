//! The coupled depth/slope model against an independent solution.

use ofc_core::math::rng::Rng;
use ofc_core::surface::depth::{DepthParams, Method, Plane};
use ofc_tests::depth_oracle as oracle;
use ofc_tests::depth_scenes::{bumps, distance, messy, precise, rms, run, scene};

/// Distance from the oracle as a part of the depth's RMS at a tolerance of 1e-6: the condition of these small systems
/// makes some hundred times the residual of it at worst.
const NEAR_ORACLE: f64 = 1e-4;

#[test]
fn coupled_slopes_span_gaps() {
    let scene = scene([96, 80], bumps, 0.0, messy(96));
    // No slope in a square in the middle of the upper half, and at a tenth of the pixels.
    let mut rng = Rng::new(1);
    let weights: Vec<f32> = (0..96 * 80)
        .map(|i| {
            let (x, y) = (i % 96, i / 96);
            let gap = (50..62).contains(&x) && (20..32).contains(&y);
            if gap || rng.below(10) == 0 { 0.0 } else { 0.5 + rng.unit() as f32 }
        })
        .collect();
    let mut input = scene.input();
    input.weights = Some(Plane::new(&weights, 96, 80, 1, 96).unwrap());
    let params = DepthParams { method: Method::Coupled, ..precise() };
    let (depth, result) = run(&input, &params).unwrap();
    assert!(result.converged && result.excluded > 400, "{result:?}");
    let mut field = scene.field();
    for (weight, &w) in field.weight.iter_mut().zip(&weights) {
        *weight *= f64::from(w);
    }
    let domain: Vec<bool> = scene.mask.iter().map(|&m| m != 0).collect();
    let exact = oracle::coupled(&field, &domain, params.smoothness);
    assert!(distance(&depth, &exact) < NEAR_ORACLE * rms(&exact), "{}", distance(&depth, &exact));
    // The gap is closed, with depth nearer to the truth than the paper's flat patch gives.
    let truth = scene.truth();
    let (flat, _) = run(&input, &DepthParams { method: Method::Paper, ..precise() }).unwrap();
    assert!(3.0 * distance(&depth, &truth) < distance(&flat, &truth));
}
