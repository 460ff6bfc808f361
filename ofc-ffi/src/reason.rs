//! Why a picture is refused or its answer doubted, in words.

use crate::prelude::*;
use core::ffi::c_char;
use ofc_core::solve::{self, Params, Reason, reason};

/// What a refusal or a doubt comes from: one of OFC_REASON_*, whose numbers are never reused.
///
/// A status says how far ofc_solve() came, a reason why it came no farther, or why its answer is to be doubted.
/// ofc_reason_message() says it in words, ofc_reason_advice() what to try; `reason_value` and `reason_limit` of the
/// solution are the numbers behind it, as said for each.
pub type ofc_reason = i32;
/// There is nothing to doubt. Streams do not look for reasons, and have this one always.
pub const OFC_REASON_NONE: i32 = 0;
/// No cause was found for the refusal.
pub const OFC_REASON_UNKNOWN: i32 = 1;

/// The mask leaves no pixels, or too few: that many, and how many a fit needs.
pub const OFC_REASON_MASK_EMPTY: i32 = 10;
/// The mask leaves the background and leaves out what looks like the object: it is inverted. The ratio of the first and
/// the last column that it leaves, above its limit.
pub const OFC_REASON_MASK_INVERTED: i32 = 11;
/// There are too few pixels: for a fit, that many, and how many it needs; or, with OFC_STATUS_OK, to say how sure the
/// orientation is: the number of inliers, and 0.
pub const OFC_REASON_TOO_FEW_PIXELS: i32 = 12;
/// Most pixels are NaN or infinite: their ratio, above its limit.
pub const OFC_REASON_NOT_FINITE: i32 = 13;

/// Most of what is not black is saturated: its ratio, above its limit.
pub const OFC_REASON_SATURATED: i32 = 20;
/// The picture is black: the ratio of black pixels, above its limit; or it has little light in the lowest part of the
/// camera's range: brightness over noise, below its limit.
pub const OFC_REASON_DARK: i32 = 21;
/// The channel `reason_channel` is the same everywhere: its standard deviation over the noise, below its limit.
pub const OFC_REASON_CHANNEL_DEAD: i32 = 22;
/// The channels are equal or proportional, as in a gray picture or under lights of one color: the second deviation of
/// the colors over the noise, below its limit.
pub const OFC_REASON_GRAY: i32 = 23;

/// The colors span two dimensions although the surface bends in both directions: there are two lights, or all of them
/// lie in a plane. The third deviation of the colors over the noise, below its limit.
pub const OFC_REASON_TOO_FEW_LIGHTS: i32 = 30;
/// The lights, or their colors, lie nearly in a plane, and `reason_channel` is the one whose light is to be moved out
/// of it. By how much the noise of a pixel turns its normal in radians, above its limit; or, without F, the third
/// deviation of the colors over the second, below its limit.
pub const OFC_REASON_LIGHTS_COPLANAR: i32 = 31;
/// The surface is a plane whose brightness falls off from the middle of the picture: the ratio of the variance of the
/// brightness that a quadratic function of the place explains, above its limit.
pub const OFC_REASON_VIGNETTE: i32 = 32;

/// The surface is a plane: the standard deviation of the channel that varies most over the noise, below its limit.
pub const OFC_REASON_FLAT: i32 = 40;
/// The surface bends in one direction only, or nearly so, as a cylinder or a groove: how much colors change across the
/// direction of the picture in which they change most, over how much along it, below its limit.
pub const OFC_REASON_CYLINDER: i32 = 41;
/// The surface looks as much hollow as convex: `confidence.convexity`, below its limit.
pub const OFC_REASON_CONVEX_OR_HOLLOW: i32 = 42;

/// There are two paints: the ratio of the steps of the colors that are the same everywhere, above its limit.
pub const OFC_REASON_TWO_PAINTS: i32 = 50;
/// A background of one color was counted as object: the ratio of the pixels that have its color, and 0.
pub const OFC_REASON_BACKGROUND: i32 = 51;
/// Most pixels do not obey the model: the ratio of outliers; or the residuals over what the noise explains; or the
/// noise over the brightness, where pixels are as different from their neighbors as from any other. Above its limit.
pub const OFC_REASON_OUTLIERS: i32 = 52;

constants!(Reason = {
    None: OFC_REASON_NONE,
    Unknown: OFC_REASON_UNKNOWN,
    MaskEmpty: OFC_REASON_MASK_EMPTY,
    MaskInverted: OFC_REASON_MASK_INVERTED,
    TooFewPixels: OFC_REASON_TOO_FEW_PIXELS,
    NotFinite: OFC_REASON_NOT_FINITE,
    Saturated: OFC_REASON_SATURATED,
    Dark: OFC_REASON_DARK,
    ChannelDead: OFC_REASON_CHANNEL_DEAD,
    Gray: OFC_REASON_GRAY,
    TooFewLights: OFC_REASON_TOO_FEW_LIGHTS,
    LightsCoplanar: OFC_REASON_LIGHTS_COPLANAR,
    Vignette: OFC_REASON_VIGNETTE,
    Flat: OFC_REASON_FLAT,
    Cylinder: OFC_REASON_CYLINDER,
    ConvexOrHollow: OFC_REASON_CONVEX_OR_HOLLOW,
    TwoPaints: OFC_REASON_TWO_PAINTS,
    Background: OFC_REASON_BACKGROUND,
    Outliers: OFC_REASON_OUTLIERS,
});

/// A text of C that is a static of its own. Literals share one section, which a firmware that prints a status would carry as a
/// whole.
macro_rules! text {
    ($text:literal) => {{
        const BYTES: &[u8] = concat!($text, "\0").as_bytes();
        static TEXT: [u8; BYTES.len()] = match BYTES.first_chunk() {
            Some(text) => *text,
            None => [0; BYTES.len()],
        };
        text_of(&TEXT)
    }};
}

/// What it is, and what to try.
fn words(reason: ofc_reason) -> [*const c_char; 2] {
    match reason {
        OFC_REASON_NONE => [text!("nothing to doubt"), text!("nothing to do")],
        OFC_REASON_UNKNOWN => [
            text!("no cause was found"),
            text!(
                "compare the picture with what it must be: one matte surface of one color that bends in both directions, under lights of three colors from three directions"
            ),
        ],
        OFC_REASON_MASK_EMPTY => [
            text!("the mask leaves too few pixels"),
            text!("check the mask: pixels that are not zero are used"),
        ],
        OFC_REASON_MASK_INVERTED => [
            text!("the mask leaves the background and leaves out the object"),
            text!("invert the mask: pixels that are not zero are used"),
        ],
        OFC_REASON_TOO_FEW_PIXELS => [
            text!("the picture has too few pixels"),
            text!(
                "take a larger picture of the object; some hundred pixels are enough for an answer, some thousand for how sure it is"
            ),
        ],
        OFC_REASON_NOT_FINITE => [
            text!("most pixels are NaN or infinite"),
            text!("check how the picture was made and its pixel format"),
        ],
        OFC_REASON_SATURATED => [
            text!("most of the object is saturated"),
            text!("shorten the exposure, dim the lights, or lower the gain; mask out a saturated background"),
        ],
        OFC_REASON_DARK => [
            text!("the picture is too dark"),
            text!(
                "expose longer, or bring more light; check the pixel format where the picture is not dark to the eye"
            ),
        ],
        OFC_REASON_CHANNEL_DEAD => [
            text!("a channel is the same everywhere"),
            text!(
                "give each channel a light of its own, and check that no channel was lost when the picture was stored"
            ),
        ],
        OFC_REASON_GRAY => [
            text!("the channels are equal or proportional: a gray picture, or lights of one color"),
            text!(
                "light the object with three colors from three directions, or take three gray pictures, each under another light, as planes"
            ),
        ],
        OFC_REASON_TOO_FEW_LIGHTS => [
            text!("the colors span two dimensions: there are two lights, or all lights lie in a plane"),
            text!("add a third light of another color, outside of the plane of the camera and the other two"),
        ],
        OFC_REASON_LIGHTS_COPLANAR => [
            text!("the lights, or their colors, lie nearly in a plane"),
            text!(
                "move the light of the channel that is named away from the plane of the other two, or take purer colors"
            ),
        ],
        OFC_REASON_VIGNETTE => [
            text!("a flat surface whose brightness falls off from the middle of the picture"),
            text!(
                "divide by a picture of the same surface without the object; a flat surface alone determines nothing"
            ),
        ],
        OFC_REASON_FLAT => [
            text!("the surface is flat"),
            text!(
                "take an object that bends in both directions, or calibrate with a ball: F of another picture serves a flat one too"
            ),
        ],
        OFC_REASON_CYLINDER => [
            text!("the surface bends in one direction only"),
            text!(
                "take an object that bends in both directions, or calibrate with a ball: F of another picture serves a cylinder too"
            ),
        ],
        OFC_REASON_CONVEX_OR_HOLLOW => [
            text!("the surface looks as much hollow as convex"),
            text!("say which it is, with OFC_CONVEXITY_CONVEX or OFC_CONVEXITY_HOLLOW"),
        ],
        OFC_REASON_TWO_PAINTS => [
            text!("there are two paints"),
            text!(
                "mask one of them, or solve each region that ofc_segment() finds; or paint the object with one color"
            ),
        ],
        OFC_REASON_BACKGROUND => [
            text!("a background of one color was counted as object"),
            text!("mask the object, or put it before something black"),
        ],
        OFC_REASON_OUTLIERS => [
            text!("most pixels do not obey the model"),
            text!(
                "mask what is not of the one matte surface: other materials, highlights, texture; check that pixel values are linear"
            ),
        ],
        _ => [text!("unknown reason"), text!("no advice for an unknown reason")],
    }
}

/// Says what a reason means.
/// @param reason  Any number.
/// @return A phrase in static storage; never NULL, not even for numbers that are no reason.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_reason_message(reason: ofc_reason) -> *const c_char {
    let [message, _] = words(reason);
    message
}

/// Says what to try about a reason.
/// @param reason  Any number.
/// @return A phrase in static storage; never NULL, not even for numbers that are no reason.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_reason_advice(reason: ofc_reason) -> *const c_char {
    let [_, advice] = words(reason);
    advice
}

/// Counts the pixels of a picture, and says why where they are too few for a fit: for a picture that ofc_solve() refused
/// with OFC_STATUS_TOO_FEW_PIXELS, OFC_STATUS_DARK or OFC_STATUS_SATURATED, without a solution.
/// @param image  The picture.
/// @param params  The parameters that ofc_solve() was given.
/// @param workspace  ofc_solve_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param counts  Output: what becomes of the pixels; none is counted as shadowed.
/// @param reason  Output: the reason; OFC_REASON_NONE where there are enough pixels.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_pixel_counts_compute(
    image: *const ofc_image,
    params: *const ofc_solve_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    counts: *mut ofc_pixel_counts,
    reason: *mut ofc_reason,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let params: Params = call.params(params)?;
        let need = solve::workspace_len(picture.width() * picture.height(), params.lmeds.sample_size);
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let (counts, reason) = (call.output(counts)?, call.output(reason)?);
        let (found, finding) = reason::of_pixels(&picture, &params, workspace);
        (*counts, *reason) = (found.to_c(), finding.reason.to_c());
        Ok(OFC_STATUS_OK)
    })
}
