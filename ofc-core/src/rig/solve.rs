//! From the sums of a rig to its model.

use super::ball::Balls;
use super::frame::form;
use super::model::{Advice, Model};
use super::sums::Rig;
use super::terms::{Order, TERMS};
use crate::math::cholesky;
use crate::math::mat3::{self, Mat3};
use crate::orientation::relief::{
    ANISOTROPY, CIRCULATION, CIRCULATION_RATIO, ReliefError, ScaleSource, USUAL_DEVIATION, USUAL_TILT,
    WEIGHT, eigenvalues,
};
use libm::{fabs, sqrt};

/// How hard W is held to the one without labels, relative to the energy of the colors of a ball; products of colors are small, and
/// held less.
const RIDGE: f64 = 0.01;
const PRODUCTS_RIDGE: f64 = 0.001;

/// So many balls whose centers are known determine products of colors; without centers no number of balls was seen to.
const FEWEST_CENTERS: u32 = 10;

/// What the bend of the colors says of the scale is not more certain than this, however many frames there are: a gel is no matte surface.
const BEND_DEVIATION: f64 = 0.06;

/// The scale's deviation where one ball gives it, and the least one.
const BALL_DEVIATION: f64 = 0.08;
const LEAST_BALL_DEVIATION: f64 = 0.02;

/// Above this share of the second least circulation, or with fewer frames, more contacts help.
const SURE_RATIO: f64 = 0.12;
const FEWEST_FRAMES: u32 = 3;

/// A rig's model.
///
/// # Errors
/// [`ReliefError::Params`] for numbers that are not finite, [`ReliefError::NothingTouched`] without frames,
/// [`ReliefError::NotDetermined`] or [`ReliefError::NotIntegrable`] where the frames do not determine W.
pub fn solve(
    rig: &Rig,
    balls: Option<&Balls>,
    saturation: Option<f32>,
    hollow: bool,
) -> Result<Model, ReliefError> {
    if !rig.is_valid() || balls.is_some_and(|balls| !balls.are_valid()) {
        return Err(ReliefError::Params);
    }
    if rig.frames == 0 {
        return Err(ReliefError::NothingTouched);
    }
    let frames = f64::from(rig.frames);
    let least = rig.least().ok_or(ReliefError::NotDetermined)?;
    let circulation_ratio = least.circulation / least.second.max(f64::MIN_POSITIVE);
    let (is_integrable, is_distinct) =
        (least.circulation <= CIRCULATION, circulation_ratio <= CIRCULATION_RATIO);
    if !is_integrable {
        return Err(ReliefError::NotIntegrable);
    }
    // The root mean square of the slopes in the contacts becomes 1, and their sign that of what is wanted.
    let mean = form(&rig.contact, &least.w) / frames;
    let outward: f64 = least.w.iter().zip(rig.outward).map(|(row, sums)| mat3::dot(*row, sums)).sum();
    let wanted = if hollow { -1.0 } else { 1.0 };
    let sign = if outward * wanted < 0.0 { -1.0 } else { 1.0 };
    let [smaller, larger] = eigenvalues(moments(&rig.contact, &least.w));
    let both = is_distinct && mean > 0.0 && smaller >= ANISOTROPY * larger;
    if !both {
        return Err(ReliefError::NotDetermined);
    }
    let w = least.w.map(|row| mat3::scale(row, sign / sqrt(mean)));
    let fewest = rig.coverage.iter().enumerate().min_by_key(|(_, cells)| **cells);
    let mut plane = rig.plane;
    plane.coefficients.iter_mut().flatten().for_each(|coefficient| *coefficient /= frames);
    let mut model = Model {
        width: rig.width,
        height: rig.height,
        order: Order::Constant,
        w: [[0.0; TERMS]; 2],
        plane,
        noise: rig.noise.map(|square| sqrt(square / frames)),
        saturation,
        frames: rig.frames,
        balls: 0,
        circulation: least.circulation,
        circulation_ratio,
        outward: fabs(outward) / sqrt(frames * form(&rig.energy, &least.w)).max(f64::MIN_POSITIVE),
        scale_source: ScaleSource::Unknown,
        scale_deviation: USUAL_DEVIATION,
        disagreement: least.circulation,
        tilt: USUAL_TILT,
        advice: Advice::Nothing,
        region: fewest.map_or(0, |(region, _)| region),
    };
    let length = sqrt(w.iter().flatten().fold(0.0, |sum, entry| sum + entry * entry));
    let bend = form(&rig.bend, &w);
    let factor = if rig.scale > 0.0 {
        (model.scale_source, model.scale_deviation) = (ScaleSource::Given, rig.scale_deviation);
        rig.scale / length
    } else if rig.bend_weight > 0.0 && bend > 0.0 {
        (model.scale_source, model.scale_deviation) =
            (ScaleSource::Colors, sqrt(1.0 / rig.bend_weight + BEND_DEVIATION * BEND_DEVIATION));
        sqrt(rig.bend_weight / bend)
    } else {
        USUAL_TILT
    };
    let w = w.map(|row| mat3::scale(row, factor));
    set(&mut model, &w);
    if let Some(balls) = balls.filter(|balls| balls.count > 0) {
        by_balls(rig, balls, &w, &mut model);
    }
    let [u, v] = model.w.each_ref().map(|row| row.first_chunk::<3>().copied().unwrap_or_default());
    model.tilt = sqrt(form(&rig.contact, &[u, v]) / frames).min(1.0);
    model.advice = advice(&model, rig);
    Ok(model)
}

/// The mean squares and products of both slopes.
fn moments(contact: &Mat3, [u, v]: &[[f64; 3]; 2]) -> [[f64; 2]; 2] {
    let (of_u, of_v) = (mat3::apply(contact, *u), mat3::apply(contact, *v));
    [[mat3::dot(*u, of_u), mat3::dot(*u, of_v)], [mat3::dot(*v, of_u), mat3::dot(*v, of_v)]]
}

/// Makes W's constant terms these.
fn set(model: &mut Model, w: &[[f64; 3]; 2]) {
    for (row, values) in model.w.iter_mut().zip(w) {
        row.iter_mut().zip(values).for_each(|(entry, value)| *entry = *value);
    }
}

/// W from balls, which `w`, what the frames say without labels up to its scale, holds where they say little.
fn by_balls(rig: &Rig, balls: &Balls, w: &[[f64; 3]; 2], model: &mut Model) {
    let count = f64::from(balls.count);
    // The scale with which the slopes without labels agree best with those of the balls.
    let (mut products, mut squares) = (0.0, 0.0);
    for (component, row) in w.iter().enumerate() {
        for (i, a) in row.iter().enumerate() {
            products += a * balls.side(component, i);
            squares += row.iter().enumerate().map(|(j, b)| a * b * balls.product(i, j)).sum::<f64>();
        }
    }
    let agree = squares > 0.0 && products > 0.0;
    if !agree {
        return;
    }
    let prior = w.map(|row| mat3::scale(row, products / squares));
    let energy = [0, 1, 2].map(|i| balls.product(i, i)).iter().sum::<f64>();
    let has_centers = balls.centers >= FEWEST_CENTERS && balls.centers.saturating_mul(2) >= balls.count;
    let order = if has_centers { Order::Products } else { Order::Place };
    let solved = if has_centers {
        each_slope(balls, &prior, energy / 3.0)
    } else {
        both_slopes(rig, balls, &prior, energy / 3.0)
    };
    let Some(solved) = solved else { return };
    model.w = solved;
    model.order = order;
    model.balls = balls.count;
    model.scale_source = ScaleSource::Ball;
    model.scale_deviation = (BALL_DEVIATION / sqrt(count)).max(LEAST_BALL_DEVIATION);
    model.disagreement = missed(balls, &model.w, order);
}

/// The share of the variance of the balls' slopes that W misses.
fn missed(balls: &Balls, w: &[[f64; TERMS]; 2], order: Order) -> f64 {
    let total = balls.squares / f64::from((balls.count).max(1));
    let mut rest = total;
    for (component, row) in w.iter().enumerate() {
        for (i, a) in row.iter().enumerate().take(order.len()) {
            let sum: f64 =
                row.iter().enumerate().take(order.len()).map(|(j, b)| b * balls.product(i, j)).sum();
            rest += a * (sum - 2.0 * balls.side(component, i));
        }
    }
    (rest / total.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

/// W as it varies over the frame: what balls say, and that the slopes of all frames have little circulation. Its rows hang together by the
/// circulation.
fn both_slopes(rig: &Rig, balls: &Balls, prior: &[[f64; 3]; 2], energy: f64) -> Option<[[f64; TERMS]; 2]> {
    const EACH: usize = Order::Place.len();
    let (frames, count) = (f64::from(rig.frames), f64::from(balls.count));
    let [[a, ..], [_, b, _], [.., c]] = rig.contact;
    let weight = WEIGHT / frames * (a + b + c) / frames / count;
    let squared = |i: usize, j: usize| {
        let column = rig.circulation.get(3 * (i / EACH) + i % EACH).filter(|_| i % EACH < 3);
        column.and_then(|column| column.get(3 * (j / EACH) + j % EACH).filter(|_| j % EACH < 3)).copied()
    };
    let (mut matrix, mut side) = ([[0.0; 2 * EACH]; 2 * EACH], [0.0; 2 * EACH]);
    for (i, column) in matrix.iter_mut().enumerate() {
        for (j, entry) in column.iter_mut().enumerate() {
            let of_balls = if i / EACH == j / EACH { balls.product(i % EACH, j % EACH) } else { 0.0 };
            let ridge = if i == j { RIDGE * energy } else { 0.0 };
            *entry = weight * squared(i, j).unwrap_or(0.0) + of_balls + ridge;
        }
    }
    for (half, (component, prior)) in side.chunks_exact_mut(EACH).zip(prior.iter().enumerate()) {
        fill_side(half, balls, component, prior, energy);
    }
    cholesky::factor(&mut matrix)?;
    cholesky::solve(&matrix, &mut side);
    let mut w = [[0.0; TERMS]; 2];
    for (row, values) in w.iter_mut().zip(side.chunks_exact(EACH)) {
        row.iter_mut().zip(values).for_each(|(entry, value)| *entry = *value);
    }
    Some(w)
}

/// W with products of colors, row by row.
#[expect(clippy::large_stack_arrays, reason = "the documentation of the call says how much stack it takes")]
fn each_slope(balls: &Balls, prior: &[[f64; 3]; 2], energy: f64) -> Option<[[f64; TERMS]; 2]> {
    let mut matrix = [[0.0; TERMS]; TERMS];
    for (i, column) in matrix.iter_mut().enumerate() {
        for (j, entry) in column.iter_mut().enumerate() {
            let share = if i < Order::Place.len() { RIDGE } else { PRODUCTS_RIDGE };
            *entry = balls.product(i, j) + if i == j { share * energy } else { 0.0 };
        }
    }
    cholesky::factor(&mut matrix)?;
    let mut w = [[0.0; TERMS]; 2];
    for (component, (row, prior)) in w.iter_mut().zip(prior).enumerate() {
        fill_side(row, balls, component, prior, energy);
        cholesky::solve(&matrix, row);
    }
    Some(w)
}

/// The right side of the regression of one slope.
fn fill_side(side: &mut [f64], balls: &Balls, component: usize, prior: &[f64; 3], energy: f64) {
    for (i, entry) in side.iter_mut().enumerate() {
        *entry = balls.side(component, i) + prior.get(i).map_or(0.0, |prior| RIDGE * energy * prior);
    }
}

/// What would help most.
fn advice(model: &Model, rig: &Rig) -> Advice {
    let least = rig.coverage.iter().min().copied().unwrap_or(0);
    if model.circulation_ratio > SURE_RATIO || rig.frames < FEWEST_FRAMES {
        Advice::Contacts
    } else if matches!(model.scale_source, ScaleSource::Unknown | ScaleSource::Colors) {
        Advice::Scale
    } else if least == 0 {
        Advice::Region
    } else {
        Advice::Nothing
    }
}
