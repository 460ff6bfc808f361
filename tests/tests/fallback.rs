//! What solve does where eqs. 25 have no root: each fallback gives the slants of its definition, on pictures whose border spoils
//! Pentland's tilts. The definitions are computed here from the colors of the picture, by code of this file and the oracles.

use ofc_core::picture::for_each_bit;
use ofc_core::solve::{self, OrientationMethod, Outcome, Params, SlantFallback, SlantSource, Solution};
use ofc_tests::linear::{Matrix, apply, inverse};
use ofc_tests::shaded_scenes::{CLEAN, Scene, direction};
use ofc_tests::slant_oracle::residuals;
use std::f64::consts::{FRAC_PI_2, PI};

/// Radians that a slant may be off its definition: solved to far better, but sums in another order decide the last digits.
const EQUAL: f64 = 1e-6;
/// What a wrong answer is turned by, in radians, to show that a check sees it: 3 degrees.
const WRONG: f64 = 0.05;
/// How far the residual of eqs. 24 may be above the smallest, by the fallback that minimizes (15).
const SLACK: f64 = 0.05;

fn solve(scene: &Scene, fallback: SlantFallback) -> Solution {
    let params = Params { fallback, orientation_method: OrientationMethod::Direct, ..Params::default() };
    let len = solve::workspace_len(scene.width * scene.height, params.lmeds.sample_size);
    solve::solve(&scene.image(), &params, &mut vec![f32::NAN; len]).expect("a solution")
}

/// A picture without a root of eqs. 25, and what its solution knows before it needs slants.
struct Rootless {
    width: usize,
    height: usize,
    /// The colors of all pixels that may be used, and of those that fit; `None` elsewhere.
    usable: Vec<Option<[f64; 3]>>,
    inliers: Vec<Option<[f64; 3]>>,
    norms: [f64; 3],
    tilts: [f64; 3],
    /// The cosines of the differences of the tilts, and those of the angles between the rows of F.
    k: [f64; 3],
    h: [f64; 3],
}

impl Rootless {
    fn new(scene: &Scene, refused: &Solution) -> Self {
        let image = scene.image();
        let ellipsoid = refused.ellipsoid.expect("an ellipsoid");
        let tilts = refused.tilts.expect("tilts").tilts;
        let [t1, t2, t3] = tilts;
        let (mut usable, mut inliers) = (vec![None; scene.colors.len()], vec![None; scene.colors.len()]);
        image.for_each_window(|window| {
            let start = window.y * scene.width + window.x;
            for_each_bit(refused.inliers.usable.bits(window), |i| {
                usable[start + i] = Some(window.pixel(i).map(f64::from));
            });
            for_each_bit(refused.inliers.bits(window), |i| {
                inliers[start + i] = Some(window.pixel(i).map(f64::from));
            });
        });
        let k = [t1 - t2, t1 - t3, t2 - t3].map(f64::cos);
        let (norms, h) = (ellipsoid.norms, ellipsoid.cosines);
        Self { width: scene.width, height: scene.height, usable, inliers, norms, tilts, k, h }
    }

    fn sum_of_squares(&self, slants: [f64; 3]) -> f64 {
        residuals(self.k, self.h, slants).iter().map(|residual| residual * residual).sum()
    }

    /// The root mean square residual of eqs. 24.
    fn residual(&self, slants: [f64; 3]) -> f64 {
        (self.sum_of_squares(slants) / 3.0).sqrt()
    }

    /// The smallest residual within [0, pi/2]: the best of a grid, and of ever smaller steps from its best ten.
    fn smallest_residual(&self) -> f64 {
        let mut starts: Vec<(f64, [f64; 3])> =
            grid(31).map(|slants| (self.sum_of_squares(slants), slants)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let descend = |&(mut least, mut at): &(f64, [f64; 3])| {
            let mut step = 0.05;
            while step > 1e-9 {
                let moves = (0..27).map(|i| {
                    let turn = |digit: i32| f64::from(i / digit % 3 - 1) * step;
                    [at[0] + turn(1), at[1] + turn(3), at[2] + turn(9)].map(|s| s.clamp(0.0, FRAC_PI_2))
                });
                let best = moves.map(|slants| (self.sum_of_squares(slants), slants));
                let best = best.min_by(|a, b| a.0.total_cmp(&b.0)).expect("27 moves");
                if best.0 < least {
                    (least, at) = best;
                } else {
                    step *= 0.5;
                }
            }
            least
        };
        (starts[..10].iter().map(descend).fold(f64::INFINITY, f64::min) / 3.0).sqrt()
    }

    /// F of these slants and its inverse's integral (15): the mean over squares of four inliers.
    fn integral(&self, slants: [f64; 3]) -> f64 {
        let row = |i: usize| {
            direction([slants[i].to_degrees(), self.tilts[i].to_degrees()]).map(|a| a * self.norms[i])
        };
        let f_inverse: Matrix = inverse([row(0), row(1), row(2)]);
        let slope = |color: [f64; 3]| {
            let n = apply(f_inverse, color);
            [-n[0] / n[2].max(0.05), -n[1] / n[2].max(0.05)]
        };
        let (mut sum, mut cells) = (0.0, 0.0);
        for y in 1..self.height {
            for x in 1..self.width {
                let at = y * self.width + x;
                let corners = [at - self.width - 1, at - self.width, at - 1, at].map(|i| self.inliers[i]);
                let [Some(nw), Some(ne), Some(sw), Some(se)] = corners.map(|color| color.map(slope)) else {
                    continue;
                };
                let p_y = 0.5 * (nw[0] + ne[0] - sw[0] - se[0]);
                let q_x = 0.5 * (ne[1] + se[1] - nw[1] - sw[1]);
                sum += (p_y - q_x) * (p_y - q_x);
                cells += 1.0;
            }
        }
        sum / cells
    }

    /// Differences of one channel along a step, y up, a pixel's length each.
    fn differences(&self, channel: usize, (dx, dy): (isize, isize)) -> Vec<f64> {
        let length = (dx as f64).hypot(dy as f64);
        let at = |x: isize, y: isize| {
            let inside = (0..self.width as isize).contains(&x) && (0..self.height as isize).contains(&y);
            let color = inside.then(|| self.inliers[(y * self.width as isize + x).cast_unsigned()]);
            color.flatten().map(|color| color[channel])
        };
        let pixels = (0..self.height as isize).flat_map(|y| (0..self.width as isize).map(move |x| (x, y)));
        pixels.filter_map(|(x, y)| Some((at(x + dx, y - dy)? - at(x, y)?) / length)).collect()
    }

    /// Eq. 22, with the mean gradient of eq. 20 from the axes and the diagonals.
    fn pentland(&self, channel: usize) -> f64 {
        let along = [(1, 0), (0, 1), (1, 1), (-1, 1)].map(|step| self.differences(channel, step));
        let [e, n, ne, nw] = along.each_ref().map(|d| mean(d));
        let h = 0.5_f64.sqrt();
        let (ix, iy) = (0.5 * (e + h * (ne - nw)), 0.5 * (n + h * (ne + nw)));
        let variance = |d: &Vec<f64>| mean(&d.iter().map(|x| (x - mean(d)).powi(2)).collect::<Vec<_>>());
        let spread = along.iter().map(variance).sum::<f64>() / 4.0;
        (1.0 - (ix * ix + iy * iy) / spread).max(0.0).sqrt().acos()
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// All triples of `points` slants from 0 to pi/2.
fn grid(points: i32) -> impl Iterator<Item = [f64; 3]> {
    let slant = move |i: i32| f64::from(i) * FRAC_PI_2 / f64::from(points - 1);
    (0..points.pow(3)).map(move |i| [i % points, i / points % points, i / points.pow(2)].map(slant))
}

/// The mean of a channel over its root mean square.
fn mean_over_rms(colors: &[Option<[f64; 3]>], channel: usize) -> f64 {
    let values: Vec<f64> = colors.iter().flatten().map(|color| color[channel]).collect();
    mean(&values) / mean(&values.iter().map(|value| value * value).collect::<Vec<_>>()).sqrt()
}

/// The mean of max(0, n.a) over its root mean square, by the midpoint rule over the slants and tilts of normals; `density` is that
/// of their slants, `lit` leaves out those that the light does not reach.
fn expected_ratio(slant: f64, density: impl Fn(f64) -> f64, lit: bool) -> f64 {
    const STEPS: i32 = 120;
    let (mut weights, mut first, mut second) = (0.0, 0.0, 0.0);
    for i in 0..STEPS {
        let b = (f64::from(i) + 0.5) / f64::from(STEPS) * FRAC_PI_2;
        for j in 0..STEPS {
            let a = (f64::from(j) + 0.5) / f64::from(STEPS) * PI;
            let shading = slant.cos() * b.cos() + slant.sin() * b.sin() * a.cos();
            if shading > 0.0 || !lit {
                let weight = density(b);
                weights += weight;
                first += weight * shading.max(0.0);
                second += weight * shading.max(0.0).powi(2);
            }
        }
    }
    (first / weights) / (second / weights).sqrt()
}

/// Whether a slant is where a falling ratio takes this value: the ends of [0, `largest`] stand for what lies beyond them.
fn solves(slant: f64, measured: f64, largest: f64, expected: impl Fn(f64) -> f64) -> bool {
    const TOLERANCE: f64 = 2e-4;
    if slant == 0.0 {
        measured > expected(0.0) - TOLERANCE
    } else if slant >= largest - 1e-9 {
        measured < expected(largest) + TOLERANCE
    } else {
        (measured - expected(slant)).abs() < TOLERANCE
    }
}

/// Asserts that the check holds for these slants and fails where any of them is turned away from its answer.
fn assert_defined(name: &str, slants: [f64; 3], is_answer: impl Fn([f64; 3]) -> bool) {
    assert!(is_answer(slants), "{name}: {slants:?}");
    for i in 0..3 {
        let mut wrong = slants;
        wrong[i] += if slants[i] > 0.8 { -WRONG } else { WRONG };
        assert!(!is_answer(wrong), "{name} does not notice that slant {i} of {slants:?} is wrong");
    }
}

#[test]
fn each_fallback_gives_the_slants_of_its_definition() {
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
        let slants =
            |fallback, source| {
                let solution = solve(&scene, fallback);
                let choice = solution.choice.expect("slants");
                assert_eq!(choice.source, source);
                assert!(
                    choice.slants.iter().all(|slant| (0.0..=FRAC_PI_2 + 1e-9).contains(slant)
                        || source == SlantSource::LeeRosenfeld)
                );
                // Two estimators may put all three lights on the axis: then there is no F, and the outcome says so.
                let full = choice.orientation.rank == 3;
                assert_eq!(solution.outcome, if full { Outcome::Solved } else { Outcome::RankDeficient });
                println!("{step} {source:?}: {:.2?} deg", choice.slants.map(f64::to_degrees));
                choice.slants
            };
        let known = Rootless::new(&scene, &refused);

        let nearest = slants(SlantFallback::LeastSquares, SlantSource::LeastSquares);
        let smallest = known.smallest_residual();
        assert_defined("least squares", nearest, |slants| known.residual(slants) < smallest + 1e-6);

        let integrable = slants(SlantFallback::TiltIntegrability, SlantSource::TiltIntegrability);
        let limit = smallest + SLACK;
        let allowed = grid(17).filter(|&slants| known.residual(slants) <= limit);
        let least = allowed.map(|slants| known.integral(slants)).fold(known.integral(nearest), f64::min);
        println!("  integral {:.4e}, of the grid {least:.4e}", known.integral(integrable));
        println!("  residual {:.4}, limit {limit:.4}", known.residual(integrable));
        assert!(known.residual(integrable) <= limit + 1e-6);
        assert!(known.integral(integrable) <= 1.02 * least);
        // The least-squares slants are no answer.
        assert!(known.integral(nearest) > 1.02 * least);

        let channels = [0, 1, 2];
        let pentland = slants(SlantFallback::PentlandSlant, SlantSource::Pentland);
        let expected = channels.map(|channel| known.pentland(channel));
        assert_defined("Pentland", pentland, |slants| {
            slants.iter().zip(expected).all(|(slant, expected)| (slant - expected).abs() < EQUAL)
        });

        // Eq. 23 is a sphere's: the density of its normals' slants over the picture is sin b cos b.
        let rosenfeld = slants(SlantFallback::LeeRosenfeldSlant, SlantSource::LeeRosenfeld);
        let measured = channels.map(|channel| mean_over_rms(&known.inliers, channel));
        assert_defined("Lee and Rosenfeld", rosenfeld, |slants| {
            let on_sphere = |slant| expected_ratio(slant, |b| b.sin() * b.cos(), true);
            slants
                .iter()
                .zip(measured)
                .all(|(&slant, measured)| solves(slant, measured, PI - 0.01, on_sphere))
        });

        let zheng = slants(SlantFallback::ZhengChellappaSlant, SlantSource::ZhengChellappa);
        let measured = channels.map(|channel| mean_over_rms(&known.usable, channel));
        assert_defined("Zheng and Chellappa", zheng, |slants| {
            let cosine = |slant| expected_ratio(slant, f64::cos, false);
            slants.iter().zip(measured).all(|(&slant, measured)| solves(slant, measured, FRAC_PI_2, cosine))
        });
    }
    println!("{without} of 24 without a root");
    assert!(without >= 3);
}
