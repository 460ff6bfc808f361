//! Which cells differ from the plane by more than noise.
//!
//! The noise of each channel is the median distance from the plane, which most cells lie on. Cells beyond five deviations are the
//! contact, once what is narrower than three cells is taken away; around it lies a skirt of five cells in which the relief
//! comes up from the plane.

use super::bit_rows::{BitRows, is_set};
use super::grid::{BRIDGED, Cell, Grid, class, neighbors};
use super::result::PixelClass;
use crate::color::dispersion::CONSISTENCY;
use crate::math::select::{kth_smallest, median_rank};

/// Deviations from the plane of a cell of the contact.
pub(crate) const DEVIATIONS: f32 = 5.0;

/// Cells of the skirt.
pub(crate) const SKIRT: usize = 5;

/// At most about so many cells say what the noise is.
const MOST_CELLS: usize = 6000;

/// The deviation of each channel of the known cells from the plane, at least `least`; `None` where there are none. Of many cells those of every
/// second or third row and column count.
///
/// # Scratch
/// One `f32` a cell.
pub(super) fn noise(
    grid: &Grid,
    planes: &[&mut [f32]; 3],
    states: &[u32],
    least: [f64; 3],
    scratch: &mut [f32],
) -> Option<[f64; 3]> {
    let step = grid.step(MOST_CELLS);
    let mut deviations = [0.0; 3];
    for ((deviation, plane), least) in deviations.iter_mut().zip(planes).zip(least) {
        let (mut count, mut y) = (0, 0);
        while y < grid.height {
            let mut x = 0;
            while x < grid.width {
                let cell = y * grid.width + x;
                if states.get(cell) == Some(&(Cell::Known as u32))
                    && let (Some(value), Some(slot)) = (plane.get(cell), scratch.get_mut(count))
                {
                    *slot = value.abs();
                    count += 1;
                }
                x += step.get();
            }
            y += step.get();
        }
        let median = kth_smallest(scratch.get(..count)?, median_rank(count))?;
        *deviation = f64::max(CONSISTENCY * f64::from(median), least);
    }
    Some(deviations)
}

/// Turns the states of cells into classes of [`PixelClass`], with the bit [`BRIDGED`] where the cell was missing.
///
/// # Scratch
/// `other`: one integer a cell.
pub(super) fn classify(
    grid: &Grid,
    planes: &[&mut [f32]; 3],
    noise: [f64; 3],
    states: &mut [u32],
    other: &mut [u32],
) {
    let reciprocals = noise.map(|deviation| 1.0 / (deviation as f32).max(f32::EPSILON));
    let mut rows = BitRows::new(other, grid.width, grid.height);
    for (y, states) in states.chunks(grid.width.max(1)).enumerate() {
        let [red, green, blue] =
            planes.each_ref().map(|plane| plane.get(y * grid.width..).unwrap_or_default());
        let colors = red.iter().zip(green).zip(blue).map(|((red, green), blue)| [*red, *green, *blue]);
        rows.set(
            y,
            states.iter().zip(colors).map(|(state, delta)| {
                let [r, g, b] = delta;
                let [r, g, b] = [r * reciprocals[0], g * reciprocals[1], b * reciprocals[2]];
                *state != Cell::Outside as u32 && r * r + g * g + b * b > DEVIATIONS * DEVIATIONS
            }),
        );
    }
    rows.shrink(1);
    rows.grow(1);
    rows.keep();
    rows.grow(SKIRT);
    for (y, states) in states.chunks_mut(grid.width.max(1)).enumerate() {
        let [contact, near] = [rows.kept(y), rows.get(y)];
        for (x, state) in states.iter_mut().enumerate() {
            let class = if *state == Cell::Outside as u32 {
                PixelClass::None
            } else if is_set(&contact, x) {
                PixelClass::Contact
            } else if is_set(&near, x) {
                PixelClass::Skirt
            } else {
                PixelClass::Plane
            };
            *state = class as u32 | if *state == Cell::Missing as u32 { BRIDGED } else { 0 };
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
