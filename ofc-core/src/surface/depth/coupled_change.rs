//! How far a step moves a surface, whatever it does to the mean depth of its regions, which is settled elsewhere.
//!
//! What counts are changes free of their mean along every run of pixels in a row, and along every run in a column.

use super::coupled_equations::Triple;
use libm::sqrt;

/// What a step does to all pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Change {
    squared: f64,
    depth_squared: f64,
    depth_sum: f64,
    slopes_squared: f64,
}

impl Change {
    /// The root mean square of the changes of depth, and that of depth, less its mean, and slopes together.
    pub fn sizes(&self, pixels: f64) -> [f64; 2] {
        let mean = self.depth_sum / pixels;
        let depth = (self.depth_squared / pixels - mean * mean).max(0.0);
        [sqrt(self.squared.max(0.0) / pixels), sqrt(depth + self.slopes_squared / pixels)]
    }
}

/// A change in the making, row after row.
pub(super) struct Changes<'a> {
    total: Change,
    /// Sum and number of the changes in the run of the row.
    row: [f64; 2],
    /// The same for the run of every column.
    columns: [&'a mut [f32]; 2],
}

impl<'a> Changes<'a> {
    /// None so far; `columns` is scratch.
    pub fn new(mut columns: [&'a mut [f32]; 2]) -> Self {
        for column in &mut columns {
            column.fill(0.0);
        }
        Self { total: Change::default(), row: [0.0; 2], columns }
    }

    /// Adds the pixel in column `x`: how its depth changes, and what it is then.
    #[inline(always)]
    pub fn add(&mut self, x: usize, change: f32, now: Triple) {
        let [sum, number] = &mut self.row;
        *sum += f64::from(change);
        *number += 1.0;
        for (column, value) in self.columns.iter_mut().zip([change, 1.0]) {
            if let Some(slot) = column.get_mut(x) {
                *slot += value;
            }
        }
        let ([z, p, q], change) = (now.map(f64::from), f64::from(change));
        self.total.squared += 2.0 * change * change;
        self.total.depth_squared += z * z;
        self.total.depth_sum += z;
        self.total.slopes_squared += p * p + q * q;
    }

    /// Ends the run of the row.
    pub fn end_row(&mut self) {
        self.total.squared -= of_mean(self.row);
        self.row = [0.0; 2];
    }

    /// Ends the run of column `x`.
    #[inline(always)]
    pub fn end_column(&mut self, x: usize) {
        let mut run = [0.0; 2];
        for (run, column) in run.iter_mut().zip(&mut self.columns) {
            if let Some(slot) = column.get_mut(x) {
                *run = f64::from(core::mem::take(slot));
            }
        }
        self.total.squared -= of_mean(run);
    }

    /// All of it.
    pub fn finish(mut self) -> Change {
        for x in 0..self.columns[0].len() {
            self.end_column(x);
        }
        self.total
    }
}

/// The part of the sum of squares of a run that is due to its mean.
fn of_mean([sum, number]: [f64; 2]) -> f64 {
    if number > 0.0 { sum * sum / number } else { 0.0 }
}
