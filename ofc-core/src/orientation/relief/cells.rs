//! Averages of a picture over square cells.

use super::grid::{Cell, Grid, Planes, around};
use super::reference::Polynomial;
use crate::picture::{Image, Usable, Window, for_each_bit};

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

/// Averages the pixels that count in all pictures, of the one that `which` says, and says what the cells are. A cell with a dark spot
/// in it, and those around it, which its blurred border reaches, are missing.
pub(super) fn average(
    pictures: &[(Image, Selection)],
    which: usize,
    grid: &Grid,
    planes: &mut Planes,
    states: &mut [u32],
    masked_counts: &mut [u32],
) {
    for plane in planes.iter_mut() {
        plane.fill(0.0);
    }
    states.fill(0);
    masked_counts.fill(0);
    let Some((first, _)) = pictures.first() else { return };
    let mut window = Window::new();
    for y in 0..grid.height * grid.side {
        for x in (0..first.width()).step_by(crate::picture::WINDOW) {
            let (mut used, mut masked, mut spots) = (u64::MAX, u64::MAX, 0);
            for (image, selection) in pictures {
                image.read(x, y, &mut window);
                let (bits, dark) = selection.bits(&window, grid);
                used &= bits;
                spots |= dark;
                masked &= window.masked;
            }
            if let Some((image, _)) = pictures.get(which) {
                image.read(x, y, &mut window);
            }
            for_each_bit(masked, |i| {
                if x + i >= grid.width * grid.side {
                    return;
                }
                let cell = grid.cell(x + i, y);
                let is_used = used >> i & 1 == 1;
                if let (Some(used), Some(masked)) = (states.get_mut(cell), masked_counts.get_mut(cell)) {
                    *used += u32::from(is_used);
                    *masked = (*masked + 1) | if spots >> i & 1 == 1 { SPOT } else { 0 };
                }
                if is_used {
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
        for plane in planes.iter_mut() {
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
