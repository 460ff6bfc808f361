//! Which cells differ from the plane by more than noise.
//!
//! The noise of each channel is the median distance from the plane, which most cells lie on. Cells beyond five deviations are the
//! contact, once what is narrower than three cells is taken away; around it lies a skirt of five cells in which the relief
//! comes up from the plane.

use super::grid::{BRIDGED, Cell, Grid, class, neighbors};
use super::result::PixelClass;
use crate::color::dispersion::CONSISTENCY;
use crate::math::select::{kth_smallest, median_rank};

/// Deviations from the plane of a cell of the contact.
const DEVIATIONS: f64 = 5.0;

/// Cells of the skirt.
const SKIRT: usize = 5;

/// The deviation of each channel of the known cells from the plane, at least `least`; `None` where there are none.
///
/// # Scratch
/// One `f32` a cell.
pub(super) fn noise(
    planes: &[&mut [f32]; 3],
    states: &[u32],
    least: [f64; 3],
    scratch: &mut [f32],
) -> Option<[f64; 3]> {
    let mut deviations = [0.0; 3];
    for ((deviation, plane), least) in deviations.iter_mut().zip(planes).zip(least) {
        let mut count = 0;
        let known = plane.iter().zip(states).filter(|(_, state)| **state == Cell::Known as u32);
        for ((value, _), slot) in known.zip(scratch.iter_mut()) {
            *slot = value.abs();
            count += 1;
        }
        let median = kth_smallest(scratch.get(..count)?, median_rank(count))?;
        *deviation = f64::max(CONSISTENCY * f64::from(median), least);
    }
    Some(deviations)
}

/// Turns the states of cells into classes of [`PixelClass`], with the bit [`BRIDGED`] where the cell was missing.
pub(super) fn classify(
    grid: &Grid,
    planes: &[&mut [f32]; 3],
    noise: [f64; 3],
    states: &mut [u32],
    other: &mut [u32],
) {
    let floor = f64::from(f32::EPSILON);
    let reciprocals = noise.map(|deviation| 1.0 / deviation.max(floor));
    for (cell, (state, touched)) in states.iter().zip(other.iter_mut()).enumerate() {
        let square = planes.iter().zip(reciprocals).fold(0.0, |sum, (plane, reciprocal)| {
            let value = plane.get(cell).map_or(0.0, |&value| f64::from(value)) * reciprocal;
            sum + value * value
        });
        *touched = u32::from(*state != Cell::Outside as u32 && square > DEVIATIONS * DEVIATIONS);
    }
    // The mask lies in the states, in their upper half: nothing but the classes is left below.
    for (state, touched) in states.iter_mut().zip(other.iter()) {
        *state = *state << 16 | *touched;
    }
    spread(grid, states, other, 1, u32::min);
    spread(grid, states, other, 1, u32::max);
    spread(grid, states, other, SKIRT, u32::max);
    for (state, other) in states.iter_mut().zip(other.iter()) {
        let (before, near, contact) = (*state >> 16, *state & 1 == 1, other >> 1 & 1 == 1);
        let class = if before == Cell::Outside as u32 {
            PixelClass::None
        } else if contact {
            PixelClass::Contact
        } else if near {
            PixelClass::Skirt
        } else {
            PixelClass::Plane
        };
        *state = class as u32 | if before == Cell::Missing as u32 { BRIDGED } else { 0 };
    }
}

/// Replaces the lowest bit of every state by what `pick` makes of the lowest bits within `radius` rows and columns. `other` keeps, in
/// its bit 1, the bit before.
fn spread(grid: &Grid, states: &mut [u32], other: &mut [u32], radius: usize, pick: fn(u32, u32) -> u32) {
    for (state, other) in states.iter().zip(other.iter_mut()) {
        *other = (*state & 1) << 1;
    }
    let around = |i: usize, len: usize| i.saturating_sub(radius)..(i + radius + 1).min(len);
    for y in 0..grid.height {
        let row = y * grid.width;
        for x in 0..grid.width {
            let bits = around(x, grid.width).filter_map(|x| states.get(row + x).map(|state| state & 1));
            let picked = bits.reduce(pick).unwrap_or(0);
            other.iter_mut().skip(row + x).take(1).for_each(|other| *other |= picked);
        }
    }
    for y in 0..grid.height {
        for x in 0..grid.width {
            let bits =
                around(y, grid.height).filter_map(|y| other.get(y * grid.width + x).map(|other| other & 1));
            let picked = bits.reduce(pick).unwrap_or(0);
            states
                .iter_mut()
                .skip(y * grid.width + x)
                .take(1)
                .for_each(|state| *state = *state & !1 | picked);
        }
    }
}

/// How many steps it is from each cell of the contact to a cell beside it; zero beside it.
pub(crate) fn distances(grid: &Grid, classes: &[u32], distances: &mut [u32]) {
    let far = (grid.width + grid.height) as u32;
    for (state, distance) in classes.iter().zip(distances.iter_mut()) {
        *distance = if class(*state) == PixelClass::Contact as u32 { far } else { 0 };
    }
    let mut relax = |cell: usize| {
        let near = neighbors(grid, cell).filter_map(|neighbor| distances.get(neighbor).copied()).min();
        let least = near.map_or(far, |near| near + 1);
        distances.iter_mut().skip(cell).take(1).for_each(|distance| *distance = least.min(*distance));
    };
    for cell in 0..grid.len() {
        relax(cell);
    }
    for cell in (0..grid.len()).rev() {
        relax(cell);
    }
}
