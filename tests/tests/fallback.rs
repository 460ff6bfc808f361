//! What solve does where eqs. 25 have no root: each fallback, on pictures whose border spoils Pentland's tilts.

use ofc_core::solve::{self, OrientationMethod, Outcome, Params, SlantFallback, SlantSource, Solution};
use ofc_tests::shaded_scenes::{CLEAN, Scene, median_error};
use std::f64::consts::FRAC_PI_2;

fn solve(scene: &Scene, fallback: SlantFallback) -> Solution {
    let params = Params { fallback, orientation_method: OrientationMethod::Direct, ..Params::default() };
    let len = solve::workspace_len(scene.width * scene.height, params.lmeds.sample_size);
    solve::solve(&scene.image(), &params, &mut vec![f32::NAN; len]).expect("a solution")
}

#[test]
fn each_fallback_is_taken_and_named() {
    let sources = [
        (SlantFallback::LeastSquares, SlantSource::LeastSquares),
        (SlantFallback::TiltIntegrability, SlantSource::TiltIntegrability),
        (SlantFallback::PentlandSlant, SlantSource::Pentland),
        (SlantFallback::LeeRosenfeldSlant, SlantSource::LeeRosenfeld),
        (SlantFallback::ZhengChellappaSlant, SlantSource::ZhengChellappa),
    ];
    let mut without = 0;
    for step in 0..24 {
        // Waves that touch the frame: the mean gradients are whatever the border makes of them.
        let phase = f64::from(step) * 0.7;
        let waves = |x: f64, y: f64| {
            let (u, v) = (x / 14.0 + phase, y / 11.0 - 0.6 * phase);
            Some(4.0 * (u.sin() + v.cos() + 0.5 * (u - v).sin()))
        };
        let scene = Scene::new(72, 72, &CLEAN, waves).with_noise(0.3, 1);
        let refused = solve(&scene, SlantFallback::Refuse);
        if refused.outcome != Outcome::NoConsistentSlants {
            assert_eq!(refused.choice.map(|choice| choice.source), Some(SlantSource::Root));
            continue;
        }
        without += 1;
        assert!(refused.choice.is_none());
        for (fallback, source) in sources {
            let solution = solve(&scene, fallback);
            let choice = solution.choice.expect("slants");
            assert_eq!(choice.source, source);
            assert!(choice.slants.iter().all(|slant| (0.0..=FRAC_PI_2).contains(slant)));
            // Two estimators may put all three lights on the axis: then there is no F, and the outcome says so.
            let full = choice.orientation.rank == 3;
            assert_eq!(solution.outcome, if full { Outcome::Solved } else { Outcome::RankDeficient });
            if without == 1 {
                println!(
                    "{source:?}: slants {:.1?} deg, median error {:.1} deg",
                    choice.slants.map(f64::to_degrees),
                    median_error(&scene, &choice.orientation.f_inverse)
                );
            }
        }
    }
    println!("{without} of 24 without a root");
    assert!(without >= 3);
}
