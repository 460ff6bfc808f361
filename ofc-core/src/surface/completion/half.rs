//! The surface of the first rounds, at half the resolution, where it takes a quarter of the time.
//!
//! All of it lies in the integrator's memory, but for the classes: they are bytes, of which only the caller has any, so those of the
//! picture wait meanwhile as integers.

use super::map::{Map, Vectors, row_of, row_of_mut};
use super::state::State;
use crate::surface::depth::{self, DepthError};

/// Pictures with fewer pixels to a side are not halved.
const LEAST_SIDE: usize = 32;

/// Leaves the surface in the state that `work` makes of it at half the resolution; `None` of a picture that is too small for that.
pub(super) fn surface(
    state: &mut State,
    work: impl FnOnce(&mut State) -> Result<(), DepthError>,
) -> Option<Result<(), DepthError>> {
    if state.size.iter().any(|&side| side < LEAST_SIDE) {
        return None;
    }
    let [width, height] = state.size.map(|side| side.div_ceil(2));
    let pixels = width * height;
    let need = depth::need(width, height)?;
    let (normals, rest) = state.singles.split_at_mut_checked(3 * pixels)?;
    let (weights, rest) = rest.split_at_mut_checked(pixels)?;
    let (depths, rest) = rest.split_at_mut_checked(pixels)?;
    let (ratios, rest) = rest.split_at_mut_checked(pixels)?;
    let singles = rest.get_mut(..need.singles)?;
    let words = state.size[0].div_ceil(4);
    let (saved, integers) = state.integers.split_at_mut_checked(words * state.size[1])?;
    let integers = integers.get_mut(..need.integers)?;
    let mut half = State {
        size: [width, height],
        classes: Map { data: &mut *state.classes.data, row_stride: state.classes.row_stride, width },
        normals: Vectors::new(normals, [width, height], 3 * width)?,
        weights: Map::new(weights, [width, height], width)?,
        depth: Map::new(depths, [width, height], width)?,
        ratios,
        singles,
        integers,
    };
    for y in 0..state.size[1] {
        let row = half.classes.data.get(y * half.classes.row_stride..).unwrap_or_default();
        let row = row.get(..state.size[0]).unwrap_or_default();
        let (groups, rest) = row.as_chunks::<4>();
        let mut saved = row_of_mut(saved, words, y).iter_mut();
        for (group, word) in groups.iter().zip(&mut saved) {
            *word = u32::from_le_bytes(*group);
        }
        if let Some(word) = saved.next() {
            *word = rest.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte));
        }
    }
    // Of four pixels the first one of the mask stands for all.
    let saved_at = |x: usize, y: usize| {
        let word = row_of(saved, words, y).get(x / 4).copied().unwrap_or(0);
        (word >> (8 * (x % 4))) as u8
    };
    for y in 0..height {
        for x in 0..width {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| (2 * x + i, 2 * y + j));
            let of_mask =
                four.iter().find(|&&(x, y)| x < state.size[0] && y < state.size[1] && saved_at(x, y) != 0);
            let &(u, v) = of_mask.unwrap_or(&(2 * x, 2 * y));
            let byte = of_mask.map_or(0, |_| saved_at(u, v));
            half.classes.set(x, y, byte);
            half.weights.set(x, y, state.weights.at(u, v));
            let i = y * width + x;
            if let (Some(n), Some(ratio)) = (half.normals.row_mut(y).get_mut(x), half.ratios.get_mut(i)) {
                *n = state.normals.at(u, v);
                *ratio = state.ratios.get(v * state.size[0] + u).copied().unwrap_or(0.0);
            }
        }
    }
    let result = work(&mut half);
    let State { depth: small, .. } = half;
    if result.is_ok() {
        for y in 0..state.size[1] {
            let row = small.row(y / 2);
            for (x, z) in state.depth.row_mut(y).iter_mut().enumerate() {
                *z = 2.0 * row.get(x / 2).copied().unwrap_or(0.0);
            }
        }
    }
    for y in 0..state.size[1] {
        let (groups, rest) = state.classes.row_mut(y).as_chunks_mut::<4>();
        let mut saved = row_of(saved, words, y).iter();
        for (group, word) in groups.iter_mut().zip(&mut saved) {
            *group = word.to_le_bytes();
        }
        if let Some(word) = saved.next() {
            rest.iter_mut().zip(word.to_le_bytes()).for_each(|(byte, saved)| *byte = saved);
        }
    }
    Some(result)
}
