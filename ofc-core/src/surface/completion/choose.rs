//! Choosing the normals that colors leave open, and integrating, in turn.
//!
//! Every pixel's normal becomes the one nearest to the surface so far that its color allows, and the surface the one that has these
//! normals: images of two lights by what integrability says and by the surface around, normals of one light on their cones.

use super::attached::hidden;
use super::boxes;
use super::class::{INTERPOLATED, NOTE, ONE_LIGHT, TWO_LIGHTS, class, single_light};
use super::half;
use super::rim::outward;
use super::slopes;
use super::state::{Known, State};
use super::two;
use super::vector::{Vector, ZERO, add, distance_squared, scale, unit};
use crate::surface::depth::{DepthError, DepthResult, Method};
use libm::sqrtf;

/// Normals are chosen so many times before the last one.
const LAST_ROUND: u32 = 7;
/// The surface says its part of the choice half as loud in the first ones.
const CAREFUL_ROUNDS: u32 = 2;
/// The rounds before this one are made with the first surface.
const EARLY_ROUNDS: u32 = 4;
/// What the surface so far may be off by, as a chord.
const SURFACE_NOISE: f32 = 0.25;
/// No pixel of the surface says more than this.
const MOST: f32 = 10.0;
/// An image that faces away is that much less likely.
const LEAST_N3: f32 = 0.03;
const FACING_AWAY: f32 = 2.0;
/// An image this many times as likely as the other, as a logarithm, has its whole weight.
const CERTAIN: f32 = 4.0;
/// The part of its weight that any has.
const LEAST_PART: f32 = 0.05;
/// How much turning to hidden lights costs, at first and later.
const STRICT: f32 = 4.0;
const LENIENT: f32 = 1.0;

/// Weights of what the color says little or nothing of.
const WEIGHT_OF_ONE_LIGHT: f32 = 0.05;
const WEIGHT_OF_NOTHING: f32 = 0.01;
/// The weight of a silhouette's outward normals, in the first surface.
const WEIGHT_OF_RIM: f32 = 0.05;
/// Slopes with this angle of uncertainty, in radians, have the weight 1.
const ONE_DEGREE: f32 = 0.017_453_3;

/// How exactly surfaces on the way are integrated.
const TOLERANCE: f64 = 5e-3;
/// The first one, which is but a guess.
const FIRST_TOLERANCE: f64 = 1e-1;
/// And the last one.
const FINAL_TOLERANCE: f64 = 1e-4;

/// The weight of a normal with this uncertainty in radians.
pub(super) fn weight(angle: f32, [.., n3]: Vector) -> f32 {
    let sure = (ONE_DEGREE / angle.max(0.25 * ONE_DEGREE)).min(4.0);
    let facing = (n3 / 0.3).clamp(0.05, 1.0);
    (sure * sure * facing * facing).clamp(1e-3, 16.0)
}

/// What depends on the size of a pixel.
#[derive(Clone, Copy)]
struct Scale {
    /// The smoothing of the surface, as a radius in pixels.
    smoothing: usize,
    /// The surface's part is the mean over `2 radius + 1` pixels a side.
    radius: usize,
}

const WHOLE: Scale = Scale { smoothing: 2, radius: 3 };
const COARSE: Scale = Scale { smoothing: 1, radius: 1 };

/// Leaves the chosen normals in the state, the surface that they make, and in its ratios how clear each choice between images was.
///
/// From the coarse to the fine: the first rounds are made at a quarter of the resolution, the next ones at half of it, as far as the
/// picture is large enough.
pub(super) fn choose(state: &mut State, known: &Known, rim: Option<f32>) -> Result<DepthResult, DepthError> {
    let coarse = half::surface(state, |coarser| {
        half::surface(coarser, |coarsest| first(coarsest, known, rim, COARSE))
            .unwrap_or_else(|| first(coarser, known, rim, COARSE))?;
        rounds(coarser, known, COARSE)
    });
    coarse.unwrap_or_else(|| {
        first(state, known, rim, WHOLE)?;
        rounds(state, known, WHOLE)
    })?;
    round(state, known, WHOLE, LAST_ROUND)
}

/// The first surface, and the early rounds.
fn first(state: &mut State, known: &Known, rim: Option<f32>, scale: Scale) -> Result<(), DepthError> {
    begin(state, rim);
    match state.integrate(Method::Coupled, FIRST_TOLERANCE) {
        // No color says anything: the flattest surface there is.
        Err(DepthError::Empty) => state.flatten(),
        other => drop(other?),
    }
    (0..EARLY_ROUNDS).try_for_each(|number| round(state, known, scale, number).map(drop))
}

/// The rounds between those and the last one.
fn rounds(state: &mut State, known: &Known, scale: Scale) -> Result<(), DepthError> {
    (EARLY_ROUNDS..LAST_ROUND).try_for_each(|number| round(state, known, scale, number).map(drop))
}

/// Chooses by the surface so far, and integrates what is chosen.
fn round(state: &mut State, known: &Known, scale: Scale, round: u32) -> Result<DepthResult, DepthError> {
    let loudness = if round < CAREFUL_ROUNDS { 0.5 } else { 1.0 };
    let is_last = round == LAST_ROUND;
    let [p, q, votes, between] = State::planes(state.singles, state.size);
    slopes::of(&state.depth, &state.classes, scale.smoothing, [&mut *p, &mut *q, &mut *votes, &mut *between]);
    // What pixels say themselves, and what those around them say, go through the weights.
    for light in 0..3 {
        let Some(Some(fold)) = known.folds.get(light) else { continue };
        let ours = |byte: u8| class(byte) == TWO_LIGHTS && single_light(byte) == light;
        let width = state.size[0].max(1);
        for (y, row) in votes.chunks_exact_mut(width).enumerate() {
            let pixels = state.classes.row(y).iter().zip(state.normals.row(y));
            for (x, (vote, (&byte, &n))) in row.iter_mut().zip(pixels).enumerate() {
                *vote = 0.0;
                if ours(byte) {
                    let guess = normal_at(p, q, width, [x, y]);
                    let [plus, minus] = fold.both(n).map(|image| cost(image, guess));
                    let noise = 2.0 * SURFACE_NOISE * SURFACE_NOISE;
                    *vote = ((minus - plus) / noise).clamp(-MOST, MOST);
                }
            }
        }
        boxes::sums(votes, between, width, scale.radius);
        let side = 2 * scale.radius + 1;
        let share = loudness / (side * side) as f32;
        for (y, row) in votes.chunks_exact(width).enumerate() {
            let ratios = state.ratios.get_mut(y * width..(y + 1) * width).unwrap_or_default();
            let pixels = state.classes.row(y).iter().zip(state.normals.row_mut(y));
            let outputs = state.weights.row_mut(y).iter_mut().zip(ratios);
            for (((&byte, n), (weight, ratio)), &votes) in pixels.zip(outputs).zip(row) {
                if !ours(byte) {
                    continue;
                }
                let said = *ratio + share * votes;
                let [plus, minus] = fold.both(*n);
                *n = two::facing(said, plus, minus);
                let angle = sqrtf(fold.variance(*n));
                let part = (said.abs() / CERTAIN).clamp(LEAST_PART, 1.0);
                *weight = self::weight(angle, *n).clamp(0.01, 1.0) * part;
                if is_last {
                    *ratio = said;
                }
            }
        }
    }
    let strictness = if 2 * round <= LAST_ROUND { STRICT } else { LENIENT };
    guess_others(state, known, strictness);
    let tolerance = if is_last { FINAL_TOLERANCE } else { TOLERANCE };
    state.integrate(Method::Poisson, tolerance)
}

/// How badly an image agrees with the surface so far.
fn cost(image: Vector, guess: Vector) -> f32 {
    let [.., n3] = image;
    distance_squared(image, guess) + FACING_AWAY * sqrtf((LEAST_N3 - n3).clamp(0.0, 1.0))
}

fn normal_at(p: &[f32], q: &[f32], width: usize, [x, y]: [usize; 2]) -> Vector {
    let i = y * width + x;
    match (p.get(i), q.get(i)) {
        (Some(&p), Some(&q)) => slopes::normal(p, q),
        _ => ZERO,
    }
}

/// Weights and normals of the first surface: of what is known, and of a silhouette.
fn begin(state: &mut State, rim: Option<f32>) {
    let [width, height] = state.size;
    for y in 0..height {
        for x in 0..width {
            let byte = state.classes.at(x, y);
            match class(byte) {
                TWO_LIGHTS | ONE_LIGHT => state.weights.set(x, y, 0.0),
                INTERPOLATED => {
                    state.weights.set(x, y, 0.0);
                    if let Some(cosine) = rim.filter(|_| byte & NOTE != 0) {
                        let n = rim_normal(cosine, outward(&state.classes, [x, y]));
                        state.weights.set(x, y, WEIGHT_OF_RIM);
                        if let Some(slot) = state.normals.row_mut(y).get_mut(x) {
                            *slot = n;
                        }
                    }
                }
                _ => {}
            }
        }
    }
}

fn rim_normal(cosine: f32, outward: Vector) -> Vector {
    add(scale(outward, cosine), sqrtf(1.0 - cosine * cosine), [0.0, 0.0, 1.0])
}

/// Normals of one light, on their cones, and of none, from the surface so far.
fn guess_others(state: &mut State, known: &Known, strictness: f32) {
    let [p, q, ..] = State::planes(state.singles, state.size);
    let [width, height] = state.size;
    for y in 0..height {
        for x in 0..width {
            let byte = state.classes.at(x, y);
            if !matches!(class(byte), ONE_LIGHT | INTERPOLATED) {
                continue;
            }
            let guess = normal_at(p, q, width, [x, y]);
            let Some(n) = state.normals.row_mut(y).get_mut(x) else { continue };
            if class(byte) == ONE_LIGHT {
                *n = on_cone(known, byte, *n, guess, strictness);
                state.weights.set(x, y, WEIGHT_OF_ONE_LIGHT);
            } else {
                *n = guess;
                if byte & NOTE != 0 {
                    *n = unit(add(guess, 1.0, rim_normal(0.8, outward(&state.classes, [x, y]))));
                }
                state.weights.set(x, y, WEIGHT_OF_NOTHING);
            }
        }
    }
}

/// The normal of a pixel of one light that is nearest to a guess.
pub(super) fn on_cone(known: &Known, byte: u8, n: Vector, guess: Vector, strictness: f32) -> Vector {
    let light = single_light(byte);
    match (known.directions.get(light), known.cones.get(light)) {
        (Some(Some(direction)), Some(Some(cone))) => {
            let cosine = super::vector::dot(*direction, n);
            cone.nearest(cosine, guess, &hidden(byte, &known.directions), strictness).unwrap_or(n)
        }
        _ => guess,
    }
}

/// How much turning to hidden lights costs in the end.
pub(super) const IN_THE_END: f32 = LENIENT;
