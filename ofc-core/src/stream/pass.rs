//! What the rows of a frame are for, and why a call does nothing.

use crate::color::lmeds::FitError;
use crate::picture::MAX_PIXELS;
use core::fmt;

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
