//! Many frames of one sensor: without labels, with the scale, and with balls of known radius.

use ofc_core::math::arena::Arena;
use ofc_core::orientation::relief::{PixelClass, ReliefError, ScaleSource, need};
use ofc_core::picture::{Image, Order, Sample};
use ofc_core::rig::{self, Advice, Ball, BallsMut, Frame, Model, PACKED, Rig, SIDES};
use ofc_tests::photographs;
use ofc_tests::relief_scenes::{HEIGHT, Kind, RELIEFS, WIDTH, frame};

fn picture(rgb: &[u8], width: usize, height: usize) -> Image<'_> {
    Image::interleaved(rgb, width, height, 3 * width, Sample::U8, Order::Rgb).expect("a picture")
}

struct BallSums {
    count: u32,
    centers: u32,
    products: [f64; PACKED],
    sides: [f64; SIDES],
    squares: f64,
}

impl BallSums {
    fn new() -> Self {
        Self { count: 0, centers: 0, products: [0.0; PACKED], sides: [0.0; SIDES], squares: 0.0 }
    }

    fn view(&mut self) -> BallsMut<'_> {
        BallsMut {
            count: &mut self.count,
            centers: &mut self.centers,
            products: &mut self.products,
            sides: &mut self.sides,
            squares: &mut self.squares,
        }
    }
}

/// A ball that is pressed in.
struct Press {
    rgb: Vec<u8>,
    center: [f64; 2],
    radius: f64,
    /// Within so many pixels of the center it is certain that the ball is there.
    trusted: f64,
}

/// The sensor, its background and its frames.
struct Sensor {
    width: usize,
    height: usize,
    background: Vec<u8>,
    presses: Vec<Press>,
}

fn with_memory<T>(width: usize, height: usize, job: impl FnOnce(Arena) -> T) -> T {
    let need = need(width, height).expect("large enough");
    let (mut singles, mut integers) = (vec![f32::NAN; need.singles], vec![7; need.integers]);
    job(Arena::new(&mut [], &mut singles, &mut integers))
}

fn add(
    rig: &mut Rig,
    balls: Option<(BallsMut, Ball)>,
    image: &Image,
    background: Option<&Image>,
) -> Result<(), ReliefError> {
    let frame = Frame { image, background, saturation: None, seed: 0 };
    with_memory(image.width(), image.height(), |arena| rig::add(rig, &frame, balls, arena, None))
}

fn degrees(a: [f64; 3], b: [f32; 3]) -> f64 {
    let product: f64 = a.iter().zip(b).map(|(a, b)| a * f64::from(b)).sum();
    product.clamp(-1.0, 1.0).acos().to_degrees()
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Calls `visit` with each pixel's class and normal.
fn normals(
    model: &Model,
    image: &Image,
    background: Option<&Image>,
    mut visit: impl FnMut(usize, usize, u8, [f32; 3]),
) {
    let (width, height) = (image.width(), image.height());
    let mut classes = vec![9; width * height];
    with_memory(width, height, |arena| rig::classify(model, image, background, arena, &mut classes))
        .expect("classes");
    rig::normals(model, image, background, &classes, |x, y, normal, deviation| {
        assert_eq!(normal[2].is_finite(), deviation.is_finite());
        visit(x, y, classes[y * width + x], normal);
    })
    .expect("normals");
}

impl Sensor {
    fn read() -> Option<Self> {
        let folder = photographs::directory()?.join("gelsight_rig");
        let (width, height, background) = photographs::read_png(&folder.join("background.png"), 3);
        let list = std::fs::read_to_string(folder.join("presses.csv")).expect("presses");
        let presses = list.lines().skip(1).map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let [x, y, radius, trusted] = [1, 2, 3, 4].map(|i| fields[i].parse::<f64>().expect("a number"));
            let (.., rgb) = photographs::read_png(&folder.join(format!("{}.png", fields[0])), 3);
            Press { rgb, center: [x, y], radius, trusted }
        });
        Some(Self { width, height, background, presses: presses.collect() })
    }

    fn image<'a>(&self, rgb: &'a [u8]) -> Image<'a> {
        picture(rgb, self.width, self.height)
    }

    /// Adds these presses.
    fn rig(&self, presses: &[usize], centers: bool) -> (Rig, BallSums) {
        let (mut rig, mut balls) =
            (Rig::new(self.width, self.height).expect("large enough"), BallSums::new());
        let background = self.image(&self.background);
        for &i in presses {
            let Press { rgb, center, radius, .. } = &self.presses[i];
            let ball = Ball { radius: *radius, center: centers.then_some(*center) };
            add(&mut rig, Some((balls.view(), ball)), &self.image(rgb), Some(&background))
                .expect("a contact");
        }
        (rig, balls)
    }

    /// The median and the mean error of a press in degrees.
    fn error(&self, model: &Model, press: usize) -> [f64; 2] {
        let Press { rgb, center, radius, trusted } = &self.presses[press];
        let mut all = Vec::new();
        normals(model, &self.image(rgb), Some(&self.image(&self.background)), |x, y, _, normal| {
            let (u, v) = ((x as f64 - center[0]) / radius, (center[1] - y as f64) / radius);
            if u.hypot(v) * radius < *trusted && normal[2].is_finite() {
                all.push(degrees([u, v, (1.0 - u * u - v * v).sqrt()], normal));
            }
        });
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        [median(&mut all), mean]
    }
}

/// The median of the medians, the mean of the means and the worst median, and a line of them.
fn summary(name: &str, errors: &[[f64; 2]]) -> [f64; 3] {
    let mut medians: Vec<f64> = errors.iter().map(|[median, _]| *median).collect();
    let mean = errors.iter().map(|[_, mean]| mean).sum::<f64>() / errors.len() as f64;
    let middle = median(&mut medians);
    let worst = medians[medians.len() - 1];
    println!("{name}: median {middle:.2}, mean {mean:.2}, worst {worst:.2} over {}", medians.len());
    [middle, mean, worst]
}

#[test]
fn frames_of_a_tactile_sensor() {
    let Some(sensor) = Sensor::read() else {
        println!("skipped: no photographs beside the project");
        return;
    };
    let count = sensor.presses.len();
    // Presses that are judged, a third of all, and those that the rig learns from.
    let splits = (0..3).map(|split| {
        let (judged, learned): (Vec<usize>, Vec<usize>) = (0..count).partition(|i| i % 3 == split);
        let shuffled = (0..learned.len()).map(|i| learned[i * 5 % learned.len()]).collect::<Vec<_>>();
        (judged, shuffled)
    });
    let splits: Vec<_> = splits.collect();
    for (frames, limits) in
        [(3, [[5.4, 6.5], [5.2, 6.2], [4.9, 6.0]]), (10, [[4.6, 5.9], [3.8, 4.9], [3.6, 4.6]])]
    {
        let [mut free, mut by_radius, mut by_center]: [Vec<[f64; 2]>; 3] = Default::default();
        for (judged, learned) in &splits {
            let learned = &learned[..frames];
            let (mut rig, mut balls) = sensor.rig(learned, false);
            let radius = rig::solve(&rig, Some(&balls.view().get()), None, false).expect("a model");
            assert_eq!((radius.scale_source, radius.balls), (ScaleSource::Ball, frames as u32));
            let unlabeled = rig::solve(&rig, None, None, false).expect("a model");
            let ratio = radius.length() / unlabeled.length();
            println!(
                "{frames} frames: circulation {:.3} ratio {:.3} outward {:.2}, scale of the colors {:.2} +- {:.2} of the balls', missed {:.3}, {:?}",
                unlabeled.circulation,
                unlabeled.circulation_ratio,
                unlabeled.outward,
                1.0 / ratio,
                unlabeled.scale_deviation,
                radius.disagreement,
                radius.advice
            );
            assert_eq!(unlabeled.scale_source, ScaleSource::Colors);
            assert!(ratio.ln().abs() < 3.0 * unlabeled.scale_deviation);
            (rig.scale, rig.scale_deviation) = (radius.length(), 0.05);
            let scaled = rig::solve(&rig, None, None, false).expect("a model");
            assert_eq!(scaled.scale_source, ScaleSource::Given);
            let (rig, mut balls) = sensor.rig(learned, true);
            let center = rig::solve(&rig, Some(&balls.view().get()), None, false).expect("a model");
            for &press in judged {
                free.push(sensor.error(&scaled, press));
                by_radius.push(sensor.error(&radius, press));
                by_center.push(sensor.error(&center, press));
            }
        }
        let all = [("without labels, scale given", &free), ("radius", &by_radius), ("center", &by_center)];
        for ((name, errors), limits) in all.iter().zip(limits) {
            let [middle, mean, _] = summary(&format!("{frames} frames, {name}"), errors);
            assert!(middle <= limits[0] && mean <= limits[1]);
        }
    }
}

/// A rig of generated frames, and how far the normals of other frames are off: of the contacts, in degrees, the median.
fn generated(rig_number: u64, with_background: bool, balls: bool) -> (Model, f64) {
    let mut rig = Rig::new(WIDTH, HEIGHT).expect("large enough");
    let mut sums = BallSums::new();
    for number in 0..8 {
        let kind = if balls { Kind::Ball } else { RELIEFS[number as usize % 4] };
        let scene = frame(rig_number, kind, number);
        let background = picture(&scene.background, WIDTH, HEIGHT);
        let ball = scene.ball.filter(|_| balls).map(|(radius, _)| Ball { radius, center: None });
        let ball = ball.map(|ball| (sums.view(), ball));
        let image = picture(&scene.rgb, WIDTH, HEIGHT);
        if let Err(error) = add(&mut rig, ball, &image, Some(&background).filter(|_| with_background)) {
            println!("{kind:?} {number}: {error:?}");
        }
    }
    let model = rig::solve(&rig, Some(&sums.view().get()), None, false).expect("a model");
    let mut errors = Vec::new();
    for number in 100..103 {
        let scene = frame(rig_number, RELIEFS[number as usize % 4], number);
        let background = picture(&scene.background, WIDTH, HEIGHT);
        let background = Some(&background).filter(|_| with_background);
        normals(&model, &picture(&scene.rgb, WIDTH, HEIGHT), background, |x, y, class, normal| {
            if class == PixelClass::Contact as u8 && normal[2].is_finite() {
                errors.push(degrees(scene.normals[y * WIDTH + x], normal));
            }
        });
    }
    let error = median(&mut errors);
    println!("rig {rig_number}, background {with_background}, balls {balls}: {error:.2} degrees");
    (model, error)
}

#[test]
fn generated_frames_are_right() {
    for with_background in [true, false] {
        let (model, error) = generated(u64::from(with_background), with_background, false);
        assert!(model.frames >= 6 && model.circulation_ratio < 0.2 && model.outward > 0.5);
        assert_eq!(model.scale_source, ScaleSource::Colors);
        assert!(error < 2.5);
        assert!(error.to_radians() < 2.0 * model.expected_error());
    }
    let (model, error) = generated(0, true, true);
    assert_eq!(model.scale_source, ScaleSource::Ball);
    assert!(model.balls >= 6 && error < 2.5);
}

#[test]
fn sums_of_two_rigs_are_those_of_one() {
    let scenes = [0, 1, 2, 3].map(|number| frame(3, RELIEFS[number], number as u64));
    let [mut all, mut first, mut second] = [(); 3].map(|()| Rig::new(WIDTH, HEIGHT).expect("large enough"));
    for (i, scene) in scenes.iter().enumerate() {
        let image = picture(&scene.rgb, WIDTH, HEIGHT);
        add(&mut all, None, &image, None).expect("a contact");
        add(if i < 2 { &mut first } else { &mut second }, None, &image, None).expect("a contact");
    }
    first.merge(&second).expect("one size");
    let [all, merged] = [all, first].map(|rig| rig::solve(&rig, None, None, false).expect("a model"));
    let pairs = all.w.iter().flatten().zip(merged.w.iter().flatten());
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() <= 1e-9 * a.abs()) && all.frames == merged.frames);
    // A hollow has the other sign.
    let hollow = rig::solve(&first, None, None, true).expect("a model");
    assert!(hollow.w.iter().flatten().zip(merged.w.iter().flatten()).all(|(a, b)| *a == -b));
    assert_eq!(first.merge(&Rig::new(WIDTH, HEIGHT + 1).expect("large enough")), None);
}

#[test]
fn nothing_is_made_up() {
    let scene = frame(5, Kind::Bump, 0);
    let [image, plane] = [&scene.rgb, &scene.background].map(|rgb| picture(rgb, WIDTH, HEIGHT));
    let mut rig = Rig::new(WIDTH, HEIGHT).expect("large enough");
    assert_eq!(add(&mut rig, None, &plane, None), Err(ReliefError::NothingTouched));
    assert_eq!(rig::solve(&rig, None, None, false), Err(ReliefError::NothingTouched));
    add(&mut rig, None, &image, Some(&plane)).expect("a contact");
    let solved = rig::solve(&rig, None, None, false).expect("a model");
    assert_eq!(solved.advice, Advice::Contacts);
    // Without what the colors say of it the scale is unknown.
    rig.bend_weight = 0.0;
    let solved = rig::solve(&rig, None, None, false).expect("a model");
    assert_eq!((solved.scale_source, solved.scale_deviation), (ScaleSource::Unknown, 0.5));
    assert!((solved.tilt - 0.4).abs() < 1e-9);
    // One groove does not determine both slopes.
    let groove = frame(5, Kind::Groove, 0);
    let mut rig = Rig::new(WIDTH, HEIGHT).expect("large enough");
    add(&mut rig, None, &picture(&groove.rgb, WIDTH, HEIGHT), Some(&plane)).expect("a contact");
    assert_eq!(rig::solve(&rig, None, None, false), Err(ReliefError::NotDetermined));
}
