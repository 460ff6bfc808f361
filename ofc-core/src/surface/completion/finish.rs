//! The normals that are left to the surface, and how sure all of them are.

use super::boxes;
use super::choose::{IN_THE_END, on_cone};
use super::class::{
    DOUBTFUL, INTERPOLATED, NOTE, ONE_LIGHT, REJECTED, THREE_LIGHTS, TWO_LIGHTS, class, single_light,
};
use super::distance::{self, FAR, STEP};
use super::duals::Duals;
use super::histogram::Histogram;
use super::map::{row_of, row_of_mut};
use super::model::Model;
use super::parameters::DualSource;
use super::slopes;
use super::state::{Known, State};
use super::vector::{Vector, ZERO, distance_squared};
use core::f32::consts::PI;
use libm::sqrtf;

/// Pixels across the border of a shadow that are compared.
const SPAN: usize = 4;
/// Pairs of pixels below which they say nothing.
const FEWEST_PAIRS: u32 = 40;
/// The logarithm of how many times as likely an image is than its mirror image, below which that has a probability above 0.1.
const DOUBT: f32 = 2.2;
/// Normals that are so far from those of the surface around a pixel, as a chord, are not those of one surface: an image is wrong
/// there or nearby.
const BENT: f32 = 0.1;
/// Of the angle between normals across the borders of shadows, what an error of a dual vector that was searched for explains.
const SEARCHED: f32 = 0.5;
/// From the mean of two variances to the square of the angle below which 68 % of errors lie.
const TO_ONE_SIGMA: f32 = 1.15;
/// Uncertainty of guesses in degrees, or so many times the angle between normals across the borders of shadows where that is more, and
/// how much it grows with each pixel's distance from what is known, up to so many pixels.
const GUESS: f32 = 6.0;
const GAPS: f32 = 2.0;
const GROWTH_OF_ONE_LIGHT: f32 = 1.0;
const GROWTH_OF_NOTHING: f32 = 1.5;
const FARTHEST: f32 = 25.0;

/// Chooses normals of one light and of none by the surface of the state, and writes the angles of all but those of three lights,
/// which the caller knows. Returns by how much normals differ across the borders of shadows, as an angle in radians.
pub(super) fn finish(state: &mut State, known: &Known, duals: &Duals, model: &Model) -> f32 {
    let [width, height] = state.size;
    let step = width.max(1);
    let [p, q, gaps, between] = State::planes(state.singles, state.size);
    slopes::of(&state.depth, &state.classes, 1, [&mut *p, &mut *q, &mut *gaps, &mut *between]);
    for (y, gaps) in gaps.chunks_exact_mut(step).enumerate() {
        let [p, q] = [row_of(p, step, y), row_of(q, step, y)];
        let pixels = state.classes.row(y).iter().zip(state.normals.row_mut(y));
        for (((&byte, n), (&p, &q)), gap) in pixels.zip(p.iter().zip(q)).zip(gaps) {
            let surface = slopes::normal(p, q);
            match class(byte) {
                0 => {
                    (*n, *gap) = (ZERO, 0.0);
                    continue;
                }
                ONE_LIGHT => *n = on_cone(known, byte, *n, surface, IN_THE_END),
                INTERPOLATED => *n = surface,
                _ => {}
            }
            *gap = distance_squared(*n, surface);
        }
    }
    // Around the pixels of the mask's border there are fewer.
    for y in 0..height {
        for (count, &byte) in row_of_mut(p, step, y).iter_mut().zip(state.classes.row(y)) {
            *count = if byte == 0 { 0.0 } else { 1.0 };
        }
    }
    boxes::sums(gaps, between, width, 2);
    boxes::sums(p, between, width, 2);
    let across = border_gap(state);
    let guess = GUESS.to_radians().max(GAPS * across);
    let [count, _, gaps, _] = State::planes(state.singles, state.size);
    let distances = state.integers.get_mut(..width * height).unwrap_or_default();
    for (y, row) in distances.chunks_exact_mut(step).enumerate() {
        for (slot, &byte) in row.iter_mut().zip(state.classes.row(y)) {
            *slot = if matches!(class(byte), THREE_LIGHTS | REJECTED | TWO_LIGHTS) { 0 } else { FAR };
        }
    }
    distance::spread(distances, width);
    for y in 0..height {
        for x in 0..width {
            let (byte, i) = (state.classes.at(x, y), y * width + x);
            let at = |plane: &[f32]| plane.get(i).copied().unwrap_or(0.0);
            let away = distances.get(i).map_or(0, |d| d / (2 * STEP));
            let away = (away.min(1000) as f32).min(FARTHEST);
            match class(byte) {
                0 => state.weights.set(x, y, PI),
                TWO_LIGHTS => {
                    let n = state.normals.at(x, y);
                    let fold = known.folds.get(single_light(byte)).copied().flatten();
                    let own = fold.map_or(0.0, |fold| fold.variance(n));
                    let gap = at(gaps) / at(count).max(1.0);
                    let shared = model.shared(n);
                    let is_searched = duals
                        .get(single_light(byte))
                        .is_some_and(|(_, source)| *source == DualSource::Search);
                    let of_dual = if is_searched { SEARCHED * across } else { 0.0 };
                    let square = shared * shared + TO_ONE_SIGMA * own + gap + of_dual * of_dual;
                    state.weights.set(x, y, sqrtf(square).min(PI));
                    let is_doubtful =
                        gap > BENT * BENT || state.ratios.get(i).is_some_and(|ratio| ratio.abs() < DOUBT);
                    state.classes.set(x, y, if is_doubtful { byte | DOUBTFUL } else { byte });
                }
                ONE_LIGHT => {
                    state.weights.set(x, y, (guess + (GROWTH_OF_ONE_LIGHT * away).to_radians()).min(PI));
                    state.classes.set(x, y, byte & !(NOTE | DOUBTFUL));
                }
                INTERPOLATED => {
                    state.weights.set(x, y, (guess + (GROWTH_OF_NOTHING * away).to_radians()).min(PI));
                    state.classes.set(x, y, byte & !NOTE);
                }
                _ => {}
            }
        }
    }
    across
}

/// The median difference between normals of two and of three lights across the borders of shadows, beyond that among the latter.
fn border_gap(state: &State) -> f32 {
    let [width, height] = state.size;
    let (mut across, mut among) = (Histogram::over(0.0, 2.0), Histogram::over(0.0, 2.0));
    let difference = |a: Vector, b: Vector| sqrtf(distance_squared(a, b));
    for y in 0..height {
        for x in 0..width {
            if class(state.classes.at(x, y)) != TWO_LIGHTS {
                continue;
            }
            let n = state.normals.at(x, y);
            for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let at = |times: usize| {
                    let by = (SPAN * times).cast_signed();
                    (x.wrapping_add_signed(dx * by), y.wrapping_add_signed(dy * by))
                };
                let [(u, v), (s, t)] = [at(1), at(2)];
                if class(state.classes.at(u, v)) != THREE_LIGHTS {
                    continue;
                }
                let lit = state.normals.at(u, v);
                across.add(difference(n, lit));
                if class(state.classes.at(s, t)) == THREE_LIGHTS {
                    among.add(difference(lit, state.normals.at(s, t)));
                }
            }
        }
    }
    if across.count() < FEWEST_PAIRS {
        return 0.0;
    }
    let (across, among) = (across.median().unwrap_or(0.0), among.median().unwrap_or(0.0));
    sqrtf((0.5 * (across * across - among * among)).max(0.0))
}
