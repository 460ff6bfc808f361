//! The fence: whatever a call from C hands over becomes a value, a slice or a reference here, or the call is refused.
//!
//! C hands over memory of types for which every bit pattern is a value (integers, floats and structs of them), so a checked
//! address and length is all that a reference needs. A [`Call`] remembers the bytes of everything that it has given out,
//! and gives out nothing that overlaps bytes which are written.

use crate::status::{
    OFC_STATUS_MISALIGNED, OFC_STATUS_NULL_POINTER, OFC_STATUS_OVERLAP, OFC_STATUS_TOO_LARGE,
    OFC_STATUS_WORKSPACE_TOO_SMALL, Refusal, ensure, ofc_status,
};
use crate::twin::FromC;
use core::ffi::{c_char, c_void};
use core::marker::PhantomData;
use core::mem::MaybeUninit;
use core::slice;
use core::sync::atomic::AtomicU32;
use ofc_core::math::arena::{Arena, Need};
use ofc_core::math::parallel::{MOST_PARTS, Parallel};

/// The alignment in bytes that every workspace must have; memory from malloc() has it.
pub const OFC_WORKSPACE_ALIGNMENT: usize = 8;

/// A plain C type: every bit pattern is a value.
///
/// # Safety
/// Implemented for integers, floats, raw pointers and `repr(C)` structs of them only.
pub unsafe trait Plain: Copy + 'static {}

/// Says that types are [`Plain`]: numbers, or `repr(C)` structs of numbers and raw pointers.
macro_rules! plain {
    ($($name:ty),+ $(,)?) => {
        // SAFETY: numbers and raw pointers alone, of which every bit pattern is a value.
        $(unsafe impl $crate::pointers::Plain for $name {})+
    };
}
pub(crate) use plain;

plain!(u8, u16, u32, u64, i32, f32, f64);
// SAFETY: arrays have no gaps between their elements.
unsafe impl<T: Plain, const N: usize> Plain for [T; N] {}

/// The promise of a C caller: what the header says of the pointers of a call is true.
pub struct Contract(());

impl Contract {
    /// # Safety
    /// Every pointer that the call is given is NULL, or memory as large as the header says lies there, which stays as it is
    /// during the call but for what the call writes, and which nobody else writes or, where the call writes it, reads.
    pub const unsafe fn kept() -> Self {
        Self(())
    }

    /// Runs the body of a call, and returns its status.
    pub fn call(self, body: impl for<'a> FnOnce(&mut Call<'a>) -> Result<ofc_status, Refusal>) -> ofc_status {
        match body(&mut Call::new(self)) {
            Ok(status) | Err(Refusal(status)) => status,
        }
    }

    /// Runs the body of a call that returns how many bytes something needs; 0 where it is refused or they are too many.
    pub fn size(self, body: impl for<'a> FnOnce(&mut Call<'a>) -> Result<Need, Refusal>) -> usize {
        body(&mut Call::new(self)).map_or(0, bytes)
    }
}

/// The bytes of so many numbers, 0 where there are none or too many.
pub fn bytes(need: Need) -> usize {
    let bytes = need.bytes();
    if isize::try_from(bytes).is_ok() { bytes } else { 0 }
}

/// A text of C, which ends with a zero.
pub const fn text_of(bytes: &'static [u8]) -> *const c_char {
    bytes.as_ptr().cast()
}

/// What `take` makes of a pointer that may be NULL.
pub fn unless_null<T, R>(
    pointer: *const T,
    take: impl FnOnce() -> Result<R, Refusal>,
) -> Result<Option<R>, Refusal> {
    if pointer.is_null() { Ok(None) } else { take().map(Some) }
}

/// Bytes that a call uses.
#[derive(Clone, Copy)]
struct Extent {
    start: usize,
    bytes: usize,
}

impl Extent {
    const fn overlaps(self, other: Self) -> bool {
        self.start < other.start.saturating_add(other.bytes)
            && other.start < self.start.saturating_add(self.bytes)
    }
}

/// No call uses more buffers: ofc_surface_complete() with a mask and planes.
const MOST_BUFFERS: usize = 13;

/// A call under way: it turns the caller's pointers into what they point to.
pub struct Call<'a> {
    extents: [Extent; MOST_BUFFERS],
    count: usize,
    /// A bit for each extent: whether it is written.
    written: u32,
    buffers: PhantomData<&'a mut [u8]>,
}

impl<'a> Call<'a> {
    const fn new(Contract(()): Contract) -> Self {
        let nothing = Extent { start: 0, bytes: 0 };
        Self { extents: [nothing; MOST_BUFFERS], count: 0, written: 0, buffers: PhantomData }
    }

    /// Remembers bytes that lie apart from those the call has already, as far as one of both is written.
    #[inline(never)]
    fn claim(&mut self, start: usize, bytes: usize, written: bool) -> Result<(), Refusal> {
        ensure(isize::try_from(bytes).is_ok() && start.checked_add(bytes).is_some(), OFC_STATUS_TOO_LARGE)?;
        let extent = Extent { start, bytes };
        let mut others = self.extents.iter().enumerate();
        let apart =
            others.all(|(i, other)| !(written || self.written >> i & 1 == 1) || !extent.overlaps(*other));
        ensure(apart, OFC_STATUS_OVERLAP)?;
        *self.extents.get_mut(self.count).ok_or(OFC_STATUS_TOO_LARGE)? = extent;
        self.written |= u32::from(written) << self.count;
        self.count += 1;
        Ok(())
    }

    /// Claims `count` values.
    fn claim_values<T>(&mut self, pointer: *const T, count: usize, written: bool) -> Result<(), Refusal> {
        let start = address(pointer.addr(), align_of::<T>())?;
        self.claim(start, count.checked_mul(size_of::<T>()).ok_or(OFC_STATUS_TOO_LARGE)?, written)
    }

    /// Claims `need` bytes of a workspace that holds `bytes`.
    fn claim_workspace(&mut self, pointer: *mut c_void, bytes: usize, need: usize) -> Result<(), Refusal> {
        ensure(need > 0, OFC_STATUS_TOO_LARGE)?;
        let start = address(pointer.addr(), OFC_WORKSPACE_ALIGNMENT)?;
        ensure(bytes >= need, OFC_STATUS_WORKSPACE_TOO_SMALL)?;
        self.claim(start, need, true)
    }

    /// A struct, number or array of a fixed length that the call reads: copied, so that nothing written later can change it.
    pub fn input<T: Plain>(&mut self, pointer: *const T) -> Result<T, Refusal> {
        self.claim_values(pointer, 1, false)?;
        // SAFETY: not null, aligned, one value of a plain type; that it can be read is in the contract.
        Ok(unsafe { pointer.read() })
    }

    /// `N` numbers that the call reads, copied.
    pub fn input_array<T: Plain, const N: usize>(&mut self, pointer: *const T) -> Result<[T; N], Refusal> {
        self.input(pointer.cast())
    }

    /// Parameters as the core has them.
    pub fn params<C: Plain, T: FromC<C>>(&mut self, pointer: *const C) -> Result<T, Refusal> {
        T::from_c(self.input(pointer)?)
    }

    /// Values that the call reads.
    pub fn input_slice<T: Plain>(&mut self, pointer: *const T, count: usize) -> Result<&'a [T], Refusal> {
        self.claim_values(pointer, count, false)?;
        // SAFETY: not null, aligned, `count` plain values that nothing in the call writes, nor anybody else by the contract.
        Ok(unsafe { slice::from_raw_parts(pointer, count) })
    }

    /// Bytes that the call reads, aligned as a `T` is.
    pub fn input_bytes<T>(&mut self, pointer: *const T, bytes: usize) -> Result<&'a [u8], Refusal> {
        address(pointer.addr(), align_of::<T>())?;
        self.input_slice(pointer.cast(), bytes)
    }

    /// A struct, number or array of a fixed length that the call writes at its very end, on success.
    pub fn output<T: Plain>(&mut self, pointer: *mut T) -> Result<&'a mut T, Refusal> {
        self.claim_values(pointer, 1, true)?;
        // SAFETY: not null, aligned, one plain value that nothing else in the call uses, nor anybody else by the contract.
        Ok(unsafe { &mut *pointer })
    }

    /// `N` numbers that the call writes.
    pub fn output_array<T: Plain, const N: usize>(
        &mut self,
        pointer: *mut T,
    ) -> Result<&'a mut [T; N], Refusal> {
        self.output(pointer.cast())
    }

    /// Values that the call writes.
    pub fn output_slice<T: Plain>(&mut self, pointer: *mut T, count: usize) -> Result<&'a mut [T], Refusal> {
        self.claim_values(pointer, count, true)?;
        // SAFETY: as for `output`, `count` values.
        Ok(unsafe { slice::from_raw_parts_mut(pointer, count) })
    }

    /// Bytes that the call writes.
    pub fn output_bytes(&mut self, pointer: *mut c_void, bytes: usize) -> Result<&'a mut [u8], Refusal> {
        self.output_slice(pointer.cast(), bytes)
    }

    /// The first `count` floats of a workspace of so many bytes.
    pub fn floats(
        &mut self,
        pointer: *mut c_void,
        bytes: usize,
        count: usize,
    ) -> Result<&'a mut [f32], Refusal> {
        self.arena(pointer, bytes, Need::of_singles(count))?
            .singles(count)
            .ok_or(Refusal(OFC_STATUS_TOO_LARGE))
    }

    /// A workspace of so many bytes as typed slices, in the order of [`Need::bytes`].
    pub fn arena(&mut self, pointer: *mut c_void, bytes: usize, need: Need) -> Result<Arena<'a>, Refusal> {
        self.claim_workspace(pointer, bytes, self::bytes(need))?;
        // SAFETY: aligned; so many bytes are there, and nothing else uses them.
        Ok(unsafe { cut(pointer.cast(), need) })
    }

    /// Memory of so many bytes, for an object that begins with an `H`: where to write that, and the object's address.
    pub fn memory<H, O>(
        &mut self,
        pointer: *mut c_void,
        bytes: usize,
        need: usize,
    ) -> Result<(&'a mut MaybeUninit<H>, *mut O), Refusal> {
        const { assert!(align_of::<H>() <= OFC_WORKSPACE_ALIGNMENT) };
        ensure(need == 0 || need >= size_of::<H>(), OFC_STATUS_TOO_LARGE)?;
        self.claim_workspace(pointer, bytes, need)?;
        // SAFETY: aligned, and as long as an `H`, of which no byte need be a value yet.
        Ok((unsafe { &mut *pointer.cast() }, pointer.cast()))
    }

    /// An object's `H`, the numbers that this `H` needs, and some bytes.
    ///
    /// The object begins with a `T`, of which `sizes` makes how many bytes of numbers lie behind the first `head` bytes, and how
    /// many more bytes behind those.
    ///
    /// # Safety
    /// `sizes` refuses a `T` unless [`Call::memory`] has been asked for that much memory and an `H` has been written there.
    pub unsafe fn object<H, T: Plain>(
        &mut self,
        object: *mut impl Sized,
        head: usize,
        sizes: impl FnOnce(T) -> Result<(usize, usize), Refusal>,
        need: impl FnOnce(&H) -> Need,
    ) -> Result<(&'a mut H, Arena<'a>, &'a mut [u8]), Refusal> {
        const { assert!(align_of::<T>() <= OFC_WORKSPACE_ALIGNMENT) };
        let start = address(object.addr(), OFC_WORKSPACE_ALIGNMENT)?;
        // SAFETY: aligned; that it can be read is in the contract.
        let (numbers, bytes) = sizes(unsafe { object.cast::<T>().read() })?;
        self.claim(start, numbers.saturating_add(bytes).saturating_add(head), true)?;
        // SAFETY: the caller's promise; the three lie apart, and nothing else in the call uses them.
        unsafe {
            let (first, object) = (object.byte_add(head), &mut *object.cast::<H>());
            let need = need(object);
            ensure(need.bytes() <= numbers, OFC_STATUS_WORKSPACE_TOO_SMALL)?;
            let bytes = slice::from_raw_parts_mut(first.byte_add(numbers).cast(), bytes);
            Ok((object, cut(first.cast(), need), bytes))
        }
    }
}

/// Numbers of each type, one type behind the other.
///
/// # Safety
/// So many bytes are there, and nobody else uses them.
unsafe fn cut<'a>(first: *mut f64, Need { doubles, singles, integers }: Need) -> Arena<'a> {
    // SAFETY: the caller's promise; what follows the doubles has half of their alignment.
    unsafe {
        let second = first.add(doubles).cast::<f32>();
        Arena::new(
            slice::from_raw_parts_mut(first, doubles),
            slice::from_raw_parts_mut(second, singles),
            slice::from_raw_parts_mut(second.add(singles).cast(), integers),
        )
    }
}

/// An address that is not null and a multiple of the alignment.
fn address(address: usize, alignment: usize) -> Result<usize, Refusal> {
    ensure(address != 0, OFC_STATUS_NULL_POINTER)?;
    ensure(address.is_multiple_of(alignment), OFC_STATUS_MISALIGNED)?;
    Ok(address)
}

/// One part of the work of a call, for ofc_parallel to run: it is called with the `work` that came with it.
pub type ofc_part = unsafe extern "C" fn(work: *mut c_void, index: i32);

/// How a call may run parts of its work at the same time, on threads of the caller. How work is cut depends on its size alone, so the
/// bits of the results do not depend on how many parts run at once, nor on their order.
///
/// With OpenMP, and much the same with cv::parallel_for_(), dispatch_apply() or a pool of threads:
///
///     static void run(void *context, ofc_part part, void *work, int32_t count)
///     {
///         #pragma omp parallel for schedule(dynamic)
///         for (int32_t i = 0; i < count; i++)
///             part(work, i);
///     }
///     const ofc_parallel openmp = {.run = run};
///
/// A call may have work for `run` several times. On processors without atomic instructions it runs all parts itself.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_parallel {
    /// Calls `part(work, i)` for every i from 0 to count - 1, in any order and on any threads, and returns when all of these have
    /// returned; `count` is at most 32. What is called twice is done once, an index out of range does nothing, and what is left
    /// out the library does when `run` has returned. No exception may leave it.
    pub run:
        Option<unsafe extern "C" fn(context: *mut c_void, part: ofc_part, work: *mut c_void, count: i32)>,
    /// The first argument of `run`. The library does not look at it, and it may be NULL.
    pub context: *mut c_void,
}

// SAFETY: raw pointers, and one to a function, of which the contract says that it is one or NULL.
unsafe impl Plain for ofc_parallel {}

/// What runs the parts of a call: the caller's threads, or nobody else.
#[derive(Clone, Copy)]
pub struct Threads(Option<ofc_parallel>);

impl Threads {
    /// The thread of the call.
    pub const fn one() -> Self {
        Self(None)
    }
}

impl Call<'_> {
    /// The caller's threads, or the one of the call where the pointer is NULL.
    pub fn threads(&mut self, pointer: *const ofc_parallel) -> Result<Threads, Refusal> {
        let parallel = unless_null(pointer, || self.input(pointer))?;
        ensure(parallel.is_none_or(|parallel| parallel.run.is_some()), OFC_STATUS_NULL_POINTER)?;
        Ok(Threads(parallel))
    }
}

/// Items to work on, each of which is given out once.
struct Work<'a, T, F> {
    items: *mut T,
    count: usize,
    part: &'a F,
    /// A bit for each item that has been given out.
    claimed: AtomicU32,
}

impl<T: Send, F: Fn(usize, &mut T) + Sync> Work<'_, T, F> {
    /// Does part `index`, unless it is none or has been given out.
    fn run(&self, index: usize) {
        if index < self.count && is_first(&self.claimed, 1 << index) {
            // SAFETY: one of the `count` items, which nobody else gets: its bit has been set here.
            (self.part)(index, unsafe { &mut *self.items.add(index) });
        }
    }
}

/// Whether a bit had not been set yet, which it is now.
#[cfg(target_has_atomic = "32")]
fn is_first(bits: &AtomicU32, bit: u32) -> bool {
    bits.fetch_or(bit, core::sync::atomic::Ordering::Relaxed) & bit == 0
}

/// Never: nobody else runs parts.
#[cfg(not(target_has_atomic = "32"))]
fn is_first(_: &AtomicU32, _: u32) -> bool {
    false
}

/// What the caller's function is given as a part.
///
/// # Safety
/// `work` is a [`Work`] of these types, as long as `run` of [`ofc_parallel`] has not returned.
unsafe extern "C" fn part_of_work<T: Send, F: Fn(usize, &mut T) + Sync>(work: *mut c_void, index: i32) {
    // SAFETY: the caller's promise. `T` may be sent and `F` shared, so this may be another thread.
    let work = unsafe { &*work.cast::<Work<T, F>>() };
    if let Ok(index) = usize::try_from(index) {
        work.run(index);
    }
}

/// The one place where a function of the caller is called.
///
/// # Safety
/// `work` is what `part` takes, and stays so until this returns.
#[inline(never)]
unsafe fn call_the_callers_function(
    parallel: &ofc_parallel,
    part: ofc_part,
    work: *mut c_void,
    count: usize,
) {
    if let (Some(run), Ok(count)) = (parallel.run, i32::try_from(count)) {
        // SAFETY: by the contract a function of this type, which calls `part` with `work` and only before it returns.
        unsafe { run(parallel.context, part, work, count) }
    }
}

impl Parallel for Threads {
    fn for_each<T: Send, F: Fn(usize, &mut T) + Sync>(&self, items: &mut [T], part: F) {
        let mut done = 0;
        if let Some(parallel) = &self.0
            && cfg!(target_has_atomic = "32")
            && (2..=MOST_PARTS).contains(&items.len())
        {
            let claimed = AtomicU32::new(0);
            let mut work = Work { items: items.as_mut_ptr(), count: items.len(), part: &part, claimed };
            let pointer = (&raw mut work).cast();
            // SAFETY: a `Work` of these types, which lives on when the caller's function has returned.
            unsafe { call_the_callers_function(parallel, part_of_work::<T, F>, pointer, work.count) };
            done = work.claimed.into_inner();
        }
        for (i, item) in items.iter_mut().enumerate() {
            // With more items than bits none is done.
            if u32::try_from(i).ok().and_then(|i| done.checked_shr(i)).unwrap_or(0) & 1 == 0 {
                part(i, item);
            }
        }
    }
}
