//! The fit, and how sure it is.

use super::center::{Centered, GRADIENT};
use super::descent::{descend, scale_of, weight};
use super::result::{Offset, OffsetError};
use super::sample::{BLOCKS, Sample};
use crate::color::ellipsoid::Coefficients;
use crate::color::inliers::Inliers;
use crate::math::cholesky;
use crate::math::mat3::{self, Mat3};
use crate::picture::Image;

/// Fits the center of the ellipsoid to the inliers, of which it takes `sample_size` at most, and starts at black.
///
/// # Scratch
/// [`workspace_len`](super::workspace_len) `f32` of any content.
///
/// # Errors
/// See [`OffsetError`].
pub fn fit(
    image: &Image,
    inliers: &Inliers,
    around_black: &Coefficients,
    sample_size: usize,
    workspace: &mut [f32],
) -> Result<Offset, OffsetError> {
    let sample = Sample::draw(image, inliers, sample_size, workspace)?;
    let start = Centered::around_black(around_black).scaled(sample.unit).ok_or(OffsetError::Form)?;
    let Sample { unit, noise, colors, distances } = sample;
    let black = descend::<6>(start, colors, distances);
    let found = descend::<9>(black, colors, distances);
    let deviation_around_black = unit * scale_of(&black, colors, distances);
    let deviation = scale_of(&found, colors, distances);
    let (covariance, blocks) = covariance(&found, colors, deviation).ok_or(OffsetError::NotDetermined)?;
    let centered = found.scaled(1.0 / unit).ok_or(OffsetError::NotDetermined)?;
    let inverse = mat3::inverse(&covariance).ok_or(OffsetError::NotDetermined)?;
    let chi_squared = mat3::dot(found.center, mat3::apply(&inverse, found.center));
    let covariance = covariance.map(|row| mat3::scale(row, unit * unit));
    let is_finite = covariance.iter().flatten().all(|entry| entry.is_finite()) && chi_squared.is_finite();
    if !is_finite {
        return Err(OffsetError::NotDetermined);
    }
    Ok(Offset {
        centered,
        covariance,
        deviation: unit * deviation,
        deviation_around_black,
        noise,
        chi_squared,
        count: colors.len(),
        blocks,
    })
}

/// Distances that rounding makes: no fit is better.
const ROUNDING: f64 = 1e-7;

/// The covariance of the center, that of estimating equations whose errors are independent from block to block, and how many blocks
/// there are.
fn covariance(found: &Centered, colors: &[[f32; 4]], deviation: f64) -> Option<(Mat3, usize)> {
    let mut curvature = [[0.0; GRADIENT]; GRADIENT];
    for color in colors {
        let (distance, gradient) = found.distance_and_gradient(color);
        add_outer(&mut curvature, &gradient, weight(distance, deviation));
    }
    let mut spread = curvature.map(|column| column.map(|entry| entry * ROUNDING * ROUNDING));
    let mut blocks = 0;
    for block in 0..BLOCKS {
        let (mut sum, mut is_there) = ([0.0; GRADIENT], false);
        for color in colors.iter().filter(|[.., own]| *own == block as f32) {
            let (distance, gradient) = found.distance_and_gradient(color);
            let factor = distance * weight(distance, deviation);
            for (sum, entry) in sum.iter_mut().zip(gradient) {
                *sum += factor * entry;
            }
            is_there = true;
        }
        add_outer(&mut spread, &sum, 1.0);
        blocks += usize::from(is_there);
    }
    cholesky::factor(&mut curvature)?;
    // (H^-1 S H^-1) of the last three: S between the columns of H^-1.
    let [.., x, y, z] = cholesky::inverse(&curvature);
    let left = blocks.checked_sub(GRADIENT).filter(|&left| left > 0)?;
    let entry = |a: &[f64; GRADIENT], b: &[f64; GRADIENT]| {
        let mut sum = 0.0;
        for (column, factor) in spread.iter().zip(b) {
            sum += factor * cholesky::dot(a, column);
        }
        sum * blocks as f64 / left as f64
    };
    let (xy, xz, yz) = (entry(&x, &y), entry(&x, &z), entry(&y, &z));
    Some(([[entry(&x, &x), xy, xz], [xy, entry(&y, &y), yz], [xz, yz, entry(&z, &z)]], blocks))
}

fn add_outer<const N: usize>(matrix: &mut [[f64; N]; N], vector: &[f64; N], factor: f64) {
    for (column, a) in matrix.iter_mut().zip(vector) {
        for (entry, b) in column.iter_mut().zip(vector) {
            *entry += factor * a * b;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::offset::workspace_len;
    use crate::math::rng::Rng;
    use crate::picture::{Order, Sample as StoredAs, Usable};
    use std::vec;
    use std::vec::Vec;

    /// A ball without shadows under three lights, and the C of its colors.
    fn ball(offset: [f64; 3], noise: f64) -> (Vec<u8>, Coefficients) {
        const SIDE: i32 = 90;
        let mut rng = Rng::new(5);
        let f = [[60.0, 10.0, 150.0], [-40.0, 55.0, 140.0], [-30.0, -60.0, 145.0]];
        let mut bytes = Vec::new();
        for y in 0..SIDE {
            for x in 0..SIDE {
                let (u, v) = (f64::from(2 * x - SIDE) / 96.0, f64::from(SIDE - 2 * y) / 96.0);
                let square = u * u + v * v;
                let normal = [u, v, (1.0 - square).max(0.0).sqrt()];
                let [a, b] = rng.normal_pair();
                for ((row, offset), error) in f.iter().zip(offset).zip([a, b, -0.7 * a]) {
                    let light = mat3::dot(*row, normal) + offset + noise * error;
                    bytes.extend(if square < 0.8 { light as f32 } else { 0.0 }.to_ne_bytes());
                }
            }
        }
        let inverse = mat3::inverse(&f).unwrap();
        let c = mat3::multiply(&mat3::transpose(&inverse), &inverse);
        (bytes, [c[0][0], c[1][1], c[2][2], c[0][1], c[0][2], c[1][2]])
    }

    fn found(bytes: &[u8], form: &Coefficients) -> Result<Offset, OffsetError> {
        let image = Image::interleaved(bytes, 90, 90, 1080, StoredAs::F32, Order::Rgb).unwrap();
        let mut workspace = vec![f32::NAN; workspace_len(3000)];
        fit(&image, &Inliers::all(Usable::below(f32::INFINITY)), form, 3000, &mut workspace)
    }

    #[test]
    fn the_center_is_found_and_how_sure_it_is() {
        for offset in [[0.0; 3], [8.0, 12.0, 5.0], [60.0; 3], [-10.0, -6.0, -8.0]] {
            for noise in [0.2, 0.8] {
                let (bytes, form) = ball(offset, noise);
                let found = found(&bytes, &form).unwrap();
                let off = core::array::from_fn(|c| found.centered.center[c] - offset[c]);
                let sigmas = mat3::dot(off, mat3::apply(&mat3::inverse(&found.covariance).unwrap(), off));
                assert!(sigmas < 25.0, "{offset:?} {noise}: {sigmas} {found:?}");
                assert!(
                    (found.noise / noise - 0.85).abs() < 0.2 && found.deviation < 1.2 * noise,
                    "{found:?}"
                );
                assert!(offset == [0.0; 3] || found.chi_squared > 100.0);
                assert!(offset != [0.0; 3] || found.chi_squared < 25.0);
                assert!(found.count > 1500 && found.blocks > 80);
            }
        }
    }

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let (bytes, form) = ball([0.0; 3], 0.1);
        assert_eq!(found(&bytes, &[1.0, 1.0, -1.0, 0.0, 0.0, 0.0]), Err(OffsetError::Form));
        assert_eq!(found(&vec![0; 90 * 1080], &form), Err(OffsetError::TooFewPixels));
        let image = Image::interleaved(&bytes, 90, 90, 1080, StoredAs::F32, Order::Rgb).unwrap();
        let inliers = Inliers::all(Usable::below(f32::INFINITY));
        let mut workspace = vec![0.0; workspace_len(200) - 1];
        assert_eq!(fit(&image, &inliers, &form, 200, &mut workspace), Err(OffsetError::WorkspaceTooShort));
        let corner = image.crop([40, 40], [8, 8]).unwrap();
        let mut workspace = vec![0.0; workspace_len(200)];
        assert!(fit(&corner, &inliers, &form, 200, &mut workspace).is_ok());
        assert_eq!(fit(&corner, &inliers, &form, 59, &mut workspace), Err(OffsetError::TooFewPixels));
    }
}
