//! Pictures of numbers in memory that the caller lends, which may have gaps between rows.

use super::vector::{Vector, ZERO};
use crate::picture::span;

/// Row `y` of numbers without gaps, none where there is none. (Two `chunks_exact` side by side keep a division that can fail.)
pub(super) fn row_of<T>(numbers: &[T], width: usize, y: usize) -> &[T] {
    let start = y.wrapping_mul(width);
    numbers.get(start..start.wrapping_add(width)).unwrap_or_default()
}

/// The same, to be written.
pub(super) fn row_of_mut<T>(numbers: &mut [T], width: usize, y: usize) -> &mut [T] {
    let start = y.wrapping_mul(width);
    numbers.get_mut(start..start.wrapping_add(width)).unwrap_or_default()
}

/// A number a pixel.
#[derive(Debug)]
pub(super) struct Map<'a, T> {
    pub data: &'a mut [T],
    pub row_stride: usize,
    pub width: usize,
}

impl<'a, T: Copy + Default> Map<'a, T> {
    /// `None` where the memory is too short.
    pub fn new(data: &'a mut [T], [width, height]: [usize; 2], row_stride: usize) -> Option<Self> {
        let need = span(width, height, 1, row_stride).ok()?;
        Some(Self { data: data.get_mut(..need)?, row_stride, width })
    }

    /// Row `y`, none outside of the picture.
    #[inline]
    pub fn row(&self, y: usize) -> &[T] {
        let start = y.wrapping_mul(self.row_stride);
        self.data.get(start..start.wrapping_add(self.width)).unwrap_or_default()
    }

    #[inline]
    pub fn row_mut(&mut self, y: usize) -> &mut [T] {
        let start = y.wrapping_mul(self.row_stride);
        self.data.get_mut(start..start.wrapping_add(self.width)).unwrap_or_default()
    }

    /// The number at (x, y), zero outside of the picture.
    #[inline]
    pub fn at(&self, x: usize, y: usize) -> T {
        self.row(y).get(x).copied().unwrap_or_default()
    }

    #[inline]
    pub fn set(&mut self, x: usize, y: usize, value: T) {
        if let Some(slot) = self.row_mut(y).get_mut(x) {
            *slot = value;
        }
    }
}

/// Three numbers a pixel.
#[derive(Debug)]
pub(super) struct Vectors<'a> {
    pub data: &'a mut [f32],
    pub row_stride: usize,
    pub width: usize,
}

impl<'a> Vectors<'a> {
    /// `None` where the memory is too short.
    pub fn new(data: &'a mut [f32], [width, height]: [usize; 2], row_stride: usize) -> Option<Self> {
        let need = span(width, height, 3, row_stride).ok()?;
        Some(Self { data: data.get_mut(..need)?, row_stride, width })
    }

    /// Row `y`, none outside of the picture.
    #[inline]
    pub fn row(&self, y: usize) -> &[Vector] {
        let start = y.wrapping_mul(self.row_stride);
        self.data.get(start..start.wrapping_add(3 * self.width)).unwrap_or_default().as_chunks().0
    }

    #[inline]
    pub fn row_mut(&mut self, y: usize) -> &mut [Vector] {
        let start = y.wrapping_mul(self.row_stride);
        self.data.get_mut(start..start.wrapping_add(3 * self.width)).unwrap_or_default().as_chunks_mut().0
    }

    /// The vector at (x, y), zero outside of the picture.
    #[inline]
    pub fn at(&self, x: usize, y: usize) -> Vector {
        self.row(y).get(x).copied().unwrap_or(ZERO)
    }
}
