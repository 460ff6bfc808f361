//! Integrability on windows of one size.
//!
//! A window says that `s = r1.(N x N_x) + r2.(N x N_y)` is zero but for noise. Its variance is known: N's noise is that of
//! the smallest cells, and what the median of s^2 is above that is the model's error. The cost is the weighted sum of
//! squares over what is expected of it, times a factor that makes of it a log likelihood: the scatter of its gradient over
//! the parts of the picture says how much independent information there is.
//!
//! Normals have unit length, so `N.N_x` and `N.N_y` are zero for a surface that obeys the model. Where they are not, by more
//! than noise, colors change over the picture for other reasons than orientation (lights that are near, interreflection),
//! in s as much as along N. Such errors do not average out, and the more of s they explain the less it counts.

use super::cells::Cells;
use super::form::{Form, flat};
use super::moments::{Moments, Plane};
use super::outward::{Outward, PARTS, Parts};
use super::search::{derivatives, minimum};
use super::{inverse, trace};
use crate::math::mat3::{self, Mat3};
use crate::math::select::{kth_smallest, median_rank};
use crate::orientation::orthogonal::polish::polish;

/// Numbers of a window, and two of scratch.
pub(super) const NUMBERS: usize = RECORD + 2;
pub(super) const RECORD: usize = 14;

/// A window counts if this share of its pixels are inliers.
const SMALLEST_FILL: f64 = 0.6;

/// Fewer windows than this say nothing.
const SMALLEST_COUNT: usize = 6;

/// Times that windows are weighed anew.
const ROUNDS: usize = 5;

/// s^2 above this many times its variance loses weight, quickly.
const CUT: f64 = 4.0;

/// The medians of the square of a normal number of variance 1, and of the sum of two squares of variance 1/2.
const MEDIAN_OF_ONE: f64 = 0.454_936;
const MEDIAN_OF_TWO: f64 = core::f64::consts::LN_2;

/// Systematic errors: as if there were so few independent windows where they explain all of s, and more with the cube of the
/// share that they explain.
const SYSTEMATIC_WINDOWS: f64 = 0.1;

/// The scatter over twenty-five parts at most, neighbours of each other, is less than it would be over pictures.
const NEIGHBOURS: f64 = 2.0;

/// What windows of one size say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Integrable {
    squares: Form,
    noise: Form,
    model: f64,
    factor: f64,
    independent: f64,
}

/// One window.
#[derive(Clone, Copy)]
struct Record {
    /// N x `N_x` and N x `N_y`.
    v: [f64; 6],
    /// Variances of `N_x` and `N_y` and their covariance, as multiples of that of a pixel.
    variance: [f64; 3],
    /// The mean of N.
    middle: [f64; 3],
    /// `(N.N_x)^2 + (N.N_y)^2`.
    radial: f64,
    /// Which part of the picture it lies in.
    part: usize,
}

impl Record {
    fn load(numbers: &[f32; RECORD]) -> Self {
        let [.., part] = *numbers;
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, _] = numbers.map(f64::from);
        let part = part.to_bits() as usize;
        Self { v: [a, b, c, d, e, f], variance: [g, h, i], middle: [j, k, l], radial: m, part }
    }

    fn numbers(&self) -> [f32; RECORD] {
        let ([a, b, c, d, e, f], [g, h, i], [j, k, l]) = (self.v, self.variance, self.middle);
        let [a, b, c, d, e, f, g, h, i, j, k, l, m] =
            [a, b, c, d, e, f, g, h, i, j, k, l, self.radial].map(|number| number as f32);
        // A small number: bits that are kept, and no rounding.
        let part = f32::from_bits(self.part as u32);
        [a, b, c, d, e, f, g, h, i, j, k, l, m, part]
    }

    /// The noise of N x `N_x` for a variance of 1: `[N]x C [N]x^T`.
    fn cross_noise(&self, noise: &Mat3) -> Mat3 {
        let crossed = noise.map(|row| mat3::cross(self.middle, row));
        mat3::transpose(&crossed).map(|column| mat3::cross(self.middle, column))
    }

    fn s(&self, rows: &Mat3) -> f64 {
        self.v.iter().zip(flat(rows)).map(|(a, b)| a * b).sum()
    }

    /// What noise adds to `radial`.
    fn radial_noise(&self, noise: &Mat3) -> f64 {
        let [xx, _, yy] = self.variance;
        mat3::dot(self.middle, mat3::apply(noise, self.middle)) * (xx + yy)
    }

    fn variance_at(&self, noise: &Mat3, [r1, r2, _]: &Mat3) -> f64 {
        let [xx, xy, yy] = self.variance;
        let (a, b) = (mat3::cross(*r1, self.middle), mat3::cross(*r2, self.middle));
        let (c, d) = (mat3::apply(noise, a), mat3::apply(noise, b));
        xx * mat3::dot(a, c) + 2.0 * xy * mat3::dot(a, d) + yy * mat3::dot(b, d)
    }
}

impl Integrable {
    /// What windows say, each as `independent` ones beside each other, and the rows that these and `outward` say together,
    /// beginning at `rows`; `None` where there are too few. `least_radial` is the least systematic error over windows so
    /// far: in larger ones curvature looks like it. `scratch` holds two numbers for every window.
    pub fn of(
        (records, independent): (&[[f32; RECORD]], f64),
        noise: &Mat3,
        outward: &Outward,
        rows: Mat3,
        least_radial: &mut f64,
        scratch: &mut [f32],
    ) -> Option<(Self, Mat3)> {
        let n = records.len();
        if n < SMALLEST_COUNT {
            return None;
        }
        let (squares, variances) = scratch.split_at_mut_checked(n)?;
        let independent = independent * n as f64;

        let radial = excess(
            records,
            |record| [record.radial, record.radial_noise(noise)],
            MEDIAN_OF_TWO,
            [&mut *squares, &mut *variances],
        )?;
        *least_radial = least_radial.min(radial.model);
        let prior = |rows: &Mat3| outward.cost(rows);
        let mut form =
            Self { squares: Form::ZERO, noise: Form::ZERO, model: 0.0, factor: independent, independent };
        let mut rows = rows;
        let mut parts = Sums { squares: [Form::ZERO; PARTS * PARTS], noise: [Form::ZERO; PARTS * PARTS] };
        for round in 0..ROUNDS {
            let of = |record: &Record| {
                let s = record.s(&rows);
                [s * s, record.variance_at(noise, &rows)]
            };
            let model = excess(records, of, MEDIAN_OF_ONE, [&mut *squares, &mut *variances])?;
            parts.weigh(records, noise, &rows, model.model, round > 0);
            form.squares = sum(&parts.squares);
            form.noise = sum(&parts.noise);
            form.model = (form.squares.at(&rows) - form.noise.at(&rows)).max(0.0);
            let cost = |rows: &Mat3| form.cost(rows) + prior(rows);
            rows = if round == 0 {
                minimum([&rows, &mat3::IDENTITY], cost).rows
            } else {
                polish(rows, cost(&rows), 120, cost).0
            };
            form.model = (form.squares.at(&rows) - form.noise.at(&rows)).max(0.0);
            form.factor = parts.information(&form, &rows, *least_radial / (model.noise + model.model))?;
        }
        Some((form, rows))
    }

    /// The negative log likelihood of `rows`.
    pub fn cost(&self, rows: &Mat3) -> f64 {
        self.factor * self.ratio(rows)
    }

    fn ratio(&self, rows: &Mat3) -> f64 {
        let expected = self.noise.at(rows) + self.model;
        if expected > 0.0 { self.squares.at(rows) / expected } else { 0.0 }
    }
}

/// The numbers of a window of `side` pixels, if it is full enough.
pub(super) fn record(window: &Moments, side: f64, part: usize) -> Option<[f32; RECORD]> {
    if window.count() < SMALLEST_FILL * side * side {
        return None;
    }
    let Plane { middle, gradient: [along_x, along_y], variance } = window.plane()?;
    let ([a, b, c], [d, e, f]) = (mat3::cross(middle, along_x), mat3::cross(middle, along_y));
    let length = mat3::dot(middle, middle);
    let (p, q) = (mat3::dot(middle, along_x), mat3::dot(middle, along_y));
    (length > 0.0)
        .then(|| Record { v: [a, b, c, d, e, f], variance, middle, radial: p * p + q * q, part }.numbers())
}

/// The windows of two by two cells, and room for two numbers of each; `None` without any.
pub(super) fn collect<'r>(
    cells: &Cells,
    scratch: &'r mut [f32],
) -> Option<(&'r [[f32; RECORD]], &'r mut [f32])> {
    let [width, height] = cells.size();
    let (records, scratch) = scratch.split_at_mut_checked(width * height * RECORD)?;
    let (records, _) = records.as_chunks_mut();
    let parts = Parts::around(cells)?;
    let mut n = 0;
    for y in 0..height.saturating_sub(1) {
        for x in 0..width.saturating_sub(1) {
            let part = parts.of(cells.middle(x, y));
            if let Some(made) = record(&cells.two_by_two(x, y), 2.0 * cells.side() as f64, part)
                && let Some(slot) = records.get_mut(n)
            {
                *slot = made;
                n += 1;
            }
        }
    }
    Some((records.get(..n)?, scratch.get_mut(..2 * n)?))
}

/// What the median of a square is above the median of the variance that noise gives it, and that variance.
struct Excess {
    model: f64,
    noise: f64,
}

/// `of` gives square and variance of a window; `median` is that of the square for a variance of 1.
fn excess(
    records: &[[f32; RECORD]],
    of: impl Fn(&Record) -> [f64; 2],
    median: f64,
    [squares, variances]: [&mut [f32]; 2],
) -> Option<Excess> {
    let n = records.len();
    let slots = squares.iter_mut().zip(variances.iter_mut());
    for (record, (square, variance)) in records.iter().map(Record::load).zip(slots) {
        let [a, b] = of(&record);
        (*square, *variance) = (a as f32, b as f32);
    }
    let square = f64::from(kth_smallest(squares.get_mut(..n)?, median_rank(n))?);
    let noise = f64::from(kth_smallest(variances.get_mut(..n)?, median_rank(n))?);
    Some(Excess { model: (square / median - noise).max(0.0), noise })
}

/// Sums by part of the picture.
struct Sums {
    squares: [Form; PARTS * PARTS],
    noise: [Form; PARTS * PARTS],
}

fn sum(forms: &[Form]) -> Form {
    let mut total = Form::ZERO;
    for form in forms {
        total.add(form);
    }
    total
}

impl Sums {
    /// The sums with the weights that windows have at `rows`; `robust` ones where s^2 is too large for its variance.
    #[inline(never)]
    fn weigh(&mut self, records: &[[f32; RECORD]], noise: &Mat3, rows: &Mat3, model: f64, robust: bool) {
        self.squares.iter_mut().chain(&mut self.noise).for_each(|form| *form = Form::ZERO);
        for record in records.iter().map(Record::load) {
            let expected = record.variance_at(noise, rows) + model;
            if expected.is_nan() || expected <= 0.0 {
                continue;
            }
            let mut weight = 1.0 / expected;
            if robust {
                let s = record.s(rows);
                let excess = 1.0 + s * s / (CUT * expected);
                weight /= excess * excess;
            }
            if let Some(form) = self.squares.get_mut(record.part) {
                form.add_square(&record.v, weight);
            }
            if let Some(form) = self.noise.get_mut(record.part) {
                form.add_noise(&record.cross_noise(noise), record.variance, weight);
            }
        }
    }

    /// The factor that makes a log likelihood of the ratio of `form` near its minimum `rows`: 3 over the trace of
    /// H^-1 G, with H its second derivatives and G the scatter of its gradient, but no more than independent windows would
    /// give, and less where errors are systematic:
    /// `radial` is the share of s^2 that they are.
    #[inline(never)]
    fn information(&self, form: &Integrable, rows: &Mat3, radial: f64) -> Option<f64> {
        let expected = form.noise.at(rows) + form.model;
        if expected.is_nan() || expected <= 0.0 {
            return None;
        }
        let ratio = form.ratio(rows);
        let (_, hessian) = derivatives(rows, |rows| form.ratio(rows));
        let (mut used, mut mean, mut scatter) = (0.0, [0.0; 3], [[0.0; 3]; 3]);
        for (squares, noise) in self.squares.iter().zip(&self.noise) {
            if *squares == Form::ZERO {
                continue;
            }
            let (gradient, _) =
                derivatives(rows, |rows| (squares.at(rows) - ratio * noise.at(rows)) / expected);
            used += 1.0;
            for ((mean, row), a) in mean.iter_mut().zip(&mut scatter).zip(gradient) {
                *mean += a;
                for (entry, b) in row.iter_mut().zip(gradient) {
                    *entry += a * b;
                }
            }
        }
        if used < 2.0 {
            return None;
        }
        for (row, a) in scatter.iter_mut().zip(mean) {
            for (entry, b) in row.iter_mut().zip(mean) {
                *entry = (*entry - a * b / used) * used / (used - 1.0);
            }
        }
        let least = 1e-6 * trace(&hessian).abs().max(f64::MIN_POSITIVE);
        let white = 1.0 / form.independent;
        let random = NEIGHBOURS * trace(&mat3::multiply(&inverse(&hessian, least), &scatter)) / 3.0;
        let share = radial.max(1e-3);
        let systematic = 2.0 * share * share * share / SYSTEMATIC_WINDOWS;
        let total = random.max(white) + systematic;
        (total > 0.0).then(|| 1.0 / total)
    }
}
