//! Averages of a picture over square cells.

use super::grid::{Cell, Grid, Planes, around};
use super::reference::Polynomial;
use crate::picture::{Image, Usable, WINDOW, Window, for_each_bit};

/// A pixel whose channels are all below this share of the plane is a dark spot: a marker, a hole or dirt. A slope cannot make all
/// of several lights so weak at once.
const DARK_SPOT: f32 = 0.6;

/// The bit of a count of pixels that says that one of them is a dark spot.
const SPOT: u32 = 1 << 31;

/// Which pixels count: the usable ones that are no dark spots in comparison with the plane.
pub(super) struct Selection<'a> {
    pub usable: Usable,
    /// The plane's color by polynomial, once it is known.
    pub plane: Option<&'a Polynomial>,
}

impl Selection<'_> {
    /// The bits of the window's pixels that count, and of dark spots.
    fn bits(&self, window: &Window, grid: &Grid) -> (u64, u64) {
        let bits = self.usable.exposed(window);
        let Some(plane) = self.plane else { return (bits, 0) };
        let (mut last, mut limits, mut spots) = (usize::MAX, [0.0; 3], 0);
        for_each_bit(bits, |i| {
            let cell = grid.cell(window.x + i, window.y);
            if cell != last {
                limits = plane.at(grid.middle(cell)).map(|value| DARK_SPOT * value as f32);
                last = cell;
            }
            let dark = window.pixel(i).into_iter().zip(limits).all(|(value, limit)| value < limit);
            spots |= u64::from(dark) << i;
        });
        (bits & !spots, spots)
    }
}

/// A picture that is averaged, which of its pixels count, and where the averages go.
pub(super) struct Source<'a, 'p, 'w> {
    pub image: &'a Image<'a>,
    pub selection: Selection<'a>,
    pub planes: &'p mut Planes<'w>,
    pub window: Window,
}

impl<'a, 'p, 'w> Source<'a, 'p, 'w> {
    pub const fn new(image: &'a Image<'a>, selection: Selection<'a>, planes: &'p mut Planes<'w>) -> Self {
        Self { image, selection, planes, window: Window::new() }
    }
}

/// Averages each picture over the pixels that count in all of them, and says what the cells are. A cell with a dark spot
/// in it, and those around it, which its blurred border reaches, are missing.
pub(super) fn average(sources: &mut [Source], grid: &Grid, states: &mut [u32], masked_counts: &mut [u32]) {
    for plane in sources.iter_mut().flat_map(|source| source.planes.iter_mut()) {
        plane.fill(0.0);
    }
    states.fill(0);
    masked_counts.fill(0);
    let width = grid.width * grid.side;
    for y in 0..grid.height * grid.side {
        for x in (0..width).step_by(WINDOW) {
            let (mut used, mut masked, mut spots) = (u64::MAX, u64::MAX, 0);
            for Source { image, selection, window, .. } in sources.iter_mut() {
                image.read(x, y, window);
                let (bits, dark) = selection.bits(window, grid);
                used &= bits;
                spots |= dark;
                masked &= window.masked;
            }
            for_each_bit(masked, |i| {
                if x + i >= width {
                    return;
                }
                let cell = grid.cell(x + i, y);
                let is_used = used >> i & 1 == 1;
                if let (Some(used), Some(masked)) = (states.get_mut(cell), masked_counts.get_mut(cell)) {
                    *used += u32::from(is_used);
                    *masked = (*masked + 1) | if spots >> i & 1 == 1 { SPOT } else { 0 };
                }
                for Source { planes, window, .. } in sources.iter_mut().filter(|_| is_used) {
                    for (plane, value) in planes.iter_mut().zip(window.pixel(i)) {
                        if let Some(sum) = plane.get_mut(cell) {
                            *sum += value;
                        }
                    }
                }
            });
        }
    }
    let half = (grid.side * grid.side).div_ceil(2) as u32;
    for cell in 0..grid.len() {
        let masked = masked_counts.get(cell).map_or(0, |count| count & !SPOT);
        let spot =
            around(grid, cell).any(|near| masked_counts.get(near).is_some_and(|count| count & SPOT != 0));
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
