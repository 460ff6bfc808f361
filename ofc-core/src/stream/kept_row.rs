//! The row before, kept in the memory of a pass for the pairs and cells that it makes with the next one.

use super::memory::Memory;
use crate::picture::{Image, WINDOW, Window, first_bits, for_each_bit};

/// Keeps a row for the blocks that it makes with the next one: channels apart, red NaN where the mask leaves a pixel out.
#[inline(never)]
pub(super) fn keep(row: &Image, memory: &mut Memory) {
    let width = row.width();
    row.for_each_window(|window| keep_window(width, window, window.masked, memory.values));
}

/// Keeps one window of a row: red is NaN for all but `bits`.
#[inline(never)]
pub(super) fn keep_window(width: usize, window: &Window, bits: u64, values: &mut [f32]) {
    for (channel, color) in window.color.iter().enumerate() {
        copy(values.get_mut(channel * width + window.x..).unwrap_or_default(), color, window.len);
    }
    let red = values.get_mut(window.x..).unwrap_or_default();
    for_each_bit(first_bits(window.len) & !bits, |i| {
        if let Some(out) = red.get_mut(i) {
            *out = f32::NAN;
        }
    });
}

/// Copies `count` values, of as many as there are.
fn copy(to: &mut [f32], from: &[f32], count: usize) {
    if let (Some(to), Some(from)) = (to.get_mut(..count), from.get(..count)) {
        to.copy_from_slice(from);
    }
}

/// The pixels that are kept of the row before, from column `x` on.
pub(super) fn kept(x: usize, width: usize, memory: &Memory, window: &mut Window) {
    window.x = x;
    window.len = width.saturating_sub(x).min(WINDOW);
    window.masked = first_bits(window.len);
    for (channel, out) in window.color.iter_mut().enumerate() {
        copy(out, memory.values.get(channel * width + x..).unwrap_or_default(), window.len);
    }
}
