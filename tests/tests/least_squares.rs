//! Least squares in place of least median of squares.

use ofc_core::color::ellipsoid::quadratic_form;
use ofc_core::color::lmeds::{self, FitError, Method, Params};
use ofc_core::picture::Usable;
use ofc_core::solve;
use ofc_tests::photographs;
use ofc_tests::shaded_scenes::{CLEAN, Scene, lopsided};
use ofc_tests::solved::{median_error, solved, with_truth};

fn fit(scene: &Scene, method: Method) -> Result<lmeds::Fit, FitError> {
    let params = Params { method, ..Params::default() };
    let mut workspace = vec![f32::NAN; lmeds::workspace_len(scene.width * scene.height, params.sample_size)];
    lmeds::fit(&scene.image(), Usable::below(f32::INFINITY), &params, &mut workspace)
}

/// Least squares for M z = 1 by Gauss-Jordan elimination of the normal equations: an oracle.
fn oracle(colors: &[[f64; 3]]) -> [f64; 6] {
    let mut system = [[0.0; 7]; 6];
    for &color in colors {
        let [r, g, b] = color.map(|value| value / 256.0);
        let row = [r * r, g * g, b * b, 2.0 * r * g, 2.0 * r * b, 2.0 * g * b];
        for (i, equation) in system.iter_mut().enumerate() {
            for (entry, value) in equation.iter_mut().zip(row.iter().chain(&[1.0])) {
                *entry += row[i] * value;
            }
        }
    }
    for i in 0..6 {
        let pivot = (i..6).max_by(|&a, &b| system[a][i].abs().total_cmp(&system[b][i].abs())).unwrap();
        system.swap(i, pivot);
        let equation = system[i].map(|entry| entry / system[i][i]);
        for (j, other) in system.iter_mut().enumerate() {
            if j == i {
                *other = equation;
            } else {
                let factor = other[i];
                for (entry, own) in other.iter_mut().zip(equation) {
                    *entry -= factor * own;
                }
            }
        }
    }
    system.map(|equation| equation[6] / 65536.0)
}

#[test]
fn all_pixels_count() {
    let scene = Scene::new(96, 96, &CLEAN, lopsided(48.0)).with_noise(1.0, 2);
    let colors: Vec<[f64; 3]> = scene
        .colors
        .iter()
        .zip(&scene.mask)
        .filter(|&(_, &mask)| mask > 0)
        .map(|(color, _)| color.map(|value| f64::from(value as f32)))
        .collect();
    let found = fit(&scene, Method::LeastSquares).unwrap();
    assert_eq!((found.inliers, found.usable, found.subsets), (colors.len(), colors.len(), 0));
    for ((got, robust), want) in found.z().iter().zip(found.robust).zip(oracle(&colors)) {
        assert!((got - want).abs() < 1e-6 * want.abs().max(1e-6), "{got} {want}");
        assert!((got - robust).abs() < 1e-12);
    }
    let mut residuals: Vec<f64> = colors
        .iter()
        .map(|c| (quadratic_form(&found.z(), c[0] as f32, c[1] as f32, c[2] as f32) - 1.0).abs())
        .collect();
    residuals.sort_by(f64::total_cmp);
    assert!((residuals[residuals.len() / 2] - found.median_residual).abs() < 1e-6);
    assert!(found.dispersion > found.median_residual);
    assert!(found.band.low < -1e300 && found.band.high > 1e300);
}

#[test]
fn outliers_pull_it_and_not_the_other() {
    let scene = Scene::new(96, 96, &CLEAN, lopsided(48.0));
    let bright = CLEAN.map(|(angles, color)| (angles, color.map(|value| 1.5 * value)));
    let spot = |x: f64, y: f64| if x > 12.0 { lopsided(48.0)(x, y) } else { None };
    let spoiled = scene.behind(&Scene::new(96, 96, &bright, spot));
    let error = |method| {
        let clean = fit(&Scene::new(96, 96, &CLEAN, lopsided(48.0)), Method::LeastSquares).unwrap().z();
        let found = fit(&spoiled, method).unwrap().z();
        clean.iter().zip(found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / clean[0]
    };
    assert!(error(Method::LeastMedian) < 1e-3);
    assert!(error(Method::LeastSquares) > 0.1);
}

#[test]
fn degenerate_colors_are_refused_alike() {
    let scene = Scene::new(48, 48, &CLEAN[..2], lopsided(24.0));
    assert!(matches!(fit(&scene, Method::LeastSquares), Err(FitError::RankDeficient { .. })));
}

#[test]
fn photometric_stereo_with_unknown_lights() {
    let Some(photo) = photographs::load("cat_figurine") else { return };
    let image = photo.image();
    for (method, limit) in [(Method::LeastMedian, 4.4), (Method::LeastSquares, 8.5)] {
        let params =
            solve::Params { lmeds: Params { method, ..Params::default() }, ..solve::Params::default() };
        let solution = solved(&image, &params);
        let f_inverse = solution.choice.as_ref().expect("an F").orientation.f_inverse;
        let pixels = with_truth(&image, solution.inliers.selector(), &photo.normals);
        let error = median_error(&pixels, f_inverse);
        println!("cat, {method:?}: {} inliers, median error {error:.2} degrees", solution.inlier_count);
        assert!(error < limit, "{method:?}: {error}");
    }
}
