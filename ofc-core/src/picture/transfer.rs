//! Transfer curves: what a file stores of light, and the light back from it.
//!
//! Cameras and image formats store numbers that grow more slowly than the light does. The model is of light, so the curve has to be
//! undone before anything else. Full scale stays full scale: the largest number of a sample type is its own linear value, and
//! floats are taken to be 1 there.
//!
//! # Reference
//! IEC 61966-2-1:1999, which defines sRGB.

use super::image::Image;
use super::layout::{ImageError, Sample};
use super::rows;
use core::fmt;
use libm::{fabs, pow};

/// What was stored of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer<'a> {
    /// The curve of sRGB, which is that of nearly all photographs in JPEG.
    Srgb,
    /// The light to the power of one over this number.
    Gamma(f64),
    /// The linear value of every number that a sample of 8 or 16 bits can be: 256 or 65,536 entries.
    Table(&'a [f32]),
}

/// The least and the largest exponent.
const EXPONENTS: core::ops::RangeInclusive<f64> = 0.1..=10.0;

/// Why nothing was made linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransferError {
    /// An exponent is not from 0.1 to 10.
    Exponent,
    /// A table does not have 256 entries for samples of 8 bits, or 65,536 for those of 16, or is given with floats.
    Length,
    /// A table has an entry that is not finite.
    Entry,
    /// The rows of the output are too short.
    Output(ImageError),
}

impl fmt::Display for TransferError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exponent => f.write_str("the exponent is not from 0.1 to 10"),
            Self::Length => f.write_str("the table has not one entry for every value of a sample"),
            Self::Entry => f.write_str("an entry of the table is not finite"),
            Self::Output(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for TransferError {}

impl From<ImageError> for TransferError {
    fn from(error: ImageError) -> Self {
        Self::Output(error)
    }
}

impl Transfer<'_> {
    /// The linear value of a stored one, both as shares of full scale; a table has none of its own here.
    fn share(&self, stored: f64) -> f64 {
        let size = fabs(stored);
        let light = match self {
            Self::Srgb if size <= 0.04045 => size / 12.92,
            Self::Srgb => pow((size + 0.055) / 1.055, 2.4),
            Self::Gamma(exponent) => pow(size, *exponent),
            Self::Table(_) => size,
        };
        light.copysign(stored)
    }

    fn check(&self, sample: Sample) -> Result<(), TransferError> {
        let entries = match sample {
            Sample::U8 => 1 << u8::BITS,
            Sample::U16 => 1 << u16::BITS,
            Sample::F32 => 0,
        };
        match self {
            Self::Gamma(exponent) if !EXPONENTS.contains(exponent) => Err(TransferError::Exponent),
            Self::Table(table) if table.is_empty() || table.len() != entries => Err(TransferError::Length),
            Self::Table(table) if !table.iter().all(|entry| entry.is_finite()) => Err(TransferError::Entry),
            _ => Ok(()),
        }
    }
}

/// Writes the linear value of every number from 0 on: a table of 256 or of 65,536 entries for [`Transfer::Table`].
///
/// # Errors
/// [`TransferError::Length`] for a table of another length, or that is to be made of a table; [`TransferError::Exponent`].
pub fn table(transfer: &Transfer, table: &mut [f32]) -> Result<(), TransferError> {
    let sample = match table.len() {
        256 => Sample::U8,
        65_536 => Sample::U16,
        _ => return Err(TransferError::Length),
    };
    transfer.check(sample)?;
    if matches!(transfer, Transfer::Table(_)) {
        return Err(TransferError::Length);
    }
    fill(transfer, f64::from(sample.saturation()), table);
    Ok(())
}

fn fill(transfer: &Transfer, full: f64, table: &mut [f32]) {
    for (i, entry) in table.iter_mut().enumerate() {
        *entry = (full * transfer.share(i as f64 / full)) as f32;
    }
}

/// Writes the linear picture as r, g, b, in the picture's own scale: a saturated sample stays at the saturation level. Samples that
/// are not finite, and those whose linear value no float holds, become NaN. The mask is not looked at.
///
/// # Shape
/// `pixels` is height rows of width times three `f32`, rows `row_stride` `f32` apart; what lies between rows is left alone.
///
/// # Errors
/// See [`TransferError`]; `pixels` is untouched then.
pub fn linearize(
    image: &Image,
    transfer: &Transfer,
    pixels: &mut [f32],
    row_stride: usize,
) -> Result<(), TransferError> {
    let sample = image.sample();
    transfer.check(sample)?;
    let mut own = [0.0; 256];
    let looked_up = match (transfer, sample) {
        (Transfer::Table(table), _) => Some(*table),
        (_, Sample::U8) => {
            fill(transfer, f64::from(Sample::U8.saturation()), &mut own);
            Some(&own[..])
        }
        _ => None,
    };
    let full = if sample == Sample::U16 { f64::from(sample.saturation()) } else { 1.0 };
    rows::write(image, pixels, row_stride, |window, out| {
        for (i, slot) in out.iter_mut().enumerate() {
            *slot = window.pixel(i).map(|stored| {
                let linear = match looked_up {
                    Some(table) => entry(table, stored),
                    None => (full * transfer.share(f64::from(stored) / full)) as f32,
                };
                if linear.is_finite() { linear } else { f32::NAN }
            });
        }
    })?;
    Ok(())
}

#[expect(clippy::cast_sign_loss, reason = "samples of 8 and 16 bits are whole numbers from 0 on")]
fn entry(table: &[f32], stored: f32) -> f32 {
    table.get(stored as usize).copied().unwrap_or(f32::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Order;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn the_curve_of_srgb_has_its_published_values() {
        // Half of full scale, the end of the straight part, and the ends.
        for (stored, light) in
            [(0.0, 0.0), (0.5, 0.214_041_14), (0.04045, 0.003_130_804_9), (1.0, 1.0), (-0.5, -0.214_041_14)]
        {
            assert!((Transfer::Srgb.share(stored) - light).abs() < 1e-8, "{stored}");
        }
        assert!((Transfer::Gamma(2.2).share(0.5) - 0.217_637_64).abs() < 1e-8);
    }

    #[test]
    fn samples_of_every_type_and_tables_agree() {
        let bytes: Vec<u8> = (0..=255).flat_map(|v| [v, v, v]).collect();
        let words: Vec<u8> = (0..=255_u16).flat_map(|v| [v * 257; 3]).flat_map(u16::to_ne_bytes).collect();
        let floats: Vec<u8> =
            (0..=255_u16).flat_map(|v| [f32::from(v) / 255.0; 3]).flat_map(f32::to_ne_bytes).collect();
        for transfer in [Transfer::Srgb, Transfer::Gamma(2.2)] {
            let view = |bytes, sample: Sample| {
                Image::interleaved(bytes, 256, 1, 768 * sample.bytes(), sample, Order::Rgb).unwrap()
            };
            let mut out = [[0.0; 768]; 3];
            linearize(&view(&bytes, Sample::U8), &transfer, &mut out[0], 768).unwrap();
            linearize(&view(&words, Sample::U16), &transfer, &mut out[1], 768).unwrap();
            linearize(&view(&floats, Sample::F32), &transfer, &mut out[2], 768).unwrap();
            for ((byte, word), share) in out[0].iter().zip(&out[1]).zip(&out[2]) {
                assert!((byte / 255.0 - share).abs() < 1e-6 && (word / 65535.0 - share).abs() < 1e-6);
            }
            assert_eq!((out[0][767], out[1][767], out[2][767]), (255.0, 65535.0, 1.0));
            for (bytes, sample, len, i) in [(&bytes, Sample::U8, 256, 0), (&words, Sample::U16, 65_536, 1)] {
                let mut entries = vec![0.0; len];
                table(&transfer, &mut entries).unwrap();
                let mut through = [0.0; 768];
                linearize(&view(bytes, sample), &Transfer::Table(&entries), &mut through, 768).unwrap();
                assert_eq!(through, out[i]);
            }
        }
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        let bytes = [9; 12];
        let image = Image::interleaved(&bytes, 2, 2, 6, Sample::U8, Order::Rgb).unwrap();
        let mut out = [7.0; 12];
        let mut bad = [1.0; 256];
        bad[9] = f32::NAN;
        for (transfer, error) in [
            (Transfer::Gamma(0.0), TransferError::Exponent),
            (Transfer::Gamma(f64::NAN), TransferError::Exponent),
            (Transfer::Table(&bad[..255]), TransferError::Length),
            (Transfer::Table(&[]), TransferError::Length),
            (Transfer::Table(&bad), TransferError::Entry),
        ] {
            assert_eq!(linearize(&image, &transfer, &mut out, 6), Err(error));
        }
        let short = Err(TransferError::Output(ImageError::TooShort));
        assert_eq!(linearize(&image, &Transfer::Srgb, &mut out[..11], 6), short);
        assert_eq!(out, [7.0; 12]);
        assert_eq!(table(&Transfer::Srgb, &mut out), Err(TransferError::Length));
        assert_eq!(table(&Transfer::Table(&[1.0; 256]), &mut bad), Err(TransferError::Length));
        let floats: Vec<u8> =
            [f32::MAX, f32::NAN, f32::INFINITY].into_iter().flat_map(f32::to_ne_bytes).collect();
        let image = Image::interleaved(&floats, 1, 1, 12, Sample::F32, Order::Rgb).unwrap();
        linearize(&image, &Transfer::Gamma(2.0), &mut out, 3).unwrap();
        assert!(out[..3].iter().all(|value| value.is_nan()));
    }
}
