//! The coupled model between a grid and the next coarser one.
//!
//! Every block says by its depth and slopes what plane it stands for, and a pixel takes the mean of what the blocks around it
//! say there, with the shares of [`transfer`](super::transfer). Planes and their bending come out as a fine grid has them,
//! with depths that fit the slopes: if depth were interpolated for itself, the misfit would resist every correction by a coarse
//! grid (the locking of thin plates in finite elements).

use super::coupled_change::{Change, Changes};
use super::coupled_equations::{Coefficients, Coupled, Equations, Right, Triple};
use super::coupled_levels::{Level, Packed};
use super::grid::Grid;
use super::operator::{Network, at};
use super::span::{Span, StoredSpan};
use super::sweep::dot;
use super::transfer::{beyond, coarse_index, shares};

/// A block that a pixel takes from.
struct Parent {
    /// Where it lies in its arrays.
    index: usize,
    /// Of what it says about depth.
    share: f32,
    /// Of its slopes, in units of the pixel, which is half as wide.
    slope: f32,
    /// Where the pixel lies from its middle, in blocks, y up.
    x: f32,
    y: f32,
}

/// Edges that hold a pixel, beside its masses.
const EDGES: f32 = 4.0;

/// The part of a block's correction that suits a pixel: little for a pixel that data hold in a block that hardly any hold.
#[inline(always)]
fn part(block: f32, pixel: f32) -> f32 {
    ((0.25 * block + EDGES) / (pixel + EDGES)).min(1.0)
}

/// The blocks that pixel `(x, y)` takes from.
#[inline(always)]
fn parents(operator: &impl Coupled, coarse: &Packed, x: usize, y: usize) -> [Parent; 3] {
    let [own, beside, across] = shares(operator, x, y);
    let index = operator.grid().start(y) + x;
    let (mass, anchor) = (operator.mass(index), operator.anchor(index));
    let (dx, dy) =
        (if x.is_multiple_of(2) { -0.25 } else { 0.25 }, if y.is_multiple_of(2) { 0.25 } else { -0.25 });
    let parent = |share: f32, column: usize, row: usize, x: f32, y: f32| {
        // Outside of the grid there is only padding, of which nobody takes a share.
        let (index, share) =
            coarse_index(&coarse.grid(), column, row).map_or((0, 0.0), |index| (index, share));
        let slope = 0.5 * share * part(coarse.mass(index), mass);
        Parent { index, share: share * part(coarse.anchor(index), anchor), slope, x, y }
    };
    [
        parent(own, x / 2, y / 2, dx, dy),
        parent(beside, beyond(x), y / 2, -3.0 * dx, dy),
        parent(across, x / 2, beyond(y), dx, -3.0 * dy),
    ]
}

/// What a pixel takes from the correction of the coarse grid.
#[inline(always)]
fn prolong(parents: &[Parent; 3], correction: &[&mut [f32]; 3]) -> Triple {
    let mut sum = [0.0; 3];
    let [z, p, q] = &mut sum;
    let [depths, ps, qs] = correction;
    for parent in parents {
        let (across, up) = (at(ps, parent.index), at(qs, parent.index));
        *z += parent.share * (at(depths, parent.index) + (parent.x * across + parent.y * up));
        *p += parent.slope * across;
        *q += parent.slope * up;
    }
    sum
}

impl<O: Coupled, R: Right> Equations<'_, O, R> {
    /// Makes the residual the right side of the coarse grid and its correction zero.
    #[inline(never)]
    pub fn descend(&mut self, spans: &[StoredSpan], coarse: &mut Level) {
        for array in coarse.right.iter_mut().chain(&mut coarse.correction) {
            array.fill(0.0);
        }
        let operator = self.operator;
        let below = coarse.operator;
        let [right_z, right_p, right_q] = &mut coarse.right;
        self.residuals(spans, |x, y, [z, p, q]| {
            for Parent { index, share, slope, x, y } in parents(&operator, &below, x, y) {
                let depth = share * z;
                let [slot_z, slot_p, slot_q] =
                    [&mut *right_z, right_p, right_q].map(|array| array.get_mut(index));
                if let (Some(slot_z), Some(slot_p), Some(slot_q)) = (slot_z, slot_p, slot_q) {
                    *slot_z += depth;
                    *slot_p += slope * p + x * depth;
                    *slot_q += slope * q + y * depth;
                }
            }
        });
    }

    /// Adds the correction of the coarse grid, of the length that lowers the energy most.
    #[inline(never)]
    pub fn correct(&mut self, spans: &[StoredSpan], coarse: &Level, above: &mut [&mut [f32]; 3]) -> Change {
        let energy = self.energy(spans, coarse, above);
        let grid = coarse.operator.grid();
        let gain: f64 = coarse.right.iter().zip(&coarse.correction).map(|(r, c)| product(&grid, r, c)).sum();
        let step = if gain > 0.0 && energy > 0.0 { (gain / energy) as f32 } else { 0.0 };
        let (operator, below) = (self.operator, coarse.operator);
        let [sums, numbers, _] = above;
        let mut changes = Changes::new([sums, numbers]);
        let grid = operator.grid();
        for y in 0..grid.height {
            let [first, last] = Span::load(spans, y, grid.width).active;
            let mut rows = self.unknowns.each_mut().map(|field| field.row_mut(y));
            let start = grid.start(y);
            for x in 0..grid.width {
                if x < first || x >= last || !operator.is_inside(start + x) {
                    changes.end_row();
                    changes.end_column(x);
                    continue;
                }
                let change = prolong(&parents(&operator, &below, x, y), &coarse.correction);
                for (row, change) in rows.iter_mut().zip(change) {
                    if let Some(value) = row.get_mut(x) {
                        *value += step * change;
                    }
                }
                // A step that had to be short says that there is more to do, not less.
                changes.add(x, step.max(1.0) * change[0], rows.each_ref().map(|row| at(row, x)));
            }
            changes.end_row();
        }
        changes.finish()
    }

    /// The energy of the correction of the coarse grid; `above` is scratch.
    fn energy(&self, spans: &[StoredSpan], coarse: &Level, above: &mut [&mut [f32]; 3]) -> f64 {
        let (operator, below) = (self.operator, coarse.operator);
        for row in &mut *above {
            row.fill(0.0);
        }
        let mut energy = 0.0;
        for y in 0..operator.grid().height {
            let start = operator.grid().start(y);
            let [first, last] = Span::load(spans, y, operator.grid().width).active;
            let mut left = [0.0; 3];
            let mut sum = 0.0;
            for x in first..last {
                let own = prolong(&parents(&operator, &below, x, y), &coarse.correction);
                let up = above.each_ref().map(|row| at(row, x));
                sum += Coefficients::of(&operator, start + x, self.stiffness).energy(
                    self.stiffness,
                    own,
                    left,
                    up,
                );
                for (row, own) in above.iter_mut().zip(own) {
                    if let Some(slot) = row.get_mut(x) {
                        *slot = own;
                    }
                }
                left = own;
            }
            energy += f64::from(sum);
        }
        energy
    }
}

/// The product of two arrays of a grid.
fn product(grid: &Grid, a: &[f32], b: &[f32]) -> f64 {
    (0..grid.height).map(|y| dot(grid.row(a, y), grid.row(b, y))).sum()
}
