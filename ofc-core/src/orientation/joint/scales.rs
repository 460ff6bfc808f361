//! From windows of growing size to the answer.

use super::constants::{DECIDING_SHARE, GAIN, LARGEST_DISTANCE, LARGEST_VARIANCE, WINDOW_SIZES};
use super::information::{inverse, trace};
use super::integrable::{Integrable, systematic_error};
use super::outward::Outward;
use super::record::Records;
use super::result::{Evidence, Joint};
use super::search;
use crate::math::mat3::{self, Mat3};
use heapless::Vec;

/// The evidence so far.
pub(super) struct Estimate<'o> {
    outward: &'o Outward,
    /// The covariance of a pixel's N.
    noise: &'o Mat3,
    /// What outward normals say alone.
    alone: Mat3,
    admitted: Vec<Scale, { WINDOW_SIZES.len() }>,
    /// The least systematic error over windows so far: in larger ones curvature looks like it.
    systematic: f64,
}

impl<'o> Estimate<'o> {
    /// From outward normals alone.
    pub fn new(outward: &'o Outward, noise: &'o Mat3) -> Self {
        let alone = search::minimum([&mat3::IDENTITY; 2], |rows| outward.cost(rows)).rows;
        Self { outward, noise, alone, admitted: Vec::new(), systematic: f64::INFINITY }
    }

    /// Takes windows of the next size into account, and says whether still larger ones are of use.
    #[inline(never)]
    pub fn admit(&mut self, mut records: Records) -> bool {
        let (outward, noise) = (self.outward, self.noise);
        let Some(systematic) = systematic_error(&mut records, noise) else { return true };
        self.systematic = self.systematic.min(systematic);
        let Some((form, rows)) = Integrable::of(&mut records, noise, outward, self.alone, self.systematic)
        else {
            return true;
        };
        let information = search::hessian(&rows, |rows| form.cost(rows) + outward.cost(rows));
        let spread = trace(&inverse(&information, 1.0 / LARGEST_VARIANCE));
        let scale = Scale { form, rows, information, spread };
        self.admitted.iter().all(|smaller| smaller.agrees(&rows)) && self.admitted.push(scale).is_ok()
    }

    /// What all of it says.
    #[inline(never)]
    pub fn end(&self) -> Joint {
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
            share if share > DECIDING_SHARE => Evidence::Outward,
            share if share < 1.0 - DECIDING_SHARE => Evidence::Integrability,
            _ => Evidence::Both,
        };
        let (rows, convexity) = outward.convex(outward.facing(best.rows));
        let covariance = seen_in(&rows, &best.rows, &covariance);
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

/// The covariance of a rotation vector in the frame of `rows`, from the one in the frame of `others`, which differ from them in
/// signs. (A reflection turns the sense of rotation as well, which a covariance does not show.)
fn seen_in(rows: &Mat3, others: &Mat3, covariance: &Mat3) -> Mat3 {
    let mut signs = [1.0; 3];
    for (sign, (row, other)) in signs.iter_mut().zip(rows.iter().zip(others)) {
        if mat3::dot(*row, *other) < 0.0 {
            *sign = -1.0;
        }
    }
    let mut seen = *covariance;
    for (line, a) in seen.iter_mut().zip(signs) {
        for (entry, b) in line.iter_mut().zip(signs) {
            *entry *= a * b;
        }
    }
    seen
}
