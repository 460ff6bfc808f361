//! The slopes of the depth that there is so far, smoothed.

use super::boxes;
use super::map::{Map, row_of_mut};
use super::vector::{Vector, unit};

/// Writes the mean slopes p and q over windows of `2 radius + 1` pixels a side into the first two planes; the other two are used
/// on the way.
pub(super) fn of(depth: &Map<f32>, classes: &Map<u8>, radius: usize, planes: [&mut [f32]; 4]) {
    let width = classes.width.max(1);
    let [p, q, count, between] = planes;
    for (y, p) in p.chunks_exact_mut(width).enumerate() {
        let [q, count] = [row_of_mut(q, width, y), row_of_mut(count, width, y)];
        let (above, here, below) = (depth.row(y.wrapping_sub(1)), depth.row(y), depth.row(y + 1));
        let [up, own, down] = [y.wrapping_sub(1), y, y + 1].map(|y| classes.row(y));
        let row = p.iter_mut().zip(q.iter_mut()).zip(count.iter_mut());
        for (x, ((p, q), count)) in row.enumerate() {
            let at = |depths: &[f32], bytes: &[u8], x: usize| match (depths.get(x), bytes.get(x)) {
                (Some(&depth), Some(&byte)) if byte != 0 => Some(depth),
                _ => None,
            };
            let Some(z) = at(here, own, x) else {
                (*p, *q, *count) = (0.0, 0.0, 0.0);
                continue;
            };
            *p = slope(at(here, own, x.wrapping_sub(1)), z, at(here, own, x + 1));
            *q = slope(at(below, down, x), z, at(above, up, x));
            *count = 1.0;
        }
    }
    for plane in [&mut *p, &mut *q, &mut *count] {
        boxes::sums(plane, between, width, radius);
    }
    for ((p, q), &count) in p.iter_mut().zip(q.iter_mut()).zip(&*count) {
        let inverse = 1.0 / count.max(1.0);
        *p *= inverse;
        *q *= inverse;
    }
}

/// The slope along an axis, from the depths before, here and after.
fn slope(before: Option<f32>, here: f32, after: Option<f32>) -> f32 {
    match (before, after) {
        (Some(before), Some(after)) => 0.5 * (after - before),
        (None, Some(after)) => after - here,
        (Some(before), None) => here - before,
        (None, None) => 0.0,
    }
}

/// The normal of a surface with these slopes.
#[inline]
pub(super) fn normal(p: f32, q: f32) -> Vector {
    unit([-p, -q, 1.0])
}
