//! Slopes relative to an untouched plane: reliefs on a plane are answered, and what only looks like one is refused.

use ofc_core::math::arena::Arena;
use ofc_core::orientation::relief::{
    PixelClass, Relief, ReliefError, ReliefParams, ScaleSource, estimate, need, normals,
};
use ofc_core::picture::{Image, Order, Sample};
use ofc_tests::photographs;
use ofc_tests::relief_scenes::{HEIGHT, OTHERS, RELIEFS, WIDTH, scene};

struct Solved {
    found: Relief,
    classes: Vec<u8>,
    normals: Vec<[f32; 3]>,
    deviations: Vec<f32>,
}

fn picture(rgb: &[u8], width: usize, height: usize) -> Image<'_> {
    Image::interleaved(rgb, width, height, 3 * width, Sample::U8, Order::Rgb).expect("a picture")
}

fn solve(image: &Image, background: Option<&Image>, params: &ReliefParams) -> Result<Solved, ReliefError> {
    let (width, height) = (image.width(), image.height());
    let need = need(width, height).expect("a large enough picture");
    let (mut singles, mut integers) = (vec![f32::NAN; need.singles], vec![7; need.integers]);
    let mut classes = vec![9; width * height];
    let arena = Arena::new(&mut [], &mut singles, &mut integers);
    let found = estimate(image, background, params, arena, &mut classes)?;
    let (mut map, mut deviations) = (vec![[0.0; 3]; width * height], vec![0.0; width * height]);
    normals(image, background, &found, &classes, |x, y, normal, deviation| {
        map[y * width + x] = normal;
        deviations[y * width + x] = deviation;
    })?;
    Ok(Solved { found, classes, normals: map, deviations })
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn degrees(a: [f64; 3], b: [f32; 3]) -> f64 {
    let product: f64 = a.iter().zip(b).map(|(a, b)| a * f64::from(b)).sum();
    product.clamp(-1.0, 1.0).acos().to_degrees()
}

/// Slopes times a factor.
fn scaled(normal: [f32; 3], factor: f64) -> [f32; 3] {
    let [x, y, _] = normal.map(|n| f64::from(n) * factor);
    let length = x.hypot(y);
    let shorter = if length > 0.97 { 0.97 / length } else { 1.0 };
    let (x, y) = (x * shorter, y * shorter);
    [x, y, (1.0 - x * x - y * y).sqrt()].map(|n| n as f32)
}

/// The median error in degrees over these pixels, with the scale as it is and with the best one, and that one over the true one.
fn errors(solved: &Solved, truth: &[(usize, [f64; 3])]) -> (f64, f64, f64) {
    let with = |factor: f64| {
        let mut all: Vec<f64> =
            truth.iter().map(|&(i, n)| degrees(n, scaled(solved.normals[i], factor))).collect();
        median(&mut all)
    };
    let factors = (-30..=30).map(|i| 1.04_f64.powi(i));
    let (best, factor) = factors.map(|f| (with(f), f)).min_by(|a, b| a.0.total_cmp(&b.0)).expect("factors");
    (with(1.0), best, 1.0 / factor)
}

#[test]
fn reliefs_on_a_plane_are_right() {
    let (mut all, mut refused) = (Vec::new(), 0);
    for number in 0..4 {
        for kind in RELIEFS {
            let scene = scene(kind, number);
            let image = picture(&scene.rgb, WIDTH, HEIGHT);
            let background = picture(&scene.background, WIDTH, HEIGHT);
            for background in [None, Some(&background)] {
                match solve(&image, background, &ReliefParams::default()) {
                    Ok(solved) => {
                        let bent = scene.normals.iter().copied().enumerate().filter(|(_, n)| n[2] < 0.985);
                        let truth: Vec<_> = bent.filter(|&(i, _)| solved.normals[i][2].is_finite()).collect();
                        let (own, best, ratio) = errors(&solved, &truth);
                        println!(
                            "{kind:?} {number} {}: {own:.2} degrees, best scale {best:.2}, ratio {ratio:.2}, {:?}",
                            background.is_some(),
                            solved.found
                        );
                        all.push(own);
                    }
                    Err(error) => {
                        println!("{kind:?} {number} {}: {error:?}", background.is_some());
                        refused += 1;
                    }
                }
            }
        }
    }
    let (count, middle) = (all.len(), median(&mut all));
    println!("{count} answered, {refused} refused, median {middle:.2}, largest {:.2}", all[count - 1]);
    assert!(refused <= 2 && middle < 1.0 && all[count * 9 / 10] < 3.0);
}

#[test]
fn what_is_no_relief_on_a_plane_is_refused() {
    let mut answered = Vec::new();
    for number in 0..4 {
        for kind in OTHERS {
            let scene = scene(kind, number);
            let image = picture(&scene.rgb, WIDTH, HEIGHT);
            let background = picture(&scene.background, WIDTH, HEIGHT);
            for background in [None, Some(&background)] {
                match solve(&image, background, &ReliefParams::default()) {
                    Ok(solved) => answered.push((kind, number, background.is_some(), solved.found)),
                    Err(error) => println!("{kind:?} {number} {}: {error:?}", background.is_some()),
                }
            }
        }
    }
    assert!(answered.is_empty(), "{answered:#?}");
}

#[test]
fn whole_frames_of_a_tactile_sensor() {
    let Some(folder) = photographs::directory().map(|data| data.join("gelsight_rig")) else {
        println!("skipped: no photographs beside the project");
        return;
    };
    let (width, height, background) = photographs::read_png(&folder.join("background.png"), 3);
    let background = picture(&background, width, height);
    let list = std::fs::read_to_string(folder.join("presses.csv")).expect("presses");
    for (mode, limits) in [
        ("background", [4.2, 7.0, 5.5, 11.0]),
        ("own", [4.5, 9.0, 6.0, 12.0]),
        ("ball", [4.2, 7.0, 4.6, 9.0]),
    ] {
        let [mut bests, mut owns]: [Vec<f64>; 2] = Default::default();
        let (mut within, mut honest) = (0, 0);
        for line in list.lines().skip(1) {
            let fields: Vec<&str> = line.split(',').collect();
            let [cx, cy, ball, trusted] = [1, 2, 3, 4].map(|i| fields[i].parse::<f64>().expect("a number"));
            let (_, _, rgb) = photographs::read_png(&folder.join(format!("{}.png", fields[0])), 3);
            let image = picture(&rgb, width, height);
            let given = (mode != "own").then_some(&background);
            let params =
                ReliefParams { ball_radius: (mode == "ball").then_some(ball), ..ReliefParams::default() };
            let solved = solve(&image, given, &params)
                .unwrap_or_else(|error| panic!("{mode} {}: {error:?}", fields[0]));
            let mut truth = Vec::new();
            for y in 0..height {
                for x in 0..width {
                    let (u, v) = ((x as f64 - cx) / ball, (cy - y as f64) / ball);
                    let i = y * width + x;
                    if u.hypot(v) < trusted / ball && solved.normals[i][2].is_finite() {
                        truth.push((i, [u, v, (1.0 - u * u - v * v).sqrt()]));
                    }
                }
            }
            let (own, best, ratio) = errors(&solved, &truth);
            let found = &solved.found;
            println!(
                "{mode} {}: {own:.2}, best scale {best:.2}, ratio {ratio:.2} said {:.2}, stated {:.2}, {:?} disagreement {:?} outward {:.2} border {:.2} circulation {:.3} {:.3} snr {:.1}",
                fields[0],
                found.scale_deviation,
                found.expected_error().to_degrees(),
                found.scale_source,
                found.disagreement,
                found.outward,
                found.border,
                found.circulation,
                found.circulation_ratio,
                found.signal_to_noise
            );
            bests.push(best);
            if found.scale_source != ScaleSource::Unknown {
                within += u32::from(ratio.ln().abs() <= 2.0 * found.scale_deviation);
                owns.push(own);
                honest += u32::from(own <= 2.0 * found.expected_error().to_degrees());
            }
        }
        let claimed = owns.len();
        let (best, own) = (median(&mut bests), median(&mut owns));
        println!(
            "{mode}: best scale {best:.2}, worst {:.2}; {claimed} claimed, {own:.2}, worst {:.2}, scale within 2 sigma {within}, error within twice the stated {honest}",
            bests[bests.len() - 1],
            owns[claimed - 1]
        );
        assert!(best <= limits[0] && bests[bests.len() - 1] <= limits[1]);
        let least = if mode == "own" { 9 } else { 12 };
        assert!(claimed >= least && own <= limits[2] && owns[claimed - 1] <= limits[3]);
    }
}

#[test]
fn the_plane_is_the_plane() {
    let scene = scene(RELIEFS[0], 1);
    let solved =
        solve(&picture(&scene.rgb, WIDTH, HEIGHT), None, &ReliefParams::default()).expect("an answer");
    let mut planes = 0;
    for ((class, normal), deviation) in solved.classes.iter().zip(&solved.normals).zip(&solved.deviations) {
        if *class == PixelClass::Plane as u8 && normal[2].is_finite() {
            assert_eq!((*normal, *deviation), ([0.0, 0.0, 1.0], 0.0));
            planes += 1;
        }
    }
    assert!(planes > WIDTH * HEIGHT / 4, "{planes}");
}
