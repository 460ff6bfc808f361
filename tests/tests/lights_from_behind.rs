//! A light from behind the plane of the picture, which reaches a surface that is turned away from the camera far enough.

use ofc_core::solve::{OrientationMethod, Outcome, Params, SlantSource};
use ofc_tests::linear::degrees_between;
use ofc_tests::shaded_scenes::{Light, Scene, lopsided, median_error};
use ofc_tests::solved::solved;
use std::f64::consts::FRAC_PI_2;

/// Degrees that a slant, and the median normal, may be off; over seeds of the noise and channels the scenes below leave at most 1.0.
const CLOSE: f64 = 1.5;

/// The light of one channel shines from the right at this slant, those of the others from above and below.
fn lights(slant: f64, channel: usize) -> [Light; 3] {
    let mut lights = [0, 1, 2].map(|i| {
        let mut color = [15.0; 3];
        color[i] = 150.0;
        ([30.0, 90.0], color)
    });
    lights[channel].0 = [slant, 0.0];
    lights[(channel + 1) % 3].0[1] = -90.0;
    lights
}

/// A dome with hollows, and a bump; both lean to the right, so that all three lights reach nearly all of them.
fn hollows(x: f64, y: f64) -> Option<f64> {
    let dome = -(x * x + 1.5 * y * y) / 200.0 + 2.0 * (x / 9.0).sin() * (y / 11.0).cos();
    (x * x + y * y < 3600.0).then_some(1.5 * dome - 0.4 * x)
}

fn bump(x: f64, y: f64) -> Option<f64> {
    lopsided(64.0)(x, y).map(|z| 1.5 * z - 0.4 * x)
}

fn scene(lights: &[Light], depth: impl Fn(f64, f64) -> Option<f64>) -> Scene {
    Scene::new(128, 128, lights, depth).with_noise(0.3, 1)
}

/// Solves the picture jointly, and asserts that the slants are those of the true F; which of them are above 90 degrees.
fn flags(scene: &Scene) -> [bool; 3] {
    let solution = solved(&scene.image(), &Params::default());
    assert_eq!(solution.outcome, Outcome::Solved);
    let choice = solution.choice.expect("slants");
    assert_eq!(choice.source, SlantSource::Joint);
    let truth = scene.f.map(|row| degrees_between(row, [0.0, 0.0, 1.0]));
    let error = median_error(scene, &choice.orientation.f_inverse);
    println!("slants {:.2?}, true {truth:.2?}, {error:.2} deg", choice.slants.map(f64::to_degrees));
    for (slant, truth) in choice.slants.iter().zip(truth) {
        assert!((slant.to_degrees() - truth).abs() < CLOSE);
    }
    assert!(error < CLOSE);
    assert_eq!(choice.lights_from_behind(), truth.map(|slant| slant > 90.0));
    choice.lights_from_behind()
}

#[test]
fn the_joint_method_finds_and_flags_a_light_from_behind() {
    for channel in 0..3 {
        let mut expected = [false; 3];
        expected[channel] = true;
        assert_eq!(flags(&scene(&lights(110.0, channel), hollows)), expected);
        assert_eq!(flags(&scene(&lights(105.0, channel), bump)), expected);
    }
}

#[test]
fn a_light_beside_the_surface_is_not_flagged() {
    for channel in 0..3 {
        // The channel mixes its light with the others, so the slant of its row is below 90 degrees.
        assert_eq!(flags(&scene(&lights(85.0, channel), hollows)), [false; 3]);
    }
}

/// The paper's slants end at 90 degrees: the direct method cannot find this light, and does not claim to.
#[test]
fn the_direct_method_has_no_lights_from_behind() {
    let params = Params { orientation_method: OrientationMethod::Direct, ..Params::default() };
    let scene = scene(&lights(110.0, 0), hollows);
    let choice = solved(&scene.image(), &params).choice.expect("slants");
    assert!(choice.slants.iter().all(|&slant| slant <= FRAC_PI_2), "{:?}", choice.slants);
    assert_eq!(choice.lights_from_behind(), [false; 3]);
}
