//! The self-checks against a naive oracle, on an egg, with something wrong, and on the photographs.

use ofc_core::check::{Check, CheckError, DepthCheck, check, workspace_len};
use ofc_core::color::inliers::Inliers;
use ofc_core::math::mat3;
use ofc_core::orientation::matrix::Orientation;
use ofc_core::picture::{Image, Window, for_each_bit};
use ofc_core::render::DepthMap;
use ofc_core::solve::{self, OrientationMethod, Outcome, Solution};
use ofc_core::surface::depth::{self, DepthInput, DepthParams, Plane, Slopes};
use ofc_core::surface::normals::{self, Length};
use ofc_tests::depth_workspace::Workspace;
use ofc_tests::photographs;
use ofc_tests::shaded_scenes::{CLEAN, Matrix, PAPER, Scene, dot};

fn solved(image: &Image) -> Solution {
    let params = solve::Params { orientation_method: OrientationMethod::Direct, ..solve::Params::default() };
    let pixels = image.width() * image.height();
    let mut workspace = vec![0.0; solve::workspace_len(pixels, params.lmeds.sample_size)];
    let solution = solve::solve(image, &params, &mut workspace).expect("a solution");
    assert_eq!(solution.outcome, Outcome::Solved);
    solution
}

fn checked(image: &Image, solution: &Solution, orientation: &Orientation) -> Check {
    let mut workspace = vec![f32::NAN; workspace_len(image.width() * image.height())];
    let coefficients = solution.fit.expect("a fit").coefficients;
    check(image, &solution.inliers, orientation, &coefficients, None, &mut workspace).expect("a check")
}

/// The surface of what F says: its depth, and what it looks like beside the picture.
fn integrated(image: &Image, solution: &Solution, orientation: &Orientation) -> DepthCheck {
    let [width, height] = [image.width(), image.height()];
    let inliers = |window: &Window| solution.inliers.bits(window);
    let mut normals = vec![0.0_f32; 3 * width * height];
    normals::compute(image, inliers, &orientation.f_inverse, Length::Unit, &mut normals, 3 * width)
        .expect("normals");
    let input = DepthInput {
        slopes: Slopes::Normals(Plane::new(&normals, width, height, 3, 3 * width).unwrap()),
        mask: None,
        weights: None,
        prior: None,
    };
    let mut workspace = Workspace::new(width, height, 0.0);
    let mut depths = vec![0.0_f32; width * height];
    let params = DepthParams { pixel_pitch: 0.25, ..DepthParams::default() };
    depth::integrate(&input, &params, workspace.arena(), &mut depths, width).expect("depth");
    let bytes: Vec<u8> = depths.iter().flat_map(|z| z.to_ne_bytes()).collect();
    let surface = DepthMap::new(&bytes, width, height, 4 * width, 0.25).unwrap();
    let coefficients = solution.fit.expect("a fit").coefficients;
    check(image, &solution.inliers, orientation, &coefficients, Some(&surface), &mut workspace.singles)
        .unwrap()
        .depth
        .unwrap()
}

/// The median angle of a check that has a surface.
fn angle(found: &DepthCheck) -> f64 {
    found.median_angle.expect("a surface")
}

#[test]
fn integrated_depth_tells_right_from_wrong() {
    let scene = Scene::new(160, 160, &CLEAN, egg).with_noise(0.5, 3);
    let image = scene.image();
    let solution = solved(&image);
    let right = solution.choice.as_ref().unwrap().orientation;
    let found = integrated(&image, &solution, &right);
    println!("right: {:.2} degrees, {:?}", angle(&found).to_degrees(), found.tilt_differences);
    assert!(found.pixels > solution.inlier_count - 20);
    assert!(angle(&found) < 0.02);
    assert!(found.tilt_differences.unwrap().iter().all(|d| d.abs() < 0.05));
    // The same colors with normals turned by 40 degrees about z: no surface has them.
    let (s, c) = 40.0_f64.to_radians().sin_cos();
    let turn = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
    let wrong = Orientation::new(mat3::multiply(&right.f, &turn), 1e-3);
    let found = integrated(&image, &solution, &wrong);
    println!("wrong: {:.2} degrees, {:?}", angle(&found).to_degrees(), found.tilt_differences);
    assert!(angle(&found) > 0.1);
}

/// An egg that every light of `CLEAN` reaches everywhere: half of a body of revolution, narrower at one end.
fn egg(x: f64, y: f64) -> Option<f64> {
    let (u, v) = (x / 60.0, y / 75.0);
    let width = 1.0 - 0.25 * v;
    let square = 1.0 - v * v - u * u / (width * width);
    (square > 0.35).then(|| 60.0 * square.sqrt())
}

/// Correlations, and the median, smallest and largest norm, from the inliers' colors in a list.
fn oracle(colors: &[[f64; 3]], f: &Matrix, g: &Matrix) -> ([f64; 3], [f64; 3]) {
    let normals: Vec<[f64; 3]> = colors.iter().map(|&color| g.map(|row| dot(row, color))).collect();
    let mut norms: Vec<f64> = normals.iter().map(|&n| dot(n, n).sqrt()).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let correlations = [0, 1, 2].map(|channel| {
        let input: Vec<f64> = colors.iter().map(|color| color[channel]).collect();
        let output: Vec<f64> =
            normals.iter().zip(&norms).map(|(&n, norm)| dot(f[channel], n) / norm).collect();
        let (mean_in, mean_out) = (mean(&input), mean(&output));
        let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            input.iter().zip(&output).map(|(a, b)| f(a - mean_in, b - mean_out)).sum()
        };
        sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
    });
    norms.sort_by(f64::total_cmp);
    (correlations, [norms[norms.len() / 2], norms[0], norms[norms.len() - 1]])
}

fn inlier_colors(image: &Image, solution: &Solution) -> Vec<[f64; 3]> {
    let mut colors = Vec::new();
    image.for_each_window(|window| {
        for_each_bit(solution.inliers.bits(window), |i| colors.push(window.pixel(i).map(f64::from)));
    });
    colors
}

#[test]
fn numbers_are_the_oracles() {
    for (lights, noise) in [(&CLEAN, 0.0), (&CLEAN, 2.0), (&PAPER, 1.0)] {
        let scene = Scene::new(160, 160, lights, egg).with_noise(noise, 3);
        let image = scene.image();
        let solution = solved(&image);
        let orientation = solution.choice.as_ref().unwrap().orientation;
        let found = checked(&image, &solution, &orientation);
        let colors = inlier_colors(&image, &solution);
        let (correlations, [median, min, max]) = oracle(&colors, &orientation.f, &orientation.f_inverse);
        assert_eq!(found.inliers, colors.len());
        for (got, want) in found.correlations.iter().zip(correlations) {
            assert!((got - want).abs() < 1e-9);
        }
        // Norms are kept in f32.
        for (got, want) in [(found.norms.median, median), (found.norms.min, min), (found.norms.max, max)] {
            assert!((got - want).abs() < 1e-6 * want, "{got} {want}");
        }
    }
}

#[test]
fn an_egg_passes() {
    let scene = Scene::new(160, 160, &CLEAN, egg);
    let image = scene.image();
    let solution = solved(&image);
    let found = checked(&image, &solution, &solution.choice.as_ref().unwrap().orientation);
    println!("egg: {found:?}");
    assert!(found.correlations.iter().all(|&r| r > 0.9989));
    assert!((found.norms.median - 1.0).abs() < 1e-3);
    assert!(found.norms.min > 0.99 && found.norms.max < 1.01);
    assert!(found.largest_p < 1e-6);
    assert!(found.tilt_differences.unwrap().iter().all(|d| d.abs() < 1e-3));
    assert!(found.tilt_residuals.unwrap().iter().all(|d| d.abs() < 1e-9));
}

#[test]
fn what_is_wrong_shows_where_it_should() {
    // Noise: in the correlations and the norms.
    let scene = Scene::new(160, 160, &CLEAN, egg).with_noise(6.0, 1);
    let image = scene.image();
    let solution = solved(&image);
    let orientation = solution.choice.as_ref().unwrap().orientation;
    let found = checked(&image, &solution, &orientation);
    assert!(found.correlations.iter().all(|&r| (0.9..0.9989).contains(&r)), "{:?}", found.correlations);
    assert!(found.norms.max - found.norms.min > 0.05);
    // A convex/concave inversion: not in the correlations, but in the tilts.
    let inverted = orientation.f.map(|[x, y, z]| [-x, -y, z]);
    let wrong = checked(&image, &solution, &Orientation::new(inverted, 1e-6));
    for (a, b) in wrong.correlations.iter().zip(found.correlations) {
        assert!((a - b).abs() < 1e-9);
    }
    assert!(wrong.tilt_residuals.unwrap().iter().all(|d| d.abs() > 3.0));
    // An F that is not that of the ellipsoid: in the norms.
    let [a, b, c] = orientation.f;
    let stretched = Orientation::new([a, b, c.map(|x| 1.3 * x)], 1e-6);
    let norms = checked(&image, &solution, &stretched).norms;
    assert!(norms.max - norms.min > 2.0 * (found.norms.max - found.norms.min));
}

#[test]
fn photographs_are_reported() {
    for name in ["gelsight_ball_6mm", "gelsight_ball_9mm", "cat_figurine"] {
        let Some(photo) = photographs::load(name) else { return };
        let image = photo.image();
        let solution = solved(&image);
        let found = checked(&image, &solution, &solution.choice.as_ref().unwrap().orientation);
        println!(
            "{name}: correlations {:.4?}, norms {:.3} ({:.3} to {:.3}), tilt differences {:.1?} deg, turn {:.1?} deg, largest p {:.1e}",
            found.correlations,
            found.norms.median,
            found.norms.min,
            found.norms.max,
            found.tilt_differences.map(|d| d.map(f64::to_degrees)),
            found.turn.map(|turn| [turn.angle, turn.expected].map(f64::to_degrees)),
            found.largest_p
        );
        assert!(found.correlations.iter().all(|&r| r > 0.97), "{name}");
        assert!((found.norms.median - 1.0).abs() < 0.05);
    }
}

#[test]
fn bad_input_is_refused() {
    let scene = Scene::new(160, 160, &CLEAN, egg);
    let image = scene.image();
    let solution = solved(&image);
    let orientation = solution.choice.as_ref().unwrap().orientation;
    let coefficients = solution.fit.unwrap().coefficients;
    let need = workspace_len(160 * 160);
    let run = |orientation: &Orientation, len: usize, any: bool| {
        let inliers = if any { solution.inliers } else { Inliers::none(solution.inliers.usable) };
        check(&image, &inliers, orientation, &coefficients, None, &mut vec![0.0; len]).map(|_| ())
    };
    let bytes = vec![0; 4 * 160 * 161];
    let other = DepthMap::new(&bytes, 160, 161, 4 * 160, 1.0).unwrap();
    assert_eq!(
        check(&image, &solution.inliers, &orientation, &coefficients, Some(&other), &mut vec![0.0; need]),
        Err(CheckError::Size)
    );
    // A surface that covers no inlier.
    let nowhere = f32::NAN.to_ne_bytes().repeat(160 * 160);
    let nowhere = DepthMap::new(&nowhere, 160, 160, 4 * 160, 1.0).unwrap();
    let found =
        check(&image, &solution.inliers, &orientation, &coefficients, Some(&nowhere), &mut vec![0.0; need]);
    assert_eq!(found.unwrap().depth, Some(DepthCheck::default()));
    assert_eq!(run(&orientation, need, true), Ok(()));
    assert_eq!(run(&orientation, need - 1, true), Err(CheckError::WorkspaceTooShort));
    assert_eq!(run(&orientation, need, false), Err(CheckError::NoInliers));
    assert_eq!(run(&Orientation { rank: 2, ..orientation }, need, true), Err(CheckError::Orientation));
    assert_eq!(
        run(&Orientation { f: [[f64::NAN; 3]; 3], ..orientation }, need, true),
        Err(CheckError::Orientation)
    );
}
