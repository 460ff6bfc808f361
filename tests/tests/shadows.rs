//! Colors that one of the lights does not reach.

use ofc_core::picture::{Faces, Image, Order, PixelCounts, Sample};
use ofc_core::render::{self, Canvas, Lights, Outputs, render};
use ofc_core::solve::{OrientationMethod, Outcome, Params, ShadowRejection, Solution, solve, workspace_len};
use ofc_tests::depth_maps::{Relief, direction, peaks, sphere};

const SIZE: usize = 192;

/// Lights of these slants, a third of a turn apart.
fn picture(relief: &Relief, slants: [f64; 3], noise: f64) -> Vec<u8> {
    let mut a = [0.0; 9];
    for (light, row) in a.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        *row = direction([slants[light], 20.0 + 120.0 * light as f64]);
    }
    let bytes = relief.bytes();
    let mut pixels = vec![0; relief.mask.len() * 3];
    let params = render::Params { noise, seed: 3, ..render::Params::default() };
    let picture =
        Canvas::new(&mut pixels, relief.width, relief.height, relief.width * 3, Sample::U8, Order::Rgb)
            .unwrap();
    let lights = Lights::new(&a, &COLORS).unwrap();
    render(&relief.view(&bytes), &lights, &params, Outputs { picture, seen: None, normals: None }).unwrap();
    pixels
}

const COLORS: [f64; 9] = [90.0, 20.0, 10.0, 25.0, 80.0, 20.0, 10.0, 30.0, 95.0];

fn solved(relief: &Relief, pixels: &[u8], params: Params) -> Solution {
    let image =
        Image::interleaved(pixels, relief.width, relief.height, relief.width * 3, Sample::U8, Order::Rgb)
            .and_then(|image| image.with_mask(&relief.mask, relief.width))
            .unwrap();
    let mut workspace = vec![f32::NAN; workspace_len(relief.mask.len(), params.lmeds.sample_size)];
    let solution = solve(&image, &params, &mut workspace).unwrap();
    assert_eq!(solution.outcome, Outcome::Solved);
    let pixel_counts = &solution.pixel_counts;
    let sum = pixel_counts.usable
        + pixel_counts.masked_out
        + pixel_counts.non_finite
        + pixel_counts.dark
        + pixel_counts.saturated
        + pixel_counts.shaded;
    assert_eq!(sum, relief.mask.len());
    solution
}

/// How many faces there are, and the largest cosine between their normals and the lights' colors that lie in them.
fn faces(shadows: &Faces) -> (usize, f64) {
    let (mut count, mut worst) = (0, 0.0_f64);
    for face in shadows.faces.iter().filter(|face| face.normal != [0.0; 3]) {
        let mut cosines: Vec<f64> = (0..3)
            .map(|light| {
                // Columns: what a light adds to red, green and blue.
                let color = [0, 1, 2].map(|channel| COLORS[channel * 3 + light]);
                let length = color.iter().map(|v| v * v).sum::<f64>().sqrt();
                let normal = face.normal.map(f64::from);
                color.iter().zip(normal).map(|(c, n)| c * n).sum::<f64>() / length
            })
            .collect();
        cosines.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        count += 1;
        worst = worst.max(cosines[1].abs());
        assert!(cosines[2] > 0.3, "the third light is above: {cosines:.3?}");
    }
    (count, worst)
}

#[test]
fn the_faces_are_spanned_by_the_colors_of_two_lights() {
    let relief = sphere(SIZE, SIZE, 0.9, 80.0);
    for noise in [0.0, 0.5, 1.5] {
        let pixels = picture(&relief, [45.0, 50.0, 55.0], noise);
        let solution = solved(&relief, &pixels, Params::default());
        let (count, worst) = faces(&solution.inliers.usable.shadow_faces);
        let share = solution.pixel_counts.shaded as f64
            / (solution.pixel_counts.shaded + solution.pixel_counts.usable) as f64;
        println!("noise {noise}: {count} faces, off by {worst:.4}, {:.1} % shaded", 100.0 * share);
        assert!(count == 3 && worst < 0.02 && (0.2..0.67).contains(&share));
        // Off, and with the direct method unless asked, all pixels stay.
        let off = Params { shadow_rejection: ShadowRejection::Off, ..Params::default() };
        let direct = Params { orientation_method: OrientationMethod::Direct, ..Params::default() };
        for params in [off, direct] {
            let kept = solved(&relief, &pixels, params);
            assert_eq!((kept.pixel_counts.shaded, kept.inliers.usable.shadow_faces), (0, Faces::NONE));
        }
        let asked = Params { shadow_rejection: ShadowRejection::On, ..direct };
        assert_eq!(solved(&relief, &pixels, asked).pixel_counts, solution.pixel_counts);
    }
}

#[test]
fn of_a_large_picture_the_rows_of_a_sample_show_them() {
    // 448 x 448 pixels: every third row is looked at. The shaded share of a ball does not depend on its size.
    let shares = [SIZE, 448].map(|size| {
        let relief = sphere(size, size, 0.9, 80.0);
        let solution = solved(&relief, &picture(&relief, [45.0, 50.0, 55.0], 0.5), Params::default());
        let (count, worst) = faces(&solution.inliers.usable.shadow_faces);
        assert!(count == 3 && worst < 0.02, "{size}: {count} faces, off by {worst:.4}");
        let fit = solution.fit.as_ref().expect("a fit");
        assert_eq!(fit.usable, solution.pixel_counts.usable, "the last fit is to all pixels");
        let PixelCounts { shaded, usable, .. } = solution.pixel_counts;
        shaded as f64 / (shaded + usable) as f64
    });
    println!("shaded: {shares:.3?}");
    assert!((shares[0] - shares[1]).abs() < 0.02);
}

#[test]
fn without_shadows_there_are_no_faces() {
    // All of this relief is lit; and a dome on a cylinder, whose colors lie in a plane at the border but obey the model.
    for (name, relief) in [("peaks", peaks(SIZE, SIZE)), ("bottle", bottle())] {
        for noise in [0.3, 1.0] {
            let pixels = picture(&relief, [15.0, 18.0, 20.0], noise);
            let params = Params {
                orientation_method: OrientationMethod::Direct,
                shadow_rejection: ShadowRejection::On,
                ..Params::default()
            };
            let solution = solved(&relief, &pixels, params);
            assert_eq!(solution.pixel_counts.shaded, 0, "{name} {noise}");
        }
    }
}

/// A cylinder that stands upright under half a ball.
fn bottle() -> Relief {
    Relief::sample(SIZE, SIZE, |u, v| {
        let square = u * u + v.max(0.0) * v.max(0.0);
        (square < 0.7 * 0.7).then(|| (0.8 * 0.8 - square).sqrt())
    })
}
