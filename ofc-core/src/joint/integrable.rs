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
use super::outward::{Outward, PARTS, Parts};
use super::search::{derivatives, minimum, starts};
use super::{inverse, trace};
use crate::mat3::{self, Mat3};
use crate::orthogonal::polish::polish;
use crate::select::{kth_smallest, median_rank};

/// Numbers of a window, and two of scratch.
pub(super) const NUMBERS: usize = RECORD + 2;
const RECORD: usize = 14;

/// A window counts if this share of its pixels are inliers.
const SMALLEST_FILL: f64 = 0.6;

/// Fewer windows than this say nothing.
const SMALLEST_COUNT: usize = 6;

/// Times that windows are weighed anew.
const ROUNDS: usize = 5;

/// s^2 above this many times its variance loses weight, quickly.
const CUT: f64 = 4.0;

/// The median of the square of a standard normal number.
const MEDIAN_SQUARE: f64 = 0.454_936;

/// Systematic errors: as if there were this many independent windows where they explain all of s, ...
const SYSTEMATIC_WINDOWS: f64 = 0.3;
/// ... and more where they explain less, with this power.
const SYSTEMATIC_POWER: i32 = 4;

/// What windows of one size say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Integrable {
    squares: Form,
    noise: Form,
    model: f64,
    factor: f64,
}

/// One window.
#[derive(Clone, Copy)]
struct Record {
    /// N x N_x and N x N_y.
    v: [f64; 6],
    /// Variances of N_x and N_y and their covariance, as multiples of that of a pixel.
    variance: [f64; 3],
    /// The mean of N.
    middle: [f64; 3],
    /// `(N.N_x)^2 + (N.N_y)^2` less what noise adds.
    radial: f64,
    /// Which part of the picture it lies in.
    part: usize,
}

impl Record {
    fn load(numbers: &[f32; RECORD]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = numbers.map(f64::from);
        let part = n as usize;
        Self { v: [a, b, c, d, e, f], variance: [g, h, i], middle: [j, k, l], radial: m, part }
    }

    fn store(&self, numbers: &mut [f32; RECORD]) {
        let rest = [self.radial, self.part as f64];
        let all = self.v.iter().chain(&self.variance).chain(&self.middle).chain(&rest);
        for (slot, &value) in numbers.iter_mut().zip(all) {
            *slot = value as f32;
        }
    }

    /// The noise of N x N_x for a variance of 1: `[N]x C [N]x^T`.
    fn cross_noise(&self, noise: &Mat3) -> Mat3 {
        let [a, b, c] = self.middle;
        let cross = [[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]];
        mat3::multiply(&mat3::multiply(&cross, noise), &mat3::transpose(&cross))
    }

    fn s(&self, rows: &Mat3) -> f64 {
        self.v.iter().zip(flat(rows)).map(|(a, b)| a * b).sum()
    }

    fn variance_at(&self, noise: &Mat3, rows: &Mat3) -> f64 {
        let c = self.cross_noise(noise);
        let [r1, r2, _] = *rows;
        let [xx, xy, yy] = self.variance;
        let (c1, c2) = (mat3::apply(&c, r1), mat3::apply(&c, r2));
        xx * mat3::dot(r1, c1) + 2.0 * xy * mat3::dot(r1, c2) + yy * mat3::dot(r2, c2)
    }
}

impl Integrable {
    /// The windows of two by two cells, and the rows that these and `outward` say together, beginning at `rows`; `None`
    /// where there are too few. `scratch` holds [`NUMBERS`] for every cell.
    pub fn of(
        cells: &Cells,
        noise: &Mat3,
        outward: &Outward,
        rows: Mat3,
        scratch: &mut [f32],
    ) -> Option<(Self, Mat3)> {
        let [width, height] = cells.size();
        let room = width * height;
        let (records, rest) = scratch.split_at_mut_checked(room * RECORD)?;
        let (squares, variances) = rest.split_at_mut_checked(room)?;
        let (records, _) = records.as_chunks_mut::<RECORD>();
        let n = collect(cells, noise, records)?;
        let records = records.get(..n)?;

        let prior = |rows: &Mat3| outward.cost(rows);
        // Windows overlap fourfold.
        let mut form = Self { squares: Form::ZERO, noise: Form::ZERO, model: 0.0, factor: 0.125 * n as f64 };
        let mut rows = rows;
        for round in 0..ROUNDS {
            let model = spread(records, noise, &rows, squares, variances)?;
            let parts = weigh(records, noise, &rows, model, round > 0);
            form.squares = sum(&parts.squares);
            form.noise = sum(&parts.noise);
            form.model = (form.squares.at(&rows) - form.noise.at(&rows)).max(0.0);
            let cost = |rows: &Mat3| form.cost(rows) + prior(rows);
            rows = if round == 0 {
                let mut from = starts();
                from[0] = rows;
                minimum(&from, cost).rows
            } else {
                polish(rows, cost(&rows), 120, cost).0
            };
            form.model = (form.squares.at(&rows) - form.noise.at(&rows)).max(0.0);
            form.factor = parts.information(&form, &rows)?;
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

/// Writes a record of every window that is full enough; how many they are, `None` where they are too few.
fn collect(cells: &Cells, noise: &Mat3, records: &mut [[f32; RECORD]]) -> Option<usize> {
    let [width, height] = cells.size();
    let parts = Parts::around(cells)?;
    let side = 2.0 * cells.side() as f64;
    let mut n = 0;
    for y in 0..height.saturating_sub(1) {
        for x in 0..width.saturating_sub(1) {
            let window = cells.two_by_two(x, y);
            if window.count() < SMALLEST_FILL * side * side {
                continue;
            }
            let Some(plane) = window.plane() else { continue };
            let [along_x, along_y] = plane.gradient;
            let ([a, b, c], [d, e, f]) =
                (mat3::cross(plane.middle, along_x), mat3::cross(plane.middle, along_y));
            let length = mat3::dot(plane.middle, plane.middle);
            let [xx, _, yy] = plane.variance;
            let (p, q) = (mat3::dot(plane.middle, along_x), mat3::dot(plane.middle, along_y));
            let expected = mat3::dot(plane.middle, mat3::apply(noise, plane.middle)) * (xx + yy);
            if length.is_nan() || length <= 0.0 {
                continue;
            }
            let part = parts.of(cells.middle(x, y));
            let radial = (p * p + q * q - expected) / length;
            let record = Record {
                v: [a, b, c, d, e, f],
                variance: plane.variance,
                middle: plane.middle,
                radial,
                part,
            };
            if let Some(slot) = records.get_mut(n) {
                record.store(slot);
                n += 1;
            }
        }
    }
    (n >= SMALLEST_COUNT).then_some(n)
}

/// The model's variance: what the median of s^2 is above that of noise.
fn spread(
    records: &[[f32; RECORD]],
    noise: &Mat3,
    rows: &Mat3,
    squares: &mut [f32],
    variances: &mut [f32],
) -> Option<f64> {
    let n = records.len();
    let slots = squares.iter_mut().zip(variances.iter_mut());
    for (record, (square, variance)) in records.iter().map(Record::load).zip(slots) {
        let s = record.s(rows);
        *square = (s * s) as f32;
        *variance = record.variance_at(noise, rows) as f32;
    }
    let square = f64::from(kth_smallest(squares.get_mut(..n)?, median_rank(n))?);
    let variance = f64::from(kth_smallest(variances.get_mut(..n)?, median_rank(n))?);
    Some((square / MEDIAN_SQUARE - variance).max(0.0))
}

/// Sums by part of the picture.
struct Sums {
    squares: [Form; PARTS * PARTS],
    noise: [Form; PARTS * PARTS],
    radial: f64,
}

fn sum(forms: &[Form]) -> Form {
    let mut total = Form::ZERO;
    for form in forms {
        total.add(form);
    }
    total
}

/// The sums with the weights that windows have at `rows`; `robust` ones where s^2 is too large for its variance.
fn weigh(records: &[[f32; RECORD]], noise: &Mat3, rows: &Mat3, model: f64, robust: bool) -> Sums {
    let mut sums =
        Sums { squares: [Form::ZERO; PARTS * PARTS], noise: [Form::ZERO; PARTS * PARTS], radial: 0.0 };
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
        sums.radial += weight * record.radial * mat3::dot(record.middle, record.middle);
        if let Some(form) = sums.squares.get_mut(record.part) {
            form.add_square(&record.v, weight);
        }
        if let Some(form) = sums.noise.get_mut(record.part) {
            form.add_noise(&record.cross_noise(noise), record.variance, weight);
        }
    }
    sums
}

impl Sums {
    /// The factor that makes a log likelihood of the ratio of `form` near its minimum `rows`: 3 over the trace of
    /// H^-1 G, with H its second derivatives and G the scatter of its gradient, and less where errors are systematic.
    fn information(&self, form: &Integrable, rows: &Mat3) -> Option<f64> {
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
        let random = trace(&mat3::multiply(&inverse(&hessian, least), &scatter)) / 3.0;
        let share = (self.radial / expected).max(1e-3);
        let systematic = 2.0 * power(share) / SYSTEMATIC_WINDOWS;
        let total = random + systematic;
        (total > 0.0).then(|| 1.0 / total)
    }
}

fn power(base: f64) -> f64 {
    let mut power = 1.0;
    for _ in 0..SYSTEMATIC_POWER {
        power *= base;
    }
    power
}
