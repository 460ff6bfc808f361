//! A camera's rows instead of a picture: the pipeline of [`solve`](mod@crate::solve) over one row at a time.
//!
//! A cold start takes two or three passes over a frame, or over consecutive frames of a scene at rest. The pass over its
//! colors keeps a stratified sample, and ends with the model: everything that medians and fits are for is computed on the
//! sample. The pass over its tilts sums the differences between neighbouring inliers, of this row and the one before it,
//! and ends with F where there is one candidate for the slants. Where there are several, a pass over the slants sums the
//! integral (15) of all of them at once, and ends with F. with the joint method ([`OrientationMethod::Joint`]) two passes take their
//! place: one sums the moments of the normals over cells, four rows at a time, for what outward normals say, and one over
//! windows of several sizes, as many as the memory holds, for integrability; it ends with F. Where the memory holds cells
//! of four pixels the first of them ends with F. Then normals and inliers of any row can be had, and one pass over a few
//! rows of a later frame refines the model.
//!
//! Where the sample has room for all pixels the result is that of [`solve`](crate::solve::solve), bit for bit, but for the
//! integral of a lone candidate, which is not computed (infinite). Without the feature `full-streams` there is the
//! direct method alone, shadows are kept, and errors of the fit are not computed (its covariance is zero).

mod cold;
mod orientation;
mod output;
mod rows;
mod strata;
mod warm;

pub use warm::{Change, Drift};

use crate::color::lmeds::{self, FitError, MIN_PIXELS};
use crate::color::regression::Moments;
use crate::light::constrained_slant::{MAX_CANDIDATES, WORKSPACE_LEN};
use crate::light::tilt::{TiltEstimator, pentland};
use crate::math::arena::Need;
use crate::math::mat3::Mat3;
use crate::orientation::integrability;
use crate::orientation::joint::{self, CellSums, STRIP, WindowSums};
use crate::picture::{Image, MAX_PIXELS, PixelCounts, Sample, Usable};
use crate::solve::{self, OrientationMethod, Outcome, SlantFallback, Solution};
use core::fmt;
use rows::Rows;
use strata::Strata;

/// Whether streams do all that [`solve`](crate::solve::solve) does.
pub const FULL: bool = cfg!(feature = "full-streams");

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// The pipeline's. `lmeds.sample_size` is how many colors the sample has room for, at least 24, here 2048 by default;
    /// tilts are Pentland's or given, and without a root slants are refused or fitted by least squares. Unless [`FULL`], the
    /// method is the direct one and shadows are not looked for.
    pub solve: solve::Params,
    /// Where less than this share of the usable pixels has a residual that the model accepts, in [0, 1], a frame does not
    /// refine it: a cold start is needed. Default 0.5, what least median of squares rests on.
    pub smallest_share: f64,
    /// About how many pixels a frame that refines the model looks at, those that the cold start could not use counting a
    /// third: every n-th row, at least 16, others from frame to frame. 0 looks at all rows. Default 16,384.
    pub refine_pixels: u32,
}

impl Default for Params {
    fn default() -> Self {
        let lmeds = lmeds::Params { sample_size: 2048, ..lmeds::Params::default() };
        let orientation_method = if FULL { OrientationMethod::Joint } else { OrientationMethod::Direct };
        let solve = solve::Params { lmeds, orientation_method, ..solve::Params::default() };
        Self { solve, smallest_share: 0.5, refine_pixels: 16_384 }
    }
}

impl Params {
    /// Whether every parameter is in its range, and one that rows can serve.
    #[must_use]
    pub fn are_valid(&self) -> bool {
        self.solve.are_valid()
            && (0.0..=1.0).contains(&self.smallest_share)
            // Merged strata leave half of the sample.
            && self.solve.lmeds.sample_size as usize >= 2 * MIN_PIXELS
            && (FULL || self.solve.orientation_method == OrientationMethod::Direct && !self.solve.rejects_shadows())
            && matches!(self.solve.tilts, TiltEstimator::Pentland | TiltEstimator::Given(_))
            && matches!(self.solve.fallback, SlantFallback::Refuse | SlantFallback::LeastSquares)
    }
}

/// What the rows of a frame are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// The sample and the model.
    Colors,
    /// The tilts.
    Tilts,
    /// The choice among the candidate slants.
    Slants,
    /// How normals point outward, for the orientation as a whole; with room for all windows, the orientation.
    Outward,
    /// That they are those of one surface, and the orientation.
    Integrability,
    /// F is there: the frame refines it.
    Refine,
}

/// Why a call did nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StreamError {
    /// A parameter is out of its range.
    Params,
    /// Width or height is zero, or there are more than [`MAX_PIXELS`].
    Size,
    /// A buffer is too short.
    TooShort,
    /// No frame was begun.
    NoFrame,
    /// There is no F yet.
    NotSolved,
    /// A row comes twice, or one before it is missing.
    RowOrder,
    /// All rows of the frame were there already.
    TooManyRows,
    /// The frame ends before its last row: it is forgotten, and its pass is still to come.
    TooFewRows,
    /// This is not one row of the frame's width and pixel type.
    Row,
    /// Nothing can be computed from the frame's colors; the next pass is over colors again.
    Fit(FitError),
}

impl fmt::Display for StreamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Params => f.write_str("a parameter is out of its range"),
            Self::Size => write!(f, "width or height is zero, or there are more than {MAX_PIXELS} pixels"),
            Self::TooShort => f.write_str("a buffer is too short"),
            Self::NoFrame => f.write_str("no frame was begun"),
            Self::NotSolved => f.write_str("there is no color-orientation matrix yet"),
            Self::RowOrder => f.write_str("a row comes twice, or one before it is missing"),
            Self::TooManyRows => f.write_str("all rows of the frame were there already"),
            Self::TooFewRows => f.write_str("the frame ends before its last row"),
            Self::Row => f.write_str("not one row of the frame's width and pixel type"),
            Self::Fit(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for StreamError {}

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
        OrientationMethod::Direct => row_len(width),
        OrientationMethod::Joint => rows_len(width).saturating_add(joint::least_room(width, height)),
    };
    if sample > rows { sample } else { rows }
}

/// Bytes for [`Memory::boxes`] and [`Memory::values`] of the pass that takes most, for callers who give every frame the same
/// memory, cut as [`State::need`] says. No number lives on from one pass to the next but in passes without boxes.
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
const fn need_of_slants(width: usize) -> Need {
    Need { doubles: WORKSPACE_LEN, singles: row_len(width), integers: 0 }
}

/// How many `f32` the row before is.
const fn row_len(width: usize) -> usize {
    width.saturating_mul(3)
}

/// How many `f32` the rows above a strip's last one are.
const fn rows_len(width: usize) -> usize {
    width.saturating_mul(3 * (STRIP - 1))
}

/// How many bytes [`Memory::places`] needs.
#[must_use]
pub const fn places_len(width: usize, height: usize, sample_size: u32) -> usize {
    room(width, height, sample_size)
}

/// How many colors the sample has room for.
const fn room(width: usize, height: usize, sample_size: u32) -> usize {
    let pixels = width.saturating_mul(height);
    if pixels < sample_size as usize { pixels } else { sample_size as usize }
}

/// The caller's buffers, which belong to the stream from one call to the next. What they hold at first does not matter.
#[derive(Debug)]
pub struct Memory<'m> {
    /// [`WORKSPACE_LEN`] numbers in the passes over tilts and those that refine, none in others: boxes of slants.
    pub boxes: &'m mut [f64],
    /// [`values_len`] numbers: the sample and its residuals, then the row before, or cells and the rows before. A caller who
    /// cuts the memory anew for every pass gives as many as [`State::need`] says.
    pub values: &'m mut [f32],
    /// [`places_len`] bytes: where in the frame the sample is from.
    pub places: &'m mut [u8],
}

/// What one pass holds for itself or for the next one.
#[derive(Clone, Debug)]
enum Held {
    Nothing,
    /// F^-1 of every candidate, and its integral.
    Candidates {
        inverses: [Option<Mat3>; MAX_CANDIDATES],
        integrals: [integrability::Sum; MAX_CANDIDATES],
    },
    CellSums(CellSums),
    WindowSums(WindowSums),
}

/// What a stream remembers beside its buffers.
#[derive(Clone, Debug)]
pub struct State {
    params: Params,
    width: usize,
    height: usize,
    format: Sample,
    pass: Pass,
    /// The row that comes next; `None` between frames.
    row: Option<usize>,
    pixel_counts: PixelCounts,
    strata: Strata,
    second_differences: (f64, u64),
    differences: pentland::Sums,
    /// Differences of the frames before.
    history: pentland::Sums,
    inlier_count: usize,
    rows: Rows,
    held: Held,
    moments: Moments,
    /// What colors are multiplied with before their moments are summed: a power of two.
    scale: f64,
    drift: Option<Drift>,
    /// Whether the cold start that `solution` is from came to its end.
    concluded: bool,
    solution: Solution,
}

impl State {
    /// For frames of this size, whose samples are stored as `format`.
    ///
    /// # Errors
    /// [`StreamError::Params`], [`StreamError::Size`].
    pub fn new(width: usize, height: usize, format: Sample, params: Params) -> Result<Self, StreamError> {
        Self::check_size(width, height, &params)?;
        Ok(Self::unchecked(width, height, format, params))
    }

    /// Whether there can be a stream of frames of this size.
    ///
    /// # Errors
    /// [`StreamError::Params`], [`StreamError::Size`].
    pub fn check_size(width: usize, height: usize, params: &Params) -> Result<(), StreamError> {
        if !params.are_valid() {
            return Err(StreamError::Params);
        }
        let holds = width.checked_mul(height).is_some_and(|pixels| (1..=MAX_PIXELS).contains(&pixels));
        if holds { Ok(()) } else { Err(StreamError::Size) }
    }

    /// Does what [`Self::new`] does, for what [`Self::check_size`] has seen: made where it is put, without a copy on the stack.
    #[must_use]
    #[expect(clippy::inline_always, reason = "three kilobytes that should not be moved")]
    #[inline(always)]
    pub fn unchecked(width: usize, height: usize, format: Sample, params: Params) -> Self {
        let usable = Usable::below(params.solve.saturation.unwrap_or(format.saturation()));
        let lmeds = params.solve.lmeds;
        Self {
            params,
            width,
            height,
            format,
            pass: Pass::Colors,
            row: None,
            pixel_counts: PixelCounts::default(),
            strata: Strata::new(lmeds.seed, room(width, height, lmeds.sample_size)),
            second_differences: (0.0, 0),
            differences: pentland::Sums::default(),
            history: pentland::Sums::default(),
            inlier_count: 0,
            rows: Rows::new(height, &PixelCounts::default(), 0),
            held: Held::Nothing,
            moments: Moments::default(),
            scale: 1.0,
            drift: None,
            concluded: false,
            solution: Solution::unsolved(PixelCounts::default(), usable),
        }
    }

    /// What the next frame is for, or the present one.
    #[must_use]
    pub const fn pass(&self) -> Pass {
        self.pass
    }

    /// Whether the last cold start came to its end; [`Self::solution`] then says how far, and otherwise is still growing.
    #[must_use]
    pub const fn is_concluded(&self) -> bool {
        self.concluded
    }

    /// How far the last cold start came, and what it found on the way.
    #[must_use]
    pub const fn solution(&self) -> &Solution {
        &self.solution
    }

    /// How many numbers the pass in progress, or the next one, takes: doubles are [`Memory::boxes`], singles
    /// [`Memory::values`].
    #[must_use]
    pub const fn need(&self) -> Need {
        let params = &self.params.solve;
        match self.pass {
            Pass::Tilts | Pass::Refine => need_of_slants(self.width),
            _ => Need::of_singles(values_len(
                self.width,
                self.height,
                params.lmeds.sample_size,
                params.orientation_method,
            )),
        }
    }

    fn usable(&self) -> Usable {
        self.solution.inliers.usable
    }
}

/// A stream: its state over its buffers.
#[derive(Debug)]
pub struct Stream<'m> {
    state: &'m mut State,
    memory: Memory<'m>,
}

impl<'m> Stream<'m> {
    /// # Errors
    /// [`StreamError::TooShort`] where the memory does not hold what the pass takes that the state is in.
    pub fn new(state: &'m mut State, memory: Memory<'m>) -> Result<Self, StreamError> {
        let (width, height, sample_size) = (state.width, state.height, state.params.solve.lmeds.sample_size);
        let Memory { boxes, values, places } = memory;
        // More than is needed must not change the answer.
        let len = values_len(width, height, sample_size, state.params.solve.orientation_method);
        let values = values.get_mut(..len.min(values.len())).ok_or(StreamError::TooShort)?;
        let places = places.get_mut(..places_len(width, height, sample_size)).ok_or(StreamError::TooShort)?;
        let stream = Self { state, memory: Memory { boxes, values, places } };
        stream.check_memory().map(|()| stream)
    }

    /// Whether the memory holds what the pass takes that the state is in.
    const fn check_memory(&self) -> Result<(), StreamError> {
        let Need { doubles, singles, .. } = self.state.need();
        let holds = self.memory.boxes.len() >= doubles && self.memory.values.len() >= singles;
        if holds { Ok(()) } else { Err(StreamError::TooShort) }
    }

    /// The state.
    #[must_use]
    pub const fn state(&self) -> &State {
        self.state
    }

    /// Forgets the model: the next frame is for colors.
    pub fn restart(&mut self) {
        let state = &mut *self.state;
        (state.row, state.pass, state.drift, state.concluded) = (None, Pass::Colors, None, false);
        state.solution.restart(PixelCounts::default());
    }

    /// Begins a frame, and says what for. One that was not ended is forgotten.
    ///
    /// # Errors
    /// [`StreamError::TooShort`] where the stream was made with the memory of another pass.
    pub fn begin(&mut self) -> Result<Pass, StreamError> {
        self.check_memory()?;
        let state = &mut *self.state;
        match state.pass {
            Pass::Colors => state.begin_colors(),
            Pass::Tilts => state.begin_tilts(),
            Pass::Slants => state.begin_slants(),
            Pass::Outward if FULL => state.begin_outward(&mut self.memory),
            Pass::Integrability if FULL => state.begin_integrability(&mut self.memory),
            Pass::Outward | Pass::Integrability => {}
            Pass::Refine => state.begin_refine(),
        }
        state.row = Some(0);
        Ok(state.pass)
    }

    /// Takes row `y` of the frame, a picture of height 1 that may have a mask.
    ///
    /// # Errors
    /// [`StreamError::NoFrame`], [`StreamError::TooManyRows`], [`StreamError::RowOrder`], [`StreamError::Row`]: the frame
    /// goes on as if the call had not been.
    pub fn row(&mut self, y: usize, row: &Image) -> Result<(), StreamError> {
        let state = &mut *self.state;
        let next = state.row.ok_or(StreamError::NoFrame)?;
        if next >= state.height {
            return Err(StreamError::TooManyRows);
        }
        if y != next {
            return Err(StreamError::RowOrder);
        }
        state.check(row)?;
        match state.pass {
            Pass::Colors => state.row_colors(y, row, &mut self.memory),
            Pass::Tilts => state.row_tilts(y, row, &mut self.memory),
            Pass::Slants => state.row_slants(y, row, &mut self.memory),
            Pass::Outward if FULL => state.row_outward(y, row, &mut self.memory),
            Pass::Integrability if FULL => state.row_integrability(y, row, &mut self.memory),
            Pass::Outward | Pass::Integrability => {}
            Pass::Refine => state.row_refine(y, row, &mut self.memory),
        }
        state.row = Some(y + 1);
        Ok(())
    }

    /// Ends a frame, and says which pass comes next. That is [`Pass::Colors`] where a cold start came to no F, and
    /// [`State::solution`] says why, and where too few pixels fit the model for it to be refined, as [`State::drift`] says.
    /// The old model serves on in this case, until it is replaced.
    ///
    /// # Errors
    /// [`StreamError::NoFrame`], [`StreamError::TooFewRows`], [`StreamError::Fit`].
    pub fn end(&mut self) -> Result<Pass, StreamError> {
        let state = &mut *self.state;
        let rows = state.row.take().ok_or(StreamError::NoFrame)?;
        if rows < state.height {
            return Err(StreamError::TooFewRows);
        }
        match state.pass {
            Pass::Colors => state.end_colors(&mut self.memory)?,
            Pass::Tilts => state.end_tilts(&mut self.memory),
            Pass::Slants => state.end_slants(),
            Pass::Outward if FULL => state.end_outward(&mut self.memory),
            Pass::Integrability if FULL => state.end_integrability(&mut self.memory),
            Pass::Outward | Pass::Integrability => {}
            Pass::Refine => state.end_refine(&mut self.memory),
        }
        Ok(state.pass)
    }
}

impl State {
    /// Whether this is a row of the frame.
    fn check(&self, row: &Image) -> Result<(), StreamError> {
        let fits = row.width() == self.width && row.height() == 1 && row.sample() == self.format;
        if fits { Ok(()) } else { Err(StreamError::Row) }
    }

    /// The pass that follows from how far the solution has come, `next` where it goes on.
    fn go_on(&mut self, goes_on: bool, next: Pass) {
        self.concluded = !goes_on;
        self.pass = if goes_on {
            next
        } else if self.solution.outcome == Outcome::Solved {
            Pass::Refine
        } else {
            Pass::Colors
        };
    }
}
