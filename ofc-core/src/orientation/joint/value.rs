//! A negative log likelihood with its derivatives by small rotations, rows -> (1 + [w]) rows.

use super::constants::STEP;
use crate::math::mat3::{self, Mat3};
use crate::orientation::orthogonal::polish::rotation;

/// A negative log likelihood, and its derivatives by w.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Value {
    pub cost: f64,
    pub gradient: [f64; 3],
    /// Second derivatives, or what is expected of them: without negative eigenvalues.
    pub information: Mat3,
}

impl Value {
    /// From differences.
    #[inline(never)]
    pub fn of(rows: &Mat3, cost: impl Fn(&Mat3) -> f64) -> Self {
        let at = |turn: [f64; 3]| cost(&mat3::multiply(&rotation(turn), rows));
        let here = cost(rows);
        let axes = [[STEP, 0.0, 0.0], [0.0, STEP, 0.0], [0.0, 0.0, STEP]];
        let plus = axes.map(at);
        let minus = axes.map(|axis| at(mat3::scale(axis, -1.0)));
        let [p1, p2, p3] = plus;
        let [m1, m2, m3] = minus;
        let p12 = at([STEP, STEP, 0.0]) - p1 - p2 + here;
        let p13 = at([STEP, 0.0, STEP]) - p1 - p3 + here;
        let p23 = at([0.0, STEP, STEP]) - p2 - p3 + here;
        let own = |p: f64, m: f64| p + m - 2.0 * here;
        let second = [[own(p1, m1), p12, p13], [p12, own(p2, m2), p23], [p13, p23, own(p3, m3)]];
        let gradient = [p1 - m1, p2 - m2, p3 - m3].map(|difference| difference / (2.0 * STEP));
        let second = second.map(|row| row.map(|entry| entry / (STEP * STEP)));
        Self { cost: here, gradient, information: without_negative(&second) }
    }

    /// Adds so many times another.
    pub fn add(&mut self, other: &Self, times: f64) {
        self.cost += times * other.cost;
        for (sum, term) in self.gradient.iter_mut().zip(other.gradient) {
            *sum += times * term;
        }
        let entries = self.information.as_flattened_mut().iter_mut();
        for (sum, term) in entries.zip(other.information.as_flattened()) {
            *sum += times * term;
        }
    }
}

/// A symmetric matrix with zero for its negative eigenvalues.
fn without_negative(a: &Mat3) -> Mat3 {
    let eigen = mat3::symmetric_eigen(a);
    let mut out = [[0.0; 3]; 3];
    for (value, vector) in eigen.values.into_iter().zip(eigen.vectors) {
        for (row, x) in out.iter_mut().zip(vector) {
            for (entry, y) in row.iter_mut().zip(vector) {
                *entry += value.max(0.0) * x * y;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_known_cost() {
        // 1 - cos of the turn about z, and what falls both ways about x.
        let at = rotation([0.0, 0.0, 0.3]);
        let cost = |rows: &Mat3| -(rows[0][0] + rows[1][1]) - 5.0 * rows[1][2] * rows[1][2];
        let value = Value::of(&at, cost);
        assert!((value.cost + 2.0 * libm::cos(0.3)).abs() < 1e-12);
        let [_, _, z] = value.gradient;
        assert!((z - 2.0 * libm::sin(0.3)).abs() < 1e-4, "{z}");
        let eigen = mat3::symmetric_eigen(&value.information);
        assert!(eigen.values.iter().all(|&value| value > -1e-9), "{eigen:?}");
        let mut sum = value;
        sum.add(&value, 2.0);
        assert!((sum.cost - 3.0 * value.cost).abs() < 1e-12);
        assert!((sum.information[2][2] - 3.0 * value.information[2][2]).abs() < 1e-9);
    }
}
