//! The equations of one row: edge weights and masses, at the finest grid out of one number a pixel, at coarse grids
//! stored, and all one inside a span.
//!
//! Every equation reads `sum over neighbors j of w_ij (z_i - z_j) + mass_i z_i = right_i`.

use super::grid::Grid;

/// How a pixel takes part in the next coarser grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attachment {
    /// It belongs to the block it lies in.
    Own,
    /// It is cut off from the rest of its block and from its neighbors' blocks.
    None,
    /// It belongs to the block beyond its horizontal edge out of the block.
    Beside,
    /// It belongs to the block beyond its vertical edge out of the block.
    Across,
}

impl Attachment {
    pub const fn bits(self) -> u32 {
        match self {
            Self::Own => 0,
            Self::None => 1,
            Self::Beside => 2,
            Self::Across => 3,
        }
    }

    const fn from_bits(bits: u32) -> Self {
        match bits {
            0 => Self::Own,
            1 => Self::None,
            2 => Self::Beside,
            _ => Self::Across,
        }
    }
}

/// `slice[i]`; the bound is known where it matters and the branch is optimized away.
#[inline(always)]
pub(super) fn at(slice: &[f32], i: usize) -> f32 {
    slice.get(i).copied().unwrap_or(0.0)
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

/// A matrix over a grid.
pub(super) trait Operator {
    /// The coefficients of a row.
    type Row<'a>: Coefficients
    where
        Self: 'a;

    /// The coefficients of the `n` pixels from index `start` on.
    fn row(&self, start: usize, n: usize) -> Option<Self::Row<'_>>;
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

/// How one number a pixel holds both the root of its weight and its mass.
pub(super) trait Packing: Copy {
    fn root(self, packed: f32) -> f32;
    fn mass(self, packed: f32) -> f32;
}

/// The number is the root weight; its sign says whether the pixel has the one mass there is.
#[derive(Clone, Copy)]
pub(super) struct Signed {
    pub mass: f32,
}

impl Packing for Signed {
    #[inline(always)]
    fn root(self, packed: f32) -> f32 {
        packed.abs()
    }

    #[inline(always)]
    fn mass(self, packed: f32) -> f32 {
        if packed < 0.0 { self.mass } else { 0.0 }
    }
}

/// Root weights are zero or one, and the number is one plus the mass where it is one.
#[derive(Clone, Copy)]
pub(super) struct OnePlusMass;

impl Packing for OnePlusMass {
    #[inline(always)]
    fn root(self, packed: f32) -> f32 {
        if packed < 1.0 { packed } else { 1.0 }
    }

    #[inline(always)]
    fn mass(self, packed: f32) -> f32 {
        packed - self.root(packed)
    }
}

/// The finest grid: the weight of an edge is the product of the root weights of its two pixels, that is, the
/// geometric mean of their weights.
#[derive(Clone, Copy)]
pub(super) struct Fine<'a, P> {
    pub grid: Grid,
    pub packed: &'a [f32],
    pub packing: P,
}

/// A row of [`Fine`].
pub(super) struct FineRow<'a, P> {
    center: &'a [f32],
    neighbors: [&'a [f32]; 4],
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
        let cut = |from: usize| self.packed.get(from..from + n);
        Some(FineRow {
            center: cut(start)?,
            neighbors: [cut(start - 1)?, cut(start + 1)?, cut(start - stride)?, cut(start + stride)?],
            packing: self.packing,
        })
    }

    #[inline(always)]
    fn east(&self, index: usize) -> f32 {
        self.packing.root(at(self.packed, index)) * self.packing.root(at(self.packed, index + 1))
    }

    #[inline(always)]
    fn south(&self, index: usize) -> f32 {
        let below = at(self.packed, index + self.grid.stride());
        self.packing.root(at(self.packed, index)) * self.packing.root(below)
    }

    #[inline(always)]
    fn mass(&self, index: usize) -> f32 {
        self.packing.mass(at(self.packed, index))
    }

    /// The two lowest bits of the number: they change a weight by less than its rounding.
    #[inline(always)]
    fn attachment(&self, index: usize) -> Attachment {
        Attachment::from_bits(at(self.packed, index).to_bits() & 3)
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
        let bits = at(self.east, index).to_bits() >> 31 | at(self.south, index).to_bits() >> 31 << 1;
        Attachment::from_bits(bits)
    }

    fn grid(&self) -> Grid {
        self.grid
    }
}

/// Sets the attachment of a pixel of the finest grid.
pub(super) fn attach_fine(packed: &mut [f32], index: usize, attachment: Attachment) {
    if let Some(value) = packed.get_mut(index) {
        *value = f32::from_bits(value.to_bits() & !3 | attachment.bits());
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
