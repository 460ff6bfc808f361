//! Reliefs under three lights with uneven paint, noise and rounding, and how good a C is for them.

use crate::depth_maps::{Relief, direction};
use crate::linear::{
    Matrix, apply, cholesky, degrees_between, dot, inverse, least_squares, median, nearest_orthogonal,
    transpose, unit,
};
use crate::linear_scenes::normal;
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Image, Order, Sample};
use ofc_core::render::{self, Canvas, Lights, Outputs, Rows, render};

/// Three white lights a third of a turn apart, each seen by one channel for the most part, as `Lights` takes them.
#[must_use]
pub fn studio() -> ([f64; 9], [f64; 9]) {
    let mut a = [0.0; 9];
    for (row, angles) in a.as_chunks_mut().0.iter_mut().zip([[35.0, 95.0], [40.0, -25.0], [38.0, -145.0]]) {
        *row = direction(angles);
    }
    (a, [200.0, 20.0, 15.0, 25.0, 190.0, 20.0, 15.0, 30.0, 210.0])
}

/// A picture and its truth.
pub struct Painted {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// RGB, 8 bits, tight rows.
    pub rgb: Vec<u8>,
    /// 255 on the object.
    pub mask: Vec<u8>,
    /// Unit normals, zero beside the object.
    pub normals: Vec<[f32; 3]>,
    /// Where all lights are seen.
    pub lit: Vec<bool>,
    /// What green was multiplied by.
    pub albedo: Vec<f64>,
}

impl Painted {
    /// The picture restricted to its object.
    ///
    /// # Panics
    /// Never: the sizes are its own.
    #[must_use]
    pub fn image(&self) -> Image<'_> {
        Image::interleaved(&self.rgb, self.width, self.height, self.width * 3, Sample::U8, Order::Rgb)
            .and_then(|image| image.with_mask(&self.mask, self.width))
            .expect("the scene's own sizes")
    }

    /// Colors and true normals where all lights are seen.
    #[must_use]
    pub fn colors_with_truth(&self) -> Vec<([f64; 3], [f64; 3])> {
        let colors = self.rgb.as_chunks::<3>().0.iter().zip(&self.normals).zip(&self.lit);
        let lit = colors.filter(|((color, _), lit)| **lit && color.iter().all(|&value| value < u8::MAX));
        lit.map(|((color, truth), _)| (color.map(f64::from), truth.map(f64::from))).collect()
    }
}

/// Renders a relief with paint: what each channel of a pixel is multiplied by.
///
/// # Panics
/// When the lights are none.
#[must_use]
pub fn painted(
    relief: &Relief,
    (a, b): &([f64; 9], [f64; 9]),
    paint: impl Fn(usize, usize) -> [f64; 3],
    noise: f64,
    seed: u64,
) -> Painted {
    let (width, height) = (relief.width, relief.height);
    let bytes = relief.bytes();
    let mut bare = vec![0; width * height * 12];
    let (mut seen, mut normals) = (vec![0; width * height], vec![0.0; width * height * 3]);
    let outputs = Outputs {
        picture: Canvas::new(&mut bare, width, height, width * 12, Sample::F32, Order::Rgb).expect("room"),
        seen: Some(Rows { values: &mut seen, row_stride: width }),
        normals: Some(Rows { values: &mut normals, row_stride: width * 3 }),
    };
    render(&relief.view(&bytes), &Lights::new(a, b).expect("lights"), &render::Params::default(), outputs)
        .expect("a picture");
    let values: Vec<f64> = bare.as_chunks().0.iter().map(|v| f64::from(f32::from_ne_bytes(*v))).collect();
    let factors: Vec<[f64; 3]> = (0..width * height).map(|i| paint(i % width, i / width)).collect();
    let colors = values.as_chunks::<3>().0.iter().zip(&factors);
    let colors: Vec<[f64; 3]> = colors.map(|(color, paint)| [0, 1, 2].map(|c| color[c] * paint[c])).collect();
    let mut largest: Vec<f64> =
        colors.iter().map(|color| color.iter().copied().fold(0.0, f64::max)).collect();
    largest.sort_by(f64::total_cmp);
    let factor = 250.0 / largest[largest.len() * 995 / 1000];
    let mut rng = Rng::new(seed);
    #[expect(clippy::cast_sign_loss, reason = "clamped")]
    let mut round = |value: f64| (factor * value + noise * normal(&mut rng)).round().clamp(0.0, 255.0) as u8;
    let rgb = colors
        .iter()
        .zip(&relief.mask)
        .flat_map(|(color, &inside)| if inside == 0 { [0; 3] } else { color.map(&mut round) })
        .collect();
    Painted {
        width,
        height,
        rgb,
        mask: relief.mask.clone(),
        normals: normals.as_chunks().0.to_vec(),
        lit: seen.iter().map(|&lights| lights == 7).collect(),
        albedo: factors.iter().map(|factor| factor[1]).collect(),
    }
}

/// A paint of that name, gray: `even`, `two` albedos with a winding border, a `gradient` from 0.6 to 1.6, fourteen `patches` between
/// 0.55 and 1.6, `blobs` of twelve pixels, and `speckle` of one.
pub fn paint(name: &str, size: usize, seed: u64) -> impl Fn(usize, usize) -> [f64; 3] {
    let mut rng = Rng::new(seed);
    let places: Vec<[f64; 3]> = (0..14).map(|_| [(); 3].map(|()| rng.unit())).collect();
    let rough = match name {
        "blobs" => noise_field(size, 12, 0.35, &mut rng),
        "speckle" => noise_field(size, 1, 0.25, &mut rng),
        _ => Vec::new(),
    };
    let name = name.to_owned();
    move |x, y| {
        let (u, v) = (x as f64 / size as f64, y as f64 / size as f64);
        let value = match name.as_str() {
            "two" => {
                if (7.0 * u + 2.0 * (5.0 * v).sin()).sin() > 0.0 {
                    1.0
                } else {
                    0.6
                }
            }
            "gradient" => 0.6 + ((u + 0.3 * v) / 1.3).clamp(0.0, 1.0),
            "patches" => {
                let square = |p: &&[f64; 3]| (u - p[0]).powi(2) + (v - p[1]).powi(2);
                let nearest = places.iter().min_by(|a, b| square(a).total_cmp(&square(b)));
                0.55 + 1.05 * nearest.expect("a patch")[2]
            }
            "blobs" | "speckle" => rough[y * size + x].exp(),
            _ => 1.0,
        };
        [value; 3]
    }
}

/// Noise smoothed by a Gaussian of so many pixels, with that deviation.
fn noise_field(size: usize, sigma: usize, deviation: f64, rng: &mut Rng) -> Vec<f64> {
    let mut field: Vec<f64> = (0..size * size).map(|_| normal(rng)).collect();
    let reach = 3 * sigma;
    let weights: Vec<f64> =
        (0..=2 * reach).map(|i| (-0.5 * ((i as f64 - reach as f64) / sigma as f64).powi(2)).exp()).collect();
    for axis in [1, size] {
        let before = field.clone();
        for (i, value) in field.iter_mut().enumerate() {
            let place = i / axis % size;
            let at = |k: usize| (place + k).checked_sub(reach).filter(|&other| other < size);
            *value = weights
                .iter()
                .enumerate()
                .filter_map(|(k, w)| at(k).map(|other| w * before[i - place * axis + other * axis]))
                .sum();
        }
    }
    let rms = (field.iter().map(|v| v * v).sum::<f64>() / field.len() as f64).sqrt();
    field.iter().map(|v| deviation * v / rms).collect()
}

/// The median angle in degrees between the normals that C makes and the true ones, after the best orthogonal matrix: twice trimmed
/// to two and a half medians.
#[must_use]
pub fn oracle(form: &[f64; 6], pixels: &[([f64; 3], [f64; 3])]) -> f64 {
    let [c11, c22, c33, c12, c13, c23] = *form;
    let root = transpose(cholesky([[c11, c12, c13], [c12, c22, c23], [c13, c23, c33]]));
    let normals: Vec<([f64; 3], [f64; 3])> =
        pixels.iter().map(|&(color, truth)| (unit(apply(root, color)), truth)).collect();
    let mut kept = vec![true; normals.len()];
    let mut error = f64::NAN;
    for _ in 0..3 {
        let mut correlation: Matrix = [[0.0; 3]; 3];
        for (&(n, truth), _) in normals.iter().zip(&kept).filter(|(_, kept)| **kept) {
            for (row, t) in correlation.iter_mut().zip(truth) {
                row.iter_mut().zip(n).for_each(|(entry, n)| *entry += t * n);
            }
        }
        let turn = nearest_orthogonal(correlation);
        let errors: Vec<f64> =
            normals.iter().map(|&(n, truth)| degrees_between(apply(turn, n), truth)).collect();
        error = median(&errors);
        kept = errors.iter().map(|&e| e <= 2.5 * error).collect();
    }
    error
}

/// The pixels of a photograph whose color's direction a linear F explains: without shadows and highlights, whatever the paint. F and
/// the albedos are fitted in turn.
#[must_use]
pub fn explained(pixels: &[([f64; 3], [f64; 3])]) -> Vec<([f64; 3], [f64; 3])> {
    let mut kept = vec![true; pixels.len()];
    let mut albedos = vec![1.0; pixels.len()];
    let mut near = Vec::new();
    for _ in 0..12 {
        let chosen: Vec<usize> = (0..pixels.len()).filter(|&i| kept[i]).collect();
        let rows: Vec<[f64; 3]> = chosen.iter().map(|&i| pixels[i].1).collect();
        let f: Matrix = [0, 1, 2].map(|c: usize| {
            let response: Vec<f64> = chosen.iter().map(|&i| pixels[i].0[c] / albedos[i]).collect();
            least_squares(&rows, &response).0
        });
        for (albedo, &(color, truth)) in albedos.iter_mut().zip(pixels) {
            let bare = apply(f, truth);
            *albedo = (dot(color, bare) / dot(bare, bare)).clamp(0.05, 20.0);
        }
        let back = inverse(f);
        let errors: Vec<f64> =
            pixels.iter().map(|&(color, truth)| degrees_between(apply(back, color), truth)).collect();
        let own: Vec<f64> = chosen.iter().map(|&i| errors[i]).collect();
        let limit = (2.5 * median(&own)).max(3.0);
        kept = errors.iter().map(|&e| e < limit).collect();
        near = errors.iter().map(|&e| e < 12.0).collect();
    }
    pixels
        .iter()
        .zip(kept)
        .zip(near)
        .filter(|((_, kept), near)| *kept && *near)
        .map(|((pixel, _), _)| *pixel)
        .collect()
}
