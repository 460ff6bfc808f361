//! The equations of every frequency along the rows: `(2 + lambda) z_x - z_(x-1) - z_(x+1) = b_x` with natural ends.
//!
//! With r < 1 the root of `r^2 - (2 + lambda) r + 1`, the equations are r times a recursion to the right and one to the
//! left. What enters from beyond an end is known in closed form, because both sides go on as mirror images.
//! Next to one, r is too coarse in f32: the recursions use s = 1 - r.
//!
//! # Reference
//! M. Unser, A. Aldroubi, M. Eden, "B-spline signal processing: part II", IEEE Trans. Signal Process. 41 (1993), box 1: the
//! same recursions for another root.

use super::cosine_transform::Rows;
use super::operator::copy;
use core::array::from_fn;
use core::f64::consts::PI;
use libm::{exp, log1p, sin, sqrt};

/// Frequencies that are worked on together.
const BLOCK: usize = 16;

/// `exp` of minus this is nothing in f32.
const NOTHING: f64 = 28.0;

/// One minus the root of frequency `k` of `n`, zero for frequency zero.
pub(super) fn gap(k: usize, n: usize) -> f64 {
    let sine = sin(PI * k as f64 / (2 * n) as f64);
    2.0 * sine * (sqrt(1.0 + sine * sine) - sine)
}

/// Solves in place but for the factor r: row x holds column x of every frequency below `n`, `width` rows. Frequency zero
/// (which has no such factor) gets the solution without mean.
pub(super) fn solve(spectrum: &mut Rows<&mut [f32]>, width: usize, n: usize) {
    let stride = spectrum.stride;
    let Some(data) = spectrum.data.get_mut(..width * stride) else { return };
    sum_twice(data, stride);
    for k in (1..n).step_by(BLOCK) {
        solve_block(data, stride, k, n);
    }
}

/// Frequency zero: differences are sums of right sides, and values are sums of differences, free of their mean.
fn sum_twice(data: &mut [f32], stride: usize) {
    let first = |row: &[f32]| row.first().copied().map_or(0.0, f64::from);
    let rows = || data.chunks_exact(stride.max(1));
    let mean = |sum: f64| sum / rows().len().max(1) as f64;
    let surplus = mean(rows().map(first).sum());
    let (mut value, mut difference, mut sum) = (0.0, 0.0, 0.0);
    for row in rows() {
        sum += value;
        difference -= first(row) - surplus;
        value += difference;
    }
    (value, difference) = (-mean(sum), 0.0);
    for row in data.chunks_exact_mut(stride.max(1)) {
        difference -= first(row) - surplus;
        if let Some(slot) = row.first_mut() {
            *slot = value as f32;
        }
        value += difference;
    }
}

type Block = [f32; BLOCK];

/// Frequencies `k` to `k + BLOCK`, as far as there are.
#[inline(never)]
fn solve_block(data: &mut [f32], stride: usize, k: usize, n: usize) {
    let width = data.len() / stride.max(1);
    let end = n.min(k + BLOCK);
    let gaps: [f64; BLOCK] = from_fn(|i| gap((k + i).min(n - 1), n));
    let s = gaps.map(|gap| gap as f32);
    let next = |b: Block, value: Block| -> Block {
        let mut next = b;
        for ((next, value), s) in next.iter_mut().zip(value).zip(s) {
            *next += value - s * value;
        }
        next
    };
    // The first frequency reaches furthest.
    let reach = NOTHING / gap(k, n);
    #[expect(clippy::cast_sign_loss, reason = "positive")]
    let near_rows = reach as usize;
    let rows = data.chunks_exact(stride.max(1));
    let mut value = if near_rows < width {
        // Not `take`: its way back slices with a check.
        let near = data.get(..near_rows * stride).unwrap_or_default().chunks_exact(stride.max(1));
        near.rev().fold([0.0; BLOCK], |sum, row| next(load(row, k, end), sum))
    } else {
        let near = rows.clone().rev().fold([0.0; BLOCK], |sum, row| next(load(row, k, end), sum));
        let far = rows.fold([0.0; BLOCK], |sum, row| next(load(row, k, end), sum));
        let mut value = near;
        for ((value, far), gap) in value.iter_mut().zip(far).zip(gaps) {
            let across = exp(width as f64 * log1p(-gap));
            *value = ((f64::from(*value) + across * f64::from(far)) / (1.0 - across * across)) as f32;
        }
        value
    };
    for row in data.chunks_exact_mut(stride.max(1)) {
        value = next(load(row, k, end), value);
        store(row, k, end, value);
    }
    // As if the value beyond the end were the last one.
    for (value, s) in value.iter_mut().zip(s) {
        *value /= s;
    }
    for row in data.chunks_exact_mut(stride.max(1)).rev() {
        value = next(load(row, k, end), value);
        store(row, k, end, value);
    }
}

#[inline(always)]
fn load(row: &[f32], k: usize, end: usize) -> Block {
    let row = row.get(k..end).unwrap_or_default();
    row.first_chunk().copied().unwrap_or_else(|| {
        let mut block = [0.0; BLOCK];
        copy(&mut block, row);
        block
    })
}

#[inline(always)]
fn store(row: &mut [f32], k: usize, end: usize, block: Block) {
    let row = row.get_mut(k..end).unwrap_or_default();
    if let Some(row) = row.first_chunk_mut() {
        *row = block;
    } else {
        copy(row, &block);
    }
}
