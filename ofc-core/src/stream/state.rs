//! What a stream remembers from row to row and from frame to frame.

use super::drift::Drift;
use super::memory::{need_of_slants, room, values_len};
use super::parameters::Params;
use super::pass::{Pass, StreamError};
use super::rows::Rows;
use super::strata::Strata;
use crate::color::regression::Moments;
use crate::light::constrained_slant::MAX_CANDIDATES;
use crate::light::tilt::pentland;
use crate::math::arena::Need;
use crate::math::mat3::Mat3;
use crate::orientation::integrability;
use crate::orientation::joint::{CellSums, WindowSums};
use crate::picture::{Image, MAX_PIXELS, PixelCounts, Sample, Usable};
use crate::solve::{Outcome, Solution};

/// What one pass holds for itself or for the next one.
#[derive(Clone, Debug)]
pub(super) enum Held {
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
    pub(super) params: Params,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) format: Sample,
    pub(super) pass: Pass,
    /// The row that comes next; `None` between frames.
    pub(super) row: Option<usize>,
    pub(super) pixel_counts: PixelCounts,
    pub(super) strata: Strata,
    pub(super) second_differences: (f64, u64),
    pub(super) differences: pentland::Sums,
    /// Differences of the frames before.
    pub(super) history: pentland::Sums,
    pub(super) inlier_count: usize,
    pub(super) rows: Rows,
    pub(super) held: Held,
    pub(super) moments: Moments,
    /// What colors are multiplied with before their moments are summed: a power of two.
    pub(super) scale: f64,
    pub(super) drift: Option<Drift>,
    /// Whether the cold start that `solution` is from came to its end.
    pub(super) concluded: bool,
    pub(super) solution: Solution,
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
            solution: Solution::new(PixelCounts::default(), usable),
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

    /// How many numbers the pass in progress, or the next one, takes: doubles are [`Memory::boxes`](super::Memory::boxes), singles
    /// [`Memory::values`](super::Memory::values).
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

    pub(super) fn usable(&self) -> Usable {
        self.solution.inliers.usable
    }

    /// Whether this is a row of the frame.
    pub(super) fn check(&self, row: &Image) -> Result<(), StreamError> {
        let fits = row.width() == self.width && row.height() == 1 && row.sample() == self.format;
        if fits { Ok(()) } else { Err(StreamError::Row) }
    }

    /// The pass that follows from how far the solution has come, `next` where it goes on.
    pub(super) fn go_on(&mut self, goes_on: bool, next: Pass) {
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
