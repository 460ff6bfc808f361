//! W from the circulation of the slopes around windows.
//!
//! Around a square window the field (u . delta, v . delta) has the circulation z . (u, v), with z the sums of delta along the
//! bottom less those along the top, and along the right side less those along the left one. For the slopes of a surface it is
//! zero to first order. Minimizing the sum of squares relative to the energy of the field, w^T M w / w^T S w with w = (u, v), is a
//! generalized eigenproblem of six numbers. S holds the noise as well, so that a direction of color space that is nothing but
//! noise does not pass for a field.

use super::grid::{Grid, class};
use super::result::PixelClass;
use crate::math::mat3::Mat3;
use crate::math::mat6::Mat6;
use crate::math::pencil::{self, Smallest};

/// Cells along a window.
const WINDOW: usize = 16;

/// Windows begin so many cells apart.
const STEP: usize = 8;

/// A window has STEP^2 cells of its own, and its mean circulation is over WINDOW^2.
pub(crate) const WEIGHT: f64 = (STEP * STEP) as f64 / (WINDOW * WINDOW) as f64;

/// The least circulation, and what it belongs to.
pub(crate) struct Least {
    /// u and v, at an arbitrary scale.
    pub w: [[f64; 3]; 2],
    /// The mean squared circulation relative to the energy.
    pub circulation: f64,
    /// That of the second eigenvector.
    pub second: f64,
}

/// What the fields of delta that have the least circulation follow from: sums, which add from picture to picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Circulation {
    /// The sum of z z^T over all windows.
    pub squares: Mat6,
    /// The sum of delta delta^T, with the noise, over all cells of the contact and its skirt.
    pub energy: Mat3,
}

impl Circulation {
    /// Those of one picture.
    pub fn of(grid: &Grid, planes: &[&mut [f32]; 3], classes: &[u32], noise: [f64; 3]) -> Self {
        let raised =
            |cell: usize| classes.get(cell).is_some_and(|&state| class(state) >= PixelClass::Skirt as u32);
        let delta = |cell: usize| {
            let is_raised = raised(cell);
            [0, 1, 2].map(|k| {
                let value = planes.get(k).and_then(|plane| plane.get(cell));
                value.filter(|_| is_raised).map_or(0.0, |&value| f64::from(value))
            })
        };
        let Self { mut squares, mut energy } = Self::default();
        for cell in (0..grid.len()).filter(|&cell| raised(cell)) {
            let delta = delta(cell);
            add_product(&mut energy, &delta);
            for (i, (column, deviation)) in energy.iter_mut().zip(noise).enumerate() {
                column.iter_mut().skip(i).take(1).for_each(|entry| *entry += deviation * deviation);
            }
        }
        for y in (0..grid.height.saturating_sub(WINDOW)).step_by(STEP) {
            for x in (0..grid.width.saturating_sub(WINDOW)).step_by(STEP) {
                if let Some(z) = circulation(grid, classes, &delta, x, y) {
                    add_product(&mut squares, &z);
                }
            }
        }
        Self { squares, energy }
    }

    /// The field of the least circulation; `None` where delta has no energy.
    pub fn least(&self) -> Option<Least> {
        // u and v have the same energy.
        let mut energies = [[0.0; 6]; 6];
        for (i, column) in energies.iter_mut().enumerate() {
            let (halves, _) = column.as_chunks_mut::<3>();
            for (half, of) in halves.iter_mut().skip(i / 3).take(1).zip(self.energy.iter().skip(i % 3)) {
                *half = *of;
            }
        }
        let Smallest { vector, values: [circulation, second] } = pencil::smallest(&self.squares, &energies)?;
        let ([u, v], _) = vector.as_chunks::<3>() else { return None };
        Some(Least { w: [*u, *v], circulation: WEIGHT * circulation, second: WEIGHT * second })
    }
}

/// Adds v v^T.
fn add_product<const N: usize>(sum: &mut [[f64; N]; N], v: &[f64; N]) {
    for (column, factor) in sum.iter_mut().zip(v) {
        for (entry, value) in column.iter_mut().zip(v) {
            *entry += factor * value;
        }
    }
}

/// z of the window whose top left cell is (x, y); `None` where it reaches out of the mask.
fn circulation(
    grid: &Grid,
    classes: &[u32],
    delta: &impl Fn(usize) -> [f64; 3],
    x: usize,
    y: usize,
) -> Option<[f64; 6]> {
    let [mut across, mut down] = [[0.0; 3]; 2];
    let add = |sum: &mut [f64; 3], cell: usize, sign: f64| {
        let inside = classes.get(cell).is_some_and(|&state| class(state) != PixelClass::None as u32);
        sum.iter_mut().zip(delta(cell)).for_each(|(sum, value)| *sum += sign * value);
        inside.then_some(())
    };
    for i in 0..=WINDOW {
        let cell = |x, y| y * grid.width + x;
        add(&mut across, cell(x + i, y + WINDOW), 1.0)?;
        add(&mut across, cell(x + i, y), -1.0)?;
        add(&mut down, cell(x + WINDOW, y + i), 1.0)?;
        add(&mut down, cell(x, y + i), -1.0)?;
    }
    let ([a, b, c], [d, e, f]) = (across, down);
    Some([a, b, c, d, e, f])
}
