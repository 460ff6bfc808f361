//! Streams, rows and memory that are refused, and what a refusal leaves behind.

use ofc_core::color::lmeds::FitError;
use ofc_core::light::tilt::TiltEstimator;
use ofc_core::math::arena::Need;
use ofc_core::picture::{Image, Order, Sample};
use ofc_core::solve::{OrientationMethod, SlantFallback};
use ofc_core::stream::{Memory, Params, Pass, State, Stream, StreamError, places_len, values_len};
use ofc_tests::camera::{Camera, digits, direct, portrait, sampling};
use ofc_tests::linear_scenes::{Layout, Scene};

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
