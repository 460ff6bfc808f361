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
//! over the parts of the surface chooses: normals that point outward make a dome.
//!
//! # Reference
//! Sections 2.3-2.4 (eqs. 13-15) and 3.2 (eqs. 20-21), which this combines.

mod cells;
mod form;
mod grid;
mod integrable;
mod moments;
mod outward;
mod search;
mod sums;
mod windows;

pub(crate) use sums::{CellSums, STRIP, WindowSums, least_room};

use crate::color::inliers::Inliers;
use crate::math::mat3::{self, Mat3};
use crate::picture::{Image, WINDOW, Window};
use heapless::Vec;
use integrable::{Integrable, RECORD};
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
    pub convexity: f64,
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
    grid::count(width, height).saturating_mul(moments::NUMBERS + integrable::NUMBERS)
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
    let mut sums = CellSums::begin(width, height, len, workspace)?;
    let mut windows = [const { Window::new() }; STRIP];
    for y in (0..height).step_by(STRIP) {
        for x in (0..width).step_by(WINDOW) {
            let mut bits = [0; STRIP];
            for ((y, window), bits) in (y..height).zip(&mut windows).zip(&mut bits) {
                image.read(x, y, window);
                let exposed = inliers.usable.exposed(window);
                sums.see(x, y, exposed);
                *bits = inliers.bits_among(window, exposed);
            }
            if y + STRIP <= height {
                let [first, ..] = &windows;
                let color = |row: usize, i| windows.get(row).map_or([0.0; 3], |window| window.pixel(i));
                sums.add([x, y], first.len, bits, root, color, workspace);
            }
        }
    }
    sums.end(workspace)
}

/// From windows of growing size to the answer.
struct Estimate<'o> {
    outward: &'o Outward,
    noise: &'o Mat3,
    /// What outward normals say alone.
    alone: Mat3,
    admitted: Vec<Scale, { WINDOW_SIZES.len() }>,
    /// The least systematic error.
    radial: f64,
}

impl<'o> Estimate<'o> {
    fn new(outward: &'o Outward, noise: &'o Mat3) -> Self {
        let alone = search::minimum([&mat3::IDENTITY; 2], |rows| outward.cost(rows)).rows;
        Self { outward, noise, alone, admitted: Vec::new(), radial: f64::INFINITY }
    }

    /// Windows of the next size, and what each counts as; whether still larger ones are of use.
    #[inline(never)]
    fn admit(&mut self, records: (&[[f32; RECORD]], f64), scratch: &mut [f32]) -> bool {
        let (outward, noise) = (self.outward, self.noise);
        let Some((form, rows)) =
            Integrable::of(records, noise, outward, self.alone, &mut self.radial, scratch)
        else {
            return true;
        };
        let information = search::hessian(&rows, |rows| form.cost(rows) + outward.cost(rows));
        let spread = trace(&inverse(&information, 1.0 / LARGEST_VARIANCE));
        let scale = Scale { form, rows, information, spread };
        self.admitted.iter().all(|smaller| smaller.agrees(&rows)) && self.admitted.push(scale).is_ok()
    }

    #[inline(never)]
    fn end(&self) -> Joint {
        let outward = self.outward;
        let chosen = self
            .admitted
            .iter()
            .reduce(|chosen, larger| if larger.spread < GAIN * chosen.spread { larger } else { chosen });
        let prior = |rows: &Mat3| outward.cost(rows);
        let form = chosen.map(|chosen| &chosen.form);
        let cost = |rows: &Mat3| prior(rows) + form.map_or(0.0, |form| form.cost(rows));
        let own = chosen.map_or(&mat3::IDENTITY, |chosen| &chosen.rows);
        let best = search::minimum([&self.alone, own], cost);
        let information = search::hessian(&best.rows, cost);
        let covariance = inverse(&information, 1.0 / LARGEST_VARIANCE);
        let shared = trace(&mat3::multiply(&covariance, &search::hessian(&best.rows, prior))) / 3.0;
        let evidence = match shared {
            share if share > 0.75 => Evidence::Outward,
            share if share < 0.25 => Evidence::Integrability,
            _ => Evidence::Both,
        };
        let (rows, convexity) = outward.convex(outward.facing(best.rows));
        Joint { rows, covariance, evidence, convexity, second_best: best.second }
    }
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
