//! Whether errors of normals are as large as they are said to be, over rendered scenes.

use ofc_core::picture::{Image, Order, Sample};
use ofc_core::solve::{OrientationMethod, Outcome, Params};
use ofc_core::surface::normals::{Length, TooShort, normal};
use ofc_core::surface::uncertainty::{Sources, Uncertainty, of_turn};
use ofc_tests::depth_maps::egg;
use ofc_tests::linear::{
    Matrix, apply, degrees_between, dot, inverse, median, multiply, nearest_orthogonal, transpose, unit,
};
use ofc_tests::lit_reliefs::{lights, reliefs, rendered};
use ofc_tests::photographs;
use ofc_tests::solved::{light_triples, solved, with_truth};
use std::f64::consts::PI;

const NO_ROTATION: Matrix = [[0.0; 3]; 3];

/// What shares of errors below 1, 2 and 3 sigma should be, in percent.
const NORMAL: [f64; 3] = [68.3, 95.4, 99.7];

/// How many errors there are, and how many are below 1, 2 and 3 sigma.
#[derive(Clone, Copy, Default)]
struct Shares {
    all: f64,
    below: [f64; 3],
}

impl Shares {
    fn add(&mut self, error: f64, sigma: f64) {
        self.all += 1.0;
        for (below, times) in self.below.iter_mut().zip([1.0, 2.0, 3.0]) {
            *below += f64::from(error < times * sigma);
        }
    }

    /// Every picture, and every scene, counts alike.
    fn add_shares(&mut self, other: &Self) {
        self.all += 1.0;
        for (below, share) in self.below.iter_mut().zip(other.percent()) {
            *below += share / 100.0;
        }
    }

    fn percent(&self) -> [f64; 3] {
        self.below.map(|below| 100.0 * below / self.all)
    }

    fn assert_calibrated(&self, what: &str) {
        for (share, expected) in self.percent().into_iter().zip(NORMAL) {
            assert!((share / expected - 1.0).abs() < 0.1, "{what}: {:.1?}, not {NORMAL:.1?}", self.percent());
        }
    }
}

/// F where every light reaches, up to a factor.
fn color_orientation(a: &[f64; 9], b: &[f64; 9]) -> Matrix {
    let [a, b] = [a, b].map(|m| [[m[0], m[1], m[2]], [m[3], m[4], m[5]], [m[6], m[7], m[8]]]);
    multiply(b, a)
}

/// What was found, over what is true: a rotation, and a bending E beside I, without its part that changes lengths alone.
struct Off {
    rotation: Matrix,
    bending: f64,
}

impl Off {
    fn new(f_inverse: Matrix, f: Matrix) -> Self {
        let turn = multiply(f_inverse, f);
        let rotation = nearest_orthogonal(turn);
        let stretch = multiply(transpose(rotation), turn);
        let mean = (stretch[0][0] + stretch[1][1] + stretch[2][2]) / 3.0;
        let mut sum = 0.0;
        for (i, entry) in stretch.as_flattened().iter().enumerate() {
            sum += (entry / mean - f64::from(i % 4 == 0)).powi(2);
        }
        Self { rotation, bending: sum.sqrt() }
    }

    /// The rotation as a vector, in radians.
    fn vector(&self) -> [f64; 3] {
        let r = self.rotation;
        let sines = [(r[2][1] - r[1][2]) / 2.0, (r[0][2] - r[2][0]) / 2.0, (r[1][0] - r[0][1]) / 2.0];
        let sine = dot(sines, sines).sqrt();
        let angle = sine.atan2((r[0][0] + r[1][1] + r[2][2] - 1.0) / 2.0);
        sines.map(|entry| entry * angle / sine.max(1e-300))
    }
}

/// The bending that is expected.
fn expected_bending(sources: &Sources) -> f64 {
    // What of_turn adds to the rotation is a third of its square, about each axis: T23 + T32 has none of it.
    let turn = of_turn(&sources.f, &sources.c, &NO_ROTATION);
    let antisymmetric = |i: usize, j: usize| (turn[i][i] + turn[j][j] - 2.0 * turn[i][j]) / 4.0;
    (antisymmetric(1, 3) + antisymmetric(2, 6) + antisymmetric(5, 7)).sqrt()
}

#[test]
fn shares_below_one_two_and_three_sigma() {
    println!("percent below 1, 2, 3 sigma (should be {NORMAL:.1?}):");
    println!("  noise alone: against the true F, noise that was estimated");
    println!("  and C: under the best rotation of the root that was found");
    println!(
        "  all: what was found against the truth, beside the rotation's root mean square error over what is said"
    );
    let mut total = [Shares::default(); 3];
    let (mut noises, mut bends, mut turns) = (Vec::new(), Vec::new(), Vec::new());
    for (name, _, relief) in &reliefs() {
        let mut scene = [Shares::default(); 3];
        let mut scene_turns = Vec::new();
        for (number, noise) in (0..=light_triples(5)).flat_map(|number| [(number, 0.3), (number, 1.0)]) {
            let (a, b) = lights(number);
            let (pixels, truth) = rendered(relief, &a, &b, noise, 7 + number);
            let image = Image::interleaved(&pixels, 256, 256, 768, Sample::U8, Order::Rgb)
                .and_then(|image| image.with_mask(&relief.mask, 256))
                .expect("a picture");
            let solution = solved(&image, &Params::default());
            assert_eq!(solution.outcome, Outcome::Solved, "{name} {number} {noise}");
            let sources = solution.uncertainty_sources().expect("the joint method");

            let f = color_orientation(&a, &b);
            let off = Off::new(sources.f_inverse, f);
            let (back, ideal) = (transpose(off.rotation), inverse(f));
            let of_c = Sources { rotation: NO_ROTATION, ..sources };
            let sigmas = [Sources { c: [0.0; 21], ..of_c }, of_c, sources].map(|s| Uncertainty::new(&s));
            let mut own = [Shares::default(); 3];
            for (color, t) in with_truth(&image, solution.inliers.selector(), &truth) {
                let found = normal(&sources.f_inverse, color, Length::Unit);
                let normals = [unit(apply(ideal, color.map(f64::from))), apply(back, found), found];
                for ((own, sigma), n) in own.iter_mut().zip(&sigmas).zip(normals) {
                    own.add(degrees_between(n, t).to_radians(), sigma.angle(color));
                }
            }
            for (sum, own) in scene.iter_mut().zip(&own) {
                sum.add_shares(own);
            }
            let w = off.vector();
            scene_turns.push((dot(w, apply(inverse(sources.rotation), w)) / 3.0).sqrt());
            noises.push(sources.noise / (noise * noise + 1.0 / 12.0).sqrt());
            bends.push(off.bending / expected_bending(&sources));
        }
        let [alone, and_c, all] = scene.map(|shares| shares.percent());
        println!(
            "{name:<8} noise alone {alone:5.1?}, and C {and_c:5.1?}, all {all:5.1?}; rotation {:.2}, median {:.2}",
            root_mean_square(&scene_turns),
            median(&scene_turns)
        );
        for (sum, scene) in total.iter_mut().zip(&scene) {
            sum.add_shares(scene);
        }
        turns.extend(scene_turns);
    }
    let [alone, and_c, all] = total.map(|shares| shares.percent());
    println!(
        "all      noise alone {alone:5.1?}, and C {and_c:5.1?}, all {all:5.1?}; rotation {:.2}, median {:.2}",
        root_mean_square(&turns),
        median(&turns)
    );
    noises.sort_by(f64::total_cmp);
    println!(
        "noise over truth: {:.2} to {:.2}, median {:.2}; bending over what is said: root mean square {:.2}",
        noises[0],
        noises[noises.len() - 1],
        median(&noises),
        root_mean_square(&bends)
    );
    for (shares, what) in total.iter().zip(["noise alone", "noise and C", "all"]) {
        shares.assert_calibrated(what);
    }
    assert!((0.98..1.06).contains(&median(&noises)));
    assert!(noises.iter().all(|noise| (0.8..1.25).contains(noise)), "{noises:.2?}");
    assert!((1.0..1.4).contains(&root_mean_square(&bends)), "{}", root_mean_square(&bends));
    assert!((0.85..1.1).contains(&root_mean_square(&turns)), "{}", root_mean_square(&turns));
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Nobody promises for photographs what rendered scenes keep, but an error is to be on the order of what is said.
#[test]
fn photographs() {
    for name in ["cat_figurine", "gelsight_ball_6mm", "gelsight_ball_9mm"] {
        let Some(photograph) = photographs::load(name) else { return };
        let image = photograph.image();
        let solution = solved(&image, &Params::default());
        let sources = solution.uncertainty_sources().expect("the joint method");
        let uncertainty = Uncertainty::new(&sources);
        let mut shares = Shares::default();
        let mut sigmas = Vec::new();
        for (color, t) in with_truth(&image, solution.inliers.selector(), &photograph.normals) {
            let found = normal(&sources.f_inverse, color, Length::Unit);
            let sigma = uncertainty.angle(color);
            sigmas.push(sigma.to_degrees());
            shares.add(degrees_between(found, t).to_radians(), sigma);
        }
        println!("{name:<18} median sigma {:5.2} degrees, shares {:5.1?}", median(&sigmas), shares.percent());
        let [one, two, _] = shares.percent();
        assert!((60.0..97.0).contains(&one) && two > 98.0, "{name}: {one} {two}");
    }
}

#[test]
fn no_normal_is_pi_and_exact_colors_are_exact() {
    let relief = egg(160, 120);
    let (a, b) = lights(2);
    let (pixels, _) = rendered(&relief, &a, &b, 0.0, 1);
    let image = Image::interleaved(&pixels, 160, 120, 480, Sample::U8, Order::Rgb).expect("a picture");
    let solution = solved(&image, &Params::default());
    let sources = solution.uncertainty_sources().expect("the joint method");
    let uncertainty = Uncertainty::new(&sources);
    let mut angles = vec![f32::NAN; 170 * 119 + 160];
    assert_eq!(uncertainty.compute(&image, solution.inliers.selector(), &mut angles, 170), Ok(()));
    let mut marks = vec![0; 160 * 120];
    solution.inliers.mark(&image, &mut marks);
    for (y, row) in angles.chunks(170).enumerate() {
        for (x, &angle) in row.iter().take(160).enumerate() {
            let inside = marks[160 * y + x] == 255;
            assert!(if inside { angle > 0.0 && angle < 0.5 } else { f64::from(angle) > PI - 1e-6 });
        }
        assert!(row.iter().skip(160).all(|gap| gap.is_nan()));
    }
    let mut short = vec![0.0; angles.len() - 1];
    assert_eq!(uncertainty.compute(&image, solution.inliers.selector(), &mut short, 170), Err(TooShort));
    assert_eq!(uncertainty.compute(&image, solution.inliers.selector(), &mut angles, 159), Err(TooShort));
    assert!(
        (uncertainty.angle([0.0; 3]) - PI).abs() < 1e-15
            && (uncertainty.angle([f32::NAN; 3]) - PI).abs() < 1e-15
    );
    let exact = Uncertainty::new(&Sources { c: [0.0; 21], rotation: NO_ROTATION, noise: 0.0, ..sources });
    assert!(exact.angle([50.0, 60.0, 70.0]) < 1e-9);
    // Noise counts the more the darker the color.
    let noise = Uncertainty::new(&Sources { c: [0.0; 21], rotation: NO_ROTATION, ..sources });
    let (bright, dark) = (noise.angle([100.0, 90.0, 80.0]), noise.angle([50.0, 45.0, 40.0]));
    assert!((dark / bright - 2.0).abs() < 1e-9);

    let paper =
        solved(&image, &Params { orientation_method: OrientationMethod::Direct, ..Params::default() });
    assert_eq!(paper.outcome, Outcome::Solved);
    assert_eq!(paper.uncertainty_sources(), None);
}
