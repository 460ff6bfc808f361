//! Whether the slopes are those of a relief that rises from the plane, or that goes down.
//!
//! A row through the contact is a profile that begins and ends on the plane. The area below it is, but for a factor, the sum of each
//! slope times its distance from the middle of the run of cells; so the normals of what rises point outward from the middle, row by
//! row and column by column, however many contacts there are and whatever their shape.

use super::scale::Inner;
use libm::fabs;

/// From -1, for what surely goes down, to 1, for what surely rises.
pub(super) fn outward(inner: &Inner) -> f64 {
    let (width, height) = (inner.grid.width, inner.grid.height);
    let (mut sum, mut most) = (0.0, 0.0);
    for y in 0..height {
        let profile = |x: usize| (y * width + x, 0);
        add(inner, width, profile, 1.0, &mut sum, &mut most);
    }
    for x in 0..width {
        let profile = |y: usize| (y * width + x, 1);
        add(inner, height, profile, -1.0, &mut sum, &mut most);
    }
    if most > 0.0 { sum / most } else { 0.0 }
}

/// Adds the runs of one row or column. `cell` gives the cell at a place, and which component of the slope lies along it.
fn add(
    inner: &Inner,
    len: usize,
    cell: impl Fn(usize) -> (usize, usize),
    direction: f64,
    sum: &mut f64,
    most: &mut f64,
) {
    let is_contact = |i: usize| i < len && inner.is_contact(cell(i).0);
    let mut start = 0;
    while start < len {
        let mut end = start;
        while is_contact(end) {
            end += 1;
        }
        let middle = 0.5 * (start + end) as f64 - 0.5;
        for i in start..end {
            let (cell, component) = cell(i);
            let slope = inner.slope(cell).into_iter().skip(component).take(1).sum::<f64>();
            let outward = direction * slope * (i as f64 - middle);
            *sum += outward;
            *most += fabs(outward);
        }
        start = end + 1;
    }
}
