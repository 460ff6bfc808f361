//! The renderer against eqs. 1-7 written out pixel by pixel.
#![allow(clippy::cast_sign_loss, clippy::cast_possible_wrap, reason = "small pixel numbers")]

use ofc_core::picture::{Order, Sample};
use ofc_core::render::{Canvas, DepthMap, Lights, Outputs, Params, render};
use ofc_tests::depth_maps::{self, Relief, TABLE_1_COLORS, direction, table_1_directions};
use ofc_tests::shots::{Picture, shoot};

/// f32 results of an f64 computation, for values up to 255.
const ROUNDING: f64 = 2e-5;
/// A ray that grazes the surface may be decided by rounding; so many pixels of 10,000 may.
const GRAZING: usize = 2;

fn unscaled() -> Params {
    Params { peak: 0.0, ..Params::default() }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The depth at (column, row) where the scene has one.
fn depth(scene: &Relief, column: i64, row: i64) -> Option<f64> {
    let inside = (0..scene.width as i64).contains(&column) && (0..scene.height as i64).contains(&row);
    let at = usize::try_from(row * scene.width as i64 + column).ok().filter(|_| inside)?;
    (scene.mask[at] != 0).then(|| f64::from(scene.depth[at]))
}

fn naive_normal(scene: &Relief, column: i64, row: i64) -> Option<[f64; 3]> {
    let here = depth(scene, column, row)?;
    let slope = |(dc, dr): (i64, i64)| {
        let ahead = depth(scene, column + dc, row + dr);
        let behind = depth(scene, column - dc, row - dr);
        let run = f64::from(i32::from(ahead.is_some()) + i32::from(behind.is_some()));
        if run == 0.0 { 0.0 } else { (ahead.unwrap_or(here) - behind.unwrap_or(here)) / run }
    };
    let (p, q) = (slope((1, 0)), slope((0, -1)));
    let length = (p * p + q * q + 1.0).sqrt();
    Some([-p / length, -q / length, 1.0 / length])
}

/// Walks the whole picture in steps of one pixel on the faster axis.
fn naive_shadow(scene: &Relief, column: i64, row: i64, light: [f64; 3]) -> bool {
    let start = depth(scene, column, row).unwrap();
    let fast = light[0].abs().max(light[1].abs());
    for step in 1..2 * scene.width.max(scene.height) {
        let t = step as f64 / fast;
        let (x, y, z) = (column as f64 + t * light[0], row as f64 - t * light[1], start + t * light[2]);
        if x < -1e-9
            || y < -1e-9
            || x > scene.width as f64 - 1.0 + 1e-9
            || y > scene.height as f64 - 1.0 + 1e-9
        {
            break;
        }
        let (c, r) = ((x + 1e-9).floor(), (y + 1e-9).floor());
        let (share, next) = if light[0].abs() >= light[1].abs() { (y - r, (0, 1)) } else { (x - c, (1, 0)) };
        let near = depth(scene, c as i64, r as i64);
        let far = depth(scene, c as i64 + next.0, r as i64 + next.1);
        let surface = match (near, far) {
            (Some(near), Some(far)) => Some(near + share * (far - near)),
            (near, far) => {
                if share < 0.5 {
                    near
                } else {
                    far
                }
            }
        };
        if surface.is_some_and(|surface| surface > z + 1e-3) {
            return true;
        }
    }
    false
}

#[test]
fn every_scene_is_as_the_naive_renderer_has_it() {
    let (a, b) = (table_1_directions(), TABLE_1_COLORS);
    for scene in [
        depth_maps::bust(90, 100),
        depth_maps::peaks(120, 80),
        depth_maps::terrain(70, 130),
        depth_maps::vase(100, 100),
        depth_maps::egg(80, 80),
        depth_maps::bump(300, 17),
    ] {
        let picture = shoot(&scene, &a, &b, &unscaled());
        let (mut grazing, mut cast) = (0, 0);
        for (i, (color, &seen)) in picture.colors.iter().zip(&picture.seen).enumerate() {
            let (column, row) = ((i % scene.width) as i64, (i / scene.width) as i64);
            let Some(normal) = naive_normal(&scene, column, row) else {
                assert_eq!((*color, seen, picture.normals[i]), ([0.0; 3], 0, [0.0; 3]));
                continue;
            };
            for (got, want) in picture.normals[i].iter().zip(normal) {
                assert!((f64::from(*got) - want).abs() < 1e-7);
            }
            let (mut bits, mut want) = (0, [0.0; 3]);
            for (light, direction) in a.as_chunks::<3>().0.iter().enumerate() {
                let cosine = dot(*direction, normal);
                let shadow = cosine > 0.0 && naive_shadow(&scene, column, row, *direction);
                cast += usize::from(shadow);
                bits |= u32::from(cosine > 0.0 && !shadow) << light;
                if seen >> light & 1 == 1 {
                    for (channel, want) in want.iter_mut().enumerate() {
                        *want += b[3 * channel + light] * cosine;
                    }
                }
            }
            grazing += usize::from(bits != seen);
            for (got, want) in color.iter().zip(want) {
                assert!((f64::from(*got) - want).abs() < ROUNDING, "{color:?} is not {want:?}");
            }
        }
        println!("{} x {}: {cast} cast shadows, {grazing} grazing", scene.width, scene.height);
        assert!(grazing * 10_000 <= GRAZING * picture.colors.len().max(5000), "{grazing} pixels differ");
    }
}

#[test]
fn a_sphere_is_lit_up_to_its_terminator() {
    let scene = depth_maps::sphere(201, 201, 0.9, 75.0);
    let radius = 0.9 * 100.5;
    let (a, b) = (table_1_directions(), TABLE_1_COLORS);
    let picture = shoot(&scene, &a, &b, &unscaled());
    for (i, color) in picture.colors.iter().enumerate().filter(|&(i, _)| scene.mask[i] != 0) {
        let (x, y) = ((i % 201) as f64 - 100.0, 100.0 - (i / 201) as f64);
        let rim = (x * x + y * y).sqrt() > radius * 75_f64.to_radians().sin() - 2.0;
        let n = [x / radius, y / radius, (1.0 - (x * x + y * y) / radius.powi(2)).sqrt()];
        let mut want = [0.0; 3];
        for (light, direction) in a.as_chunks::<3>().0.iter().enumerate() {
            let cosine = dot(*direction, n);
            // Differences over two pixels of a sphere this size are off by less than this away from the rim.
            if cosine.abs() > 0.01 && !rim {
                assert_eq!(picture.seen[i] >> light & 1 == 1, cosine > 0.0, "at {x}, {y}");
            }
            for (channel, want) in want.iter_mut().enumerate() {
                *want += b[3 * channel + light] * cosine.max(0.0);
            }
        }
        for (got, want) in color.iter().zip(want) {
            assert!(rim || (f64::from(*got) - want).abs() < 0.3, "{color:?} is not {want:?}");
        }
    }
}

/// A floor with a wall of 12 on rows or columns 60 and 61 of 100.
fn wall(upright: bool) -> Relief {
    let on = |t: f64| (20.0..22.0).contains(&(t * 50.0 + 10.0));
    Relief::sample(100, 100, |u, v| Some(if on(if upright { u } else { -v }) { 12.0 / 50.0 } else { 0.0 }))
}

#[test]
fn the_shadow_of_a_wall_is_as_long_as_its_height_times_the_slant_s_tangent() {
    for slant in [20.0_f64, 45.0, 60.0, 70.0] {
        let length = 12.0 * slant.to_radians().tan();
        for (upright, tilt, turn) in [
            (true, 0.0_f64, 0.0_f64),
            (true, 30.0, 30.0),
            (true, 70.0, 70.0),
            (false, -90.0, 0.0),
            (false, -70.0, 20.0),
        ] {
            let picture = shoot(&wall(upright), &direction([slant, tilt]), &[1.0; 3], &unscaled());
            // The wall is 60 pixels from where the light does not come from; look across its middle.
            let across = length * turn.to_radians().cos();
            for distance in 2..45 {
                let i = if upright { 50 * 100 + 60 - distance } else { (60 - distance) * 100 + 50 };
                // The wall's foot is up to a pixel wide between the samples, and its ends are far enough.
                let (near, far) = ((distance as f64) < across - 1.0, distance as f64 > across + 1.0);
                let long = across.hypot(length) > 70.0 || length * turn.to_radians().sin() > 45.0;
                if !long && (near || far) {
                    assert_eq!(picture.seen[i] == 0, near, "slant {slant} tilt {tilt} distance {distance}");
                }
            }
            // Behind the wall, toward the light, nothing is dark.
            let behind = if upright { 50 * 100 + 63 } else { 63 * 100 + 50 };
            assert_eq!(picture.seen[behind], 1);
        }
    }
    let lit = Params { cast_shadows: false, ..unscaled() };
    let picture = shoot(&wall(true), &direction([60.0, 0.0]), &[1.0; 3], &lit);
    assert!(picture.seen[50 * 100 + 50] == 1, "without cast shadows the floor is lit");
}

#[test]
fn a_plane_does_not_shadow_itself() {
    for tilt in [0.0, 33.0, 90.0, 135.0, -160.0, -45.0] {
        // The light is two degrees above the plane, whose slope is 1.
        let scene = Relief::sample(80, 60, |u, v| Some(1000.0 - 0.9 * u + 0.3 * v));
        let normal = naive_normal(&scene, 40, 30).unwrap();
        let (sin, cos) = 88_f64.to_radians().sin_cos();
        let side = direction([90.0, tilt]);
        let out = dot(side, normal);
        let tangent: Vec<f64> = side.iter().zip(normal).map(|(s, n)| s - out * n).collect();
        let length = tangent.iter().map(|t| t * t).sum::<f64>().sqrt();
        let light: Vec<f64> = tangent.iter().zip(normal).map(|(t, n)| sin * t / length + cos * n).collect();
        let picture = shoot(&scene, &light, &[1.0; 3], &unscaled());
        assert!(picture.seen.iter().all(|&seen| seen == 1), "tilt {tilt}");
    }
}

#[test]
fn the_largest_modulus_is_the_peak() {
    let (scene, a, b) = (depth_maps::bust(100, 100), table_1_directions(), TABLE_1_COLORS);
    let plain = shoot(&scene, &a, &b, &unscaled());
    assert_eq!(plain.rendering.scale, 1.0);
    let modulus = |color: &[f32; 3]| color.iter().map(|&c| f64::from(c).powi(2)).sum::<f64>().sqrt();
    let largest = |picture: &Picture| picture.colors.iter().map(modulus).fold(0.0, f64::max);
    assert!((largest(&plain) - plain.rendering.largest).abs() < ROUNDING);
    for peak in [255.0, 1.0, 65535.0] {
        let scaled = shoot(&scene, &a, &b, &Params { peak, ..Params::default() });
        assert!((largest(&scaled) / peak - 1.0).abs() < 1e-6);
        assert!((scaled.rendering.scale * plain.rendering.largest / peak - 1.0).abs() < 1e-12);
        // Where all lights are seen the picture is F n with F = scale B A.
        let f = Lights::new(&a, &b).unwrap().orientation().map(|row| row.map(|x| x * scaled.rendering.scale));
        for i in (0..scaled.colors.len()).filter(|&i| scaled.seen[i] == 0b111) {
            for (got, row) in scaled.colors[i].iter().zip(f) {
                assert!((f64::from(*got) - dot(row, scaled.normals[i].map(f64::from))).abs() < 1e-6 * peak);
            }
        }
    }
    // Nothing is lit: no division by zero.
    let dark = shoot(&scene, &[0.0, 0.0, -1.0], &[1.0; 3], &Params::default());
    assert_eq!((dark.rendering.largest, dark.rendering.scale), (0.0, 1.0));
    assert!(dark.colors.iter().flatten().all(|&c| c == 0.0));
}

#[test]
fn table_1_s_matrix_is_as_printed() {
    let (a, b) = (table_1_directions(), TABLE_1_COLORS);
    let f = Lights::new(&a, &b).unwrap().orientation();
    for (row, (tilt, slant)) in f.iter().zip([(-36.80, 23.26), (-149.91, 30.63), (-136.55, 10.87)]) {
        // The first tilt is 36.79; the paper prints 36.80.
        assert!((row[1].atan2(row[0]).to_degrees() - tilt).abs() < 0.01);
        assert!((row[0].hypot(row[1]).atan2(row[2]).to_degrees() - slant).abs() < 0.005);
    }
    // The picture is scaled so that the largest color has modulus 255; Table 1's norms are then 156.06, 164.96, 145.68,
    // in the ratio of the rows' lengths.
    let norms = f.map(|row| dot(row, row).sqrt());
    assert!((norms[1] / norms[0] - 164.96 / 156.06).abs() < 1e-4);
    assert!((norms[2] / norms[0] - 145.68 / 156.06).abs() < 1e-4);
}

#[test]
fn noise_is_gaussian_and_the_same_whatever_else() {
    let (a, b) = (table_1_directions(), TABLE_1_COLORS);
    let scene = depth_maps::bump(256, 256);
    let clean = shoot(&scene, &a, &b, &Params::default());
    let noise = |scene: &Relief, params: &Params, clean: &Picture, a: &[f64], b: &[f64]| -> Vec<[f64; 3]> {
        let noisy = shoot(scene, a, b, params);
        let pairs = noisy.colors.iter().zip(&clean.colors);
        pairs.map(|(n, c)| [0, 1, 2].map(|k| f64::from(n[k]) - f64::from(c[k]))).collect()
    };
    let params = Params { noise: 2.0, seed: 7, ..Params::default() };
    let first = noise(&scene, &params, &clean, &a, &b);
    let count = first.len() as f64;
    let moment = |values: &dyn Fn(&[f64; 3]) -> f64| first.iter().map(values).sum::<f64>() / count;
    for k in 0..3 {
        // Five standard deviations of each statistic.
        let [mean, variance] = [moment(&|n| n[k] / 2.0), moment(&|n| (n[k] / 2.0).powi(2))];
        let [skew, fourth] = [moment(&|n| (n[k] / 2.0).powi(3)), moment(&|n| (n[k] / 2.0).powi(4))];
        let within =
            |value: f64, want: f64, spread: f64| (value - want).abs() < 5.0 * (spread / count).sqrt();
        assert!(within(mean, 0.0, 1.0) && within(variance, 1.0, 2.0), "{mean} {variance}");
        assert!(within(skew, 0.0, 15.0) && within(fourth, 3.0, 96.0), "{skew} {fourth}");
        assert!(within(moment(&|n| n[k] * n[(k + 1) % 3] / 4.0), 0.0, 1.0));
        let neighbors: f64 = first.windows(2).map(|w| w[0][k] * w[1][k] / 4.0).sum::<f64>() / count;
        assert!(within(neighbors, 0.0, 1.0));
        let one_sigma = first.iter().filter(|n| n[k].abs() < 2.0).count() as f64 / count;
        assert!((one_sigma - 0.6827).abs() < 0.01);
    }
    // Another scene, other lights, half the noise: half the numbers.
    let sphere = depth_maps::sphere(256, 256, 0.8, 90.0);
    let (a2, b2) = (direction([10.0, 0.0]), [10.0, 20.0, 30.0]);
    let clean2 = shoot(&sphere, &a2, &b2, &Params { cast_shadows: false, ..Params::default() });
    let half = Params { noise: 1.0, seed: 7, cast_shadows: false, ..Params::default() };
    for ((one, two), mask) in noise(&sphere, &half, &clean2, &a2, &b2).iter().zip(&first).zip(&sphere.mask) {
        for (one, two) in one.iter().zip(two) {
            let want = if *mask == 0 { 0.0 } else { two / 2.0 };
            assert!((one - want).abs() < 1e-4, "{one} is not {want}");
        }
    }
    let other = noise(&scene, &Params { seed: 8, ..params }, &clean, &a, &b);
    let correlation: f64 = other.iter().zip(&first).map(|(x, y)| x[0] * y[0] / 4.0).sum::<f64>() / count;
    assert!(correlation.abs() < 0.02);
}

#[test]
fn turning_the_scene_turns_the_picture() {
    let scene = depth_maps::bust(64, 64);
    let (a, b) = (table_1_directions(), TABLE_1_COLORS);
    let upright = shoot(&scene, &a, &b, &Params::default());
    // Counter-clockwise by a right angle: (x, y) goes to (-y, x).
    let from = |i: usize| (i % 64) * 64 + 63 - i / 64;
    let mut turned = scene.clone();
    let mut turned_a = a;
    for (i, (z, mask)) in turned.depth.iter_mut().zip(&mut turned.mask).enumerate() {
        (*z, *mask) = (scene.depth[from(i)], scene.mask[from(i)]);
    }
    for row in turned_a.as_chunks_mut::<3>().0 {
        *row = [-row[1], row[0], row[2]];
    }
    let picture = shoot(&turned, &turned_a, &b, &Params::default());
    let differ = (0..64 * 64).filter(|&i| picture.seen[i] != upright.seen[from(i)]).count();
    assert!(differ <= GRAZING, "{differ} pixels differ");
    for i in (0..64 * 64).filter(|&i| picture.seen[i] == upright.seen[from(i)]) {
        for (got, want) in picture.colors[i].iter().zip(upright.colors[from(i)]) {
            assert!(f64::from(got - want).abs() < 1e-4);
        }
    }
    // Lights in another order: the same picture, bits in that order.
    let swapped_a = [&a[3..6], &a[0..3], &a[6..9]].concat();
    let swapped_b: Vec<f64> = b.chunks(3).flat_map(|row| [row[1], row[0], row[2]]).collect();
    let swapped = shoot(&scene, &swapped_a, &swapped_b, &Params::default());
    for (one, two) in swapped.seen.iter().zip(&upright.seen) {
        assert_eq!((one & 4) | (one & 1) << 1 | (one & 2) >> 1, *two);
    }
    // A unit of length twice as small.
    let depths: Vec<u8> = scene.depth.iter().flat_map(|z| (2.0 * z).to_ne_bytes()).collect();
    let map = DepthMap::new(&depths, 64, 64, 256, 2.0).unwrap().with_mask(&scene.mask, 64).unwrap();
    let mut bytes = vec![0; 64 * 64 * 12];
    let canvas = Canvas::new(&mut bytes, 64, 64, 768, Sample::F32, Order::Rgb).unwrap();
    let outputs = Outputs { picture: canvas, seen: None, normals: None };
    render(&map, &Lights::new(&a, &b).unwrap(), &Params::default(), outputs).unwrap();
    let want: Vec<u8> = upright.colors.iter().flat_map(|c| c.map(f32::to_ne_bytes).concat()).collect();
    assert_eq!(bytes, want);
}

#[test]
fn thirty_two_lights_have_a_bit_each() {
    let scene = depth_maps::sphere(50, 50, 0.9, 60.0);
    let a: Vec<f64> = (0..32).flat_map(|i| direction([50.0, 11.25 * f64::from(i) - 170.0])).collect();
    let picture = shoot(&scene, &a, &[1.0; 96], &unscaled());
    assert_eq!(picture.seen[25 * 50 + 25], u32::MAX);
    let color = picture.colors[25 * 50 + 25][0];
    assert!((f64::from(color) - 32.0 * 50_f64.to_radians().cos()).abs() < 0.1);
}
