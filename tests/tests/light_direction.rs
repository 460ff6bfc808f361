//! The estimators of light direction against what they expect of a Lambertian sphere, and against naive sums elsewhere.
#![allow(clippy::cast_sign_loss, clippy::cast_possible_wrap, reason = "small pixel numbers")]

use ofc_core::light::channel_maxima;
use ofc_core::light::slant::{self, Estimate, Reach};
use ofc_core::light::tilt::chojnacki::{Disc, largest_disc, workspace_len};
use ofc_core::light::tilt::{chojnacki, lee_rosenfeld, pentland, zheng_chellappa};
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Image, Sample, Window};
use ofc_tests::depth_maps::direction;
use std::f64::consts::{FRAC_PI_2, PI};

/// Sums in another order.
const SUMS: f64 = 1e-9;
/// Degrees: pixels on a grid instead of a round border, for radii of a hundred pixels and more.
const GRID_TILT: f64 = 0.6;

/// Three planes of f32 and a mask.
struct Picture {
    width: usize,
    height: usize,
    colors: Vec<[f32; 3]>,
    planes: [Vec<u8>; 3],
    mask: Vec<u8>,
}

impl Picture {
    /// Colors at (x, y), pixels from the middle with y up; `None` is outside the mask, where the picture is garbage.
    fn new(width: usize, height: usize, mut color: impl FnMut(f64, f64) -> Option<[f64; 3]>) -> Self {
        let (mut colors, mut mask) = (Vec::new(), Vec::new());
        for row in 0..height {
            for column in 0..width {
                let (x, y) =
                    (column as f64 - 0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0) - row as f64);
                let color = color(x, y);
                mask.push(u8::from(color.is_some()));
                colors.push(color.unwrap_or([1e9, -7e8, 3e7]).map(|c| c as f32));
            }
        }
        let planes = [0, 1, 2].map(|k| colors.iter().flat_map(|c| c[k].to_ne_bytes()).collect());
        Self { width, height, colors, planes, mask }
    }

    fn image(&self) -> Image<'_> {
        let [r, g, b] = &self.planes;
        let image = Image::planes([r, g, b], self.width, self.height, self.width * 4, Sample::F32).unwrap();
        image.with_mask(&self.mask, self.width).unwrap()
    }

    /// Noise with every scale, and holes.
    fn random(width: usize, height: usize, seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        Self::new(width, height, |x, y| {
            let color = [1.0, 2.0, -0.5].map(|k| 100.0 + k * x - 0.3 * k * k * y + 20.0 * rng.unit());
            (rng.unit() < 0.8).then_some(color)
        })
    }

    fn inside(&self, column: usize, row: usize) -> Option<[f64; 3]> {
        (column < self.width && row < self.height && self.mask[row * self.width + column] != 0)
            .then(|| self.colors[row * self.width + column].map(f64::from))
    }
}

fn masked(window: &Window) -> u64 {
    window.masked
}

/// A sphere whose channels are lit from these (slant, tilt) in degrees with strengths 100, 60, 20; cut at the given
/// slant of its normals, and where `lit` at a channel's terminator.
fn sphere(radius: f64, cap: f64, lights: [[f64; 2]; 3], lit: bool) -> Picture {
    let size = 2 * (radius as usize) + 5;
    let (lights, edge) = (lights.map(direction), radius * cap.to_radians().sin());
    Picture::new(size, size, |x, y| {
        let squared = x * x + y * y;
        if squared >= edge * edge {
            return None;
        }
        let n = [x / radius, y / radius, (1.0 - squared / radius.powi(2)).sqrt()];
        let cosines = lights.map(|a| a.iter().zip(n).map(|(a, n)| a * n).sum::<f64>());
        if lit && cosines.iter().any(|&c| c <= 0.0) {
            return None;
        }
        Some([100.0 * cosines[0].max(0.0), 60.0 * cosines[1].max(0.0), 20.0 * cosines[2].max(0.0)])
    })
}

fn angle_between(a: f64, b: f64) -> f64 {
    ((a - b).sin().atan2((a - b).cos())).to_degrees().abs()
}

#[test]
fn tilts_of_a_sphere_are_the_light_s() {
    for slant in [15.0, 40.0, 65.0] {
        for tilt in [-170.0, -95.0, -20.0, 3.0, 45.0, 130.0] {
            // One light, so that what it lights is symmetric about it.
            let picture = sphere(120.0, 90.0, [[slant, tilt]; 3], true);
            let image = picture.image();
            let all = [
                pentland::tilts(&image, masked).unwrap().tilts,
                lee_rosenfeld::tilts(&image, masked).unwrap(),
                zheng_chellappa::tilts(&image, masked).unwrap(),
            ];
            for (method, tilts) in all.iter().enumerate() {
                for got in tilts {
                    let off = angle_between(*got, f64::to_radians(tilt));
                    assert!(off < GRID_TILT, "method {method}, slant {slant}, tilt {tilt}: off by {off}");
                }
            }
        }
    }
}

#[test]
fn a_disc_gives_the_tilts_of_three_lights_at_once() {
    let lights = [[50.0, 100.0], [35.0, -25.0], [45.0, -140.0]];
    let picture = sphere(130.0, 90.0, lights, true);
    let image = picture.image();
    let mut workspace = vec![f32::NAN; workspace_len(picture.mask.len())];
    let found = largest_disc(&image, masked, &mut workspace).unwrap();
    let given = Disc { x: picture.width / 2, y: picture.height / 2, radius_squared: 70 * 70 };
    let (found_tilts, given_tilts) = (
        chojnacki::tilts(&image, masked, &found).unwrap(),
        chojnacki::tilts(&image, masked, &given).unwrap(),
    );
    let whole = lee_rosenfeld::tilts(&image, masked).unwrap();
    let mut worst = 0.0_f64;
    for (i, light) in lights.iter().enumerate() {
        assert!(angle_between(given_tilts[i], light[1].to_radians()) < GRID_TILT);
        // The largest disc is not about the pole, but it is round.
        assert!(angle_between(found_tilts[i], light[1].to_radians()) < 12.0);
        worst = worst.max(angle_between(whole[i], light[1].to_radians()));
    }
    // What the disc is for: the pixels that see all three lights are not symmetric about any.
    assert!(worst > 2.0, "{worst}");
}

/// Sum and sum of squares of differences I(to) - I(from), and their count, over all pixels of the picture.
fn naive_differences(picture: &Picture, (dx, dy): (i64, i64)) -> Vec<[f64; 3]> {
    let mut differences = Vec::new();
    for row in 0..picture.height as i64 {
        for column in 0..picture.width as i64 {
            // y is up and rows go down.
            let to = usize::try_from(column + dx).ok().zip(usize::try_from(row - dy).ok());
            let from = picture.inside(column as usize, row as usize);
            if let (Some(from), Some(to)) = (from, to.and_then(|(c, r)| picture.inside(c, r))) {
                differences.push([0, 1, 2].map(|k| to[k] - from[k]));
            }
        }
    }
    differences
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().sum::<f64>() / values.count() as f64
}

#[test]
fn tilts_and_slants_elsewhere_are_their_definitions() {
    for (width, height, seed) in [(2, 2, 5), (63, 9, 1), (64, 8, 2), (65, 7, 3), (127, 6, 4), (200, 31, 6)] {
        let picture = if width == 2 {
            Picture::new(2, 2, |x, y| Some([x + y + 3.0, 5.0 - x * y + 0.3 * x, 2.0 * x - y + x * y]))
        } else {
            Picture::random(width, height, seed)
        };
        let image = picture.image();
        let [east, north, north_east, north_west] =
            [(1, 0), (0, 1), (1, 1), (-1, 1)].map(|step| naive_differences(&picture, step));
        let rosenfeld = lee_rosenfeld::tilts(&image, masked).unwrap();
        let zheng = zheng_chellappa::tilts(&image, masked).unwrap();
        let slants = slant::pentland::slants(&image, masked).unwrap();
        for k in 0..3 {
            let [e, n] = [&east, &north].map(|d| mean(d.iter().map(|d| d[k])));
            assert!((rosenfeld[k] - n.atan2(e)).abs() < SUMS);
            // Eqs. 20-22 with the unit directions (1,0), (0,1), (1,1)/sqrt 2, (-1,1)/sqrt 2.
            let h = 0.5_f64.sqrt();
            let [ne, nw] = [&north_east, &north_west].map(|d| mean(d.iter().map(|d| d[k] * h)));
            let (ix, iy) = ((e + h * ne - h * nw) / 2.0, (n + h * ne + h * nw) / 2.0);
            assert!((pentland::tilts(&image, masked).unwrap().tilts[k] - iy.atan2(ix)).abs() < SUMS);
            let variance = |d: &Vec<[f64; 3]>, scale: f64| {
                let about = mean(d.iter().map(|d| d[k] * scale));
                mean(d.iter().map(|d| (d[k] * scale - about).powi(2)))
            };
            let spread = (variance(&east, 1.0)
                + variance(&north, 1.0)
                + variance(&north_east, h)
                + variance(&north_west, h))
                / 4.0;
            let statistic = (ix * ix + iy * iy) / spread;
            // A linear channel has no spread at all, and an infinite statistic.
            assert!((1.0 / slants[k].statistic - 1.0 / statistic).abs() < 1e-7);
            let want = if statistic > 1.0 { FRAC_PI_2 } else { (1.0 - statistic).sqrt().acos() };
            assert!((slants[k].slant - want).abs() < 1e-7);
            // Zheng and Chellappa: the gradient that fits all six differences of a cell best.
            let mut votes = [0.0; 2];
            for (row, column) in (0..height).flat_map(|r| (0..width).map(move |c| (r, c))) {
                let corner = |dc, dr| picture.inside(column + dc, row + dr).map(|c| c[k]);
                let (Some(tl), Some(tr), Some(bl), Some(br)) =
                    (corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1))
                else {
                    continue;
                };
                let samples = [
                    (1.0, 0.0, tr - tl),
                    (1.0, 0.0, br - bl),
                    (0.0, 1.0, tl - bl),
                    (0.0, 1.0, tr - br),
                    (h, h, (tr - bl) * h),
                    (-h, h, (tl - br) * h),
                ];
                let sum = |f: &dyn Fn(&(f64, f64, f64)) -> f64| samples.iter().map(f).sum::<f64>();
                let (xx, xy, yy) = (sum(&|s| s.0 * s.0), sum(&|s| s.0 * s.1), sum(&|s| s.1 * s.1));
                let (xd, yd) = (sum(&|s| s.0 * s.2), sum(&|s| s.1 * s.2));
                let det = xx * yy - xy * xy;
                let (x, y) = ((yy * xd - xy * yd) / det, (xx * yd - xy * xd) / det);
                votes[0] += x / x.hypot(y);
                votes[1] += y / x.hypot(y);
            }
            assert!((zheng[k] - votes[1].atan2(votes[0])).abs() < SUMS);
        }
    }
}

#[test]
fn turning_the_picture_turns_the_tilts() {
    let picture = Picture::random(90, 90, 11);
    let turned = Picture::new(90, 90, |x, y| {
        // Counter-clockwise: what is at (x, y) was at (y, -x).
        picture.inside((y + 44.5) as usize, (44.5 + x) as usize)
    });
    let swapped = Picture::new(90, 90, |x, y| {
        picture.inside((x + 44.5) as usize, (44.5 - y) as usize).map(|[r, g, b]| [4.0 * b, 4.0 * r, 4.0 * g])
    });
    let disc = Disc { x: 45, y: 45, radius_squared: 900 };
    let all = |picture: &Picture, disc: Disc| {
        let image = picture.image();
        [
            lee_rosenfeld::tilts(&image, masked).unwrap(),
            zheng_chellappa::tilts(&image, masked).unwrap(),
            chojnacki::tilts(&image, masked, &disc).unwrap(),
        ]
    };
    let (before, after) = (all(&picture, disc), all(&turned, Disc { y: 44, ..disc }));
    for (before, after) in before.iter().flatten().zip(after.iter().flatten()) {
        assert!(angle_between(before + FRAC_PI_2, *after) < 1e-9, "{before} {after}");
    }
    for (one, [r, g, b]) in all(&swapped, disc).iter().zip(before) {
        assert!(one.iter().zip([b, r, g]).all(|(one, other)| (one - other).abs() < SUMS));
    }
    let slants = |picture: &Picture| {
        let image = picture.image();
        [
            slant::pentland::slants(&image, masked).unwrap(),
            slant::lee_rosenfeld::slants(&image, masked).unwrap().0,
            slant::zheng_chellappa::slants(&image, masked).unwrap(),
        ]
    };
    for (one, [r, g, b]) in slants(&swapped).iter().zip(slants(&picture)) {
        assert!(one.iter().zip([b, r, g]).all(|(one, other)| (one.slant - other.slant).abs() < 1e-6));
    }
}

#[test]
fn the_largest_disc_is_the_largest() {
    let mut rng = Rng::new(9);
    for (width, height, density) in [
        (1, 1, 1.0),
        (5, 1, 1.0),
        (1, 6, 1.0),
        (30, 20, 1.0),
        (40, 33, 0.99),
        (70, 25, 0.97),
        (66, 40, 0.7),
        (25, 60, 0.9),
        (20, 20, 0.0),
    ] {
        let picture = Picture::new(width, height, |_, _| (rng.unit() < density).then_some([1.0; 3]));
        let outlier = |column: i64, row: i64| {
            let place = usize::try_from(column).ok().zip(usize::try_from(row).ok());
            place.and_then(|(c, r)| picture.inside(c, r)).is_none()
        };
        // Outliers count in squares of four; the picture's surroundings do.
        let outside = |column: i64, row: i64| {
            let square = |c: i64, r: i64| (0..4).all(|i| outlier(c + i % 2, r + i / 2));
            (0..4).any(|i| square(column - i % 2, row - i / 2))
        };
        // How far from the center the nearest pixel is that is outside.
        let reach = |x: usize, y: usize| {
            let mut nearest = u64::MAX;
            for row in -1..=height as i64 {
                for column in -1..=width as i64 {
                    if outside(column, row) {
                        let (dx, dy) = (column - x as i64, row - y as i64);
                        nearest = nearest.min((dx * dx + dy * dy).unsigned_abs());
                    }
                }
            }
            nearest
        };
        let mut best: Option<Disc> = None;
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let radius_squared = reach(x, y);
            if radius_squared > best.map_or(0, |disc| disc.radius_squared) {
                best = Some(Disc { x, y, radius_squared });
            }
        }
        let mut workspace = vec![f32::NAN; width * height + 1];
        assert_eq!(largest_disc(&picture.image(), masked, &mut workspace), best);
        assert!(workspace[width * height].is_nan());
        assert_eq!(largest_disc(&picture.image(), masked, &mut workspace[..width * height - 1]), None);
        let Some(disc) = best else { continue };
        let mut count = 0;
        picture.image().for_each_window(|window| {
            for i in (0..window.len).filter(|i| disc.bits(window) >> i & 1 == 1) {
                assert!(!outside((window.x + i) as i64, window.y as i64));
            }
            count += u64::from(disc.bits(window).count_ones());
        });
        assert!(count > 0 && (disc.radius_squared > 1 || count == 1));
    }
}

#[test]
fn pentland_s_slant_of_a_cap_is_what_eq_22_makes_of_it() {
    for (cap, slant) in [(30.0_f64, 5.0_f64), (50.0, 10.0), (50.0, 20.0), (60.0, 25.0), (50.0, 38.0)] {
        let picture = sphere(300.0, cap, [[slant, 70.0]; 3], false);
        let estimates = slant::pentland::slants(&picture.image(), masked).unwrap();
        // Mean gradient rho sin s / R; variance of a derivative rho^2 cos^2 s / R^2 <x^2 / (R^2 - x^2 - y^2)>.
        let u = cap.to_radians().sin().powi(2);
        let spread = 0.5 * (-(1.0 - u).ln() / u - 1.0);
        let statistic = slant.to_radians().tan().powi(2) / spread;
        for estimate in estimates {
            assert!(
                (estimate.statistic / statistic - 1.0).abs() < 0.03,
                "{} {statistic}",
                estimate.statistic
            );
            let want = if statistic < 1.0 { statistic.sqrt().asin() } else { FRAC_PI_2 };
            assert!((estimate.slant - want).to_degrees().abs() < 1.5);
            assert_eq!(estimate.reach, if statistic < 1.0 { Reach::Inside } else { Reach::AboveLargest });
        }
    }
}

#[test]
fn lee_and_rosenfeld_s_slant_of_a_sphere_is_the_light_s() {
    assert!((slant::lee_rosenfeld::ratio(0.0) - 3.0 / (2.0 * 2_f64.sqrt())).abs() < 1e-12);
    assert!((slant::lee_rosenfeld::ratio(FRAC_PI_2) - 3.0 * PI / 8.0).abs() < 1e-12);
    let angles = (0..3130).map(|i| f64::from(i) * 1e-3);
    assert!(
        angles
            .clone()
            .zip(angles.skip(1))
            .all(|(a, b)| slant::lee_rosenfeld::ratio(a) < slant::lee_rosenfeld::ratio(b))
    );
    for slant in [20.0_f64, 45.0, 70.0, 90.0, 110.0] {
        let picture = sphere(200.0, 90.0, [[slant, -40.0]; 3], true);
        let (estimates, strengths) = slant::lee_rosenfeld::slants(&picture.image(), masked).unwrap();
        for ((estimate, strength), want) in estimates.iter().zip(strengths).zip([100.0, 60.0, 20.0]) {
            let off = (estimate.slant.to_degrees() - slant).abs();
            assert!(off < 1.0 && estimate.reach == Reach::Inside, "{slant}: {estimate:?}");
            assert!((strength / want - 1.0).abs() < 0.02, "{slant}: {strength}");
        }
    }
    // A picture with less contrast than any sphere, and one with more.
    let extreme = Picture::new(40, 40, |x, _| Some([200.0 + x, 200.0, if x > 15.0 { 50.0 } else { 0.5 }]));
    let ([low, flat, high], strengths) = slant::lee_rosenfeld::slants(&extreme.image(), masked).unwrap();
    // At slant 0 the mean is two thirds of the strength.
    assert!((strengths[1] - 300.0).abs() < 1e-9, "{strengths:?}");
    assert_eq!((low.slant, low.reach), (0.0, Reach::BelowZero));
    assert_eq!((flat.slant, flat.reach, flat.statistic), (0.0, Reach::BelowZero, 1.0));
    assert!(high.reach == Reach::AboveLargest && high.slant > 3.1);
}

/// f3 by summing over a grid of normals.
fn naive_f3(slant: f64) -> f64 {
    const STEPS: i32 = 1000;
    let (mut first, mut second) = (0.0, 0.0);
    for i in 0..STEPS {
        let b = FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(STEPS);
        for j in 0..STEPS {
            let a = PI * (f64::from(j) + 0.5) / f64::from(STEPS);
            let intensity = (slant.cos() * b.cos() + slant.sin() * b.sin() * a.cos()).max(0.0);
            first += intensity * b.cos();
            second += intensity * intensity * b.cos();
        }
    }
    let cell = FRAC_PI_2 / f64::from(STEPS * STEPS);
    first * cell / (second * cell).sqrt()
}

#[test]
fn f3_is_its_integral_and_near_the_published_polynomial() {
    let polynomial = [0.5577, 0.6240, 0.1882, -0.6514, -0.5350, 0.9282, 0.3476, -0.4984];
    for degrees in (0..=90).step_by(5) {
        let slant = f64::from(degrees).to_radians();
        let f3 = slant::zheng_chellappa::f3(slant);
        // The grid's own error.
        assert!((f3 - naive_f3(slant)).abs() < 1e-5, "{degrees}");
        let published = polynomial.iter().rev().fold(0.0, |sum, c| sum * slant.cos() + c);
        assert!((f3 - published).abs() < 0.007, "{degrees}");
    }
    let angles = (0..=1570).map(|i| f64::from(i) * 1e-3);
    assert!(
        angles
            .clone()
            .zip(angles.skip(1))
            .all(|(a, b)| slant::zheng_chellappa::f3(a) > slant::zheng_chellappa::f3(b))
    );
}

#[test]
fn zheng_and_chellappa_s_slant_is_right_where_its_density_is() {
    // The surface of revolution whose normals' slants have the density cos b: sin b = (r / R)^2.
    for slant in [0.0_f64, 20.0, 45.0, 60.0, 80.0] {
        let (a, radius) = (direction([slant, 25.0]), 200.0);
        let picture = Picture::new(403, 403, |x, y| {
            let (r, sin) = (x.hypot(y).max(1e-9), (x * x + y * y) / (radius * radius));
            let cosine = (a[0] * x + a[1] * y) / r * sin + a[2] * (1.0 - sin * sin).max(0.0).sqrt();
            (sin < 1.0).then_some([90.0 * cosine.max(0.0); 3])
        });
        for estimate in slant::zheng_chellappa::slants(&picture.image(), masked).unwrap() {
            // Flat at slant 0: there a small error of the ratio is a large one of the angle.
            let tolerance = if slant == 0.0 { 3.0 } else { 0.5 };
            assert!((estimate.slant.to_degrees() - slant).abs() < tolerance, "{slant}: {estimate:?}");
        }
    }
    // On a sphere <I> = 2/(3 pi) ((pi - s) cos s + sin s) and <I^2> = (1 + cos s)^2 / 8 over the whole disc.
    for (slant, reads) in [(0.0_f64, 24.0), (30.0, 46.0), (60.0, 70.0), (85.0, 84.0)] {
        let s = slant.to_radians();
        let first = 2.0 / (3.0 * PI) * ((PI - s) * s.cos() + s.sin());
        let statistic = first / ((1.0 + s.cos()).powi(2) / 8.0).sqrt();
        let picture = sphere(200.0, 90.0, [[slant, 25.0]; 3], false);
        for estimate in slant::zheng_chellappa::slants(&picture.image(), masked).unwrap() {
            assert!((estimate.statistic - statistic).abs() < 2e-3, "{slant}: {estimate:?} {statistic}");
            if estimate.reach == Reach::Inside {
                assert!((naive_f3(estimate.slant) - estimate.statistic).abs() < 1e-5);
            }
            let read = estimate.slant.to_degrees();
            assert!((read - reads).abs() < 2.0, "{slant} reads {read}");
        }
    }
    let extreme = Picture::new(40, 40, |x, _| Some([200.0, if x > 15.0 { 50.0 } else { 0.5 }, 200.0 + x]));
    let [flat, high, _] = slant::zheng_chellappa::slants(&extreme.image(), masked).unwrap();
    assert_eq!((flat.slant, flat.reach), (0.0, Reach::BelowZero));
    assert_eq!((high.slant, high.reach), (FRAC_PI_2, Reach::AboveLargest));
}

#[test]
fn channel_maxima_are_the_norms_where_a_normal_faces_each_light() {
    let picture = sphere(100.0, 90.0, [[30.0, 0.0], [50.0, 120.0], [20.0, -90.0]], false);
    let norms = channel_maxima::norms(&picture.image(), masked).unwrap();
    for (got, want) in norms.iter().zip([100.0, 60.0, 20.0]) {
        assert!(*got <= want && *got > 0.999 * want);
    }
    // Negative values are values too.
    let dark = Picture::new(3, 3, |x, _| Some([-5.0 + x, -3.0, 0.0]));
    assert_eq!(channel_maxima::norms(&dark.image(), masked), Some([-4.0, -3.0, 0.0]));
    assert_eq!(channel_maxima::norms(&dark.image(), |_| 0), None);
}

#[test]
fn too_little_is_no_answer() {
    let disc = Disc { x: 0, y: 0, radius_squared: 100 };
    let attempt = |picture: &Picture, inliers: &dyn Fn(&Window) -> u64| -> [bool; 6] {
        let image = picture.image();
        let found = |estimates: Option<[Estimate; 3]>| estimates.is_some();
        [
            lee_rosenfeld::tilts(&image, inliers).is_some(),
            zheng_chellappa::tilts(&image, inliers).is_some(),
            chojnacki::tilts(&image, inliers, &disc).is_some(),
            found(slant::pentland::slants(&image, inliers)),
            found(slant::lee_rosenfeld::slants(&image, inliers).map(|(estimates, _)| estimates)),
            found(slant::zheng_chellappa::slants(&image, inliers)),
        ]
    };
    let slope = Picture::new(9, 9, |x, y| Some([x + 9.0, y + 9.0, x + y + 20.0]));
    assert_eq!(attempt(&slope, &masked), [true; 6]);
    assert_eq!(attempt(&slope, &|_| 0), [false; 6]);
    // A row has no vertical pair; single pixels are enough for means.
    assert_eq!(
        attempt(&slope, &|w| if w.y == 4 { w.masked } else { 0 }),
        [false, false, false, false, true, true]
    );
    assert_eq!(attempt(&slope, &|w| w.masked & 1), [false, false, false, false, true, true]);
    // Flat in one channel.
    let flat = Picture::new(9, 9, |x, y| Some([x + 9.0, y + 9.0, 20.0]));
    assert_eq!(attempt(&flat, &masked), [false, false, false, false, true, true]);
    // Not positive in one channel; not a number in one channel.
    let black = Picture::new(9, 9, |x, y| Some([x + 9.0, y + 9.0, -(x + 2.0 * y) - 30.0]));
    assert_eq!(attempt(&black, &masked), [true, true, true, true, false, false]);
    let nan = Picture::new(9, 9, |x, y| Some([x + 9.0, y + 9.0, if x > 3.0 { f64::NAN } else { x + y }]));
    assert_eq!(attempt(&nan, &masked)[..4], [false, true, false, false]);
    assert_eq!(attempt(&nan, &masked)[4..], [false, false]);
    // A plane's derivatives do not vary: the slant's sine is beyond 1.
    let estimates = slant::pentland::slants(&slope.image(), masked).unwrap();
    assert!(estimates.iter().all(|e| e.slant == FRAC_PI_2 && e.reach == Reach::AboveLargest));
}
