//! What the renderer reads and writes: formats, strides, masks, and the input that it refuses.

use ofc_core::picture::{Image, ImageError, Order, Sample, Window};
use ofc_core::render::{
    Canvas, DepthMap, DepthMapError, Lights, LightsError, Outputs, Params, RenderError, Rows,
    normals_from_depth, render,
};
use ofc_tests::depth_maps::{self, Relief, TABLE_1_COLORS, table_1_directions};
use ofc_tests::shots::shoot;

fn raw(scene: &Relief, params: &Params, sample: Sample, order: Order, pad: usize) -> (Vec<u8>, usize) {
    let (a, b, depths) = (table_1_directions(), TABLE_1_COLORS, scene.bytes());
    let stride = scene.width * order.samples() * sample.bytes() + pad;
    let mut bytes = vec![0xA5; stride * scene.height + 16];
    let picture = Canvas::new(&mut bytes, scene.width, scene.height, stride, sample, order).unwrap();
    let outputs = Outputs { picture, seen: None, normals: None };
    render(&scene.view(&depths), &Lights::new(&a, &b).unwrap(), params, outputs).unwrap();
    (bytes, stride)
}

#[test]
fn integers_are_rounded_and_limited() {
    let scene = depth_maps::bust(77, 64);
    for (sample, largest, peak) in
        [(Sample::U8, 255.0, 255.0), (Sample::U16, 65535.0, 65535.0), (Sample::U8, 255.0, 600.0)]
    {
        // Much noise, so that values below 0 and above the largest occur.
        let params = Params { noise: peak / 20.0, seed: 3, peak, ..Params::default() };
        let exact = shoot(&scene, &table_1_directions(), &TABLE_1_COLORS, &params);
        let low = exact.colors.iter().flatten().any(|&c| c < 0.0);
        let high = exact.colors.iter().flatten().any(|&c| f64::from(c) > largest);
        assert!(low && (high || peak <= 255.0 || sample == Sample::U16));
        for (order, positions) in [
            (Order::Rgb, [0, 1, 2]),
            (Order::Bgr, [2, 1, 0]),
            (Order::Rgba, [0, 1, 2]),
            (Order::Bgra, [2, 1, 0]),
        ] {
            let (bytes, stride) = raw(&scene, &params, sample, order, 5);
            let image = Image::interleaved(&bytes, 77, 64, stride, sample, order).unwrap();
            let mut window = Window::new();
            for (i, color) in exact.colors.iter().enumerate() {
                image.read(i % 77, i / 77, &mut window);
                for (got, want) in window.pixel(0).into_iter().zip(color) {
                    let want = f64::from(*want).clamp(0.0, largest);
                    // The f32 picture is itself rounded: at a half either neighbor will do.
                    assert!((f64::from(got) - want).abs() <= 0.5 + 1e-2, "{got} is not {want}");
                    assert_eq!(got, got.round());
                }
                if sample == Sample::U8 && scene.mask[i] == 0 {
                    let start = i / 77 * stride + i % 77 * order.samples();
                    assert!(positions.iter().all(|p| bytes[start + p] == 0));
                }
            }
            // Padding, what is behind the last row, and the fourth sample stay as they were.
            for (row, line) in bytes.chunks(stride).enumerate() {
                let used = if row < 64 { stride - 5 } else { 0 };
                assert!(line.iter().skip(used).all(|&byte| byte == 0xA5));
                if order.samples() == 4 {
                    let pixels = line[..used].chunks(4 * sample.bytes());
                    assert!(pixels.flat_map(|p| &p[3 * sample.bytes()..]).all(|&byte| byte == 0xA5));
                }
            }
        }
    }
}

#[test]
fn strided_is_contiguous_and_what_is_masked_out_is_never_read() {
    let scene = depth_maps::bust(70, 64);
    let (a, b) = (table_1_directions(), TABLE_1_COLORS);
    let want = shoot(&scene, &a, &b, &Params::default());
    // Bytes at odd addresses, gaps full of NaN, NaN outside the mask.
    let (stride, mask_stride) = (70 * 4 + 7, 73);
    let (mut depths, mut mask) = (vec![0xFF; 1 + stride * 64], vec![0xFF; mask_stride * 64]);
    for (i, (&z, &inside)) in scene.depth.iter().zip(&scene.mask).enumerate() {
        let (x, y) = (i % 70, i / 70);
        let z = if inside == 0 { f32::NAN } else { z };
        depths[1 + y * stride + 4 * x..][..4].copy_from_slice(&z.to_ne_bytes());
        mask[y * mask_stride + x] = inside / 255;
    }
    let map =
        DepthMap::new(&depths[1..], 70, 64, stride, 1.0).unwrap().with_mask(&mask, mask_stride).unwrap();
    let (mut bytes, mut seen, mut normals) = (vec![0; 70 * 64 * 12], vec![77; 71 * 64], vec![7.0; 215 * 64]);
    let picture = Canvas::new(&mut bytes, 70, 64, 70 * 12, Sample::F32, Order::Rgb).unwrap();
    let outputs = Outputs {
        picture,
        seen: Some(Rows { values: &mut seen, row_stride: 71 }),
        normals: Some(Rows { values: &mut normals, row_stride: 215 }),
    };
    render(&map, &Lights::new(&a, &b).unwrap(), &Params::default(), outputs).unwrap();
    for (i, color) in want.colors.iter().enumerate() {
        let bits = color.map(f32::to_ne_bytes).concat();
        assert_eq!(bytes[12 * i..][..12], bits);
        assert_eq!(seen[i / 70 * 71 + i % 70], want.seen[i]);
        assert_eq!(normals[i / 70 * 215 + 3 * (i % 70)..][..3], want.normals[i]);
    }
    assert!(seen.chunks(71).all(|row| row[70] == 77));
    assert!(normals.chunks(215).all(|row| row[210..] == [7.0; 5]));
    let mut alone = vec![7.0; 215 * 64];
    normals_from_depth(&map, &mut Rows { values: &mut alone, row_stride: 215 }).unwrap();
    assert_eq!(alone, normals);
}

#[test]
fn bad_input_is_refused_and_outputs_stay_as_they_were() {
    let zeros = [0_u8; 64];
    assert_eq!(DepthMap::new(&zeros, 0, 4, 16, 1.0).unwrap_err(), DepthMapError::Image(ImageError::Empty));
    assert_eq!(
        DepthMap::new(&zeros, 4, 4, 15, 1.0).unwrap_err(),
        DepthMapError::Image(ImageError::StrideTooSmall)
    );
    assert_eq!(DepthMap::new(&zeros, 4, 5, 16, 1.0).unwrap_err(), DepthMapError::Image(ImageError::TooShort));
    for pitch in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-40] {
        assert_eq!(DepthMap::new(&zeros, 4, 4, 16, pitch).unwrap_err(), DepthMapError::Pitch);
    }
    let map = DepthMap::new(&zeros, 4, 4, 16, 1.0).unwrap();
    assert_eq!(map.with_mask(&zeros[..15], 4).unwrap_err(), ImageError::TooShort);

    let up = [0.0, 0.0, 1.0];
    assert_eq!(Lights::new(&[], &[]).unwrap_err(), LightsError::Count);
    assert_eq!(Lights::new(&up.repeat(33), &[1.0; 99]).unwrap_err(), LightsError::Count);
    assert_eq!(Lights::new(&up[..2], &[1.0; 2]).unwrap_err(), LightsError::Size);
    assert_eq!(Lights::new(&up, &[1.0; 4]).unwrap_err(), LightsError::Size);
    for a in [[0.0; 3], [0.0, 0.0, 1.1], [f64::NAN, 0.0, 1.0]] {
        assert_eq!(Lights::new(&a, &[1.0; 3]).unwrap_err(), LightsError::Direction);
    }
    for color in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Lights::new(&up, &[1.0, color, 1.0]).unwrap_err(), LightsError::Color);
    }

    let lights = Lights::new(&up, &[1.0; 3]).unwrap();
    let attempt = |map: &DepthMap, params: &Params, width: usize, seen_len: usize, normals_stride: usize| {
        let (mut bytes, mut seen, mut normals) = ([0xA5; 60], [7; 16], [7.0; 48]);
        let outputs = Outputs {
            picture: Canvas::new(&mut bytes, width, 4, 15, Sample::U8, Order::Rgb).unwrap(),
            seen: Some(Rows { values: &mut seen[..seen_len], row_stride: 4 }),
            normals: Some(Rows { values: &mut normals, row_stride: normals_stride }),
        };
        let result = render(map, &lights, params, outputs);
        let untouched = bytes == [0xA5; 60] && seen == [7; 16] && normals == [7.0; 48];
        assert_eq!(untouched, result.is_err());
        result.err()
    };
    let good = Params::default();
    assert_eq!(attempt(&map, &good, 4, 16, 12), None);
    assert_eq!(attempt(&map, &good, 5, 16, 12), Some(RenderError::Size));
    assert_eq!(attempt(&map, &good, 4, 15, 12), Some(RenderError::Size));
    assert_eq!(attempt(&map, &good, 4, 16, 11), Some(RenderError::Size));
    assert_eq!(attempt(&map, &good, 4, 16, usize::MAX), Some(RenderError::Size));
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(attempt(&map, &Params { peak: value, ..good }, 4, 16, 12), Some(RenderError::Peak));
        assert_eq!(attempt(&map, &Params { noise: value, ..good }, 4, 16, 12), Some(RenderError::Noise));
    }
    let nan: Vec<u8> =
        [0.0, 0.0, f32::INFINITY, 0.0].repeat(4).iter().flat_map(|z| z.to_ne_bytes()).collect();
    let map = DepthMap::new(&nan, 4, 4, 16, 1.0).unwrap();
    assert_eq!(attempt(&map, &good, 4, 16, 12), Some(RenderError::NonFiniteDepth));
    let mut normals = [7.0; 48];
    let mut rows = Rows { values: &mut normals[..], row_stride: 13 };
    assert_eq!(normals_from_depth(&map, &mut rows), Err(RenderError::Size));
    assert_eq!(normals, [7.0; 48]);
    // There is no surface where the depth is not finite: its neighbors have one-sided differences.
    normals_from_depth(&map, &mut Rows { values: &mut normals[..], row_stride: 12 }).unwrap();
    assert_eq!(
        normals.as_chunks::<3>().0[..4],
        [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0; 3], [0.0, 0.0, 1.0]]
    );
    // The same infinity outside the mask is no matter, nor is an empty mask.
    let masked = map.with_mask(&[1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 1], 4).unwrap();
    assert_eq!(attempt(&masked, &good, 4, 16, 12), None);
    assert_eq!(attempt(&map.with_mask(&[0; 16], 4).unwrap(), &good, 4, 16, 12), None);
}
