//! The matrices of the coupled model on every grid, in the arrays of the hierarchy.
//!
//! A coarse grid needs eight arrays: three right sides, three corrections, and its coefficients in two words a pixel, each
//! word two numbers of eight bits' precision. That is enough for a correction, whose length a search along it decides.

use super::coarsen;
use super::coupled_equations::{Coupled, Equations, Field, Right};
use super::grid::Grid;
use super::hierarchy::{CoarseArrays, Hierarchy};
use super::operator::{Fine, Network, Packing, at};
use super::span::StoredSpan;
use super::word::{self, Attachment};

/// Root weights are one in the mask and zero outside of it; the number is the mass of p and q.
#[derive(Clone, Copy)]
pub(super) struct Slopes;

/// The number of a pixel of the mask without mass: any other would make the word zero.
const NO_MASS: f32 = 1e-30;

impl Slopes {
    /// The word of a pixel of the mask.
    pub fn word(mass: f32) -> u32 {
        word::word(mass.max(NO_MASS))
    }
}

impl Packing for Slopes {
    const UNIT: u32 = word::word(NO_MASS);

    #[inline(always)]
    fn root(self, word: u32) -> f32 {
        if word == 0 { 0.0 } else { 1.0 }
    }

    #[inline(always)]
    fn mass(self, word: u32) -> f32 {
        word::number(word)
    }
}

/// The same words, but the mass is that of depth.
#[derive(Clone, Copy)]
struct Depths {
    mass: f32,
}

impl Packing for Depths {
    /// No pixel has it: none is said to be alike, which costs time once and nothing else.
    const UNIT: u32 = u32::MAX;

    #[inline(always)]
    fn root(self, word: u32) -> f32 {
        Slopes.root(word)
    }

    #[inline(always)]
    fn mass(self, word: u32) -> f32 {
        if word::is_known(word) { self.mass } else { 0.0 }
    }
}

/// The finest grid.
#[derive(Clone, Copy)]
pub(super) struct Finest<'a> {
    pub slopes: Fine<'a, Slopes>,
    /// The mass of known depths.
    pub anchor: f32,
}

impl Network for Finest<'_> {
    #[inline(always)]
    fn east(&self, index: usize) -> f32 {
        self.slopes.east(index)
    }

    #[inline(always)]
    fn south(&self, index: usize) -> f32 {
        self.slopes.south(index)
    }

    #[inline(always)]
    fn mass(&self, index: usize) -> f32 {
        self.slopes.mass(index)
    }

    #[inline(always)]
    fn attachment(&self, index: usize) -> Attachment {
        self.slopes.attachment(index)
    }

    fn grid(&self) -> Grid {
        self.slopes.grid
    }
}

impl Coupled for Finest<'_> {
    #[inline(always)]
    fn anchor(&self, index: usize) -> f32 {
        if word::is_known(at(self.slopes.words, index)) { self.anchor } else { 0.0 }
    }

    #[inline(always)]
    fn is_inside(&self, index: usize) -> bool {
        at(self.slopes.words, index) != 0
    }
}

/// A coarse grid: two words a pixel.
#[derive(Clone, Copy)]
pub(super) struct Packed<'a> {
    grid: Grid,
    /// The weights of the edges to the right and below, whose signs hold the attachment.
    edges: &'a [f32],
    /// The masses of slopes and of depth.
    masses: &'a [f32],
}

/// The upper half of f32 has the same range.
const HALF: u32 = 16;

fn pack(high: f32, low: f32) -> f32 {
    f32::from_bits(high.to_bits() >> HALF << HALF | low.to_bits() >> HALF)
}

#[inline(always)]
fn unpack(word: f32) -> [f32; 2] {
    let bits = word.to_bits();
    [f32::from_bits(bits >> HALF << HALF), f32::from_bits(bits << HALF)]
}

impl Network for Packed<'_> {
    #[inline(always)]
    fn east(&self, index: usize) -> f32 {
        unpack(at(self.edges, index))[0].abs()
    }

    #[inline(always)]
    fn south(&self, index: usize) -> f32 {
        unpack(at(self.edges, index))[1].abs()
    }

    #[inline(always)]
    fn mass(&self, index: usize) -> f32 {
        unpack(at(self.masses, index))[0]
    }

    #[inline(always)]
    fn attachment(&self, index: usize) -> Attachment {
        let [beside, across] =
            unpack(at(self.edges, index)).map(|weight| u32::from(weight.is_sign_negative()));
        Attachment::from_bits(beside | across << 1)
    }

    fn grid(&self) -> Grid {
        self.grid
    }
}

impl Coupled for Packed<'_> {
    #[inline(always)]
    fn anchor(&self, index: usize) -> f32 {
        unpack(at(self.masses, index))[1]
    }

    #[inline(always)]
    fn is_inside(&self, _: usize) -> bool {
        true
    }
}

/// A coarse grid.
pub(super) struct Level<'a> {
    pub operator: Packed<'a>,
    pub right: [&'a mut [f32]; 3],
    pub correction: [&'a mut [f32]; 3],
    pub spans: &'a [StoredSpan],
}

/// Right sides in arrays.
pub(super) struct Stored<'a> {
    grid: Grid,
    arrays: [&'a [f32]; 3],
}

impl Right for Stored<'_> {
    fn row(&mut self, y: usize) -> [&[f32]; 3] {
        self.arrays.map(|array| self.grid.row(array, y))
    }
}

impl<'a> Level<'a> {
    /// Its equations, whose unknowns are the corrections.
    pub fn equations(self, stiffness: f32) -> Equations<'a, Packed<'a>, Stored<'a>> {
        let grid = self.operator.grid;
        Equations {
            operator: self.operator,
            stiffness,
            right: Stored { grid, arrays: self.right.map(|array| &*array) },
            unknowns: self.correction.map(|array| Field::of(grid, array)),
        }
    }
}

/// All grids but the finest.
pub(super) struct Levels<'a, 'b> {
    pub hierarchy: &'a mut Hierarchy<'b>,
    /// Three arrays more for each.
    pub more: &'a mut [f32],
}

impl Levels<'_, '_> {
    /// Builds the coarse grids from the words of the finest; `anchor` is the mass of known depths.
    pub fn build(&mut self, grid: Grid, words: &mut [u32], anchor: f32) -> Option<()> {
        let levels = self.hierarchy.levels();
        self.more.fill(0.0);
        if anchor > 0.0 {
            coarsen::build(grid, words, Depths { mass: anchor }, self.hierarchy)?;
            for level in 1..levels {
                let more = self.start(level);
                let (grid, arrays, _) = self.hierarchy.level(level)?;
                let anchors = self.more.get_mut(more..more + grid.len())?;
                for (anchor, mass) in anchors.iter_mut().zip(&*arrays.mass) {
                    *anchor = *mass;
                }
            }
        }
        coarsen::build(grid, words, Slopes, self.hierarchy)?;
        for level in 1..levels {
            let more = self.start(level);
            let (grid, arrays, _) = self.hierarchy.level(level)?;
            let anchors = self.more.get_mut(more..more + grid.len())?;
            for (east, &south) in arrays.east.iter_mut().zip(&*arrays.south) {
                *east = pack(*east, south);
            }
            for (mass, &anchor) in arrays.mass.iter_mut().zip(&*anchors) {
                *mass = pack(*mass, anchor);
            }
            // Padding stays zero from here on.
            for array in [arrays.south, arrays.right, arrays.correction, anchors] {
                array.fill(0.0);
            }
        }
        Some(())
    }

    /// Where the further arrays of a coarse `level` begin.
    fn start(&self, level: usize) -> usize {
        let (mut grid, mut start) = (self.hierarchy.finest.coarser(), 0);
        for _ in 1..level {
            start += 3 * grid.len();
            grid = grid.coarser();
        }
        start
    }

    /// The first coarse grid, and the spans of the finest.
    pub fn first(&mut self) -> Option<(Level<'_>, &[StoredSpan])> {
        let finest = self.hierarchy.finest;
        let (arrays, spans) = self.hierarchy.first()?;
        let (own, coarser) = spans.split_at_checked(finest.height)?;
        Some((view(finest.coarser(), arrays, self.more, coarser)?, own))
    }

    /// A coarse grid and the next.
    pub fn pair(&mut self, level: usize) -> Option<(Level<'_>, Level<'_>)> {
        let start = self.start(level);
        let grid = self.hierarchy.grid(level);
        let (own, next, spans) = self.hierarchy.pair(level)?;
        let (more, rest) = self.more.get_mut(start..)?.split_at_mut_checked(3 * grid.len())?;
        Some((view(grid, own, more, spans)?, view(grid.coarser(), next, rest, &[])?))
    }

    /// A coarse grid.
    pub fn level(&mut self, level: usize) -> Option<Level<'_>> {
        let start = self.start(level);
        let (grid, arrays, spans) = self.hierarchy.level(level)?;
        view(grid, arrays, self.more.get_mut(start..)?, spans)
    }
}

fn view<'a>(
    grid: Grid,
    arrays: CoarseArrays<'a>,
    mut more: &'a mut [f32],
    spans: &'a [StoredSpan],
) -> Option<Level<'a>> {
    let len = grid.len();
    let CoarseArrays { east, south, mass, right, correction } = arrays;
    Some(Level {
        operator: Packed { grid, edges: east, masses: mass },
        right: [right, south, more.split_off_mut(..len)?],
        correction: [correction, more.split_off_mut(..len)?, more.split_off_mut(..len)?],
        spans,
    })
}
