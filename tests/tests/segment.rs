//! Segmentation: two spheres of different material and light, noise, what cannot be segmented, bad input.

use ofc_core::color::rank::patches::{self, Refused, patches};
use ofc_core::color::rank::{Class, rank};
use ofc_core::color::segment::{Params, Regions, SegmentError, colors_len, mark, segment};
use ofc_core::picture::{Image, Order, Sample, Usable};
use ofc_core::solve::{self, Outcome};
use ofc_tests::photographs;
use ofc_tests::shaded_scenes::{CLEAN, Light, OTHER, Scene, cap, dot, lopsided, median_error, moved};

const WIDTH: usize = 320;
const HEIGHT: usize = 160;

/// A sphere on the left, another on the right, black between; and the truth, 1 left and 2 right.
fn two_spheres(noise: f64, seed: u64) -> (Scene, Vec<u8>) {
    let left = Scene::new(WIDTH, HEIGHT, &CLEAN, moved(cap(128.0, 70.0), [-78.0, 0.0]));
    let right = Scene::new(WIDTH, HEIGHT, &OTHER, moved(cap(110.0, 60.0), [80.0, 5.0]));
    let truth =
        left.mask.iter().zip(&right.mask).map(|(&l, &r)| u8::from(l > 0) + 2 * u8::from(r > 0)).collect();
    let scene = left.behind(&right);
    (if noise > 0.0 { scene.with_noise(noise, seed).quantized() } else { scene }, truth)
}

fn run(image: &Image, params: &Params) -> (Vec<u16>, Regions) {
    let pixels = image.width() * image.height();
    let (mut labels, mut colors, mut queue) =
        (vec![77; pixels], vec![f32::NAN; colors_len(pixels)], vec![u32::MAX; pixels]);
    let usable = Usable::below(image.sample().saturation());
    let regions = segment(image, usable, params, &mut labels, &mut colors, &mut queue).expect("parameters");
    (labels, regions)
}

/// For each true region: the label most of it has, the share with that label, and the share of that label elsewhere.
fn scores(labels: &[u16], truth: &[u8], count: u8) -> Vec<(u16, f64, f64)> {
    (1..=count)
        .map(|region| {
            let inside = |label: u16| {
                labels.iter().zip(truth).filter(|&(&l, &t)| t == region && l == label).count() as f64
            };
            let size = labels.iter().zip(truth).filter(|&(_, &t)| t == region).count() as f64;
            let label = (1..=16).max_by(|&a, &b| inside(a).total_cmp(&inside(b))).unwrap_or(0);
            let all = labels.iter().filter(|&&l| l == label).count() as f64;
            (label, inside(label) / size, 1.0 - inside(label) / all)
        })
        .collect()
}

#[test]
fn two_spheres_are_two_regions() {
    for (noise, least) in [(0.0, 0.999), (0.5, 0.999), (1.0, 0.996), (2.0, 0.945)] {
        for seed in 0..3 {
            let (scene, truth) = two_spheres(noise, seed);
            let (labels, regions) = run(&scene.image(), &Params { seed, ..Params::default() });
            let scores = scores(&labels, &truth, 2);
            println!("noise {noise}: {} regions, {scores:.3?}", regions.len());
            assert_ne!(scores[0].0, scores[1].0);
            for &(label, inside, elsewhere) in &scores {
                assert!(inside > least && elsewhere < 0.02, "noise {noise}: {scores:?}");
                let region = regions.iter().find(|region| region.label == label).unwrap();
                assert_eq!(region.pixels, labels.iter().filter(|&&l| l == label).count());
                assert!(region.rank.is_some_and(|rank| rank.is_full()));
            }
        }
    }
}

#[test]
fn each_region_has_its_own_ellipsoid() {
    let (scene, truth) = two_spheres(0.0, 0);
    let (labels, regions) = run(&scene.image(), &Params::default());
    for (&(label, ..), side) in scores(&labels, &truth, 2).iter().zip(1..) {
        let region = regions.iter().find(|region| region.label == label).unwrap();
        let c = ofc_core::color::ellipsoid::matrix(&region.coefficients);
        for (&color, _) in scene.colors.iter().zip(&truth).filter(|&(_, &t)| t == side) {
            let form = dot(color, c.map(|row| dot(row, color)));
            assert!((form - 1.0).abs() < 1e-3, "{form}");
        }
    }
}

#[test]
fn solve_works_on_one_label() {
    let (scene, truth) = two_spheres(0.5, 1);
    let (labels, _) = run(&scene.image(), &Params::default());
    let params = solve::Params::default();
    let mut workspace = vec![0.0; solve::workspace_len(WIDTH * HEIGHT, params.lmeds.sample_size)];
    for (label, ..) in scores(&labels, &truth, 2) {
        let mut mask = vec![9; WIDTH * HEIGHT];
        mark(&labels, label, &mut mask);
        let image = scene.whole().with_mask(&mask, WIDTH).unwrap();
        let solution = solve::solve(&image, &params, &mut workspace).unwrap();
        assert_eq!(solution.outcome, Outcome::Solved);
        let mut part = two_spheres(0.5, 1).0;
        part.mask.clone_from(&mask);
        let error = median_error(&part, &solution.choice.unwrap().orientation.f_inverse);
        println!("label {label}: median error {error:.2} degrees");
        assert!(error < 1.2);
    }
}

#[test]
fn one_brightness_step_is_enough() {
    // The same lights on paint that is 25 % darker, on one surface.
    let (width, height) = (240, 160);
    let whole = Scene::new(width, height, &CLEAN, cap(160.0, 100.0));
    let darker = CLEAN.map(|(angles, color)| (angles, color.map(|value| 0.75 * value)));
    let half =
        Scene::new(width, height, &darker, |x, y| if x > 10.0 { cap(160.0, 100.0)(x, y) } else { None });
    let truth: Vec<u8> =
        whole.mask.iter().zip(&half.mask).map(|(&w, &h)| if h > 0 { 2 } else { u8::from(w > 0) }).collect();
    let scene = whole.behind(&half).with_noise(0.7, 4).quantized();
    let (labels, regions) = run(&scene.image(), &Params::default());
    let scores = scores(&labels, &truth, 2);
    println!("{} regions, {scores:.3?}", regions.len());
    assert!(scores.iter().all(|&(_, inside, elsewhere)| inside > 0.99 && elsewhere < 0.01), "{scores:?}");
}

#[test]
fn the_block_of_the_original_suffices_without_noise() {
    let (scene, truth) = two_spheres(0.0, 0);
    let params = Params { spacing: 1, refits: 0, ..Params::default() };
    let (labels, regions) = run(&scene.image(), &params);
    let scores = scores(&labels, &truth, 2);
    println!("spacing 1, no refits: {} regions, {scores:.3?}", regions.len());
    // Six neighbors in f32 are known to one part in 10^7 and C through them to some percent: most of each sphere.
    assert!(scores.iter().all(|&(_, inside, elsewhere)| inside > 0.88 && elsewhere < 0.01));
    assert!(regions.iter().all(|region| region.spacing == 1));
}

/// The classes of a scene's patches of 16 pixels, as (light, surface), row by row.
fn classes(scene: &Scene, noise: f64) -> Vec<(u8, u8)> {
    let image = scene.image();
    let found = patches(&image, Usable::below(f32::INFINITY), 16, noise).expect("parameters");
    found.map(|Class { light, surface }| (light, surface)).collect()
}

const SIZE: usize = 96;

/// A plane on the left, a cylinder in the middle and a ball on the right.
fn three_surfaces(lights: &[Light]) -> Scene {
    let plane = |x: f64, y: f64| (x < -16.0).then_some(0.2 * x + 0.1 * y);
    let cylinder = |x: f64, _: f64| (x.abs() <= 15.0).then(|| (3600.0 - 4.0 * x * x).sqrt());
    let ball = |x: f64, y: f64| (x > 16.0).then(|| (6400.0 - (x - 32.0).powi(2) - y * y).sqrt());
    Scene::new(SIZE, SIZE, lights, plane)
        .behind(&Scene::new(SIZE, SIZE, lights, cylinder))
        .behind(&Scene::new(SIZE, SIZE, lights, ball))
}

#[test]
fn a_patch_says_the_rank_of_its_light_and_of_its_surface() {
    assert_eq!(patches::shape(SIZE, SIZE, 16), [6, 6]);
    // Lights, and what patches of the plane, the cylinder and the ball say.
    for (name, lights, plane, cylinder, ball) in [
        ("three lights", &CLEAN[..], (0, 1), (0, 2), (3, 3)),
        ("two lights", &CLEAN[..2], (0, 1), (0, 2), (2, 3)),
        ("one light", &CLEAN[..1], (0, 1), (1, 0), (1, 0)),
    ] {
        for (noise, scene) in
            [(0.01, three_surfaces(lights)), (0.1, three_surfaces(lights).with_noise(0.1, 3))]
        {
            let classes = classes(&scene, noise);
            for row in classes.chunks_exact(6) {
                assert_eq!(
                    row,
                    [plane, plane, cylinder, cylinder, ball, ball],
                    "{name}, {noise}: {classes:?}"
                );
            }
        }
    }
}

#[test]
fn a_region_says_what_its_patches_do_not() {
    // The ball and the cylinder alone, under two lights and under three.
    for (lights, light) in [(&CLEAN[..2], 2), (&CLEAN[..], 3)] {
        let scene = three_surfaces(lights).with_noise(0.1, 3);
        let image = scene.image();
        let region = rank(&image, |window| window.masked, None).expect("pixels").class();
        assert_eq!((region.light, region.surface), (light, 3));
        let found = patches(&image, Usable::below(f32::INFINITY), 16, 0.1).expect("parameters");
        for (i, class) in found.map(|class| class.under(region.light)).enumerate() {
            let surface = [1, 1, 2, 2, 3, 3][i % 6];
            assert_eq!((class.light, class.surface), (light, surface));
        }
    }
}

#[test]
fn patches_at_the_edges_may_be_smaller_and_need_half_of_their_pixels() {
    // 16 times 6 and 4 more; the last patches are 4 x 16, 16 x 4 and 4 x 4.
    let (width, height) = (100, 100);
    let scene = Scene::new(width, height, &CLEAN, |x, y| Some((8000.0 - x * x - y * y).sqrt()));
    let usable = Usable::below(f32::INFINITY);
    let all: Vec<Class> = patches(&scene.image(), usable, 16, 0.01).expect("parameters").collect();
    assert_eq!(patches::shape(width, height, 16), [7, 7]);
    assert_eq!(all, [Class { light: 3, surface: 3 }; 49]);
    // All but just under half of each patch is masked out, or just half.
    for (rows, class) in [(7, Class::default()), (8, Class { light: 3, surface: 3 })] {
        let mask: Vec<u8> = (0..width * height).map(|i| u8::from(i / width % 16 < rows)).collect();
        let image = scene.whole().with_mask(&mask, width).expect("sizes agree");
        let found: Vec<Class> = patches(&image, usable, 16, 0.01).expect("parameters").collect();
        assert_eq!(found[..42], [class; 42]);
        // The rows of the last patches are all there.
        assert_eq!(found[42..], [Class { light: 3, surface: 3 }; 7]);
    }
    for (side, noise) in [(2, 0.2), (65, 0.2), (16, 0.0), (16, -1.0), (16, f64::NAN), (16, f64::INFINITY)] {
        assert!(matches!(patches(&scene.image(), usable, side, noise).map(drop), Err(Refused)));
    }
}

#[test]
fn what_has_no_ellipsoid_has_no_region() {
    let gray: Vec<Light> = CLEAN.iter().map(|&(angles, _)| (angles, [100.0; 3])).collect();
    for scene in [
        Scene::new(64, 64, &gray, lopsided(32.0)),
        Scene::new(64, 64, &CLEAN, |_, _| None),
        Scene::new(64, 64, &CLEAN, |x, y| Some(0.1 * x + 0.2 * y)),
        Scene::new(3, 2, &CLEAN, cap(20.0, 10.0)),
        Scene::new(1, 1, &CLEAN, cap(20.0, 10.0)),
    ] {
        let (labels, regions) = run(&scene.quantized().image(), &Params::default());
        assert!(regions.is_empty(), "{regions:?}");
        assert!(labels.iter().all(|&label| label == 0));
    }
}

#[test]
fn the_seed_fixes_everything_and_dirt_does_not_matter() {
    let (scene, _) = two_spheres(1.0, 2);
    let pixels = WIDTH * HEIGHT;
    let usable = Usable::below(255.0);
    let params = Params { seed: 3, ..Params::default() };
    let (labels, regions) = run(&scene.image(), &params);
    let (mut more, mut colors, mut queue) =
        (vec![5; pixels + 3], vec![1e30; colors_len(pixels) + 3], vec![0; pixels + 3]);
    let again = segment(&scene.image(), usable, &params, &mut more, &mut colors, &mut queue).unwrap();
    assert_eq!(regions, again);
    assert_eq!(labels, more[..pixels]);
    assert_eq!(more[pixels..], [5; 3]);
    assert_eq!(colors[colors_len(pixels)..], [1e30; 3]);
    assert_eq!(queue[pixels..], [0; 3]);
}

#[test]
fn bad_input_is_refused_and_nothing_written() {
    let scene = Scene::new(32, 32, &CLEAN, cap(40.0, 15.0));
    let usable = Usable::below(f32::INFINITY);
    let good = Params::default();
    let run = |params: &Params, labels_len, colors_len, queue_len| {
        let (mut labels, mut colors, mut queue) =
            (vec![7; labels_len], vec![0.0; colors_len], vec![0; queue_len]);
        let result = segment(&scene.image(), usable, params, &mut labels, &mut colors, &mut queue);
        if result.is_err() {
            assert!(labels.iter().all(|&label| label == 7));
        }
        result.map(|_| ())
    };
    assert_eq!(run(&good, 1024, 3072, 1024), Ok(()));
    assert_eq!(run(&good, 1023, 3072, 1024), Err(SegmentError::LabelsTooShort));
    assert_eq!(run(&good, 1024, 3071, 1024), Err(SegmentError::WorkspaceTooShort));
    assert_eq!(run(&good, 1024, 3072, 1023), Err(SegmentError::WorkspaceTooShort));
    for bad in [
        Params { tolerance: 0.0, ..good },
        Params { tolerance: f64::NAN, ..good },
        Params { min_pixels: 11, ..good },
        Params { max_regions: 0, ..good },
        Params { max_regions: 17, ..good },
        Params { blocks: 0, ..good },
        Params { spacing: 65, ..good },
        Params { reach: 0, ..good },
        Params { refits: 101, ..good },
    ] {
        assert_eq!(run(&bad, 1024, 3072, 1024), Err(SegmentError::Params), "{bad:?}");
    }
    // Values that are not finite are no pixels.
    let bytes: Vec<u8> = std::iter::repeat_n(f32::NAN.to_ne_bytes(), 3 * 1024).flatten().collect();
    let image = Image::interleaved(&bytes, 32, 32, 32 * 12, Sample::F32, Order::Rgb).unwrap();
    assert!(self::run(&image, &good).1.is_empty());
}

/// Shares of the object that the largest region has: 1.00, 0.975 and 0.798. The rest is shadow, or bent by near lights.
#[test]
fn photographs_are_mostly_one_region() {
    for (name, least) in [("gelsight_ball_6mm", 0.99), ("gelsight_ball_9mm", 0.96), ("cat_figurine", 0.78)] {
        let Some(photo) = photographs::load(name) else { return };
        let image = photo.image();
        let (_, regions) = run(&image, &Params { tolerance: 0.2, ..Params::default() });
        let object = photo.mask.iter().filter(|&&mask| mask > 0).count();
        let shares: Vec<f64> = regions.iter().map(|region| region.pixels as f64 / object as f64).collect();
        println!("{name}: {object} pixels, regions {shares:.3?}");
        assert!(shares.iter().copied().fold(0.0, f64::max) > least, "{name}: {shares:.3?}");
    }
}
