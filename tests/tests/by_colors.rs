//! Pictures of a flat gel with a contact, every pixel of which obeys the model: C is right however few pixels are bent.

#![allow(clippy::cast_sign_loss, reason = "pixels are not negative")]

use ofc_core::color::lmeds::{self, Weighting};
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Image, Order, Sample};
use ofc_core::solve::{Outcome, Params, solve, workspace_len};
use ofc_tests::linear::{apply, degrees_between, median, nearest_orthogonal, unit};

const WIDTH: usize = 320;
const HEIGHT: usize = 240;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Spoiled {
    No,
    /// Highlights over 10 % and markers over 5 %.
    Spots,
    /// One light reaches only half of the bent part.
    Shadow,
}

type Vector = [f64; 3];

/// A ball pressed into a flat gel, whose contact covers this share: the picture, its normals, and which pixels obey the model.
fn gel(share: f64, spoiled: Spoiled, seed: u64) -> (Vec<u8>, Vec<Vector>, Vec<bool>) {
    let mut rng = Rng::new(seed);
    let steepest = 50.0_f64.to_radians();
    let radius = (share * (WIDTH * HEIGHT) as f64 / core::f64::consts::PI).sqrt();
    let (ball, skirt, slope) = (radius / steepest.sin(), 0.25 * radius, steepest.tan());
    let turn = 2.0 * core::f64::consts::PI * rng.unit();
    let lights = [0.0, 1.0, 2.0].map(|i| {
        let (azimuth, slant) = (turn + i * 2.09 + 0.4 * rng.unit(), (38.0 + 15.0 * rng.unit()).to_radians());
        let strength = 160.0 + 40.0 * rng.unit();
        [slant.sin() * azimuth.cos(), slant.sin() * azimuth.sin(), slant.cos()].map(|c| strength * c)
    });
    let mut spots: Vec<[f64; 4]> = Vec::new();
    if spoiled == Spoiled::Spots {
        for (count, size, kind) in [(70, 6.0, 1.0), (77, 4.0, 0.0)] {
            for _ in 0..count {
                spots.push([
                    rng.unit() * WIDTH as f64,
                    rng.unit() * HEIGHT as f64,
                    size,
                    kind * (20.0 + 120.0 * rng.unit()),
                ]);
            }
        }
    }
    let (mut rgb, mut normals, mut obeys) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..WIDTH * HEIGHT {
        let (x, y) = ((i % WIDTH) as f64 - 159.5, 119.5 - (i / WIDTH) as f64);
        let d = x.hypot(y).max(1e-9);
        let falling = if d < radius {
            d / (ball * ball - d * d).sqrt()
        } else {
            slope / skirt * (radius + skirt - d).max(0.0)
        };
        let normal = unit([falling * x / d, falling * y / d, 1.0]);
        let mut color = lights.map(|l| l.iter().zip(normal).map(|(a, b)| a * b).sum::<f64>());
        let mut obedient = color.iter().all(|&c| c > 0.0);
        if spoiled == Spoiled::Shadow && falling > 0.0 && x > 0.0 {
            color[0] *= 0.15;
            obedient = false;
        }
        for [cx, cy, size, glow] in &spots {
            if ((i % WIDTH) as f64 - cx).hypot((i / WIDTH) as f64 - cy) < *size {
                color = if *glow > 0.0 { color.map(|c| c + glow) } else { [12.0; 3] };
                obedient = false;
            }
        }
        rgb.extend(color.map(|c| (c + 0.8 * rng.normal_pair()[0]).round().clamp(0.0, 255.0) as u8));
        normals.push(normal);
        obeys.push(obedient);
    }
    (rgb, normals, obeys)
}

/// The median error in degrees of the bent pixels that obey the model, with the best orthogonal matrix; `None` where it is refused.
fn error(share: f64, spoiled: Spoiled, seed: u64, weighting: Weighting) -> Option<(f64, bool)> {
    let (rgb, normals, obeys) = gel(share, spoiled, seed);
    let image =
        Image::interleaved(&rgb, WIDTH, HEIGHT, 3 * WIDTH, Sample::U8, Order::Rgb).expect("a picture");
    let params =
        Params { lmeds: lmeds::Params { weighting, ..lmeds::Params::default() }, ..Params::default() };
    let mut workspace = vec![f32::NAN; workspace_len(WIDTH * HEIGHT, params.lmeds.sample_size)];
    let solution = solve(&image, &params, &mut workspace).expect("enough pixels");
    if solution.outcome != Outcome::Solved {
        return None;
    }
    let root = solution.ellipsoid.expect("an ellipsoid").root;
    let mut correlation = [[0.0; 3]; 3];
    let bent: Vec<(Vector, Vector)> = normals
        .iter()
        .zip(rgb.as_chunks::<3>().0)
        .zip(&obeys)
        .filter(|((normal, _), obeys)| **obeys && normal[2] < 0.9999)
        .map(|((normal, rgb), _)| (*normal, unit(apply(root, rgb.map(f64::from)))))
        .collect();
    for (truth, found) in &bent {
        for (row, t) in correlation.iter_mut().zip(truth) {
            row.iter_mut().zip(found).for_each(|(entry, n)| *entry += t * n);
        }
    }
    let rotation = nearest_orthogonal(correlation);
    let errors: Vec<f64> =
        bent.iter().map(|(truth, found)| degrees_between(*truth, apply(rotation, *found))).collect();
    Some((median(&errors), solution.fit.expect("a fit").by_colors))
}

#[test]
fn a_flat_majority_does_not_hide_the_contact() {
    for (spoiled, limit) in [(Spoiled::No, 0.7), (Spoiled::Spots, 1.0), (Spoiled::Shadow, 1.0)] {
        for percent in [2, 5, 10, 20, 30, 40, 50, 60] {
            for seed in 1..=2 {
                let found = error(f64::from(percent) / 100.0, spoiled, seed, Weighting::Auto);
                let before = error(f64::from(percent) / 100.0, spoiled, seed, Weighting::Pixels);
                println!("{spoiled:?} {percent} % seed {seed}: {found:?}, all pixels alike {before:?}");
                let (found, _) = found.unwrap_or_else(|| panic!("{spoiled:?} {percent}: refused"));
                assert!(found <= limit, "{spoiled:?} {percent} %: {found}");
            }
        }
    }
    // Without the weights the smallest contact is not found at all.
    assert!(error(0.02, Spoiled::No, 1, Weighting::Pixels).is_none_or(|(error, _)| error > 2.0));
}
