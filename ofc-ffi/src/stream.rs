//! Rows of a camera instead of a picture: one memory of a published size, in the caller's hands.

use crate::image::{checked_pixel_count, dimension, ofc_image, ofc_pixel_format, sample_type};
use crate::pointers::{Call, Contract, Plain, plain, unless_null};
use crate::solve::{ofc_solution, ofc_solve_params};
use crate::status::{
    OFC_STATUS_COLD_START_NEEDED, OFC_STATUS_NO_STREAM, OFC_STATUS_NOT_SOLVED, OFC_STATUS_OK,
    OFC_STATUS_TOO_LARGE, Refusal, ensure, ofc_status,
};
use crate::twin::{ToC, constants, from_c, to_c};
use core::ffi::c_void;
use ofc_core::math::arena::Need;
use ofc_core::picture::Image;
use ofc_core::solve::OrientationMethod;
use ofc_core::stream::{self, Change, Drift, Memory, Params, Pass, State, Stream, StreamError};

/// What the rows of a stream's frame are for: one of OFC_PASS_*.
pub type ofc_stream_pass = i32;
/// A cold start: a sample of the colors, and the model. A model of before serves until this pass ends.
pub const OFC_PASS_COLORS: i32 = 1;
/// A cold start: the tilts; with one candidate for the slants also F.
pub const OFC_PASS_TILTS: i32 = 2;
/// A cold start: the choice among the candidates for the slants, and F.
pub const OFC_PASS_SLANTS: i32 = 3;
/// F is there, and the frame refines it.
pub const OFC_PASS_REFINE: i32 = 4;
/// A cold start with OFC_ORIENTATION_JOINT: how normals point outward; where the sample has room for all pixels also F.
pub const OFC_PASS_OUTWARD: i32 = 5;
/// A cold start with OFC_ORIENTATION_JOINT: integrability, and F.
pub const OFC_PASS_INTEGRABILITY: i32 = 6;

/// What a stream does. Set by ofc_stream_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_stream_params {
    /// The parameters of ofc_solve(), but lmeds.sample_size is how many colors the stream has room for, at least 24, by default 2048;
    /// tilt_estimator is OFC_TILT_PENTLAND or OFC_TILT_GIVEN, and slant_fallback OFC_FALLBACK_REFUSE or
    /// OFC_FALLBACK_LEAST_SQUARES. A library built without the feature `full-streams`, for small memories, knows
    /// OFC_ORIENTATION_DIRECT without shadow rejection alone, and this method is then the default.
    pub solve: ofc_solve_params,
    /// Where less than this share of the usable pixels fits the model, a frame does not refine it and
    /// OFC_STATUS_COLD_START_NEEDED is returned: in [0, 1]. Default 0.5, what least median of squares rests on.
    pub min_inlier_ratio: f64,
    /// About how many pixels a frame that refines the model looks at, those that the cold start could not use counting a
    /// third: every n-th row, at least 16, others from frame to frame. 0 looks at all rows. Default 16,384. The tilts
    /// are averaged over about n frames.
    pub refine_pixels: u32,
    /// Must be zero.
    pub reserved: [u32; 3],
}

/// What the last OFC_PASS_REFINE frame said of the model from before it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_stream_drift {
    /// Share of the usable pixels, of those looked at, whose residual the old model accepts.
    pub inlier_ratio: f64,
    /// Angles between the old and the new rows of F; zero where there is no new model.
    pub angle_rad: [f64; 3],
    /// Lengths of the new rows of F over those of the old; zero where there is no new model.
    pub strength_ratio: [f64; 3],
    /// Dispersion of the new residuals over that of the old; zero where there is no new model.
    pub dispersion_ratio: f64,
    /// 1 when there is a new model, 0 when a cold start is needed.
    pub refined: i32,
    /// Zero.
    pub reserved: u32,
}

plain!(ofc_stream_params, ofc_stream_drift, *mut ofc_stream);

constants!(Pass = {
    Colors: OFC_PASS_COLORS,
    Tilts: OFC_PASS_TILTS,
    Slants: OFC_PASS_SLANTS,
    Outward: OFC_PASS_OUTWARD,
    Integrability: OFC_PASS_INTEGRABILITY,
    Refine: OFC_PASS_REFINE,
});
to_c!(Params => ofc_stream_params { solve, refine_pixels; min_inlier_ratio: smallest_share } zero { reserved });
from_c!(Params <= ofc_stream_params { solve, refine_pixels; min_inlier_ratio: smallest_share } zero { reserved } where are_valid);

/// A stream in memory of the caller's: see ofc_stream_init(). It may be copied to another place of the same alignment.
pub struct ofc_stream {
    _opaque: (),
}

/// What such memory begins with.
#[repr(C)]
struct Head {
    words: [u64; 4],
    state: State,
}

/// Bytes of a stream before its buffers, on every target.
const STATE_BYTES: usize = 4096;
const _: () = assert!(size_of::<Head>() <= STATE_BYTES);

/// The first word of a stream.
const MAGIC: u64 = 0x6d61_6572_7473_666f;

/// The words of a stream for so many pixels in a row and rows, and so many sampled colors on its method; the last one checks
/// the others.
fn words(size: u64, sample: u64) -> [u64; 4] {
    const ODD: u64 = 0x9e37_79b9_7f4a_7c15;
    [MAGIC, size, sample, (MAGIC ^ size).wrapping_mul(ODD).rotate_left(32) ^ sample.wrapping_mul(ODD)]
}

/// The sampled colors and the method as one word.
fn sample_word(params: &Params) -> u64 {
    let orientation_method = u64::from(params.solve.orientation_method == OrientationMethod::Joint);
    orientation_method << 32 | u64::from(params.solve.lmeds.sample_size)
}

/// How many bytes of numbers and of places lie behind the state, and how many all of it takes; 0 when that is too much.
fn sizes(width: usize, height: usize, sample: u64) -> (usize, usize, usize) {
    let sample_size = sample as u32;
    let orientation_method =
        if sample >> 32 == 0 { OrientationMethod::Direct } else { OrientationMethod::Joint };
    let numbers = stream::shared_bytes(width, height, sample_size, orientation_method);
    let places = stream::places_len(width, height, sample_size);
    let bytes = numbers.checked_add(places + STATE_BYTES + 7);
    (numbers, places, bytes.map_or(0, |bytes| bytes / 8 * 8))
}

impl<'a> Call<'a> {
    /// The stream at this address.
    fn stream(&mut self, stream: *mut ofc_stream) -> Result<Stream<'a>, Refusal> {
        let sizes = |[magic, size, sample, check]: [u64; 4]| {
            ensure([magic, size, sample, check] == words(size, sample), OFC_STATUS_NO_STREAM)?;
            let (numbers, places, _) = sizes((size >> 32) as usize, size as u32 as usize, sample);
            Ok((numbers, places))
        };
        let need = |head: &Head| head.state.need();
        // SAFETY: words that check say that ofc_stream_init() was here, which has seen that there is so much memory.
        let (head, mut numbers, places) = unsafe { self.object(stream, STATE_BYTES, sizes, need) }?;
        let Need { doubles, singles, .. } = need(head);
        let boxes = numbers.doubles(doubles).unwrap_or_default();
        let values = numbers.singles(singles).unwrap_or_default();
        Ok(Stream::new(&mut head.state, Memory { boxes, values, places })?)
    }
}

/// Sets every field to its default.
///
/// @param params  Output.
/// @return OFC_STATUS_OK, OFC_STATUS_NULL_POINTER, OFC_STATUS_MISALIGNED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_params_default(params: *mut ofc_stream_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Bytes of memory that a stream needs: 4096, 21 for each color of the sample, and the difference where what rows take is more
/// than 20 for each color. Rows take 3456 and 12 for each pixel of a row, or with OFC_ORIENTATION_JOINT 36 for each pixel of a
/// row and 116 for each of 192 cells where that is more. OFC_STREAM_SIZE(width, height) is no less for the default parameters, for
/// static buffers: 47,104 bytes at 320 x 240.
///
/// @return The size, or 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_size(width: i32, height: i32, params: *const ofc_stream_params) -> usize {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.size(|call| {
        let params: Params = call.params(params)?;
        checked_pixel_count(width, height)?;
        let (_, _, bytes) = sizes(dimension(width), dimension(height), sample_word(&params));
        Ok(Need { doubles: bytes / size_of::<f64>(), singles: 0, integers: 0 })
    })
}

/// Makes a stream for frames that come row by row. A frame is begun, given its rows from the top down, and ended; which
/// pass it is for follows from the ones before it:
///
///     ofc_stream_begin(stream, &pass);
///     for (int32_t y = 0; y < height; y++) {
///         row.pixels = next_row();
///         ofc_stream_row(stream, y, &row);
///         if (pass == OFC_PASS_REFINE)
///             ofc_stream_normals_row(stream, &row, normals);
///     }
///     ofc_status status = ofc_stream_end(stream, &pass);
///
/// A cold start takes the pass over colors and those of its method, all of one frame or of consecutive frames of a scene at
/// rest: with OFC_ORIENTATION_JOINT outward normals and integrability, with OFC_ORIENTATION_DIRECT tilts, and where eqs. 25 have several roots
/// slants. Then there is F; a few rows of every
/// further frame refine it, and for the others ofc_stream_row() does next to nothing. Medians and fits of
/// a cold start are those of a stratified sample of the colors, and integrability is that of as many windows as there is
/// room for. Where the sample has room for all pixels, the solution is that of ofc_solve() to the bit, but for the
/// integral of a lone candidate, which is not computed (infinite); with OFC_ORIENTATION_DIRECT it is enough that it holds all usable
/// ones. Without the feature `full-streams` fit.covariance is zero.
///
/// Frames that refine follow C and the strength of the lights. With OFC_ORIENTATION_DIRECT they also follow the tilts; on
/// OFC_ORIENTATION_JOINT lights that turn about the scene as a whole are not seen, and need ofc_stream_restart().
///
/// Stack, for this call and every other that takes a stream: below 4 KiB with OFC_ORIENTATION_DIRECT, 20 KiB with OFC_ORIENTATION_JOINT.
///
/// @param width, height  Of the frames.
/// @param format     How samples are stored; their order and planes are each row's own.
/// @param params     See the struct.
/// @param memory     ofc_stream_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT; contents do not matter. It is the stream's
///                   until the caller is done with it: there is nothing to free.
/// @param memory_bytes  Its size.
/// @param stream     Output: the stream, at the address of its memory.
/// @return OFC_STATUS_OK; OFC_STATUS_WORKSPACE_TOO_SMALL; the status of an invalid argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_init(
    width: i32,
    height: i32,
    format: ofc_pixel_format,
    params: *const ofc_stream_params,
    memory: *mut c_void,
    memory_bytes: usize,
    stream: *mut *mut ofc_stream,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let params: Params = call.params(params)?;
        let sample = sample_type(format)?;
        checked_pixel_count(width, height)?;
        let (width, height, word) = (dimension(width), dimension(height), sample_word(&params));
        let (_, _, need) = sizes(width, height, word);
        let (head, object) = call.memory(memory, memory_bytes, need)?;
        let stream = call.output(stream)?;
        State::check_size(width, height, &params)?;
        let words = words((width as u64) << 32 | height as u64, word);
        head.write(Head { words, state: State::unchecked(width, height, sample, params) });
        *stream = object;
        Ok(OFC_STATUS_OK)
    })
}

/// Forgets the model and any frame under way: the next frame is for colors.
///
/// @param stream  The stream.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_STREAM; the status of an invalid argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_restart(stream: *mut ofc_stream) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        call.stream(stream)?.restart();
        Ok(OFC_STATUS_OK)
    })
}

/// Begins a frame. One that was not ended is forgotten.
///
/// @param stream  The stream.
/// @param pass    Output: what the frame is for, one of OFC_PASS_*; may be NULL.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_STREAM; the status of an invalid argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_begin(stream: *mut ofc_stream, pass: *mut ofc_stream_pass) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let mut stream = call.stream(stream)?;
        let out = unless_null(pass, || call.output(pass))?;
        let pass = stream.begin()?;
        if let Some(out) = out {
            *out = pass.to_c();
        }
        Ok(OFC_STATUS_OK)
    })
}

/// Takes the next row of the frame.
///
/// @param stream  The stream.
/// @param y       The row, 0 at the top.
/// @param row     A picture of height 1; its mask, black and saturated pixels are left out.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_STREAM, OFC_STATUS_NO_FRAME, OFC_STATUS_ROW_ORDER, OFC_STATUS_TOO_MANY_ROWS,
///         OFC_STATUS_ROW_MISMATCH; the status of an invalid argument. Unless it is OFC_STATUS_OK the call changed nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_row(
    stream: *mut ofc_stream,
    y: i32,
    row: *const ofc_image,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let mut stream = call.stream(stream)?;
        let row = call.image(row)?;
        stream.row(usize::try_from(y).unwrap_or(usize::MAX), &row)?;
        Ok(OFC_STATUS_OK)
    })
}

/// Ends the frame.
///
/// @param stream  The stream.
/// @param pass    Output: what the next frame is for, one of OFC_PASS_*; may be NULL.
/// @return OFC_STATUS_OK: the next pass follows from this one. OFC_STATUS_COLD_START_NEEDED: the frame does not fit the
///         model, as ofc_stream_drift_get() says; the next pass is over colors. A cold start that comes to no F ends with
///         OFC_STATUS_RANK_DEFICIENT, OFC_STATUS_NOT_POSITIVE_DEFINITE, OFC_STATUS_NO_TILT or
///         OFC_STATUS_NO_CONSISTENT_SLANTS, or without any result with OFC_STATUS_TOO_FEW_PIXELS, OFC_STATUS_DARK or
///         OFC_STATUS_SATURATED; the next pass is over colors. OFC_STATUS_NO_STREAM, OFC_STATUS_NO_FRAME,
///         OFC_STATUS_TOO_FEW_ROWS; the status of an invalid argument.
///
/// Reference: section 3.4.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_end(stream: *mut ofc_stream, pass: *mut ofc_stream_pass) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let mut stream = call.stream(stream)?;
        let out = unless_null(pass, || call.output(pass))?;
        let next = stream.end()?;
        if let Some(out) = out {
            *out = next.to_c();
        }
        let state = stream.state();
        Ok(match (next, state.drift()) {
            (Pass::Colors, Some(_)) => OFC_STATUS_COLD_START_NEEDED,
            (Pass::Colors, None) => state.solution().outcome.to_c(),
            _ => OFC_STATUS_OK,
        })
    })
}

/// What the last cold start found, and the frames that refined it since.
///
/// @param stream    The stream.
/// @param solution  Output. After frames that refined it: F, its stages and the fit are the last frame's, rank is that of
///                  the cold start, candidates have no integral (infinite), tilts come from the axes alone, covariances
///                  are those of the cold start, and counts and pixel counts are of the pixels that were looked at.
/// @return As ofc_solve(), for the cold start; OFC_STATUS_NOT_SOLVED, `solution` untouched, before its last pass;
///         OFC_STATUS_NO_STREAM; the status of an invalid argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_solution(
    stream: *mut ofc_stream,
    solution: *mut ofc_solution,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let stream = call.stream(stream)?;
        let solution = call.output(solution)?;
        let state = stream.state();
        ensure(state.is_concluded(), OFC_STATUS_NOT_SOLVED)?;
        solution.set(state.solution());
        Ok(solution.outcome)
    })
}

/// What the last frame of OFC_PASS_REFINE says of the model from before it.
///
/// @param stream  The stream.
/// @param drift   Output.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED when there was no such frame since the cold start; OFC_STATUS_NO_STREAM; the
///         status of an invalid argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_drift_get(
    stream: *mut ofc_stream,
    drift: *mut ofc_stream_drift,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let stream = call.stream(stream)?;
        let out = call.output(drift)?;
        let Drift { inlier_share, change } = *stream.state().drift().ok_or(OFC_STATUS_NOT_SOLVED)?;
        let nothing = Change { angles: [0.0; 3], strengths: [0.0; 3], dispersion: 0.0 };
        let Change { angles, strengths, dispersion } = change.unwrap_or(nothing);
        *out = ofc_stream_drift {
            inlier_ratio: inlier_share,
            angle_rad: angles,
            strength_ratio: strengths,
            dispersion_ratio: dispersion,
            refined: change.is_some().to_c(),
            reserved: 0,
        };
        Ok(OFC_STATUS_OK)
    })
}

/// Unit normals of a row's inliers, under the model there is: any row of any frame.
///
/// @param stream   The stream.
/// @param row      A picture of height 1.
/// @param normals  Output: width times (x, y, z) floats, zero where there is no normal. Frame: x right, y up, z toward the
///                 camera.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_ROW_MISMATCH; OFC_STATUS_NO_STREAM; the status of an invalid
///         argument.
///
/// Reference: eq. 8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_normals_row(
    stream: *mut ofc_stream,
    row: *const ofc_image,
    normals: *mut f32,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| write_row(call, stream, row, normals, 3, State::normals))
}

/// Writes what ofc_stream_normals_row() writes, in 8 bits a component.
///
/// @param stream   The stream.
/// @param row      A picture of height 1.
/// @param normals  Output: width times (x, y, z) bytes, (n + 1) / 2 of 255, rounded; zeros, which is no normal's, where there
///                 is none.
/// @return As ofc_stream_normals_row().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_normals_row_packed(
    stream: *mut ofc_stream,
    row: *const ofc_image,
    normals: *mut u8,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| write_row(call, stream, row, normals, 3, State::packed_normals))
}

/// Which pixels of a row are inliers, under the model there is.
///
/// @param stream  The stream.
/// @param row     A picture of height 1.
/// @param flags   Output: width bytes, 255 for an inlier and 0 elsewhere.
/// @return As ofc_stream_normals_row().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_inliers_row(
    stream: *mut ofc_stream,
    row: *const ofc_image,
    flags: *mut u8,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| write_row(call, stream, row, flags, 1, State::inliers))
}

/// Writes so many values for each pixel of a row.
fn write_row<T: Plain>(
    call: &mut Call,
    stream: *mut ofc_stream,
    row: *const ofc_image,
    out: *mut T,
    count: usize,
    write: impl FnOnce(&State, &Image, &mut [T]) -> Result<(), StreamError>,
) -> Result<ofc_status, Refusal> {
    let stream = call.stream(stream)?;
    let row = call.image(row)?;
    let out = call.output_slice(out, row.width().checked_mul(count).ok_or(OFC_STATUS_TOO_LARGE)?)?;
    write(stream.state(), &row, out)?;
    Ok(OFC_STATUS_OK)
}
