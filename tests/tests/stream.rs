//! Rows instead of pictures.

use ofc_core::color::lmeds::{FitError, Method};
use ofc_core::light::constrained_slant::WORKSPACE_LEN;
use ofc_core::light::tilt::TiltEstimator;
use ofc_core::math::arena::Need;
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Image, Order, Sample};
use ofc_core::solve::{
    Finding, OrientationMethod, Outcome, ShadowRejection, SlantFallback, Solution, solve, workspace_len,
};
use ofc_core::stream::{Change, Memory, Params, Pass, State, Stream, StreamError, places_len, values_len};
use ofc_core::surface::normals::{self, Length};
use ofc_tests::bust::bust;
use ofc_tests::linear::{Matrix, degrees_between, dot, length};
use ofc_tests::linear_scenes::{
    Layout, Scene, cylinder, direction, ellipsoid, plane, sphere, table_1_f, three_lights,
};
use ofc_tests::photographs::load;
use ofc_tests::shaded_scenes::{self, median_error};
use ofc_tests::tolerances::{SAMPLED_ANGLE, SAMPLED_STRENGTH};

/// A stream over buffers of its own.
struct Camera {
    state: State,
    boxes: Vec<f64>,
    values: Vec<f32>,
    places: Vec<u8>,
}

impl Camera {
    fn new(image: &Image, params: Params) -> Self {
        let (width, height, sample) = (image.width(), image.height(), params.solve.lmeds.sample_size);
        let state = State::new(width, height, image.sample(), params).unwrap();
        // Whatever the memory holds, it means nothing.
        let values = vec![f32::NAN; values_len(width, height, sample, params.solve.orientation_method)];
        let (boxes, places) = (vec![f64::NAN; WORKSPACE_LEN], vec![0xa5; places_len(width, height, sample)]);
        Self { state, boxes, values, places }
    }

    fn stream(&mut self) -> Stream<'_> {
        let memory = Memory { boxes: &mut self.boxes, values: &mut self.values, places: &mut self.places };
        Stream::new(&mut self.state, memory).unwrap()
    }

    /// One frame.
    fn frame(&mut self, image: &Image) -> Result<Pass, StreamError> {
        self.stream().begin().unwrap();
        for y in 0..image.height() {
            // As if the caller had been away between any two rows.
            self.stream().row(y, &image.row(y).unwrap()).unwrap();
        }
        self.stream().end()
    }

    /// Frames until there is an answer, at most five.
    fn cold(&mut self, image: &Image) -> Result<Pass, StreamError> {
        let mut pass = self.frame(image)?;
        for expected in [Pass::Outward, Pass::Integrability, Pass::Tilts, Pass::Slants] {
            if pass == expected {
                pass = self.frame(image)?;
            }
        }
        Ok(pass)
    }
}

fn sampling(sample_size: u32) -> Params {
    let mut params = Params::default();
    params.solve.lmeds.sample_size = sample_size;
    params
}

/// The direct method, as streams take it without the feature `full-streams`.
fn direct(mut params: Params) -> Params {
    params.solve.orientation_method = OrientationMethod::Direct;
    params
}

/// Both methods, with shadow rejection and without.
fn methods(params: Params) -> [Params; 4] {
    let with = |mut params: Params, shadow_rejection| {
        params.solve.shadow_rejection = shadow_rejection;
        params
    };
    [params, with(params, ShadowRejection::Off), direct(params), with(direct(params), ShadowRejection::On)]
}

fn whole(image: &Image, params: &Params) -> Solution {
    let pixels = image.width() * image.height();
    let mut workspace = vec![0.0; workspace_len(pixels, params.solve.lmeds.sample_size)];
    solve(image, &params.solve, &mut workspace).unwrap()
}

/// Every number of a solution, with its bits: shortest round-trip digits, and the sign of zero.
fn digits(solution: &Solution) -> String {
    format!("{solution:?}")
}

/// Sample, model, tilts, choice, normals and inliers of rows are those of the picture, to the bit.
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
        assert!(row.iter().zip(expected).all(|(a, b)| a.to_bits() == b.to_bits()), "row {y}");
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
        let image = photograph.image();
        let params = sampling((image.width() * image.height()) as u32);
        println!("{name}: {:?}", methods(params).map(|params| assert_same(&image, params)));
    }
}

/// A bust in QVGA with noise, rounded to bytes, under lights that are well known on that method.
fn portrait(orientation_method: OrientationMethod, seed: u64) -> shaded_scenes::Scene {
    let lights = if orientation_method == OrientationMethod::Joint {
        shaded_scenes::CLEAN
    } else {
        shaded_scenes::PAPER
    };
    shaded_scenes::Scene::new(320, 240, &lights, bust(240.0)).with_noise(1.0, seed).quantized()
}

/// The largest angle between rows of two F, in degrees, and the largest relative difference of their lengths.
fn apart(a: &Matrix, b: &Matrix) -> (f64, f64) {
    let rows = || a.iter().zip(b);
    let angle = rows().map(|(&a, &b)| degrees_between(a, b)).fold(0.0, f64::max);
    (angle, rows().map(|(&a, &b)| (length(a) / length(b) - 1.0).abs()).fold(0.0, f64::max))
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

#[test]
fn frames_that_are_none() {
    let scene = portrait(OrientationMethod::Direct, 1);
    let image = scene.whole();
    let row = |y| image.row(y).unwrap();
    let params = direct(Params::default());
    let mut camera = Camera::new(&image, params);
    let mut stream = camera.stream();
    assert_eq!(stream.row(0, &row(0)), Err(StreamError::NoFrame));
    assert_eq!(stream.end(), Err(StreamError::NoFrame));
    assert_eq!(stream.state().normals(&row(0), &mut [0.0; 960]), Err(StreamError::NotSolved));
    assert_eq!(stream.begin(), Ok(Pass::Colors));
    assert_eq!(stream.row(1, &row(1)), Err(StreamError::RowOrder));
    stream.row(0, &row(0)).unwrap();
    assert_eq!(stream.row(0, &row(0)), Err(StreamError::RowOrder));
    assert_eq!(stream.row(1, &image), Err(StreamError::Row));
    let narrow = Image::interleaved(&[0; 957], 319, 1, 957, Sample::U8, Order::Rgb).unwrap();
    let deep = Image::interleaved(&[0; 1920], 320, 1, 1920, Sample::U16, Order::Rgb).unwrap();
    assert_eq!(stream.row(1, &narrow), Err(StreamError::Row));
    assert_eq!(stream.row(1, &deep), Err(StreamError::Row));
    assert_eq!(stream.end(), Err(StreamError::TooFewRows));
    assert_eq!(stream.end(), Err(StreamError::NoFrame));
    // Nothing of this is remembered, nor of a frame that was begun and left.
    assert_eq!(stream.begin(), Ok(Pass::Colors));
    stream.row(0, &row(100)).unwrap();
    assert_eq!(stream.begin(), Ok(Pass::Colors));
    for y in 0..240 {
        stream.row(y, &row(y)).unwrap();
    }
    assert_eq!(stream.row(240, &row(0)), Err(StreamError::TooManyRows));
    assert_eq!(stream.end(), Ok(Pass::Tilts));
    assert_eq!(stream.begin(), Ok(Pass::Tilts));
    stream.row(0, &row(200)).unwrap();
    assert_eq!(stream.end(), Err(StreamError::TooFewRows));
    let mut other = Camera::new(&image, params);
    other.frame(&image).unwrap();
    camera.cold(&image).unwrap();
    other.cold(&image).unwrap();
    assert_eq!(digits(camera.state.solution()), digits(other.state.solution()));
    assert_eq!(camera.state.normals(&row(0), &mut [0.0; 959]), Err(StreamError::TooShort));
    assert_eq!(camera.state.packed_normals(&row(0), &mut [0; 959]), Err(StreamError::TooShort));
    assert_eq!(camera.state.inliers(&row(0), &mut [0; 319]), Err(StreamError::TooShort));
    assert_eq!(camera.state.normals(&narrow, &mut [0.0; 960]), Err(StreamError::Row));
    camera.stream().restart();
    assert_eq!(camera.state.pass(), Pass::Colors);
    assert!(camera.state.orientation().is_none() && !camera.state.is_concluded());
}

#[test]
fn streams_that_are_none() {
    let new = |width, height, params| State::new(width, height, Sample::U8, params).err();
    let params = Params::default();
    assert_eq!(new(0, 240, params), Some(StreamError::Size));
    assert_eq!(new(320, 0, params), Some(StreamError::Size));
    assert_eq!(new(usize::MAX, 2, params), Some(StreamError::Size));
    assert_eq!(new(320, 240, sampling(23)), Some(StreamError::Params));
    assert_eq!(new(320, 240, sampling(24)), None);
    let mut chojnacki = params;
    chojnacki.solve.tilts = TiltEstimator::Chojnacki;
    assert_eq!(new(320, 240, chojnacki), Some(StreamError::Params));
    let mut fallback = params;
    fallback.solve.fallback = SlantFallback::TiltIntegrability;
    assert_eq!(new(320, 240, fallback), Some(StreamError::Params));
    let mut state = State::new(320, 240, Sample::U8, params).unwrap();
    let (values, places) = (values_len(320, 240, 2048, OrientationMethod::Joint), places_len(320, 240, 2048));
    assert_eq!((values, places), (10_240, 2048));
    assert!(size_of::<State>() + 4 * values + places <= 48 << 10, "{}", size_of::<State>());
    for (short_values, short_places) in [(1, 0), (0, 1)] {
        let (mut values, mut places) = (vec![0.0; values - short_values], vec![0; places - short_places]);
        let memory = Memory { boxes: &mut [], values: &mut values, places: &mut places };
        assert_eq!(Stream::new(&mut state, memory).err(), Some(StreamError::TooShort));
    }
}

#[test]
fn memory_may_be_cut_anew_for_every_pass_but_no_shorter() {
    let scene = portrait(OrientationMethod::Direct, 1);
    let mut camera = Camera::new(&scene.whole(), direct(Params::default()));
    assert_eq!(camera.state.need(), Need::of_singles(10_240));
    assert_eq!(camera.frame(&scene.whole()), Ok(Pass::Tilts));
    let need = camera.state.need();
    assert_eq!(need, Need { doubles: 432, singles: 960, integers: 0 });
    let Camera { state, boxes, values, places } = &mut camera;
    for (missing_boxes, missing_values) in [(1, 0), (0, 1)] {
        let (boxes, values) = (&mut boxes[missing_boxes..], &mut values[..need.singles - missing_values]);
        let stream = Stream::new(state, Memory { boxes, values, places });
        assert_eq!(stream.err(), Some(StreamError::TooShort));
    }
    let mut stream = Stream::new(state, Memory { boxes, values: &mut values[..960], places }).unwrap();
    assert_eq!(stream.begin(), Ok(Pass::Tilts));
    // The pass over colors takes more than this stream has.
    stream.restart();
    assert_eq!(stream.begin(), Err(StreamError::TooShort));
    assert_eq!(stream.row(0, &scene.whole().row(0).unwrap()), Err(StreamError::NoFrame));
}

#[test]
fn dark_and_white_frames_say_so() {
    for (value, expected) in [(0.0, FitError::Dark), (255.0, FitError::Saturated)] {
        let scene = Scene::paint(40, 30, |_, _| [value; 3]);
        let encoded = scene.encode_as(Layout { sample: Sample::U8, order: Some(Order::Rgb), gap: 0 });
        let mut camera = Camera::new(&encoded.image(), Params::default());
        assert_eq!(camera.frame(&encoded.image()), Err(StreamError::Fit(expected)));
        assert_eq!(camera.state.pass(), Pass::Colors);
    }
}

/// A stream that has seen a portrait.
fn solved(params: Params) -> (Camera, shaded_scenes::Scene) {
    let scene = portrait(params.solve.orientation_method, 100);
    let mut camera = Camera::new(&scene.whole(), params);
    assert_eq!(camera.cold(&scene.whole()), Ok(Pass::Refine));
    assert_eq!(camera.state.drift(), None);
    (camera, scene)
}

fn refined(camera: &mut Camera, scene: &shaded_scenes::Scene) -> (f64, Change) {
    assert_eq!(camera.frame(&scene.whole()), Ok(Pass::Refine));
    let drift = camera.state.drift().unwrap();
    (drift.inlier_share, drift.change.unwrap())
}

#[test]
fn frames_of_the_same_scene_refine_the_model() {
    for params in [Params::default(), direct(Params::default())] {
        refine(params);
    }
}

fn refine(params: Params) {
    let (mut camera, _) = solved(params);
    println!(
        "against solve of the frame: angle, strength; against the frame before: share, angle, dispersion"
    );
    for seed in 101..109 {
        let scene = portrait(params.solve.orientation_method, seed);
        let before = camera.state.orientation().unwrap().f;
        let (share, change) = refined(&mut camera, &scene);
        let expected = whole(&scene.whole(), &params).choice.unwrap().orientation;
        let found = camera.state.orientation().unwrap();
        let (angle, strength) = apart(&found.f, &expected.f);
        let largest = change.angles.into_iter().fold(0.0, f64::max).to_degrees();
        println!(
            "{seed}: {angle:.2} deg, {strength:.4}; {share:.3}, {largest:.2} deg, {:.4}",
            change.dispersion
        );
        assert!(angle < SAMPLED_ANGLE && strength < SAMPLED_STRENGTH);
        assert!(share > 0.9 && largest < SAMPLED_ANGLE && (change.dispersion - 1.0).abs() < 0.05);
        // What is reported is what happened.
        for ((angle, strength), (&old, &new)) in
            change.angles.iter().zip(change.strengths).zip(before.iter().zip(&found.f))
        {
            assert!((angle.to_degrees() - degrees_between(old, new)).abs() < 1e-6);
            assert!((strength - length(new) / length(old)).abs() < 1e-12);
        }
    }
}

#[test]
fn warm_frames_look_at_as_many_pixels_as_wanted() {
    let mut seen = Vec::new();
    for refine_pixels in [0, 16_384, 1] {
        let (mut camera, _) = solved(Params { refine_pixels, ..Params::default() });
        refined(&mut camera, &portrait(OrientationMethod::Joint, 101));
        let pixel_counts = camera.state.solution().pixel_counts;
        seen.push(
            pixel_counts.usable
                + pixel_counts.masked_out
                + pixel_counts.non_finite
                + pixel_counts.dark
                + pixel_counts.saturated,
        );
    }
    // 29,000 usable pixels and a third of the others are more than twice 16,384; never less than 16 rows.
    assert_eq!(seen, [320 * 240, 320 * 80, 320 * 16]);
}

#[test]
fn noise_that_comes_and_goes() {
    let picture = |noise, seed| {
        shaded_scenes::Scene::new(320, 240, &shaded_scenes::CLEAN, bust(240.0))
            .with_noise(noise, seed)
            .quantized()
    };
    let first = picture(1.0, 0);
    let mut camera = Camera::new(&first.whole(), Params::default());
    assert_eq!(camera.cold(&first.whole()), Ok(Pass::Refine));
    let (mut dispersion, mut most) = (1.0, 0.0_f64);
    for (seed, noise) in [1.0, 2.0, 3.0, 3.0, 3.0, 2.0, 1.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
        let (share, change) = refined(&mut camera, &picture(noise, seed as u64 + 1));
        dispersion *= change.dispersion;
        most = most.max(dispersion);
        println!("{noise}: share {share:.3}, dispersion {:.3}, {dispersion:.3} in all", change.dispersion);
    }
    assert!(most > 1.5 && (dispersion - 1.0).abs() < 0.1);
    let last = whole(&picture(1.0, 10).whole(), &Params::default()).choice.unwrap().orientation;
    let (angle, strength) = apart(&camera.state.orientation().unwrap().f, &last.f);
    println!("against solve of the last frame: {angle:.2} deg, {strength:.4}");
    assert!(angle < SAMPLED_ANGLE && strength < SAMPLED_STRENGTH);
}

#[test]
fn lights_that_grow_stronger_are_followed() {
    let (mut camera, _) = solved(direct(Params::default()));
    let f = camera.state.orientation().unwrap().f;
    for frame in 1..=20_u32 {
        let gain = 1.0 + 0.02 * f64::from(frame);
        let lights = shaded_scenes::PAPER.map(|(angles, color)| (angles, color.map(|c| c * gain)));
        let brighter = shaded_scenes::Scene::new(320, 240, &lights, bust(240.0));
        refined(&mut camera, &brighter.with_noise(1.0, u64::from(frame)).quantized());
    }
    let (angle, _) = apart(&camera.state.orientation().unwrap().f, &f);
    assert!(angle < SAMPLED_ANGLE, "{angle}");
    for (&new, &old) in camera.state.orientation().unwrap().f.iter().zip(&f) {
        assert!((length(new) / length(old) / 1.4 - 1.0).abs() < SAMPLED_STRENGTH);
    }
}

#[test]
fn other_lights_need_a_cold_start() {
    for (params, lights) in
        [(Params::default(), shaded_scenes::PAPER), (direct(Params::default()), shaded_scenes::CLEAN)]
    {
        changes(params, &lights);
    }
    let params = direct(Params::default());
    // How many must fit is the caller's to say; a black frame fits nobody.
    let (mut strict, _) = solved(Params { smallest_share: 0.99, ..params });
    assert_eq!(strict.frame(&portrait(OrientationMethod::Direct, 100).whole()), Ok(Pass::Colors));
    let (mut lenient, _) = solved(Params { smallest_share: 0.0, ..params });
    let black = Scene::paint(320, 240, |_, _| [0.0; 3]);
    let black = black.encode_as(Layout { sample: Sample::U8, order: Some(Order::Rgb), gap: 0 });
    assert_eq!(lenient.frame(&black.image()), Ok(Pass::Colors));
    assert_eq!(lenient.state.drift().map(|drift| drift.inlier_share), Some(0.0));
}

fn changes(params: Params, lights: &[shaded_scenes::Light]) {
    let (mut camera, _) = solved(params);
    let before = digits(camera.state.solution());
    let other = shaded_scenes::Scene::new(320, 240, lights, bust(240.0)).with_noise(1.0, 7).quantized();
    assert_eq!(camera.frame(&other.whole()), Ok(Pass::Colors));
    let drift = *camera.state.drift().unwrap();
    println!("{drift:?}");
    assert!(drift.inlier_share < 0.5 && drift.change.is_none());
    // The old model is as it was, and serves until there is a new one.
    assert_eq!(digits(camera.state.solution()), before);
    assert!(camera.state.orientation().is_some());
    assert_eq!(camera.cold(&other.whole()), Ok(Pass::Refine));
    assert_eq!(camera.state.drift(), None);
    // As a stream that had never seen anything else.
    let mut fresh = Camera::new(&other.whole(), params);
    fresh.cold(&other.whole()).unwrap();
    assert_eq!(digits(camera.state.solution()), digits(fresh.state.solution()));
}

#[test]
fn an_exact_scene_stays_exact() {
    let scene = Scene::render(110, 90, three_lights(), sphere(60.0, 36.0));
    let encoded = scene.encode();
    let mut camera = Camera::new(&encoded.image(), Params::default());
    assert_eq!(camera.cold(&encoded.image()), Ok(Pass::Refine));
    for _ in 0..5 {
        assert_eq!(camera.frame(&encoded.image()), Ok(Pass::Refine));
        let drift = camera.state.drift().unwrap();
        println!("{drift:?}");
        assert!(drift.inlier_share > 0.99);
    }
    let (angle, strength) = apart(&camera.state.orientation().unwrap().f, &three_lights());
    println!("{angle} {strength}");
    assert!(angle < 0.01 && strength < 1e-4);
}
