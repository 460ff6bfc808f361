//! The equations of one pixel of the coupled model, and Gauss-Seidel steps that solve them pixel after pixel.
//!
//! Divided by the weight of the misfit between depth and slopes, and with the width of its own pixels for the unit of length,
//! every grid has the same energy: edges keep the squared misfit of depth, pixels and edges `stiffness` times the squares of
//! slopes and of their differences. Only the stiffness falls, to a quarter from a grid to the next coarser one.

use super::grid::Grid;
use super::operator::{Network, at};
use super::span::{Span, StoredSpan};
use core::array::from_fn;

/// Weight of the misfit between depth and slopes, in units of the smoothness. In a gap, slopes depart from those of their
/// depth over the root of its inverse, a third of a pixel, which is no distance on a grid: more would hardly change the
/// result (by some per cent for ten times as much) and only be slower to solve.
pub(super) const MISFIT: f64 = 10.0;

/// Depth, p and q of a pixel, or what belongs to their equations.
pub(super) type Triple = [f32; 3];

/// The graph of the coupled model: its mass is that of p and q.
pub(super) trait Coupled: Network + Copy {
    /// The mass of the depth of pixel `index`: where a prior knows it.
    fn anchor(&self, index: usize) -> f32;
    /// Whether the pixel has unknowns; on coarse grids it does not matter what the others are given.
    fn is_inside(&self, index: usize) -> bool;
}

/// Rows of numbers, any stride apart.
pub(super) struct Field<'a> {
    pub data: &'a mut [f32],
    pub first: usize,
    pub stride: usize,
    pub width: usize,
}

impl<'a> Field<'a> {
    /// An array in grid layout.
    pub const fn of(grid: Grid, data: &'a mut [f32]) -> Self {
        Self { data, first: grid.start(0), stride: grid.stride(), width: grid.width }
    }

    /// The row above row `y`, row `y`, and the row below; there are none beyond the ends.
    fn around(&mut self, y: usize) -> [&mut [f32]; 3] {
        let start = self.first + y * self.stride;
        let (before, rest) = self.data.split_at_mut_checked(start).unwrap_or_default();
        let (center, after) = rest.split_at_mut_checked(self.width).unwrap_or_default();
        let above =
            start.checked_sub(self.stride).and_then(|above| before.get_mut(above..above + self.width));
        let below = self.stride - self.width;
        let below = after.get_mut(below..below + self.width);
        [above.unwrap_or_default(), center, below.unwrap_or_default()]
    }

    /// Row `y`.
    pub fn row_mut(&mut self, y: usize) -> &mut [f32] {
        let start = self.first + y * self.stride;
        self.data.get_mut(start..start + self.width).unwrap_or_default()
    }
}

/// Right sides, row by row.
pub(super) trait Right {
    /// The right sides of row `y`.
    fn row(&mut self, y: usize) -> [&[f32]; 3];
}

/// The equations of a grid.
pub(super) struct Equations<'a, O, R> {
    pub operator: O,
    pub stiffness: f32,
    pub right: R,
    /// Depth, p and q.
    pub unknowns: [Field<'a>; 3],
}

/// The coefficients of one pixel: edges to the left, right, upper and lower neighbor, and masses.
pub(super) struct Coefficients {
    pub edges: [f32; 4],
    /// Weights of the misfits along them.
    pub misfits: [f32; 4],
    /// Of p and q.
    pub mass: f32,
    /// Of depth.
    pub anchor: f32,
}

impl Coefficients {
    #[inline(always)]
    pub fn of(operator: &impl Coupled, index: usize, stiffness: f32) -> Self {
        let stride = operator.grid().stride();
        let edges = [
            operator.east(index - 1),
            operator.east(index),
            operator.south(index - stride),
            operator.south(index),
        ];
        let mut misfits = edges;
        let softness = MISFIT as f32 * stiffness;
        if softness < 1.0 {
            let hold = |index: usize| (stiffness * operator.mass(index) + softness).min(1.0);
            let own = hold(index);
            let neighbors = [index - 1, index + 1, index - stride, index + stride];
            for (misfit, neighbor) in misfits.iter_mut().zip(neighbors) {
                *misfit *= 0.5 * (own + hold(neighbor));
            }
        }
        Self { edges, misfits, mass: stiffness * operator.mass(index), anchor: operator.anchor(index) }
    }

    /// Half of the gradient of the energy with respect to the depth, p and q of the pixel; neighbors as the edges.
    #[inline(always)]
    fn gradient(&self, stiffness: f32, center: Triple, neighbors: [Triple; 4]) -> Triple {
        let [wl, wr, wu, wd] = self.edges;
        let [ml, mr, mu, md] = self.misfits;
        let [l, r, u, d] = neighbors;
        let [z, p, q] = center;
        let left = ml * (z - l[0] - 0.5 * (l[1] + p));
        let right = mr * (r[0] - z - 0.5 * (p + r[1]));
        let up = mu * (u[0] - z - 0.5 * (q + u[2]));
        let down = md * (z - d[0] - 0.5 * (d[2] + q));
        let bend = |k: usize, value: f32| {
            (wl * (value - l[k]) + wr * (value - r[k])) + (wu * (value - u[k]) + wd * (value - d[k]))
        };
        [
            (left - right) + (down - up) + self.anchor * z,
            self.mass * p + stiffness * bend(1, p) - 0.5 * (left + right),
            self.mass * q + stiffness * bend(2, q) - 0.5 * (up + down),
        ]
    }

    /// What the pixel and its edges to the left and up add to the energy.
    #[inline(always)]
    pub fn energy(&self, stiffness: f32, [z, p, q]: Triple, left: Triple, up: Triple) -> f32 {
        let [wl, _, wu, _] = self.edges;
        let [ml, _, mu, _] = self.misfits;
        let square = |value: f32| value * value;
        let bend = |other: Triple| stiffness * (square(p - other[1]) + square(q - other[2]));
        (ml * square(z - left[0] - 0.5 * (left[1] + p)) + wl * bend(left))
            + (mu * square(up[0] - z - 0.5 * (q + up[2])) + wu * bend(up))
            + (self.mass * (p * p + q * q) + self.anchor * z * z)
    }

    /// The change of the pixel that solves its own three equations.
    #[inline(always)]
    fn solve(&self, stiffness: f32, [z, p, q]: Triple) -> Triple {
        let [wl, wr, wu, wd] = self.edges;
        let [ml, mr, mu, md] = self.misfits;
        let base = self.mass + stiffness * ((wl + wr) + (wu + wd));
        let (zp, zq) = (0.5 * (mr - ml), 0.5 * (mu - md));
        let invert = |pivot: f32| if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
        let (ip, iq) = (invert(base + 0.25 * (ml + mr)), invert(base + 0.25 * (mu + md)));
        let zz = (ml + mr) + (mu + md) + self.anchor;
        let pivot = zz - (zp * zp * ip + zq * zq * iq);
        // Where rounding leaves nothing of the pivot, depth has to wait for its neighbors.
        let dz = if pivot > 1e-5 * zz { (z - (zp * ip * p + zq * iq * q)) / pivot } else { 0.0 };
        [dz, ip * (p - zp * dz), iq * (q - zq * dz)]
    }
}

/// Values of three rows around a pixel.
struct Rows<'a> {
    above: [&'a [f32]; 3],
    center: [&'a mut [f32]; 3],
    below: [&'a [f32]; 3],
    right: [&'a [f32]; 3],
}

impl Rows<'_> {
    #[inline(always)]
    fn residual(&self, own: &Coefficients, stiffness: f32, x: usize) -> Triple {
        let pick = |x: usize| -> Triple { from_fn(|k| self.center.get(k).map_or(0.0, |row| at(row, x))) };
        let take = |rows: &[&[f32]; 3], x: usize| -> Triple { rows.map(|row| at(row, x)) };
        let neighbors = [pick(x.wrapping_sub(1)), pick(x + 1), take(&self.above, x), take(&self.below, x)];
        let gradient = own.gradient(stiffness, pick(x), neighbors);
        let [z, p, q] = take(&self.right, x);
        [z - gradient[0], p - gradient[1], q - gradient[2]]
    }
}

impl<O: Coupled, R: Right> Equations<'_, O, R> {
    /// The active part of row `y`, its rows, and where it begins in the grid.
    fn rows(&mut self, spans: &[StoredSpan], y: usize) -> ([usize; 2], usize, Rows<'_>) {
        let grid = self.operator.grid();
        let Span { active, .. } = Span::load(spans, y, grid.width);
        let [z, p, q] = self.unknowns.each_mut().map(|field| field.around(y));
        let ([za, zc, zb], [pa, pc, pb], [qa, qc, qb]) = (z, p, q);
        let rows =
            Rows { above: [za, pa, qa], center: [zc, pc, qc], below: [zb, pb, qb], right: self.right.row(y) };
        (active, grid.start(y), rows)
    }

    /// Solves every second pixel's equations, as the squares of a chessboard, and then the others'.
    #[inline(never)]
    pub fn relax(&mut self, spans: &[StoredSpan]) {
        let stiffness = self.stiffness;
        let operator = self.operator;
        for color in 0..2 {
            for y in 0..self.operator.grid().height {
                let ([first, last], start, mut rows) = self.rows(spans, y);
                let first = first + (first + y + color) % 2;
                for x in (first..last).step_by(2) {
                    let own = Coefficients::of(&operator, start + x, stiffness);
                    let change = own.solve(stiffness, rows.residual(&own, stiffness, x));
                    for (row, change) in rows.center.iter_mut().zip(change) {
                        if let Some(value) = row.get_mut(x) {
                            *value += change;
                        }
                    }
                }
            }
        }
    }

    /// Gives the residual of every pixel, by column and row, to `take`.
    #[inline(always)]
    pub fn residuals(&mut self, spans: &[StoredSpan], mut take: impl FnMut(usize, usize, Triple)) {
        let stiffness = self.stiffness;
        for y in 0..self.operator.grid().height {
            let operator = self.operator;
            let ([first, last], start, rows) = self.rows(spans, y);
            for x in first..last {
                let own = Coefficients::of(&operator, start + x, stiffness);
                take(x, y, rows.residual(&own, stiffness, x));
            }
        }
    }
}
