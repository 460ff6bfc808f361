//! The methods to the orthogonal transformation: the same minimum, the twin, the choice between them.

use ofc_core::color::ellipsoid;
use ofc_core::color::lmeds;
use ofc_core::math::mat3::{Mat3, dot};
use ofc_core::orientation::integrability;
use ofc_core::orientation::matrix::compose;
use ofc_core::orientation::orthogonal::annealing::{self, Params, annealing};
use ofc_core::orientation::orthogonal::closed_form::closed_form;
use ofc_core::orientation::orthogonal::{Found, OrthogonalError, TwinChoice};
use ofc_core::picture::{Usable, Window};
use ofc_core::solve;
use ofc_tests::photographs;
use ofc_tests::shaded_scenes::{CLEAN, Light, Matrix, PAPER, Scene, cap, lopsided, median_error};
use ofc_tests::solved::{self, solved, with_truth};
use std::f64::consts::PI;

/// The integral of pictures in f32 that are exact otherwise: the square of their rounding.
const ROUNDING: f64 = 1e-12;

fn inliers(scene: &Scene) -> impl Fn(&Window) -> u64 {
    let usable = Usable::below(scene.image().sample().saturation());
    move |window| usable.bits(window)
}

/// The root of C from the regression.
fn fitted_root(scene: &Scene) -> Mat3 {
    let image = scene.image();
    let params = lmeds::Params::default();
    let mut workspace = vec![0.0; lmeds::workspace_len(scene.width * scene.height, params.sample_size)];
    let usable = Usable::below(image.sample().saturation());
    let fit = lmeds::fit(&image, usable, &params, &mut workspace).expect("a fit");
    ellipsoid::decompose(&fit.z()).expect("an ellipsoid").root
}

fn scratch(scene: &Scene, params: &Params) -> Vec<f32> {
    vec![f32::NAN; annealing::workspace_len(scene.width * scene.height, params.sample_cells)]
}

fn anneal(scene: &Scene, root: &Mat3, tilts: Option<[f64; 3]>, params: &Params) -> Found {
    annealing(&scene.image(), inliers(scene), root, tilts, params, &mut scratch(scene, params))
        .expect("a minimum")
}

/// The mean of (15) for the normals of `g`, from the picture's own colors, over cells inside the mask: an oracle.
fn integral(scene: &Scene, g: &Matrix) -> f64 {
    let slope = |at: usize| {
        let n = g.map(|row| dot(row, scene.colors[at]));
        (-n[0] / n[2].max(0.05), -n[1] / n[2].max(0.05))
    };
    let (mut sum, mut count) = (0.0, 0.0);
    for y in 0..scene.height - 1 {
        for x in 0..scene.width - 1 {
            let nw = y * scene.width + x;
            let (ne, sw, se) = (nw + 1, nw + scene.width, nw + scene.width + 1);
            if [nw, ne, sw, se].iter().all(|&i| scene.mask[i] > 0) {
                let [nw, ne, sw, se] = [nw, ne, sw, se].map(slope);
                let p_y = 0.5 * (nw.0 + ne.0 - sw.0 - se.0);
                let q_x = 0.5 * (ne.1 + se.1 - nw.1 - sw.1);
                sum += (p_y - q_x) * (p_y - q_x);
                count += 1.0;
            }
        }
    }
    sum / count
}

fn scenes() -> Vec<(&'static str, Scene)> {
    let with = |lights: &[Light], size: usize, lop: bool| {
        if lop {
            Scene::new(size, size, lights, lopsided(size as f64 / 2.0))
        } else {
            Scene::new(size, size, lights, cap(size as f64, size as f64 / 2.1))
        }
    };
    vec![
        ("cap, clean lights", with(&CLEAN, 96, false)),
        ("cap, the paper's lights", with(&PAPER, 96, false)),
        ("lopsided, clean lights", with(&CLEAN, 96, true)),
        ("lopsided, the paper's lights", with(&PAPER, 96, true)),
    ]
}

fn assert_orthogonal(rows: &Mat3) {
    for (i, a) in rows.iter().enumerate() {
        for (j, b) in rows.iter().enumerate() {
            let wanted = if i == j { 1.0 } else { 0.0 };
            assert!((dot(*a, *b) - wanted).abs() < 1e-12);
        }
    }
}

#[test]
fn all_methods_lead_to_the_same_integral_without_noise() {
    for (name, scene) in scenes() {
        let root = fitted_root(&scene);
        let annealed = anneal(&scene, &root, None, &Params::default());
        let closed = closed_form(&scene.image(), inliers(&scene), &root, None, 60).unwrap();
        for (orientation_method, found) in [("annealing", &annealed), ("closed form", &closed)] {
            println!(
                "{name}, {orientation_method}: integral {:.4e} (unpolished {:.4e}), median error {:.3} deg, clarity {:.2}, {} evaluations",
                found.integral.mean,
                found.unpolished.mean,
                median_error(&scene, &found.transformation.f_inverse),
                found.clarity,
                found.evaluations,
            );
            assert_orthogonal(&found.transformation.rows);
            // The integral is the oracle's, and the twin has the same.
            let naive = integral(&scene, &found.transformation.f_inverse);
            assert!((found.integral.mean - naive).abs() < 1e-3 * naive + ROUNDING);
            assert!((integral(&scene, &found.twin.f_inverse) - naive).abs() < 1e-9 * naive);
            // One minimum: a discretisation error wide, so 1 % of it is far below a hundredth of a degree.
            let difference = (found.integral.mean - annealed.integral.mean).abs();
            assert!(difference < 0.01 * annealed.integral.mean + ROUNDING, "{name}, {orientation_method}");
            // These are domes, so the convex twin is the truth.
            assert_eq!(found.choice, TwinChoice::Convex);
            assert!(
                median_error(&scene, &found.transformation.f_inverse) < 0.5,
                "{name}, {orientation_method}"
            );
            assert!(median_error(&scene, &found.twin.f_inverse) > 10.0);
            assert!(found.transformation.slants.iter().all(|&slant| slant <= PI / 2.0));
        }
    }
}

#[test]
fn tilts_choose_between_the_twins() {
    let scene = Scene::new(80, 80, &CLEAN, lopsided(40.0));
    let root = fitted_root(&scene);
    let tilts = scene.f.map(|[x, y, _]| y.atan2(x));
    let away = tilts.map(|tilt| tilt + PI);
    for orientation_method in 0..2 {
        let find = |tilts| match orientation_method {
            0 => anneal(&scene, &root, Some(tilts), &Params::default()),
            _ => closed_form(&scene.image(), inliers(&scene), &root, Some(tilts), 60).unwrap(),
        };
        let (right, wrong) = (find(tilts), find(away));
        assert_eq!(right.choice, TwinChoice::Tilts);
        assert!(right.clarity > 0.99);
        assert!(median_error(&scene, &right.transformation.f_inverse) < 0.5);
        for (found, wanted) in right.transformation.tilts.iter().zip(tilts) {
            assert!((found - wanted).cos() > 0.999 || (found - wanted).abs() < 0.02);
        }
        assert_eq!((right.transformation, right.twin), (wrong.twin, wrong.transformation));
    }
}

#[test]
fn reflected_roots_are_no_obstacle() {
    // Half of O(3) cannot be reached by rotations from a given root.
    let scene = Scene::new(80, 80, &PAPER, lopsided(40.0));
    let root = fitted_root(&scene);
    let [a, b, c] = root;
    let mirrored = [a.map(|x| -x), b, c];
    for root in [root, mirrored] {
        for found in [
            anneal(&scene, &root, None, &Params::default()),
            closed_form(&scene.image(), inliers(&scene), &root, None, 60).unwrap(),
        ] {
            assert!(median_error(&scene, &found.transformation.f_inverse) < 0.5);
        }
    }
}

/// On a surface that is symmetric on the whole the axes of smoothness are those of the picture, and the closed form needs no polish.
#[test]
fn the_bare_closed_form_is_exact_on_symmetric_surfaces() {
    let dome = |x: f64, y: f64| (x * x + 2.0 * y * y <= 1936.0).then(|| -0.004 * x * x - 0.006 * y * y);
    for (name, lights) in [("clean", &CLEAN), ("the paper's", &PAPER)] {
        for (shape, scene) in
            [("cap", Scene::new(96, 96, lights, cap(96.0, 44.0))), ("dome", Scene::new(96, 96, lights, dome))]
        {
            let root = fitted_root(&scene);
            let bare = closed_form(&scene.image(), inliers(&scene), &root, None, 0).expect("cells");
            let error = median_error(&scene, &bare.transformation.f_inverse);
            println!("{shape}, {name} lights: {error:.4} degrees, clarity {:.3}", bare.clarity);
            assert!(error < 0.1, "{shape}, {name}: {error}");
            assert_eq!((bare.integral, bare.evaluations), (bare.unpolished, 2));
            // F is that of its rows, slants and tilts.
            let found = bare.transformation;
            let norms = found.f.map(|row| dot(row, row).sqrt());
            let composed = compose(norms, found.slants, found.tilts);
            for (a, b) in composed.as_flattened().iter().zip(found.f.as_flattened()) {
                assert!((a - b).abs() < 1e-9 * norms[0], "{composed:?} {:?}", found.f);
            }
        }
    }
}

/// At a high temperature everything is accepted, and a chain of small steps wanders off; at a low one it goes downhill only. The
/// best of a wanderer is no minimum.
#[test]
fn the_temperature_decides_how_far_uphill_a_chain_goes() {
    let scene = Scene::new(64, 64, &CLEAN, lopsided(32.0));
    let root = fitted_root(&scene);
    let integral = |temperature: f64, seed| {
        let params = Params {
            proposals: 400,
            chains: 1,
            temperatures: [temperature; 2],
            angles: [0.1; 2],
            polish_evaluations: 0,
            seed,
            ..Params::default()
        };
        anneal(&scene, &root, None, &params).integral.mean
    };
    let mut ratios: Vec<f64> = (0..9).map(|seed| integral(1e6, seed) / integral(1e-6, seed)).collect();
    ratios.sort_by(f64::total_cmp);
    println!("hot over cold: {ratios:.2?}");
    assert!(ratios[0] > 2.0 && ratios[4] > 100.0, "{ratios:.2?}");
}

#[test]
fn noise_moves_the_answer_a_little() {
    for seed in 0..3 {
        let scene = Scene::new(128, 128, &CLEAN, lopsided(64.0)).with_noise(0.5, seed).quantized();
        let root = fitted_root(&scene);
        let annealed = anneal(&scene, &root, None, &Params::default());
        let closed = closed_form(&scene.image(), inliers(&scene), &root, None, 60).unwrap();
        for (orientation_method, found) in [("annealing", &annealed), ("closed form", &closed)] {
            let error = median_error(&scene, &found.transformation.f_inverse);
            println!(
                "noise, {orientation_method}: integral {:.4e} (unpolished {:.4e}), median error {error:.3} deg",
                found.integral.mean, found.unpolished.mean,
            );
            assert!(error < 1.1, "seed {seed}, {orientation_method}: {error}");
        }
        assert!((closed.integral.mean / annealed.integral.mean - 1.0).abs() < 0.01);
    }
}

/// The methods need no tilts; with those of the joint method to choose between the twins they are measured beside it. Limits are
/// what was measured, and 0.2 degrees: of annealing, the bare closed form, and the polished one.
#[test]
fn photographs_by_every_method() {
    for (name, limits) in [
        ("gelsight_ball_6mm", [4.1, 6.4, 4.1]),
        ("gelsight_ball_9mm", [8.4, 14.5, 8.4]),
        ("cat_figurine", [5.4, 12.6, 5.4]),
    ] {
        let Some(photo) = photographs::load(name) else { return };
        let image = photo.image();
        let solution = solved(&image, &solve::Params::default());
        let bits = |window: &Window| solution.inliers.bits(window);
        let root = solution.ellipsoid.expect("an ellipsoid").root;
        let tilts = solution.tilts.map(|tilts| tilts.tilts);
        let joint = solution.choice.as_ref().expect("slants").orientation.f_inverse;
        let pixels = with_truth(&image, bits, &photo.normals);
        let error = |f_inverse: &Mat3| solved::median_error(&pixels, *f_inverse);
        let integral = integrability::integral(&image, bits, &joint).expect("cells").mean;
        println!("{name}: joint {:.2} deg, integral {integral:.3e}", error(&joint));
        let params = Params::default();
        let mut cells = vec![0.0; annealing::workspace_len(photo.width * photo.height, params.sample_cells)];
        let annealed = annealing(&image, bits, &root, tilts, &params, &mut cells).expect("a minimum");
        let bare = closed_form(&image, bits, &root, tilts, 0).expect("a minimum");
        let closed = closed_form(&image, bits, &root, tilts, 60).expect("a minimum");
        for ((orientation_method, found), limit) in
            [("annealing", annealed), ("closed form, bare", bare), ("closed form", closed)]
                .into_iter()
                .zip(limits)
        {
            let (ours, twin) = (error(&found.transformation.f_inverse), error(&found.twin.f_inverse));
            println!(
                "  {orientation_method}: {ours:.2} deg, integral {:.3e}, clarity {:.2}, twin {twin:.2} deg",
                found.integral.mean, found.clarity,
            );
            assert!(ours < limit, "{name}, {orientation_method}: {ours}");
            assert!(ours < twin && found.integral.cells > 100);
        }
        // Both look for the minimum of this integral; the joint method does not.
        assert!(annealed.integral.mean <= 1.001 * closed.integral.mean.min(integral));
    }
}

#[test]
fn the_seed_fixes_the_bits_and_dirt_does_not_matter() {
    let scene = Scene::new(64, 48, &CLEAN, lopsided(24.0)).with_noise(1.0, 5);
    let root = fitted_root(&scene);
    let params = Params { seed: 7, proposals: 500, chains: 2, ..Params::default() };
    let first = anneal(&scene, &root, None, &params);
    let mut dirty = vec![3.5e30; 10 + annealing::workspace_len(64 * 48, params.sample_cells)];
    let again = annealing(&scene.image(), inliers(&scene), &root, None, &params, &mut dirty).unwrap();
    assert_eq!(first, again);
    let used = annealing::workspace_len(64 * 48, params.sample_cells);
    assert!(dirty[used..].iter().all(|&value| value == 3.5e30));
}

#[test]
fn bad_input_is_refused() {
    let scene = Scene::new(32, 32, &CLEAN, cap(32.0, 15.0));
    let root = fitted_root(&scene);
    let params = Params::default();
    let run = |root: &Mat3, tilts, params: &Params, len| {
        annealing(&scene.image(), inliers(&scene), root, tilts, params, &mut vec![0.0; len]).map(|_| ())
    };
    let need = annealing::workspace_len(32 * 32, params.sample_cells);
    assert_eq!(run(&root, None, &params, need), Ok(()));
    assert_eq!(run(&root, None, &params, need - 1), Err(OrthogonalError::WorkspaceTooShort));
    assert_eq!(run(&root, Some([0.0, f64::NAN, 0.0]), &params, need), Err(OrthogonalError::Params));
    assert_eq!(run(&[[0.0; 3]; 3], None, &params, need), Err(OrthogonalError::SingularRoot));
    assert_eq!(run(&[[f64::NAN; 3]; 3], None, &params, need), Err(OrthogonalError::SingularRoot));
    for bad in [
        Params { proposals: 0, ..params },
        Params { chains: 0, ..params },
        Params { chains: 4001, ..params },
        Params { sample_cells: 0, ..params },
        Params { temperatures: [0.0, 1.0], ..params },
        Params { angles: [1.0, f64::INFINITY], ..params },
    ] {
        assert_eq!(run(&root, None, &bad, need), Err(OrthogonalError::Params));
    }
    let nothing = |_: &Window| 0;
    let image = scene.image();
    let mut workspace = vec![0.0; need];
    assert_eq!(
        annealing(&image, nothing, &root, None, &params, &mut workspace),
        Err(OrthogonalError::NoCells)
    );
    assert_eq!(closed_form(&image, nothing, &root, None, 60), Err(OrthogonalError::NoCells));
    // A plane: the normals do not vary.
    let plane = Scene::new(32, 32, &CLEAN, |x, y| Some(0.1 * x + 0.2 * y));
    let flat = vec![plane.colors[500]; 1024];
    let bytes: Vec<u8> = flat.iter().flatten().flat_map(|v| (*v as f32).to_ne_bytes()).collect();
    let image = ofc_core::picture::Image::interleaved(
        &bytes,
        32,
        32,
        32 * 12,
        ofc_core::picture::Sample::F32,
        ofc_core::picture::Order::Rgb,
    )
    .unwrap();
    assert_eq!(closed_form(&image, |w| w.masked, &root, None, 60), Err(OrthogonalError::NoCells));
}
