//! Frames after the first answer: they refine it, follow slow changes, and notice when the scene is another.

use ofc_core::picture::{Order, Sample};
use ofc_core::solve::OrientationMethod;
use ofc_core::stream::{Change, Params, Pass};
use ofc_tests::bust::bust;
use ofc_tests::camera::{Camera, apart, digits, direct, portrait, whole};
use ofc_tests::linear::{degrees_between, length};
use ofc_tests::linear_scenes::{Layout, Scene, sphere, three_lights};
use ofc_tests::shaded_scenes;
use ofc_tests::tolerances::{SAMPLED_ANGLE, SAMPLED_STRENGTH};

/// A stream that has seen a portrait.
fn solved(params: Params) -> (Camera, shaded_scenes::Scene) {
    let scene = portrait(params.solve.orientation_method, 100);
    let mut camera = Camera::new(&scene.whole(), params);
    assert_eq!(camera.cold(&scene.whole()), Ok(Pass::Refine));
    assert_eq!(camera.state.drift(), None);
    (camera, scene)
}

fn refined(camera: &mut Camera, scene: &shaded_scenes::Scene) -> (f64, Change) {
    assert_eq!(camera.frame(&scene.whole()), Ok(Pass::Refine));
    let drift = camera.state.drift().unwrap();
    (drift.inlier_share, drift.change.unwrap())
}

#[test]
fn frames_of_the_same_scene_refine_the_model() {
    for params in [Params::default(), direct(Params::default())] {
        refine(params);
    }
}

fn refine(params: Params) {
    let (mut camera, _) = solved(params);
    println!(
        "against solve of the frame: angle, strength; against the frame before: share, angle, dispersion"
    );
    for seed in 101..109 {
        let scene = portrait(params.solve.orientation_method, seed);
        let before = camera.state.orientation().unwrap().f;
        let (share, change) = refined(&mut camera, &scene);
        let expected = whole(&scene.whole(), &params).choice.unwrap().orientation;
        let found = camera.state.orientation().unwrap();
        let (angle, strength) = apart(&found.f, &expected.f);
        let largest = change.angles.into_iter().fold(0.0, f64::max).to_degrees();
        println!(
            "{seed}: {angle:.2} deg, {strength:.4}; {share:.3}, {largest:.2} deg, {:.4}",
            change.dispersion
        );
        assert!(angle < SAMPLED_ANGLE && strength < SAMPLED_STRENGTH);
        assert!(share > 0.9 && largest < SAMPLED_ANGLE && (change.dispersion - 1.0).abs() < 0.05);
        // What is reported is what happened.
        for ((angle, strength), (&old, &new)) in
            change.angles.iter().zip(change.strengths).zip(before.iter().zip(&found.f))
        {
            assert!((angle.to_degrees() - degrees_between(old, new)).abs() < 1e-6);
            assert!((strength - length(new) / length(old)).abs() < 1e-12);
        }
    }
}

/// The first row that a warm frame looks at, which the surface reaches here, makes no pairs with one above it, whatever is left there
/// of the frame before.
#[test]
fn a_warm_frame_knows_nothing_of_what_its_memory_held() {
    let scene = Scene::render(110, 60, three_lights(), sphere(60.0, 36.0)).encode();
    let image = scene.image();
    for params in [direct(Params::default()), Params::default()] {
        let mut camera = Camera::new(&image, params);
        assert_eq!(camera.cold(&image), Ok(Pass::Refine));
        for _ in 0..5 {
            let mut other = Camera { state: camera.state.clone(), ..Camera::new(&image, params) };
            other.values.fill(1000.0);
            assert_eq!(camera.frame(&image), Ok(Pass::Refine));
            assert_eq!(other.frame(&image), Ok(Pass::Refine));
            assert_eq!(digits(other.state.solution()), digits(camera.state.solution()));
        }
    }
}

#[test]
fn warm_frames_look_at_as_many_pixels_as_wanted() {
    let mut seen = Vec::new();
    for refine_pixels in [0, 16_384, 1] {
        let (mut camera, _) = solved(Params { refine_pixels, ..Params::default() });
        refined(&mut camera, &portrait(OrientationMethod::Joint, 101));
        let pixel_counts = camera.state.solution().pixel_counts;
        seen.push(
            pixel_counts.usable
                + pixel_counts.masked_out
                + pixel_counts.non_finite
                + pixel_counts.dark
                + pixel_counts.saturated,
        );
    }
    // 29,000 usable pixels and a third of the others are more than twice 16,384; never less than 16 rows.
    assert_eq!(seen, [320 * 240, 320 * 80, 320 * 16]);
}

#[test]
fn noise_that_comes_and_goes() {
    let picture = |noise, seed| {
        shaded_scenes::Scene::new(320, 240, &shaded_scenes::CLEAN, bust(240.0))
            .with_noise(noise, seed)
            .quantized()
    };
    let first = picture(1.0, 0);
    let mut camera = Camera::new(&first.whole(), Params::default());
    assert_eq!(camera.cold(&first.whole()), Ok(Pass::Refine));
    let (mut dispersion, mut most) = (1.0, 0.0_f64);
    for (seed, noise) in [1.0, 2.0, 3.0, 3.0, 3.0, 2.0, 1.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
        let (share, change) = refined(&mut camera, &picture(noise, seed as u64 + 1));
        dispersion *= change.dispersion;
        most = most.max(dispersion);
        println!("{noise}: share {share:.3}, dispersion {:.3}, {dispersion:.3} in all", change.dispersion);
    }
    assert!(most > 1.5 && (dispersion - 1.0).abs() < 0.1);
    let last = whole(&picture(1.0, 10).whole(), &Params::default()).choice.unwrap().orientation;
    let (angle, strength) = apart(&camera.state.orientation().unwrap().f, &last.f);
    println!("against solve of the last frame: {angle:.2} deg, {strength:.4}");
    assert!(angle < SAMPLED_ANGLE && strength < SAMPLED_STRENGTH);
}

#[test]
fn lights_that_grow_stronger_are_followed() {
    let (mut camera, _) = solved(direct(Params::default()));
    let f = camera.state.orientation().unwrap().f;
    for frame in 1..=20_u32 {
        let gain = 1.0 + 0.02 * f64::from(frame);
        let lights = shaded_scenes::PAPER.map(|(angles, color)| (angles, color.map(|c| c * gain)));
        let brighter = shaded_scenes::Scene::new(320, 240, &lights, bust(240.0));
        refined(&mut camera, &brighter.with_noise(1.0, u64::from(frame)).quantized());
    }
    let (angle, _) = apart(&camera.state.orientation().unwrap().f, &f);
    assert!(angle < SAMPLED_ANGLE, "{angle}");
    for (&new, &old) in camera.state.orientation().unwrap().f.iter().zip(&f) {
        assert!((length(new) / length(old) / 1.4 - 1.0).abs() < SAMPLED_STRENGTH);
    }
}

#[test]
fn other_lights_need_a_cold_start() {
    for (params, lights) in
        [(Params::default(), shaded_scenes::PAPER), (direct(Params::default()), shaded_scenes::CLEAN)]
    {
        changes(params, &lights);
    }
    let params = direct(Params::default());
    // How many must fit is the caller's to say; a black frame fits nobody.
    let (mut strict, _) = solved(Params { smallest_share: 0.99, ..params });
    assert_eq!(strict.frame(&portrait(OrientationMethod::Direct, 100).whole()), Ok(Pass::Colors));
    let (mut lenient, _) = solved(Params { smallest_share: 0.0, ..params });
    let black = Scene::paint(320, 240, |_, _| [0.0; 3]);
    let black = black.encode_as(Layout { sample: Sample::U8, order: Some(Order::Rgb), gap: 0 });
    assert_eq!(lenient.frame(&black.image()), Ok(Pass::Colors));
    assert_eq!(lenient.state.drift().map(|drift| drift.inlier_share), Some(0.0));
}

fn changes(params: Params, lights: &[shaded_scenes::Light]) {
    let (mut camera, _) = solved(params);
    let before = digits(camera.state.solution());
    let other = shaded_scenes::Scene::new(320, 240, lights, bust(240.0)).with_noise(1.0, 7).quantized();
    assert_eq!(camera.frame(&other.whole()), Ok(Pass::Colors));
    let drift = *camera.state.drift().unwrap();
    println!("{drift:?}");
    assert!(drift.inlier_share < 0.5 && drift.change.is_none());
    // The old model is as it was, and serves until there is a new one.
    assert_eq!(digits(camera.state.solution()), before);
    assert!(camera.state.orientation().is_some());
    assert_eq!(camera.cold(&other.whole()), Ok(Pass::Refine));
    assert_eq!(camera.state.drift(), None);
    // As a stream that had never seen anything else.
    let mut fresh = Camera::new(&other.whole(), params);
    fresh.cold(&other.whole()).unwrap();
    assert_eq!(digits(camera.state.solution()), digits(fresh.state.solution()));
}

#[test]
fn an_exact_scene_stays_exact() {
    let scene = Scene::render(110, 90, three_lights(), sphere(60.0, 36.0));
    let encoded = scene.encode();
    let mut camera = Camera::new(&encoded.image(), Params::default());
    assert_eq!(camera.cold(&encoded.image()), Ok(Pass::Refine));
    for _ in 0..5 {
        assert_eq!(camera.frame(&encoded.image()), Ok(Pass::Refine));
        let drift = camera.state.drift().unwrap();
        println!("{drift:?}");
        assert!(drift.inlier_share > 0.99);
    }
    let (angle, strength) = apart(&camera.state.orientation().unwrap().f, &three_lights());
    println!("{angle} {strength}");
    assert!(angle < 0.01 && strength < 1e-4);
}
