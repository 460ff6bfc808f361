//! A rig: camera, lights and surface stay, and frames of what is pressed in add up.

use crate::prelude::*;
use crate::relief::{
    OFC_SCALE_UNKNOWN, ofc_no_relief, ofc_relief_class, ofc_relief_params, ofc_scale_source, reason,
};
use ofc_core::orientation::relief::{self, Polynomial, ReliefError, ReliefParams, ScaleSource};
use ofc_core::rig::{self, Advice, Ball, Balls, BallsMut, Frame, Model, Order, PACKED, Rig, SIDES, TERMS};

/// What would make a rig's model better, most: one of OFC_RIG_ADVICE_*.
pub type ofc_rig_advice = i32;
/// Nothing that is known.
pub const OFC_RIG_ADVICE_NONE: i32 = 0;
/// More contacts, of things that are round rather than long.
pub const OFC_RIG_ADVICE_CONTACTS: i32 = 1;
/// A ball of known radius, or the scale.
pub const OFC_RIG_ADVICE_SCALE: i32 = 2;
/// Contacts in the part of the frame that has none: `region` of the model.
pub const OFC_RIG_ADVICE_REGION: i32 = 3;

constants!(Advice = {
    Nothing: OFC_RIG_ADVICE_NONE,
    Contacts: OFC_RIG_ADVICE_CONTACTS,
    Scale: OFC_RIG_ADVICE_SCALE,
    Region: OFC_RIG_ADVICE_REGION,
});

/// What frames without labels say of a rig: sums, below 1 KiB for any number of frames. Made by ofc_rig_init(); plain numbers, which
/// may be copied.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_rig {
    /// Sums of squared circulations around windows, 6 x 6.
    pub circulation: [f64; 36],
    /// Sums of the energy of the relative colors, 3 x 3.
    pub energy: [f64; 9],
    /// Sums of the relative colors times how far a cell is from the middle of its contact, 2 x 3: which way is out.
    pub outward: [f64; 6],
    /// Sums of the mean squares and products of the relative colors in the contacts, 3 x 3.
    pub contact: [f64; 9],
    /// The weighted sum of these over the squared tilts that the bend of the colors gives, 3 x 3.
    pub bend: [f64; 9],
    /// The sum of these weights: the reciprocal variance of the scale's logarithm.
    pub bend_weight: f64,
    /// Sums of the squared noise of each channel of a cell.
    pub noise: [f64; 3],
    /// The sum of the polynomials of the plane, as in ofc_relief.
    pub plane: [f64; 45],
    /// The scale that was set, as the Frobenius norm of the constant terms of the slopes; 0 where none was.
    pub scale: f64,
    /// The standard deviation of its logarithm.
    pub scale_deviation: f64,
    /// Cells of contact in each ninth of the frame, row by row from the top left.
    pub coverage: [u32; 9],
    /// Width of the frames.
    pub width: i32,
    /// Height of the frames.
    pub height: i32,
    /// How many frames with a contact were added.
    pub frames: u32,
}

/// What balls of known radius say of a rig: sums, below 13 KiB for any number of balls. Made by ofc_rig_init(); plain numbers, which may be
/// copied.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_rig_balls {
    /// Sums of the covariances of the 54 terms, the lower triangle row by row.
    pub products: [f64; 1485],
    /// Sums of the covariances of the terms and both slopes, 2 x 54.
    pub sides: [f64; 108],
    /// The sum of the variances of both slopes.
    pub squares: f64,
    /// How many balls were added.
    pub count: u32,
    /// How many of them had a known center.
    pub centers: u32,
}

const _: () = assert!(
    size_of::<ofc_rig>() <= 1024
        && size_of::<ofc_rig_balls>() <= 13 * 1024
        && PACKED == 1485
        && SIDES == 108
        && TERMS == 54
);

/// A solved rig: what turns the colors of any of its frames into normals. Made by ofc_rig_solve().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_rig_model {
    /// W, 2 x 54 and row-major: (n1, n2) = W phi. With delta the color of a pixel divided by that of the plane, less 1, phi is delta times
    /// each of 1, x, y, x^2, xy, y^2, three terms after three, and then the products rr, rg, rb, gg, gb, bb of delta times each of them. x goes
    /// from -1 to 1 across the frame and y from -1 to 1 down. What is beyond `terms` is zero.
    pub slopes: [f64; 108],
    /// The color of the plane, as in ofc_relief; where frames have a background it tells dark spots only.
    pub plane: [f64; 45],
    /// The standard deviation of each channel of a cell of the plane, relative to its color.
    pub noise: [f64; 3],
    /// The mean squared circulation that a constant W leaves in all frames, relative to the energy of the slopes.
    pub circulation: f64,
    /// The circulation relative to that of the second best W: near 1 where the frames do not determine it.
    pub circulation_ratio: f64,
    /// The correlation between the slopes and how far they are from the middle of their contacts: above 0.5 for things that are pressed in.
    pub outward: f64,
    /// The standard deviation of the logarithm of the scale: 0.1 stands for 10 %.
    pub scale_deviation: f64,
    /// The share of the slopes' variance that W misses: of the balls where there are some, otherwise the circulation.
    pub disagreement: f64,
    /// The root mean square of the sines of the contacts' slants.
    pub tilt: f64,
    /// The expected median error of the normals in a contact, in radians.
    pub expected_error: f64,
    /// The level of saturation; zero stands for none that was given.
    pub saturation: f64,
    /// How many terms W has: 3, 18 or 54.
    pub terms: i32,
    /// Where the scale comes from, one of OFC_SCALE_*.
    pub scale_source: ofc_scale_source,
    /// What would help most, one of OFC_RIG_ADVICE_*.
    pub advice: ofc_rig_advice,
    /// The ninth of the frame that has fewest contacts: 0 to 8, row by row from the top left.
    pub region: i32,
    /// How many frames it was made of.
    pub frames: u32,
    /// How many balls it was made of.
    pub balls: u32,
    /// Width of the frames.
    pub width: i32,
    /// Height of the frames.
    pub height: i32,
}

plain!(ofc_rig, ofc_rig_balls, ofc_rig_model);

/// Matrices row by row, or column by column, as arrays without structure, and back.
fn flat<const N: usize>(values: impl Iterator<Item = f64>) -> [f64; N] {
    let mut flat = [0.0; N];
    flat.iter_mut().zip(values).for_each(|(entry, value)| *entry = value);
    flat
}

fn nested<const N: usize, const M: usize>(values: &[f64]) -> [[f64; N]; M] {
    let mut nested = [[0.0; N]; M];
    nested.iter_mut().flatten().zip(values).for_each(|(entry, value)| *entry = *value);
    nested
}

impl ToC<ofc_rig> for Rig {
    fn to_c(&self) -> ofc_rig {
        ofc_rig {
            circulation: flat(self.circulation.iter().flatten().copied()),
            energy: flat(self.energy.iter().flatten().copied()),
            outward: flat(self.outward.iter().flatten().copied()),
            contact: flat(self.contact.iter().flatten().copied()),
            bend: flat(self.bend.iter().flatten().copied()),
            bend_weight: self.bend_weight,
            noise: self.noise,
            plane: flat(self.plane.coefficients.iter().flatten().copied()),
            scale: self.scale,
            scale_deviation: self.scale_deviation,
            coverage: self.coverage,
            width: self.width.to_c(),
            height: self.height.to_c(),
            frames: self.frames,
        }
    }
}

impl FromC<ofc_rig> for Rig {
    fn from_c(value: ofc_rig) -> Result<Self, Refusal> {
        let rig = Self {
            width: dimension(value.width),
            height: dimension(value.height),
            frames: value.frames,
            circulation: nested(&value.circulation),
            energy: nested(&value.energy),
            outward: nested(&value.outward),
            contact: nested(&value.contact),
            bend: nested(&value.bend),
            bend_weight: value.bend_weight,
            noise: value.noise,
            plane: Polynomial { coefficients: nested(&value.plane) },
            scale: value.scale,
            scale_deviation: value.scale_deviation,
            coverage: value.coverage,
        };
        ensure(rig.is_valid() && pixel_count(value.width, value.height) > 0, OFC_STATUS_INVALID_PARAMETER)?;
        Ok(rig)
    }
}

/// The core's view of sums over balls.
fn balls_of(balls: &ofc_rig_balls) -> Result<Balls<'_>, Refusal> {
    let ofc_rig_balls { products, sides, squares, count, centers } = balls;
    let balls = Balls { count: *count, centers: *centers, products, sides, squares: *squares };
    ensure(balls.are_valid(), OFC_STATUS_INVALID_PARAMETER)?;
    Ok(balls)
}

/// The core's view of sums over balls that grow.
fn growing_balls(balls: &mut ofc_rig_balls) -> Result<BallsMut<'_>, Refusal> {
    balls_of(balls)?;
    let ofc_rig_balls { products, sides, squares, count, centers } = balls;
    Ok(BallsMut { count, centers, products, sides, squares })
}

impl<'a> Call<'a> {
    /// Sums over balls where there are some, which the call reads in place: they are large.
    fn balls(&mut self, balls: *const ofc_rig_balls) -> Result<Option<Balls<'a>>, Refusal> {
        let balls = unless_null(balls, || self.input_slice(balls, 1))?;
        balls.and_then(<[_]>::first).map(balls_of).transpose()
    }
}

impl ToC<ofc_rig_model> for Model {
    fn to_c(&self) -> ofc_rig_model {
        ofc_rig_model {
            slopes: flat(self.w.iter().flatten().copied()),
            plane: flat(self.plane.coefficients.iter().flatten().copied()),
            noise: self.noise,
            circulation: self.circulation,
            circulation_ratio: self.circulation_ratio,
            outward: self.outward,
            scale_deviation: self.scale_deviation,
            disagreement: self.disagreement,
            tilt: self.tilt,
            expected_error: self.expected_error(),
            saturation: self.saturation.map_or(0.0, f64::from),
            terms: self.order.len().to_c(),
            scale_source: self.scale_source.to_c(),
            advice: self.advice.to_c(),
            region: self.region.to_c(),
            frames: self.frames,
            balls: self.balls,
            width: self.width.to_c(),
            height: self.height.to_c(),
        }
    }
}

impl FromC<ofc_rig_model> for Model {
    fn from_c(value: ofc_rig_model) -> Result<Self, Refusal> {
        let orders = [Order::Constant, Order::Place, Order::Products];
        let order = orders.into_iter().find(|order| order.len() == dimension(value.terms));
        ensure(order.is_some() || value.terms != 0, OFC_STATUS_NOT_SOLVED)?;
        let model = Self {
            width: dimension(value.width),
            height: dimension(value.height),
            order: order.ok_or(OFC_STATUS_INVALID_PARAMETER)?,
            w: nested(&value.slopes),
            plane: Polynomial { coefficients: nested(&value.plane) },
            noise: value.noise,
            saturation: saturation(value.saturation)?,
            frames: value.frames,
            balls: value.balls,
            circulation: value.circulation,
            circulation_ratio: value.circulation_ratio,
            outward: value.outward,
            scale_source: ScaleSource::from_c(value.scale_source)?,
            scale_deviation: value.scale_deviation,
            disagreement: value.disagreement,
            tilt: value.tilt,
            advice: Advice::from_c(value.advice)?,
            region: dimension(value.region),
        };
        ensure(model.is_valid() && pixel_count(value.width, value.height) > 0, OFC_STATUS_INVALID_PARAMETER)?;
        Ok(model)
    }
}

/// The status of what the core refuses, where it is not a reason why there is no relief.
pub(crate) fn rig_refusal(error: ReliefError) -> Refusal {
    reason(error).map_or_else(|refusal| refusal, |_| Refusal(OFC_STATUS_NO_RELIEF))
}

/// Begins a rig for frames of this size.
/// @param width,height  Size of the frames, as for ofc_relief_workspace_size().
/// @param rig  Output: the rig without frames.
/// @param balls  Output: sums without balls; NULL where no ball will be added.
/// @return OFC_STATUS_OK; OFC_STATUS_EMPTY for frames that are too small; OFC_STATUS_TOO_LARGE; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_init(
    width: i32,
    height: i32,
    rig: *mut ofc_rig,
    balls: *mut ofc_rig_balls,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let rig = call.output(rig)?;
        let balls = unless_null(balls, || call.output(balls))?;
        checked_pixel_count(width, height)?;
        *rig = Rig::new(dimension(width), dimension(height)).ok_or(OFC_STATUS_EMPTY)?.to_c();
        if let Some(balls) = balls {
            balls.products.fill(0.0);
            balls.sides.fill(0.0);
            (balls.squares, balls.count, balls.centers) = (0.0, 0, 0);
        }
        Ok(OFC_STATUS_OK)
    })
}

/// Adds a frame to a rig, and to `balls` where a ball of known radius is pressed in.
///
/// A frame without a contact, or whose contact is not one of a relief, adds nothing. Markers and other spots that are dark in all
/// channels are left out.
/// @param rig  The rig; changed with OFC_STATUS_OK alone.
/// @param balls  The sums over balls; changed with OFC_STATUS_OK alone. NULL unless `params` has a ball's radius.
/// @param image  The frame.
/// @param background  A frame of the same rig without a contact; NULL to take the plane from the frame itself.
/// @param params  `saturation`, `seed`, and `ball_radius`: the radius in pixels of the one ball that is pressed in, or 0. The convexity is
///     not used.
/// @param center  Where the ball's center is: x and y in pixels, y downward, from the middle of the top left pixel. NULL where that is not
///     known, or there is no ball.
/// @param workspace  ofc_relief_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param classes  Output: width x height bytes, rows without gaps: one of OFC_RELIEF_* for each pixel. NULL where they are not wanted.
/// @param no_relief  Output: why the frame adds nothing, one of OFC_NO_RELIEF_*, and 0 where it adds something. NULL where that is not
///     wanted.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_RELIEF where the frame adds nothing, with the reason; OFC_STATUS_TOO_FEW_PIXELS; an argument status,
///     OFC_STATUS_INVALID_PARAMETER for a frame of another size and for a ball without `balls`.
///
/// Stack: below 17 KiB. Reference: docs/rig.md.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_add(
    rig: *mut ofc_rig,
    balls: *mut ofc_rig_balls,
    image: *const ofc_image,
    background: *const ofc_image,
    params: *const ofc_relief_params,
    center: *const f64,
    workspace: *mut c_void,
    workspace_bytes: usize,
    classes: *mut ofc_relief_class,
    no_relief: *mut ofc_no_relief,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let rig = call.output(rig)?;
        let balls = unless_null(balls, || call.output(balls))?;
        let image = call.image(image)?;
        let background = unless_null(background, || call.image(background))?;
        let params: ReliefParams = call.params(params)?;
        let center = unless_null(center, || call.input_array::<f64, 2>(center))?;
        let mut sums = Rig::from_c(*rig)?;
        let [width, height] = size(&image);
        ensure([width, height] == [sums.width, sums.height], OFC_STATUS_INVALID_PARAMETER)?;
        let ball = match (params.ball_radius, balls) {
            (Some(radius), Some(balls)) => Some((growing_balls(balls)?, Ball { radius, center })),
            (None, balls) if center.is_none() => {
                balls.map(growing_balls).transpose()?;
                None
            }
            _ => return Err(Refusal(OFC_STATUS_INVALID_PARAMETER)),
        };
        let need = relief::need(width, height).ok_or(OFC_STATUS_EMPTY)?;
        let workspace = call.arena(workspace, workspace_bytes, need)?;
        let classes = unless_null(classes, || call.output_slice(classes, width * height))?;
        let no_relief = unless_null(no_relief, || call.output(no_relief))?;
        let frame = Frame {
            image: &image,
            background: background.as_ref(),
            saturation: params.saturation,
            seed: params.seed,
        };
        let (status, why) = match rig::add(&mut sums, &frame, ball, workspace, classes) {
            Ok(()) => {
                *rig = sums.to_c();
                (OFC_STATUS_OK, 0)
            }
            Err(error) => (OFC_STATUS_NO_RELIEF, reason(error)?),
        };
        if let Some(no_relief) = no_relief {
            *no_relief = why;
        }
        Ok(status)
    })
}

/// Adds the frames and the balls of another rig of the same sensor. A scale that was set there counts where none was set here.
/// @param rig  The rig; changed.
/// @param balls  Its balls, changed; NULL where there are none, and `other_balls` is NULL.
/// @param other  The other rig.
/// @param other_balls  Its balls; NULL where there are none.
/// @return OFC_STATUS_OK; an argument status, OFC_STATUS_INVALID_PARAMETER for frames of another size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_merge(
    rig: *mut ofc_rig,
    balls: *mut ofc_rig_balls,
    other: *const ofc_rig,
    other_balls: *const ofc_rig_balls,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let rig = call.output(rig)?;
        let balls = unless_null(balls, || call.output(balls))?;
        let other: Rig = call.params(other)?;
        let other_balls = call.balls(other_balls)?;
        ensure(other_balls.is_none() || balls.is_some(), OFC_STATUS_NULL_POINTER)?;
        let mut sums = Rig::from_c(*rig)?;
        let balls = balls.map(growing_balls).transpose()?;
        sums.merge(&other).ok_or(OFC_STATUS_INVALID_PARAMETER)?;
        if let (Some(mut balls), Some(other)) = (balls, other_balls) {
            balls.merge(&other);
        }
        *rig = sums.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Sets the scale of a rig from something whose height is known: `factor` is the true height over the one that `model` gave it. Where balls are
/// used it does not count.
/// @param rig  The rig; changed.
/// @param model  What ofc_rig_solve() made of it.
/// @param factor  By how much the slopes of the model are too flat, positive.
/// @param deviation  The standard deviation of its logarithm: 0.1 stands for 10 %. Not negative.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_set_scale(
    rig: *mut ofc_rig,
    model: *const ofc_rig_model,
    factor: f64,
    deviation: f64,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let rig = call.output(rig)?;
        let model: Model = call.params(model)?;
        let mut sums = Rig::from_c(*rig)?;
        ensure(factor > 0.0 && factor.is_finite(), OFC_STATUS_INVALID_PARAMETER)?;
        ensure(deviation >= 0.0 && deviation.is_finite(), OFC_STATUS_INVALID_PARAMETER)?;
        (sums.scale, sums.scale_deviation) = (factor * model.length(), deviation);
        ensure(sums.is_valid() && sums.scale > 0.0, OFC_STATUS_INVALID_PARAMETER)?;
        *rig = sums.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Solves a rig.
///
/// Without balls W is constant over the frame, and its scale is the one that was set, or that of the bend of the colors where these bend enough.
/// With balls it varies over the frame, held to what all frames say where they say little; ten balls whose centers are known give products of
/// colors as well.
/// @param rig  The rig.
/// @param balls  Its balls; NULL to use none.
/// @param params  `saturation` for the frames to come, and `convexity` as in ofc_relief_params.
/// @param model  Output: the model.
/// @return OFC_STATUS_OK; OFC_STATUS_SCALE_UNKNOWN with a model whose slopes and depths are right up to a factor, for which a usual one stands
///     in; OFC_STATUS_NO_RELIEF, with `model` untouched, where no frame was added or the frames contradict each other;
///     OFC_STATUS_UNDETERMINED, with `model` untouched, where more contacts are needed; an argument status.
///
/// Stack: below 44 KiB. Reference: docs/rig.md.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_solve(
    rig: *const ofc_rig,
    balls: *const ofc_rig_balls,
    params: *const ofc_relief_params,
    model: *mut ofc_rig_model,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let rig: Rig = call.params(rig)?;
        let balls = call.balls(balls)?;
        let params: ReliefParams = call.params(params)?;
        let out = call.output(model)?;
        let model = match rig::solve(&rig, balls.as_ref(), params.saturation, params.hollow) {
            Ok(model) => model,
            Err(ReliefError::NotDetermined) => return Ok(OFC_STATUS_UNDETERMINED),
            Err(error) => return Err(rig_refusal(error)),
        };
        *out = model.to_c();
        let is_known = out.scale_source != OFC_SCALE_UNKNOWN;
        Ok(if is_known { OFC_STATUS_OK } else { OFC_STATUS_SCALE_UNKNOWN })
    })
}
