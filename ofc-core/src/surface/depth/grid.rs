//! A padded grid: how the pixels of a picture, or of one of its coarser grids, lie in an array.
//!
//! A grid is stored with one column of padding (it stands to the right of a row and to the left of the next), a row
//! above, a row below and one number more. The padding stays zero, so that every pixel has four neighbors and no
//! kernel knows about borders.

/// A padded grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    pub width: usize,
    pub height: usize,
}

impl Grid {
    /// From a pixel to the one below.
    pub const fn stride(&self) -> usize {
        self.width + 1
    }

    /// Numbers in one array.
    pub const fn len(&self) -> usize {
        (self.height + 2) * self.stride() + 1
    }

    /// Index of the first pixel of row `y`.
    pub const fn start(&self, y: usize) -> usize {
        (y + 1) * self.stride() + 1
    }

    /// The next coarser grid, of 2x2 blocks.
    pub const fn coarser(&self) -> Self {
        Self { width: self.width.div_ceil(2), height: self.height.div_ceil(2) }
    }

    /// A single pixel has no equation left to solve by going coarser.
    pub const fn is_coarsest(&self) -> bool {
        self.width <= 1 && self.height <= 1
    }

    /// Zeroes all of `array` that is not a pixel.
    pub fn clear_padding<T: Copy + Default>(&self, array: &mut [T]) {
        let stride = self.stride();
        let (above, rest) = array.split_at_mut_checked(stride + 1).unwrap_or_default();
        above.fill(T::default());
        for row in rest.chunks_mut(stride.max(1)).take(self.height) {
            row.iter_mut().skip(self.width).for_each(|padding| *padding = T::default());
        }
        rest.iter_mut().skip(self.height * stride).for_each(|padding| *padding = T::default());
    }

    /// Row `y` of `array`, none when there is no such row.
    pub fn row<'a, T>(&self, array: &'a [T], y: usize) -> &'a [T] {
        let start = self.start(y);
        array.get(start..start + self.width).unwrap_or_default()
    }

    /// Row `y` of `array` for writing.
    pub fn row_mut<'a, T>(&self, array: &'a mut [T], y: usize) -> &'a mut [T] {
        let start = self.start(y);
        array.get_mut(start..start + self.width).unwrap_or_default()
    }

    /// Row `y` with the padding (or the neighbor's padding) before and after it.
    pub fn padded_row<'a>(&self, array: &'a [f32], y: usize) -> &'a [f32] {
        let start = self.start(y) - 1;
        array.get(start..start + self.width + 2).unwrap_or_default()
    }

    /// The row above row `y`: padding above row 0.
    pub fn row_above<'a, T>(&self, array: &'a [T], y: usize) -> &'a [T] {
        let start = self.start(y) - self.stride();
        array.get(start..start + self.width).unwrap_or_default()
    }
}
