//! The sum of the evidences, and where it is least.

use super::constants::{
    APART, COMMON_EPS, COMMON_TURN, DECIDING_SHARE, FIRST_EPS, FOLLOWED, LARGEST_VARIANCE, LONGEST_STEP,
    OTHER_STEPS, ROUNDS, SAME, SAMPLE, SCALES, STARTS, STARTS_APART, STEPS,
};
use super::information::{inverse, trace};
use super::integrable::Integrable;
use super::mixture::Mixture;
use super::outward::Outward;
use super::result::{Evidence, Joint};
use super::search::{angle, minimum, start};
use super::value::Value;
use crate::math::mat3::{self, Mat3};
use crate::orientation::orthogonal::polish::rotation;
use heapless::Vec;
use libm::{exp, sqrt};

/// Rows, eps^2, and their cost.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    rows: Mat3,
    eps_squared: [f64; SCALES],
    cost: f64,
}

/// All that is weighed.
struct Sum<'e, 'w> {
    integrable: [Integrable<'w>; SCALES],
    outward: &'e Outward,
    /// What integrability counts of its own likelihood.
    belief: [f64; SCALES],
}

/// What integrability counts of its own likelihood, of which the information is given. An error of the model turns all windows alike,
/// so that however many there are, what they say together is no more certain than that common turn.
fn belief(eps_squared: f64, information: &Mat3) -> f64 {
    let ratio = eps_squared / (COMMON_EPS * COMMON_EPS);
    let common = COMMON_TURN * ratio;
    1.0 / (1.0 + common * common * trace(information) / 3.0)
}

/// What a sum is at rows and eps^2.
struct At {
    value: Value,
    /// The derivative by log eps^2, and what is expected of the second.
    eps: [[f64; 2]; SCALES],
}

impl Sum<'_, '_> {
    fn at(&self, rows: &Mat3, eps_squared: &[f64; SCALES]) -> At {
        let mut at = At { value: Value::of(rows, |rows| self.outward.cost(rows)), eps: [[0.0; 2]; SCALES] };
        let scales = self.integrable.iter().zip(self.belief).zip(eps_squared);
        for (((integrable, belief), &eps_squared), eps) in scales.zip(&mut at.eps) {
            let likelihood = integrable.likelihood(rows, eps_squared);
            at.value.add(&likelihood.value, belief);
            *eps = [likelihood.by_eps, likelihood.eps_information];
        }
        at
    }

    /// Scoring steps from a candidate.
    fn polish(&self, from: &Candidate, steps: usize) -> Candidate {
        let Candidate { mut rows, mut eps_squared, .. } = *from;
        let mut here = self.at(&rows, &eps_squared);
        let mut damping = 1e-3;
        for _ in 0..steps {
            let least = damping * trace(&here.value.information) / 3.0 + 1e-9;
            let mut damped = here.value.information;
            for (i, row) in damped.iter_mut().enumerate() {
                if let Some(entry) = row.get_mut(i) {
                    *entry += least;
                }
            }
            let Some(inverse) = mat3::inverse(&damped) else { break };
            let step = mat3::scale(mat3::apply(&inverse, here.value.gradient), -1.0);
            let length = sqrt(mat3::dot(step, step));
            let step = if length > LONGEST_STEP { mat3::scale(step, LONGEST_STEP / length) } else { step };
            let mut next_eps = eps_squared;
            for (eps, [slope, information]) in next_eps.iter_mut().zip(here.eps) {
                let by = -slope / (information * (1.0 + damping) + 1e-3);
                *eps = Integrable::bounded(*eps * exp(by.clamp(-1.5, 1.5)));
            }
            let next = mat3::multiply(&rotation(step), &rows);
            let there = self.at(&next, &next_eps);
            if there.value.cost <= here.value.cost {
                let gain = here.value.cost - there.value.cost;
                (rows, eps_squared, here) = (next, next_eps, there);
                damping = (damping * 0.2).max(1e-6);
                if gain < 1e-7 || length < 1e-6 {
                    break;
                }
            } else {
                damping *= 8.0;
                if damping > 1e6 {
                    break;
                }
            }
        }
        Candidate { rows, eps_squared, cost: here.value.cost }
    }

    /// The best of a few eps for these rows.
    fn least_over_eps(&self, rows: Mat3) -> Candidate {
        let mut best = Candidate { rows, eps_squared: [1.0; SCALES], cost: self.outward.cost(&rows) };
        for ((integrable, belief), slot) in self.integrable.iter().zip(self.belief).zip(&mut best.eps_squared)
        {
            let mut least = f64::INFINITY;
            for eps in FIRST_EPS {
                let cost = integrable.likelihood(&rows, eps * eps).value.cost;
                if cost < least {
                    (least, *slot) = (cost, eps * eps);
                }
            }
            best.cost += belief * least;
        }
        best
    }
}

/// Takes a candidate among the best ones that lie apart, if it is one.
fn consider(candidate: Candidate, best: &mut Vec<Candidate, FOLLOWED>) {
    let near = best.iter().position(|other| angle(&other.rows, &candidate.rows) <= STARTS_APART);
    let dearest = || (0..best.len()).reduce(|a, b| if cost_of(best, b) > cost_of(best, a) { b } else { a });
    let place = if near.is_none() && !best.is_full() { None } else { near.or_else(dearest) };
    match place.and_then(|place| best.get_mut(place)) {
        Some(other) if candidate.cost < other.cost => *other = candidate,
        Some(_) => {}
        None => drop(best.push(candidate)),
    }
}

fn cost_of(candidates: &[Candidate], i: usize) -> f64 {
    candidates.get(i).map_or(f64::INFINITY, |candidate| candidate.cost)
}

/// The one of least cost.
fn least<'c>(candidates: impl Iterator<Item = &'c Candidate>) -> Option<&'c Candidate> {
    candidates.reduce(|least, other| if other.cost < least.cost { other } else { least })
}

/// What both say.
#[inline(never)]
pub(super) fn estimate(outward: &Outward, integrable: [Integrable; SCALES]) -> Joint {
    let alone = minimum(|rows| outward.cost(rows));
    let sample =
        integrable.map(|all| Integrable { stride: all.windows.len().div_ceil(SAMPLE).max(1), ..all });
    let mut sum = Sum { integrable: sample, outward, belief: [1.0; SCALES] };
    // What integrability takes to be best, from everywhere.
    let mut promising: Vec<Candidate, FOLLOWED> = Vec::new();
    for i in 0..STARTS {
        consider(sum.least_over_eps(start(i)), &mut promising);
    }
    let mut followed: Vec<Candidate, { FOLLOWED + 1 }> = Vec::new();
    for candidate in &promising {
        let _ = followed.push(sum.polish(candidate, STEPS));
    }
    let _ = followed.push(sum.polish(&sum.least_over_eps(alone), STEPS));
    sum.integrable = integrable;
    let mut best = Candidate { rows: alone, eps_squared: [1.0; SCALES], cost: f64::INFINITY };
    if let Some(first) = least(followed.iter()) {
        best = sum.polish(first, STEPS);
    }
    let mut second = f64::INFINITY;
    let mut others: Vec<Candidate, { FOLLOWED + 1 }> = Vec::new();
    for _ in 0..ROUNDS {
        // The error of the model belongs to integrability, and so does what it allows.
        for ((integrable, belief_of), eps) in integrable.iter().zip(&mut sum.belief).zip(best.eps_squared) {
            let own = integrable.likelihood(&best.rows, eps);
            *belief_of = belief(eps, &own.value.information);
        }
        let mut found = sum.polish(&best, STEPS);
        second = f64::INFINITY;
        others.clear();
        for other in &followed {
            if angle(&other.rows, &found.rows) <= SAME {
                continue;
            }
            let other = sum.polish(other, OTHER_STEPS);
            if angle(&other.rows, &found.rows) > APART {
                second = second.min((other.cost - found.cost).abs());
            }
            let (better, worse) = if other.cost < found.cost { (other, found) } else { (found, other) };
            found = better;
            if others.iter().all(|known| angle(&known.rows, &worse.rows) > SAME) {
                let _ = others.push(worse);
            }
        }
        best = found;
    }
    let total = sum.at(&best.rows, &best.eps_squared).value;
    let covariance = inverse(&total.information, 1.0 / LARGEST_VARIANCE);
    let theirs = Value::of(&best.rows, |rows| outward.cost(rows)).information;
    let evidence = match trace(&mat3::multiply(&covariance, &theirs)) / 3.0 {
        share if share > DECIDING_SHARE => Evidence::Outward,
        share if share < 1.0 - DECIDING_SHARE => Evidence::Integrability,
        _ => Evidence::Both,
    };
    let mut mixture = Mixture::new();
    for other in others.iter().filter(|other| angle(&other.rows, &best.rows) > SAME) {
        mixture.add(&best.rows, &other.rows, other.cost - best.cost);
    }
    let covariance = mixture.covariance(&covariance, integrable.iter().map(|all| all.windows.len()).sum());
    let (rows, convexity) = outward.convex(outward.facing(best.rows));
    let covariance = seen_in(&rows, &best.rows, &covariance);
    Joint { rows, covariance, evidence, convexity, second_best: second }
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
