//! The coarse grids: which pixels a block stands for, and what its edges weigh.
//!
//! A block of 2x2 pixels that a cut runs through holds pixels that have nothing to do with each other. It stands for
//! the largest connected part of them; the others join the block that they are connected to, so that a cut one pixel
//! wide is still a cut on every coarser grid.
//!
//! An edge between two blocks conducts what the edges between their pixels do: each is a path from the middle of one
//! block to the middle of the other, half an inner edge, the edge across and half an inner edge in series, and the
//! paths are parallel. Where all weights are one that gives one again; along a path one pixel wide it gives a half (two
//! edges in series), and behind a neck it falls with the number of grids, as the resistance of a neck does.

use super::grid::Grid;
use super::hierarchy::{CoarseArrays, Hierarchy};
use super::operator::{Coarse, Fine, Network, Packing, at, attach_coarse, attach_fine};
use super::span::{Span, StoredSpan};
use super::transfer::beyond;
use super::word::Attachment;

/// A grid whose attachments can be set.
trait Attachable {
    type View<'a>: Network
    where
        Self: 'a;
    fn view(&self) -> Self::View<'_>;
    fn attach(&mut self, index: usize, attachment: Attachment);
}

struct FineGrid<'a, P> {
    grid: Grid,
    words: &'a mut [u32],
    packing: P,
}

impl<P: Packing> Attachable for FineGrid<'_, P> {
    type View<'r>
        = Fine<'r, P>
    where
        Self: 'r;

    fn view(&self) -> Fine<'_, P> {
        Fine { grid: self.grid, words: self.words, packing: self.packing }
    }

    fn attach(&mut self, index: usize, attachment: Attachment) {
        attach_fine(self.words, index, attachment);
    }
}

struct CoarseGrid<'a, 'b> {
    grid: Grid,
    arrays: &'a mut CoarseArrays<'b>,
}

impl Attachable for CoarseGrid<'_, '_> {
    type View<'r>
        = Coarse<'r>
    where
        Self: 'r;

    fn view(&self) -> Coarse<'_> {
        view(self.grid, self.arrays)
    }

    fn attach(&mut self, index: usize, attachment: Attachment) {
        attach_coarse(self.arrays.east, self.arrays.south, index, attachment);
    }
}

/// The operator of a coarse grid.
fn view<'a>(grid: Grid, arrays: &'a CoarseArrays) -> Coarse<'a> {
    Coarse { grid, east: arrays.east, south: arrays.south, mass: arrays.mass }
}

/// The operator, right side and correction of a coarse grid.
pub(super) fn equations(grid: Grid, arrays: CoarseArrays<'_>) -> (Coarse<'_>, &[f32], &mut [f32]) {
    let CoarseArrays { east, south, mass, right, correction } = arrays;
    (Coarse { grid, east, south, mass }, right, correction)
}

/// Builds all coarse grids from the finest, and finds the spans of every grid.
#[inline(never)]
pub(super) fn build<P: Packing>(
    grid: Grid,
    words: &mut [u32],
    packing: P,
    hierarchy: &mut Hierarchy,
) -> Option<()> {
    hierarchy.coarse.fill(0.0);
    find_fine_spans(Fine { grid, words, packing }, hierarchy);
    if attach_strays(&mut FineGrid { grid, words, packing }, hierarchy.spans) {
        find_fine_spans(Fine { grid, words, packing }, hierarchy);
    }
    let finest = Fine { grid, words, packing };
    let levels = hierarchy.levels();
    if levels > 1 {
        let (mut next, spans) = hierarchy.first()?;
        coarsen(&finest, spans, &mut next);
    }
    for level in 1..levels {
        let (grid, mut arrays, spans) = hierarchy.level(level)?;
        find_coarse_spans(view(grid, &arrays), spans);
        if level + 1 < levels {
            if attach_strays(&mut CoarseGrid { grid, arrays: &mut arrays }, spans) {
                find_coarse_spans(view(grid, &arrays), spans);
            }
            let (own, mut next, spans) = hierarchy.pair(level)?;
            coarsen(&view(grid, &own), spans, &mut next);
        }
    }
    Some(())
}

#[inline(never)]
fn find_fine_spans<P: Packing>(finest: Fine<P>, hierarchy: &mut Hierarchy) {
    let is_active = |index| at(finest.words, index) != 0;
    let are_unit = |index| finest.are_unit(index);
    find_spans(finest.grid, hierarchy.spans_mut(0), is_active, |index| finest.is_unit(index), are_unit);
}

fn find_coarse_spans(coarse: Coarse, spans: &mut [StoredSpan]) {
    let is_active = |index| strength(&coarse, index) > 0.0;
    let are_unit = |index| coarse.are_unit(index);
    find_spans(coarse.grid, spans, is_active, |index| coarse.is_unit(index), are_unit);
}

/// The diagonal of a pixel's equation; zero if it has none.
fn strength<O: Network>(operator: &O, index: usize) -> f32 {
    let stride = operator.grid().stride();
    (operator.east(index) + operator.east(index - 1))
        + (operator.south(index) + operator.south(index - stride))
        + operator.mass(index)
}

/// Pixels of a row that are looked at together.
const TOGETHER: usize = 16;

/// The span of every row; `are_unit` may say of the [`TOGETHER`] pixels from an index on that all are unit.
fn find_spans(
    grid: Grid,
    spans: &mut [StoredSpan],
    is_active: impl Fn(usize) -> bool,
    is_unit: impl Fn(usize) -> bool,
    are_unit: impl Fn(usize) -> bool,
) {
    for y in 0..grid.height {
        let start = grid.start(y);
        let first = (0..grid.width).find(|&x| is_active(start + x)).unwrap_or(grid.width);
        let last = (first..grid.width).rfind(|&x| is_active(start + x)).map_or(first, |x| x + 1);
        let (mut best, mut from, mut x) = ([first, first], first, first);
        while x <= last {
            if x + TOGETHER <= last && are_unit(start + x) {
                x += TOGETHER;
                continue;
            }
            if x == last || !is_unit(start + x) {
                let [a, b] = best;
                if x - from > b - a {
                    best = [from, x];
                }
                from = x + 1;
            }
            x += 1;
        }
        Span { active: [first, last], unit: best }.store(spans, y);
    }
}

/// Finds the pixels that are cut off from their block and attaches them to another. Returns whether there are any.
#[inline(never)]
fn attach_strays<A: Attachable>(target: &mut A, spans: &[StoredSpan]) -> bool {
    let grid = target.view().grid();
    let mut strays = 0_usize;
    for y in (0..grid.height).step_by(2) {
        let Span { active: [first, last], unit: [from, to] } = Span::load(spans, y, grid.width);
        // Below the last row there is none, and no span of it.
        let below = (y + 1 < grid.height).then(|| Span::load(spans, y + 1, grid.width).active);
        let [first_below, last_below] = below.unwrap_or([first, last]);
        let (first, last) = (first.min(first_below) & !1, last.max(last_below));
        for x in (first..last).step_by(2) {
            if x >= from && x < to {
                continue;
            }
            let block = block_indices(&grid, x, y);
            let stray = stray_pixels(&target.view(), block);
            if stray != 0 {
                for (bit, &index) in block.iter().enumerate() {
                    if stray >> bit & 1 != 0 {
                        target.attach(index, Attachment::None);
                        strays += 1;
                    }
                }
            }
        }
    }
    if strays == 0 {
        return false;
    }
    for y in 0..grid.height {
        let Span { active: [first, last], unit: [from, to] } = Span::load(spans, y, grid.width);
        for x in (first..from).chain(to..last) {
            let index = grid.start(y) + x;
            let attachment = better_block(&target.view(), index, x, y);
            if let Some(attachment) = attachment {
                target.attach(index, attachment);
            }
        }
    }
    true
}

/// Where a pixel that is cut off from its block belongs instead, if anywhere; none for other pixels.
fn better_block<O: Network>(operator: &O, index: usize, x: usize, y: usize) -> Option<Attachment> {
    if operator.attachment(index) != Attachment::None {
        return None;
    }
    let [edge_x, edge_y] = operator
        .outward(x, y)
        .map(|(edge, other)| if operator.attachment(other) == Attachment::Own { edge } else { 0.0 });
    if edge_x > 0.0 && edge_x >= edge_y {
        Some(Attachment::Beside)
    } else if edge_y > 0.0 {
        Some(Attachment::Across)
    } else {
        None
    }
}

/// The pixels of a block in reading order; beyond the grid there is padding, without edges.
const fn block_indices(grid: &Grid, x: usize, y: usize) -> [usize; 4] {
    let start = grid.start(y) + x;
    let below = start + grid.stride();
    [start, start + 1, below, below + 1]
}

/// A bit for each pixel of a block that has equations but is not connected, within the block, to its largest part.
fn stray_pixels<O: Network>(operator: &O, block: [usize; 4]) -> u32 {
    let [a, b, c, _] = block;
    let (top, bottom) = (operator.east(a) > 0.0, operator.east(c) > 0.0);
    let (left, right) = (operator.south(a) > 0.0, operator.south(b) > 0.0);
    // Three edges out of four connect all.
    if u8::from(top) + u8::from(bottom) + u8::from(left) + u8::from(right) >= 3 {
        return 0;
    }
    let strengths = block.map(|index| strength(operator, index));
    let mut active = 0_u32;
    for (bit, &strength) in strengths.iter().enumerate() {
        active |= u32::from(strength > 0.0) << bit;
    }
    let links = [(top, 0b0011_u32), (bottom, 0b1100), (left, 0b0101), (right, 0b1010)];
    let (mut best, mut best_size, mut best_strength) = (0, 0, 0.0);
    for bit in 0..4 {
        let mut part = 1_u32 << bit & active;
        // Two links at most: two rounds reach all.
        for _ in 0..2 {
            for (exists, pair) in links {
                if exists && part & pair != 0 {
                    part |= pair;
                }
            }
        }
        let size = part.count_ones();
        let total: f32 =
            strengths.iter().enumerate().map(|(k, &s)| if part >> k & 1 != 0 { s } else { 0.0 }).sum();
        if size > best_size || size == best_size && total > best_strength {
            (best, best_size, best_strength) = (part, size, total);
        }
    }
    active & !best
}

/// What a path of half an inner edge, an edge across and half an inner edge conducts. An inner edge of weight zero
/// means that the block is only one pixel wide there.
fn path(inner: f32, across: f32, other_inner: f32) -> f32 {
    if inner == 1.0 && across == 1.0 && other_inner == 1.0 {
        return 0.5;
    }
    let half = |weight: f32| if weight > 0.0 { 0.5 / weight } else { 0.0 };
    1.0 / (1.0 / across + half(inner) + half(other_inner))
}

/// The weights and masses of the next coarser grid.
#[inline(never)]
fn coarsen<O: Network>(operator: &O, spans: &[StoredSpan], coarse: &mut CoarseArrays) {
    let grid = operator.grid();
    let coarse_grid = grid.coarser();
    let stride = grid.stride();
    let own = |index: usize| operator.attachment(index) == Attachment::Own;
    for y in 0..coarse_grid.height {
        let row = coarse_grid.start(y);
        let (from, to) = unit_blocks(spans, grid, y);
        for (array, value) in [(&mut coarse.east, 1.0), (&mut coarse.south, 1.0), (&mut coarse.mass, 0.0)] {
            array.get_mut(row + from..row + to).unwrap_or_default().fill(value);
        }
        for x in (0..from).chain(to..coarse_grid.width) {
            let [a, b, c, d] = block_indices(&grid, 2 * x, 2 * y);
            let horizontal = |left: usize, right: usize| {
                let across = operator.east(right);
                if across > 0.0 && own(right) && own(right + 1) {
                    path(operator.east(left), across, operator.east(right + 1))
                } else {
                    0.0
                }
            };
            let vertical = |upper: usize, lower: usize| {
                let across = operator.south(lower);
                if across > 0.0 && own(lower) && own(lower + stride) {
                    path(operator.south(upper), across, operator.south(lower + stride))
                } else {
                    0.0
                }
            };
            // A block at the right or lower end may lack its second column or row: what stands there is padding.
            let (wide, high) = (2 * x + 1 < grid.width, 2 * y + 1 < grid.height);
            let mut east = 0.0;
            let mut south = 0.0;
            if wide {
                east += horizontal(a, b);
                if high {
                    east += horizontal(c, d);
                }
            }
            if high {
                south += vertical(a, c);
                if wide {
                    south += vertical(b, d);
                }
            }
            let index = row + x;
            for (array, value) in [(&mut coarse.east, east), (&mut coarse.south, south)] {
                if let Some(slot) = array.get_mut(index) {
                    *slot = value;
                }
            }
            if let Some(slot) = coarse.mass.get_mut(index) {
                *slot = 0.0;
            }
        }
    }
    add_masses(operator, spans, coarse);
}

/// The blocks of row `y` of the coarse grid, whose edges join pixels with unit edges only.
fn unit_blocks(spans: &[StoredSpan], grid: Grid, y: usize) -> (usize, usize) {
    if 2 * y + 2 >= grid.height {
        return (0, 0);
    }
    let (mut from, mut to) = (0, grid.width);
    for y in 2 * y..2 * y + 3 {
        let [row_from, row_to] = Span::load(spans, y, grid.width).unit;
        (from, to) = (from.max(row_from), to.min(row_to));
    }
    let (from, to) = (from.div_ceil(2), to.saturating_sub(1) / 2);
    if from < to { (from, to) } else { (0, 0) }
}

/// Every pixel's mass goes to the block it is attached to.
#[inline(never)]
fn add_masses<O: Network>(operator: &O, spans: &[StoredSpan], coarse: &mut CoarseArrays) {
    let grid = operator.grid();
    let coarse_grid = grid.coarser();
    for y in 0..grid.height {
        let start = grid.start(y);
        let Span { active: [first, last], unit: [from, to] } = Span::load(spans, y, grid.width);
        for x in (first..from).chain(to..last) {
            let mass = operator.mass(start + x);
            if mass == 0.0 {
                continue;
            }
            let (block_x, block_y) = match operator.attachment(start + x) {
                Attachment::Own => (x / 2, y / 2),
                Attachment::None => continue,
                Attachment::Beside => (beyond(x), y / 2),
                Attachment::Across => (x / 2, beyond(y)),
            };
            if block_x < coarse_grid.width
                && block_y < coarse_grid.height
                && let Some(slot) = coarse.mass.get_mut(coarse_grid.start(block_y) + block_x)
            {
                *slot += mass;
            }
        }
    }
}

impl<P: Packing> Fine<'_, P> {
    /// Whether the pixel and its neighbors have weight one and no mass, and all stand for their own blocks.
    #[inline(always)]
    fn is_unit(&self, index: usize) -> bool {
        let stride = self.grid.stride();
        [index, index - 1, index + 1, index - stride, index + stride]
            .iter()
            .all(|&index| at(self.words, index) == P::UNIT)
    }

    /// Whether all of the pixels from `index` on are.
    #[inline(always)]
    fn are_unit(&self, index: usize) -> bool {
        let stride = self.grid.stride();
        are_all(self.words, index - stride, P::UNIT)
            && are_all(self.words, index, P::UNIT)
            && are_all(self.words, index + stride, P::UNIT)
    }
}

/// Whether [`TOGETHER`] numbers from `index` on, and the one before and the one behind, are `value`.
#[inline(always)]
fn are_all<T: Copy + PartialEq>(array: &[T], index: usize, value: T) -> bool {
    let numbers = array.get(index - 1..).and_then(|rest| rest.first_chunk::<{ TOGETHER + 2 }>());
    // Without a way out of the loop, so that all are compared at once.
    numbers.is_some_and(|numbers| numbers.iter().filter(|&&number| number != value).count() == 0)
}

impl Coarse<'_> {
    /// Whether all edges of the pixel weigh one, there is no mass, and the neighbors stand for their own blocks.
    #[inline(always)]
    fn is_unit(&self, index: usize) -> bool {
        let stride = self.grid.stride();
        let edges = [self.east(index), self.east(index - 1), self.south(index), self.south(index - stride)];
        edges.iter().all(|&weight| weight == 1.0)
            && self.mass(index) == 0.0
            && [index, index - 1, index + 1, index - stride, index + stride]
                .iter()
                .all(|&index| self.attachment(index) == Attachment::Own)
    }

    /// Whether all of the pixels from `index` on are, by a sufficient condition.
    #[inline(always)]
    fn are_unit(&self, index: usize) -> bool {
        let stride = self.grid.stride();
        let edges = |index| are_all(self.east, index, 1.0) && are_all(self.south, index, 1.0);
        let mass = self.mass.get(index..).and_then(|rest| rest.first_chunk::<TOGETHER>());
        edges(index - stride)
            && edges(index)
            && edges(index + stride)
            && mass.is_some_and(|mass| mass.iter().all(|&mass| mass == 0.0))
    }
}
