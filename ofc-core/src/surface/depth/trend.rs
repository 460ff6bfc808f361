//! The paraboloid that fits the slopes best, taken out before the equations are solved and put back in f64 afterwards.
//!
//! Depths run to hundreds of pixels while the equations are about differences of neighbors; what is left without the
//! paraboloid is smaller, and a surface that is one comes out exact whatever the tolerance is.

use super::grid::Grid;
use super::operator::at;
use crate::math::mat3::{cross, dot};

/// Rows that the fit looks at.
const SAMPLED_ROWS: usize = 64;

/// phi(x, y) = p x + q y + (pp x² + 2 pq x y + qq y²) / 2 in pixels from the middle of the picture, y up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Trend {
    p: f64,
    q: f64,
    pp: f64,
    pq: f64,
    qq: f64,
    middle: [f64; 2],
}

/// The sums of a straight fit of one quantity over the plane.
#[derive(Default)]
struct Moments {
    matrix: [[f64; 3]; 3],
    right: [[f64; 3]; 2],
}

/// A fit in the making.
pub(super) struct Fit {
    middle: [f64; 2],
    unit: f64,
    moments: Moments,
}

impl Fit {
    pub fn new(grid: &Grid) -> Self {
        let middle = [(grid.width - 1) as f64 / 2.0, (grid.height - 1) as f64 / 2.0];
        Self { middle, unit: middle[0].max(middle[1]).max(1.0), moments: Moments::default() }
    }

    /// The rows to add.
    pub fn rows(grid: &Grid) -> impl Iterator<Item = usize> + use<> {
        (0..grid.height).step_by(grid.height.div_ceil(SAMPLED_ROWS).max(1))
    }

    /// Adds the slopes `p`, `q` of the pixels of row `y` that count.
    #[inline(always)]
    pub fn add(&mut self, y: usize, counts: impl Fn(usize) -> bool, p: &[f32], q: &[f32]) {
        let v = (self.middle[1] - y as f64) / self.unit;
        for (x, (&p, &q)) in p.iter().zip(q).enumerate() {
            if counts(x) {
                let basis = [1.0, (x as f64 - self.middle[0]) / self.unit, v];
                self.moments.add(basis, [f64::from(p), f64::from(q)]);
            }
        }
    }

    pub fn trend(&self) -> Trend {
        let [p, q] = self.moments.solve();
        let ([p, pp, pq], [q, qp, qq]) = (p, q);
        let (unit, middle) = (self.unit, self.middle);
        Trend { p, q, pp: pp / unit, pq: 0.5 * (pq + qp) / unit, qq: qq / unit, middle }
    }
}

impl Trend {
    /// Fits the slopes `p`, `q` (in grid layout) of pixels whose word is not zero.
    #[inline(never)]
    pub fn fit(grid: &Grid, words: &[u32], p: &[f32], q: &[f32]) -> Self {
        let mut fit = Fit::new(grid);
        for y in Fit::rows(grid) {
            let weights = grid.row(words, y);
            fit.add(y, |x| at(weights, x) != 0, grid.row(p, y), grid.row(q, y));
        }
        fit.trend()
    }

    /// Its p and q along row `y`, each the value at column 0 and the slope.
    pub fn slopes(&self, y: f64) -> [[f64; 2]; 2] {
        let v = self.middle[1] - y;
        [
            [self.p + self.pq * v - self.pp * self.middle[0], self.pp],
            [self.q + self.qq * v - self.pq * self.middle[0], self.pq],
        ]
    }

    /// Its depth along row `y`: a polynomial in the column.
    pub fn depth(&self, y: usize) -> [f64; 3] {
        let v = self.middle[1] - y as f64;
        let [[p0, pp], _] = self.slopes(y as f64);
        let middle = self.middle[0];
        let left = self.q * v + 0.5 * self.qq * v * v - (self.p + self.pq * v) * middle
            + 0.5 * self.pp * middle * middle;
        [left, p0, 0.5 * pp]
    }
}

impl Moments {
    fn add(&mut self, basis: [f64; 3], values: [f64; 2]) {
        for (row, &b) in self.matrix.iter_mut().zip(&basis) {
            for (entry, &c) in row.iter_mut().zip(&basis) {
                *entry += b * c;
            }
        }
        for (right, &value) in self.right.iter_mut().zip(&values) {
            for (entry, &b) in right.iter_mut().zip(&basis) {
                *entry += b * value;
            }
        }
    }

    fn solve(&self) -> [[f64; 3]; 2] {
        let [mut a, mut b, mut c] = self.matrix;
        // A hair of ridge: pixels may all lie on one line, and then the slope across it does not matter.
        let ridge = 1e-9 * a[0];
        a[0] += ridge;
        b[1] += ridge;
        c[2] += ridge;
        let minors = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = dot(a, minors[0]);
        let factor = if determinant > 0.0 { 1.0 / determinant } else { 0.0 };
        // The matrix is symmetric, and so is its adjugate.
        self.right.map(|right| minors.map(|minor| dot(minor, right) * factor))
    }
}
