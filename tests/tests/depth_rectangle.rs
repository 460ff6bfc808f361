//! Whole rectangles, which are solved directly: against an independent solution, against multigrid, and what the
//! documentation promises about them.

use ofc_core::math::rng::Rng;
use ofc_core::surface::depth::{DepthInput, DepthParams, DepthResult, Method, Plane, Slopes, integrate};
use ofc_tests::depth_oracle::{self as oracle, Field};
use ofc_tests::depth_workspace::Workspace;

/// Distance from the oracle as a part of the depth's RMS: rounding, which long thin rectangles let grow most.
const NEAR_ORACLE: f64 = 1e-5;

/// Distance from multigrid at a tolerance of 1e-6 as a part of the depth's RMS.
const NEAR_MULTIGRID: f64 = 1e-4;

/// Heights and widths that have small prime factors, or one of them, and every radix: 4, 2, 3, 5 and 7.
const DIRECT: [[usize; 2]; 22] = [
    [1, 1],
    [1, 9],
    [9, 1],
    [1, 200],
    [200, 1],
    [11, 1],
    [1, 11],
    [2, 2],
    [3, 2],
    [16, 16],
    [17, 15],
    [15, 17],
    [5, 7],
    [48, 36],
    [36, 48],
    [64, 49],
    [49, 22],
    [22, 49],
    [1000, 30],
    [30, 1000],
    [33, 128],
    [100, 105],
];

/// Neither side does.
const NOT_DIRECT: [[usize; 2]; 3] = [[11, 13], [22, 34], [57, 44]];

/// Noisy slopes of a wavy surface.
struct Scene {
    size: [usize; 2],
    p: Vec<f32>,
    q: Vec<f32>,
}

impl Scene {
    fn new(size: [usize; 2]) -> Self {
        let [width, height] = size;
        let mut rng = Rng::new(5);
        let mut noise = || 0.1 * (rng.unit() - 0.5);
        let (mut p, mut q) = (vec![], vec![]);
        for i in 0..width * height {
            let (x, y) = ((i % width) as f64, (i / width) as f64);
            p.push((0.3 * (0.02 * x).cos() * (0.05 * y).sin() + 0.2 + noise()) as f32);
            q.push((0.4 * (0.03 * x).sin() - 0.001 * y + noise()) as f32);
        }
        Self { size, p, q }
    }

    fn input(&self) -> DepthInput<'_> {
        let [width, height] = self.size;
        let plane = |data| Plane::new(data, width, height, 1, width).unwrap();
        let slopes = Slopes::Gradients { p: plane(&self.p), q: plane(&self.q) };
        DepthInput { slopes, mask: None, weights: None, prior: None }
    }

    fn oracle(&self) -> Vec<f64> {
        let [width, height] = self.size;
        let slope = |values: &[f32]| values.iter().map(|&v| f64::from(v)).collect();
        let weight = vec![1.0; width * height];
        oracle::poisson(&Field { width, height, p: slope(&self.p), q: slope(&self.q), weight }, None)
    }
}

fn run(input: &DepthInput, params: &DepthParams, dirt: f32) -> (Vec<f32>, DepthResult) {
    let [width, height] = input.size();
    let mut workspace = Workspace::new(width, height, dirt);
    let mut depth = vec![9.0; width * height];
    let result = integrate(input, params, workspace.arena(), &mut depth, width).unwrap();
    (depth, result)
}

fn rms(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    f64::sqrt(values.map(|v| v * v).sum::<f64>() / n)
}

fn distance(a: &[f32], b: &[f64]) -> f64 {
    rms(a.iter().zip(b).map(|(&a, &b)| f64::from(a) - b))
}

/// Multigrid solves with any weight that is not one.
fn by_multigrid(scene: &Scene) -> (Vec<f32>, DepthResult) {
    let [width, height] = scene.size;
    let weights = vec![0.25; width * height];
    let weights = Some(Plane::new(&weights, width, height, 1, width).unwrap());
    let input = DepthInput { weights, ..scene.input() };
    run(&input, &DepthParams { tolerance: 1e-6, ..DepthParams::default() }, f32::NAN)
}

#[test]
fn direct_solutions_against_the_oracle() {
    for size in DIRECT {
        let scene = Scene::new(size);
        let (depth, result) = run(&scene.input(), &DepthParams::default(), f32::NAN);
        assert!(result.converged && result.cycles == 0 && result.residual <= 1e-4, "{size:?} {result:?}");
        assert_eq!((result.regions, result.pixels, result.excluded), (1, size[0] * size[1], 0));
        let exact = scene.oracle();
        let (error, scale) = (distance(&depth, &exact), rms(exact.iter().copied()));
        assert!(error <= NEAR_ORACLE * scale, "{size:?} {error} {scale}");
    }
}

#[test]
fn other_sides_are_left_to_multigrid() {
    for size in NOT_DIRECT {
        let scene = Scene::new(size);
        let (depth, result) = run(&scene.input(), &DepthParams::default(), f32::NAN);
        assert!(result.converged && result.cycles > 0, "{size:?} {result:?}");
        let exact = scene.oracle();
        let scale = rms(exact.iter().copied());
        assert!(distance(&depth, &exact) <= 0.01 * scale, "{size:?}");
    }
}

#[test]
fn direct_solutions_against_multigrid() {
    for size in [[48, 36], [640, 480], [480, 640], [1000, 30], [97, 486]] {
        let scene = Scene::new(size);
        let (depth, result) = run(&scene.input(), &DepthParams::default(), f32::NAN);
        assert!(result.converged && result.cycles == 0, "{size:?} {result:?}");
        let (other, other_result) = by_multigrid(&scene);
        assert!(other_result.converged && other_result.cycles > 0, "{size:?} {other_result:?}");
        let other: Vec<f64> = other.iter().map(|&z| f64::from(z)).collect();
        let scale = rms(other.iter().copied());
        assert!(
            distance(&depth, &other) <= NEAR_MULTIGRID * scale,
            "{size:?} {}",
            distance(&depth, &other) / scale
        );
    }
}

#[test]
fn the_residual_is_that_of_the_depth() {
    // Slopes without trend, which is taken out before and put back after.
    let mut rng = Rng::new(2);
    let mut noise = || (0..70 * 64).map(|_| (rng.unit() - 0.5) as f32).collect();
    let scene = Scene { size: [70, 64], p: noise(), q: noise() };
    let (depth, result) = run(&scene.input(), &DepthParams::default(), 0.0);
    let [width, height] = scene.size;
    // Of every edge: what the slopes want, and what the depth has instead.
    let (mut right, mut left) = (vec![0.0; width * height], vec![0.0; width * height]);
    let mut edge = |a: usize, b: usize, slopes: &[f32]| {
        let rise = 0.5 * (f64::from(slopes[a]) + f64::from(slopes[b]));
        let step = f64::from(depth[b]) - f64::from(depth[a]);
        right[a] -= rise;
        right[b] += rise;
        left[a] += rise - step;
        left[b] -= rise - step;
    };
    for y in 0..height {
        for x in 0..width {
            let i = y * width + x;
            if x + 1 < width {
                edge(i, i + 1, &scene.p);
            }
            if y > 0 {
                edge(i, i - width, &scene.q);
            }
        }
    }
    let residual = rms(left.into_iter()) / rms(right.into_iter());
    assert!(residual > 0.0 && result.residual > 0.0);
    assert!(result.residual <= 2.0 * residual && residual <= 4.0 * result.residual, "{residual} {result:?}");
}

#[test]
fn the_same_bits_whatever_the_workspace_held() {
    for size in [[48, 36], [50, 23], [23, 50], [1, 12], [7, 1]] {
        let scene = Scene::new(size);
        for method in [Method::Poisson, Method::Paper] {
            let params = DepthParams { method, ..DepthParams::default() };
            let expected = run(&scene.input(), &params, 0.0);
            for dirt in [0.0, f32::NAN, f32::INFINITY, -1e30, 1e-40] {
                let (depth, result) = run(&scene.input(), &params, dirt);
                assert_eq!(result, expected.1);
                assert!(depth.iter().zip(&expected.0).all(|(a, b)| a.to_bits() == b.to_bits()));
            }
        }
    }
}

#[test]
fn the_same_bits_everywhere() {
    // Every radix, both ways, from slopes of integer arithmetic, so that only the core computes.
    let hashes = [[84, 60], [28, 45], [11, 48], [48, 11]].map(|size: [usize; 2]| {
        let mut rng = Rng::new(11);
        let mut slopes =
            || (0..size[0] * size[1]).map(|_| (rng.below(2001) as f32 - 1000.0) / 1024.0).collect();
        let scene = Scene { size, p: slopes(), q: slopes() };
        let (depth, _) = run(&scene.input(), &DepthParams::default(), 0.0);
        depth.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, z| {
            (hash ^ u64::from(z.to_bits())).wrapping_mul(0x0100_0000_01b3)
        })
    });
    assert_eq!(hashes, GOLDEN, "{hashes:#x?}");
}

/// What [`the_same_bits_everywhere`] gave when it was written, on x86-64.
const GOLDEN: [u64; 4] =
    [0x095a_0759_8f52_73a0, 0xf204_6f94_6972_7454, 0xeb08_29dd_3e16_1c83, 0x3e6f_20a7_3a44_fa73];

#[test]
fn whole_masks_and_weights_of_one_are_direct_and_priors_are_not() {
    let scene = Scene::new([32, 20]);
    let (expected, _) = run(&scene.input(), &DepthParams::default(), 0.0);
    let (mask, ones, known) = (vec![7_u8; 640], vec![1.0_f32; 640], vec![f32::NAN; 640]);
    let plane = |data| Some(Plane::new(data, 32, 20, 1, 32).unwrap());
    let input = DepthInput {
        mask: Some(Plane::new(&mask, 32, 20, 1, 32).unwrap()),
        weights: plane(&ones),
        ..scene.input()
    };
    let (depth, result) = run(&input, &DepthParams::default(), 0.0);
    assert_eq!(result.cycles, 0);
    assert!(depth.iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits()));
    let input = DepthInput { prior: plane(&known), ..scene.input() };
    assert!(run(&input, &DepthParams::default(), 0.0).1.cycles > 0);
    let ignored = DepthParams { prior_weight: 0.0, ..DepthParams::default() };
    assert_eq!(run(&input, &ignored, 0.0).1.cycles, 0);
}

#[test]
fn the_paper_s_mask_has_no_mean() {
    let scene = Scene::new([40, 30]);
    let mask: Vec<u8> = (0..1200).map(|i| u8::from(i % 40 > 10 && i / 40 > 3)).collect();
    let input = DepthInput { mask: Some(Plane::new(&mask, 40, 30, 1, 40).unwrap()), ..scene.input() };
    let params = DepthParams { method: Method::Paper, ..DepthParams::default() };
    let (depth, result) = run(&input, &params, 0.0);
    assert_eq!((result.cycles, result.pixels), (0, 29 * 26));
    let known = depth.iter().filter(|z| !z.is_nan());
    assert_eq!(known.clone().count(), 29 * 26);
    assert!((known.map(|&z| f64::from(z)).sum::<f64>() / (29.0 * 26.0)).abs() < 1e-6);
    assert!(depth.iter().zip(&mask).all(|(z, &m)| m != 0 || z.to_bits() == 0x7fc0_0000));
}
