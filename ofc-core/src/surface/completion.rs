//! The whole surface: a normal, an uncertainty and one depth for every pixel of the mask.
//!
//! The rest of the library takes pixels that see all three lights. This knits them together with those that see two lights or one,
//! and with those whose color says nothing. In raw normals v = F^-1 rho, with the lights' directions `a_i` and their dual basis `E_i`:
//!
//! - lit by all: v = n, of length 1 ([`THREE_LIGHTS`], and where it is not, [`REJECTED`]);
//! - in the shadow of light i: v = n - `E_i` (`a_i . n`), so v is known but for its part along `E_i` ([`TWO_LIGHTS`]);
//! - by light j alone: v = `E_j` (`a_j . n`), so the angle to `a_j` is known ([`ONE_LIGHT`]);
//! - else nothing ([`INTERPOLATED`]).
//!
//! The lights come from the shadows themselves: a shadow's colors lie in a plane whose normal is the light's direction. What colors
//! leave open is chosen so that the normals are those of one surface. `docs/whole-surface.md` derives this.
//!
//! # Scratch
//! [`need`]: what [`depth`] takes and one number more for each pixel.

mod agreement;
mod attached;
mod boxes;
mod choose;
mod class;
mod cone;
mod curl;
mod distance;
mod duals;
mod faces;
mod finish;
mod half;
mod histogram;
mod lights;
mod map;
mod model;
mod parameters;
mod pixels;
mod rim;
mod search;
mod slopes;
mod state;
mod three;
mod two;
mod vector;

pub use class::{
    CLASS, DOUBTFUL, FIRST_LIGHT, INTERPOLATED, ONE_LIGHT, OUTSIDE, REJECTED, THREE_LIGHTS, TWO_LIGHTS, class,
};
pub use parameters::{Completion, CompletionError, CompletionParams, DualSource, Light, Outputs};

use super::depth;
use super::uncertainty::Sources;
use crate::math::arena::{Arena, Need};
use crate::math::mat3;
use crate::picture::{Image, Usable};
use cone::Cone;
use faces::Means;
use libm::sqrtf;
use lights::Shadow;
use map::{Map, Vectors};
use model::Model;
use state::{Known, State};
use two::Fold;
use vector::{apply, form, scale, single, single_matrix, trace, unit};

/// Raw normals of two lights are means of 3 x 3 pixels: their noise is that of a pixel times this, as neighbors at the border of a
/// shadow are fewer.
const NOISE_OF_MEANS: f32 = 1.2 / 3.0;
/// Where means of 3 x 3 pixels have more noise than this, pixels that see one light are interpolated: on photographs, where most of
/// what is taken for noise is what the model does not explain, cones are off by more than what is around.
const MOST_NOISE_OF_ONE_LIGHT: f32 = 0.05;

/// What [`complete`] needs as workspace for a picture of this size; `None` if there is no such picture.
#[must_use]
pub const fn need(width: usize, height: usize) -> Option<Need> {
    match depth::need(width, height) {
        Some(need) => Some(Need { singles: need.singles + width * height, ..need }),
        None => None,
    }
}

/// Completes the surface of a picture that was solved: `sources` and `saturation` are those of the solution.
///
/// # Errors
/// [`CompletionError`]; the outputs are then untouched.
pub fn complete(
    image: &Image,
    sources: &Sources,
    saturation: f32,
    params: &CompletionParams,
    mut workspace: Arena,
    outputs: Outputs,
) -> Result<Completion, CompletionError> {
    let size = [image.width(), image.height()];
    let [width, height] = size;
    let need = need(width, height).ok_or(CompletionError::Size)?;
    if !params.is_valid() {
        return Err(CompletionError::Parameter);
    }
    if !workspace.holds(need) {
        return Err(CompletionError::Workspace(need));
    }
    let usable = Usable::below(saturation);
    if usable.count(image).usable == 0 {
        return Err(CompletionError::Empty);
    }
    let root = single_matrix(&sources.f_inverse).map(|row| scale(row, sources.noise as f32));
    if !agreement::holds(image, usable, &single_matrix(&sources.f_inverse), &root) {
        return Err(CompletionError::OtherPicture);
    }
    let ratios = workspace.singles(width * height).ok_or(CompletionError::Workspace(need))?;
    let singles = workspace.singles(need.singles - width * height).ok_or(CompletionError::Workspace(need))?;
    let integers = workspace.integers(need.integers).ok_or(CompletionError::Workspace(need))?;
    let Outputs { normals, angles, depths, classes } = outputs;
    let mut state = State {
        size,
        classes: Map::new(classes.0, size, classes.1).ok_or(CompletionError::Output)?,
        normals: Vectors::new(normals.0, size, normals.1).ok_or(CompletionError::Output)?,
        weights: Map::new(angles.0, size, angles.1).ok_or(CompletionError::Output)?,
        depth: Map::new(depths.0, size, depths.1).ok_or(CompletionError::Output)?,
        ratios,
        singles,
        integers,
    };
    run(&mut state, image, usable, sources, &root, params).map_err(|_| CompletionError::Workspace(need))
}

/// All steps.
fn run(
    state: &mut State,
    image: &Image,
    usable: Usable,
    sources: &Sources,
    root: &vector::Matrix,
    params: &CompletionParams,
) -> Result<Completion, depth::DepthError> {
    let [width, _] = state.size;
    let [[xx, ..], [_, yy, _], [.., zz]] = sources.rotation;
    let orientation_variance = (xx + yy + zz) as f32;
    let noise = covariance(root);
    let model = Model::new(sources, &noise);
    let of_means = noise.map(|row| scale(row, NOISE_OF_MEANS * NOISE_OF_MEANS));
    // Raw normals are in the integrator's memory until all that is read from them is written.
    let pixels = state.size[0] * state.size[1];
    let (raw, room) = state.singles.split_at_mut_checked(3 * pixels).unwrap_or_default();
    let Some(mut raw) = Vectors::new(raw, state.size, 3 * width) else { return Err(depth::DepthError::Size) };
    let masked =
        pixels::read(image, usable, &single_matrix(&sources.f_inverse), &mut raw, &mut state.classes);
    let means = Means::gather(&raw, &state.classes, masked, root, room);
    let left = means.noise_left().clamp(1.0 / 3.0, 1.0);
    let directions = if params.channels_are_lights {
        sources.f.map(|row| Some(unit(single(row))))
    } else {
        means.directions(params.seed)
    };
    let shadows = directions.map(|a| {
        a.map(|direction| {
            let deviation = sqrtf(form(&noise, direction));
            Shadow { direction, deviation, deviation_of_means: left * deviation }
        })
    });
    let votes = state.integers.get_mut(..pixels).unwrap_or_default();
    lights::mark(&shadows, &raw, &mut state.classes, votes);
    let deviation = sqrtf(trace(&noise) / 3.0);
    let (directions, duals) = if let [Some(a), Some(b), Some(c)] = directions {
        (
            directions,
            duals::of_three([a, b, c])
                .map_or(duals::NONE, |duals| duals.map(|dual| (Some(dual), DualSource::Directions))),
        )
    } else {
        duals::search(directions, deviation, &raw, &state.classes, [room, &mut *state.ratios])
    };
    let folds = duals.map(|(dual, _)| dual.map(|dual| Fold::new(dual, &of_means)));
    let all = duals.iter().all(|(dual, _)| dual.is_some());
    let cones =
        directions.map(|a| a.filter(|_| all && left * deviation < MOST_NOISE_OF_ONE_LIGHT).map(Cone::new));
    let mut known = Known { directions, folds, cones };
    pixels::classify(state.size, &known, &raw, &mut state.classes, &mut state.normals);
    curl::compare(&known.folds, deviation, &state.normals, &state.classes, state.ratios);
    pixels::normals(
        &known,
        &noise,
        orientation_variance,
        &raw,
        &mut state.classes,
        &mut state.normals,
        &mut state.weights,
    );
    let distances = state.integers.get_mut(..pixels).unwrap_or_default();
    attached::mark(&shadows, &raw, &mut state.classes, distances);
    curl::gather(state.ratios, &state.classes, State::planes(state.singles, state.size));
    let duals = duals::checked(duals, &mut known, state);
    let distances = state.integers.get_mut(..pixels).unwrap_or_default();
    let rim = rim::mark(&mut state.classes, &state.normals, distances);
    let depth = choose::choose(state, &known, rim)?;
    let border_gap = finish::finish(state, &known, &duals, &model);
    angles(state, image, &single_matrix(&sources.f_inverse), &model);
    for y in 0..state.size[1] {
        state.depth.row_mut(y).iter_mut().for_each(|z| *z = (f64::from(*z) * params.pixel_pitch) as f32);
    }
    let mut counts = [0; 8];
    for y in 0..state.size[1] {
        for &byte in state.classes.row(y) {
            if let Some(count) = counts.get_mut(usize::from(class(byte))) {
                *count += 1;
            }
        }
    }
    let mut found = [None; 3];
    for ((slot, direction), (dual, source)) in found.iter_mut().zip(directions).zip(duals) {
        *slot = direction.map(|direction| Light {
            direction: direction.map(f64::from),
            color: dual.map(|dual| mat3::apply(&sources.f, dual.map(f64::from))),
            dual: source,
        });
    }
    Ok(Completion {
        lights: found,
        counts,
        border_gap: f64::from(border_gap),
        regions: depth.regions,
        converged: depth.converged,
    })
}

/// The covariance of raw normals of noise with this root.
fn covariance(root: &vector::Matrix) -> vector::Matrix {
    root.map(|a| root.map(|b| vector::dot(a, b)))
}

/// The angles of pixels that see three lights.
fn angles(state: &mut State, image: &Image, f_inverse: &vector::Matrix, model: &Model) {
    image.for_each_window(|window| {
        let row = state.classes.row(window.y).iter().zip(state.normals.row(window.y));
        let row = row.zip(state.weights.row_mut(window.y)).skip(window.x);
        for (i, ((&byte, &n), angle)) in row.take(window.len).enumerate() {
            match class(byte) {
                THREE_LIGHTS => *angle = model.of_three(n),
                REJECTED => {
                    let misfit = three::misfit(apply(f_inverse, window.pixel(i)));
                    *angle = model.of_three(n).max(misfit);
                }
                _ => {}
            }
        }
    });
}
