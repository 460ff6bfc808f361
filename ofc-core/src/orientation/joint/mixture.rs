//! How sure an answer is among other minima of its cost.

use super::constants::WINDOW_TURN;
use super::search::angle;
use crate::math::mat3::{self, Mat3};
use libm::{exp, sqrt};

/// The minima of a cost, as a mixture of normal distributions of one covariance: mean squares about the best one.
pub(super) struct Mixture {
    weight: f64,
    squares: Mat3,
}

impl Mixture {
    /// The best minimum alone.
    pub const fn new() -> Self {
        Self { weight: 1.0, squares: [[0.0; 3]; 3] }
    }

    /// Another minimum, whose negative log likelihood is higher by so much.
    pub fn add(&mut self, best: &Mat3, other: &Mat3, higher: f64) {
        let weight = exp(-higher.max(0.0));
        let turn = turn(best, other);
        self.weight += weight;
        for (row, x) in self.squares.iter_mut().zip(turn) {
            for (entry, y) in row.iter_mut().zip(turn) {
                *entry += weight * x * y;
            }
        }
    }

    /// The mean square turn from the best minimum, whose own covariance is given, and what so many windows
    /// may be wrong by together.
    pub fn covariance(&self, own: &Mat3, windows: usize) -> Mat3 {
        let few = WINDOW_TURN / windows.max(1) as f64;
        let mut all = *own;
        for (entry, square) in all.as_flattened_mut().iter_mut().zip(self.squares.as_flattened()) {
            *entry += square / self.weight;
        }
        for (i, row) in all.iter_mut().enumerate() {
            if let Some(entry) = row.get_mut(i) {
                *entry += few * few;
            }
        }
        all
    }
}

/// The rotation vector from a frame to another one, or to its twin if that is nearer. Where the axis of half a turn is lost in
/// rounding it is nearly none.
fn turn(from: &Mat3, to: &Mat3) -> [f64; 3] {
    let ([x, y, _], [a, b, c]) = (*from, *to);
    let sign = if mat3::dot(x, a) + mat3::dot(y, b) < 0.0 { -1.0 } else { 1.0 };
    let to = [mat3::scale(a, sign), mat3::scale(b, sign), c];
    let [[_, xy, xz], [yx, _, yz], [zx, zy, _]] = mat3::multiply(&to, &mat3::transpose(from));
    let axis = [zy - yz, xz - zx, yx - xy];
    let length = sqrt(mat3::dot(axis, axis));
    mat3::scale(axis, angle(from, &to) / length.max(1e-9))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orientation::orthogonal::polish::rotation;

    #[test]
    fn turns_are_found_again_and_twins_are_one() {
        let from = rotation([0.3, -0.8, 1.1]);
        let wanted = [0.2, 0.5, -0.4];
        let [a, b, c] = mat3::multiply(&rotation(wanted), &from);
        for to in [[a, b, c], [mat3::scale(a, -1.0), mat3::scale(b, -1.0), c]] {
            let found = turn(&from, &to);
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        }
    }

    #[test]
    fn a_tie_widens_along_the_turn_and_what_is_unlikely_does_not() {
        let own = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
        let least = 0.1 + WINDOW_TURN * WINDOW_TURN / 100.0;
        let other = rotation([0.0, 0.6, 0.0]);
        for (higher, wanted) in [(0.0, 0.18), (50.0, 0.0)] {
            let mut mixture = Mixture::new();
            mixture.add(&mat3::IDENTITY, &other, higher);
            let [[x, ..], [_, y, _], [.., z]] = mixture.covariance(&own, 10);
            assert!((x - least).abs() < 1e-12 && (z - least).abs() < 1e-12);
            assert!((y - least - wanted).abs() < 1e-12, "{y}");
        }
    }
}
