//! Averages of a picture over square cells.

use super::grid::{Cell, Grid, MOST_ALONG, Planes, around};
use super::reference::Polynomial;
use crate::picture::{Image, Usable, WINDOW, Window, first_bits, for_each_bit};
use core::num::NonZero;

/// A pixel whose channels are all below this share of the plane is a dark spot: a marker, a hole or dirt. A slope cannot make all
/// of several lights so weak at once.
pub(crate) const DARK_SPOT: f64 = 0.6;

/// The bit of a count of pixels that says that one of them is a dark spot.
const SPOT: u32 = 1 << 31;

/// A picture that is averaged, which of its pixels are usable, and where the averages go.
pub(super) struct Source<'a, 'p, 'w> {
    image: &'a Image<'a>,
    usable: Usable,
    planes: &'p mut Planes<'w>,
    window: Window,
    /// The sums of the columns of a strip.
    sums: [[f32; WINDOW]; 3],
}

impl<'a, 'p, 'w> Source<'a, 'p, 'w> {
    pub const fn new(image: &'a Image<'a>, usable: Usable, planes: &'p mut Planes<'w>) -> Self {
        Self { image, usable, planes, window: Window::new(), sums: [[0.0; WINDOW]; 3] }
    }

    /// Adds a row of the strip, less the pixels that are left out.
    fn add(&mut self, left_out: u64) {
        for_each_bit(left_out, |i| {
            for color in self.window.color.iter_mut().filter_map(|channel| channel.get_mut(i)) {
                *color = 0.0;
            }
        });
        for (sums, channel) in self.sums.iter_mut().zip(&self.window.color) {
            sums.iter_mut().zip(channel).for_each(|(sum, color)| *sum += color);
        }
    }

    /// Adds the columns of the strip to its cells.
    fn finish(&mut self, strip: &Strip) {
        for (plane, sums) in self.planes.iter_mut().zip(&mut self.sums) {
            let cells = plane.get_mut(strip.first..).unwrap_or_default();
            let columns = sums.get(..strip.len).unwrap_or_default();
            // Of frames 320 and 640 pixels wide, with vector instructions.
            match strip.side.get() {
                2 => add_groups(cells, columns.as_chunks::<2>().0),
                4 => add_groups(cells, columns.as_chunks::<4>().0),
                side => {
                    let mut rest = columns;
                    for cell in cells.iter_mut().take(strip.cells()) {
                        let (own, others) = rest.split_at_checked(side).unwrap_or((rest, &[]));
                        *cell += own.iter().sum::<f32>();
                        rest = others;
                    }
                }
            }
            sums.fill(0.0);
        }
    }
}

/// Adds the sum of each group to its cell.
fn add_groups<const N: usize>(cells: &mut [f32], groups: &[[f32; N]]) {
    for (cell, group) in cells.iter_mut().zip(groups) {
        *cell += group.iter().sum::<f32>();
    }
}

/// Neighboring columns of a row of cells: whole cells, or a part of a single one.
pub(crate) struct Strip {
    /// The first cell.
    pub first: usize,
    /// Columns.
    pub len: usize,
    /// Columns of a cell.
    pub side: NonZero<usize>,
}

impl Strip {
    /// The strip from this column on, where cells begin with `first`.
    pub fn at(grid: &Grid, x: usize, first: usize) -> Self {
        let side = NonZero::new(grid.side).unwrap_or(NonZero::<usize>::MIN);
        let left = grid.width * grid.side - x;
        let len =
            if side.get() <= WINDOW { WINDOW - WINDOW % side } else { WINDOW.min(side.get() - x % side) };
        Self { first: first + x / side, len: len.min(left), side }
    }

    /// The strip from this column on, where a row of pixels is looked at; the pixels beyond the last whole cell are like it.
    pub fn of_row(grid: &Grid, x: usize, width: usize) -> Self {
        if x < grid.width * grid.side {
            return Self::at(grid, x, 0);
        }
        let side = NonZero::new(WINDOW).unwrap_or(NonZero::<usize>::MIN);
        Self { first: grid.width.saturating_sub(1), len: WINDOW.min(width - x), side }
    }

    /// How many cells it has.
    pub fn cells(&self) -> usize {
        (self.len + self.side.get() - 1) / self.side
    }

    /// Adds the bits of each cell to its count.
    fn count(&self, bits: u64, counts: &mut [u32]) {
        let side = self.side.get();
        let cells = counts.iter_mut().skip(self.first).take(self.cells());
        if bits == first_bits(self.len) {
            cells.for_each(|count| *count += side.min(self.len) as u32);
            return;
        }
        for (k, count) in cells.enumerate() {
            *count += (bits >> (k * side) & first_bits(side)).count_ones();
        }
    }
}

/// Below which colors a pixel is a dark spot, for a row of cells.
struct Limits<'a> {
    plane: &'a Polynomial,
    /// By channel and cell.
    colors: [[f32; MOST_ALONG]; 3],
}

impl<'a> Limits<'a> {
    const fn new(plane: &'a Polynomial) -> Self {
        Self { plane, colors: [[0.0; MOST_ALONG]; 3] }
    }

    fn set(&mut self, grid: &Grid, row: usize) {
        let along = self.plane.along(grid.middle(row * grid.width)[1]);
        for (colors, along) in self.colors.iter_mut().zip(along) {
            for (i, color) in colors.iter_mut().take(grid.width).enumerate() {
                let x = (2 * i + 1) as f64 / grid.width as f64 - 1.0;
                *color = (DARK_SPOT * along.at(x)) as f32;
            }
        }
    }

    /// The largest limit of each channel in a strip that begins with the `column`th cell of the row.
    fn largest(&self, strip: &Strip, column: usize) -> [f32; 3] {
        self.colors.each_ref().map(|colors| {
            let colors = colors.iter().skip(column).take(strip.cells());
            colors.fold(f32::NEG_INFINITY, |largest, &color| if color > largest { color } else { largest })
        })
    }

    /// Which of these pixels of a strip are dark spots.
    fn dark(&self, window: &Window, bits: u64, largest: [f32; 3], strip: &Strip, column: usize) -> u64 {
        let [red, green, blue] = largest;
        // Few are below what is the most anywhere in the strip.
        let candidates = bits & window.bits(|r, g, b| r < red && g < green && b < blue);
        let mut dark = 0;
        for_each_bit(candidates, |i| {
            let cell = column + i / strip.side;
            let limits = self.colors.each_ref().map(|colors| colors.get(cell).copied().unwrap_or(0.0));
            let is_dark = window.pixel(i).into_iter().zip(limits).all(|(value, limit)| value < limit);
            dark |= u64::from(is_dark) << i;
        });
        dark
    }
}

/// Averages each picture over the pixels that count in all of them, and says what the cells are. A cell with a dark spot
/// in it, and those around it, which its blurred border reaches, are missing. Dark spots are told by the plane, once it is known.
pub(super) fn average(
    sources: &mut [Source],
    plane: Option<&Polynomial>,
    grid: &Grid,
    states: &mut [u32],
    masked_counts: &mut [u32],
) {
    for plane in sources.iter_mut().flat_map(|source| source.planes.iter_mut()) {
        plane.fill(0.0);
    }
    states.fill(0);
    masked_counts.fill(0);
    let mut limits = plane.map(Limits::new);
    let (width, mut has_spots) = (grid.width * grid.side, false);
    for row in 0..grid.height {
        if let Some(limits) = &mut limits {
            limits.set(grid, row);
        }
        let mut x = 0;
        while x < width {
            let strip = Strip::at(grid, x, row * grid.width);
            let (all, column) = (first_bits(strip.len), strip.first - row * grid.width);
            let largest = limits.as_ref().map(|limits| limits.largest(&strip, column)).unwrap_or_default();
            for y in row * grid.side..(row + 1) * grid.side {
                let (mut used, mut masked, mut spots) = (all, all, 0);
                for Source { image, usable, window, .. } in sources.iter_mut() {
                    image.read(x, y, window);
                    let bits = all & usable.exposed(window);
                    let dark = limits
                        .as_ref()
                        .map_or(0, |limits| limits.dark(window, bits, largest, &strip, column));
                    used &= bits & !dark;
                    spots |= dark;
                    masked &= window.masked;
                }
                strip.count(used, states);
                strip.count(masked, masked_counts);
                for_each_bit(spots & masked, |i| {
                    has_spots = true;
                    let counts = masked_counts.iter_mut().skip(strip.first + i / strip.side).take(1);
                    counts.for_each(|count| *count |= SPOT);
                });
                for source in sources.iter_mut() {
                    source.add(all & !used);
                }
            }
            for source in sources.iter_mut() {
                source.finish(&strip);
            }
            x += strip.len;
        }
    }
    let half = (grid.side * grid.side).div_ceil(2) as u32;
    for cell in 0..grid.len() {
        let masked = masked_counts.get(cell).map_or(0, |count| count & !SPOT);
        let is_spot = |near: usize| masked_counts.get(near).is_some_and(|count| count & SPOT != 0);
        let spot = has_spots && around(grid, cell).any(is_spot);
        let Some(state) = states.get_mut(cell) else { return };
        let used = *state;
        for plane in sources.iter_mut().flat_map(|source| source.planes.iter_mut()) {
            if let Some(sum) = plane.get_mut(cell) {
                *sum /= used.max(1) as f32;
            }
        }
        *state = if masked < half {
            Cell::Outside
        } else if spot || used < half {
            Cell::Missing
        } else {
            Cell::Known
        } as u32;
    }
}
