//! The orthogonal transformation from all that the normals say about it: how they point outward, and that they are those
//! of one surface. The sums need no second look at the picture, so any number of candidates costs nothing.
//!
//! With N = G0 rho the normals up to a member of O(3), n = (r1.N, r2.N, r3.N), three kinds of evidence are weighed against
//! each other, each by an uncertainty estimated from the picture itself:
//!
//! - *Integrability.* For a surface, `n3 n1_y - n1 n3_y = n3 n2_x - n2 n3_x`, which is linear in the first two rows,
//!   `r1.(N x N_x) + r2.(N x N_y) = 0`: the condition of the parent's `orthogonal`, but on N and its gradients fitted to windows of
//!   8 to 64 pixels, without what noise adds to the squares, and with less weight where it fails ([`integrable`]).
//! - *Outward normals.* On the whole a normal points away from the middle of its surface: the slopes of N over position
//!   are to be along x and y. Pentland's tilts say the same of mean gradients, which only the border of the surface
//!   decides; regression listens to all of it. Both are used ([`outward`]).
//!
//! (r1, r2) -> -(r1, r2), the convex/concave twin, changes nothing in the first. The sign of `sum (x n1 + y n2) / n3`
//! over the surface chooses: normals that point outward make a dome.
//!
//! # Reference
//! Sections 2.3-2.4 (eqs. 13-15) and 3.2 (eqs. 20-21), which this combines.

mod cells;
mod form;
mod integrable;
mod outward;
mod search;

use crate::image::{Image, WINDOW, Window};
use crate::inliers::Inliers;
use crate::mat3::{self, Mat3};
use cells::{Cells, Grid, MeanPosition};
use heapless::Vec;
use integrable::Integrable;
use libm::sqrt;
use outward::Outward;

/// Which evidence decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// More than three quarters of the information are the outward normals'.
    Outward,
    /// More than three quarters are integrability's.
    Integrability,
    /// Neither.
    Both,
}

/// The transformation, and how sure it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// r1, r2, r3: n = `rows` G0 rho. Its determinant is 1 or -1.
    pub rows: Mat3,
    /// Covariance of the small rotation, a vector in the frame of n, by which `rows` may be wrong; radians squared.
    pub covariance: Mat3,
    /// What decided.
    pub evidence: Evidence,
    /// From 0 (dome and hollow fit alike) to 1 (all of the surface is a dome): how clear the choice between the twins is.
    pub dome: f64,
    /// How much less likely the best of the candidates that are more than [`APART`] away is: the difference of the two
    /// negative log likelihoods; infinite where there is none.
    pub second_best: f64,
}

impl Joint {
    /// The root mean square angle, over directions, by which normals are expected to be turned.
    #[must_use]
    pub fn expected_error(&self) -> f64 {
        sqrt(2.0 / 3.0 * trace(&self.covariance))
    }
}

/// Candidates less than this far apart, in radians, are one.
pub const APART: f64 = 0.2;

/// Square windows of so many pixels, smallest first.
const WINDOW_SIZES: [usize; 4] = [8, 16, 32, 64];

/// Larger windows are taken for a variance that is smaller by this factor at least.
const GAIN: f64 = 0.5;

/// Estimates from windows of two sizes agree up to this distance, squared, in standard deviations of three parameters.
const LARGEST_DISTANCE: f64 = 5.0;

/// How many `f32` [`estimate`] needs for a picture of this size: at most two a pixel.
#[must_use]
pub const fn workspace_len(width: usize, height: usize) -> usize {
    cells::count(width, height).saturating_mul(cells::NUMBERS + integrable::NUMBERS)
}

/// Sums over the rows of a picture, four by four: all that its orientation is found from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Survey {
    grid: Grid,
    whole: MeanPosition,
}

/// Rows that are summed at a time.
pub(crate) const STRIP: usize = cells::SIDE;

impl Survey {
    /// Over a picture of this size, of cells as small as `room` numbers allow while rows come and `later` ones after that;
    /// `None` where there is nothing to sum. `numbers` are the room.
    pub fn begin(
        width: usize,
        height: usize,
        room: usize,
        later: usize,
        numbers: &mut [f32],
    ) -> Option<Self> {
        let grid = Grid::finest(width, height, room, later)?;
        grid.clear(numbers);
        Some(Self { grid, whole: MeanPosition::default() })
    }

    /// The pixels of a window that the surface is seen in, shaded ones among them.
    pub fn see(&mut self, x: usize, y: usize, exposed: u64) {
        self.whole.add(x, y, exposed);
    }

    /// Four rows that begin at `y`, a multiple of four: a window of each, one below the other, and their inliers.
    pub fn add(
        &self,
        y: usize,
        windows: &[Window; STRIP],
        inliers: [u64; STRIP],
        root: &Mat3,
        numbers: &mut [f32],
    ) {
        self.grid.add(y, windows, inliers, root, numbers);
    }

    /// As [`estimate`], from the sums in the first of these numbers.
    pub fn end(&self, numbers: &mut [f32]) -> Option<Joint> {
        let (cells, rest) = Cells::of(&self.grid, numbers)?;
        of_cells(cells, rest, self.whole.position())
    }
}

/// The transformation of the normals `root` rho of the inliers; `None` where they are too few or too scattered to say
/// anything.
///
/// # Units
/// `root` in (pixel value)^-1.
///
/// # Scratch
/// [`workspace_len`] `f32`; what they hold before does not matter. One pass over the picture.
pub fn estimate(image: &Image, inliers: &Inliers, root: &Mat3, workspace: &mut [f32]) -> Option<Joint> {
    let (width, height) = (image.width(), image.height());
    let len = workspace_len(width, height);
    let workspace = workspace.get_mut(..len)?;
    let mut survey = Survey::begin(width, height, len, len, workspace)?;
    let mut windows = [const { Window::new() }; STRIP];
    for y in (0..height).step_by(STRIP) {
        for x in (0..width).step_by(WINDOW) {
            let mut bits = [0; STRIP];
            for ((y, window), bits) in (y..height).zip(&mut windows).zip(&mut bits) {
                image.read(x, y, window);
                survey.see(x, y, inliers.usable.exposed(window));
                *bits = inliers.bits(window);
            }
            if y + STRIP <= height {
                survey.add(y, &windows, bits, root, workspace);
            }
        }
    }
    survey.end(workspace)
}

/// The transformation, from cells and what lies behind them.
fn of_cells(mut cells: Cells, rest: &mut [f32], whole: [f64; 2]) -> Option<Joint> {
    let outward = Outward::of(&cells, rest, whole)?;
    let noise = cells.noise(rest)?;

    let prior = |rows: &Mat3| outward.cost(rows);
    let mut best = search::minimum(&search::starts(), prior);
    let mut admitted: Vec<Scale, { WINDOW_SIZES.len() }> = Vec::new();
    let mut radial = f64::INFINITY;
    for _ in WINDOW_SIZES {
        if let Some((form, rows)) = Integrable::of(&cells, &noise, &outward, best.rows, &mut radial, rest) {
            let information = search::hessian(&rows, |rows| form.cost(rows) + prior(rows));
            let spread = trace(&inverse(&information, 1.0 / LARGEST_VARIANCE));
            let scale = Scale { form, rows, information, spread };
            if !admitted.iter().all(|smaller| smaller.agrees(&rows)) || admitted.push(scale).is_err() {
                break;
            }
        }
        if !cells.merge() {
            break;
        }
    }

    let chosen = admitted.iter().reduce(
        |chosen, larger| {
            if larger.spread < GAIN * chosen.spread { larger } else { chosen }
        },
    );
    let form = chosen.map(|chosen| &chosen.form);
    let cost = |rows: &Mat3| prior(rows) + form.map_or(0.0, |form| form.cost(rows));
    let mut starts = search::starts();
    starts[0] = best.rows;
    if let Some(chosen) = chosen {
        starts[1] = chosen.rows;
    }
    best = search::minimum(&starts, cost);
    let information = search::hessian(&best.rows, cost);
    let covariance = inverse(&information, 1.0 / LARGEST_VARIANCE);
    let shared = trace(&mat3::multiply(&covariance, &search::hessian(&best.rows, prior))) / 3.0;
    let evidence = match shared {
        share if share > 0.75 => Evidence::Outward,
        share if share < 0.25 => Evidence::Integrability,
        _ => Evidence::Both,
    };
    let rows = outward.facing(best.rows);
    let (rows, dome) = outward.convex(rows);
    Some(Joint { rows, covariance, evidence, dome, second_best: best.second })
}

/// What windows of one size say together with the outward normals.
struct Scale {
    form: Integrable,
    rows: Mat3,
    information: Mat3,
    spread: f64,
}

impl Scale {
    /// Whether other rows are within the uncertainty of these. The larger windows are the more they hide of the curvature of a
    /// surface, and at some size they are wrong by more than the noise that they leave out (O. V. Lepski's rule).
    fn agrees(&self, rows: &Mat3) -> bool {
        let turn = search::turn(&self.rows, rows);
        mat3::dot(turn, mat3::apply(&self.information, turn)) <= LARGEST_DISTANCE
    }
}

fn trace(a: &Mat3) -> f64 {
    let [[a, ..], [_, b, _], [.., c]] = *a;
    a + b + c
}

/// No rotation is more uncertain than this, in radians squared.
const LARGEST_VARIANCE: f64 = 3.0;

/// The inverse of a positive semidefinite matrix whose eigenvalues below `least` are taken for that.
fn inverse(a: &Mat3, least: f64) -> Mat3 {
    let eigen = mat3::symmetric_eigen(a);
    let mut inverse = [[0.0; 3]; 3];
    for (value, vector) in eigen.values.into_iter().zip(eigen.vectors) {
        let reciprocal = 1.0 / value.max(least);
        for (row, x) in inverse.iter_mut().zip(vector) {
            for (entry, y) in row.iter_mut().zip(vector) {
                *entry += reciprocal * x * y;
            }
        }
    }
    inverse
}
