//! Slants by integrability when the tilts are given.

use ofc_core::light::constrained_slant::{least_squares, residual_rms, roots};
use ofc_core::math::mat3::svd;
use ofc_core::orientation::integrability;
use ofc_core::orientation::matrix::{Orientation, compose};
use ofc_core::orientation::orthogonal::OrthogonalError;
use ofc_core::orientation::orthogonal::tilts_given::{Params, tilts_given, workspace_len};
use ofc_core::picture::{Usable, Window};
use ofc_core::solve;
use ofc_tests::photographs;
use ofc_tests::shaded_scenes::{CLEAN, Matrix, PAPER, Scene, cap, dot, lopsided, median_error};
use ofc_tests::solved::{self, solved, with_truth};
use std::f64::consts::FRAC_PI_2;

fn inliers(window: &Window) -> u64 {
    Usable::below(f32::INFINITY).bits(window)
}

/// Norms, cosines and tilts of the rows of F.
fn rows(f: &Matrix) -> ([f64; 3], [f64; 3], [f64; 3]) {
    let norms = f.map(|row| dot(row, row).sqrt());
    let cosine = |i: usize, j: usize| dot(f[i], f[j]) / (norms[i] * norms[j]);
    (norms, [cosine(0, 1), cosine(0, 2), cosine(1, 2)], f.map(|[x, y, _]| y.atan2(x)))
}

#[test]
fn true_tilts_lead_to_the_true_slants() {
    for (lights, size) in [(&CLEAN, 80), (&PAPER, 96)] {
        let scene = Scene::new(size, size, lights, lopsided(size as f64 / 2.0));
        let (norms, cosines, tilts) = rows(&scene.f);
        let mut workspace = vec![f32::NAN; workspace_len(size * size, 2000)];
        let found =
            tilts_given(&scene.image(), inliers, norms, cosines, tilts, &Params::default(), &mut workspace)
                .unwrap();
        for ((slant, row), norm) in found.slants.iter().zip(scene.f).zip(norms) {
            let truth = (row[2] / norm).acos();
            assert!((slant - truth).abs() < 0.5_f64.to_radians(), "{slant} {truth}");
        }
        assert!(found.residual_rms <= found.residual_limit + 1e-9);
    }
}

#[test]
fn without_a_root_it_is_more_integrable_than_least_squares_and_flat_without_a_limit() {
    let scene = Scene::new(96, 96, &CLEAN, lopsided(48.0)).with_noise(0.5, 3);
    let (norms, cosines, tilts) = rows(&scene.f);
    let mut tested = 0;
    for turn in -40..40 {
        let wrong = [tilts[0], tilts[1] + 0.05 * f64::from(turn), tilts[2]];
        if !roots(wrong, cosines).is_empty() {
            continue;
        }
        tested += 1;
        let nearest = least_squares(wrong, cosines);
        let mut workspace = vec![0.0; workspace_len(96 * 96, 2000)];
        let mut run = |slack| {
            let params = Params { slack, ..Params::default() };
            tilts_given(&scene.image(), inliers, norms, cosines, wrong, &params, &mut workspace).unwrap()
        };
        let found = run(0.05);
        let error =
            |slants| median_error(&scene, &Orientation::new(compose(norms, slants, wrong), 0.0).f_inverse);
        if tested % 6 == 1 {
            println!(
                "turn {turn}: least squares rms {:.3} error {:.2} deg; integrability rms {:.3} error {:.2} deg",
                nearest.residual_rms,
                error(nearest.slants),
                found.residual_rms,
                error(found.slants)
            );
        }
        assert!(found.residual_rms <= nearest.residual_rms + 0.05 + 1e-9);
        let tight = run(0.0);
        assert!((residual_rms(wrong, cosines, tight.slants) - nearest.residual_rms).abs() < 1e-6);
        assert!(found.integral.mean <= tight.integral.mean);
        // The negative control of the limit: without it the surface is flattened.
        let free = run(f64::INFINITY);
        assert!(free.integral.mean < found.integral.mean);
    }
    assert!(tested > 3, "{tested}");
}

/// Wrong tilts on real photographs: what is found is more integrable than least squares, and without a limit it is flat.
#[test]
fn on_photographs_the_limit_keeps_the_surface_from_flattening() {
    for name in ["gelsight_ball_6mm", "gelsight_ball_9mm", "cat_figurine"] {
        let Some(photo) = photographs::load(name) else { return };
        let image = photo.image();
        let params = solve::Params {
            orientation_method: solve::OrientationMethod::Direct,
            ..solve::Params::default()
        };
        let solution = solved(&image, &params);
        let (Some(ellipsoid), Some(tilts)) = (solution.ellipsoid, solution.tilts) else {
            panic!("{name}: no tilts")
        };
        let pixels = with_truth(&image, solution.inliers.selector(), &photo.normals);
        let mut workspace = vec![0.0; workspace_len(photo.width * photo.height, 2000)];
        let error = |slants, tilts| {
            let f = Orientation::new(compose(ellipsoid.norms, slants, tilts), 1e-6);
            solved::median_error(&pixels, f.f_inverse)
        };
        for turn in [0.1, 0.2, 0.35, 0.5, 0.7] {
            for sign in [1.0, -1.0] {
                let wrong = [tilts.tilts[0] + sign * turn, tilts.tilts[1] - sign * turn, tilts.tilts[2]];
                if !roots(wrong, ellipsoid.cosines).is_empty() {
                    continue;
                }
                let nearest = least_squares(wrong, ellipsoid.cosines);
                print!("{name} {:+.2}: least squares {:.2} deg", sign * turn, error(nearest.slants, wrong));
                let integral = |f: &Orientation| {
                    integrability::integral(&image, |w| solution.inliers.bits(w), &f.f_inverse).unwrap().mean
                };
                let mut errors = Vec::new();
                for slack in [0.02, 0.05, 0.1, f64::INFINITY] {
                    let found = tilts_given(
                        &image,
                        |window| solution.inliers.bits(window),
                        ellipsoid.norms,
                        ellipsoid.cosines,
                        wrong,
                        &Params { slack, sample_cells: 2000 },
                        &mut workspace,
                    )
                    .expect("slants");
                    errors.push(error(found.slants, wrong));
                    // Two lights on the axis are one: then there is no inverse to compare with.
                    let f = Orientation::new(compose(ellipsoid.norms, nearest.slants, wrong), 1e-6);
                    assert!(f.rank < 3 || found.integral.mean <= integral(&f) * (1.0 + 1e-6));
                }
                println!(", slack 0.02, 0.05, 0.1, infinite: {errors:.2?}");
                assert!(errors[3] > errors[1] + 5.0);
            }
        }
    }
}

#[test]
fn bad_input_is_refused() {
    let scene = Scene::new(32, 32, &CLEAN, cap(32.0, 15.0));
    let (norms, cosines, tilts) = rows(&scene.f);
    assert!(svd(&scene.f).values[2] > 1.0);
    let run = |norms, cosines, tilts, slack, len| {
        let params = Params { slack, ..Params::default() };
        tilts_given(&scene.image(), inliers, norms, cosines, tilts, &params, &mut vec![0.0; len]).map(|_| ())
    };
    let need = workspace_len(32 * 32, 2000);
    assert_eq!(run(norms, cosines, tilts, 0.05, need), Ok(()));
    assert_eq!(run(norms, cosines, tilts, 0.05, need - 1), Err(OrthogonalError::WorkspaceTooShort));
    for (norms, cosines, tilts, slack) in [
        ([0.0, 1.0, 1.0], cosines, tilts, 0.05),
        ([1.0, f64::NAN, 1.0], cosines, tilts, 0.05),
        (norms, [f64::NAN, 0.0, 0.0], tilts, 0.05),
        (norms, cosines, [0.0, f64::INFINITY, 0.0], 0.05),
        (norms, cosines, tilts, -0.1),
        (norms, cosines, tilts, f64::NAN),
    ] {
        assert_eq!(run(norms, cosines, tilts, slack, need), Err(OrthogonalError::Params));
    }
    let mut workspace = vec![0.0; need];
    let params = Params::default();
    let none = tilts_given(&scene.image(), |_| 0, norms, cosines, tilts, &params, &mut workspace);
    assert_eq!(none, Err(OrthogonalError::NoCells));
    // Angles that no tilts allow: the least-squares answer, if any, is in range.
    let found = tilts_given(&scene.image(), inliers, norms, [-1.0; 3], tilts, &params, &mut workspace);
    assert!(found.is_ok_and(|found| found.slants.iter().all(|slant| (0.0..=FRAC_PI_2).contains(slant))));
}
