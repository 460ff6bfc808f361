//! What the documentation of depth promises whatever the surface is: units, strides, workspaces, limits and errors.

use ofc_core::math::arena::Need;
use ofc_core::math::rng::Rng;
use ofc_core::surface::depth::{
    DepthError, DepthInput, DepthParams, MAX_PIXELS, Method, Plane, Slopes, integrate, need,
};
use ofc_tests::depth_scenes::{all, bumps, disc, messy, precise, run, scene};
use ofc_tests::depth_workspace::Workspace;

#[test]
fn the_unit_and_the_sign_of_the_axes() {
    let scene = scene([33, 21], |x, y| [0.5 * x + 0.25 * y, 0.5, 0.25], 0.0, all);
    let (depth, _) =
        run(&scene.input(), &DepthParams { pixel_pitch: 0.02, ..DepthParams::default() }).unwrap();
    // To the right depth grows, and upward: toward row 0.
    assert!((depth[1] - depth[0] - 0.01).abs() < 1e-6);
    assert!((depth[0] - depth[33] - 0.005).abs() < 1e-6);
    assert!(depth[16 + 33 * 10].abs() < 1e-6);
}

#[test]
fn gradients_and_strides() {
    let scene = scene([50, 40], bumps, 0.01, messy(50));
    let field = scene.field();
    let [p, q] = [&field.p, &field.q].map(|s| s.iter().map(|&s| s as f32).collect::<Vec<f32>>());
    let pad = |values: &[f32], row: usize, stride: usize| -> Vec<f32> {
        values
            .chunks(row)
            .flat_map(|r| r.iter().copied().chain(std::iter::repeat_n(f32::NAN, stride - row)))
            .collect()
    };
    let (expected, expected_result) = run(&scene.input(), &DepthParams::default()).unwrap();
    let (p, q) = (pad(&p, 50, 57), pad(&q, 50, 57));
    let plane = |data| Plane::new(data, 50, 40, 1, 57).unwrap();
    let gradients = DepthInput { slopes: Slopes::Gradients { p: plane(&p), q: plane(&q) }, ..scene.input() };
    let (depth, result) = run(&gradients, &DepthParams::default()).unwrap();
    assert_eq!(result.pixels, expected_result.pixels);
    for (a, b) in depth.iter().zip(&expected) {
        assert!(a.is_nan() && b.is_nan() || (a - b).abs() < 1e-5, "{a} {b}");
    }
    let normals = pad(&scene.normals, 150, 163);
    let mask: Vec<u8> = scene.mask.chunks(50).flat_map(|r| [r, &[1, 1, 1]].concat()).collect();
    let input = DepthInput {
        slopes: Slopes::Normals(Plane::new(&normals, 50, 40, 3, 163).unwrap()),
        mask: Some(Plane::new(&mask, 50, 40, 1, 53).unwrap()),
        ..scene.input()
    };
    // Dirty workspaces of all kinds, a strided output: the same bits, and nothing written in between or behind.
    for dirt in [0.0, 1e30, f32::NAN, f32::INFINITY, -1.0] {
        let need = need(50, 40).unwrap();
        let more = Need { doubles: 0, singles: need.singles + 5, integers: need.integers + 5 };
        let mut workspace = Workspace::of(more, dirt);
        let mut out = vec![-7.5_f32; 64 * 40 + 10];
        let strided_result =
            integrate(&input, &DepthParams::default(), workspace.arena(), &mut out, 64).unwrap();
        assert_eq!(strided_result, expected_result);
        for (y, row) in out.chunks(64).enumerate() {
            for (x, &z) in row.iter().enumerate() {
                let expected = if x < 50 && y < 40 { expected[y * 50 + x] } else { -7.5 };
                assert_eq!(z.to_bits(), expected.to_bits());
            }
        }
        assert!(workspace.singles[need.singles..].iter().all(|w| w.to_bits() == dirt.to_bits()));
        assert!(workspace.integers[need.integers..].iter().all(|&w| w == dirt.to_bits()));
    }
}

#[test]
fn every_method_ignores_what_the_workspace_held() {
    let scene = scene([61, 47], bumps, 0.01, messy(61));
    let prior = vec![3.0_f32; 61 * 47];
    for method in [Method::Poisson, Method::Paper, Method::Coupled] {
        for prior_weight in [0.0, 0.1] {
            let input =
                DepthInput { prior: Some(Plane::new(&prior, 61, 47, 1, 61).unwrap()), ..scene.input() };
            let params = DepthParams { method, prior_weight, ..DepthParams::default() };
            let mut workspace = Workspace::new(61, 47, 0.0);
            let outputs = [0.0, f32::NAN, 1e20, 3.5].map(|dirt| {
                if dirt != 3.5 {
                    workspace.soil(dirt);
                }
                let mut depth = vec![0.0; 61 * 47];
                integrate(&input, &params, workspace.arena(), &mut depth, 61).unwrap();
                depth.iter().map(|z| z.to_bits()).collect::<Vec<_>>()
            });
            assert!(outputs.iter().all(|bits| *bits == outputs[0]));
        }
    }
}

#[test]
fn the_same_bits_everywhere() {
    // Slopes from integer arithmetic, so that only the core computes.
    let (width, height) = (70, 50);
    let mut rng = Rng::new(11);
    let mut slope = || (rng.below(2001) as f32 - 1000.0) / 1024.0;
    let p: Vec<f32> = (0..width * height).map(|_| slope()).collect();
    let q: Vec<f32> = (0..width * height).map(|_| slope()).collect();
    let mask: Vec<u8> = (0..width * height).map(|i| u8::from(i % 11 != 3)).collect();
    let plane = |data| Plane::new(data, width, height, 1, width).unwrap();
    let input = DepthInput {
        slopes: Slopes::Gradients { p: plane(&p), q: plane(&q) },
        mask: Some(Plane::new(&mask, width, height, 1, width).unwrap()),
        weights: None,
        prior: None,
    };
    let hashes = [Method::Poisson, Method::Paper, Method::Coupled].map(|method| {
        let (depth, _) = run(&input, &DepthParams { method, ..DepthParams::default() }).unwrap();
        depth.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, z| {
            (hash ^ u64::from(z.to_bits())).wrapping_mul(0x0100_0000_01b3)
        })
    });
    assert_eq!(hashes, GOLDEN, "{hashes:#x?}");
}

/// What [`the_same_bits_everywhere`] gave when it was written, on x86-64.
const GOLDEN: [u64; 3] = [0x6c6f_4345_db1c_1547, 0x6fc1_5cb3_f7df_2776, 0xce30_f248_b465_9ad4];

#[test]
fn stops_where_it_is_told_to() {
    let scene = scene([64, 64], bumps, 0.01, disc(64));
    let (_, result) = run(&scene.input(), &DepthParams { max_cycles: 1, ..DepthParams::default() }).unwrap();
    assert!(!result.converged && result.cycles == 1 && result.residual > 1e-4, "{result:?}");
    let (_, result) = run(&scene.input(), &DepthParams { max_cycles: 0, ..DepthParams::default() }).unwrap();
    assert!(!result.converged && result.cycles == 0);
    let (_, result) = run(&scene.input(), &precise()).unwrap();
    assert!(result.converged && result.residual <= 1e-6, "{result:?}");
}

#[test]
fn bad_input_leaves_the_depth_alone() {
    let scene = scene([20, 10], bumps, 0.0, all);
    let good = scene.input();
    let need = need(20, 10).unwrap();
    let check = |input: &DepthInput, params: DepthParams, workspace: Need, len: usize, stride: usize| {
        let mut depth = vec![5.0_f32; len];
        let result = integrate(input, &params, Workspace::of(workspace, 0.0).arena(), &mut depth, stride);
        assert!(result.is_ok() || depth.iter().all(|&z| z == 5.0));
        result.err()
    };
    let params = DepthParams::default();
    assert_eq!(check(&good, params, need, 200, 20), None);
    let short = [
        Need::default(),
        Need { singles: need.singles - 1, ..need },
        Need { integers: need.integers - 1, ..need },
    ];
    for short in short {
        assert_eq!(check(&good, params, short, 200, 20), Some(DepthError::Workspace(need)));
    }
    assert_eq!(check(&good, params, need, 199, 20), Some(DepthError::Output));
    assert_eq!(check(&good, params, need, 200, 19), Some(DepthError::Output));
    assert_eq!(check(&good, params, need, 200, usize::MAX), Some(DepthError::Output));
    let small = vec![1.0_f32; 200];
    let turned = DepthInput { weights: Some(Plane::new(&small, 10, 20, 1, 10).unwrap()), ..good };
    assert_eq!(check(&turned, params, need, 200, 20), Some(DepthError::Size));
    let turned = DepthInput { slopes: Slopes::Normals(Plane::new(&small, 20, 10, 1, 20).unwrap()), ..good };
    assert_eq!(check(&turned, params, need, 200, 20), Some(DepthError::Size));
    let none = vec![0_u8; 200];
    let empty = DepthInput { mask: Some(Plane::new(&none, 20, 10, 1, 20).unwrap()), ..good };
    let unknown = vec![f32::NAN; 600];
    let hopeless =
        DepthInput { slopes: Slopes::Normals(Plane::new(&unknown, 20, 10, 3, 60).unwrap()), ..good };
    for method in [Method::Poisson, Method::Paper, Method::Coupled] {
        for input in [empty, hopeless] {
            let params = DepthParams { method, ..params };
            assert_eq!(check(&input, params, need, 200, 20), Some(DepthError::Empty));
        }
    }
    for bad in [f64::NAN, f64::INFINITY, -1.0, 1e300, 1e-300] {
        let variants = [
            DepthParams { pixel_pitch: bad, ..params },
            DepthParams { tolerance: bad, ..params },
            DepthParams { min_n3: bad, ..params },
            DepthParams { smoothness: bad, ..params },
            DepthParams { prior_weight: if bad == 1e-300 { -1e-300 } else { bad }, ..params },
        ];
        for params in variants {
            assert_eq!(check(&good, params, need, 200, 20), Some(DepthError::Parameter), "{params:?}");
        }
    }
}

#[test]
fn workspace_sizes() {
    let coarse = |w: usize, h: usize| 8 * (w * h / 3 + 3 * w + 2 * h + 180);
    for [w, h] in [[1, 1], [7, 5], [640, 480], [2048, 2048], [1, 100_000], [30_000, 17_000]] {
        let fine = (h + 2) * (w + 1) + 1;
        let singles = 2 * fine + coarse(w, h) + 7 * (w + 2);
        let integers = fine + 4 * (2 * h + 30);
        assert_eq!(need(w, h), Some(Need { doubles: 0, singles, integers }));
    }
    // 24 bytes a pixel from this size on.
    for [w, h] in [[256, 256], [320, 320], [512, 512], [1024, 1024], [4096, 4096], [640, 480]] {
        assert!(need(w, h).unwrap().bytes() <= 24 * w * h, "{w} {h}");
    }
    for [w, h] in [[0, 5], [5, 0], [0, 0], [MAX_PIXELS + 1, 1], [1 << 20, 1 << 20], [usize::MAX, usize::MAX]]
    {
        assert_eq!(need(w, h), None);
    }
    assert!(need(MAX_PIXELS, 1).is_some());
}
