//! A relief on a plane: pictures most of which is one flat surface.

use crate::prelude::*;
use ofc_core::orientation::relief::{
    self, Grid, PixelClass, Polynomial, Relief, ReliefError, ReliefParams, ScaleSource,
};

/// Where the scale of a relief's slopes comes from: one of OFC_SCALE_*.
pub type ofc_scale_source = i32;
/// It is unknown: slopes and depths are right up to a factor, and a usual one is taken.
pub const OFC_SCALE_UNKNOWN: i32 = 0;
/// From the bend of the colors of the inner contact.
pub const OFC_SCALE_COLORS: i32 = 1;
/// From the radius of the ball that was given.
pub const OFC_SCALE_BALL: i32 = 2;
/// It was set, by ofc_rig_set_scale().
pub const OFC_SCALE_GIVEN: i32 = 3;

constants!(ScaleSource = {
    Unknown: OFC_SCALE_UNKNOWN,
    Colors: OFC_SCALE_COLORS,
    Ball: OFC_SCALE_BALL,
    Given: OFC_SCALE_GIVEN,
});

/// Why a picture shows no relief on a plane: one of OFC_NO_RELIEF_*, whose numbers are never reused; 0 where it shows one.
pub type ofc_no_relief = i32;
/// Nothing differs from the plane.
pub const OFC_NO_RELIEF_UNTOUCHED: i32 = 1;
/// More than half of the picture differs from the plane.
pub const OFC_NO_RELIEF_NO_PLANE: i32 = 2;
/// The slopes have one direction, as those of a groove, or do not stand out of the noise.
pub const OFC_NO_RELIEF_NOT_DETERMINED: i32 = 3;
/// What differs from the plane is paint, spots, highlights or shadows: its slopes would not be those of a surface.
pub const OFC_NO_RELIEF_NOT_INTEGRABLE: i32 = 4;
/// What differs from the plane has an edge: it lies on the plane rather than rises from it, or it is paint.
pub const OFC_NO_RELIEF_EDGE: i32 = 5;

/// What a pixel of a relief is part of: one of OFC_RELIEF_*.
pub type ofc_relief_class = u8;
/// The pixel is masked out or its surroundings have no usable color: there is no normal.
pub const OFC_RELIEF_NONE: u8 = 0;
/// The untouched plane: its normal is (0, 0, 1).
pub const OFC_RELIEF_PLANE: u8 = 1;
/// The surroundings of the contact, where the relief comes up from the plane.
pub const OFC_RELIEF_SKIRT: u8 = 2;
/// The contact: what differs from the plane by more than noise.
pub const OFC_RELIEF_CONTACT: u8 = 3;

const _: () = assert!(
    OFC_RELIEF_NONE == PixelClass::None as u8
        && OFC_RELIEF_PLANE == PixelClass::Plane as u8
        && OFC_RELIEF_SKIRT == PixelClass::Skirt as u8
        && OFC_RELIEF_CONTACT == PixelClass::Contact as u8,
    "the header says what the core does"
);

/// What is known of a relief beforehand. Set by ofc_relief_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_relief_params {
    /// A pixel with a channel at or above this level is saturated; zero stands for the largest value of the pixel type,
    /// and for no limit with floats. Default 0.
    pub saturation: f64,
    /// The radius in pixels of the one ball that is pressed in: it gives the scale of the slopes. 0 where there is none. Default 0.
    pub ball_radius: f64,
    /// Determines every random choice. Default 0.
    pub seed: u64,
    /// One of OFC_CONVEXITY_*: OFC_CONVEXITY_HOLLOW for a dent or an engraving, and otherwise the relief rises toward the camera, as a
    /// gel does where something is pressed into it. Default OFC_CONVEXITY_AUTO.
    pub convexity: ofc_convexity,
    /// Must be zero.
    pub reserved: [u32; 3],
}

/// A relief on a plane: what turns colors into its normals, and how far to trust them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_relief {
    /// W, 2 x 3 and row-major: (n1, n2) = W delta, where delta is the color of a pixel divided by that of the plane, less 1, channel by
    /// channel.
    pub slopes: [f64; 6],
    /// The color of the plane by a polynomial of order 4, 15 coefficients a channel, in pixel values. The terms are 1, x, y, x^2, xy, y^2
    /// and so on; x goes from -1 to 1 across the picture and y from -1 to 1 down. Where a background was given it tells dark spots only.
    pub plane: [f64; 45],
    /// The standard deviation of each channel of a cell of the plane, relative to its color.
    pub noise: [f64; 3],
    /// The mean squared circulation of the slopes relative to their energy: 0 for a perfect relief, above 0.3 for paint, spots and shadows.
    pub circulation: f64,
    /// The circulation relative to that of the second best W: near 1 for a groove.
    pub circulation_ratio: f64,
    /// The variance of the slopes across the relief over that along it: 0 for a groove.
    pub anisotropy: f64,
    /// The smaller standard deviation of the slopes in the contact over that of their noise.
    pub signal_to_noise: f64,
    /// The root mean square of the step of the slopes across the border of the contact over that of the slopes in it: near 1 for what
    /// has an edge.
    pub border: f64,
    /// How surely the normals point outward, from 0, where nothing is known, to 1: that chooses the sign of W.
    pub outward: f64,
    /// The standard deviation of the logarithm of the scale: 0.1 stands for 10 %.
    pub scale_deviation: f64,
    /// The share of the normals' variance by which they disagree with the ellipsoid of the contact's colors; NaN where the colors have no
    /// ellipsoid.
    pub disagreement: f64,
    /// The root mean square of the sines of the contact's slants.
    pub tilt: f64,
    /// The expected median error of the normals in the contact, in radians.
    pub expected_error: f64,
    /// The level of saturation of ofc_relief_params, which ofc_relief_normals() keeps to; zero stands for none that was given.
    pub saturation: f64,
    /// Where the scale comes from, one of OFC_SCALE_*.
    pub scale_source: ofc_scale_source,
    /// 1 where a picture of the plane was given, 0 otherwise.
    pub has_background: i32,
    /// Why there is no relief, one of OFC_NO_RELIEF_*; 0 where there is one.
    pub reason: ofc_no_relief,
    /// Width of the picture.
    pub width: i32,
    /// Height of the picture.
    pub height: i32,
    /// How many cells have no color, lie on the plane, in the skirt, and in the contact. A cell is a square of pixels, some 160 of them
    /// are in the longer side of the picture.
    pub cells: [i32; 4],
    /// Zero.
    pub reserved: u32,
}

plain!(ofc_relief_params, ofc_relief);

/// Zeros.
const NO_RELIEF: ofc_relief = ofc_relief {
    slopes: [0.0; 6],
    plane: [0.0; 45],
    noise: [0.0; 3],
    circulation: 0.0,
    circulation_ratio: 0.0,
    anisotropy: 0.0,
    signal_to_noise: 0.0,
    border: 0.0,
    outward: 0.0,
    scale_deviation: 0.0,
    disagreement: 0.0,
    tilt: 0.0,
    expected_error: 0.0,
    saturation: 0.0,
    scale_source: OFC_SCALE_UNKNOWN,
    has_background: 0,
    reason: 0,
    width: 0,
    height: 0,
    cells: [0; 4],
    reserved: 0,
};

/// The parameters of the core and the level of saturation, if one is set.
impl FromC<ofc_relief_params> for ReliefParams {
    fn from_c(value: ofc_relief_params) -> Result<Self, Refusal> {
        ensure(value.reserved == [0; 3], OFC_STATUS_RESERVED_NOT_ZERO)?;
        let convexity = ofc_core::solve::Convexity::from_c(value.convexity)?;
        let params = Self {
            saturation: saturation(value.saturation)?,
            ball_radius: Some(value.ball_radius).filter(|&radius| radius != 0.0),
            hollow: convexity == ofc_core::solve::Convexity::Hollow,
            seed: value.seed,
        };
        ensure(params.are_valid(), OFC_STATUS_INVALID_PARAMETER)?;
        Ok(params)
    }
}

/// A relief of a picture of this size, as C has it.
fn to_c(found: &Relief, [width, height]: [usize; 2]) -> ofc_relief {
    let [[a, b, c], [d, e, f]] = found.w;
    let mut plane = [0.0; 45];
    for (entry, value) in plane.iter_mut().zip(found.plane.coefficients.iter().flatten()) {
        *entry = *value;
    }
    ofc_relief {
        slopes: [a, b, c, d, e, f],
        plane,
        noise: found.noise,
        circulation: found.circulation,
        circulation_ratio: found.circulation_ratio,
        anisotropy: found.anisotropy,
        signal_to_noise: found.signal_to_noise,
        border: found.border,
        outward: found.outward,
        scale_deviation: found.scale_deviation,
        disagreement: found.disagreement.unwrap_or(f64::NAN),
        tilt: found.tilt,
        expected_error: found.expected_error(),
        saturation: found.saturation.map_or(0.0, f64::from),
        scale_source: found.scale_source.to_c(),
        has_background: found.has_background.to_c(),
        reason: 0,
        width: width.to_c(),
        height: height.to_c(),
        cells: found.cells.map(|count| count.to_c()),
        reserved: 0,
    }
}

/// Back from C, where everything that normals need is finite.
impl FromC<ofc_relief> for Relief {
    fn from_c(value: ofc_relief) -> Result<Self, Refusal> {
        ensure(value.reserved == 0, OFC_STATUS_RESERVED_NOT_ZERO)?;
        ensure(value.reason == 0 && value.width > 0, OFC_STATUS_NOT_SOLVED)?;
        let numbers = value.slopes.iter().chain(&value.plane).chain(&value.noise);
        let others = [value.scale_deviation, value.tilt, value.circulation];
        ensure(numbers.chain(&others).all(|number| number.is_finite()), OFC_STATUS_INVALID_PARAMETER)?;
        let grid = Grid::of(dimension(value.width), dimension(value.height));
        let (rows, _) = value.slopes.as_chunks::<3>();
        let mut w = [[0.0; 3]; 2];
        for (row, given) in w.iter_mut().zip(rows) {
            *row = *given;
        }
        let mut plane = Polynomial::default();
        for (entry, given) in plane.coefficients.iter_mut().flatten().zip(value.plane) {
            *entry = given;
        }
        Ok(Self {
            w,
            plane,
            has_background: bool::from_c(value.has_background)?,
            saturation: saturation(value.saturation)?,
            grid: grid.ok_or(OFC_STATUS_INVALID_PARAMETER)?,
            noise: value.noise,
            cells: [0; 4],
            circulation: value.circulation,
            circulation_ratio: value.circulation_ratio,
            anisotropy: value.anisotropy,
            signal_to_noise: value.signal_to_noise,
            border: value.border,
            outward: value.outward,
            scale_source: ScaleSource::from_c(value.scale_source)?,
            scale_deviation: value.scale_deviation,
            disagreement: Some(value.disagreement).filter(|share| share.is_finite()),
            tilt: value.tilt,
        })
    }
}

/// The reason, where the picture shows no relief; otherwise the status of the refusal.
pub(crate) fn reason(error: ReliefError) -> Result<ofc_no_relief, Refusal> {
    match error {
        ReliefError::NothingTouched => Ok(OFC_NO_RELIEF_UNTOUCHED),
        ReliefError::NoMajority => Ok(OFC_NO_RELIEF_NO_PLANE),
        ReliefError::NotDetermined => Ok(OFC_NO_RELIEF_NOT_DETERMINED),
        ReliefError::NotIntegrable => Ok(OFC_NO_RELIEF_NOT_INTEGRABLE),
        ReliefError::HasEdge => Ok(OFC_NO_RELIEF_EDGE),
        ReliefError::Params | ReliefError::Size => Err(Refusal(OFC_STATUS_INVALID_PARAMETER)),
        ReliefError::TooSmall => Err(Refusal(OFC_STATUS_EMPTY)),
        ReliefError::Workspace(_) => Err(Refusal(OFC_STATUS_WORKSPACE_TOO_SMALL)),
        ReliefError::TooFewPixels => Err(Refusal(OFC_STATUS_TOO_FEW_PIXELS)),
    }
}

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_relief_params_default(params: *mut ofc_relief_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = ofc_relief_params {
            saturation: 0.0,
            ball_radius: 0.0,
            seed: 0,
            convexity: OFC_CONVEXITY_AUTO,
            reserved: [0; 3],
        };
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_relief_solve() needs: 36 for each cell of the picture, at most 2.1 MB.
/// @param width,height  Size of the picture, at least 32 pixels and less than about five times as long as wide.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_relief_workspace_size(width: i32, height: i32) -> usize {
    let large = pixel_count(width, height) > 0;
    relief::need(dimension(width), dimension(height)).filter(|_| large).map_or(0, bytes)
}

/// Finds the plane that most of a picture shows, and what turns colors into the normals of the relief on it.
///
/// Call it for the whole frames of a tactile sensor, a dent in a plate, a coin: where most of the picture is one flat, uniformly colored
/// surface. ofc_solve() refuses such a picture where it is not that of a matte surface around black, as no gel is. Lights may be near,
/// no mask is needed, and spots that are dark in all channels, as the markers of a gel, are left out.
/// @param image  The picture.
/// @param background  A picture of the plane alone, of the same size; NULL to estimate the plane from the picture itself.
/// @param params  The parameters.
/// @param workspace  ofc_relief_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param classes  Output: width x height bytes, rows without gaps: one of OFC_RELIEF_* for each pixel.
/// @param relief  Output: the relief.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_RELIEF with the reason in `relief`, whose other fields are zero, and `classes` untouched;
///     OFC_STATUS_EMPTY for a picture that is too small; OFC_STATUS_TOO_FEW_PIXELS; an argument status.
///
/// Stack: below 16 KiB. Reference: docs/relief.md.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_relief_solve(
    image: *const ofc_image,
    background: *const ofc_image,
    params: *const ofc_relief_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    classes: *mut ofc_relief_class,
    relief: *mut ofc_relief,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let background = unless_null(background, || call.image(background))?;
        let params: ReliefParams = call.params(params)?;
        let size = size(&picture);
        let [width, height] = size;
        let need = relief::need(width, height).ok_or(OFC_STATUS_EMPTY)?;
        let workspace = call.arena(workspace, workspace_bytes, need)?;
        let classes = call.output_slice(classes, width * height)?;
        let out = call.output(relief)?;
        match relief::estimate(&picture, background.as_ref(), &params, workspace, classes) {
            Ok(found) => {
                *out = to_c(&found, size);
                Ok(OFC_STATUS_OK)
            }
            Err(error) => {
                let reason = reason(error)?;
                *out = ofc_relief { reason, ..NO_RELIEF };
                Ok(OFC_STATUS_NO_RELIEF)
            }
        }
    })
}

/// Computes the unit normals of a relief, and how sure each of them is. The picture may be another one of the same plane under the same
/// lights, with the classes of its own.
/// @param image  The picture.
/// @param background  The picture of the plane where ofc_relief_solve() had one, and NULL where it had none.
/// @param relief  What ofc_relief_solve() found.
/// @param classes  Its classes, width x height bytes.
/// @param normals  Output: height rows of width (n1, n2, n3) floats: (0, 0, 1) on the plane, NaN where there is no usable color.
/// @param normals_stride_bytes  Bytes from one row to the next, a multiple of 4.
/// @param uncertainty  Output: height rows of width floats, the standard deviation of the angle in radians: 0 on the plane, NaN where
///     there is no normal. NULL where it is not wanted.
/// @param uncertainty_stride_bytes  Bytes from one row to the next, a multiple of 4; not read where `uncertainty` is NULL.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED for a struct that holds no relief; an argument status, OFC_STATUS_INVALID_PARAMETER for
///     a picture of another size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_relief_normals(
    image: *const ofc_image,
    background: *const ofc_image,
    relief: *const ofc_relief,
    classes: *const ofc_relief_class,
    normals: *mut f32,
    normals_stride_bytes: usize,
    uncertainty: *mut f32,
    uncertainty_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let background = unless_null(background, || call.image(background))?;
        let given = call.input(relief)?;
        let size = size(&picture);
        let [width, height] = size;
        let found = Relief::from_c(given)?;
        ensure([dimension(given.width), dimension(given.height)] == size, OFC_STATUS_INVALID_PARAMETER)?;
        let classes = call.input_slice(classes, width * height)?;
        let normals = call.output_rows(normals, size, 3, normals_stride_bytes)?;
        let deviations =
            unless_null(uncertainty, || call.output_rows(uncertainty, size, 1, uncertainty_stride_bytes))?;
        let write = normals_writer(normals, deviations);
        relief::normals(&picture, background.as_ref(), &found, classes, write)
            .map_err(|_| OFC_STATUS_INVALID_PARAMETER)?;
        Ok(OFC_STATUS_OK)
    })
}

/// Writes normals and, where they are wanted, their deviations into rows: each with how many values lie from a row to the next.
pub(crate) fn normals_writer<'a>(
    (normals, stride): (&'a mut [f32], usize),
    mut deviations: Option<(&'a mut [f32], usize)>,
) -> impl FnMut(usize, usize, [f32; 3], f32) + 'a {
    move |x, y, normal, deviation| {
        let slot = normals.get_mut(y * stride + 3 * x..).and_then(<[f32]>::first_chunk_mut);
        if let Some(slot) = slot {
            *slot = normal;
        }
        if let Some((deviations, stride)) = &mut deviations
            && let Some(slot) = deviations.get_mut(y * *stride + x)
        {
            *slot = deviation;
        }
    }
}
