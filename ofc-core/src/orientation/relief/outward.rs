//! Whether the slopes are those of a relief that rises from the plane, or that goes down.
//!
//! A row through the contact is a profile that begins and ends on the plane. The area below it is, but for a factor, the sum of each
//! slope times its distance from the middle of the run of cells; so the normals of what rises point outward from the middle, row by
//! row and column by column, however many contacts there are and whatever their shape.

use super::grid::Grid;
use super::scale::Inner;
use libm::fabs;

/// From -1, for what surely goes down, to 1, for what surely rises.
pub(super) fn outward(inner: &Inner) -> f64 {
    let (mut sum, mut most) = (0.0, 0.0);
    arms(
        inner.grid,
        |cell| inner.is_contact(cell),
        |cell, component, arm| {
            let slope = inner.slope(cell).into_iter().skip(component).take(1).sum::<f64>();
            let outward = slope * arm;
            sum += outward;
            most += fabs(outward);
        },
    );
    if most > 0.0 { sum / most } else { 0.0 }
}

/// Visits each cell of the contact twice, once in its row and once in its column: with the component of the slope that lies along it,
/// and how far it is from the middle of its run, positive to the right and up.
pub(crate) fn arms(
    grid: &Grid,
    is_contact: impl Fn(usize) -> bool,
    mut visit: impl FnMut(usize, usize, f64),
) {
    let (width, height) = (grid.width, grid.height);
    for y in 0..height {
        let cell = |x: usize| y * width + x;
        runs(width, |x| is_contact(cell(x)), |x, arm| visit(cell(x), 0, arm));
    }
    for x in 0..width {
        let cell = |y: usize| y * width + x;
        runs(height, |y| is_contact(cell(y)), |y, arm| visit(cell(y), 1, -arm));
    }
}

/// Visits the runs of one row or column.
fn runs(len: usize, is_contact: impl Fn(usize) -> bool, mut visit: impl FnMut(usize, f64)) {
    let mut start = 0;
    while start < len {
        let mut end = start;
        while end < len && is_contact(end) {
            end += 1;
        }
        let middle = 0.5 * (start + end) as f64 - 0.5;
        for i in start..end {
            visit(i, i as f64 - middle);
        }
        start = end + 1;
    }
}
