//! A picture of a plane as cells: how much the color of each differs from the plane's, and which are touched.

use super::cells::{self, Source};
use super::circulation::Circulation;
use super::contact;
use super::fill::fill;
use super::grid::{BRIDGED, Cell, Grid, class};
use super::reference::{self, Polynomial};
use super::result::{PixelClass, ReliefError};
use crate::math::arena::{Arena, Need};
use crate::picture::{Image, Sample, Usable};

/// A contact has at least so many cells.
const FEWEST_CELLS: usize = 50;

/// The least noise of integers.
const ROUNDING: f64 = 0.5;

/// What [`estimate`](super::estimate()) needs as workspace for a picture of this size; `None` where it is too small.
#[must_use]
pub const fn need(width: usize, height: usize) -> Option<Need> {
    match Grid::of(width, height) {
        Some(grid) => Some(Need { doubles: 0, singles: 7 * grid.len(), integers: 2 * grid.len() }),
        None => None,
    }
}

/// The workspace, cut up.
pub(crate) struct Memory<'w> {
    /// Colors of the picture, then relative to the plane.
    pub color: [&'w mut [f32]; 3],
    /// Colors of the plane, then free.
    pub plane: [&'w mut [f32]; 3],
    pub scratch: &'w mut [f32],
    /// States of cells, then classes.
    pub classes: &'w mut [u32],
    /// Counts, then free.
    pub other: &'w mut [u32],
}

impl<'w> Memory<'w> {
    fn cut(grid: &Grid, arena: &mut Arena<'w>) -> Option<Self> {
        let len = grid.len();
        let mut planes = || Some([arena.singles(len)?, arena.singles(len)?, arena.singles(len)?]);
        let (color, plane) = (planes()?, planes()?);
        let scratch = arena.singles(len)?;
        Some(Self { color, plane, scratch, classes: arena.integers(len)?, other: arena.integers(len)? })
    }
}

/// A picture as cells.
pub(crate) struct Survey<'w> {
    pub grid: Grid,
    /// The color of the plane.
    pub plane: Polynomial,
    /// The deviation of each channel of a cell of the plane, relative to its color.
    pub noise: [f64; 3],
    /// Cells of each [`PixelClass`].
    pub cells: [usize; 4],
    pub memory: Memory<'w>,
}

/// Looks at a picture, and at one of the plane alone if there is one. A plane that is known is not estimated again.
///
/// # Errors
/// See [`ReliefError`].
pub(crate) fn survey<'w>(
    image: &Image,
    background: Option<&Image>,
    saturation: Option<f32>,
    known: Option<&Polynomial>,
    mut workspace: Arena<'w>,
) -> Result<Survey<'w>, ReliefError> {
    let (width, height) = (image.width(), image.height());
    if background.is_some_and(|b| [b.width(), b.height()] != [width, height]) {
        return Err(ReliefError::Size);
    }
    let (Some(grid), Some(need)) = (Grid::of(width, height), need(width, height)) else {
        return Err(ReliefError::TooSmall);
    };
    let mut memory = Memory::cut(&grid, &mut workspace).ok_or(ReliefError::Workspace(need))?;
    let usable = Usable::below(saturation.unwrap_or(image.sample().saturation()));
    let pictures = Pictures { grid, image, background, usable };
    let plane = pictures.average(known, &mut memory).ok_or(ReliefError::TooFewPixels)?;
    pictures.compare(&plane, &mut memory);
    let Memory { color, scratch, classes: states, other, .. } = &mut memory;
    let noise = contact::noise(&grid, color, states, pictures.rounding(&plane), scratch)
        .ok_or(ReliefError::TooFewPixels)?;
    fill(&grid, color, states);
    contact::classify(&grid, color, noise, states, other);
    let cells = [PixelClass::None, PixelClass::Plane, PixelClass::Skirt, PixelClass::Contact]
        .map(|of| states.iter().filter(|state| class(**state) == of as u32).count());
    Ok(Survey { grid, plane, noise, cells, memory })
}

struct Pictures<'a> {
    grid: Grid,
    image: &'a Image<'a>,
    background: Option<&'a Image<'a>>,
    usable: Usable,
}

impl Pictures<'_> {
    /// The plane's polynomial; the averages of both pictures are in their planes then, dark spots left out.
    fn average(&self, known: Option<&Polynomial>, memory: &mut Memory) -> Option<Polynomial> {
        let Self { grid, image, background, usable } = self;
        let Memory { color, plane, scratch, classes, other } = memory;
        let source = background.unwrap_or(image);
        let source_usable =
            if background.is_some() { Usable::below(source.sample().saturation()) } else { *usable };
        let polynomial = if let Some(known) = known {
            *known
        } else {
            cells::average(&mut [Source::new(source, source_usable, plane)], None, grid, classes, other);
            reference::fit(grid, plane, classes, scratch)?
        };
        let of_image = Source::new(image, *usable, color);
        match background {
            None => cells::average(&mut [of_image], Some(&polynomial), grid, classes, other),
            Some(background) => {
                let of_background = Source::new(background, source_usable, plane);
                cells::average(&mut [of_image, of_background], Some(&polynomial), grid, classes, other);
            }
        }
        let known = classes.iter().filter(|state| **state == Cell::Known as u32).count();
        (known > FEWEST_CELLS).then_some(polynomial)
    }

    /// Makes the picture's colors relative to the plane's.
    fn compare(&self, plane: &Polynomial, memory: &mut Memory) {
        let Memory { color, plane: reference, .. } = memory;
        if self.background.is_none() {
            for row in 0..self.grid.height {
                let first = row * self.grid.width;
                let along = plane.along(self.grid.middle(first)[1]);
                for (reference, along) in reference.iter_mut().zip(along) {
                    let cells = reference.iter_mut().skip(first).take(self.grid.width);
                    for (i, value) in cells.enumerate() {
                        *value = along.at(self.grid.middle(i)[0]) as f32;
                    }
                }
            }
        }
        for (color, reference) in color.iter_mut().zip(reference.iter()) {
            for (color, reference) in color.iter_mut().zip(reference.iter()) {
                *color = relative(*color, *reference);
            }
        }
    }

    /// What the rounding of pixels to integers makes of a cell's relative color: half a step, because the colors of a plane without
    /// noise are but one or two.
    fn rounding(&self, plane: &Polynomial) -> [f64; 3] {
        let step = if self.image.sample() == Sample::F32 { 0.0 } else { ROUNDING };
        plane.at([0.0; 2]).map(|color| step / (color.max(1.0) * self.grid.side as f64))
    }
}

impl Survey<'_> {
    /// Whether a part of the picture is touched, and no more than half.
    pub fn check(&self) -> Result<(), ReliefError> {
        let [_, untouched, skirt, touched] = self.cells;
        if touched < FEWEST_CELLS {
            return Err(ReliefError::NothingTouched);
        }
        if touched > untouched + skirt {
            return Err(ReliefError::NoMajority);
        }
        Ok(())
    }

    /// The sums that tell which field of the relative colors has the least circulation.
    pub fn circulation(&self) -> Circulation {
        let Memory { color, classes, .. } = &self.memory;
        Circulation::of(&self.grid, color, classes, self.noise)
    }

    /// The classes of pixels from those of their cells, for rows of so many pixels.
    pub fn write(&self, width: usize, classes: &mut [u8]) {
        let states = &self.memory.classes;
        let side = self.grid.side.max(1);
        let width = width.max(1);
        for (y, rows) in classes.chunks_mut((width * side).max(1)).enumerate() {
            let of_row = states.iter().skip(self.grid.cell(0, y * side)).take(self.grid.width);
            let Some((first, others)) = rows.split_at_mut_checked(width) else { return };
            let mut pixels = first.iter_mut();
            let mut last = PixelClass::None as u8;
            for state in of_row {
                // What has no color of its own has no normal either, but on the plane.
                let is_bridged = state & BRIDGED != 0 && class(*state) != PixelClass::Plane as u32;
                last = if is_bridged { PixelClass::None as u8 } else { class(*state) as u8 };
                pixels.by_ref().take(side).for_each(|pixel| *pixel = last);
            }
            // Pixels beyond the last whole cell are like it.
            pixels.for_each(|pixel| *pixel = last);
            for row in others.chunks_mut(width) {
                row.iter_mut().zip(first.iter()).for_each(|(pixel, class)| *pixel = *class);
            }
        }
    }
}

/// How far a color is from that of the plane, relative to it.
pub(crate) fn relative(color: f32, plane: f32) -> f32 {
    if plane > 0.0 { (color - plane) / plane } else { 0.0 }
}
