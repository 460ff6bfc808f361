//! Squares of four neighboring pixels, the stencil of every finite difference in the pipeline.

use crate::picture::{Image, WINDOW, Window};

/// Two windows of the rows `y` and `y + 1`, and which pixels of them are inliers.
///
/// Pixel `i` of both rows and the next one, `i + 1`, make cell `i`. The windows of neighboring blocks overlap by one
/// column, so every cell belongs to exactly one block; the last row and column begin no cell, but their pairs along the
/// border are in a block too.
pub struct Block {
    /// Row `y`, the upper one in the picture.
    pub top: Window,
    /// Row `y + 1`; empty below the last row.
    pub bottom: Window,
    /// Inliers of `top`.
    pub top_bits: u64,
    /// Inliers of `bottom`.
    pub bottom_bits: u64,
    /// The pixels that begin a cell or pair of this block rather than of the next.
    own: u64,
}

impl Block {
    /// Pixels `i` for which `i` and `i + 1` of the top row are inliers.
    #[must_use]
    pub const fn horizontal(&self) -> u64 {
        self.top_bits & (self.top_bits >> 1) & self.own
    }

    /// Pixels `i` for which `i` of both rows is an inlier.
    #[must_use]
    pub const fn vertical(&self) -> u64 {
        self.top_bits & self.bottom_bits & self.own
    }

    /// Pixels `i` for which bottom `i` and top `i + 1` are inliers: the diagonal that rises to the right.
    #[must_use]
    pub const fn rising(&self) -> u64 {
        self.bottom_bits & (self.top_bits >> 1) & self.own
    }

    /// Pixels `i` for which top `i` and bottom `i + 1` are inliers: the diagonal that falls to the right.
    #[must_use]
    pub const fn falling(&self) -> u64 {
        self.top_bits & (self.bottom_bits >> 1) & self.own
    }

    /// Inliers of the top row that belong to this block rather than to the next.
    #[must_use]
    pub const fn own_top(&self) -> u64 {
        self.top_bits & self.own
    }

    /// Cells of four inliers.
    #[must_use]
    pub const fn cells(&self) -> u64 {
        self.horizontal() & self.vertical() & (self.bottom_bits >> 1)
    }
}

impl Default for Block {
    fn default() -> Self {
        Self { top: Window::new(), bottom: Window::new(), top_bits: 0, bottom_bits: 0, own: u64::MAX >> 1 }
    }
}

/// Visits the picture as blocks, top row first. `inliers` gives the bits of a window's inliers.
pub fn for_each_block(image: &Image, inliers: impl Fn(&Window) -> u64, mut visit: impl FnMut(&Block)) {
    let mut block = Block::default();
    for y in 0..image.height() {
        let read = |x, window: &mut Window, row| image.read(x, y + row, window);
        for_each_block_of_rows(image.width(), &mut block, read, &inliers, &mut visit);
    }
}

/// Visits the blocks of two neighboring rows `width` pixels wide. `read` gives the pixels from a column on, of the upper
/// row, 0, or the lower one, 1; `block` is where they are put.
pub fn for_each_block_of_rows(
    width: usize,
    block: &mut Block,
    read: impl Fn(usize, &mut Window, usize),
    inliers: impl Fn(&Window) -> u64,
    mut visit: impl FnMut(&Block),
) {
    for x in (0..width).step_by(WINDOW - 1) {
        read(x, &mut block.top, 0);
        block.top_bits = inliers(&block.top);
        read(x, &mut block.bottom, 1);
        block.bottom_bits = inliers(&block.bottom);
        visit(block);
    }
}
