//! Depth from normals against an independent solution, and everything that its documentation promises.

use ofc_core::math::rng::Rng;
use ofc_core::surface::depth::{
    DepthError, DepthInput, DepthParams, DepthResult, MAX_PIXELS, Method, Plane, Slopes, integrate,
    workspace_len,
};
use ofc_tests::depth_oracle::{self as oracle, Field};

/// RMSE against the truth may be this much larger than that of the exact least-squares solution (from the issue).
const WORSE_THAN_EXACT: f64 = 1.01;
/// A paraboloid comes back to this part of its range (from the issue).
const QUADRATIC: f64 = 1e-5;
/// Distance from the oracle as a part of the depth's RMS at a tolerance of 1e-6: the condition of these small systems
/// makes some hundred times the residual of it at worst.
const NEAR_ORACLE: f64 = 1e-4;

/// A scene: truth, slopes and mask.
#[derive(Clone)]
struct Scene {
    width: usize,
    height: usize,
    truth: Vec<f64>,
    normals: Vec<f32>,
    mask: Vec<u8>,
}

/// Depth, p and q at a place in pixels from the middle, y up.
type Surface = fn(f64, f64) -> [f64; 3];

fn quadratic(x: f64, y: f64) -> [f64; 3] {
    let z = 0.001 * x * x - 0.0015 * x * y - 0.002 * y * y + 0.1 * x - 0.3 * y;
    [z, 0.002 * x - 0.0015 * y + 0.1, -0.0015 * x - 0.004 * y - 0.3]
}

fn bumps(x: f64, y: f64) -> [f64; 3] {
    let (a, b) = (0.11, 0.07);
    let z = 4.0 * (a * x).sin() * (b * y).cos() + 0.002 * x * x;
    let p = 4.0 * a * (a * x).cos() * (b * y).cos() + 0.004 * x;
    [z, p, -4.0 * b * (a * x).sin() * (b * y).sin()]
}

fn gaussian(rng: &mut Rng) -> f64 {
    (-2.0 * (1.0 - rng.unit()).ln()).sqrt() * (std::f64::consts::TAU * rng.unit()).cos()
}

fn scene(size: [usize; 2], surface: Surface, noise: f64, inside: impl Fn(usize, usize) -> bool) -> Scene {
    let [width, height] = size;
    let mut rng = Rng::new(7);
    let mut scene = Scene { width, height, truth: vec![], normals: vec![], mask: vec![] };
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (x as f64 - (width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0 - y as f64);
            let [z, p, q] = surface(u, v);
            let length = (1.0 + p * p + q * q).sqrt();
            scene.truth.push(z);
            scene.normals.extend(
                [-p, -q, 1.0].map(|n| {
                    (n / length + if noise > 0.0 { noise * gaussian(&mut rng) } else { 0.0 }) as f32
                }),
            );
            scene.mask.push(u8::from(inside(x, y)));
        }
    }
    scene
}

fn all(_: usize, _: usize) -> bool {
    true
}

fn disc(size: usize) -> impl Fn(usize, usize) -> bool {
    let middle = (size - 1) as f64 / 2.0;
    move |x, y| (x as f64 - middle).hypot(y as f64 - middle) < 0.48 * size as f64
}

/// A disc cut in two but for a neck one pixel wide, with holes, an island in a hole, islands of one pixel, and a cut one
/// pixel wide that does not separate anything.
fn messy(size: usize) -> impl Fn(usize, usize) -> bool {
    let disc = disc(size);
    move |x, y| {
        let near = |cx: f64, cy: f64, r: f64| {
            (x as f64 - cx * size as f64).hypot(y as f64 - cy * size as f64) < r * size as f64
        };
        let wall = y == size / 2 || y == size / 2 + 1;
        let neck = x == size / 2;
        let hole = near(0.3, 0.25, 0.1) && !near(0.3, 0.25, 0.04);
        let cut = x == size / 3 && y > size * 6 / 10;
        let slant = x + 20 == y && y > size * 6 / 10 && y < size * 8 / 10;
        let island = (x, y) == (1, 1) || (x, y) == (size - 1, 0);
        island || disc(x, y) && !hole && !cut && !slant && (!wall || neck)
    }
}

impl Scene {
    fn input(&self) -> DepthInput<'_> {
        let (w, h) = (self.width, self.height);
        DepthInput {
            slopes: Slopes::Normals(Plane::new(&self.normals, w, h, 3, 3 * w).unwrap()),
            mask: Some(Plane::new(&self.mask, w, h, 1, w).unwrap()),
            weights: None,
            prior: None,
        }
    }

    fn field(&self) -> Field {
        let slope = |k: usize| {
            self.normals.as_chunks::<3>().0.iter().map(|n| -f64::from(n[k]) / f64::from(n[2])).collect()
        };
        Field {
            width: self.width,
            height: self.height,
            p: slope(0),
            q: slope(1),
            weight: self.mask.iter().map(|&m| f64::from(m)).collect(),
        }
    }

    fn truth(&self) -> Vec<f64> {
        let field = self.field();
        oracle::free_of_means(&field, self.truth.clone(), None, &vec![true; self.truth.len()])
    }
}

fn run(input: &DepthInput, params: &DepthParams) -> Result<(Vec<f32>, DepthResult), DepthError> {
    let [width, height] = input.size();
    let mut workspace = vec![f32::NAN; workspace_len(width, height).unwrap()];
    let mut depth = vec![9.0; width * height];
    let result = integrate(input, params, &mut workspace, &mut depth, width)?;
    Ok((depth, result))
}

fn precise() -> DepthParams {
    DepthParams { tolerance: 1e-6, ..DepthParams::default() }
}

/// Root mean square of the difference; both must be NaN at the same pixels.
fn distance(depth: &[f32], other: &[f64]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (&a, &b) in depth.iter().zip(other) {
        assert_eq!(a.is_nan(), b.is_nan());
        if !b.is_nan() {
            sum += (f64::from(a) - b) * (f64::from(a) - b);
            count += 1.0;
        }
    }
    f64::sqrt(sum / count)
}

fn rms(values: &[f64]) -> f64 {
    distance(&values.iter().map(|v| if v.is_nan() { f32::NAN } else { 0.0 }).collect::<Vec<_>>(), values)
}

#[test]
fn as_accurate_as_the_exact_solution() {
    let scenes = [
        scene([150, 133], bumps, 0.01, all),
        scene([150, 150], bumps, 0.01, disc(150)),
        scene([160, 160], bumps, 0.01, messy(160)),
    ];
    for scene in scenes {
        let (depth, result) = run(&scene.input(), &DepthParams::default()).unwrap();
        assert!(result.converged && result.residual <= 1e-4, "{result:?}");
        assert!(result.cycles <= 10, "{result:?}");
        let exact = oracle::poisson(&scene.field(), None);
        let truth = scene.truth();
        let exact_error = distance(&exact.iter().map(|&z| z as f32).collect::<Vec<_>>(), &truth);
        let error = distance(&depth, &truth);
        assert!(error <= WORSE_THAN_EXACT * exact_error, "{error} {exact_error}");
        // The control: a solution that is off by a hundredth of the truth would not pass.
        let off: Vec<f32> = exact.iter().map(|&z| (1.01 * z) as f32).collect();
        assert!(distance(&off, &truth) > WORSE_THAN_EXACT * exact_error);
    }
}

#[test]
fn paraboloids_are_exact() {
    let sizes = [[1024, 700], [257, 255], [3, 2], [2, 2], [1, 9], [9, 1], [1, 1], [500, 1], [2, 301]];
    let mut scenes: Vec<Scene> = sizes.map(|size| scene(size, quadratic, 0.0, all)).into();
    scenes.push(scene([300, 300], quadratic, 0.0, disc(300)));
    scenes.push(scene([200, 200], quadratic, 0.0, messy(200)));
    for scene in scenes {
        let (depth, result) = run(&scene.input(), &DepthParams::default()).unwrap();
        assert!(result.converged, "{result:?}");
        let truth = scene.truth();
        let known = || truth.iter().copied().filter(|z| z.is_finite());
        let range = known().fold(f64::MIN, f64::max) - known().fold(f64::MAX, f64::min);
        for (&z, &t) in depth.iter().zip(&truth) {
            assert!(t.is_nan() && z.is_nan() || (f64::from(z) - t).abs() <= QUADRATIC * range, "{z} {t}");
        }
    }
}

#[test]
fn regions_are_counted_and_have_no_mean() {
    let scene = scene([160, 160], bumps, 0.01, messy(160));
    let (depth, result) = run(&scene.input(), &DepthParams::default()).unwrap();
    let (labels, count) = oracle::regions(&scene.field());
    assert_eq!(count, 4);
    assert_eq!(result.regions, count);
    assert_eq!(result.pixels, scene.mask.iter().map(|&m| usize::from(m)).sum());
    assert_eq!(result.excluded, 0);
    for region in 0..count {
        let values: Vec<f64> = depth
            .iter()
            .zip(&labels)
            .filter(|(_, l)| **l == Some(region))
            .map(|(&z, _)| f64::from(z))
            .collect();
        assert!((values.iter().sum::<f64>() / values.len() as f64).abs() < 1e-6);
    }
    for (z, m) in depth.iter().zip(&scene.mask) {
        assert_eq!(*m == 0, z.is_nan());
        assert!(!z.is_nan() || z.to_bits() == 0x7fc0_0000);
    }
}

#[test]
fn masks_that_coarse_grids_misrepresent() {
    let size = 200;
    let hash = |x: usize, y: usize| Rng::new((x * 1000 + y) as u64).below(100);
    // A cut down the middle at every offset from the blocks, a diagonal cut, lines one pixel wide, a fifth of the
    // pixels missing at random, a chessboard: and how many cycles each may take.
    let cuts = |at: usize| move |x: usize, y: usize| x != at || y == 0;
    for at in 96..104 {
        check_cycles(&scene([size, size], bumps, 0.01, cuts(at)), 10);
    }
    check_cycles(&scene([size, size], bumps, 0.01, |x, y| x != y), 12);
    check_cycles(&scene([size, size], bumps, 0.01, |x, y| x % 20 == 3 || y % 20 == 7), 25);
    check_cycles(&scene([size, size], bumps, 0.01, |x, y| x == 5 || y == 190), 12);
    check_cycles(&scene([size, size], bumps, 0.01, |x, y| hash(x, y) >= 10), 12);
    check_cycles(&scene([size, size], bumps, 0.01, |x, y| hash(x, y) >= 20), 25);
    check_cycles(&scene([size, size], bumps, 0.01, |x, y| (x + y) % 2 == 0), 0);
    // Combs and mazes of corridors narrower than their walls' period are the worst there is: slow, but they arrive.
    check_cycles(&scene([100, 100], bumps, 0.01, |x, y| x % 3 != 1 || y == 0), 1000);
}

fn check_cycles(scene: &Scene, most: u32) {
    let (_, result) = run(&scene.input(), &DepthParams::default()).unwrap();
    let (_, count) = oracle::regions(&scene.field());
    assert!(result.converged && result.cycles <= most, "{most} {result:?}");
    assert_eq!(result.regions, count);
}

#[test]
fn weights_against_the_oracle() {
    let scene = scene([90, 70], bumps, 0.05, messy(90));
    let mut rng = Rng::new(3);
    let weights: Vec<f32> =
        (0..90 * 70).map(|_| if rng.below(20) == 0 { 0.0 } else { 0.01 + rng.unit() as f32 }).collect();
    let mut input = scene.input();
    input.weights = Some(Plane::new(&weights, 90, 70, 1, 90).unwrap());
    let (depth, result) = run(&input, &precise()).unwrap();
    let mut field = scene.field();
    for (weight, &w) in field.weight.iter_mut().zip(&weights) {
        *weight *= f64::from(w);
    }
    let exact = oracle::poisson(&field, None);
    assert!(result.converged && result.excluded > 100, "{result:?}");
    assert_eq!(result.regions, oracle::regions(&field).1);
    assert!(distance(&depth, &exact) < NEAR_ORACLE * rms(&exact), "{}", distance(&depth, &exact));
    // A weight for everyone changes nothing.
    let same = vec![4.0_f32; 90 * 70];
    input.weights = Some(Plane::new(&same, 90, 70, 1, 90).unwrap());
    let (weighted, _) = run(&input, &precise()).unwrap();
    let (plain, _) = run(&scene.input(), &precise()).unwrap();
    let plain: Vec<f64> = plain.iter().map(|&z| f64::from(z)).collect();
    assert!(distance(&weighted, &plain) < NEAR_ORACLE * rms(&plain));
}

#[test]
fn unusable_normals_are_left_out_and_counted() {
    let mut scene = scene([40, 30], bumps, 0.0, all);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1.0, 1e38];
    for (k, value) in bad.iter().enumerate() {
        scene.normals[3 * (k * 100 + 7) + 2] = *value;
    }
    scene.normals[3 * 900..3 * 901].fill(0.0);
    scene.normals[3 * 950] = f32::NAN;
    let (depth, result) = run(&scene.input(), &DepthParams::default()).unwrap();
    assert_eq!(result.excluded, 8);
    assert_eq!(result.pixels, 1192);
    assert_eq!(depth.iter().filter(|z| z.is_nan()).count(), 8);
    for pixel in [7, 107, 207, 307, 407, 507, 900, 950] {
        scene.mask[pixel] = 0;
    }
    let (masked, result) = run(&scene.input(), &DepthParams::default()).unwrap();
    assert_eq!(result.excluded, 0);
    assert!(depth.iter().zip(&masked).all(|(a, b)| a.to_bits() == b.to_bits()));
}

#[test]
fn grazing_normals_do_not_explode() {
    // A sphere up to its rim.
    let size = 101;
    let mut scene =
        scene([size, size], |_, _| [0.0; 3], 0.0, |x, y| (x as f64 - 50.0).hypot(y as f64 - 50.0) < 50.0);
    for (i, n) in scene.normals.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        let (x, y) = ((i % size) as f64 - 50.0, 50.0 - (i / size) as f64);
        let z = (2500.0 - x * x - y * y).max(1e-9).sqrt();
        *n = [x as f32, y as f32, z as f32];
        scene.truth[i] = z;
    }
    let (depth, result) =
        run(&scene.input(), &DepthParams { min_n3: 0.2, ..DepthParams::default() }).unwrap();
    assert!(result.converged, "{result:?}");
    let truth = scene.truth();
    // One pixel inside the rim the slope is 5 and changes by a half from pixel to pixel.
    assert!(distance(&depth, &truth) < 0.4, "{}", distance(&depth, &truth));
    assert!(depth.iter().all(|z| z.is_nan() || z.abs() < 60.0));
}

#[test]
fn a_prior_fixes_the_depth_of_its_regions() {
    let scene = scene([80, 80], bumps, 0.01, messy(80));
    let mut prior = vec![f32::NAN; 80 * 80];
    for (i, prior) in prior.iter_mut().enumerate() {
        if i % 37 == 5 && i < 3000 {
            *prior = (scene.truth[i] + 100.0) as f32;
        }
    }
    let mut input = scene.input();
    input.prior = Some(Plane::new(&prior, 80, 80, 1, 80).unwrap());
    for weight in [1e-3, 1.0] {
        let params = DepthParams { prior_weight: weight, ..precise() };
        let (depth, result) = run(&input, &params).unwrap();
        assert!(result.converged, "{result:?}");
        let prior: Vec<f64> = prior.iter().map(|&z| f64::from(z)).collect();
        let exact = oracle::poisson(&scene.field(), Some((&prior, weight)));
        assert!(distance(&depth, &exact) < NEAR_ORACLE * rms(&exact), "{}", distance(&depth, &exact));
        // In the unit of the pitch.
        let scaled: Vec<f32> = prior.iter().map(|&z| (0.25 * z) as f32).collect();
        let mut input = scene.input();
        input.prior = Some(Plane::new(&scaled, 80, 80, 1, 80).unwrap());
        let (quarter, _) = run(&input, &DepthParams { pixel_pitch: 0.25, ..params }).unwrap();
        let exact: Vec<f64> = exact.iter().map(|z| 0.25 * z).collect();
        assert!(distance(&quarter, &exact) < NEAR_ORACLE * rms(&exact));
    }
    // Without weight it is not there.
    let (depth, _) = run(&input, &DepthParams { prior_weight: 0.0, ..precise() }).unwrap();
    let (plain, _) = run(&scene.input(), &precise()).unwrap();
    assert!(depth.iter().zip(&plain).all(|(a, b)| a.to_bits() == b.to_bits()));
}

#[test]
fn the_paper_s_rectangle() {
    let scene = scene([75, 60], bumps, 0.01, disc(60));
    let (depth, result) = run(&scene.input(), &DepthParams { method: Method::Paper, ..precise() }).unwrap();
    let mut field = scene.field();
    for i in 0..75 * 60 {
        if scene.mask[i] == 0 {
            (field.p[i], field.q[i]) = (0.0, 0.0);
        }
        field.weight[i] = 1.0;
    }
    let counted: Vec<bool> = scene.mask.iter().map(|&m| m != 0).collect();
    let exact = oracle::free_of_means(&field, oracle::poisson(&field, None), None, &counted);
    let exact: Vec<f64> = exact.iter().zip(&counted).map(|(&z, &c)| if c { z } else { f64::NAN }).collect();
    assert!(distance(&depth, &exact) < NEAR_ORACLE * rms(&exact), "{}", distance(&depth, &exact));
    assert_eq!((result.regions, result.pixels), (1, scene.mask.iter().map(|&m| usize::from(m)).sum()));
}

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
    let need = workspace_len(50, 40).unwrap();
    for dirt in [0.0, 1e30, f32::NAN, f32::INFINITY, -1.0] {
        let mut workspace = vec![dirt; need + 5];
        let mut out = vec![-7.5_f32; 64 * 40 + 10];
        let strided_result =
            integrate(&input, &DepthParams::default(), &mut workspace, &mut out, 64).unwrap();
        assert_eq!(strided_result, expected_result);
        for (y, row) in out.chunks(64).enumerate() {
            for (x, &z) in row.iter().enumerate() {
                let expected = if x < 50 && y < 40 { expected[y * 50 + x] } else { -7.5 };
                assert_eq!(z.to_bits(), expected.to_bits());
            }
        }
        assert!(workspace[need..].iter().all(|w| w.to_bits() == dirt.to_bits()));
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
            let mut workspace = vec![0.0; workspace_len(61, 47).unwrap()];
            let outputs = [0.0, f32::NAN, 1e20, 3.5].map(|dirt| {
                if dirt != 3.5 {
                    workspace.fill(dirt);
                }
                let mut depth = vec![0.0; 61 * 47];
                integrate(&input, &params, &mut workspace, &mut depth, 61).unwrap();
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
const GOLDEN: [u64; 3] = [0x6c6f_4345_db1c_1547, 0x6fc1_5cb3_f7df_2776, 0x6f7c_6537_5a04_a0ca];

#[test]
fn one_row_one_column_one_pixel() {
    for size in [[1, 1], [1, 2], [2, 1], [200, 1], [1, 200], [2, 2], [3, 3], [1000, 2]] {
        let scene = scene(size, bumps, 0.0, all);
        let field = scene.field();
        for method in [Method::Poisson, Method::Paper, Method::Coupled] {
            let (depth, result) = run(&scene.input(), &DepthParams { method, ..precise() }).unwrap();
            assert!(result.converged && result.regions == 1, "{size:?} {result:?}");
            if method != Method::Coupled && size != [1, 1] {
                let exact = oracle::poisson(&field, None);
                assert!(distance(&depth, &exact) <= NEAR_ORACLE * rms(&exact) + 1e-7, "{size:?} {depth:?}");
            }
            if size == [1, 1] {
                assert_eq!(depth, [0.0]);
            }
        }
    }
}

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
    let need = workspace_len(20, 10).unwrap();
    let check = |input: &DepthInput, params: DepthParams, workspace: usize, len: usize, stride: usize| {
        let mut depth = vec![5.0_f32; len];
        let result = integrate(input, &params, &mut vec![0.0; workspace], &mut depth, stride);
        assert!(result.is_ok() || depth.iter().all(|&z| z == 5.0));
        result.err()
    };
    let params = DepthParams::default();
    assert_eq!(check(&good, params, need, 200, 20), None);
    assert_eq!(check(&good, params, need - 1, 200, 20), Some(DepthError::Workspace(need)));
    assert_eq!(check(&good, params, 0, 200, 20), Some(DepthError::Workspace(need)));
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
    let formula = |w: u64, h: u64| {
        4 * ((h + 2) * (w + 1) + 1) + 5 * (w * h / 3 + 3 * w + 2 * h + 180) + 4 * (2 * h + 30) + 4 * (w + 2)
    };
    for [w, h] in [[1, 1], [7, 5], [640, 480], [2048, 2048], [1, 100_000], [30_000, 17_000]] {
        assert_eq!(workspace_len(w, h).map(|len| len as u64), Some(formula(w as u64, h as u64)));
    }
    // 24 bytes a pixel from this size on.
    for size in [256, 320, 512, 1024, 4096] {
        assert!(workspace_len(size, size).unwrap() <= 6 * size * size, "{size}");
    }
    assert!(workspace_len(640, 480).unwrap() <= 6 * 640 * 480);
    for [w, h] in [[0, 5], [5, 0], [0, 0], [MAX_PIXELS + 1, 1], [1 << 20, 1 << 20], [usize::MAX, usize::MAX]]
    {
        assert_eq!(workspace_len(w, h), None);
    }
    assert!(workspace_len(MAX_PIXELS, 1).is_some());
}
