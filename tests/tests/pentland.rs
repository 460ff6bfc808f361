//! Pentland's tilt against explicit loops over pixels, and on surfaces where the answer is known.

use ofc_core::light::tilt::Tilts;
use ofc_core::light::tilt::pentland::{MAX_STEP, tilts, tilts_along};
use ofc_core::math::rng::Rng;
use ofc_tests::linear::eliminate;
use ofc_tests::linear_scenes::{Scene, sphere, three_lights};
use ofc_tests::tolerances::{REORDERED_SUM, SYMMETRIC_TILT};
use std::f64::consts::{FRAC_PI_2, PI};

/// The axes and the diagonals.
const FOUR: [[i32; 2]; 4] = [[1, 0], [0, 1], [1, 1], [-1, 1]];

/// Eqs. 20-21 by definition: (dx, dy) steps with y up, mean differences, and a regression over the directions.
fn oracle(scene: &Scene, mask: &[u8], steps: &[[i32; 2]]) -> Option<[[f64; 2]; 3]> {
    let (width, height) = (scene.width.cast_signed(), scene.height.cast_signed());
    let inside = |x: isize, y: isize| {
        let within = (0..width).contains(&x) && (0..height).contains(&y);
        within.then(|| (y * width + x).cast_unsigned()).filter(|&i| mask[i] != 0)
    };
    let mut gradients = [[0.0; 2]; 3];
    for (channel, gradient) in gradients.iter_mut().enumerate() {
        let (mut normal, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
        for [dx, dy] in steps.iter().map(|step| step.map(|pixels| pixels as isize)) {
            let length = (dx as f64).hypot(dy as f64);
            let (mut sum, mut count) = (0.0, 0.0);
            for y in 0..height {
                for x in 0..width {
                    let (Some(from), Some(to)) = (inside(x, y), inside(x + dx, y - dy)) else { continue };
                    let value = |i: usize| f64::from(scene.colors[i][channel] as f32);
                    sum += (value(to) - value(from)) / length;
                    count += 1.0;
                }
            }
            if count == 0.0 {
                return None;
            }
            let s = [dx as f64 / length, dy as f64 / length];
            for i in 0..2 {
                right[i] += s[i] * sum / count;
                for j in 0..2 {
                    normal[i][j] += s[i] * s[j];
                }
            }
        }
        *gradient = eliminate(normal, right)?;
    }
    Some(gradients)
}

fn turn_between(a: f64, b: f64) -> f64 {
    let difference = (a - b).rem_euclid(2.0 * PI);
    difference.min(2.0 * PI - difference)
}

fn core(scene: &Scene, mask: &[u8]) -> Option<Tilts> {
    let encoded = scene.encode();
    let image = encoded.image().with_mask(mask, scene.width).expect("sizes agree");
    tilts(&image, |window| window.masked)
}

#[test]
fn explicit_loops_agree_on_every_width_around_the_window() {
    let mut rng = Rng::new(41);
    let mut without = 0;
    for width in [1, 2, 3, 31, 63, 64, 65, 126, 127, 128, 130] {
        for height in [1, 2, 5, 17] {
            for holes in [0, 3, 8] {
                let scene = Scene::paint(width, height, |x, y| {
                    [x as f64 + 3.0 * rng.unit(), y as f64 + 9.0 * rng.unit(), 255.0 * rng.unit()]
                });
                let mask: Vec<u8> = (0..width * height).map(|_| u8::from(rng.below(10) >= holes)).collect();
                let found = core(&scene, &mask);
                let Some(wanted) = oracle(&scene, &mask, &FOUR) else {
                    assert_eq!(found, None);
                    without += 1;
                    continue;
                };
                let found = found.expect("pairs in every direction");
                for ((tilt, [x, y]), [wanted_x, wanted_y]) in
                    found.tilts.iter().zip(found.gradients).zip(wanted)
                {
                    let tolerance = REORDERED_SUM * 255.0;
                    assert!((x - wanted_x).abs() <= tolerance && (y - wanted_y).abs() <= tolerance);
                    assert!((tilt - y.atan2(x)).abs() < REORDERED_SUM);
                }
            }
        }
    }
    assert!(without >= 16, "one-pixel rows and columns have no diagonals: {without}");
}

#[test]
fn any_set_of_directions_is_fitted() {
    let mut rng = Rng::new(43);
    let scene = Scene::paint(131, 40, |x, y| {
        [2.0 * x as f64 - y as f64 + 9.0 * rng.unit(), y as f64 * 3.0 + 9.0 * rng.unit(), 200.0 * rng.unit()]
    });
    let mask: Vec<u8> = (0..131 * 40).map(|_| u8::from(rng.below(10) >= 2)).collect();
    let encoded = scene.encode();
    let image = encoded.image().with_mask(&mask, scene.width).expect("sizes agree");
    let along = |steps: &[[i32; 2]]| tilts_along(&image, |window| window.masked, steps);
    let sets: [&[[i32; 2]]; 5] = [
        &FOUR,
        &[[1, 0], [0, 1]],
        &[[2, 1], [-1, 3], [5, 0]],
        &[[-1, -2], [3, -1], [0, -4], [-7, 2], [-3, 0]],
        &[[70, 1], [1, 20]],
    ];
    for steps in sets {
        let found = along(steps).expect("pairs along every step");
        let wanted = oracle(&scene, &mask, steps).expect("pairs along every step");
        for ((tilt, gradient), wanted) in found.tilts.iter().zip(found.gradients).zip(wanted) {
            for (got, wanted) in gradient.into_iter().zip(wanted) {
                assert!((got - wanted).abs() <= REORDERED_SUM * 255.0, "{steps:?}: {got} {wanted}");
            }
            assert!((tilt - gradient[1].atan2(gradient[0])).abs() < REORDERED_SUM);
        }
    }
    // Parallel, no step, too long a step, longer than the picture.
    for none in [
        &[[1, 2], [-2, -4]][..],
        &[[1, 0]],
        &[],
        &[[0, 0], [1, 0]],
        &[[MAX_STEP + 1, 0], [0, 1]],
        // It has no absolute value.
        &[[i32::MIN, 0], [0, 1]],
        &[[1, 0], [0, i32::MIN]],
        &[[1, 0], [0, 40]],
    ] {
        assert_eq!(along(none), None, "{none:?}");
    }
}

#[test]
fn on_a_sphere_the_tilt_is_the_light_s() {
    for size in [41, 64, 97] {
        let f = three_lights();
        let radius = 0.48 * size as f64;
        let scene = Scene::render(size, size, f, sphere(radius * 1.4, 44.0));
        let mask: Vec<u8> = scene.normals.iter().map(|n| u8::from(n[2] > 0.0)).collect();
        let found = core(&scene, &mask).expect("tilts");
        for (tilt, row) in found.tilts.iter().zip(f) {
            assert!(turn_between(*tilt, row[1].atan2(row[0])) < SYMMETRIC_TILT, "{tilt} {row:?}");
        }
    }
}

#[test]
fn tilts_turn_with_the_picture() {
    let mut rng = Rng::new(42);
    let mut scene = Scene::paint(71, 50, |x, y| {
        [x as f64 + 9.0 * rng.unit(), 50.0 - y as f64 + 9.0 * rng.unit(), (2 * y + x) as f64 + rng.unit()]
    });
    let whole = vec![1; 71 * 50];
    let start = core(&scene, &whole).expect("tilts");
    for turns in 1..=4 {
        scene = scene.turned();
        let turned = core(&scene, &whole).expect("tilts");
        for (tilt, before) in turned.tilts.iter().zip(start.tilts) {
            assert!(turn_between(*tilt, before + f64::from(turns) * FRAC_PI_2) < REORDERED_SUM);
        }
    }
}

#[test]
fn a_flat_channel_has_no_tilt() {
    let scene = Scene::paint(20, 20, |x, y| [x as f64, y as f64, 7.0]);
    assert_eq!(core(&scene, &[1; 400]), None);
}
