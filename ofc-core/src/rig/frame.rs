//! A frame is added to a rig.

use super::ball::{Ball, BallsMut};
use super::sums::Rig;
use crate::math::arena::Arena;
use crate::math::mat3::{self, Mat3};
use crate::orientation::relief::{
    CIRCULATION, Inner, LARGEST_DISAGREEMENT, LEAST_DEVIATION, Least, Memory, ReliefError, Survey, arms,
    distances, survey,
};
use crate::picture::Image;
use libm::sqrt;

/// A frame, and what is known of it.
pub struct Frame<'a> {
    /// The picture.
    pub image: &'a Image<'a>,
    /// The same without a contact; `None` to take the plane from the picture itself.
    pub background: Option<&'a Image<'a>>,
    /// A pixel is saturated if a channel is at or above this; `None` for the largest value of the pixel type, and no limit for f32.
    pub saturation: Option<f32>,
    /// Fixes every random choice.
    pub seed: u64,
}

/// Adds a frame, and the ball that is pressed in where `ball` says so. Writes the class of every pixel, see
/// [`PixelClass`](crate::orientation::relief::PixelClass), where `classes` are wanted.
///
/// # Scratch
/// What [`need`](crate::orientation::relief::need) says.
///
/// # Errors
/// See [`ReliefError`]; nothing is added or written then.
pub fn add(
    rig: &mut Rig,
    frame: &Frame,
    ball: Option<(BallsMut, Ball)>,
    workspace: Arena,
    classes: Option<&mut [u8]>,
) -> Result<(), ReliefError> {
    let Frame { image, background, saturation, seed } = *frame;
    let (width, height) = (image.width(), image.height());
    if [width, height] != [rig.width, rig.height]
        || classes.as_ref().is_some_and(|classes| classes.len() != width * height)
    {
        return Err(ReliefError::Size);
    }
    if ball.as_ref().is_some_and(|(_, ball)| !ball.is_valid()) {
        return Err(ReliefError::Params);
    }
    let mut survey = survey(image, background, saturation, None, workspace)?;
    survey.check()?;
    let circulation = survey.circulation();
    let energy = trace(&circulation.energy);
    let least = circulation.least().filter(|_| energy > 0.0).ok_or(ReliefError::NotDetermined)?;
    let is_integrable = least.circulation <= CIRCULATION;
    if !is_integrable {
        return Err(ReliefError::NotIntegrable);
    }
    let Memory { classes: states, other, .. } = &mut survey.memory;
    distances(&survey.grid, states, other);
    if let Some((mut balls, ball)) = ball {
        balls.add(&mut survey, &ball, least.w).ok_or(ReliefError::NotDetermined)?;
    }
    let contact = contact_of(&survey, &least);
    for (sums, values) in rig.circulation.iter_mut().zip(&circulation.squares) {
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / energy);
    }
    add_scaled(&mut rig.energy, &circulation.energy, 1.0 / energy);
    add_scaled(&mut rig.contact, &contact, 1.0);
    outward(rig, &survey, &least, energy);
    bend(rig, &mut survey, &least, &contact, seed);
    for (sum, deviation) in rig.noise.iter_mut().zip(survey.noise) {
        *sum += deviation * deviation;
    }
    for (sum, value) in
        rig.plane.coefficients.iter_mut().flatten().zip(survey.plane.coefficients.iter().flatten())
    {
        *sum += value;
    }
    cover(rig, &survey);
    rig.frames = rig.frames.saturating_add(1);
    if let Some(classes) = classes {
        survey.write(width, classes);
    }
    Ok(())
}

/// The contact of a survey, with slopes by `w`.
fn inner_of<'s>(survey: &'s Survey, w: [[f64; 3]; 2]) -> Inner<'s> {
    let Memory { color: [red, green, blue], classes, other, .. } = &survey.memory;
    Inner { grid: &survey.grid, delta: [red, green, blue], classes, distances: other, w }
}

/// The mean squares and products of the relative colors in the contact.
fn contact_of(survey: &Survey, least: &Least) -> Mat3 {
    let inner = inner_of(survey, least.w);
    let (mut moments, mut count) = ([[0.0; 3]; 3], 0.0);
    for cell in inner.contact() {
        let delta = inner.delta(cell);
        for (row, factor) in moments.iter_mut().zip(delta) {
            row.iter_mut().zip(delta).for_each(|(entry, value)| *entry += factor * value);
        }
        count += 1.0;
    }
    moments.map(|row| mat3::scale(row, 1.0 / f64::max(count, 1.0)))
}

/// Adds which way is out.
fn outward(rig: &mut Rig, survey: &Survey, least: &Least, energy: f64) {
    let inner = inner_of(survey, least.w);
    let (mut sums, mut squares) = ([[0.0; 3]; 2], 0.0);
    arms(
        &survey.grid,
        |cell| inner.is_contact(cell),
        |cell, component, arm| {
            for row in sums.iter_mut().skip(component).take(1) {
                row.iter_mut().zip(inner.delta(cell)).for_each(|(sum, value)| *sum += arm * value);
            }
            squares += arm * arm;
        },
    );
    let weight = 1.0 / sqrt(f64::max(squares * energy, f64::MIN_POSITIVE));
    for (row, values) in rig.outward.iter_mut().zip(sums) {
        row.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
    }
}

/// Adds the scale that the bend of the colors of the inner contact gives, as the tilt that the contact has.
fn bend(rig: &mut Rig, survey: &mut Survey, least: &Least, contact: &Mat3, seed: u64) {
    let Survey { grid, memory, .. } = survey;
    let Memory { color: [red, green, blue], plane, scratch, classes, other } = memory;
    let inner = Inner { grid, delta: [red, green, blue], classes, distances: other, w: least.w };
    let found = inner.of_colors(plane, scratch, seed);
    if let Some(scale) = found.filter(|scale| scale.disagreement <= LARGEST_DISAGREEMENT) {
        let tilt_square = scale.factor * scale.factor * form(contact, &least.w);
        let weight = 1.0 / (scale.disagreement + LEAST_DEVIATION * LEAST_DEVIATION);
        if tilt_square > 0.0 {
            add_scaled(&mut rig.bend, contact, weight / tilt_square);
            rig.bend_weight += weight;
        }
    }
}

/// Counts the cells of the contact in each ninth of the frame.
fn cover(rig: &mut Rig, survey: &Survey) {
    let inner = inner_of(survey, [[0.0; 3]; 2]);
    for cell in inner.contact() {
        let [column, row] = survey.grid.place(cell);
        let third = |along: usize, count: usize| (3 * along).checked_div(count).unwrap_or(0);
        let (x, y) = (third(column, survey.grid.width), third(row, survey.grid.height));
        rig.coverage.iter_mut().skip(3 * y + x).take(1).for_each(|count| {
            *count = count.saturating_add(1);
        });
    }
}

/// The sum of u^T m u and v^T m v for the rows u and v of w.
pub(super) fn form(m: &Mat3, w: &[[f64; 3]; 2]) -> f64 {
    w.iter().map(|row| mat3::dot(*row, mat3::apply(m, *row))).sum()
}

fn trace([[a, ..], [_, b, _], [.., c]]: &Mat3) -> f64 {
    a + b + c
}

fn add_scaled(sums: &mut Mat3, values: &Mat3, factor: f64) {
    for (sum, value) in sums.iter_mut().flatten().zip(values.iter().flatten()) {
        *sum += factor * value;
    }
}
