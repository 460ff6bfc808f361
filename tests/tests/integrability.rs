//! The integral (15) against explicit loops, and on surfaces where it is zero.

use ofc_core::light::tilt::TiltEstimator;
use ofc_core::math::rng::Rng;
use ofc_core::orientation::integrability::integral;
use ofc_core::solve::{OrientationMethod, Params, SlantSource};
use ofc_tests::linear::{Matrix, apply, inverse, multiply, transpose};
use ofc_tests::linear_scenes::{Scene, direction, paraboloid, three_lights};
use ofc_tests::solved::solved;
use ofc_tests::tolerances::{INTEGRABLE, REORDERED_SUM};

/// The mean of `(p_y - q_x)^2` over squares of four pixels of the mask; slopes are held at n3 = 0.05 where it is smaller.
fn oracle(scene: &Scene, mask: &[u8], f_inverse: Matrix) -> Option<(f64, usize)> {
    let (mut sum, mut cells) = (0.0, 0_usize);
    for row in 1..scene.height {
        for column in 1..scene.width {
            let at = |dx: usize, dy: usize| (row - 1 + dy) * scene.width + column - 1 + dx;
            let corners = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            if corners.iter().any(|&i| mask[i] == 0) {
                continue;
            }
            let [upper_left, upper_right, lower_left, lower_right] = corners.map(|i| {
                let n = apply(f_inverse, scene.colors[i].map(|c| f64::from(c as f32)));
                [-n[0] / n[2].max(0.05), -n[1] / n[2].max(0.05)]
            });
            let p_y = (upper_left[0] + upper_right[0] - lower_left[0] - lower_right[0]) / 2.0;
            let q_x = (upper_right[1] + lower_right[1] - upper_left[1] - lower_left[1]) / 2.0;
            sum += (p_y - q_x).powi(2);
            cells += 1;
        }
    }
    (cells > 0).then(|| (sum / cells as f64, cells))
}

#[test]
fn explicit_loops_agree() {
    let mut rng = Rng::new(61);
    let f_inverse = inverse(three_lights());
    for width in [1, 2, 63, 64, 65, 127, 130] {
        for holes in [0, 2, 6] {
            let scene = Scene::paint(width, 9, |_, _| [0; 3].map(|_| 255.0 * rng.unit()));
            let mask: Vec<u8> = (0..width * 9).map(|_| u8::from(rng.below(10) >= holes)).collect();
            let encoded = scene.encode();
            let image = encoded.image().with_mask(&mask, width).expect("sizes agree");
            let found = integral(&image, |window| window.masked, &f_inverse);
            match oracle(&scene, &mask, f_inverse) {
                None => assert_eq!(found, None),
                Some((mean, cells)) => {
                    let found = found.expect("cells");
                    assert_eq!(found.cells, cells);
                    assert!((found.mean - mean).abs() <= REORDERED_SUM * mean, "{found:?} {mean}");
                }
            }
        }
    }
}

#[test]
fn a_quadratic_surface_is_integrable_and_its_turned_normals_are_not() {
    let f = three_lights();
    let scene = Scene::render(90, 70, f, paraboloid([0.011, 0.006, 0.003], 35.0));
    let encoded = scene.encode();
    let mask: Vec<u8> = scene.normals.iter().map(|n| u8::from(n[2] > 0.0)).collect();
    let image = encoded.image().with_mask(&mask, 90).expect("sizes agree");
    let truth = inverse(f);
    let mean = |f_inverse: Matrix| integral(&image, |window| window.masked, &f_inverse).expect("cells").mean;
    assert!(mean(truth) < INTEGRABLE, "{}", mean(truth));
    let (sin, cos) = 0.2_f64.sin_cos();
    for turn in [
        [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]],
        [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]],
    ] {
        assert!(mean(multiply(turn, truth)) > 1e3 * INTEGRABLE, "{}", mean(multiply(turn, truth)));
        assert!(mean(multiply(transpose(turn), truth)) > 1e3 * INTEGRABLE);
    }
    // Convex and concave are the same to the integral (section 2.4).
    let inverted = multiply([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], truth);
    assert!(mean(inverted) < INTEGRABLE);
}

/// Section 3.4, step 8. The lights of figures 1 and 2 leave two candidates: (40, 30, 5) degrees, which are right, and (64.6, 0.9,
/// 32.3). The integral (15) is zero for the right ones alone.
#[test]
fn of_two_candidates_the_more_integrable_one_is_chosen() {
    let strong = |strength: f64, direction: [f64; 3]| direction.map(|component| component * strength);
    let angles = [(40.0, 20.0), (30.0, -120.0), (5.0, 0.0)];
    let [a, b, c] = angles.map(|(slant, tilt)| direction(slant, tilt));
    let rows = [strong(120.0, a), strong(200.0, b), strong(160.0, c)];
    let tilts = angles.map(|(_, tilt)| f64::to_radians(tilt));
    for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
        let scene = Scene::render(100, 80, order.map(|i| rows[i]), paraboloid([0.012, 0.02, 0.004], 40.0));
        let encoded = scene.encode();
        let params = Params {
            orientation_method: OrientationMethod::Direct,
            tilts: TiltEstimator::Given(order.map(|i| tilts[i])),
            ..Params::default()
        };
        let solution = solved(&encoded.image(), &params);
        let choice = solution.choice.expect("slants");
        let degrees: Vec<[f64; 3]> =
            choice.candidates.iter().map(|candidate| candidate.slants.map(f64::to_degrees)).collect();
        let integrals: Vec<f64> = choice.candidates.iter().map(|candidate| candidate.integral).collect();
        assert_eq!((choice.source, choice.candidates.len()), (SlantSource::Root, 2), "{degrees:.1?}");
        let (right, wrong) = (choice.chosen, 1 - choice.chosen);
        for (found, i) in degrees[right].iter().zip(order) {
            assert!((found - angles[i].0).abs() < 0.1, "{degrees:.2?}, {integrals:?}");
        }
        assert!(integrals[wrong] > 1e3 * integrals[right], "{integrals:?}");
        assert_eq!(choice.slants, choice.candidates[right].slants);
    }
}
