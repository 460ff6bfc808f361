//! From where it begins to the form that pairs, noise and paint agree on: a reweighted generalized eigenproblem.
//!
//! Two colors p and q have the lengths P = p^T C p and Q = q^T C q, their mean S, and the relative difference
//! r = (P - Q) / S - g . d, d being the step between their pixels and g what a gradient of the paint across the whole picture makes.
//! Noise of the deviation sigma in each channel gives r the variance v = 4 sigma^2 (|C p|^2 + |C q|^2) / S^2, and paint gives it
//! gamma^2, which is of each distance its own and what the scatter of r has beyond v. The weights are Tukey's, over the variance
//! of P - Q. With the monomials m of a color, P = z . m(p), independent paint adds to D, the weighted sum of the squares of
//! m(p) - m(q), in proportion to N, that of gamma^2 / 2 times the squares of m(p) and of m(q): the eigenvector of the smallest
//! eigenvalue of (D, N) is not moved by it. The gradient, which is linear in both, is eliminated from D.

use super::pairs::{DISTANCES, FEWEST, Pair, Pairs, lengths, monomials};
use crate::color::dispersion::CONSISTENCY;
use crate::color::ellipsoid::{Coefficients, is_positive_definite, matrix};
use crate::math::mat3::{Mat3, apply, dot};
use crate::math::mat6::{self, Mat6};
use crate::math::pencil;
use crate::math::select::{kth_smallest, median_rank};
use libm::{fabs, sqrt};

/// Rounds of reweighting. By trial: later ones change nothing.
const ROUNDS: usize = 15;
/// Differences above so many deviations have no weight.
const CUT: f64 = 4.0;
/// The smallest variance that paint is given.
const LEAST_VARIANCE: f64 = 1e-6;
/// What keeps N positive definite, as a share of its trace.
const RIDGE: f64 = 1e-12;
/// The shortest length there is, of those whose median is 1.
const SHORTEST: f64 = 1e-6;

/// What the rounds end at.
pub(super) struct Refined {
    pub(super) form: Coefficients,
    /// Of log a^2, a pixel, along rows and down columns.
    pub(super) gradient: [f64; 2],
    pub(super) ratio: f64,
    pub(super) variogram: [f64; DISTANCES],
}

/// Refines the form; `None` where the pairs are too few or too much alike. The deviation of the `noise` is that of the colors of
/// pairs.
pub(super) fn refine(pairs: &Pairs, start: Coefficients, noise: f64, values: &mut [f32]) -> Option<Refined> {
    let mut model = Model { form: start, c: matrix(&start), gradient: [0.0; 2], noise };
    let mut variances = [None::<f64>; DISTANCES];
    let mut ratio = f64::NAN;
    for _ in 0..ROUNDS {
        let mut sums = Sums::default();
        for (variance, own) in variances.iter_mut().zip(pairs.of) {
            if own.len() >= FEWEST {
                let now = model.paint_variance(own, values);
                let mean = variance.map_or(now, |before| sqrt(before * now));
                *variance = Some(mean);
                for pair in own {
                    model.add(pair, mean, &mut sums);
                }
            }
        }
        sums.ridge();
        let inverse = sums.eliminate_gradient();
        let smallest = pencil::smallest(&sums.d, &sums.n)?;
        let [least, next] = smallest.values;
        ratio = sqrt(next / least.max(f64::MIN_POSITIVE));
        let [c11, c22, c33, ..] = smallest.vector;
        let sign = 1.0_f64.copysign(c11 + c22 + c33);
        let found = smallest.vector.map(|c| sign * c);
        if !is_positive_definite(&found) {
            break;
        }
        let middle = median_length(pairs, &found, values);
        model.form = found.map(|c| c / middle);
        model.c = matrix(&model.form);
        let [x, y] = sums.gradient.map(|row| mat6::dot(&row, &model.form));
        let [xx, xy, yy] = inverse;
        model.gradient = [xx * x + xy * y, xy * x + yy * y];
    }
    let variogram = variances.map(|variance| variance.map_or(f64::NAN, sqrt));
    let Model { form, gradient, .. } = model;
    let is_finite = form.iter().chain(&gradient).all(|c| c.is_finite());
    is_finite.then_some(Refined { form, gradient: gradient.map(|g| -g), ratio, variogram })
}

/// The weighted sums over all pairs.
#[derive(Default)]
struct Sums {
    /// Of the squares of the differences of the monomials.
    d: Mat6,
    /// Of what independent paint adds to them.
    n: Mat6,
    /// Of the differences times S d: along rows, down columns.
    gradient: [[f64; 6]; 2],
    /// Of the products of S d with itself: xx, xy, yy.
    steps: [f64; 3],
}

impl Sums {
    fn ridge(&mut self) {
        let ridge = RIDGE * mat6::diagonal(&self.n).iter().sum::<f64>();
        for (i, column) in self.n.iter_mut().enumerate() {
            if let Some(entry) = column.get_mut(i) {
                *entry += ridge;
            }
        }
    }

    /// Takes from D what the best gradient explains, and returns the inverse of the sums over the steps, zero where it has none.
    fn eliminate_gradient(&mut self) -> [f64; 3] {
        let [xx, xy, yy] = self.steps;
        let determinant = xx * yy - xy * xy;
        if determinant <= RIDGE * xx * yy {
            return [0.0; 3];
        }
        let inverse = [yy / determinant, -xy / determinant, xx / determinant];
        let [along, down] = self.gradient;
        add_product(&mut self.d, &along, &along, -inverse[0]);
        add_product(&mut self.d, &along, &down, -inverse[1]);
        add_product(&mut self.d, &down, &along, -inverse[1]);
        add_product(&mut self.d, &down, &down, -inverse[2]);
        inverse
    }
}

/// A form and a gradient, and the noise that lengths are seen through.
struct Model {
    form: Coefficients,
    c: Mat3,
    gradient: [f64; 2],
    noise: f64,
}

impl Model {
    /// The mean length S of a pair, its relative difference r, and the variance v that noise gives that.
    fn difference(&self, pair: &Pair) -> [f64; 3] {
        let [p, q] = lengths(&self.form, pair).map(|length| length.max(SHORTEST));
        let mean = 0.5 * (p + q);
        let [pr, pg, pb, qr, qg, qb, x, y] = pair.map(f64::from);
        let [p_slope, q_slope] = [[pr, pg, pb], [qr, qg, qb]].map(|color| {
            let slope = apply(&self.c, color);
            dot(slope, slope)
        });
        let variance = 4.0 * self.noise * self.noise * (p_slope + q_slope) / (mean * mean);
        let [along, down] = self.gradient;
        [mean, (p - q) / mean - along * x - down * y, variance]
    }

    /// What the differences scatter beyond the noise.
    fn paint_variance(&self, pairs: &[Pair], values: &mut [f32]) -> f64 {
        let mut median = |value: fn([f64; 3]) -> f64| {
            for (slot, pair) in values.iter_mut().zip(pairs) {
                *slot = value(self.difference(pair)) as f32;
            }
            let values = values.get(..pairs.len()).unwrap_or_default();
            kth_smallest(values, median_rank(values.len())).map_or(0.0, f64::from)
        };
        let deviation = CONSISTENCY * median(|[_, r, _]| fabs(r));
        let noise = median(|[_, _, v]| v);
        (deviation * deviation - noise).max(LEAST_VARIANCE)
    }

    /// Adds a pair to the sums.
    fn add(&self, pair: &Pair, paint: f64, sums: &mut Sums) {
        let [mean, r, noise] = self.difference(pair);
        let variance = noise + paint;
        let u = r / (CUT * sqrt(variance));
        if fabs(u) >= 1.0 {
            return;
        }
        let tukey = (1.0 - u * u) * (1.0 - u * u);
        let weight = tukey / (variance * mean * mean);
        let [p, q] = monomials(pair);
        let mut difference = p;
        for (entry, q) in difference.iter_mut().zip(q) {
            *entry -= q;
        }
        add_product(&mut sums.d, &difference, &difference, weight);
        add_product(&mut sums.n, &p, &p, 0.5 * weight * paint);
        add_product(&mut sums.n, &q, &q, 0.5 * weight * paint);
        let &[.., x, y] = pair;
        let step = [x, y].map(|step| mean * f64::from(step));
        for (sum, step) in sums.gradient.iter_mut().zip(step) {
            for (entry, difference) in sum.iter_mut().zip(difference) {
                *entry += weight * step * difference;
            }
        }
        let [x, y] = step;
        for (sum, square) in sums.steps.iter_mut().zip([x * x, x * y, y * y]) {
            *sum += weight * square;
        }
    }
}

/// Adds factor a b^T.
fn add_product(sum: &mut Mat6, a: &[f64; 6], b: &[f64; 6], factor: f64) {
    for (column, b) in sum.iter_mut().zip(b) {
        for (entry, a) in column.iter_mut().zip(a) {
            *entry += factor * a * b;
        }
    }
}

/// The median of rho^T C rho over the first colors of the pairs of the shortest distance that has enough.
fn median_length(pairs: &Pairs, form: &Coefficients, values: &mut [f32]) -> f64 {
    let own = pairs.of.into_iter().find(|own| own.len() >= FEWEST).unwrap_or_default();
    for (slot, pair) in values.iter_mut().zip(own) {
        let [p, _] = lengths(form, pair);
        *slot = p as f32;
    }
    let values = values.get(..own.len()).unwrap_or_default();
    let median = kth_smallest(values, median_rank(values.len())).map_or(1.0, f64::from);
    if median > 0.0 { median } else { 1.0 }
}
