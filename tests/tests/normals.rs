//! Normals against F^-1 rho, one pixel at a time.

use ofc_core::math::rng::Rng;
use ofc_core::orientation::matrix::{Orientation, RANK_THRESHOLD};
use ofc_core::surface::normals::{Length, TooShort, compute};
use ofc_tests::linear::{apply, inverse, unit};
use ofc_tests::linear_scenes::{Scene, three_lights};
use ofc_tests::tolerances::STORED_AS_F32;

const CANARY: f32 = 12_345.0;

#[test]
fn every_pixel_and_nothing_else() {
    let mut rng = Rng::new(51);
    let f = three_lights();
    let (by_core, by_oracle) = (Orientation::new(f, RANK_THRESHOLD), inverse(f));
    for (width, height, gap) in [(1, 1, 0), (2, 3, 5), (63, 2, 0), (64, 4, 1), (65, 3, 7), (130, 5, 64)] {
        let scene = Scene::paint(width, height, |_, _| [0; 3].map(|_| 255.0 * rng.unit()));
        let mask: Vec<u8> = (0..width * height).map(|_| rng.below(3).min(1) as u8).collect();
        let encoded = scene.encode();
        let image = encoded.image().with_mask(&mask, width).expect("sizes agree");
        let stride = 3 * width + gap;
        for length in [Length::Kept, Length::Unit] {
            let mut normals = vec![CANARY; stride * height + 100];
            compute(&image, |window| window.masked, &by_core.f_inverse, length, &mut normals, stride)
                .expect("room for all");
            for (at, &got) in normals.iter().enumerate() {
                let (row, column) = (at / stride, at % stride / 3);
                if row >= height || at % stride >= 3 * width {
                    assert_eq!(got, CANARY, "behind row {row}");
                    continue;
                }
                let pixel = row * width + column;
                let color = scene.colors[pixel].map(|c| f64::from(c as f32));
                let kept = apply(by_oracle, color);
                let wanted = match (mask[pixel], length) {
                    (0, _) => [0.0; 3],
                    (_, Length::Kept) => kept,
                    (_, Length::Unit) => unit(kept),
                };
                let wanted = wanted[at % stride % 3];
                assert!((f64::from(got) - wanted).abs() <= STORED_AS_F32 * 3.0, "{got} is not {wanted}");
            }
        }
    }
}

#[test]
fn a_buffer_that_is_too_short_is_left_alone() {
    let scene = Scene::paint(5, 4, |_, _| [10.0; 3]);
    let encoded = scene.encode();
    let by_core = Orientation::new(three_lights(), RANK_THRESHOLD);
    for (len, stride) in [(59, 15), (60, 14), (62, 16), (0, 15), (60, usize::MAX)] {
        let mut normals = vec![CANARY; len];
        let done = compute(
            &encoded.image(),
            |window| window.masked,
            &by_core.f_inverse,
            Length::Kept,
            &mut normals,
            stride,
        );
        assert_eq!(done, Err(TooShort), "{len} {stride}");
        assert!(normals.iter().all(|&n| n == CANARY));
    }
}
