//! The lengths of F's rows from the fit or from the channels' maxima, with the direct method.

use ofc_core::light::channel_maxima;
use ofc_core::picture::Sample;
use ofc_core::solve::{self, NormSource, OrientationMethod, Outcome, Params, Solution};
use ofc_core::stream;
use ofc_tests::shaded_scenes::{CLEAN, Scene, lopsided};

fn solve(scene: &Scene, norms: NormSource, orientation_method: OrientationMethod) -> Solution {
    let params = Params { norms, orientation_method, ..Params::default() };
    let len = solve::workspace_len(scene.width * scene.height, params.lmeds.sample_size);
    solve::solve(&scene.image(), &params, &mut vec![f32::NAN; len]).expect("a solution")
}

#[test]
fn maxima_stretch_the_rows_of_f_and_turn_none() {
    let scene = Scene::new(96, 96, &CLEAN, lopsided(48.0)).with_noise(0.5, 1);
    let [fitted, maximal] = [NormSource::Fit, NormSource::ChannelMaxima]
        .map(|norms| solve(&scene, norms, OrientationMethod::Direct));
    assert_eq!((fitted.outcome, maximal.outcome), (Outcome::Solved, Outcome::Solved));
    assert_eq!(fitted.ellipsoid, maximal.ellipsoid);
    let maxima = channel_maxima::norms(&scene.image(), maximal.inliers.selector()).expect("inliers");
    let norms = fitted.ellipsoid.expect("C").norms;
    let (fitted, maximal) = (fitted.choice.expect("F"), maximal.choice.expect("F"));
    assert_eq!((fitted.slants, fitted.chosen), (maximal.slants, maximal.chosen));
    for channel in 0..3 {
        let (old, new) = (fitted.orientation.f[channel], maximal.orientation.f[channel]);
        // The maximum is one pixel's, with its noise and where the surface happens to face the light best.
        assert!(maxima[channel] != norms[channel]);
        for (old, new) in old.into_iter().zip(new) {
            assert!((new - old * maxima[channel] / norms[channel]).abs() < 1e-12 * maxima[channel]);
        }
    }
}

#[test]
fn the_joint_method_and_streams_have_the_fit_s() {
    let scene = Scene::new(96, 96, &CLEAN, lopsided(48.0));
    let [fitted, maximal] = [NormSource::Fit, NormSource::ChannelMaxima]
        .map(|norms| solve(&scene, norms, OrientationMethod::Joint));
    assert!(fitted.joint.is_some());
    assert_eq!(fitted, maximal);
    let mut params = stream::Params::default();
    assert!(stream::State::new(96, 96, Sample::U8, params).is_ok());
    params.solve.norms = NormSource::ChannelMaxima;
    assert_eq!(stream::State::new(96, 96, Sample::U8, params).err(), Some(stream::StreamError::Params));
}
