//! A camera's rows instead of a picture: the pipeline of [`solve`](mod@crate::solve) over one row at a time.
//!
//! A cold start takes two or three passes over a frame, or over consecutive frames of a scene at rest. The pass over its
//! colors keeps a stratified sample, and ends with the model: everything that medians and fits are for is computed on the
//! sample. The pass over its tilts sums the differences between neighboring inliers, of this row and the one before it,
//! and ends with F where there is one candidate for the slants. Where there are several, a pass over the slants sums the
//! integral (15) of all of them at once, and ends with F. With the joint method ([`OrientationMethod::Joint`](crate::solve::OrientationMethod::Joint)) two passes take their
//! place: one sums the moments of the normals over cells, four rows at a time, for what outward normals say, and one over
//! windows of several sizes, as many as the memory holds, for integrability; it ends with F. Where the memory holds cells
//! of four pixels the first of them ends with F. Then normals and inliers of any row can be had, and one pass over a few
//! rows of a later frame refines the model.
//!
//! Where the sample has room for all pixels, and these are fewer than 131,072, the result is that of
//! [`solve`](crate::solve::solve), bit for bit, but for the integral of a lone candidate, which is not computed (infinite). Without the
//! feature `full-streams` there is the direct method alone, shadows are kept, and errors of the fit are not computed (its covariance is zero).

mod cold;
mod drift;
mod kept_row;
mod memory;
mod orientation;
mod output;
mod parameters;
mod pass;
mod rows;
mod state;
mod strata;
mod warm;

pub use drift::{Change, Drift};
pub use memory::{Memory, places_len, shared_bytes, values_len};
pub use parameters::{FULL, Params};
pub use pass::{Pass, StreamError};
pub use state::State;

use crate::math::arena::Need;
use crate::picture::{Image, PixelCounts};

/// A stream: its state over its buffers.
///
/// # Example
/// ```
/// use ofc_core::light::constrained_slant::WORKSPACE_LEN;
/// use ofc_core::stream::{Memory, Params, Pass, State, Stream, places_len, values_len};
/// use ofc_core::{Image, Order, Sample};
///
/// let (width, height, params) = (64, 48, Params::default());
/// let (sample, method) = (params.solve.lmeds.sample_size, params.solve.orientation_method);
/// let mut boxes = vec![0.0; WORKSPACE_LEN];
/// let mut values = vec![0.0; values_len(width, height, sample, method)];
/// let mut places = vec![0; places_len(width, height, sample)];
/// let mut state = State::new(width, height, Sample::U8, params).unwrap();
/// let memory = Memory { boxes: &mut boxes, values: &mut values, places: &mut places };
/// let mut stream = Stream::new(&mut state, memory).unwrap();
///
/// // A camera that sees a plane: the frame ends without F, and the next one is for colors again.
/// let row = vec![90_u8; 3 * width];
/// let image = Image::interleaved(&row, width, 1, 3 * width, Sample::U8, Order::Rgb).unwrap();
/// assert_eq!(stream.begin(), Ok(Pass::Colors));
/// for y in 0..height {
///     stream.row(y, &image).unwrap();
/// }
/// assert_eq!(stream.end(), Ok(Pass::Colors));
/// ```
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
