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

use super::constants::{
    CUT, GRADIENT_NEIGHBORS, MEDIAN_OF_ONE, MEDIAN_OF_TWO, PARTS, ROUND_EVALUATIONS, ROUNDS,
    SMALLEST_CURVATURE, SMALLEST_SYSTEMATIC_SHARE, SMALLEST_WINDOWS, SYSTEMATIC_WINDOWS,
};
use super::form::Form;
use super::information::{inverse, trace};
use super::noise::{self, TERMS};
use super::outward::Outward;
use super::record::{Record, Records};
use super::search::{derivatives, minimum};
use crate::math::mat3::{self, Mat3};
use crate::math::select::{kth_smallest, median_rank};
use crate::orientation::orthogonal::polish::polish;

/// What windows of one size say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Integrable {
    squares: Form,
    noise: Form,
    model: f64,
    factor: f64,
    independent: f64,
}

impl Integrable {
    /// What windows say, and the rows that these and `outward` say together, beginning at `rows`; `None` where there are too
    /// few. `systematic` is the least systematic error that windows have shown so far.
    pub fn of(
        records: &mut Records,
        noise: &Mat3,
        outward: &Outward,
        rows: Mat3,
        systematic: f64,
    ) -> Option<(Self, Mat3)> {
        let independent = records.independent * records.numbers.len() as f64;
        let prior = |rows: &Mat3| outward.cost(rows);
        let mut form =
            Self { squares: Form::ZERO, noise: Form::ZERO, model: 0.0, factor: independent, independent };
        let mut rows = rows;
        let mut parts = Sums { squares: [Form::ZERO; PARTS * PARTS], noise: [[0.0; TERMS]; PARTS * PARTS] };
        for round in 0..ROUNDS {
            let variance = noise::variance(&rows, noise);
            let of = |record: &Record| {
                let s = record.s(&rows);
                [s * s, noise::total(&variance, &record.noise_terms())]
            };
            let model = excess(records, of, MEDIAN_OF_ONE)?;
            parts.weigh(records, &variance, &rows, model.model, round > 0);
            (form.squares, form.noise) = parts.total(noise);
            form.model = (form.squares.at(&rows) - form.noise.at(&rows)).max(0.0);
            let cost = |rows: &Mat3| form.cost(rows) + prior(rows);
            rows = if round == 0 {
                minimum([&rows, &mat3::IDENTITY], cost).rows
            } else {
                polish(rows, cost(&rows), ROUND_EVALUATIONS, cost).0
            };
            form.model = (form.squares.at(&rows) - form.noise.at(&rows)).max(0.0);
            form.factor = parts.information(&form, noise, &rows, systematic / (model.noise + model.model))?;
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

/// How much of `N.N_x` and `N.N_y`, squared, is not noise; `None` where there are too few windows.
pub(super) fn systematic_error(records: &mut Records, noise: &Mat3) -> Option<f64> {
    if records.numbers.len() < SMALLEST_WINDOWS {
        return None;
    }
    let of = |record: &Record| [record.radial, record.radial_noise(noise)];
    excess(records, of, MEDIAN_OF_TWO).map(|excess| excess.model)
}

/// What the median of a square is above the median of the variance that noise gives it, and that variance.
struct Excess {
    model: f64,
    noise: f64,
}

/// `of` gives square and variance of a window; `median` is that of the square for a variance of 1.
fn excess(records: &mut Records, of: impl Fn(&Record) -> [f64; 2], median: f64) -> Option<Excess> {
    let n = records.numbers.len();
    let (squares, variances) = records.scratch.split_at_mut_checked(n)?;
    let slots = squares.iter_mut().zip(variances.iter_mut());
    for (record, (square, variance)) in records.numbers.iter().map(Record::load).zip(slots) {
        let [a, b] = of(&record);
        (*square, *variance) = (a as f32, b as f32);
    }
    let square = f64::from(kth_smallest(squares, median_rank(n))?);
    let noise = f64::from(kth_smallest(variances.get_mut(..n)?, median_rank(n))?);
    Some(Excess { model: (square / median - noise).max(0.0), noise })
}

/// Sums by part of the picture: of squares, and of what their noise is linear in.
struct Sums {
    squares: [Form; PARTS * PARTS],
    noise: [noise::Terms; PARTS * PARTS],
}

impl Sums {
    /// The sums with the weights that windows have at `rows`, where `variance` makes that of `s`; `robust` ones where s^2 is too
    /// large for its variance.
    #[inline(never)]
    fn weigh(&mut self, records: &Records, variance: &noise::Terms, rows: &Mat3, model: f64, robust: bool) {
        self.squares = [Form::ZERO; PARTS * PARTS];
        self.noise = [[0.0; TERMS]; PARTS * PARTS];
        for record in records.iter() {
            let terms = record.noise_terms();
            let expected = noise::total(variance, &terms) + model;
            if expected.is_nan() || expected <= 0.0 {
                continue;
            }
            let mut weight = 1.0 / expected;
            if robust {
                let s = record.s(rows);
                let excess = 1.0 + s * s / (CUT * expected);
                weight /= excess * excess;
            }
            let part = records.parts.of(record.at);
            if let (Some(form), Some(noise)) = (self.squares.get_mut(part), self.noise.get_mut(part)) {
                form.add_square(&record.v, weight);
                for (sum, term) in noise.iter_mut().zip(terms) {
                    *sum += weight * term;
                }
            }
        }
    }

    /// The forms of all parts together: of squares, and of noise.
    fn total(&self, noise: &Mat3) -> (Form, Form) {
        let (mut squares, mut terms) = (Form::ZERO, [0.0; TERMS]);
        self.squares.iter().for_each(|form| squares.add(form));
        for part in &self.noise {
            terms.iter_mut().zip(part).for_each(|(sum, term)| *sum += term);
        }
        (squares, noise::form(&terms, noise))
    }

    /// The factor that makes a log likelihood of the ratio of `form` near its minimum `rows`: 3 over the trace of
    /// H^-1 G, with H its second derivatives and G the scatter of its gradient, but no more than independent windows would
    /// give, and less where errors are systematic: `share` of s^2 they are.
    #[inline(never)]
    fn information(&self, form: &Integrable, noise: &Mat3, rows: &Mat3, share: f64) -> Option<f64> {
        let expected = form.noise.at(rows) + form.model;
        if expected.is_nan() || expected <= 0.0 {
            return None;
        }
        let ratio = form.ratio(rows);
        let (_, hessian) = derivatives(rows, |rows| form.ratio(rows));
        let (mut used, mut mean, mut scatter) = (0.0, [0.0; 3], [[0.0; 3]; 3]);
        for (squares, terms) in self.squares.iter().zip(&self.noise) {
            if *squares == Form::ZERO {
                continue;
            }
            let own_noise = noise::form(terms, noise);
            let (gradient, _) =
                derivatives(rows, |rows| (squares.at(rows) - ratio * own_noise.at(rows)) / expected);
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
        let least = SMALLEST_CURVATURE * trace(&hessian).abs().max(f64::MIN_POSITIVE);
        let white = 1.0 / form.independent;
        let random = GRADIENT_NEIGHBORS * trace(&mat3::multiply(&inverse(&hessian, least), &scatter)) / 3.0;
        let share = share.max(SMALLEST_SYSTEMATIC_SHARE);
        let systematic = 2.0 * share * share * share / SYSTEMATIC_WINDOWS;
        let total = random.max(white) + systematic;
        (total > 0.0).then(|| 1.0 / total)
    }
}
