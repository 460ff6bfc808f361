//! The one-dimensional least median of squares against brute force.

use ofc_core::color::inliers::Inliers;
use ofc_core::color::location::shortest_half;
use ofc_core::color::norms;
use ofc_core::math::rng::Rng;
use ofc_core::picture::Usable;
use ofc_tests::linear::median;
use ofc_tests::linear_scenes::Scene;
use ofc_tests::tolerances::REORDERED_SUM;

/// Midpoint and half length of every shortest half, ascending: all contiguous halves of the sorted values are tried.
fn halves(values: &[f32]) -> (Vec<f64>, f64) {
    let mut sorted: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
    sorted.sort_by(f64::total_cmp);
    let most = sorted.len() / 2 + 1;
    let all: Vec<(f64, f64)> = sorted.windows(most).map(|half| (half[0], half[most - 1])).collect();
    let shortest = all.iter().map(|(low, high)| high - low).fold(f64::INFINITY, f64::min);
    let midpoints =
        all.iter().filter(|(low, high)| high - low == shortest).map(|(low, high)| 0.5 * (low + high));
    (midpoints.collect(), 0.5 * shortest)
}

/// The median distance of the values from a place.
fn objective(values: &[f32], place: f64) -> f64 {
    median(&values.iter().map(|&v| (f64::from(v) - place).abs()).collect::<Vec<_>>())
}

fn values(rng: &mut Rng, count: u32, case: u32) -> Vec<f32> {
    (0..count)
        .map(|_| match case % 4 {
            // Few different values: ties everywhere, and halves of length zero.
            0 => rng.below(4) as f32,
            1 => rng.below(40) as f32 * 0.25 - 3.0,
            2 => (rng.unit() * rng.unit() * 10.0 - 5.0) as f32,
            _ => 1.0 + 1e-3 * rng.unit() as f32 + if rng.below(5) < 2 { 100.0 } else { 0.0 },
        })
        .collect()
}

#[test]
fn the_shortest_half_is_found_with_the_middle_one_of_ties() {
    let mut rng = Rng::new(31);
    let mut ties = 0;
    for case in 0..2000 {
        let count = 2 + rng.below(60);
        let values = values(&mut rng, count, case);
        let (mut sorted, mut scratch) = (values.clone(), vec![f32::NAN; values.len()]);
        let found = shortest_half(&mut sorted, &mut scratch).expect("two values or more");
        let (midpoints, half_length) = halves(&values);
        assert_eq!(found.median_distance, half_length, "{values:?}");
        assert_eq!(found.location, midpoints[(midpoints.len() - 1) / 2], "{values:?}");
        ties += usize::from(midpoints.len() > 1);
        let correction = 1.0 + 5.0 / (f64::from(count) - 1.0);
        let dispersion = 1.482_602_218_505_602 * correction * half_length;
        assert!((found.dispersion - dispersion).abs() <= REORDERED_SUM * dispersion);
    }
    assert!(ties > 500, "only {ties} cases had ties");
}

/// Section 2.2's second rejection looks at the lengths that C gives to the normals of the inliers.
#[test]
fn the_lengths_of_normals_are_those_of_the_form() {
    let mut rng = Rng::new(33);
    let form = [4e-4, 3e-4, 5e-4, 1e-4, -5e-5, 2e-5];
    let scene = Scene::paint(70, 5, |_, _| [0; 3].map(|_| 20.0 + 30.0 * rng.unit()));
    let mask: Vec<u8> = (0..350).map(|i| u8::from(i % 3 > 0)).collect();
    let encoded = scene.encode();
    let image = encoded.image().with_mask(&mask, 70).expect("sizes agree");
    let mut lengths: Vec<f32> = scene
        .colors
        .iter()
        .zip(&mask)
        .filter(|&(_, &mask)| mask > 0)
        .map(|(color, _)| {
            let [r, g, b] = color.map(|value| f64::from(value as f32));
            let [c11, c22, c33, c12, c13, c23] = form;
            let square = r * (c11 * r + c12 * g + c13 * b)
                + g * (c12 * r + c22 * g + c23 * b)
                + b * (c13 * r + c23 * g + c33 * b);
            square.sqrt() as f32
        })
        .collect();
    let all = Inliers::all(Usable::below(f32::INFINITY));
    let found = norms::location(&image, &all, &form, &mut vec![f32::NAN; 700]).expect("two pixels or more");
    let count = lengths.len();
    let wanted = shortest_half(&mut lengths, &mut vec![0.0; count]).expect("two values or more");
    assert!(
        (found.location - wanted.location).abs() < 1e-6
            && (found.dispersion - wanted.dispersion).abs() < 1e-6
    );
    assert_eq!(norms::location(&image, &Inliers::none(all.usable), &form, &mut vec![0.0; 700]), None);
    assert_eq!(norms::location(&image, &all, &form, &mut [0.0; 349]), None);
}

#[test]
fn no_place_has_a_smaller_median_distance() {
    let mut rng = Rng::new(32);
    for case in 0..200 {
        let count = 2 + rng.below(30);
        let values = values(&mut rng, count, case);
        let found =
            shortest_half(&mut values.clone(), &mut vec![0.0; values.len()]).expect("two values or more");
        let here = objective(&values, found.location);
        // The median distance is piecewise linear, its minima are midpoints of two values.
        for a in &values {
            for b in &values {
                let place = 0.5 * (f64::from(*a) + f64::from(*b));
                assert!(objective(&values, place) >= here, "{place} beats {} of {values:?}", found.location);
            }
        }
    }
}
