//! What every call returns.

use crate::prelude::*;
use core::ffi::{CStr, c_char};
use ofc_core::check::CheckError;
use ofc_core::color::ellipsoid::NotPositiveDefinite;
use ofc_core::color::lmeds::FitError;
use ofc_core::color::offset::OffsetError;
use ofc_core::color::paint::PaintError;
use ofc_core::color::paint::albedo::AlbedoError;
use ofc_core::color::segment::SegmentError;
use ofc_core::orientation::orthogonal::OrthogonalError;
use ofc_core::picture::ImageError;
use ofc_core::picture::dark::DarkError;
use ofc_core::picture::flat_field::FlatFieldError;
use ofc_core::picture::transfer::TransferError;
use ofc_core::render::{DepthMapError, RenderError};
use ofc_core::solve::Outcome;
use ofc_core::stream::StreamError;
use ofc_core::surface::completion::CompletionError;
use ofc_core::surface::depth::DepthError;
use ofc_core::surface::normals;

/// What a call returns: one of OFC_STATUS_*, whose numbers are never reused.
///
/// Zero is success. A negative status is an error, and no output has been touched. A positive status says that the
/// input is sound but does not determine the whole answer; the function says what it writes then. An argument status is
/// one from OFC_STATUS_NULL_POINTER to OFC_STATUS_RESERVED_NOT_ZERO.
pub type ofc_status = i32;

/// Success.
pub const OFC_STATUS_OK: i32 = 0;
/// Colors or normals span fewer than three dimensions: F is not determined.
pub const OFC_STATUS_RANK_DEFICIENT: i32 = 1;
/// The colors do not lie on an ellipsoid: C is not positive definite.
pub const OFC_STATUS_NOT_POSITIVE_DEFINITE: i32 = 2;
/// There is no tilt: a channel has no mean gradient over the inliers.
pub const OFC_STATUS_NO_TILT: i32 = 3;
/// No slants agree with the tilts and with the angles between the rows of F.
pub const OFC_STATUS_NO_CONSISTENT_SLANTS: i32 = 4;
/// An iteration ended before its tolerance; the result is what it had reached.
pub const OFC_STATUS_NOT_CONVERGED: i32 = 5;
/// The stream's model no longer fits the frame; the next frame is for colors.
pub const OFC_STATUS_COLD_START_NEEDED: i32 = 6;
/// The paint cannot be told from the shape: it is as rough, or of several hues.
pub const OFC_STATUS_PAINT_UNKNOWN: i32 = 7;
/// The picture shows no relief on a plane; the result says why.
pub const OFC_STATUS_NO_RELIEF: i32 = 8;
/// Colors and normals span three dimensions, but by hardly more than the noise, or than what does not obey the model: C
/// is not determined. `reason` of the solution says what it comes from.
pub const OFC_STATUS_UNDETERMINED: i32 = 9;
/// The slopes and depths of a rig are right up to a factor: nothing says what it is.
pub const OFC_STATUS_SCALE_UNKNOWN: i32 = 10;

/// A pointer that must not be NULL is NULL.
pub const OFC_STATUS_NULL_POINTER: i32 = -10;
/// A pointer or stride is not aligned for its type, or for a workspace.
pub const OFC_STATUS_MISALIGNED: i32 = -11;
/// An output overlaps an input, the workspace or another output.
pub const OFC_STATUS_OVERLAP: i32 = -12;

/// A width, a height or a count is too small.
pub const OFC_STATUS_EMPTY: i32 = -20;
/// There are more than 2^31 - 1 pixels, or a size exceeds the address space.
pub const OFC_STATUS_TOO_LARGE: i32 = -21;
/// A row stride is smaller than a row.
pub const OFC_STATUS_STRIDE_TOO_SMALL: i32 = -22;
/// The workspace is smaller than its size function says.
pub const OFC_STATUS_WORKSPACE_TOO_SMALL: i32 = -23;

/// A pixel format is none of OFC_PIXEL_*, or not one that the call takes.
pub const OFC_STATUS_UNKNOWN_FORMAT: i32 = -30;
/// A parameter is out of its range, or an input number is not finite.
pub const OFC_STATUS_INVALID_PARAMETER: i32 = -31;
/// A reserved field is not zero: initialize the whole struct.
pub const OFC_STATUS_RESERVED_NOT_ZERO: i32 = -32;
/// The solution holds no F, as the call that made it did not return OFC_STATUS_OK, or its F does not fit the picture.
pub const OFC_STATUS_NOT_SOLVED: i32 = -33;
/// The direct method, which found the solution, knows no uncertainty.
pub const OFC_STATUS_NO_COVARIANCE: i32 = -34;

/// There are fewer usable pixels than a fit needs.
pub const OFC_STATUS_TOO_FEW_PIXELS: i32 = -40;
/// There are too few usable pixels: most are black.
pub const OFC_STATUS_DARK: i32 = -41;
/// There are too few usable pixels: most are saturated.
pub const OFC_STATUS_SATURATED: i32 = -42;
/// No two by two pixels are all inliers, so there are no differences to take.
pub const OFC_STATUS_NO_CELLS: i32 = -43;

/// No stream is at this address, or something overwrote it.
pub const OFC_STATUS_NO_STREAM: i32 = -50;
/// No frame was begun.
pub const OFC_STATUS_NO_FRAME: i32 = -51;
/// A row was given twice or skipped; the call changed nothing.
pub const OFC_STATUS_ROW_ORDER: i32 = -52;
/// The frame has all its rows already.
pub const OFC_STATUS_TOO_MANY_ROWS: i32 = -53;
/// The frame ended before its last row; its pass must be repeated.
pub const OFC_STATUS_TOO_FEW_ROWS: i32 = -54;
/// The picture is not one row of the stream's width and sample type.
pub const OFC_STATUS_ROW_MISMATCH: i32 = -55;

/// The bytes are not those of a saved model, or their byte order was changed.
pub const OFC_STATUS_NOT_A_MODEL: i32 = -60;
/// The model is of a version that is not known.
pub const OFC_STATUS_MODEL_VERSION: i32 = -61;
/// The bytes of the model are too few, too many or changed.
pub const OFC_STATUS_MODEL_DAMAGED: i32 = -62;

fn message(status: ofc_status) -> &'static CStr {
    match status {
        OFC_STATUS_OK => c"success",
        OFC_STATUS_RANK_DEFICIENT => c"rank-deficient: the colors or the normals span fewer than three dimensions",
        OFC_STATUS_NOT_POSITIVE_DEFINITE => c"C is not positive definite: the colors do not lie on an ellipsoid (normals in fewer than three dimensions, or a surface that is not uniform and matte)",
        OFC_STATUS_NO_TILT => c"no tilt: a channel has no mean gradient over the inliers",
        OFC_STATUS_NO_CONSISTENT_SLANTS => c"no slants are consistent with the tilts and the cosines (eqs. 25 have no root)",
        OFC_STATUS_NOT_CONVERGED => c"not converged: the iteration ended before it reached its tolerance",
        OFC_STATUS_COLD_START_NEEDED => c"the model no longer fits: a cold start is needed",
        OFC_STATUS_PAINT_UNKNOWN => c"the paint cannot be told from the shape: it is as rough, or of several hues",
        OFC_STATUS_NO_RELIEF => c"the picture shows no relief on a plane",
        OFC_STATUS_UNDETERMINED => c"C is not determined: what would determine it is hardly more than the noise, or than what does not obey the model",
        OFC_STATUS_SCALE_UNKNOWN => c"the scale is unknown: slopes and depths are right up to a factor",
        OFC_STATUS_NULL_POINTER => c"a pointer is NULL",
        OFC_STATUS_MISALIGNED => c"a pointer or stride is not aligned for its type",
        OFC_STATUS_OVERLAP => c"an output overlaps another buffer",
        OFC_STATUS_EMPTY => c"a width, height or count is too small for the call",
        OFC_STATUS_TOO_LARGE => c"too many pixels, or a size beyond the address space",
        OFC_STATUS_STRIDE_TOO_SMALL => c"a row stride is smaller than a row",
        OFC_STATUS_WORKSPACE_TOO_SMALL => c"the workspace is too small",
        OFC_STATUS_UNKNOWN_FORMAT => c"unknown pixel format",
        OFC_STATUS_INVALID_PARAMETER => c"a parameter is out of its range or not finite: see its field in ofc.h",
        OFC_STATUS_RESERVED_NOT_ZERO => c"a reserved field is not zero",
        OFC_STATUS_NOT_SOLVED => c"the solution holds no F that fits the picture",
        OFC_STATUS_NO_COVARIANCE => c"the solution does not know how sure its orientation is: it was found by tilts alone",
        OFC_STATUS_TOO_FEW_PIXELS => c"too few usable pixels",
        OFC_STATUS_DARK => c"too few usable pixels: most are black",
        OFC_STATUS_SATURATED => c"too few usable pixels: most are saturated",
        OFC_STATUS_NO_CELLS => c"no cell of four neighboring inliers",
        OFC_STATUS_NO_STREAM => c"no stream is initialized at this address",
        OFC_STATUS_NO_FRAME => c"no frame was begun",
        OFC_STATUS_ROW_ORDER => c"a row is out of order",
        OFC_STATUS_TOO_MANY_ROWS => c"the frame has all its rows",
        OFC_STATUS_TOO_FEW_ROWS => c"the frame ended before its last row",
        OFC_STATUS_ROW_MISMATCH => c"not one row of the stream's width and sample type",
        OFC_STATUS_NOT_A_MODEL => c"not a saved model, or with another byte order",
        OFC_STATUS_MODEL_VERSION => c"a model of an unknown version",
        OFC_STATUS_MODEL_DAMAGED => c"a damaged model: its size or its checksum is wrong",
        _ => c"unknown status",
    }
}

/// Says what a status means.
/// @param status  Any number.
/// @return A sentence in static storage; never NULL, not even for numbers that are no status.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_status_message(status: ofc_status) -> *const c_char {
    message(status).as_ptr()
}

/// Why a call is refused.
#[derive(Clone, Copy)]
pub(crate) struct Refusal(pub(crate) ofc_status);

impl From<ofc_status> for Refusal {
    fn from(status: ofc_status) -> Self {
        Self(status)
    }
}

/// Refuses the call with `status` unless a condition holds.
pub(crate) fn ensure(holds: bool, status: ofc_status) -> Result<(), Refusal> {
    if holds { Ok(()) } else { Err(Refusal(status)) }
}

/// What errors of the core are in C.
macro_rules! refusals {
    ($($error:ty { $($kind:pat => $status:expr),+ $(,)? })+) => {$(
        impl From<$error> for Refusal {
            fn from(error: $error) -> Self {
                Self(match error { $($kind => $status,)+ })
            }
        }
    )+};
}

refusals! {
    ImageError {
        ImageError::Empty => OFC_STATUS_EMPTY,
        ImageError::StrideTooSmall => OFC_STATUS_STRIDE_TOO_SMALL,
        ImageError::TooLarge | ImageError::TooShort => OFC_STATUS_TOO_LARGE,
    }
    FitError {
        FitError::Params => OFC_STATUS_INVALID_PARAMETER,
        FitError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
        FitError::TooFewPixels => OFC_STATUS_TOO_FEW_PIXELS,
        FitError::Dark => OFC_STATUS_DARK,
        FitError::Saturated => OFC_STATUS_SATURATED,
        FitError::RankDeficient { .. } => OFC_STATUS_RANK_DEFICIENT,
    }
    NotPositiveDefinite {
        NotPositiveDefinite { .. } => OFC_STATUS_NOT_POSITIVE_DEFINITE,
    }
    OrthogonalError {
        OrthogonalError::Params | OrthogonalError::SingularRoot => OFC_STATUS_INVALID_PARAMETER,
        OrthogonalError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
        OrthogonalError::NoCells => OFC_STATUS_NO_CELLS,
    }
    normals::TooShort {
        normals::TooShort => OFC_STATUS_INVALID_PARAMETER,
    }
    DepthError {
        DepthError::Size => OFC_STATUS_TOO_LARGE,
        DepthError::Parameter => OFC_STATUS_INVALID_PARAMETER,
        DepthError::Workspace(_) => OFC_STATUS_WORKSPACE_TOO_SMALL,
        DepthError::Output => OFC_STATUS_STRIDE_TOO_SMALL,
        DepthError::Empty => OFC_STATUS_TOO_FEW_PIXELS,
    }
    CompletionError {
        CompletionError::Size => OFC_STATUS_TOO_LARGE,
        CompletionError::Parameter => OFC_STATUS_INVALID_PARAMETER,
        CompletionError::Workspace(_) => OFC_STATUS_WORKSPACE_TOO_SMALL,
        CompletionError::Output => OFC_STATUS_STRIDE_TOO_SMALL,
        CompletionError::Empty => OFC_STATUS_TOO_FEW_PIXELS,
        CompletionError::OtherPicture => OFC_STATUS_NOT_SOLVED,
    }
    CheckError {
        CheckError::Orientation => OFC_STATUS_NOT_SOLVED,
        CheckError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
        CheckError::Size => OFC_STATUS_INVALID_PARAMETER,
        CheckError::NoInliers => OFC_STATUS_TOO_FEW_PIXELS,
    }
    DepthMapError {
        DepthMapError::Image(error) => Self::from(error).0,
        DepthMapError::Pitch => OFC_STATUS_INVALID_PARAMETER,
    }
    RenderError {
        RenderError::NonFiniteDepth | RenderError::Peak | RenderError::Noise | RenderError::Size => {
            OFC_STATUS_INVALID_PARAMETER
        },
    }
    StreamError {
        StreamError::Params => OFC_STATUS_INVALID_PARAMETER,
        StreamError::Size => OFC_STATUS_TOO_LARGE,
        StreamError::TooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
        StreamError::NoFrame => OFC_STATUS_NO_FRAME,
        StreamError::NotSolved => OFC_STATUS_NOT_SOLVED,
        StreamError::RowOrder => OFC_STATUS_ROW_ORDER,
        StreamError::TooManyRows => OFC_STATUS_TOO_MANY_ROWS,
        StreamError::TooFewRows => OFC_STATUS_TOO_FEW_ROWS,
        StreamError::Row => OFC_STATUS_ROW_MISMATCH,
        StreamError::Fit(error) => Self::from(error).0,
    }
    FlatFieldError {
        FlatFieldError::Size => OFC_STATUS_INVALID_PARAMETER,
        FlatFieldError::Output => OFC_STATUS_STRIDE_TOO_SMALL,
        FlatFieldError::Background => OFC_STATUS_DARK,
    }
    TransferError {
        TransferError::Exponent | TransferError::Length | TransferError::Entry => OFC_STATUS_INVALID_PARAMETER,
        TransferError::Output(error) => Self::from(error).0,
    }
    DarkError {
        DarkError::Frame | DarkError::Offset => OFC_STATUS_INVALID_PARAMETER,
        DarkError::Output(error) => Self::from(error).0,
    }
    OffsetError {
        OffsetError::Form => OFC_STATUS_NOT_POSITIVE_DEFINITE,
        OffsetError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
        OffsetError::TooFewPixels => OFC_STATUS_TOO_FEW_PIXELS,
        OffsetError::NotDetermined => OFC_STATUS_UNDETERMINED,
    }
    PaintError {
        PaintError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
        PaintError::TooFewPixels => OFC_STATUS_TOO_FEW_PIXELS,
        PaintError::Dark => OFC_STATUS_DARK,
        PaintError::Saturated => OFC_STATUS_SATURATED,
    }
    AlbedoError {
        AlbedoError::Rows => OFC_STATUS_STRIDE_TOO_SMALL,
        AlbedoError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
        AlbedoError::TooFewPixels => OFC_STATUS_TOO_FEW_PIXELS,
    }
    SegmentError {
        SegmentError::Params => OFC_STATUS_INVALID_PARAMETER,
        SegmentError::LabelsTooShort | SegmentError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
    }
}

constants!(Outcome = {
    Solved: OFC_STATUS_OK,
    RankDeficient: OFC_STATUS_RANK_DEFICIENT,
    Undetermined: OFC_STATUS_UNDETERMINED,
    NotPositiveDefinite: OFC_STATUS_NOT_POSITIVE_DEFINITE,
    NoTilt: OFC_STATUS_NO_TILT,
    NoConsistentSlants: OFC_STATUS_NO_CONSISTENT_SLANTS,
    Unfinished: OFC_STATUS_NOT_SOLVED,
});
