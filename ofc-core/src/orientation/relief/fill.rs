//! Cells without a color take the mean of their neighbors', from the rim of each gap inward.

use super::grid::{Cell, Grid, neighbors};

/// Gaps are filled to this depth; the middle of a wider gap stays zero, which is the plane.
const DEPTH: usize = 8;

const FILLED: u32 = 3;
const NEW: u32 = 4;

/// Fills the missing cells of the planes. Their states stay missing.
pub(super) fn fill(grid: &Grid, planes: &mut [&mut [f32]; 3], states: &mut [u32]) {
    for (cell, state) in states.iter().enumerate() {
        if *state == Cell::Missing as u32 {
            for plane in planes.iter_mut() {
                plane.iter_mut().skip(cell).take(1).for_each(|value| *value = 0.0);
            }
        }
    }
    for _ in 0..DEPTH {
        if !states.contains(&(Cell::Missing as u32)) {
            break;
        }
        for cell in 0..grid.len() {
            if states.get(cell) != Some(&(Cell::Missing as u32)) {
                continue;
            }
            let (mut sums, mut count) = ([0.0; 3], 0.0);
            for neighbor in neighbors(grid, cell) {
                if matches!(states.get(neighbor), Some(&state) if state == Cell::Known as u32 || state == FILLED)
                {
                    for (sum, plane) in sums.iter_mut().zip(planes.iter()) {
                        *sum += plane.get(neighbor).copied().unwrap_or(0.0);
                    }
                    count += 1.0;
                }
            }
            if count > 0.0 {
                for (plane, sum) in planes.iter_mut().zip(sums) {
                    plane.iter_mut().skip(cell).take(1).for_each(|value| *value = sum / count);
                }
                states.iter_mut().skip(cell).take(1).for_each(|state| *state = NEW);
            }
        }
        for state in states.iter_mut().filter(|state| **state == NEW) {
            *state = FILLED;
        }
    }
    for state in states.iter_mut().filter(|state| **state == FILLED) {
        *state = Cell::Missing as u32;
    }
}
