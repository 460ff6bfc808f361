//! The dual basis E of the lights' directions: `a_i . E_j` is 1 for i = j and 0 else.
//!
//! A raw normal in the shadow of light i is n - `E_i` (`a_i . n`), and the color of light i is F `E_i`.

use super::class::{ALL_LIGHTS, INTERPOLATED, ONE_LIGHT, TWO_LIGHTS, class, single_light};
use super::cone::LEAST_N3;
use super::map::{Map, Vectors};
use super::parameters::DualSource;
use super::search::Shade;
use super::state::{Known, State};
use super::two::Fold;
use super::vector::{Vector, cross, dot, scale, unit};

/// Directions that span less than this volume leave their dual basis to the noise.
const LEAST_VOLUME: f32 = 0.02;
/// Of a shadow no more than this share may have normals that face away, or none, where its dual vector was searched for.
const MOST_AWAY: f32 = 0.1;

/// The dual vector of each light, and how it was found.
pub(super) type Duals = [(Option<Vector>, DualSource); 3];

/// None of them.
pub(super) const NONE: Duals = [(None, DualSource::None); 3];

/// From all three directions; `None` where they hardly span the space.
pub(super) fn of_three([a, b, c]: [Vector; 3]) -> Option<[Vector; 3]> {
    let volume = dot(cross(a, b), c);
    if volume.abs() < LEAST_VOLUME {
        return None;
    }
    Some([cross(b, c), cross(c, a), cross(a, b)].map(|dual| scale(dual, 1.0 / volume)))
}

/// The dual vectors that the shadows of one or two lights determine; of two, they say where the third light is.
pub(super) fn search(
    mut directions: [Option<Vector>; 3],
    deviation: f32,
    raw: &Vectors,
    classes: &Map<u8>,
    [room, more]: [&mut [f32]; 2],
) -> ([Option<Vector>; 3], Duals) {
    let mut duals = NONE;
    for (light, slot) in duals.iter_mut().enumerate() {
        let Some(Some(direction)) = directions.get(light).copied() else { continue };
        let mut others = directions.iter().enumerate().filter(|&(other, _)| other != light);
        let other = others.find_map(|(_, direction)| *direction);
        let shade = Shade::gather(light, direction, deviation, raw, classes, [&mut *room, &mut *more]);
        if let Some(dual) = shade.and_then(|shade| shade.best(direction, other)) {
            *slot = (Some(dual), DualSource::Search);
        }
    }
    if let ([Some(a), Some(b), None], [(Some(d), _), (Some(e), _), _]) = (directions, duals) {
        let third = third_direction(d, e);
        if let Some([.., dual]) = of_three([a, b, third]) {
            let [.., direction] = &mut directions;
            let [.., slot] = &mut duals;
            (*direction, *slot) = (Some(third), (Some(dual), DualSource::Search));
        }
    }
    (directions, duals)
}

/// The direction of the light whose shadow was not found, from the dual vectors of both others: it is across these, and in front of
/// the surface.
fn third_direction(e: Vector, other: Vector) -> Vector {
    let direction = unit(cross(e, other));
    let [.., z] = direction;
    if z < 0.0 { scale(direction, -1.0) } else { direction }
}

/// Without those that were searched for and make normals face away; what lies in their shadow is interpolated.
pub(super) fn checked(mut duals: Duals, known: &mut Known, state: &mut State) -> Duals {
    for (light, (dual, source)) in duals.iter_mut().enumerate() {
        let Some(Some(fold)) = known.folds.get(light).copied() else { continue };
        if *source != DualSource::Search || is_plausible(light, &fold, state) {
            continue;
        }
        (*dual, *source) = (None, DualSource::Rejected);
        if let Some(fold) = known.folds.get_mut(light) {
            *fold = None;
        }
        let classes = &mut state.classes;
        for row in classes.data.chunks_mut(classes.row_stride.max(1)) {
            for byte in row.iter_mut().take(classes.width) {
                let is_in_shadow = class(*byte) == TWO_LIGHTS && single_light(*byte) == light;
                if is_in_shadow || class(*byte) == ONE_LIGHT {
                    *byte = *byte & ALL_LIGHTS | INTERPOLATED;
                }
            }
        }
    }
    duals
}

/// Whether the normals of a shadow face the camera as they must, by what the ratios say of each.
fn is_plausible(light: usize, fold: &Fold, state: &State) -> bool {
    let (mut all, mut away) = (0.0, 0.0);
    for y in 0..state.size[1] {
        let rows = state.classes.row(y).iter().zip(state.normals.row(y));
        for (x, (&byte, &n)) in rows.enumerate() {
            let is_ours = byte != 0 && (byte >> 4 & 7).count_ones() == 2 && single_light(byte) == light;
            if !is_ours {
                continue;
            }
            all += 1.0;
            let ratio = state.ratios.get(y * state.size[0] + x).copied().unwrap_or(0.0);
            let [plus, minus] = fold.both(n);
            let [.., z] = if ratio > 0.0 { plus } else { minus };
            away += f32::from(u8::from(class(byte) != TWO_LIGHTS || z < 2.0 * LEAST_N3));
        }
    }
    away <= MOST_AWAY * all
}
