//! Depth maps of well-known models beside the project, where they are present.

use crate::depth_maps::Relief;
use crate::photographs::directory;
use flate2::read::ZlibDecoder;
use std::io::Read;

/// The model of that name; `None` where the data are not there.
///
/// # Panics
/// When the data are there but are not what they were.
#[must_use]
pub fn shape(name: &str) -> Option<Relief> {
    let bytes = std::fs::read(directory()?.join(format!("shapes/{name}.tiff"))).ok()?;
    let (width, height, values) = read_tiff(&bytes);
    let mask = values.iter().map(|z| if z.is_finite() { 255 } else { 0 }).collect();
    let depth = values.iter().map(|&z| if z.is_finite() { z } else { 0.0 }).collect();
    Some(Relief { width, height, depth, mask })
}

/// Width, height and values of a little-endian TIFF of one `f32` a pixel, deflated after the floating-point predictor.
///
/// # Reference
/// Adobe Photoshop TIFF Technical Note 3, 2005.
fn read_tiff(bytes: &[u8]) -> (usize, usize, Vec<f32>) {
    let number = |at: usize, len: usize| {
        bytes[at..at + len].iter().rev().fold(0_usize, |number, &byte| number << 8 | usize::from(byte))
    };
    assert_eq!(&bytes[..4], b"II*\0", "a little-endian TIFF");
    let directory = number(4, 4);
    let field = |tag: usize| -> Vec<usize> {
        let entries = (0..number(directory, 2)).map(|i| directory + 2 + 12 * i);
        let entry = entries.into_iter().find(|&entry| number(entry, 2) == tag).expect("the tag");
        let size = if number(entry + 2, 2) == 3 { 2 } else { 4 };
        let count = number(entry + 4, 4);
        let start = if size * count > 4 { number(entry + 8, 4) } else { entry + 8 };
        (0..count).map(|i| number(start + size * i, size)).collect()
    };
    assert_eq!([field(259)[0], field(258)[0], field(317)[0], field(339)[0]], [8, 32, 3, 3]);
    let (width, height) = (field(256)[0], field(257)[0]);
    let mut values = Vec::new();
    for (start, len) in field(273).into_iter().zip(field(279)) {
        let mut strip = Vec::new();
        ZlibDecoder::new(&bytes[start..start + len]).read_to_end(&mut strip).expect("a deflated strip");
        for row in strip.chunks_exact_mut(4 * width) {
            for i in 1..row.len() {
                row[i] = row[i].wrapping_add(row[i - 1]);
            }
            // The most significant bytes of the row come first.
            values.extend((0..width).map(|x| f32::from_be_bytes([0, 1, 2, 3].map(|k| row[k * width + x]))));
        }
    }
    assert_eq!(values.len(), width * height);
    (width, height, values)
}
