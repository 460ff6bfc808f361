//! The slants that satisfy eqs. 24 best when nothing satisfies them exactly.

use super::Constraints;
use super::descent::descend;
use super::roots::roots;
use crate::math::angle::sincos;
use crate::math::mat3;
use core::f64::consts::FRAC_PI_2;
use libm::sqrt;

/// Slants that minimize the sum of the squared residuals of eqs. 24.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestSlants {
    /// The slants of the three channels, in [0, pi/2], radians.
    pub slants: [f64; 3],
    /// What is left of eqs. 24: the cosine that these slants give minus the one asked for, pairs 12, 13, 23.
    pub residuals: [f64; 3],
    /// Root mean square of the three residuals; infinite when the input has no answer.
    pub residual_rms: f64,
}

impl NearestSlants {
    const NONE: Self = Self { slants: [0.0; 3], residuals: [f64::INFINITY; 3], residual_rms: f64::INFINITY };

    fn at(constraints: &Constraints, slants: [f64; 3]) -> Self {
        let (residuals, _) = constraints.evaluate(slants);
        let residual_rms = sqrt(mat3::dot(residuals, residuals) / 3.0);
        Self { slants, residuals, residual_rms }
    }
}

/// Points of the grid along each slant: 7 degrees apart, in the middles of their cells. None is at the ends of the
/// range, where all derivatives vanish and a descent would not start.
const GRID: usize = 13;
/// Descents, from the best local minima of the grid.
const MAX_STARTS: usize = 8;

/// The slants in [0, pi/2] that satisfy eqs. 24 best in the least-squares sense, over the whole range of slants.
///
/// Where eqs. 24 have solutions it is the first of [`roots()`]. Otherwise the best of the minima that descents
/// (damped Newton, slants kept in range) reach from the local minima of a grid.
///
/// # Units
/// Radians; `cosines` are (h12, h13, h23), the angles' between the rows of F.
///
/// # Errors
/// For input that is not finite or has a cosine beyond 2: slants zero, residuals infinite.
///
/// # Scratch
/// About 7 kB of stack.
///
/// # Reference
/// Section 3.3: if there are no solutions, "fall back".
#[must_use]
pub fn least_squares(tilts: [f64; 3], cosines: [f64; 3]) -> NearestSlants {
    if let Some(constraints) = Constraints::new(tilts, cosines)
        && let Some(root) = roots(tilts, cosines).first()
    {
        return NearestSlants::at(&constraints, root.slants);
    }
    without_roots(tilts, cosines)
}

/// [`least_squares()`] of equations that have no root, with less than 3 kB of stack.
#[must_use]
pub fn without_roots(tilts: [f64; 3], cosines: [f64; 3]) -> NearestSlants {
    let mut best = NearestSlants::NONE;
    let Some(constraints) = Constraints::new(tilts, cosines) else { return best };
    for start in starts(&constraints) {
        let nearest = NearestSlants::at(&constraints, descend(&constraints, start.slants));
        if nearest.residual_rms < best.residual_rms {
            best = nearest;
        }
    }
    best
}

#[derive(Clone, Copy)]
struct Start {
    cost: f64,
    slants: [f64; 3],
}

/// The squared residual of one pair of channels at one slant, beside the grid infinite, and all slants of the other.
type Costs = [f64; GRID];
/// The same at a slant of the grid and those before and behind it.
type Around = [Costs; 3];

/// The best local minima of the grid, best first.
#[inline(never)]
fn starts(constraints: &Constraints) -> heapless::Vec<Start, MAX_STARTS> {
    let mut sines = [(0.0, 0.0); GRID];
    for (i, sine) in sines.iter_mut().enumerate() {
        *sine = sincos(grid_slant(i));
    }
    let ([k12, k13, k23], [h12, h13, h23]) = (constraints.k, constraints.h);
    let cost = |k: f64, h: f64, i: usize, j: usize| {
        let (Some(&i), Some(&j)) = (sines.get(i), sines.get(j)) else { return f64::INFINITY };
        let (cosine, _) = super::pair(k, i, j);
        (cosine - h) * (cosine - h)
    };
    // Beyond the grid the cost is infinite: one below zero wraps around to a very large index.
    let around = |k: f64, h: f64, i: usize| -> Around {
        [i.wrapping_sub(1), i, i + 1].map(|i| core::array::from_fn(|j| cost(k, h, i, j)))
    };
    let mut starts = heapless::Vec::new();
    for i in 0..GRID {
        let c13 = around(k13, h13, i);
        for j in 0..GRID {
            let c23 = around(k23, h23, j);
            let c12 = |i, j| cost(k12, h12, i, j);
            let (im, jm) = (i.wrapping_sub(1), j.wrapping_sub(1));
            let (here, north, south) = (c12(i, j), c12(im, j), c12(i + 1, j));
            let (west, east) = (c12(i, jm), c12(i, j + 1));
            let sum = |c12: f64, c13: &Costs, c23: &Costs, k: usize| {
                let at = |costs: &Costs| costs.get(k).copied().unwrap_or(f64::INFINITY);
                c12 + at(c13) + at(c23)
            };
            let ([c13_before, c13, c13_behind], [c23_before, c23, c23_behind]) = (&c13, &c23);
            for k in 0..GRID {
                let cost = sum(here, c13, c23, k);
                let neighbors = [
                    sum(north, c13_before, c23, k),
                    sum(south, c13_behind, c23, k),
                    sum(west, c13, c23_before, k),
                    sum(east, c13, c23_behind, k),
                    sum(here, c13, c23, k.wrapping_sub(1)),
                    sum(here, c13, c23, k + 1),
                ];
                if neighbors.iter().all(|&neighbor| cost <= neighbor) {
                    keep(&mut starts, Start { cost, slants: [i, j, k].map(grid_slant) });
                }
            }
        }
    }
    starts
}

fn grid_slant(index: usize) -> f64 {
    (index as f64 + 0.5) * (FRAC_PI_2 / GRID as f64)
}

/// Keeps the list sorted; what does not fit at its end is dropped.
fn keep(starts: &mut heapless::Vec<Start, MAX_STARTS>, start: Start) {
    let mut carried = start;
    for slot in starts.iter_mut() {
        if carried.cost < slot.cost {
            core::mem::swap(slot, &mut carried);
        }
    }
    // No room: it was the worst.
    let _ = starts.push(carried);
}

#[cfg(test)]
mod tests {
    use super::super::tests::random_case;
    use super::*;
    use crate::math::rng::Rng;

    /// The smallest cost on a fine grid: an upper bound of the minimum, and not far above it.
    fn brute_force(constraints: &Constraints, points: usize) -> f64 {
        let angle = |i: usize| i as f64 * FRAC_PI_2 / (points - 1) as f64;
        let mut best = f64::INFINITY;
        for i in 0..points {
            for j in 0..points {
                for k in 0..points {
                    let (f, _) = constraints.evaluate([angle(i), angle(j), angle(k)]);
                    best = best.min(mat3::dot(f, f));
                }
            }
        }
        sqrt(best / 3.0)
    }

    #[test]
    fn exact_where_there_is_a_root() {
        let mut rng = Rng::new(21);
        for _ in 0..200 {
            let (_, tilts, cosines) = random_case(&mut rng);
            let nearest = least_squares(tilts, cosines);
            assert!(nearest.residual_rms < 4e-12);
            assert_eq!(nearest.slants, roots(tilts, cosines)[0].slants);
        }
    }

    #[test]
    fn no_grid_point_is_better_where_there_is_none() {
        let mut rng = Rng::new(22);
        let mut without = 0;
        while without < 60 {
            let (_, tilts, cosines) = random_case(&mut rng);
            let cosines = cosines.map(|h| (h + 0.8 * (rng.unit() - 0.5)).clamp(-1.0, 1.0));
            if !roots(tilts, cosines).is_empty() {
                continue;
            }
            without += 1;
            let constraints = Constraints::new(tilts, cosines).unwrap();
            let nearest = least_squares(tilts, cosines);
            assert!(nearest.slants.iter().all(|slant| (0.0..=FRAC_PI_2).contains(slant)));
            let grid = brute_force(&constraints, 61);
            assert!(nearest.residual_rms <= grid + 1e-9, "{} {grid}", nearest.residual_rms);
            // Slants that say how far the grid can be off: half a cell of 1.5 degrees in each.
            assert!(nearest.residual_rms > grid - 0.03, "{} {grid}", nearest.residual_rms);
        }
    }

    #[test]
    fn the_gradient_vanishes_or_points_outside() {
        let mut rng = Rng::new(23);
        for _ in 0..500 {
            let (_, tilts, cosines) = random_case(&mut rng);
            let cosines = cosines.map(|h| (h + 0.4 * (rng.unit() - 0.5)).clamp(-1.0, 1.0));
            let nearest = least_squares(tilts, cosines);
            let (f, jacobian) = Constraints::new(tilts, cosines).unwrap().evaluate(nearest.slants);
            let gradient = mat3::apply(&mat3::transpose(&jacobian), f);
            for (slope, slant) in gradient.into_iter().zip(nearest.slants) {
                let at_limit = (slant == 0.0 && slope > 0.0) || (slant == FRAC_PI_2 && slope < 0.0);
                assert!(at_limit || slope.abs() < 1e-6, "{slope} at {slant}");
            }
        }
    }

    #[test]
    fn no_answer_for_no_input() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            assert_eq!(least_squares([0.0, 1.0, 2.0], [bad, 0.5, 0.5]), NearestSlants::NONE);
        }
        assert_eq!(least_squares([f64::NAN, 1.0, 2.0], [0.5; 3]), NearestSlants::NONE);
        assert!(least_squares([0.0, 1.0, 2.0], [1.5, -1.5, 1.5]).residual_rms.is_finite());
    }
}
