//! Effective ranks of rendered scenes that lack something, of complete ones, and of the photographs.

use ofc_core::color::inliers::Inliers;
use ofc_core::color::lmeds;
use ofc_core::color::rank::{Class, Rank, rank};
use ofc_core::picture::{Image, Order, Sample, Usable};
use ofc_core::solve::{self, Outcome};
use ofc_tests::photographs;
use ofc_tests::shaded_scenes::{CLEAN, Light, PAPER, Scene, cap, lopsided};

fn ranks(name: &str, image: &Image) -> Rank {
    let params = lmeds::Params::default();
    let mut workspace = vec![0.0; lmeds::workspace_len(image.width() * image.height(), params.sample_size)];
    let usable = Usable::below(image.sample().saturation());
    let fit = lmeds::fit(image, usable, &params, &mut workspace).ok();
    let all = Inliers::all(usable);
    let inliers = fit.map_or(all, |fit| Inliers { residual: fit.band, ..all });
    let rank = rank(image, |window| inliers.bits(window), fit.map(|fit| (fit.z(), fit.residual_deviation)))
        .expect("there are pixels");
    println!(
        "{name:34} colors {} normals {:?}: {:.2?} against {:.3}; {:.3?} against {:.4}",
        rank.colors,
        rank.normals,
        rank.color_deviations,
        rank.color_noise,
        rank.normal_deviations,
        rank.normal_noise
    );
    rank
}

type Make<'a> = &'a dyn Fn() -> Scene;

/// A name and a scene; the ranks of its colors and of its normals, and its class as (light, surface).
type Lacking<'a> = (&'a str, Make<'a>, u32, Option<u32>, (u8, u8));

/// Without noise, rounded, and with noise before it.
fn variants(make: impl Fn() -> Scene, noises: &[f64]) -> Vec<(String, Scene)> {
    let mut all = vec![("exact".into(), make()), ("rounded".into(), make().quantized())];
    for (seed, &noise) in noises.iter().enumerate() {
        all.push((format!("noise {noise}"), make().with_noise(noise, seed as u64).quantized()));
        all.push((format!("noise {noise}, float"), make().with_noise(noise, seed as u64 + 50)));
    }
    all
}

const SIZE: usize = 128;

fn cylinder(x: f64, y: f64) -> Option<f64> {
    let across = 0.8 * x + 0.6 * y;
    (x * x + y * y < 3600.0).then(|| (10000.0 - across * across).sqrt())
}

#[test]
fn complete_scenes_have_rank_three() {
    let makes: [(&str, Make, &[f64]); 5] = [
        ("30 degree cap", &|| Scene::new(SIZE, SIZE, &CLEAN, cap(128.0, 60.0)), &[0.5, 1.0, 2.0]),
        ("15 degree cap", &|| Scene::new(SIZE, SIZE, &CLEAN, cap(240.0, 60.0)), &[0.5, 1.0, 2.0]),
        ("lopsided", &|| Scene::new(SIZE, SIZE, &CLEAN, lopsided(64.0)), &[0.5, 1.0, 2.0]),
        ("cap, paper's lights", &|| Scene::new(SIZE, SIZE, &PAPER, cap(128.0, 60.0)), &[0.5, 1.0]),
        ("hemisphere, paper's lights", &|| Scene::new(SIZE, SIZE, &PAPER, cap(61.0, 60.0)), &[0.5, 1.0]),
    ];
    for (name, make, noises) in makes {
        for (variant, scene) in variants(make, noises) {
            let rank = ranks(&format!("{name}, {variant}"), &scene.image());
            assert!(rank.is_full(), "{name}, {variant}: {rank:?}");
            assert_eq!(rank.class(), Class { light: 3, surface: 3 });
        }
    }
}

/// Under lights that are well apart; rejection cuts the tails of the noise off, by up to a tenth of its deviation.
#[test]
fn the_noise_is_that_of_the_picture() {
    for (seed, noise) in [(0, 0.5), (1, 1.0), (2, 2.0)] {
        let shapes = [
            Scene::new(SIZE, SIZE, &CLEAN, cap(128.0, 60.0)).with_noise(noise, seed),
            Scene::new(SIZE, SIZE, &CLEAN, lopsided(64.0)).with_noise(noise, seed),
        ];
        for scene in shapes {
            let exact = ranks("noise", &scene.image()).color_noise / noise;
            // Rounding is noise of 1 / sqrt(12).
            let rounded = ranks("rounded", &scene.quantized().image()).color_noise;
            let rounded = rounded / (noise * noise + 1.0 / 12.0).sqrt();
            assert!((0.9..1.0).contains(&exact) && (0.9..1.0).contains(&rounded), "{exact} {rounded}");
        }
    }
}

/// Over the disc of a cap n1 and n2 have the mean square (rim / radius)^2 / 4, and n3 the rest of 1.
#[test]
fn the_deviations_of_normals_are_those_of_the_surface() {
    for (radius, rim) in [(128.0, 60.0), (240.0, 60.0)] {
        let rank = ranks("cap", &Scene::new(SIZE, SIZE, &CLEAN, cap(radius, rim)).image());
        let across = f64::powi(rim / radius, 2) / 4.0;
        for (found, square) in rank.normal_deviations.into_iter().zip([1.0 - 2.0 * across, across, across]) {
            assert!((found - square.sqrt()).abs() < 0.002, "{:?}", rank.normal_deviations);
        }
    }
}

#[test]
fn what_lacks_a_dimension_is_found_and_named() {
    let gray: Vec<Light> = CLEAN.iter().map(|&(angles, _)| (angles, [100.0; 3])).collect();
    let plane = |x: f64, y: f64| Some(0.2 * x + 0.1 * y);
    let makes: [Lacking; 6] = [
        ("cylinder", &|| Scene::new(SIZE, SIZE, &CLEAN, cylinder), 2, Some(2), (0, 2)),
        ("cylinder, paper's lights", &|| Scene::new(SIZE, SIZE, &PAPER, cylinder), 2, Some(2), (0, 2)),
        ("two lights", &|| Scene::new(SIZE, SIZE, &CLEAN[..2], lopsided(64.0)), 2, Some(3), (2, 3)),
        ("one light", &|| Scene::new(SIZE, SIZE, &CLEAN[..1], lopsided(64.0)), 1, None, (1, 0)),
        ("gray", &|| Scene::new(SIZE, SIZE, &gray, lopsided(64.0)), 1, None, (1, 0)),
        ("plane", &|| Scene::new(SIZE, SIZE, &CLEAN, plane), 1, Some(1), (0, 1)),
    ];
    for (name, make, colors, normals, class) in makes {
        for (variant, scene) in variants(make, &[0.5, 1.0, 2.0]) {
            let rank = ranks(&format!("{name}, {variant}"), &scene.image());
            assert_eq!((rank.colors, rank.normals), (colors, normals), "{name}, {variant}: {rank:?}");
            assert_eq!((rank.class().light, rank.class().surface), class);
        }
    }
}

#[test]
fn photographs_are_what_they_are() {
    let names = ["gelsight_ball_6mm", "gelsight_ball_9mm", "cat_figurine"];
    for name in names {
        let Some(photo) = photographs::load(name) else { return };
        let rank = ranks(name, &photo.image());
        let [.., least] = rank.color_deviations;
        // Twice the threshold and more: 4.3 to 7.9 times the noise.
        assert!(rank.is_full() && least > 4.0 * rank.color_noise, "{name}");
    }
    let Some(groove) = photographs::load("gelsight_groove_rank2") else { return };
    let rank = ranks("groove", &groove.image());
    assert!(!rank.is_full() && rank.normals == Some(2));
}

/// Every press of a ball, inside the radius that is certainly in contact.
#[test]
fn presses_have_rank_three() {
    let Some(folder) = photographs::directory().map(|data| data.join("gelsight_presses")) else { return };
    let table = std::fs::read_to_string(folder.join("presses.csv")).expect("presses.csv");
    for line in table.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let [x, y, _, radius] = [1, 2, 3, 4].map(|i| fields[i].parse::<f64>().expect("a number"));
        let (width, height, rgb) = photographs::read_png(&folder.join(format!("{}.png", fields[0])), 3);
        let inside = |i: usize| (i % width) as f64 - x;
        let mask: Vec<u8> = (0..width * height)
            .map(|i| if inside(i).hypot((i / width) as f64 - y) <= radius { 255 } else { 0 })
            .collect();
        let image = Image::interleaved(&rgb, width, height, width * 3, Sample::U8, Order::Rgb)
            .and_then(|image| image.with_mask(&mask, width))
            .expect("sizes agree");
        assert!(ranks(fields[0], &image).is_full(), "{line}");
    }
}

#[test]
fn solve_refuses_by_rank_and_says_so() {
    let params = solve::Params::default();
    let solve = |scene: &Scene| {
        let mut workspace = vec![0.0; solve::workspace_len(SIZE * SIZE, params.lmeds.sample_size)];
        solve::solve(&scene.image(), &params, &mut workspace).expect("a solution")
    };
    for (variant, scene) in variants(|| Scene::new(SIZE, SIZE, &CLEAN[..2], lopsided(64.0)), &[0.5, 1.0, 2.0])
    {
        let solution = solve(&scene);
        assert_eq!(solution.outcome, Outcome::RankDeficient, "{variant}");
        assert_eq!(solution.rank.map(|rank| rank.colors), Some(2));
    }
    for (variant, scene) in variants(|| Scene::new(SIZE, SIZE, &CLEAN, lopsided(64.0)), &[0.5, 1.0, 2.0]) {
        let solution = solve(&scene);
        assert_eq!(solution.outcome, Outcome::Solved, "{variant}");
        assert!(solution.rank.is_some_and(|rank| rank.is_full()));
    }
}

#[test]
fn no_pixels_have_no_rank() {
    let scene = Scene::new(8, 8, &CLEAN, cap(20.0, 3.0));
    assert_eq!(rank(&scene.image(), |_| 0, None), None);
}
