//! Rows of a camera instead of a picture: one memory of a published size, in the caller's hands.

use crate::prelude::*;
use ofc_core::picture::Image;
use ofc_core::solve::OrientationMethod;
use ofc_core::stream::{self, Change, Drift, Memory, Params, Pass, State, Stream, StreamError};

/// What the rows of a stream's frame are for: one of OFC_PASS_*.
pub type ofc_stream_pass = i32;
/// A cold start samples the colors and fits the model. The previous model serves until this pass ends.
pub const OFC_PASS_COLORS: i32 = 1;
/// A cold start estimates the tilts; with one candidate for the slants it finds F.
pub const OFC_PASS_TILTS: i32 = 2;
/// A cold start chooses among the candidates for the slants, and finds F.
pub const OFC_PASS_SLANTS: i32 = 3;
/// F has been found, and the frame refines it.
pub const OFC_PASS_REFINE: i32 = 4;
/// A cold start with the joint method looks at how normals point outward; where the sample holds all pixels it finds F.
pub const OFC_PASS_OUTWARD: i32 = 5;
/// A cold start with the joint method looks at integrability, and finds F.
pub const OFC_PASS_INTEGRABILITY: i32 = 6;

/// What a stream does. Set by ofc_stream_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_stream_params {
    /// The parameters of ofc_solve(), with these differences: `lmeds.sample_size` is how many colors the stream stores,
    /// at least 24, by default 2048; `tilt_estimator` is OFC_TILT_PENTLAND or OFC_TILT_GIVEN; `slant_fallback` is
    /// OFC_FALLBACK_REFUSE or OFC_FALLBACK_LEAST_SQUARES; `convexity` is
    /// OFC_CONVEXITY_AUTO: negate x and y of the normals of a hollow. A library without the feature `full-streams`, for small
    /// memories, takes the direct method without shadow rejection alone, which is its default.
    pub solve: ofc_solve_params,
    /// Where a smaller ratio of the usable pixels fits the model, a frame does not refine it and
    /// OFC_STATUS_COLD_START_NEEDED is returned: in [0, 1]. Default 0.5, the breakdown point of least median of
    /// squares.
    pub min_inlier_ratio: f64,
    /// About how many pixels a frame that refines the model uses, where a pixel that the cold start could not use
    /// counts a third: every n-th row, at least 16 rows, and other rows from frame to frame. The tilts are averaged
    /// over about n frames. 0 uses all rows. Default 16,384.
    pub refine_pixels: u32,
    /// Must be zero.
    pub reserved: [u32; 3],
}

/// What the last frame of OFC_PASS_REFINE says about the model from before it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_stream_drift {
    /// The ratio of the usable pixels in the rows that were used whose residual the old model accepts.
    pub inlier_ratio: f64,
    /// Angles between the old and the new rows of F in radians; NaN where there is no new model.
    pub angle_rad: [f64; 3],
    /// Lengths of the new rows of F over those of the old rows; NaN where there is no new model.
    pub strength_ratio: [f64; 3],
    /// Dispersion of the new residuals over that of the old residuals; NaN where there is no new model.
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

/// A stream in memory of the caller, made by ofc_stream_init(). It may be copied to another place of the same
/// alignment.
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
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_params_default(params: *mut ofc_stream_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of memory a stream needs.
///
/// There are 4096 bytes of state and one byte for each color of the sample, and more for what takes most: 20 bytes for
/// each color of the sample; for rows, 3456 bytes and 12 for each pixel of a row; and for rows with the joint method,
/// 36 bytes for each pixel of a row and 116 for each of up to 192 cells. OFC_STREAM_SIZE() is no less for the default
/// parameters and static buffers: 47,104 bytes at 320 x 240.
/// @param width,height  Size of the frames.
/// @param params  The parameters that ofc_stream_init() will be given.
/// @return The size; 0 when an argument is invalid.
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

/// Makes a stream for frames that come row by row.
///
/// A frame is begun, given its rows from the top down, and ended. What it is for, its pass, follows from the frames
/// before it:
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
/// A cold start begins with a pass over colors. With the joint method passes over outward normals and integrability
/// follow; with the direct method a pass over tilts, and one over slants where eqs. 25 have several roots. All of them
/// take the same frame, or consecutive frames of a scene at rest. Then F is known. A few rows of every further frame
/// refine it; for the other rows ofc_stream_row() does next to nothing.
///
/// Medians and fits of a cold start are those of a stratified sample of the colors, and integrability is that of as
/// many windows as the memory holds. Where the sample holds all pixels, or with the direct method all usable pixels, and
/// there are fewer than 131,072 of them, above which ofc_solve() takes some numbers from a sample of the rows,
/// the solution is equal to that of ofc_solve() bit by bit, but for the integral of a lone candidate, which is not
/// computed (infinite), and but for `reason` and what follows from it: streams do not look for reasons. Without the
/// feature `full-streams` fit.covariance is NaN: not known.
///
/// Frames that refine F follow C and the strength of the lights, and with the direct method also the tilts. With the
/// joint method a turn of all lights about the scene goes unnoticed; ofc_stream_restart() is needed after it.
/// @param width,height  Size of the frames.
/// @param format  How samples are stored; each row has its own order and planes.
/// @param params  The parameters.
/// @param memory  ofc_stream_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT. They belong to the stream until the
///     caller is done with it; nothing has to be freed.
/// @param memory_bytes  How long the memory is.
/// @param stream  Output: the stream, at the address of its memory.
/// @return OFC_STATUS_OK; an argument status.
///
/// Stack, for this call and every other one that takes a stream: below 4 KiB with the direct method, 20 KiB with the
/// joint method.
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

/// Forgets the model and any frame that was begun. The next frame is for colors.
/// @param stream  The stream.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_STREAM; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_restart(stream: *mut ofc_stream) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        call.stream(stream)?.restart();
        Ok(OFC_STATUS_OK)
    })
}

/// Begins a frame. A frame that was not ended is forgotten.
/// @param stream  The stream.
/// @param pass  Output: what the frame is for, one of OFC_PASS_*; may be NULL.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_STREAM; an argument status.
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

/// Takes the next row of the frame. The call changes nothing unless it returns OFC_STATUS_OK.
/// @param stream  The stream.
/// @param y  The row, 0 at the top.
/// @param row  A picture of height 1. Pixels that are masked out, black, saturated or not finite are left out.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_STREAM, OFC_STATUS_NO_FRAME, OFC_STATUS_ROW_ORDER, OFC_STATUS_TOO_MANY_ROWS,
///     OFC_STATUS_ROW_MISMATCH; an argument status.
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
/// @param stream  The stream.
/// @param pass  Output: what the next frame is for, one of OFC_PASS_*; may be NULL.
/// @return OFC_STATUS_OK when the next pass follows from this one. OFC_STATUS_COLD_START_NEEDED when the frame does not
///     fit the model, as ofc_stream_drift_get() says. OFC_STATUS_RANK_DEFICIENT, OFC_STATUS_UNDETERMINED,
///     OFC_STATUS_NOT_POSITIVE_DEFINITE, OFC_STATUS_NO_TILT, OFC_STATUS_NO_CONSISTENT_SLANTS, OFC_STATUS_TOO_FEW_PIXELS, OFC_STATUS_DARK or
///     OFC_STATUS_SATURATED when a cold start found no F. After each of these but OFC_STATUS_OK the next pass is over
///     colors. OFC_STATUS_NO_STREAM, OFC_STATUS_NO_FRAME, OFC_STATUS_TOO_FEW_ROWS; an argument status.
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

/// Gives what the last cold start found, as refined by the frames since.
/// @param stream  The stream.
/// @param solution  Output: the solution. After frames that refined it, F, its stages and the fit come from the last
///     frame; `rank` and all covariances come from the cold start; candidates have no integral (infinite); tilts come
///     from the axes alone; and all counts are of the pixels that were used.
/// @return The status that ofc_solve() would return for the cold start; OFC_STATUS_NOT_SOLVED before the last pass of
///     the cold start; OFC_STATUS_NO_STREAM; an argument status.
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

/// Gives what the last frame of OFC_PASS_REFINE says about the model from before it.
/// @param stream  The stream.
/// @param drift  Output: the drift.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED when there was no such frame since the cold start;
///     OFC_STATUS_NO_STREAM; an argument status.
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
        let nothing = Change { angles: [f64::NAN; 3], strengths: [f64::NAN; 3], dispersion: f64::NAN };
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

/// Computes the unit normals of a row's inliers under the current model, for any row of any frame.
/// @param stream  The stream.
/// @param row  A picture of height 1.
/// @param normals  Output: width (x, y, z) floats, x right, y up, z toward the camera; zero where there is no normal.
///     Computed in double precision, where ofc_normals_compute() takes single precision for most: they differ by rounding.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_ROW_MISMATCH; OFC_STATUS_NO_STREAM; an argument status.
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

/// Computes the unit normals of a row's inliers under the current model, in 8 bits for each component.
/// @param stream  The stream.
/// @param row  A picture of height 1.
/// @param normals  Output: width (x, y, z) bytes, each 255 (n + 1) / 2, rounded; three zeros, which are no unit normal,
///     where there is no normal.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_ROW_MISMATCH; OFC_STATUS_NO_STREAM; an argument status.
///
/// Reference: eq. 8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_stream_normals_row_packed(
    stream: *mut ofc_stream,
    row: *const ofc_image,
    normals: *mut u8,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| write_row(call, stream, row, normals, 3, State::packed_normals))
}

/// Says which pixels of a row are inliers under the current model.
/// @param stream  The stream.
/// @param row  A picture of height 1.
/// @param flags  Output: width bytes, 255 for an inlier and 0 elsewhere.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_ROW_MISMATCH; OFC_STATUS_NO_STREAM; an argument status.
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
