//! The buffers of a stream, and how much of them a pass takes.

use super::parameters::FULL;
use crate::light::constrained_slant::WORKSPACE_LEN;
use crate::math::arena::Need;
use crate::orientation::joint::{self, STRIP};
use crate::solve::OrientationMethod;

/// How many `f32` [`Memory::values`] needs for all passes.
#[must_use]
pub const fn values_len(
    width: usize,
    height: usize,
    sample_size: u32,
    orientation_method: OrientationMethod,
) -> usize {
    let sample = room(width, height, sample_size).saturating_mul(5);
    let rows = match orientation_method {
        OrientationMethod::Joint if FULL => rows_len(width).saturating_add(joint::least_room(width, height)),
        _ => row_len(width),
    };
    if sample > rows { sample } else { rows }
}

/// Bytes for [`Memory::boxes`] and [`Memory::values`] of the pass that takes most, for callers who give every frame the same
/// memory, cut as [`State::need`](super::State::need) says. No number lives on from one pass to the next but in passes without boxes.
#[must_use]
pub const fn shared_bytes(
    width: usize,
    height: usize,
    sample_size: u32,
    orientation_method: OrientationMethod,
) -> usize {
    let values = Need::of_singles(values_len(width, height, sample_size, orientation_method)).bytes();
    let boxes = need_of_slants(width).bytes();
    if values > boxes { values } else { boxes }
}

/// What a pass takes that ends with slants: a list of boxes and the row before.
pub(super) const fn need_of_slants(width: usize) -> Need {
    Need { doubles: WORKSPACE_LEN, singles: row_len(width), integers: 0 }
}

/// How many `f32` the row before is.
pub(super) const fn row_len(width: usize) -> usize {
    width.saturating_mul(3)
}

/// How many `f32` the rows above a strip's last one are.
pub(super) const fn rows_len(width: usize) -> usize {
    width.saturating_mul(3 * (STRIP - 1))
}

/// How many bytes [`Memory::places`] needs.
#[must_use]
pub const fn places_len(width: usize, height: usize, sample_size: u32) -> usize {
    room(width, height, sample_size)
}

/// How many colors the sample has room for.
pub(super) const fn room(width: usize, height: usize, sample_size: u32) -> usize {
    let pixels = width.saturating_mul(height);
    if pixels < sample_size as usize { pixels } else { sample_size as usize }
}

/// The caller's buffers, which belong to the stream from one call to the next. What they hold at first does not matter.
#[derive(Debug)]
pub struct Memory<'m> {
    /// [`WORKSPACE_LEN`] numbers in the passes over tilts and those that refine, none in others: boxes of slants.
    pub boxes: &'m mut [f64],
    /// [`values_len`] numbers: the sample and its residuals, then the row before, or cells and the rows before. A caller who
    /// cuts the memory anew for every pass gives as many as [`State::need`](super::State::need) says.
    pub values: &'m mut [f32],
    /// [`places_len`] bytes: where in the frame the sample is from.
    pub places: &'m mut [u8],
}
