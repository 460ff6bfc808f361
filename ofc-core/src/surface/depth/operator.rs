//! The equations of one row: edge weights and masses, at the finest grid out of one number a pixel, at coarse grids
//! stored, and all one inside a span.
//!
//! Every equation reads `sum over neighbors j of w_ij (z_i - z_j) + mass_i z_i = right_i`.

use super::grid::Grid;
use super::word::{self, Attachment};

/// `slice[i]`; the bound is known where it matters and the branch is optimized away.
#[inline(always)]
pub(super) fn at<T: Copy + Default>(slice: &[T], i: usize) -> T {
    slice.get(i).copied().unwrap_or_default()
}

/// Copies as much as fits: no lengths to disagree about.
#[inline(always)]
pub(super) fn copy(to: &mut [f32], from: &[f32]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = from;
    }
}

/// The coefficients of the equations of neighboring pixels of one row.
pub(super) trait Coefficients: Sized {
    /// Weights of the edges to the left, right, upper and lower neighbor of pixel `i`.
    fn edges(&self, i: usize) -> [f32; 4];
    /// The mass of pixel `i`.
    fn mass(&self, i: usize) -> f32;

    /// The right side minus this is what is left to do: `-(A z)_i`.
    #[inline(always)]
    fn flow(&self, i: usize, center: f32, neighbors: [f32; 4]) -> f32 {
        let [l, r, u, d] = neighbors;
        let [wl, wr, wu, wd] = self.edges(i);
        (wl * (l - center) + wr * (r - center)) + (wu * (u - center) + wd * (d - center))
            - self.mass(i) * center
    }

    /// One over the diagonal, or zero for a pixel without equation.
    #[inline(always)]
    fn inverse_diagonal(&self, i: usize) -> f32 {
        let [wl, wr, wu, wd] = self.edges(i);
        let diagonal = (wl + wr) + (wu + wd) + self.mass(i);
        if diagonal > 0.0 { 1.0 / diagonal } else { 0.0 }
    }
}

/// All edges one, no mass.
pub(super) struct Unit;

impl Coefficients for Unit {
    #[inline(always)]
    fn edges(&self, _: usize) -> [f32; 4] {
        [1.0; 4]
    }

    #[inline(always)]
    fn mass(&self, _: usize) -> f32 {
        0.0
    }

    #[inline(always)]
    fn flow(&self, _: usize, center: f32, [l, r, u, d]: [f32; 4]) -> f32 {
        ((l - center) + (r - center)) + ((u - center) + (d - center))
    }

    #[inline(always)]
    fn inverse_diagonal(&self, _: usize) -> f32 {
        0.25
    }
}

/// The graph of a matrix over a grid: its coefficients one by one, and how its pixels join blocks of the next coarser grid.
pub(super) trait Network {
    /// Weight of the edge between pixel `index` and its right neighbor.
    fn east(&self, index: usize) -> f32;
    /// Weight of the edge between pixel `index` and the one below.
    fn south(&self, index: usize) -> f32;
    /// The mass of pixel `index`.
    fn mass(&self, index: usize) -> f32;
    /// Where pixel `index` belongs at the next coarser grid.
    fn attachment(&self, index: usize) -> Attachment;
    /// The grid.
    fn grid(&self) -> Grid;

    /// The two edges of pixel `(x, y)` that lead out of its block, sideways and up or down: their weights and the pixels
    /// that they lead to.
    #[inline(always)]
    fn outward(&self, x: usize, y: usize) -> [(f32, usize); 2] {
        let grid = self.grid();
        let (index, stride) = (grid.start(y) + x, grid.stride());
        [
            if x.is_multiple_of(2) {
                (self.east(index - 1), index - 1)
            } else {
                (self.east(index), index + 1)
            },
            if y.is_multiple_of(2) {
                (self.south(index - stride), index - stride)
            } else {
                (self.south(index), index + stride)
            },
        ]
    }
}

/// A matrix over a grid, row by row.
pub(super) trait Operator: Network {
    /// The coefficients of a row.
    type Row<'a>: Coefficients
    where
        Self: 'a;

    /// The coefficients of the `n` pixels from index `start` on.
    fn row(&self, start: usize, n: usize) -> Option<Self::Row<'_>>;
}

/// How one word a pixel holds both the root of its weight and its mass.
pub(super) trait Packing: Copy {
    /// The word of a pixel of root weight one, without mass and flags.
    const UNIT: u32;
    fn root(self, word: u32) -> f32;
    fn mass(self, word: u32) -> f32;
}

/// The number is the root weight, and pixels of known depth have the one mass there is.
#[derive(Clone, Copy)]
pub(super) struct Anchored {
    pub mass: f32,
}

impl Packing for Anchored {
    const UNIT: u32 = word::ONE;

    #[inline(always)]
    fn root(self, word: u32) -> f32 {
        word::number(word)
    }

    #[inline(always)]
    fn mass(self, word: u32) -> f32 {
        if word::is_known(word) { self.mass } else { 0.0 }
    }
}

/// The finest grid: the weight of an edge is the product of the root weights of its two pixels, that is, the
/// geometric mean of their weights.
#[derive(Clone, Copy)]
pub(super) struct Fine<'a, P> {
    pub grid: Grid,
    pub words: &'a [u32],
    pub packing: P,
}

/// A row of [`Fine`].
pub(super) struct FineRow<'a, P> {
    center: &'a [u32],
    neighbors: [&'a [u32]; 4],
    packing: P,
}

impl<P: Packing> Coefficients for FineRow<'_, P> {
    #[inline(always)]
    fn edges(&self, i: usize) -> [f32; 4] {
        let center = self.packing.root(at(self.center, i));
        let [l, r, u, d] = self.neighbors;
        [l, r, u, d].map(|row| center * self.packing.root(at(row, i)))
    }

    #[inline(always)]
    fn mass(&self, i: usize) -> f32 {
        self.packing.mass(at(self.center, i))
    }
}

impl<P: Packing> Operator for Fine<'_, P> {
    type Row<'r>
        = FineRow<'r, P>
    where
        Self: 'r;

    #[inline(always)]
    fn row(&self, start: usize, n: usize) -> Option<FineRow<'_, P>> {
        let stride = self.grid.stride();
        let cut = |from: usize| self.words.get(from..from + n);
        Some(FineRow {
            center: cut(start)?,
            neighbors: [cut(start - 1)?, cut(start + 1)?, cut(start - stride)?, cut(start + stride)?],
            packing: self.packing,
        })
    }
}

impl<P: Packing> Network for Fine<'_, P> {
    #[inline(always)]
    fn east(&self, index: usize) -> f32 {
        self.packing.root(at(self.words, index)) * self.packing.root(at(self.words, index + 1))
    }

    #[inline(always)]
    fn south(&self, index: usize) -> f32 {
        let below = at(self.words, index + self.grid.stride());
        self.packing.root(at(self.words, index)) * self.packing.root(below)
    }

    #[inline(always)]
    fn mass(&self, index: usize) -> f32 {
        self.packing.mass(at(self.words, index))
    }

    #[inline(always)]
    fn attachment(&self, index: usize) -> Attachment {
        word::attachment(at(self.words, index))
    }

    fn grid(&self) -> Grid {
        self.grid
    }
}

/// A coarse grid: stored edge weights, whose signs hold the attachment.
#[derive(Clone, Copy)]
pub(super) struct Coarse<'a> {
    pub grid: Grid,
    pub east: &'a [f32],
    pub south: &'a [f32],
    pub mass: &'a [f32],
}

/// A row of [`Coarse`].
pub(super) struct CoarseRow<'a> {
    edges: [&'a [f32]; 4],
    mass: &'a [f32],
}

impl Coefficients for CoarseRow<'_> {
    #[inline(always)]
    fn edges(&self, i: usize) -> [f32; 4] {
        self.edges.map(|row| at(row, i).abs())
    }

    #[inline(always)]
    fn mass(&self, i: usize) -> f32 {
        at(self.mass, i)
    }
}

impl Operator for Coarse<'_> {
    type Row<'r>
        = CoarseRow<'r>
    where
        Self: 'r;

    #[inline(always)]
    fn row(&self, start: usize, n: usize) -> Option<CoarseRow<'_>> {
        let above = start - self.grid.stride();
        Some(CoarseRow {
            edges: [
                self.east.get(start - 1..start - 1 + n)?,
                self.east.get(start..start + n)?,
                self.south.get(above..above + n)?,
                self.south.get(start..start + n)?,
            ],
            mass: self.mass.get(start..start + n)?,
        })
    }
}

impl Network for Coarse<'_> {
    #[inline(always)]
    fn east(&self, index: usize) -> f32 {
        at(self.east, index).abs()
    }

    #[inline(always)]
    fn south(&self, index: usize) -> f32 {
        at(self.south, index).abs()
    }

    #[inline(always)]
    fn mass(&self, index: usize) -> f32 {
        at(self.mass, index)
    }

    #[inline(always)]
    fn attachment(&self, index: usize) -> Attachment {
        let flag = |array: &[f32], bit: u32| u32::from(at(array, index).is_sign_negative()) << bit;
        Attachment::from_bits(flag(self.east, 0) | flag(self.south, 1))
    }

    fn grid(&self) -> Grid {
        self.grid
    }
}

/// Sets the attachment of a pixel of the finest grid.
pub(super) fn attach_fine(words: &mut [u32], index: usize, attachment: Attachment) {
    if let Some(word) = words.get_mut(index) {
        *word = word::attached(*word, attachment);
    }
}

/// Sets the attachment of a pixel of a coarse grid.
pub(super) fn attach_coarse(east: &mut [f32], south: &mut [f32], index: usize, attachment: Attachment) {
    let bits = attachment.bits();
    for (array, bit) in [(east, bits & 1), (south, bits >> 1)] {
        if let Some(value) = array.get_mut(index) {
            *value = if bit == 0 { value.abs() } else { -value.abs() };
        }
    }
}
