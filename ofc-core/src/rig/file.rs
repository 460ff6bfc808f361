//! A model as bytes, the same on every target: a magic number, a mark of the byte order, the version, the size, the numbers and a checksum.
//!
//! Numbers are little-endian; the mark tells bytes that something swapped from those of another kind of file. The checksum is
//! FNV-1a of all bytes before it.

use super::model::{Advice, Model};
use super::terms::{Order, TERMS};
use crate::orientation::relief::{Polynomial, ScaleSource};
use core::fmt;

/// The bytes of a model.
pub const FILE_BYTES: usize = HEADER + 8 * DOUBLES + 4 * WORDS + CHECKSUM;

const HEADER: usize = 8 + 4 + 4 + 8;
const DOUBLES: usize = 2 * TERMS + 45 + 3 + 7;
const WORDS: usize = 8;
const CHECKSUM: usize = 8;

const MAGIC: [u8; 8] = *b"ofc-rig\n";
const BYTE_ORDER: u32 = 0x0102_0304;
const VERSION: u32 = 1;

/// Why bytes are no model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileError {
    /// They do not begin as a model does, or their byte order was changed.
    Kind,
    /// They are of a version that is not known here.
    Version,
    /// They are fewer or more than a model has.
    Size,
    /// They are not those that were saved.
    Damaged,
    /// They were saved so, but no model has such numbers.
    Numbers,
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Kind => "not the model of a rig, or with another byte order",
            Self::Version => "a model of a version that is not known",
            Self::Size => "a model has another size",
            Self::Damaged => "the checksum is wrong",
            Self::Numbers => "no model has such numbers",
        })
    }
}

impl core::error::Error for FileError {}

/// Writes a model into these bytes.
pub fn save(model: &Model, bytes: &mut [u8; FILE_BYTES]) {
    let scalars = [
        model.saturation.map_or(0.0, f64::from),
        model.circulation,
        model.circulation_ratio,
        model.outward,
        model.scale_deviation,
        model.disagreement,
        model.tilt,
    ];
    let numbers = model.w.iter().flatten().chain(model.plane.coefficients.iter().flatten());
    let numbers = numbers.chain(&model.noise).chain(&scalars);
    let words = [
        model.width as u32,
        model.height as u32,
        model.order.len() as u32,
        model.scale_source as u32,
        model.advice as u32,
        model.region as u32,
        model.frames,
        model.balls,
    ];
    let header = MAGIC.into_iter().chain(BYTE_ORDER.to_le_bytes()).chain(VERSION.to_le_bytes());
    let header = header.chain((FILE_BYTES as u64).to_le_bytes());
    let body = numbers.flat_map(|number| number.to_le_bytes());
    let all = header.chain(body).chain(words.into_iter().flat_map(u32::to_le_bytes));
    bytes.iter_mut().zip(all).for_each(|(slot, byte)| *slot = byte);
    let Some((content, slot)) = bytes.split_last_chunk_mut::<CHECKSUM>() else { return };
    *slot = checksum(content).to_le_bytes();
}

/// The model that these bytes hold.
///
/// # Errors
/// See [`FileError`].
pub fn load(bytes: &[u8]) -> Result<Model, FileError> {
    let mut reader = Reader { bytes };
    if reader.take::<8>() != Some(MAGIC) || reader.word() != Some(BYTE_ORDER) {
        return Err(FileError::Kind);
    }
    if reader.word() != Some(VERSION) {
        return Err(FileError::Version);
    }
    if reader.take::<8>() != Some((FILE_BYTES as u64).to_le_bytes()) || bytes.len() != FILE_BYTES {
        return Err(FileError::Size);
    }
    let (content, found) = bytes.split_last_chunk::<CHECKSUM>().ok_or(FileError::Size)?;
    if checksum(content).to_le_bytes() != *found {
        return Err(FileError::Damaged);
    }
    let model = reader.model().ok_or(FileError::Numbers)?;
    if model.is_valid() { Ok(model) } else { Err(FileError::Numbers) }
}

/// FNV-1a.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.bytes.split_first_chunk::<N>()?;
        self.bytes = rest;
        Some(*first)
    }

    fn word(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn double(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn model(&mut self) -> Option<Model> {
        let mut w = [[0.0; TERMS]; 2];
        let mut plane = Polynomial::default();
        let mut noise = [0.0; 3];
        for number in w.iter_mut().flatten().chain(plane.coefficients.iter_mut().flatten()).chain(&mut noise)
        {
            *number = self.double()?;
        }
        let mut scalars = [0.0; 7];
        for number in &mut scalars {
            *number = self.double()?;
        }
        let [saturation, circulation, circulation_ratio, outward, scale_deviation, disagreement, tilt] =
            scalars;
        let mut words = [0; WORDS];
        for word in &mut words {
            *word = self.word()?;
        }
        let [width, height, terms, scale_source, advice, region, frames, balls] = words;
        let orders = [Order::Constant, Order::Place, Order::Products];
        let sources = [ScaleSource::Unknown, ScaleSource::Colors, ScaleSource::Ball, ScaleSource::Given];
        let advices = [Advice::Nothing, Advice::Contacts, Advice::Scale, Advice::Region];
        Some(Model {
            width: width as usize,
            height: height as usize,
            order: orders.into_iter().find(|order| order.len() as u32 == terms)?,
            w,
            plane,
            noise,
            saturation: (saturation != 0.0).then_some(saturation as f32),
            frames,
            balls,
            circulation,
            circulation_ratio,
            outward,
            scale_source: sources.into_iter().find(|source| *source as u32 == scale_source)?,
            scale_deviation,
            disagreement,
            tilt,
            advice: advices.into_iter().find(|each| *each as u32 == advice)?,
            region: usize::try_from(region).ok().filter(|region| *region < 9)?,
        })
    }
}
