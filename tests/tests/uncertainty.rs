//! Whether errors of normals are as large as they are said to be, over rendered scenes.

use ofc_core::image::{Image, Order, Sample};
use ofc_core::mat3;
use ofc_core::normals::{Length, normal};
use ofc_core::solve::{Outcome, Params, Solution, solve, workspace_len};
use ofc_core::uncertainty::{Sources, Uncertainty};
use ofc_tests::linear::{Matrix, apply, degrees_between, dot, nearest_orthogonal, unit};
use ofc_tests::lit_reliefs::{lights, reliefs, rendered};

/// Random light triples beside Table 1's.
fn light_triples() -> u64 {
    std::env::var("OFC_LIGHTS").map_or(5, |text| text.parse().expect("OFC_LIGHTS is a number"))
}

fn solved(image: &Image) -> Solution {
    let params = Params::default();
    let pixels = image.width() * image.height();
    let mut workspace = vec![f32::NAN; workspace_len(pixels, params.lmeds.sample_size)];
    solve(image, &params, &mut workspace).expect("enough pixels")
}

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

    /// Adds another's shares as one.
    fn add_shares(&mut self, other: &Self) {
        self.all += 1.0;
        for (below, share) in self.below.iter_mut().zip(other.percent()) {
            *below += share / 100.0;
        }
    }

    fn percent(&self) -> [f64; 3] {
        self.below.map(|below| 100.0 * below / self.all)
    }
}

#[test]
fn shares_below_one_two_and_three_sigma() {
    println!("scene  lights noise found | noise alone | noise, C | all | w/sigma");
    let mut sums = [Shares::default(); 3];
    for (name, _, relief) in &reliefs() {
        let mut scene = [Shares::default(); 3];
        let mut ratios = Vec::new();
        for number in 0..=light_triples() {
            for noise in [0.3, 1.0] {
                let (a, b) = lights(number);
                let (pixels, truth) = rendered(relief, &a, &b, noise, 7 + number);
                let image = Image::interleaved(&pixels, 256, 256, 768, Sample::U8, Order::Rgb)
                    .and_then(|image| image.with_mask(&relief.mask, 256))
                    .expect("a picture");
                let solution = solved(&image);
                if solution.outcome != Outcome::Solved {
                    println!("{name} {number} {noise} {:?}", solution.outcome);
                    continue;
                }
                let sources = Sources::of(&solution).expect("the default road");
                let mut pixels = Vec::new();
                image.for_each_window(|window| {
                    let bits = solution.inliers.bits(window);
                    for i in (0..window.len).filter(|i| bits >> i & 1 == 1) {
                        let t = truth[window.y * 256 + window.x + i].map(f64::from);
                        if dot(t, t) > 0.0 {
                            pixels.push((window.pixel(i), t));
                        }
                    }
                });
                // The true F where all lights reach: F = B A.
                let mut f = [[0.0; 3]; 3];
                for i in 0..3 {
                    for j in 0..3 {
                        f[i][j] = (0..3).map(|k| b[3 * i + k] * a[3 * k + j]).sum();
                    }
                }
                let true_inverse = ofc_tests::linear::inverse(f);
                // G G_true^-1 = rotation times symmetric: polar.
                let g = sources.f_inverse;
                let t = mat3::multiply(&g, &f);
                let r = nearest_orthogonal(t); // convention below
                let back = |m: Matrix, n| apply(m, n);
                let _ = (r, back);
                let w = {
                    let e = mat3::multiply(&ofc_tests::linear::transpose(r), &t);
                    let _ = e;
                    // angle of r
                    ((r[0][0] + r[1][1] + r[2][2] - 1.0) / 2.0).clamp(-1.0, 1.0).acos()
                };
                let wv = [(r[2][1] - r[1][2]) / 2.0, (r[0][2] - r[2][0]) / 2.0, (r[1][0] - r[0][1]) / 2.0];
                let inv = ofc_tests::linear::inverse(sources.rotation);
                let maha = (dot(wv, apply(inv, wv)) / 3.0).sqrt();
                ratios.push(maha);
                // e: symmetric part relative to predicted
                let noise_only =
                    Uncertainty::new(&Sources { c: [0.0; 21], rotation: [[0.0; 3]; 3], ..sources });
                let no_rot = Uncertainty::new(&Sources { rotation: [[0.0; 3]; 3], ..sources });
                let everything = Uncertainty::new(&sources);
                let mut own = [Shares::default(); 3];
                let derot = ofc_tests::linear::transpose(r);
                for &(color, t) in &pixels {
                    let ideal = unit(apply(true_inverse, color.map(f64::from)));
                    own[0].add(degrees_between(ideal, t).to_radians(), noise_only.angle(color));
                    let found = normal(&sources.f_inverse, color, Length::Unit);
                    own[1].add(degrees_between(apply(derot, found), t).to_radians(), no_rot.angle(color));
                    own[2].add(degrees_between(found, t).to_radians(), everything.angle(color));
                }
                let trace = sources.rotation[0][0] + sources.rotation[1][1] + sources.rotation[2][2];
                println!(
                    "{name:<8} {number} {noise} noise {:5.3} of {:5.3} | {:5.1?} | {:5.1?} | {:5.1?} | w {:5.2} of {:5.2} deg, maha {maha:5.2}",
                    sources.noise,
                    (noise * noise + 1.0f64 / 12.0).sqrt(),
                    own[0].percent(),
                    own[1].percent(),
                    own[2].percent(),
                    w.to_degrees(),
                    trace.sqrt().to_degrees()
                );
                for (sum, own) in scene.iter_mut().zip(&own) {
                    sum.add_shares(own);
                }
            }
        }
        ratios.sort_by(f64::total_cmp);
        println!(
            "{name:<8} ALL  {:5.1?} | {:5.1?} | {:5.1?}  maha {ratios:.2?}",
            scene[0].percent(),
            scene[1].percent(),
            scene[2].percent()
        );
        for (sum, own) in sums.iter_mut().zip(&scene) {
            sum.add_shares(own);
        }
    }
    println!("TOTAL  {:5.1?} | {:5.1?} | {:5.1?}", sums[0].percent(), sums[1].percent(), sums[2].percent());
}
