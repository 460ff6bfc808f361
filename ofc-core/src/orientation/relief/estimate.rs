//! From a picture, and perhaps one of the plane alone, to W.

use super::circulation::Least;
use super::contact;
use super::grid::{Grid, class};
use super::outward;
use super::parameters::ReliefParams;
use super::result::{PixelClass, Relief, ReliefError, ScaleSource};
use super::scale::Inner;
use super::survey::{Memory, Survey, survey};
use crate::math::arena::Arena;
use crate::math::mat3;
use crate::picture::Image;
use libm::sqrt;

/// The slopes stand out of the noise by at least so many deviations, along and across.
const SIGNAL_TO_NOISE: f64 = 3.0;

/// The variance of the slopes across the relief is at least this share of that along it.
pub(crate) const ANISOTROPY: f64 = 0.05;

/// The circulation is at most this, and at most this share of the second best field's. Paint, spots, highlights and shadows
/// exceed both: `docs/relief.md` has a table.
pub(crate) const CIRCULATION: f64 = 0.2;
pub(crate) const CIRCULATION_RATIO: f64 = 0.4;

/// The step of the slopes across the border of the contact is at most this share of the slopes in it.
const BORDER: f64 = 0.5;

/// Above this disagreement the ellipsoid says nothing of the scale.
pub(crate) const LARGEST_DISAGREEMENT: f64 = 0.2;

/// Where the scale is unknown: the root mean square of the sines of the slants that contacts usually have, and how
/// far, as a factor's logarithm, theirs are from it.
pub(crate) const USUAL_TILT: f64 = 0.4;
pub(crate) const USUAL_DEVIATION: f64 = 0.5;

/// The scale's deviation where a ball's radius gives it: its border and its center are found in the same picture.
const BALL_DEVIATION: f64 = 0.08;

/// The least deviation of a scale from colors.
pub(crate) const LEAST_DEVIATION: f64 = 0.02;

/// Finds the plane and the relief on it, and writes the class of every pixel.
///
/// `background`, if there is one, is a picture of the same size without the relief. `classes` are rows of one byte a pixel without
/// gaps, see [`PixelClass`]; they are written on success only.
///
/// # Scratch
/// What [`need`](super::need) says.
///
/// # Errors
/// See [`ReliefError`].
pub fn estimate(
    image: &Image,
    background: Option<&Image>,
    params: &ReliefParams,
    workspace: Arena,
    classes: &mut [u8],
) -> Result<Relief, ReliefError> {
    if !params.are_valid() {
        return Err(ReliefError::Params);
    }
    if classes.len() != image.width() * image.height() {
        return Err(ReliefError::Size);
    }
    let survey = survey(image, background, params.saturation, None, workspace)?;
    survey.check()?;
    Job { params, survey }.run(image, background, classes)
}

struct Job<'a, 'w> {
    params: &'a ReliefParams,
    survey: Survey<'w>,
}

impl Job<'_, '_> {
    fn run(
        mut self,
        image: &Image,
        background: Option<&Image>,
        classes: &mut [u8],
    ) -> Result<Relief, ReliefError> {
        let Survey { grid, plane, noise, cells, .. } = self.survey;
        let least = self.survey.circulation().least().ok_or(ReliefError::NotDetermined)?;
        let Memory { classes: states, other, .. } = &mut self.survey.memory;
        contact::distances(&grid, states, other);
        let mut found = Relief {
            w: least.w,
            plane,
            has_background: background.is_some(),
            saturation: self.params.saturation,
            grid,
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
        self.survey.write(image.width(), classes);
        Ok(found)
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
        let Memory { color: [red, green, blue], plane, scratch, classes, other } = &mut self.survey.memory;
        let inner = Inner {
            grid: &self.survey.grid,
            delta: [red, green, blue],
            classes,
            distances: other,
            w: found.w,
        };
        let colors = inner.of_colors(plane, scratch, self.params.seed);
        let colors = colors.filter(|scale| scale.disagreement <= LARGEST_DISAGREEMENT);
        found.disagreement = colors.map(|scale| scale.disagreement);
        let ball = self
            .params
            .ball_radius
            .and_then(|radius| inner.of_ball(radius / self.survey.grid.side as f64, scratch));
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
        let Memory { color: [red, green, blue], classes, other, .. } = &self.survey.memory;
        Inner { grid: &self.survey.grid, delta: [red, green, blue], classes, distances: other, w }
    }

    /// The differences between the slopes of a cell at the border of the contact and those two cells farther out.
    fn steps(&self, inner: &Inner, cell: usize) -> impl Iterator<Item = [f64; 2]> {
        let Grid { width, height, .. } = self.survey.grid;
        let [x, y] = self.survey.grid.place(cell);
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
            let state = self.survey.memory.classes.get(second)?;
            let beside = !inner.is_contact(first) && class(*state) == PixelClass::Skirt as u32;
            let [other_u, other_v] = inner.slope(second);
            beside.then_some([u - other_u, v - other_v])
        });
        steps.into_iter().flatten()
    }
}

/// The eigenvalues of a symmetric matrix, the smaller one first.
pub(crate) fn eigenvalues([[a, b], [_, c]]: [[f64; 2]; 2]) -> [f64; 2] {
    let (mean, half) = (0.5 * (a + c), 0.5 * libm::hypot(a - c, 2.0 * b));
    [mean - half, mean + half]
}
