//! Rows instead of pictures: the answer of a cold start is that of the whole picture.

use ofc_core::color::lmeds::Method;
use ofc_core::light::tilt::TiltEstimator;
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Image, Order, Sample, Window};
use ofc_core::solve::{Finding, Outcome, SlantFallback};
use ofc_core::stream::{Params, Pass};
use ofc_core::surface::normals::{self, Length};
use ofc_tests::bust::bust;
use ofc_tests::camera::{Camera, apart, digits, direct, methods, portrait, sampling, whole};
use ofc_tests::linear::dot;
use ofc_tests::linear_scenes::{
    Layout, Scene, cylinder, direction, ellipsoid, plane, sphere, table_1_f, three_lights,
};
use ofc_tests::photographs::load;
use ofc_tests::shaded_scenes::{self, median_error};
use ofc_tests::tolerances::{SAMPLED_ANGLE, SAMPLED_STRENGTH};

/// Sample, model, tilts, choice and inliers of rows are those of the picture, to the bit, and normals nearly so.
fn assert_same(image: &Image, params: Params) -> (Outcome, usize) {
    let mut expected = whole(image, &params);
    // Streams do not look for reasons.
    expected.finding = Finding::default();
    if let Some([alone]) = expected.choice.as_mut().map(|choice| &mut choice.candidates[..]) {
        // Not worth a pass.
        alone.integral = f64::INFINITY;
    }
    let mut camera = Camera::new(image, params);
    let pass = camera.cold(image).unwrap();
    assert_eq!(digits(camera.state.solution()), digits(&expected));
    assert_eq!(pass == Pass::Refine, expected.outcome == Outcome::Solved);
    if pass != Pass::Refine {
        return (expected.outcome, 0);
    }
    let choice = expected.choice.as_ref().unwrap();
    let (width, height) = (image.width(), image.height());
    let mut picture = vec![0.0; width * height * 3];
    let bits = |window: &_| expected.inliers.bits(window);
    normals::compute(image, bits, &choice.orientation.f_inverse, Length::Unit, &mut picture, width * 3)
        .unwrap();
    let mut mask = vec![0; width * height];
    expected.inliers.mark(image, &mut mask);
    let (mut row, mut packed, mut flags) = (vec![9.0; width * 3], vec![9; width * 3], vec![9; width]);
    for y in 0..height {
        let view = image.row(y).unwrap();
        camera.state.normals(&view, &mut row).unwrap();
        camera.state.packed_normals(&view, &mut packed).unwrap();
        camera.state.inliers(&view, &mut flags).unwrap();
        let expected = &picture[y * width * 3..][..width * 3];
        // A picture's normals are computed in single precision, a row's in double.
        assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-5), "row {y}");
        let mut window = Window::new();
        for (x, found) in row.as_chunks::<3>().0.iter().enumerate().filter(|(x, _)| flags[*x] != 0) {
            view.read(x, 0, &mut window);
            let wanted = normals::normal(&choice.orientation.f_inverse, window.pixel(0), Length::Unit);
            assert_eq!(*found, wanted.map(|component| component as f32), "row {y}");
        }
        assert_eq!(flags, mask[y * width..][..width]);
        for (i, (&byte, &component)) in packed.iter().zip(expected).enumerate() {
            let normal =
                if flags[i / 3] == 0 { 0.0 } else { f64::midpoint(f64::from(component), 1.0) * 255.0 };
            assert!((f64::from(byte) - normal).abs() <= 0.5 + 1e-4, "row {y}: {byte} for {component}");
        }
    }
    (Outcome::Solved, choice.candidates.len())
}

#[test]
fn a_sample_of_everything_gives_the_same_bits() {
    let mut rng = Rng::new(3);
    let formats = [Sample::U8, Sample::U16, Sample::F32];
    // Figure 1: two pairs of slants agree with these tilts.
    let ambiguous = [(150.0, 40.0, 20.0), (170.0, 30.0, -120.0), (200.0, 5.0, 0.0)]
        .map(|(strength, slant, tilt)| direction(slant, tilt).map(|component| component * strength));
    let (mut solved, mut chosen, mut shaded) = (0, 0, 0);
    for (width, height) in [(110, 90), (64, 65), (63, 71), (130, 63), (65, 64), (30, 27)] {
        let radius = 0.45 * width.min(height) as f64;
        let bodies = [
            Scene::render(width, height, three_lights(), sphere(radius / 0.6, 36.0)),
            Scene::render(width, height, ambiguous, sphere(radius / 0.7, 44.0)),
            Scene::render(width, height, table_1_f(), ellipsoid([radius, 0.9 * radius, radius], 30.0)),
        ];
        for body in bodies {
            let noisy = body.with_noise(0.7, &mut rng);
            for (sample, order) in formats.into_iter().zip([Some(Order::Rgb), Some(Order::Bgra), None]) {
                let scene = if sample == Sample::F32 { noisy.clone() } else { noisy.clone().rounded() };
                let encoded = scene.encode_as(Layout { sample, order, gap: 12 });
                let usable = scene.colors.iter().filter(|c| c.iter().any(|&v| v > 0.0)).count();
                // All pixels, and with the direct method exactly as many as there are: windows are all there where there is room for all pixels, usable or not.
                let alone = direct(sampling(usable as u32));
                for params in methods(sampling((width * height) as u32)).into_iter().chain([alone]) {
                    let (outcome, candidates) = assert_same(&encoded.image(), params);
                    solved += usize::from(outcome == Outcome::Solved);
                    chosen += usize::from(candidates > 1);
                    shaded += usize::from(whole(&encoded.image(), &params).pixel_counts.shaded > 0);
                }
            }
        }
    }
    let mut in_portraits = 0;
    for seed in 0..3 {
        let portrait = shaded_scenes::Scene::new(320, 240, &shaded_scenes::PAPER, bust(240.0))
            .with_noise(0.3, seed)
            .quantized();
        let params = sampling(320 * 240);
        assert_same(&portrait.whole(), params);
        in_portraits += usize::from(whole(&portrait.whole(), &params).pixel_counts.shaded > 1000);
    }
    println!(
        "{solved} solved, {chosen} of them with a choice, {shaded} with shadows and {in_portraits} portraits"
    );
    assert!(solved > 150 && chosen > 0 && chosen < solved && shaded > 0 && in_portraits > 0);
}

#[test]
fn one_pixel_less_than_everything_gives_other_bits() {
    let scene =
        Scene::render(64, 64, three_lights(), sphere(48.0, 36.0)).with_noise(0.7, &mut Rng::new(3)).rounded();
    let usable = scene.colors.iter().filter(|c| c.iter().any(|&v| v > 0.0)).count();
    let encoded = scene.encode();
    let params = sampling(usable as u32 - 1);
    let mut camera = Camera::new(&encoded.image(), params);
    camera.cold(&encoded.image()).unwrap();
    assert_ne!(digits(camera.state.solution()), digits(&whole(&encoded.image(), &params)));
}

#[test]
fn degenerate_scenes_are_refused_like_pictures() {
    let mut rng = Rng::new(4);
    let mut outcomes = Vec::new();
    for scene in [
        Scene::render(70, 60, three_lights(), cylinder(40.0, 0.3, 40.0)),
        Scene::render(70, 60, three_lights(), plane([0.1, 0.2, 0.97])),
        Scene::paint(70, 60, |x, y| [200.0 - x as f64, 50.0 + y as f64, 40.0]),
        Scene::paint(70, 60, |x, _| [x as f64 + 1.0; 3]),
    ] {
        let layout = Layout { sample: Sample::U8, order: Some(Order::Rgb), gap: 0 };
        let encoded = scene.with_noise(0.5, &mut rng).rounded().encode_as(layout);
        outcomes.extend(methods(sampling(4200)).map(|params| assert_same(&encoded.image(), params).0));
    }
    assert!(
        outcomes.contains(&Outcome::RankDeficient) && !outcomes.contains(&Outcome::Solved),
        "{outcomes:?}"
    );
    // Few enough colors to fit anything: the noise is that of neighbors, in a row.
    let few = Scene::paint(70, 60, |x, y| {
        let level = |i: usize| 40.0 + 20.0 * (i % 7) as f64;
        [level(x / 10), level(y / 10), level((x + y) / 20)]
    });
    let encoded = few.encode_as(Layout { sample: Sample::U8, order: Some(Order::Rgb), gap: 0 });
    println!("{:?}", methods(sampling(4200)).map(|params| assert_same(&encoded.image(), params)));
}

#[test]
fn parameters_reach_every_pass() {
    let scene =
        Scene::render(70, 60, three_lights(), sphere(48.0, 36.0)).with_noise(0.7, &mut Rng::new(3)).rounded();
    let encoded = scene.encode();
    let image = encoded.image();
    let base = direct(sampling(4200));
    let mut outcomes = Vec::new();
    for fallback in [SlantFallback::Refuse, SlantFallback::LeastSquares] {
        for tilts in
            [TiltEstimator::Pentland, TiltEstimator::Given([0.3, 2.4, -1.8]), TiltEstimator::Given([0.0; 3])]
        {
            for method in [Method::LeastMedian, Method::LeastSquares] {
                let mut params = base;
                (params.solve.fallback, params.solve.tilts, params.solve.lmeds.method) =
                    (fallback, tilts, method);
                params.solve.saturation = Some(180.0);
                params.solve.lmeds.seed = 77;
                outcomes.push(assert_same(&image, params).0);
            }
        }
    }
    assert!(
        outcomes.contains(&Outcome::Solved) && outcomes.contains(&Outcome::NoConsistentSlants),
        "{outcomes:?}"
    );
}

#[test]
fn frames_too_low_for_cells_take_the_direct_method() {
    let strip = Scene::paint(400, 3, |x, y| {
        let (a, b) = (0.004 * (x as f64 - 199.5), 0.6 * (1.0 - y as f64));
        let normal = [a.sin(), a.cos() * b.sin(), a.cos() * b.cos()];
        three_lights().map(|row| dot(row, normal))
    });
    let encoded = strip.with_noise(0.5, &mut Rng::new(8)).encode();
    let image = encoded.image();
    let mut camera = Camera::new(&image, sampling(1200));
    assert_eq!(camera.frame(&image), Ok(Pass::Outward));
    assert_eq!(camera.frame(&image), Ok(Pass::Tilts));
    println!("{:?}", assert_same(&image, sampling(1200)));
    // Nor is the joint method taken where the tilts are given.
    let mut params = sampling(1200);
    params.solve.tilts = TiltEstimator::Given([0.3, 2.4, -1.8]);
    let mut camera = Camera::new(&image, params);
    assert_eq!(camera.frame(&image), Ok(Pass::Tilts));
    println!("{:?}", assert_same(&image, params));
}

#[test]
fn masked_photographs_give_the_same_bits() {
    for name in ["cat_figurine", "gelsight_ball_6mm", "gelsight_ball_9mm"] {
        let Some(photograph) = load(name) else { return };
        // Of a larger picture solve() takes some numbers from a sample of its rows.
        let (whole, most) = (photograph.image(), 131_071);
        let height = whole.height().min(most / whole.width());
        let image = whole.crop([0, (whole.height() - height) / 2], [whole.width(), height]).expect("a part");
        let params = sampling((image.width() * image.height()) as u32);
        println!("{name}: {:?}", methods(params).map(|params| assert_same(&image, params)));
    }
}

#[test]
fn a_sample_of_a_portrait() {
    println!("against solve: largest angle of F's rows, strength; median error of the normals of both");
    for (seed, params) in (0..8).flat_map(|seed| methods(Params::default()).map(|params| (seed, params))) {
        let (mut params, scene) = (params, portrait(params.solve.orientation_method, seed));
        params.solve.lmeds.seed = seed;
        let image = scene.whole();
        let mut picture = params;
        picture.solve.lmeds.sample_size = 10_000;
        let expected = whole(&image, &picture).choice.unwrap().orientation;
        let mut camera = Camera::new(&image, params);
        assert_eq!(camera.cold(&image), Ok(Pass::Refine));
        let used = camera.state.solution().fit.unwrap().usable;
        let room = params.solve.lmeds.sample_size as usize;
        assert!(used >= room / 2 && used <= room, "{used}");
        let found = camera.state.orientation().unwrap();
        let (angle, strength) = apart(&found.f, &expected.f);
        let errors = [found, &expected].map(|orientation| median_error(&scene, &orientation.f_inverse));
        println!(
            "{:?} {:?}, {seed}: {angle:.2} deg, {strength:.4}; {:.2}, {:.2} deg",
            params.solve.orientation_method, params.solve.shadow_rejection, errors[0], errors[1]
        );
        assert!(angle < SAMPLED_ANGLE && strength < SAMPLED_STRENGTH);
        assert!(errors[0] < errors[1] + SAMPLED_ANGLE);
    }
}

#[test]
fn samples_of_photographs() {
    println!("against solve: largest angle of F's rows, strength");
    for name in ["cat_figurine", "gelsight_ball_6mm", "gelsight_ball_9mm"] {
        let Some(photograph) = load(name) else { return };
        let image = photograph.image();
        for params in [Params::default(), sampling(8192)] {
            let expected = whole(&image, &params).choice.unwrap().orientation;
            let mut camera = Camera::new(&image, params);
            assert_eq!(camera.cold(&image), Ok(Pass::Refine));
            let (angle, strength) = apart(&camera.state.orientation().unwrap().f, &expected.f);
            println!("{name} {}: {angle:.2} deg, {strength:.4}", params.solve.lmeds.sample_size);
            assert!(angle < SAMPLED_ANGLE && strength < SAMPLED_STRENGTH);
        }
    }
}
