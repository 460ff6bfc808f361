//! The real photographs with ground truth beside the project, where they are present.

use ofc_core::picture::{Image, Order, Sample};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// A photograph, where its object is, and the normals there.
pub struct Photograph {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// RGB, 8 bits, tight rows.
    pub rgb: Vec<u8>,
    /// 255 on the object.
    pub mask: Vec<u8>,
    /// Width x height normals, zero outside the mask; empty where there is no truth.
    pub normals: Vec<[f32; 3]>,
}

impl Photograph {
    /// The picture restricted to its mask.
    ///
    /// # Panics
    /// Never: the loader has checked the sizes.
    #[must_use]
    pub fn image(&self) -> Image<'_> {
        Image::interleaved(&self.rgb, self.width, self.height, self.width * 3, Sample::U8, Order::Rgb)
            .and_then(|image| image.with_mask(&self.mask, self.width))
            .expect("the loader's sizes agree")
    }
}

/// Where the photographs are: `OFC_DATA`, or `shared/data` beside the project or further up.
#[must_use]
pub fn directory() -> Option<PathBuf> {
    if let Some(given) = std::env::var_os("OFC_DATA") {
        return Some(PathBuf::from(given)).filter(|directory| directory.is_dir());
    }
    let mut places = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().map(|above| above.join("shared/data"));
    places.find(|directory| directory.is_dir())
}

/// The photograph of that name; `None`, with a printed line, where the data are not there.
///
/// # Panics
/// When the data are there but cannot be read.
#[must_use]
pub fn load(name: &str) -> Option<Photograph> {
    let Some(directory) = directory() else {
        println!("skipped: no photographs beside the project (set OFC_DATA to their folder)");
        return None;
    };
    let folder = directory.join(name);
    let (width, height, rgb) = read_png(&folder.join("rgb.png"), 3);
    let (.., mask) = read_png(&folder.join("mask.png"), 1);
    let normals = match std::fs::read(folder.join("normals.npy")) {
        Ok(bytes) => read_npy(&bytes).as_chunks().0.to_vec(),
        Err(_) => Vec::new(),
    };
    Some(Photograph { width, height, rgb, mask, normals })
}

/// The values of a `NumPy` file of format 1.0 that holds little-endian `float32` row by row.
fn read_npy(bytes: &[u8]) -> Vec<f32> {
    let (start, rest) = bytes.split_at(10);
    let (start, length) = start.split_at(8);
    assert_eq!(start, b"\x93NUMPY\x01\x00", "a NumPy file");
    let length = usize::from(u16::from_le_bytes(length.try_into().expect("two bytes")));
    let (header, values) = rest.split_at(length);
    let header = String::from_utf8_lossy(header);
    assert!(header.contains("'descr': '<f4'") && header.contains("'fortran_order': False"), "{header}");
    values.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
}

/// Width, height and samples of an 8-bit PNG of so many channels.
///
/// # Panics
/// When it is not one.
#[must_use]
pub fn read_png(path: &Path, channels: usize) -> (usize, usize, Vec<u8>) {
    let file = File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().expect("a PNG");
    let mut samples = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut samples).expect("PNG pixels");
    samples.truncate(info.buffer_size());
    let (width, height) = (info.width as usize, info.height as usize);
    assert_eq!(samples.len(), width * height * channels, "{}", path.display());
    (width, height, samples)
}
