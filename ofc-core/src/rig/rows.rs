//! A frame row by row, without memory for it: what is touched, and its normals, by a model that is known.
//!
//! A row is looked at in cells as wide as those of whole frames, and one row high. A cell is touched that differs from the plane by
//! more than five deviations together with both beside it: what is above and below is not known.

use super::row::Row;
use super::terms::{Order, TERMS};
use crate::orientation::relief::{
    self, Along, BitRow, DARK_SPOT, DEVIATIONS, Grid, MOST_ALONG, PixelClass, SKIRT, Strip, is_set, narrower,
    relative, unit, wider,
};
use crate::picture::{Image, WINDOW, Window, first_bits};
use core::fmt;
use libm::sqrtf;

/// One over the color of the plane, by channel and cell of a row.
pub type Reciprocals = [[f32; MOST_ALONG]; 3];

/// What rows take of a [model](super::Model), in place.
#[derive(Clone, Copy)]
pub struct RowModel<'m> {
    /// Pixels in a row of a frame.
    pub width: usize,
    /// Rows of a frame.
    pub height: usize,
    /// The terms that W has.
    pub order: Order,
    /// W.
    pub w: [&'m [f64; TERMS]; 2],
    /// The coefficients of the plane's polynomials: red, green, blue.
    pub plane: [&'m [f64; relief::TERMS]; 3],
    /// The deviation of each channel of a cell of the plane, relative to its color.
    pub noise: [f64; 3],
    /// The level of saturation, where one is set.
    pub saturation: Option<f32>,
}

/// What was seen of a frame so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Its rows.
    pub rows: usize,
    /// Pixels of the contact.
    pub pixels: u32,
    /// Sums of their columns and rows.
    pub sums: [f64; 2],
    /// The first and last column and row of the contact: left, top, right, bottom.
    pub bounds: [usize; 4],
    /// The cells of the contact in the row of cells that was last begun, a bit each.
    pub contact: BitRow,
    /// Its cells of which less than half is usable, a bit each.
    pub missing: BitRow,
}

/// A frame that is seen row by row.
#[derive(Debug)]
pub struct Rows<'r> {
    /// One over the colors of the plane, for the row of cells that was last begun.
    pub reciprocals: &'r mut Reciprocals,
    /// What was seen.
    pub seen: &'r mut Seen,
}

/// What is wanted of a row: as many classes as it has pixels, and three numbers for each.
#[derive(Debug)]
pub struct Wanted<'w> {
    /// The classes.
    pub classes: Option<&'w mut [u8]>,
    /// The normals: (0, 0, 1) on the plane, NaN where there is no usable color.
    pub normals: Option<&'w mut [f32]>,
}

impl Wanted<'_> {
    fn write(&mut self, x: usize, class: PixelClass, normal: [f32; 3]) {
        if let Some(slot) = self.classes.as_mut().and_then(|classes| classes.get_mut(x)) {
            *slot = class as u8;
        }
        let normals = self.normals.as_mut().and_then(|normals| normals.get_mut(3 * x..));
        if let Some(slot) = normals.and_then(<[f32]>::first_chunk_mut) {
            *slot = normal;
        }
    }

    /// Writes that so many pixels are part of the plane.
    fn write_plane(&mut self, x: usize, len: usize) {
        if let Some(classes) = &mut self.classes {
            classes.iter_mut().skip(x).take(len).for_each(|class| *class = PixelClass::Plane as u8);
        }
        if let Some(normals) = &mut self.normals {
            let normals = normals.as_chunks_mut::<3>().0.get_mut(x..).unwrap_or_default();
            normals.iter_mut().take(len).for_each(|normal| *normal = [0.0, 0.0, 1.0]);
        }
    }
}

/// Why there are no normals of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowError {
    /// It, or that of the background, is not one row of the model's width.
    Row,
    /// The frame has all its rows.
    TooMany,
}

impl fmt::Display for RowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Row => "not one row of the model's width",
            Self::TooMany => "the frame has all its rows",
        })
    }
}

impl core::error::Error for RowError {}

/// Looks at the next row of a frame. `background` is the same row without a contact; `None` to take the model's plane, whose noise then holds what the
/// plane misses.
///
/// # Errors
/// [`RowError`]; nothing is changed then.
pub fn row(
    model: &RowModel,
    frame: &mut Rows,
    image: &Image,
    background: Option<&Image>,
    wanted: &mut Wanted,
) -> Result<(), RowError> {
    let is_row = |image: &Image| image.height() == 1 && image.width() == model.width;
    let grid = Grid::of(model.width, model.height).ok_or(RowError::Row)?;
    if !is_row(image) || background.is_some_and(|background| !is_row(background)) {
        return Err(RowError::Row);
    }
    let y = frame.seen.rows;
    if y >= model.height {
        return Err(RowError::TooMany);
    }
    let saturation = model.saturation.unwrap_or(image.sample().saturation());
    let job = Job { model, grid, image, background, saturation, window: &mut Window::new(), plane: None };
    if background.is_some() {
        look_with_background(job, frame, wanted);
    } else {
        look(job, frame, wanted);
    }
    Ok(())
}

/// [`look`] with a background, whose pixels take stack that they do not take without one.
#[inline(never)]
fn look_with_background(job: Job, frame: &mut Rows, wanted: &mut Wanted) {
    look(Job { plane: Some(&mut Window::new()), ..job }, frame, wanted);
}

fn look(mut job: Job, frame: &mut Rows, wanted: &mut Wanted) {
    let (y, grid) = (frame.seen.rows, job.grid);
    // Rows beyond the last whole cells are like them.
    if y.checked_rem(grid.side) == Some(0) && y < grid.height * grid.side {
        // Where there is a background they are not used in this row; the next one may come without.
        job.set_plane(frame.reciprocals, y);
        job.begin(frame);
    }
    let run = job.write(frame, y, wanted);
    frame.seen.add(&run);
}

/// The pixels of the contact in a row.
#[derive(Default)]
struct Run {
    pixels: u32,
    /// The sum of their columns.
    columns: u64,
    first: usize,
    last: usize,
}

impl Run {
    /// Adds a pixel to the right of the last one.
    fn add(&mut self, x: usize) {
        if self.pixels == 0 {
            self.first = x;
        }
        self.last = x;
        self.pixels += 1;
        self.columns += x as u64;
    }
}

impl Seen {
    /// Adds a row.
    fn add(&mut self, run: &Run) {
        let y = self.rows;
        self.rows += 1;
        if run.pixels == 0 {
            return;
        }
        if self.pixels == 0 {
            self.bounds = [run.first, y, run.last, y];
        }
        let ([left, top, right, _], [x_sum, y_sum]) = (self.bounds, self.sums);
        self.bounds = [left.min(run.first), top, right.max(run.last), y];
        self.pixels = self.pixels.saturating_add(run.pixels);
        self.sums = [x_sum + run.columns as f64, y_sum + f64::from(run.pixels) * y as f64];
    }
}

struct Job<'j> {
    model: &'j RowModel<'j>,
    grid: Grid,
    image: &'j Image<'j>,
    background: Option<&'j Image<'j>>,
    /// A pixel is saturated if any of its channels is at or above this.
    saturation: f32,
    window: &'j mut Window,
    plane: Option<&'j mut Window>,
}

impl Job<'_> {
    /// The middle of a cell along its row, in [-1, 1].
    fn middle(&self, cell: usize) -> f32 {
        (2 * cell + 1) as f32 / self.grid.width as f32 - 1.0
    }

    /// Sets the reciprocals for the cells from this row on.
    fn set_plane(&self, reciprocals: &mut Reciprocals, y: usize) {
        let row = y.checked_div(self.grid.side).unwrap_or(0);
        let down = (2 * row + 1) as f64 / self.grid.height as f64 - 1.0;
        let [step, begin] = [2.0 / self.grid.width as f32, self.middle(0)];
        for (reciprocals, coefficients) in reciprocals.iter_mut().zip(self.model.plane) {
            let [c0, c1, c2, c3, c4] = Along::of(coefficients, down).singles();
            for (cell, reciprocal) in reciprocals.iter_mut().take(self.grid.width).enumerate() {
                let x = begin + cell as f32 * step;
                let color = (((c4 * x + c3) * x + c2) * x + c1) * x + c0;
                *reciprocal = if color > 0.0 { 1.0 / color } else { 0.0 };
            }
        }
    }

    /// Reads the columns of a strip.
    fn read(&mut self, x: usize) {
        self.image.read(x, 0, self.window);
        if let (Some(background), Some(plane)) = (self.background, &mut self.plane) {
            background.read(x, 0, plane);
        }
    }

    /// Begins a row of cells with its first row of pixels: which cells differ from the plane, but for dark spots and what is near them, and which
    /// are missing.
    fn begin(&mut self, frame: &mut Rows) {
        let (mut bits, mut spots, mut missing) = ([0; 8], [0; 8], [0; 8]);
        // Of a cell of one row the noise is that of fewer pixels.
        let rows = sqrtf(self.grid.side as f32);
        let weights =
            self.model.noise.map(|noise| 1.0 / (DEVIATIONS * rows * (noise as f32).max(f32::EPSILON)));
        let (mut x, width) = (0, self.grid.width * self.grid.side);
        while x < width {
            let strip = Strip::at(&self.grid, x, 0);
            self.read(x);
            let firsts = (0..strip.len).step_by(strip.side.get());
            for (cell, first) in (strip.first..).zip(firsts) {
                let columns = first..strip.len.min(first + strip.side.get());
                let (all, by) = (columns.len(), here(frame.reciprocals, cell));
                if self.square(columns.clone(), by, weights) <= 1.0 {
                    continue;
                }
                // Few differ: which of their pixels say so is looked at for these alone.
                let usable = columns.filter(|&i| self.is_usable(i, false));
                let count = usable.clone().count();
                if 2 * count < all {
                    set(&mut missing, cell);
                    continue;
                }
                // The variance of the mean of fewer pixels is more.
                if count < all && self.square(usable.clone(), by, weights) * count as f32 <= all as f32 {
                    continue;
                }
                let is_spot = usable.clone().any(|i| is_dark(self.relative(i, by)));
                set(if is_spot { &mut spots } else { &mut bits }, cell);
            }
            x += strip.len;
        }
        if spots.iter().any(|word| *word != 0) {
            let near = wider(&wider(&spots));
            bits.iter_mut().zip(near).for_each(|(word, near)| *word &= !near);
        }
        frame.seen.contact = wider(&narrower(&bits));
        frame.seen.missing = missing;
    }

    /// Whether the color of pixel `i` of what was read last is known, and that of the background; all are in the mask of what is whole.
    #[expect(clippy::inline_always, reason = "asked of each pixel near a contact")]
    #[inline(always)]
    fn is_usable(&self, i: usize, is_whole: bool) -> bool {
        (is_whole || self.window.masked >> i & 1 == 1)
            && is_below(self.window.pixel(i), self.saturation)
            && (self.plane.is_none() || self.is_background_known(i))
    }

    #[inline(never)]
    fn is_background_known(&self, i: usize) -> bool {
        let (Some(plane), Some(background)) = (&self.plane, self.background) else { return false };
        let color = plane.pixel(i);
        color.iter().all(|&value| value > 0.0) && is_below(color, background.sample().saturation())
    }

    /// The square of the distance of a cell's pixels from the plane, in units of where it begins to be touched.
    #[expect(clippy::inline_always, reason = "asked of each cell")]
    #[inline(always)]
    fn square(&self, pixels: impl Iterator<Item = usize> + Clone, by: [f32; 3], weights: [f32; 3]) -> f32 {
        let share = 1.0 / pixels.clone().count() as f32;
        let [r, g, b] = sum(self.window, pixels.clone());
        let [by_r, by_g, by_b] = match &self.plane {
            Some(plane) => sum(plane, pixels).map(|sum| if sum > 0.0 { 1.0 / (share * sum) } else { 0.0 }),
            None => by,
        };
        let [weight_r, weight_g, weight_b] = weights;
        let r = (share * r * by_r - 1.0) * weight_r;
        let g = (share * g * by_g - 1.0) * weight_g;
        let b = (share * b * by_b - 1.0) * weight_b;
        r * r + g * g + b * b
    }

    /// The relative color of pixel `i` of what was read last, by the reciprocals of its cell.
    fn relative(&self, i: usize, [by_r, by_g, by_b]: [f32; 3]) -> [f32; 3] {
        let [r, g, b] = self.window.pixel(i);
        if let Some(plane) = &self.plane {
            let [plane_r, plane_g, plane_b] = plane.pixel(i);
            return [relative(r, plane_r), relative(g, plane_g), relative(b, plane_b)];
        }
        [r * by_r - 1.0, g * by_g - 1.0, b * by_b - 1.0]
    }

    /// Writes classes and normals of a row. What it has of the contact.
    fn write(&mut self, frame: &Rows, y: usize, wanted: &mut Wanted) -> Run {
        let (Seen { contact, missing, .. }, mut run) = (&*frame.seen, Run::default());
        let is_masked = (0..self.model.width).step_by(WINDOW).any(|x| {
            let len = WINDOW.min(self.model.width - x);
            self.image.masked(x, 0) != first_bits(len)
        });
        if !is_masked && contact.iter().chain(missing).all(|word| *word == 0) {
            wanted.write_plane(0, self.model.width);
            return run;
        }
        let near = (0..SKIRT).fold(*contact, |near, _| wider(&near));
        let down = (2 * y + 1) as f64 / (self.grid.height * self.grid.side) as f64 - 1.0;
        let row = Row::of(self.model.w, self.model.order, down);
        let mut x = 0;
        while x < self.model.width {
            let strip = Strip::of_row(&self.grid, x, self.model.width);
            let is_whole = first_bits(strip.len) & !self.image.masked(x, 0) == 0;
            let cells = strip.first..strip.first + strip.cells();
            if is_whole && !cells.clone().any(|cell| is_set(&near, cell) || is_set(missing, cell)) {
                wanted.write_plane(x, strip.len);
                x += strip.len;
                continue;
            }
            self.read(x);
            for (cell, first) in cells.zip((0..strip.len).step_by(strip.side.get())) {
                let class = if is_set(contact, cell) {
                    PixelClass::Contact
                } else if is_set(&near, cell) {
                    PixelClass::Skirt
                } else {
                    PixelClass::Plane
                };
                let end = strip.len.min(first + strip.side.get());
                if class == PixelClass::Plane && is_whole && !is_set(missing, cell) {
                    wanted.write_plane(x + first, end - first);
                    continue;
                }
                let middle = self.middle(cell);
                let (w, by) = (row.at(middle), here(frame.reciprocals, cell));
                for i in first..end {
                    let normal = if !self.is_usable(i, is_whole) {
                        None
                    } else if class == PixelClass::Plane {
                        Some([0.0, 0.0, 1.0])
                    } else {
                        let delta = self.relative(i, by);
                        if is_dark(delta) { None } else { unit(row.of_pixel(middle, w, delta)) }
                    };
                    if normal.is_some() && class == PixelClass::Contact {
                        run.add(x + i);
                    }
                    match normal {
                        Some(normal) => wanted.write(x + i, class, normal),
                        None => wanted.write(x + i, PixelClass::None, [f32::NAN; 3]),
                    }
                }
            }
            x += strip.len;
        }
        run
    }
}

/// The sum of the colors of these pixels.
fn sum(window: &Window, pixels: impl Iterator<Item = usize>) -> [f32; 3] {
    let mut sums = [0.0; 3];
    for i in pixels {
        let ([red, green, blue], [r, g, b]) = (sums, window.pixel(i));
        sums = [red + r, green + g, blue + b];
    }
    sums
}

/// The reciprocals of a cell's plane.
fn here(reciprocals: &Reciprocals, cell: usize) -> [f32; 3] {
    let [r, g, b] = reciprocals;
    let at = |row: &[f32; MOST_ALONG]| row.get(cell).copied().unwrap_or(0.0);
    [at(r), at(g), at(b)]
}

/// Whether all channels are that much darker than the plane: a marker, a hole or dirt.
fn is_dark(delta: [f32; 3]) -> bool {
    is_below(delta, DARK_SPOT as f32 - 1.0)
}

fn is_below([r, g, b]: [f32; 3], limit: f32) -> bool {
    r < limit && g < limit && b < limit
}

fn set(bits: &mut BitRow, cell: usize) {
    bits.iter_mut().skip(cell / 32).take(1).for_each(|word| *word |= 1 << (cell % 32));
}
