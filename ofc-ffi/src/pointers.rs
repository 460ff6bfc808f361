//! The fence: every raw pointer from C becomes a value, a slice or an [`Out`] here, checked, or an error status.
//!
//! What C hands us is memory of unknown contents but of types for which every bit pattern is a value (integers, floats
//! and structs of them), so a checked address and length is all a reference needs.

use crate::status::{
    OFC_STATUS_MISALIGNED, OFC_STATUS_NULL_POINTER, OFC_STATUS_OVERLAP, OFC_STATUS_TOO_LARGE,
    OFC_STATUS_WORKSPACE_TOO_SMALL, ofc_status,
};
use core::slice;
use ofc_core::math::arena::{Arena, Need};

/// The alignment in bytes that every workspace must have; what malloc returns has it.
pub const OFC_WORKSPACE_ALIGNMENT: usize = 8;

/// A plain C type: every bit pattern is a value.
///
/// # Safety
/// Implemented for integers, floats, raw pointers and `repr(C)` structs of them only.
pub unsafe trait Plain: Copy {}
// SAFETY: every bit pattern is a value.
unsafe impl Plain for u8 {}
// SAFETY: as above.
unsafe impl Plain for f32 {}
// SAFETY: as above.
unsafe impl Plain for f64 {}
// SAFETY: as above.
unsafe impl Plain for i32 {}
// SAFETY: as above.
unsafe impl Plain for u32 {}
// SAFETY: as above.
unsafe impl Plain for u64 {}
// SAFETY: as its elements, and arrays have no gaps.
unsafe impl<T: Plain, const N: usize> Plain for [T; N] {}

/// The bytes a call reads or writes, to be compared with the others of the same call.
#[derive(Clone, Copy)]
pub struct Extent {
    start: usize,
    bytes: usize,
}

impl Extent {
    /// No bytes: what an output that the caller does not want occupies.
    pub const NOTHING: Self = Self { start: 0, bytes: 0 };

    /// How many bytes.
    pub const fn bytes(self) -> usize {
        self.bytes
    }

    const fn overlaps(self, other: Self) -> bool {
        self.start < other.start.saturating_add(other.bytes)
            && other.start < self.start.saturating_add(self.bytes)
    }
}

/// The bytes of `count` values at `pointer`, after all checks that need no look at the memory.
pub fn extent<T>(pointer: *const T, count: usize) -> Result<Extent, ofc_status> {
    if pointer.is_null() {
        return Err(OFC_STATUS_NULL_POINTER);
    }
    if !pointer.is_aligned() {
        return Err(OFC_STATUS_MISALIGNED);
    }
    let start = pointer.addr();
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if isize::try_from(bytes).is_ok() && start.checked_add(bytes).is_some() => {
            Ok(Extent { start, bytes })
        }
        _ => Err(OFC_STATUS_TOO_LARGE),
    }
}

/// An error if one of the bytes `written` is also written by another or read.
pub fn disjoint(written: &[Extent], read: &[Extent]) -> Result<(), ofc_status> {
    let overlaps = written
        .iter()
        .enumerate()
        .any(|(i, output)| written.iter().skip(i + 1).chain(read).any(|other| output.overlaps(*other)));
    if overlaps { Err(OFC_STATUS_OVERLAP) } else { Ok(()) }
}

/// A struct or number that the call reads: copied, so that nothing written later can change it.
pub fn input<T: Plain>(pointer: *const T) -> Result<(T, Extent), ofc_status> {
    let extent = extent(pointer, 1)?;
    // SAFETY: not null, aligned, one value of a plain type; that it can be read is the caller's part of the contract.
    Ok((unsafe { pointer.read() }, extent))
}

/// A small array that the call reads, copied.
pub fn input_array<T: Plain, const N: usize>(pointer: *const T) -> Result<([T; N], Extent), ofc_status> {
    let extent = extent(pointer, N)?;
    // SAFETY: as for `input`, N values without gaps.
    Ok((unsafe { pointer.cast::<[T; N]>().read() }, extent))
}

/// Values that the call reads.
///
/// # Safety
/// Nobody writes them during the call; the lifetime is the call's.
pub unsafe fn input_slice<'a, T: Plain>(
    pointer: *const T,
    count: usize,
) -> Result<(&'a [T], Extent), ofc_status> {
    let extent = extent(pointer, count)?;
    // SAFETY: not null, aligned, `count` plain values within the address space.
    Ok((unsafe { slice::from_raw_parts(pointer, count) }, extent))
}

/// Values that the call writes.
///
/// # Safety
/// Nobody else uses them during the call, which has also checked that they are [`disjoint`] from its other buffers.
pub unsafe fn output_slice<'a, T: Plain>(pointer: *mut T, count: usize) -> &'a mut [T] {
    // SAFETY: `extent` has been asked for the same pointer and count.
    unsafe { slice::from_raw_parts_mut(pointer, count) }
}

/// A workspace of at least `need` bytes, seen as floats once its bytes are known to be disjoint from everything else.
pub fn workspace(pointer: *mut f64, bytes: usize, need: usize) -> Result<Extent, ofc_status> {
    if need == 0 {
        return Err(OFC_STATUS_TOO_LARGE);
    }
    let aligned = extent(pointer, 1)?;
    if bytes < need {
        return Err(OFC_STATUS_WORKSPACE_TOO_SMALL);
    }
    Ok(Extent { bytes: need, ..aligned })
}

/// The caller's workspace as typed slices, in the order of [`Need::bytes`].
///
/// # Safety
/// [`workspace`] has been asked for the same pointer and for `need.bytes()`, and its bytes are [`disjoint`] from everything
/// else in the call.
#[expect(dead_code, reason = "stages take it one after the other")]
pub unsafe fn arena<'a>(pointer: *mut f64, need: Need) -> Arena<'a> {
    let Need { doubles, singles, integers } = need;
    // SAFETY: that many bytes are there; doubles come first, and what follows has half of their alignment.
    unsafe {
        let first = pointer.add(doubles).cast::<f32>();
        Arena::new(
            output_slice(pointer, doubles),
            output_slice(first, singles),
            output_slice(first.add(singles).cast::<u32>(), integers),
        )
    }
}

/// A struct or array that the call writes at its very end, on success.
#[derive(Clone, Copy)]
pub struct Out<T> {
    pointer: *mut T,
    /// The bytes it occupies.
    pub extent: Extent,
}

impl<T: Plain> Out<T> {
    /// Checks the address.
    pub fn new(pointer: *mut T) -> Result<Self, ofc_status> {
        Ok(Self { pointer, extent: extent(pointer.cast_const(), 1)? })
    }

    /// Where the value goes, for large ones: made in place, without a copy on the stack. What is there is not a value yet.
    pub fn place<'a>(self) -> &'a mut T {
        // SAFETY: as for `write`; any bytes are a plain value.
        unsafe { &mut *self.pointer }
    }

    /// Writes the value.
    pub fn write(self, value: T) {
        // SAFETY: checked when made; that it can be written is the caller's part of the contract.
        unsafe { self.pointer.write(value) }
    }
}
