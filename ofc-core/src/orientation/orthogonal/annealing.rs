//! The orthogonal transformation by simulated annealing of the integral (15) over O(3).
//!
//! Chains start at random members of O(3), half of them reflections. A proposal turns the frame by a random angle about a
//! random axis, and now and then reflects it; it is accepted if the integral falls, and otherwise with probability
//! (old / new)^(1 / T): what is annealed is the logarithm of the integral, so no scale of the picture enters. T and the
//! angle fall geometrically. Proposals are evaluated on a sample of cells in the workspace; the best frame of each chain is
//! polished there, and the two best that are no neighbors on the whole picture, which decides between them: on a sample two minima
//! may change places.
//!
//! # Reference
//! Section 2.3, eq. 15. \[14\]: L. L. Kontsevich, A. P. Petrov, I. S. Vergelskaya, "Reconstruction of shape from shading in
//! color images", J. Opt. Soc. Am. A 11, 1994. S. Kirkpatrick et al., "Optimization by simulated annealing", 1983. Random
//! rotations: K. Shoemake, "Uniform random rotations", Graphics Gems III, 1992.

use super::closed_form::POLISH_EVALUATIONS;
use super::polish::{polish, rotation};
use super::problem::Problem;
use super::result::{Found, OrthogonalError};
use super::sample::{CELL, Sample};
use crate::math::angle::sincos;
use crate::math::mat3::{self, Mat3};
use crate::math::rng::Rng;
use crate::picture::{Image, Window};
use core::f64::consts::TAU;
use libm::{exp, log, pow, sqrt};

/// Evaluations and cells are never more than this.
pub const MAX_EVALUATIONS: u32 = 10_000_000;

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Proposals in all, shared by the chains, 1 to [`MAX_EVALUATIONS`]. Default 4000.
    pub proposals: u32,
    /// Chains, at least 1 and no more than `proposals`. Default 8.
    pub chains: u32,
    /// The cells that proposals are evaluated on; all cells when there are fewer. At least 1. Default 2000.
    pub sample_cells: u32,
    /// T at the start of a chain and at its end, both positive. Default 1 and 0.01.
    pub temperatures: [f64; 2],
    /// The largest angle of a proposal at the start of a chain and at its end, in radians, both positive. Default 2 and
    /// 0.02.
    pub angles: [f64; 2],
    /// Times that the polish may compute (15) over the whole picture, and again that each chain may compute it over the
    /// sample. Default 60.
    pub polish_evaluations: u32,
    /// Fixes every random choice. Default 0.
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            proposals: 4000,
            chains: 8,
            sample_cells: 2000,
            temperatures: [1.0, 0.01],
            angles: [2.0, 0.02],
            polish_evaluations: POLISH_EVALUATIONS,
            seed: 0,
        }
    }
}

impl Params {
    /// Whether every parameter is in its range.
    #[must_use]
    pub fn are_valid(&self) -> bool {
        let positive = |values: [f64; 2]| values.iter().all(|&value| value > 0.0 && value.is_finite());
        (1..=MAX_EVALUATIONS).contains(&self.proposals)
            && (1..=self.proposals).contains(&self.chains)
            && self.sample_cells > 0
            && self.polish_evaluations <= MAX_EVALUATIONS
            && positive(self.temperatures)
            && positive(self.angles)
    }
}

/// How many `f32` [`annealing`] needs for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize, sample_cells: u32) -> usize {
    let cells = if pixels < sample_cells as usize { pixels } else { sample_cells as usize };
    cells.saturating_mul(CELL)
}

/// The transformation of the normals `root` rho of the pixels that `inliers` gives the bits of.
///
/// `tilts` of the rows of F, where known, choose between the twins.
///
/// # Units
/// `root` in (pixel value)^-1, tilts in radians, the integral in pixel^-2.
///
/// # Errors
/// See [`OrthogonalError`].
///
/// # Scratch
/// [`workspace_len`] `f32`; what they hold before does not matter. About 6 KiB of stack.
pub fn annealing(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    root: &Mat3,
    tilts: Option<[f64; 3]>,
    params: &Params,
    workspace: &mut [f32],
) -> Result<Found, OrthogonalError> {
    if !params.are_valid() {
        return Err(OrthogonalError::Params);
    }
    let problem = Problem::new(image, inliers, root, tilts)?;
    let pixels = image.width() * image.height();
    let workspace = workspace
        .get_mut(..workspace_len(pixels, params.sample_cells))
        .ok_or(OrthogonalError::WorkspaceTooShort)?;
    let limit = params.sample_cells as usize;
    let sample =
        Sample::gather(image, &problem.inliers, root, limit, workspace).ok_or(OrthogonalError::NoCells)?;
    let mut rng = Rng::new(params.seed);
    let mut best: [Option<State>; 2] = [None; 2];
    for chain in 0..params.chains {
        let share =
            |chain: u32| u64::from(params.proposals) * u64::from(chain) / u64::from(params.chains.max(1));
        let proposals = (share(chain + 1) - share(chain)) as u32;
        let start = random_frame(&mut rng, chain % 2 == 1);
        let cold = anneal(&sample, start, proposals, params, &mut rng);
        let (rows, _) =
            polish(cold.rows, cold.integral, params.polish_evaluations, |rows| sample.integral(rows));
        keep(&mut best, State::new(&sample, rows));
    }
    let [first, second] = best;
    let first = problem.finish(first.ok_or(OrthogonalError::Params)?.rows, params.polish_evaluations)?;
    let Some(second) = second else { return Ok(first) };
    let second = problem.finish(second.rows, params.polish_evaluations)?;
    let evaluations = first.evaluations + second.evaluations;
    let best = if second.integral.mean < first.integral.mean { second } else { first };
    Ok(Found { evaluations, ..best })
}

/// Keeps the best state, and the best of those that are not near it.
fn keep(best: &mut [Option<State>; 2], state: State) {
    let is_better = |than: Option<State>| than.is_none_or(|than| state.integral < than.integral);
    let [first, second] = best;
    match *first {
        Some(other) if !state.is_near(&other) => {
            if is_better(*first) {
                (*first, *second) = (Some(state), *first);
            } else if is_better(*second) {
                *second = Some(state);
            }
        }
        _ if is_better(*first) => *first = Some(state),
        _ => {}
    }
}

#[derive(Clone, Copy)]
struct State {
    rows: Mat3,
    integral: f64,
}

impl State {
    fn new(sample: &Sample, rows: Mat3) -> Self {
        Self { rows, integral: sample.integral(&rows) }
    }

    /// Whether each row is within eleven degrees of the other's, whose sense does not count.
    fn is_near(&self, other: &Self) -> bool {
        self.rows.iter().zip(other.rows).all(|(a, b)| mat3::dot(*a, b).abs() > 0.98)
    }
}

/// The best state of one chain.
fn anneal(sample: &Sample, start: Mat3, proposals: u32, params: &Params, rng: &mut Rng) -> State {
    let mut state = State::new(sample, start);
    let mut best = state;
    let [hot, cold] = params.temperatures;
    let [wide, narrow] = params.angles;
    for step in 0..proposals {
        let progress = f64::from(step) / f64::from(proposals);
        let temperature = hot * pow(cold / hot, progress);
        let angle = wide * pow(narrow / wide, progress);
        let mut rows = mat3::multiply(&state.rows, &rotation(random_turn(rng, angle)));
        // Reflections are worth a try while it is hot: r1 turns around, r2 and r3 stay.
        if rng.unit() < 0.25 * (1.0 - progress) {
            let [r1, r2, r3] = rows;
            rows = [mat3::scale(r1, -1.0), r2, r3];
        }
        let proposal = State::new(sample, rows);
        let draw = rng.unit();
        let rise = log(proposal.integral.max(f64::MIN_POSITIVE)) - log(state.integral.max(f64::MIN_POSITIVE));
        if rise <= 0.0 || draw < exp(-rise / temperature) {
            state = proposal;
            if state.integral < best.integral {
                best = state;
            }
        }
    }
    best
}

/// A turn about a random axis by up to `angle`.
fn random_turn(rng: &mut Rng, angle: f64) -> [f64; 3] {
    let height = 2.0 * rng.unit() - 1.0;
    let (s, c) = sincos(TAU * rng.unit());
    let across = sqrt((1.0 - height * height).max(0.0));
    mat3::scale([across * c, across * s, height], angle * rng.unit())
}

/// A rotation uniform among all, or a reflection.
fn random_frame(rng: &mut Rng, reflected: bool) -> Mat3 {
    let share = rng.unit();
    let (s1, c1) = sincos(TAU * rng.unit());
    let (s2, c2) = sincos(TAU * rng.unit());
    let (a, b) = (sqrt(1.0 - share), sqrt(share));
    let (x, y, z, w) = (a * s1, a * c1, b * s2, b * c2);
    let sign = if reflected { -1.0 } else { 1.0 };
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
    .map(|row| mat3::scale(row, sign))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_best_are_no_neighbors() {
        let state = |angle: f64, integral| {
            let (s, c) = sincos(angle);
            State { rows: [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]], integral }
        };
        let mut best = [None; 2];
        for (angle, integral) in [(1.0, 5.0), (0.0, 3.0), (0.1, 4.0), (1.0, 4.5), (3.2, 2.0), (2.0, 9.0)] {
            keep(&mut best, state(angle, integral));
        }
        let integrals = best.map(|state| state.map(|state| state.integral));
        assert_eq!(integrals, [Some(2.0), Some(4.5)]);
    }

    #[test]
    fn frames_are_rotations_and_reflections_in_all_directions() {
        let mut rng = Rng::new(12);
        let (mut mean, mut squares) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        for i in 0..4000 {
            let reflected = i % 2 == 1;
            let rows = random_frame(&mut rng, reflected);
            let product = mat3::multiply(&rows, &mat3::transpose(&rows));
            for (a, b) in product.as_flattened().iter().zip(mat3::IDENTITY.as_flattened()) {
                assert!((a - b).abs() < 1e-12);
            }
            let [r1, r2, r3] = rows;
            let determinant = mat3::dot(mat3::cross(r1, r2), r3);
            assert!((determinant - if reflected { -1.0 } else { 1.0 }).abs() < 1e-12);
            let entries = mean.as_flattened_mut().iter_mut().zip(squares.as_flattened_mut());
            for ((mean, square), entry) in entries.zip(rows.as_flattened()) {
                *mean += entry / 4000.0;
                *square += entry * entry / 4000.0;
            }
        }
        // Every entry has mean 0 and variance 1/3; 4000 draws know these to 0.009 and 0.005.
        assert!(mean.as_flattened().iter().all(|mean| mean.abs() < 0.04), "{mean:?}");
        assert!(
            squares.as_flattened().iter().all(|square| (square - 1.0 / 3.0).abs() < 0.025),
            "{squares:?}"
        );
    }

    #[test]
    fn turns_are_as_long_as_they_may_be_and_in_all_directions() {
        let mut rng = Rng::new(13);
        let (mut longest, mut mean) = (0.0_f64, [0.0; 3]);
        for _ in 0..4000 {
            let turn = random_turn(&mut rng, 0.4);
            longest = longest.max(sqrt(mat3::dot(turn, turn)));
            for (mean, entry) in mean.iter_mut().zip(turn) {
                *mean += entry / 4000.0;
            }
        }
        assert!((0.399..0.4).contains(&longest), "{longest}");
        assert!(mean.iter().all(|mean| mean.abs() < 0.01), "{mean:?}");
    }
}
