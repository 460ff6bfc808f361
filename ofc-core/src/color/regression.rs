//! Least squares for M z = 1, and what it says of its own coefficients.
//!
//! The rows of M are (r^2, g^2, b^2, 2rg, 2rb, 2gb); all of M^T M is made of the fifteen monomials of degree four,
//! summed in one pass.
//!
//! # Reference
//! Eqs. 10-11; the statistics are the textbook's: P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier
//! Detection", Wiley 1987, chapter 2.

mod errors;
mod lanes;

pub use errors::{Triangle, add_square, whole};

pub(crate) use lanes::WindowMoments;

use crate::color::ellipsoid::{Coefficients, matrix};
use crate::math::mat6::{self, Mat6};
use crate::math::student_t;
use libm::sqrt;

/// Coefficients of the quadratic form.
pub const TERMS: usize = 6;

/// The sums that M^T M and M^T 1 are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// How many colors were added.
    pub count: u32,
    quartic: [f64; 15],
    quadratic: [f64; 6],
}

impl Moments {
    /// Adds a color.
    #[inline(never)]
    pub fn add(&mut self, [r, g, b]: [f64; 3]) {
        let (rr, gg, bb, rg, rb, gb) = (r * r, g * g, b * b, r * g, r * b, g * b);
        // A line a term: a loop over them takes twice the instructions where code is made small.
        let [r4, r2g2, r2b2, r3g, r3b, r2gb, g4, g2b2, rg3, rg2b, g3b, b4, rgb2, rb3, gb3] =
            &mut self.quartic;
        *r4 += rr * rr;
        *r2g2 += rr * gg;
        *r2b2 += rr * bb;
        *r3g += rr * rg;
        *r3b += rr * rb;
        *r2gb += rr * gb;
        *g4 += gg * gg;
        *g2b2 += gg * bb;
        *rg3 += gg * rg;
        *rg2b += gg * rb;
        *g3b += gg * gb;
        *b4 += bb * bb;
        *rgb2 += bb * rg;
        *rb3 += bb * rb;
        *gb3 += bb * gb;
        let [r2, g2, b2, sum_rg, sum_rb, sum_gb] = &mut self.quadratic;
        *r2 += rr;
        *g2 += gg;
        *b2 += bb;
        *sum_rg += rg;
        *sum_rb += rb;
        *sum_gb += gb;
        self.count += 1;
    }

    /// Adds other sums to these.
    pub fn merge(&mut self, other: &Self) {
        for (sum, term) in self.quartic.iter_mut().zip(&other.quartic) {
            *sum += term;
        }
        for (sum, term) in self.quadratic.iter_mut().zip(&other.quadratic) {
            *sum += term;
        }
        self.count += other.count;
    }

    /// The second moments of the colors, E\[rho rho^T\].
    #[must_use]
    pub fn second_moments(&self) -> [[f64; 3]; 3] {
        matrix(&self.quadratic.map(|sum| sum / f64::from(self.count.max(1))))
    }

    fn normal_matrix(&self) -> Mat6 {
        let [r4, r2g2, r2b2, r3g, r3b, r2gb, g4, g2b2, rg3, rg2b, g3b, b4, rgb2, rb3, gb3] = self.quartic;
        [
            [r4, r2g2, r2b2, 2.0 * r3g, 2.0 * r3b, 2.0 * r2gb],
            [r2g2, g4, g2b2, 2.0 * rg3, 2.0 * rg2b, 2.0 * g3b],
            [r2b2, g2b2, b4, 2.0 * rgb2, 2.0 * rb3, 2.0 * gb3],
            [2.0 * r3g, 2.0 * rg3, 2.0 * rgb2, 4.0 * r2g2, 4.0 * r2gb, 4.0 * rg2b],
            [2.0 * r3b, 2.0 * rg2b, 2.0 * rb3, 4.0 * r2gb, 4.0 * r2b2, 4.0 * rgb2],
            [2.0 * r2gb, 2.0 * g3b, 2.0 * gb3, 4.0 * rg2b, 4.0 * rgb2, 4.0 * g2b2],
        ]
    }

    /// K, the sums of what noise does to the rows of M: noise of variance v in each channel changes the value of a form
    /// D by a variance of v z^T K z in all, z being its coefficients. (Row m of M has the derivative 2 D rho.)
    fn noise_matrix(&self) -> Mat6 {
        let [rr, gg, bb, rg, rb, gb] = self.quadratic.map(|sum| 4.0 * sum);
        [
            [rr, 0.0, 0.0, rg, rb, 0.0],
            [0.0, gg, 0.0, rg, 0.0, gb],
            [0.0, 0.0, bb, 0.0, rb, gb],
            [rg, rg, 0.0, rr + gg, gb, rb],
            [rb, 0.0, rb, gb, rr + bb, rg],
            [0.0, gb, gb, rb, rg, gg + bb],
        ]
    }

    /// The deviation of the noise in each channel that would explain residuals of this sum of squares about z.
    #[must_use]
    pub fn noise(&self, z: &Coefficients, residual_sum: f64) -> f64 {
        let change = mat6::dot(z, &mat6::apply(&self.noise_matrix(), z));
        sqrt(residual_sum / change.max(f64::MIN_POSITIVE))
    }

    /// The smallest deviation of noise in each channel with which these could be colors that do not determine z.
    ///
    /// Colors of a degenerate scene obey a second, homogeneous equation rho^T D rho = 0: C is only known up to
    /// multiples of D. Noise alone then makes the mean square of that form v z^T K z. So this is the square root of the
    /// smallest eigenvalue of M^T M relative to K.
    #[must_use]
    pub fn degenerate_noise(&self, fit: &LeastSquares) -> f64 {
        let z = self.least_determined(fit);
        let spread = mat6::dot(&z, &mat6::apply(&self.noise_matrix(), &z));
        let explained = mat6::dot(&z, &mat6::apply(&self.normal_matrix(), &z));
        if spread > 0.0 { sqrt(explained.max(0.0) / spread) } else { 0.0 }
    }

    /// The form of that eigenvalue.
    #[inline(never)]
    fn least_determined(&self, fit: &LeastSquares) -> [f64; TERMS] {
        let size = |column: &[f64; TERMS]| column.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
        let noise = self.noise_matrix();
        let mut power = [[0.0; TERMS]; TERMS];
        for (column, noise) in power.iter_mut().zip(&noise) {
            *column = apply(&fit.inverse, noise, 1.0);
        }
        for _ in 0..SQUARINGS {
            let factor = power;
            let largest = power.iter().map(size).fold(f64::MIN_POSITIVE, f64::max);
            for (column, factors) in power.iter_mut().zip(&factor) {
                *column = apply(&factor, factors, largest);
            }
        }
        // Every column is now a multiple of the eigenvector, apart from rounding: the largest one has least of it.
        power.iter().max_by(|a, b| size(a).total_cmp(&size(b))).copied().unwrap_or_default()
    }

    /// The sum of squared residuals about z, from the sums alone: good to the rounding of `count`.
    #[must_use]
    pub fn residual_sum(&self, z: &Coefficients) -> f64 {
        let [rr, gg, bb, rg, rb, gb] = self.quadratic;
        let right = [rr, gg, bb, 2.0 * rg, 2.0 * rb, 2.0 * gb];
        let mut product = mat6::apply(&self.normal_matrix(), z);
        for (entry, right) in product.iter_mut().zip(right) {
            *entry -= 2.0 * right;
        }
        (mat6::dot(z, &product) + f64::from(self.count)).max(0.0)
    }

    /// The least-squares z, and (M^T M)^-1; `None` when the colors do not determine z.
    #[must_use]
    #[inline(never)]
    pub fn solve(&self) -> Option<LeastSquares> {
        let [rr, gg, bb, rg, rb, gb] = self.quadratic;
        let mut inverse = self.normal_matrix();
        invert(&mut inverse)?;
        let coefficients = mat6::apply(&inverse, &[rr, gg, bb, 2.0 * rg, 2.0 * rb, 2.0 * gb]);
        coefficients.iter().all(|c| c.is_finite()).then_some(LeastSquares { coefficients, inverse })
    }
}

/// Makes (M^T M)^-1 of M^T M; `None` when the colors do not determine z.
#[inline(never)]
fn invert(matrix: &mut Mat6) -> Option<()> {
    // Cholesky of the matrix with a unit diagonal: its pivots then say how much of a column the others explain.
    let diagonal = mat6::diagonal(matrix);
    if diagonal.iter().any(|&entry| !(entry > 0.0 && entry.is_finite())) {
        return None;
    }
    let scale = diagonal.map(|entry| 1.0 / sqrt(entry));
    mat6::scale(matrix, &scale);
    mat6::factor(matrix)?;
    if mat6::diagonal(matrix).iter().any(|&pivot| pivot * pivot < SMALLEST_PIVOT) {
        return None;
    }
    *matrix = mat6::inverse(matrix);
    mat6::scale(matrix, &scale);
    Some(())
}

/// The matrix of these columns times `vector` / `divisor`, without temporaries.
#[inline(never)]
fn apply(columns: &[[f64; TERMS]; TERMS], vector: &[f64; TERMS], divisor: f64) -> [f64; TERMS] {
    let mut result = [0.0; TERMS];
    for (column, entry) in columns.iter().zip(vector) {
        let factor = entry / divisor;
        for (sum, entry) in result.iter_mut().zip(column) {
            *sum += entry * factor;
        }
    }
    result
}

/// A squared pivot below this share of its diagonal entry is rounding: colors of eight bits with an exact linear
/// dependence leave 1e-16, the weakest real scenes 1e-9.
const SMALLEST_PIVOT: f64 = 1e-13;

/// Squarings of the power method for the smallest eigenvalue, 128 steps of it: enough to leave a few percent at most.
const SQUARINGS: usize = 7;

/// A least-squares solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastSquares {
    /// z.
    pub coefficients: Coefficients,
    /// (M^T M)^-1: times the residual variance it is the covariance of z.
    pub inverse: [[f64; TERMS]; TERMS],
}

/// One coefficient with what the regression knows of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Value over standard error.
    pub t: f64,
    /// The two-sided p value of t under Student's distribution: how likely so large a t is if the true value is 0.
    pub p: f64,
    /// Lower confidence limit.
    pub low: f64,
    /// Upper confidence limit.
    pub high: f64,
}

/// The row of M that belongs to a color.
fn monomials([r, g, b]: [f64; 3]) -> [f64; TERMS] {
    [r * r, g * g, b * b, 2.0 * r * g, 2.0 * r * b, 2.0 * g * b]
}

/// The estimates behind a least-squares solution over `count` observations with this residual `variance`, with limits at `confidence` (0.95 for the usual ones).
#[must_use]
#[inline(never)]
pub fn estimates(fit: &LeastSquares, variance: f64, count: u32, confidence: f64) -> [Estimate; TERMS] {
    let degrees = f64::from(count) - TERMS as f64;
    let width = student_t::quantile(confidence, degrees);
    let mut estimates = [Estimate::default(); TERMS];
    for (i, (estimate, (&value, row))) in
        estimates.iter_mut().zip(fit.coefficients.iter().zip(&fit.inverse)).enumerate()
    {
        let standard_error = sqrt(variance * row.get(i).copied().unwrap_or(0.0));
        // An exact fit has no error: its t is infinite and its p zero.
        let t = if standard_error > 0.0 { value / standard_error } else { f64::INFINITY.copysign(value) };
        *estimate = Estimate {
            value,
            standard_error,
            t,
            p: student_t::two_sided_p(t, degrees),
            low: value - width * standard_error,
            high: value + width * standard_error,
        };
    }
    estimates
}

/// The z through exactly six colors, or `None` when they do not determine one.
#[must_use]
pub fn through(colors: &[[f64; 3]; TERMS]) -> Option<Coefficients> {
    let mut columns = [[0.0; TERMS]; TERMS];
    for (i, color) in colors.iter().enumerate() {
        for (column, entry) in columns.iter_mut().zip(monomials(*color)) {
            if let Some(place) = column.get_mut(i) {
                *place = entry;
            }
        }
    }
    let z = mat6::solve(&columns, &[1.0; TERMS])?;
    z.iter().all(|c| c.is_finite()).then_some(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::ellipsoid::quadratic_form;
    use crate::math::mat3;
    use crate::math::rng::Rng;

    const TRUTH: Coefficients = [3.0, 2.0, 5.0, -0.5, 0.25, -1.0];

    /// A color on the ellipsoid of `TRUTH` in a random direction of the positive octant.
    fn color(rng: &mut Rng) -> [f64; 3] {
        let direction = [rng.unit() as f32, rng.unit() as f32, rng.unit() as f32];
        let [r, g, b] = direction;
        let length = sqrt(quadratic_form(&TRUTH, r, g, b));
        direction.map(|c| f64::from(c) / length)
    }

    fn assert_close(z: &Coefficients, tolerance: f64) {
        for (got, want) in z.iter().zip(TRUTH) {
            assert!((got - want).abs() < tolerance, "{z:?}");
        }
    }

    #[test]
    fn six_colors_and_many_give_the_ellipsoid_they_lie_on() {
        let mut rng = Rng::new(11);
        let mut moments = Moments::default();
        for _ in 0..100 {
            assert_close(&through(&[(); TERMS].map(|()| color(&mut rng))).unwrap(), 1e-3);
            moments.add(color(&mut rng));
        }
        assert_close(&moments.solve().unwrap().coefficients, 1e-10);
    }

    #[test]
    fn dependent_colors_determine_nothing() {
        let mut rng = Rng::new(12);
        let mut moments = Moments::default();
        for _ in 0..100 {
            let [r, g, _] = color(&mut rng);
            moments.add([r, g, 0.5 * r + 0.25 * g]);
        }
        assert!(moments.solve().is_none());
        assert!(Moments::default().solve().is_none());
        assert!(through(&[[1.0, 1.0, 1.0]; TERMS]).is_none());
    }

    #[test]
    fn sums_of_residuals_and_second_moments_are_those_of_the_colors() {
        let mut rng = Rng::new(14);
        let colors = [(); 40].map(|()| color(&mut rng).map(|c| c * (0.9 + 0.2 * rng.unit())));
        let (mut moments, mut second) = (Moments::default(), [[0.0; 3]; 3]);
        for color in colors {
            moments.add(color);
            for (row, a) in second.iter_mut().zip(color) {
                for (entry, b) in row.iter_mut().zip(color) {
                    *entry += a * b / 40.0;
                }
            }
        }
        let residual = |[r, g, b]: [f64; 3]| {
            monomials([r, g, b]).iter().zip(TRUTH).map(|(m, z)| m * z).sum::<f64>() - 1.0
        };
        let wanted: f64 = colors.iter().map(|&color| residual(color) * residual(color)).sum();
        assert!((moments.residual_sum(&TRUTH) / wanted - 1.0).abs() < 1e-9);
        for (a, b) in moments.second_moments().as_flattened().iter().zip(second.as_flattened()) {
            assert!((a - b).abs() < 1e-14);
        }
        // Noise d changes a residual by 2 d . C rho: the sum of its squares over the variance of d.
        let change: f64 = colors
            .iter()
            .map(|&rho| {
                let half = mat3::apply(&matrix(&TRUTH), rho);
                4.0 * mat3::dot(half, half)
            })
            .sum();
        assert!((moments.noise(&TRUTH, wanted) - sqrt(wanted / change)).abs() < 1e-12);
    }

    #[test]
    fn noise_in_the_colors_moves_the_fit_by_the_bias_that_is_said() {
        let mut rng = Rng::new(15);
        let deviation = 0.01;
        let colors = [(); 300].map(|()| color(&mut rng));
        let exact = {
            let mut moments = Moments::default();
            for color in colors {
                moments.add(color);
            }
            moments
        };
        let fit = exact.solve().unwrap();
        // Without a variance of the residuals, the triangle is the bias's squares and products.
        let said = whole(&exact.error_covariance(&fit, 0.0, deviation, 1.0));
        let mut shift = [0.0; TERMS];
        for _ in 0..500 {
            let normal = || (0..12).map(|_| rng.unit()).sum::<f64>() - 6.0;
            let mut noise = std::iter::repeat_with(normal);
            let noise = [(); 300].map(|()| [(); 3].map(|()| deviation * noise.next().unwrap()));
            // Both signs: what is odd in the noise cancels, and the bias is even.
            for sign in [1.0, -1.0] {
                let mut moments = Moments::default();
                for ([r, g, b], [x, y, z]) in colors.into_iter().zip(noise) {
                    moments.add([r + sign * x, g + sign * y, b + sign * z]);
                }
                let found = moments.solve().unwrap().coefficients;
                for ((sum, found), truth) in shift.iter_mut().zip(found).zip(TRUTH) {
                    *sum += (found - truth) / 1000.0;
                }
            }
        }
        let largest = shift.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
        for (i, row) in said.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let wanted = shift[i] * shift[j];
                assert!((entry - wanted).abs() < 0.15 * largest * largest, "{i} {j}: {entry} {wanted}");
            }
        }
    }

    #[test]
    fn standard_errors_are_the_scatter_of_repeated_fits() {
        let mut rng = Rng::new(13);
        let (mut sums, mut squares, mut predicted) = ([0.0; TERMS], [0.0; TERMS], [0.0; TERMS]);
        let repeats = 400.0;
        for _ in 0..400 {
            // Noise in the response: the radius of each color is off by a random factor.
            let mut moments = Moments::default();
            let mut colors = [[0.0; 3]; 200];
            for slot in &mut colors {
                let noise = (0..12).map(|_| rng.unit()).sum::<f64>() - 6.0;
                *slot = color(&mut rng).map(|c| c * sqrt(1.0 + 0.01 * noise));
                moments.add(*slot);
            }
            let fit = moments.solve().unwrap();
            let residual_sum: f64 = colors
                .iter()
                .map(|&[r, g, b]| quadratic_form(&fit.coefficients, r as f32, g as f32, b as f32) - 1.0)
                .map(|r| r * r)
                .sum();
            for (i, e) in estimates(&fit, residual_sum / 194.0, 200, 0.95).iter().enumerate() {
                sums[i] += e.value;
                squares[i] += e.value * e.value;
                predicted[i] += e.standard_error;
            }
        }
        for i in 0..TERMS {
            let mean = sums[i] / repeats;
            let scatter = sqrt(squares[i] / repeats - mean * mean);
            let ratio = predicted[i] / repeats / scatter;
            // 400 repeats know a standard deviation to 3.5 %.
            assert!((0.85..1.15).contains(&ratio), "coefficient {i}: {ratio}");
        }
    }
}
