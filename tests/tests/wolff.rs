//! The matte weight against Fresnel's equations in sines and tangents, written for light that leaves the surface.

use ofc_core::math::rng::Rng;
use ofc_core::orientation::matrix::{Orientation, RANK_THRESHOLD};
use ofc_core::surface::normals::TooShort;
use ofc_core::surface::wolff::Dielectric;
use ofc_tests::linear::{apply, inverse, unit};
use ofc_tests::linear_scenes::{Scene, three_lights};
use ofc_tests::tolerances::STORED_AS_F32;
use std::f64::consts::FRAC_PI_2;

/// The share of unpolarized light that leaves a surface of that refractive index at an angle from the normal, coming from below at
/// the angle that Snell's law says.
fn leaving(angle: f64, index: f64) -> f64 {
    let below = (angle.sin() / index).asin();
    let (difference, sum) = (below - angle, below + angle);
    let across = (difference.sin() / sum.sin()).powi(2);
    let along = (difference.tan() / sum.tan()).powi(2);
    1.0 - 0.5 * (across + along)
}

#[test]
fn the_weight_is_what_leaves_over_what_leaves_along_the_normal() {
    for index in [1.0, 1.1, 1.4, 1.5, 1.9, 2.4] {
        let surface = Dielectric::new(index).expect("a refractive index");
        let upright = 1.0 - ((index - 1.0) / (index + 1.0)).powi(2);
        assert!((surface.weight(1.0) - 1.0).abs() < 1e-15);
        let mut before = 1.0 + 1e-9;
        for step in 1..900 {
            let angle = f64::from(step) * FRAC_PI_2 / 900.0;
            let (weight, wanted) = (surface.weight(angle.cos()), leaving(angle, index) / upright);
            assert!((weight - wanted).abs() < 1e-12, "{index} at {angle}: {weight} is not {wanted}");
            // Brewster's angle makes one polarisation pass unhindered, but never more of both than the normal direction.
            assert!(weight < before + 1e-12 && weight <= 1.0 + 1e-12);
            before = weight;
        }
        // Along the surface nothing leaves, whatever is below.
        assert!(index == 1.0 || surface.weight(1e-12) < 1e-10);
        for away in [0.0, -0.5, -1.0, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(surface.weight(away), 0.0);
        }
    }
    // At Brewster's angle light along the plane of incidence is not reflected, and of light across it this much is.
    let brewster = 1.5_f64.atan();
    let across = f64::powi((1.5 * 1.5 - 1.0) / (1.5 * 1.5 + 1.0), 2);
    let weight = Dielectric::new(1.5).expect("glass").weight(brewster.cos());
    assert!((weight - (1.0 - 0.5 * across) / 0.96).abs() < 1e-14, "{weight}");
    // No refractive index makes more of a normal than the one toward the camera.
    for index in [4.0, 10.0, 1e3, 1e9, 1e200] {
        let surface = Dielectric::new(index).expect("a refractive index");
        assert!((1..=100).all(|step| (0.0..=1.0).contains(&surface.weight(f64::from(step) / 100.0))));
    }
    for bad in [0.999, 0.0, -1.5, f64::NAN, f64::INFINITY] {
        assert_eq!(Dielectric::new(bad), None);
    }
}

#[test]
fn every_inlier_and_nothing_else() {
    const CANARY: f32 = 12_345.0;
    let mut rng = Rng::new(52);
    let (by_core, by_oracle) =
        (Orientation::new(three_lights(), RANK_THRESHOLD).f_inverse, inverse(three_lights()));
    let surface = Dielectric::new(1.5).expect("plastic");
    let (mut seen, mut away) = (0, 0);
    for (width, height, gap) in [(1, 1, 0), (65, 3, 7), (130, 5, 64)] {
        let scene = Scene::paint(width, height, |_, _| [0; 3].map(|_| 255.0 * (2.0 * rng.unit() - 1.0)));
        let mask: Vec<u8> = (0..width * height).map(|_| rng.below(3).min(1) as u8).collect();
        let encoded = scene.encode();
        let image = encoded.image().with_mask(&mask, width).expect("sizes agree");
        let stride = width + gap;
        let mut weights = vec![CANARY; stride * height + 100];
        surface
            .compute(&image, |window| window.masked, &by_core, &mut weights, stride)
            .expect("room for all");
        for (at, &got) in weights.iter().enumerate() {
            let (row, column) = (at / stride, at % stride);
            if row >= height || column >= width {
                assert_eq!(got, CANARY, "behind row {row}");
                continue;
            }
            let pixel = row * width + column;
            let [.., n3] = unit(apply(by_oracle, scene.colors[pixel].map(|c| f64::from(c as f32))));
            let wanted = match mask[pixel] {
                0 => 0.0,
                _ if n3 <= 0.0 => {
                    away += 1;
                    0.0
                }
                _ => {
                    seen += 1;
                    leaving(n3.acos(), 1.5) / 0.96
                }
            };
            assert!((f64::from(got) - wanted).abs() <= 2.0 * STORED_AS_F32, "{got} is not {wanted}");
        }
        let len = stride * (height - 1) + width - 1;
        let mut short = vec![CANARY; len];
        let done = surface.compute(&image, |window| window.masked, &by_core, &mut short, stride);
        assert_eq!((done, short.iter().all(|&w| w == CANARY)), (Err(TooShort), true));
    }
    assert!(seen > 100 && away > 10, "{seen} {away}");
}
