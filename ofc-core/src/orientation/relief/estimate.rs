//! From a picture, and perhaps one of the plane alone, to W.

use super::cells::{self, Selection, Source};
use super::circulation::{self, Least};
use super::contact;
use super::fill::fill;
use super::grid::{BRIDGED, Cell, Grid, class};
use super::outward;
use super::parameters::ReliefParams;
use super::reference;
use super::result::{PixelClass, Relief, ReliefError, ScaleSource};
use super::scale::Inner;
use crate::math::arena::{Arena, Need};
use crate::math::mat3;
use crate::picture::{Image, Sample, Usable};
use libm::sqrt;

/// A contact has at least so many cells.
const FEWEST_CELLS: usize = 50;

/// The slopes stand out of the noise by at least so many deviations, along and across.
const SIGNAL_TO_NOISE: f64 = 3.0;

/// The variance of the slopes across the relief is at least this share of that along it.
const ANISOTROPY: f64 = 0.05;

/// The circulation is at most this, and at most this share of the second best field's. Paint, spots, highlights and shadows
/// exceed both: `docs/relief.md` has a table.
const CIRCULATION: f64 = 0.2;
const CIRCULATION_RATIO: f64 = 0.4;

/// The step of the slopes across the border of the contact is at most this share of the slopes in it.
const BORDER: f64 = 0.5;

/// Above this disagreement the ellipsoid says nothing of the scale.
const LARGEST_DISAGREEMENT: f64 = 0.2;

/// Where the scale is unknown: the root mean square of the sines of the slants that contacts usually have, and how
/// far, as a factor's logarithm, theirs are from it.
const USUAL_TILT: f64 = 0.4;
const USUAL_DEVIATION: f64 = 0.5;

/// The least noise of integers.
const ROUNDING: f64 = 0.5;

/// The scale's deviation where a ball's radius gives it: its border and its center are found in the same picture.
const BALL_DEVIATION: f64 = 0.08;

/// The least deviation of a scale from colors.
const LEAST_DEVIATION: f64 = 0.02;

/// What [`estimate`] needs as workspace for a picture of this size; `None` where it is too small.
#[must_use]
pub const fn need(width: usize, height: usize) -> Option<Need> {
    match Grid::of(width, height) {
        Some(grid) => Some(Need { doubles: 0, singles: 7 * grid.len(), integers: 2 * grid.len() }),
        None => None,
    }
}

/// Finds the plane and the relief on it, and writes the class of every pixel.
///
/// `background`, if there is one, is a picture of the same size without the relief. `classes` are rows of one byte a pixel without
/// gaps, see [`PixelClass`]; they are written on success only.
///
/// # Errors
/// See [`ReliefError`].
pub fn estimate(
    image: &Image,
    background: Option<&Image>,
    params: &ReliefParams,
    mut workspace: Arena,
    classes: &mut [u8],
) -> Result<Relief, ReliefError> {
    let (width, height) = (image.width(), image.height());
    if !params.are_valid() {
        return Err(ReliefError::Params);
    }
    if classes.len() != width * height
        || background.is_some_and(|b| [b.width(), b.height()] != [width, height])
    {
        return Err(ReliefError::Size);
    }
    let (Some(grid), Some(need)) = (Grid::of(width, height), need(width, height)) else {
        return Err(ReliefError::TooSmall);
    };
    let memory = Memory::cut(&grid, &mut workspace).ok_or(ReliefError::Workspace(need))?;
    let usable = Usable::below(params.saturation.unwrap_or(image.sample().saturation()));
    let job = Job { grid, image, background, params, usable, memory };
    job.run(classes)
}

/// The workspace, cut up.
struct Memory<'w> {
    /// Colors of the picture, then relative to the plane.
    color: [&'w mut [f32]; 3],
    /// Colors of the plane, then those of the inner contact.
    plane: [&'w mut [f32]; 3],
    scratch: &'w mut [f32],
    /// States of cells, then classes.
    classes: &'w mut [u32],
    /// Counts, then distances.
    other: &'w mut [u32],
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

struct Job<'a, 'w> {
    grid: Grid,
    image: &'a Image<'a>,
    background: Option<&'a Image<'a>>,
    params: &'a ReliefParams,
    usable: Usable,
    memory: Memory<'w>,
}

impl Job<'_, '_> {
    fn run(mut self, classes: &mut [u8]) -> Result<Relief, ReliefError> {
        let plane = self.reference().ok_or(ReliefError::TooFewPixels)?;
        let Memory { color, plane: reference, .. } = &mut self.memory;
        for cell in 0..self.grid.len() {
            let by_polynomial = plane.at(self.grid.middle(cell));
            for ((color, reference), fitted) in color.iter_mut().zip(reference.iter()).zip(by_polynomial) {
                let reference = match self.background {
                    Some(_) => reference.get(cell).map_or(1.0, |&value| f64::from(value)),
                    None => fitted,
                };
                if let Some(value) = color.get_mut(cell) {
                    *value = relative(f64::from(*value), reference) as f32;
                }
            }
        }
        let least = self.rounding(&plane);
        let Memory { color, scratch, classes: states, other, .. } = &mut self.memory;
        let noise = contact::noise(color, states, least, scratch).ok_or(ReliefError::TooFewPixels)?;
        fill(&self.grid, color, states);
        contact::classify(&self.grid, color, noise, states, other);
        let mut cells = [0; 4];
        for state in states.iter() {
            cells.iter_mut().skip(class(*state) as usize).take(1).for_each(|count| *count += 1);
        }
        let [_, untouched, skirt, touched] = cells;
        if touched < FEWEST_CELLS {
            return Err(ReliefError::NothingTouched);
        }
        if touched > untouched + skirt {
            return Err(ReliefError::NoMajority);
        }
        let least = circulation::least(&self.grid, color, states, noise).ok_or(ReliefError::NotDetermined)?;
        contact::distances(&self.grid, states, other);
        let mut found = Relief {
            w: least.w,
            plane,
            has_background: self.background.is_some(),
            grid: self.grid,
            noise,
            cells,
            circulation: least.circulation,
            circulation_ratio: least.circulation / least.second.max(f64::MIN_POSITIVE),
            anisotropy: 0.0,
            signal_to_noise: 0.0,
            border: 0.0,
            outward: 0.0,
            scale_source: ScaleSource::Unknown,
            scale_deviation: USUAL_DEVIATION,
            disagreement: None,
            tilt: 0.0,
        };
        self.judge(&mut found, &least)?;
        self.scale(&mut found);
        self.write(classes);
        Ok(found)
    }

    /// What the rounding of pixels to integers makes of a cell's relative color: half a step, because the colors of a plane without
    /// noise are but one or two.
    fn rounding(&self, plane: &reference::Polynomial) -> [f64; 3] {
        let step = if self.image.sample() == Sample::F32 { 0.0 } else { ROUNDING };
        plane.at([0.0; 2]).map(|color| step / (color.max(1.0) * self.grid.side as f64))
    }

    /// The plane's polynomial; the averages of both pictures are in their planes then, dark spots left out.
    fn reference(&mut self) -> Option<reference::Polynomial> {
        let Self { grid, image, background, usable, memory, .. } = self;
        let Memory { color, plane, scratch, classes, other } = memory;
        let source = background.unwrap_or(image);
        let source_usable =
            if background.is_some() { Usable::below(source.sample().saturation()) } else { *usable };
        let all = Selection { usable: source_usable, plane: None };
        cells::average(&mut [Source::new(source, all, plane)], grid, classes, other);
        let polynomial = reference::fit(grid, plane, classes, scratch)?;
        let without_spots = |usable| Selection { usable, plane: Some(&polynomial) };
        let of_image = Source::new(image, without_spots(*usable), color);
        match background {
            None => cells::average(&mut [of_image], grid, classes, other),
            Some(background) => {
                let of_background = Source::new(background, without_spots(source_usable), plane);
                cells::average(&mut [of_image, of_background], grid, classes, other);
            }
        }
        let known = classes.iter().filter(|state| **state == Cell::Known as u32).count();
        (known > FEWEST_CELLS).then_some(polynomial)
    }

    /// Whether this is a relief on a plane. Makes the root mean square of the slopes in the contact 1, and their sign that of the
    /// convexity.
    fn judge(&self, found: &mut Relief, least: &Least) -> Result<(), ReliefError> {
        let inner = self.inner(least.w);
        let (mut moments, mut border, mut count, mut border_count) = ([[0.0; 2]; 2], 0.0, 0.0, 0.0);
        for cell in inner.contact() {
            let [u, v] = inner.slope(cell);
            moments = [
                [moments[0][0] + u * u, moments[0][1] + u * v],
                [moments[1][0] + u * v, moments[1][1] + v * v],
            ];
            count += 1.0;
            for [du, dv] in self.steps(&inner, cell) {
                border += du * du + dv * dv;
                border_count += 1.0;
            }
        }
        let [smaller, larger] = eigenvalues(moments);
        let mean = (smaller + larger) / count;
        let mut noise = [[0.0; 2]; 2];
        for (row, a) in noise.iter_mut().zip(least.w) {
            for (entry, b) in row.iter_mut().zip(least.w) {
                let terms = a.iter().zip(b).zip(found.noise);
                *entry = terms.map(|((a, b), deviation)| a * b * deviation * deviation).sum();
            }
        }
        let [_, noise] = eigenvalues(noise);
        found.anisotropy = smaller / larger;
        found.signal_to_noise = sqrt(smaller.max(0.0) / count / noise.max(f64::MIN_POSITIVE));
        found.border = sqrt(border / f64::max(border_count, 1.0) / mean);
        let outward = outward::outward(&inner);
        found.outward = libm::fabs(outward);
        let enough = found.signal_to_noise >= SIGNAL_TO_NOISE && found.anisotropy >= ANISOTROPY;
        if !enough {
            return Err(ReliefError::NotDetermined);
        }
        let is_integrable = found.circulation <= CIRCULATION && found.circulation_ratio <= CIRCULATION_RATIO;
        if !is_integrable {
            return Err(ReliefError::NotIntegrable);
        }
        let rises = found.border <= BORDER;
        if !rises {
            return Err(ReliefError::HasEdge);
        }
        let wanted = if self.params.hollow { -1.0 } else { 1.0 };
        let sign = if outward * wanted < 0.0 { -1.0 } else { 1.0 };
        found.w = least.w.map(|row| mat3::scale(row, sign / sqrt(mean)));
        Ok(())
    }

    /// Makes W's scale that of the ball, of the colors, or a usual one.
    fn scale(&mut self, found: &mut Relief) {
        let Memory { color: [red, green, blue], plane, scratch, classes, other } = &mut self.memory;
        let inner =
            Inner { grid: &self.grid, delta: [red, green, blue], classes, distances: other, w: found.w };
        let colors = inner.of_colors(plane, scratch, self.params.seed);
        let colors = colors.filter(|scale| scale.disagreement <= LARGEST_DISAGREEMENT);
        found.disagreement = colors.map(|scale| scale.disagreement);
        let ball =
            self.params.ball_radius.and_then(|radius| inner.of_ball(radius / self.grid.side as f64, scratch));
        let (factor, source, deviation) = match (ball, colors) {
            (Some(factor), _) => (factor, ScaleSource::Ball, BALL_DEVIATION),
            (None, Some(scale)) => {
                let deviation = sqrt(scale.disagreement + LEAST_DEVIATION * LEAST_DEVIATION);
                (scale.factor, ScaleSource::Colors, deviation)
            }
            (None, None) => (USUAL_TILT, ScaleSource::Unknown, USUAL_DEVIATION),
        };
        (found.scale_source, found.scale_deviation, found.tilt) = (source, deviation, factor.min(1.0));
        found.w = found.w.map(|row| mat3::scale(row, factor));
    }

    fn inner(&self, w: [[f64; 3]; 2]) -> Inner<'_> {
        let Memory { color: [red, green, blue], classes, other, .. } = &self.memory;
        Inner { grid: &self.grid, delta: [red, green, blue], classes, distances: other, w }
    }

    /// The differences between the slopes of a cell at the border of the contact and those two cells farther out.
    fn steps(&self, inner: &Inner, cell: usize) -> impl Iterator<Item = [f64; 2]> {
        let Grid { width, height, .. } = self.grid;
        let [x, y] = self.grid.place(cell);
        let at = |x: usize, y: usize| (x < width && y < height).then_some(y * width + x);
        let outward = [
            (x.checked_sub(1), x.checked_sub(2), Some(y), Some(y)),
            (Some(x + 1), Some(x + 2), Some(y), Some(y)),
            (Some(x), Some(x), y.checked_sub(1), y.checked_sub(2)),
            (Some(x), Some(x), Some(y + 1), Some(y + 2)),
        ];
        let [u, v] = inner.slope(cell);
        let steps = outward.map(|(x1, x2, y1, y2)| {
            let (first, second) = (at(x1?, y1?)?, at(x2?, y2?)?);
            let state = self.memory.classes.get(second)?;
            let beside = !inner.is_contact(first) && class(*state) == PixelClass::Skirt as u32;
            let [other_u, other_v] = inner.slope(second);
            beside.then_some([u - other_u, v - other_v])
        });
        steps.into_iter().flatten()
    }

    /// The classes of pixels from those of their cells.
    fn write(&self, classes: &mut [u8]) {
        let (width, states) = (self.image.width(), &self.memory.classes);
        for (y, row) in classes.chunks_mut(width.max(1)).enumerate() {
            for (x, class) in row.iter_mut().enumerate() {
                let state = states.get(self.grid.cell(x, y)).copied().unwrap_or(PixelClass::None as u32);
                // What has no color of its own has no normal either, but on the plane.
                let is_bridged = state & BRIDGED != 0 && self::class(state) != PixelClass::Plane as u32;
                *class = if is_bridged { PixelClass::None as u8 } else { self::class(state) as u8 };
            }
        }
    }
}

/// The eigenvalues of a symmetric matrix, the smaller one first.
fn eigenvalues([[a, b], [_, c]]: [[f64; 2]; 2]) -> [f64; 2] {
    let (mean, half) = (0.5 * (a + c), 0.5 * libm::hypot(a - c, 2.0 * b));
    [mean - half, mean + half]
}

/// How far a color is from that of the plane, relative to it.
pub(super) fn relative(color: f64, plane: f64) -> f64 {
    if plane > 0.0 { color / plane - 1.0 } else { 0.0 }
}
