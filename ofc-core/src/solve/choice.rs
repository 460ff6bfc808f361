//! The slants that the tilts allow, and the choice among them.

use super::outcome::Outcome;
use crate::light::constrained_slant::{Candidates, MAX_CANDIDATES, SlantRoot};
use crate::orientation::matrix::Orientation;
use core::f64::consts::FRAC_PI_2;
use heapless::Vec;

/// Where the slants come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlantSource {
    /// A root of eqs. 25, chosen by integrability.
    Root,
    /// There is no root: least squares over eqs. 24.
    LeastSquares,
    /// There is no root: the least integral (15) that eqs. 24 allow.
    TiltIntegrability,
    /// There is no root: Pentland's slants, eq. 22.
    Pentland,
    /// There is no root: Lee and Rosenfeld's slants, eq. 23.
    LeeRosenfeld,
    /// There is no root: Zheng and Chellappa's slants.
    ZhengChellappa,
    /// F was oriented as a whole ([`OrientationMethod::Joint`](super::OrientationMethod::Joint)): its slants follow from it.
    Joint,
}

/// Slants that are consistent with the tilts, and how integrable their normals are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Slants of f1, f2, f3 in radians.
    pub slants: [f64; 3],
    /// Which of the eight branches of eqs. 25 they lie on, 1 to 8; 0 for least squares.
    pub branch: u8,
    /// The largest residual of eqs. 24.
    pub residual: f64,
    /// The integral (15) as a mean over cells; infinite when F is rank-deficient or there are no cells.
    pub integral: f64,
}

/// The candidates and the choice among them.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The slants of F, from +z: in [0, pi/2] with the direct method, in [0, pi] with the joint one, see
    /// [`Self::lights_from_behind`].
    pub slants: [f64; 3],
    /// Where they come from.
    pub source: SlantSource,
    /// All candidates, by ascending first slant.
    pub candidates: Vec<Candidate, MAX_CANDIDATES>,
    /// Which of them was chosen.
    pub chosen: usize,
    /// F.
    pub orientation: Orientation,
}

impl Choice {
    /// Which rows of F have a slant above 90 degrees: the light that such a channel is equivalent to shines from behind the
    /// surface, and reaches only parts of it that are turned away from the camera by more than that. The paper has no such
    /// lights; with the joint method, which does not ask for slants, one is rare in a picture and common in a wrong answer.
    #[must_use]
    pub fn lights_from_behind(&self) -> [bool; 3] {
        self.slants.map(|slant| slant > FRAC_PI_2)
    }

    /// Whether this F solves the picture.
    pub(crate) const fn outcome(&self) -> Outcome {
        if self.orientation.rank == 3 { Outcome::Solved } else { Outcome::RankDeficient }
    }

    /// No choice yet.
    pub(crate) const fn none() -> Self {
        Self {
            slants: [0.0; 3],
            source: SlantSource::Root,
            candidates: Vec::new(),
            chosen: 0,
            orientation: Orientation::NONE,
        }
    }

    /// Takes these roots of eqs. 25 for candidates, their integrals not known yet.
    pub(crate) fn set_candidates(&mut self, roots: &Candidates) {
        self.candidates.clear();
        for &SlantRoot { slants, branch, residual } in roots {
            // There are no more roots than candidates have room.
            let _ = self.candidates.push(Candidate { slants, branch, residual, integral: f64::INFINITY });
        }
    }

    /// Which candidate has the least integral, and its slants.
    pub(crate) fn most_integrable(&self) -> Option<(usize, [f64; 3])> {
        let candidates = self.candidates.iter().enumerate();
        let least = candidates.min_by(|(_, a), (_, b)| a.integral.total_cmp(&b.integral));
        least.map(|(chosen, candidate)| (chosen, candidate.slants))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_from_behind_are_those_above_90_degrees() {
        let mut choice = Choice::none();
        choice.slants = [FRAC_PI_2, FRAC_PI_2 + 1e-9, 0.1];
        assert_eq!(choice.lights_from_behind(), [false, true, false]);
    }
}
