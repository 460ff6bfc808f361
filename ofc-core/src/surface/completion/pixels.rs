//! From colors to raw normals, and from these to classes and normals.

use super::choose::weight;
use super::class::{
    ALL_LIGHTS, CLASS, INTERPOLATED, ONE_LIGHT, REJECTED, THREE_LIGHTS, TWO_LIGHTS, class, mean_around,
    single_light,
};
use super::map::{Map, Vectors};
use super::state::Known;
use super::three;
use super::vector::{Matrix, apply, dot, form, trace};
use crate::picture::{Image, Usable};
use libm::sqrtf;

/// Reads the raw normals, NaN where a pixel is not usable, and marks the pixels of the mask, whose number it returns.
pub(super) fn read(
    image: &Image,
    usable: Usable,
    f_inverse: &Matrix,
    raw: &mut Vectors,
    classes: &mut Map<u8>,
) -> usize {
    let mut masked = 0;
    image.for_each_window(|window| {
        let bits = usable.exposed(window);
        masked += window.masked.count_ones() as usize;
        let bytes = classes.row_mut(window.y).get_mut(window.x..).unwrap_or_default();
        let row = raw.row_mut(window.y).get_mut(window.x..).unwrap_or_default();
        for (i, (byte, v)) in bytes.iter_mut().zip(row).take(window.len).enumerate() {
            *byte = if window.masked >> i & 1 == 1 { INTERPOLATED } else { 0 };
            *v = if bits >> i & 1 == 1 { apply(f_inverse, window.pixel(i)) } else { [f32::NAN; 3] };
        }
    });
    masked
}

/// Says which pixels are of two lights or one, and writes images of the first, of means over windows of five pixels a side.
pub(super) fn classify(
    [width, height]: [usize; 2],
    known: &Known,
    raw: &Vectors,
    classes: &mut Map<u8>,
    normals: &mut Vectors,
) {
    for y in 0..height {
        for x in 0..width {
            let byte = classes.at(x, y);
            let [first, ..] = raw.at(x, y);
            if byte == 0 || first.is_nan() {
                continue;
            }
            let lights = byte & ALL_LIGHTS;
            let light = single_light(byte);
            let same = |other: u8| other != 0 && other & ALL_LIGHTS == lights;
            let class = match lights.count_ones() {
                2 => {
                    let Some(Some(fold)) = known.folds.get(light) else { continue };
                    let image = mean_around(raw, classes, [x, y], 1, same).and_then(|v| fold.image(v));
                    let mean = mean_around(raw, classes, [x, y], 2, same);
                    let (Some(_), Some(mean)) = (image, mean) else { continue };
                    if let Some(n) = normals.row_mut(y).get_mut(x) {
                        *n = fold.nearest_image(mean);
                    }
                    TWO_LIGHTS
                }
                1 if known.cones.get(light).is_some_and(Option::is_some) => ONE_LIGHT,
                _ => continue,
            };
            classes.set(x, y, lights | class);
        }
    }
}

/// Writes the normals of pixels that see lights, of means of 3 x 3 pixels that see the same ones, and the weights of those that see
/// three. Says which of these are rejected.
pub(super) fn normals(
    known: &Known,
    noise: &Matrix,
    orientation_variance: f32,
    raw: &Vectors,
    classes: &mut Map<u8>,
    normals: &mut Vectors,
    weights: &mut Map<f32>,
) {
    let height = classes.data.len().div_ceil(classes.row_stride.max(1));
    for y in 0..height {
        for x in 0..classes.width {
            let byte = classes.at(x, y);
            let v = raw.at(x, y);
            let [first, ..] = v;
            let lights = byte & ALL_LIGHTS;
            if byte == 0 || first.is_nan() {
                continue;
            }
            let light = single_light(byte);
            let same = |other: u8| other != 0 && other & ALL_LIGHTS == lights;
            let Some(n) = normals.row_mut(y).get_mut(x) else { continue };
            match class(byte) {
                TWO_LIGHTS => {
                    let (Some(Some(fold)), Some(mean)) =
                        (known.folds.get(light), mean_around(raw, classes, [x, y], 1, same))
                    else {
                        continue;
                    };
                    let Some(image) = fold.image(mean) else { continue };
                    *n = image;
                }
                ONE_LIGHT => {
                    let (Some(Some(direction)), Some(Some(cone)), Some(mean)) = (
                        known.directions.get(light),
                        known.cones.get(light),
                        mean_around(raw, classes, [x, y], 1, same),
                    ) else {
                        continue;
                    };
                    let cosine = dot(*direction, mean).clamp(0.0, 1.0);
                    match cone.nearest(cosine, [0.0, 0.0, 1.0], &[None; 3], 0.0) {
                        Some(nearest) => *n = nearest,
                        None => classes.set(x, y, lights | INTERPOLATED),
                    }
                }
                _ if lights == ALL_LIGHTS => {
                    let mean = mean_around(raw, classes, [x, y], 1, |other| other != 0).unwrap_or(v);
                    let Some(found) = three::normal(v, mean, noise) else { continue };
                    *n = found.n;
                    let spread = trace(noise) - form(noise, found.n) + orientation_variance;
                    let angle = sqrtf(1.15 * spread).max(found.misfit);
                    weights.set(x, y, weight(angle, found.n));
                    let class = if found.fits { THREE_LIGHTS } else { REJECTED };
                    classes.set(x, y, byte & !CLASS | class);
                }
                _ => {}
            }
        }
    }
}
