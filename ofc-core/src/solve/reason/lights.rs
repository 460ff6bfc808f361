//! Whether the lights span space, and which of them is to be moved.

use super::finding::{Finding, Reason};
use super::survey::Survey;
use crate::color::ellipsoid;
use crate::math::mat3::{self, Mat3};
use crate::solve::outcome::Outcome;
use crate::solve::solution::Solution;

/// The smallest singular value of F over the one before it below which the lights lie nearly in a plane.
const SMALL: f64 = 0.12;
/// By how much the noise of a pixel may turn its normal, in radians.
const LARGEST_TURN: f64 = 0.03;
/// The third deviation of the colors over the second below which they hardly span space.
const HARDLY: f64 = 0.15;

/// That the lights of an answer lie nearly in a plane, and noise turns its normals for it.
pub(super) fn nearly_coplanar(solution: &Solution) -> Option<Finding> {
    let (choice, fit) = (solution.choice.as_ref()?, solution.fit.as_ref()?);
    let [_, second, third] = choice.orientation.singular_values;
    let found = Finding::above(Reason::LightsCoplanar, fit.pixel_noise / third, LARGEST_TURN)?;
    (third < SMALL * second).then_some(found.about(Some(to_move(&choice.orientation.f))))
}

/// That the colors of a refused picture hardly span space.
pub(super) fn hardly_span(solution: &Solution, survey: &Survey) -> Option<Finding> {
    if solution.outcome == Outcome::Solved {
        return None;
    }
    let [_, second, third] = survey.deviations;
    let found = Finding::below(Reason::LightsCoplanar, third / second.max(f64::MIN_POSITIVE), HARDLY)?;
    let ellipsoid = solution.fit.as_ref().and_then(|fit| ellipsoid::decompose(&fit.z()).ok());
    // Rows that make the same angles as those of F.
    Some(found.about(ellipsoid.map(|ellipsoid| to_move(&ellipsoid.root_inverse()))))
}

/// The same of an answer, whose lights are not in a plane altogether.
pub(super) fn of_answer(found: Finding, solution: &Solution) -> Finding {
    if found.reason != Reason::TooFewLights {
        return found;
    }
    let channel = solution.choice.as_ref().map(|choice| to_move(&choice.orientation.f));
    Finding { reason: Reason::LightsCoplanar, channel, ..found }
}

/// The channel whose light is to be moved out of the plane of the other two: these are the ones that lie farthest from one line.
fn to_move(f: &Mat3) -> usize {
    let [a, b, c] =
        f.map(|row| mat3::scale(row, 1.0 / libm::sqrt(mat3::dot(row, row)).max(f64::MIN_POSITIVE)));
    let sine = |u, v| {
        let cross = mat3::cross(u, v);
        mat3::dot(cross, cross)
    };
    let [without_first, without_second, without_third] = [sine(b, c), sine(a, c), sine(a, b)];
    if without_first >= without_second && without_first >= without_third {
        0
    } else if without_second >= without_third {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_between_the_others_is_to_be_moved() {
        let (left, middle, right) = ([-0.7, 0.0, 0.7], [0.1, 0.02, 0.9], [0.6, 0.0, 0.8]);
        assert_eq!(to_move(&[middle, left, right]), 0);
        assert_eq!(to_move(&[left, middle, right]), 1);
        assert_eq!(to_move(&[left, right, middle]), 2);
    }
}
