//! A round surface: how well the normals are those of a sphere about the middle of all of the surface.
//!
//! For a sphere about (x0, y0) the tilt of every normal is the direction of its place from there: (n1, n2) = kappa (x - x0, y - y0).
//! Of the variance of (n1, n2) over the inliers a sphere leaves the share 1 - c^2, where c is their correlation with
//! (x - x0, y - y0). The middle is that of the *whole* surface, shaded parts among them, and is not fitted: where one side is shaded
//! and left out, regression takes a round object for one that leans, and this does not.
//!
//! What is left is not noise but shape, and nobody knows how large it may be: with its variance unknown the negative log likelihood
//! of m independent places is m/2 log(1 - c^2). Most surfaces are no part of a sphere about the middle of what is seen of them, and
//! then their places say nothing of this kind. Both are possible, so the likelihood is the sum of both: it decides where the surface is
//! round, and is flat where it is not.

use super::cells::Cells;
use super::constants::{LEAST_UNEXPLAINED, ROUND, ROUND_PLACES};
use crate::math::mat3::{self, Mat3};
use libm::{exp, log, log1p, sqrt};

/// Sums over the inliers, of unit normals N in their own frame and of places from the middle of the whole surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Round {
    count: f64,
    /// Of the square of the distance.
    squares: f64,
    /// Of x N and of y N.
    along: [[f64; 3]; 2],
    /// Of N N^T.
    normals: Mat3,
}

impl Round {
    /// Over cells, each with the mean of its inliers, where the mean position of the whole surface is `whole`.
    pub fn of(cells: &Cells, whole: [f64; 2]) -> Self {
        let mut round = Self::default();
        let ([width, height], [x0, y0]) = (cells.size(), whole);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let cell = cells.at(x, y);
            let ([count, dx, dy, ..], [right, up]) = (cell.position, cells.middle(x, y));
            if count > 0.0 {
                round.add(count, [right + dx / count - x0, up + dy / count - y0], cell.normal);
            }
        }
        round
    }

    /// Adds so many inliers at a place, whose normals have this direction.
    fn add(&mut self, count: f64, [x, y]: [f64; 2], normal: [f64; 3]) {
        let length = sqrt(mat3::dot(normal, normal));
        if length.is_nan() || length <= 0.0 {
            return;
        }
        let weighted = mat3::scale(normal, count / length);
        self.count += count;
        self.squares += count * (x * x + y * y);
        for (sums, at) in self.along.iter_mut().zip([x, y]) {
            sums.iter_mut().zip(weighted).for_each(|(sum, n)| *sum += at * n);
        }
        for (row, n) in self.normals.iter_mut().zip(normal) {
            row.iter_mut().zip(weighted).for_each(|(sum, m)| *sum += n / length * m);
        }
    }

    /// The correlation of (n1, n2) with the place: 1 for a dome that is a part of a sphere, -1 for a hollow one.
    fn correlation(&self, [r1, r2, r3]: &Mat3) -> f64 {
        let [x, y] = self.along;
        let outward = mat3::dot(*r1, x) + mat3::dot(*r2, y);
        // n1^2 + n2^2 is 1 - n3^2.
        let tilted = (self.count - mat3::dot(*r3, mat3::apply(&self.normals, *r3))).max(0.0);
        let all = sqrt(self.squares * tilted);
        if all > 0.0 { (outward / all).clamp(-1.0, 1.0) } else { 0.0 }
    }

    /// The negative log likelihood of `rows`, over that of a surface that is not round.
    pub fn cost(&self, rows: &Mat3) -> f64 {
        let c = self.correlation(rows);
        let unexplained = 1.0 - c * c.abs() + LEAST_UNEXPLAINED;
        -log1p(exp(0.5 * ROUND_PLACES * log(ROUND / unexplained)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orientation::orthogonal::polish::rotation;

    /// A part of a sphere of radius 50 about (7, -3) in another frame, to the right of `from`; normals are of any length.
    fn sphere(rows: &Mat3, from: f64, squash: f64) -> Round {
        let mut round = Round::default();
        let back = mat3::transpose(rows);
        for (x, y) in (-40..=40).flat_map(|y| (-40..=40).map(move |x| (f64::from(x), f64::from(y)))) {
            let square = x * x + y * y;
            if square < 1600.0 && x >= from {
                let n = mat3::apply(&back, [x, squash * y, sqrt(2500.0 - square)]);
                round.add(2.0, [x, y], mat3::scale(n, 0.3));
            }
        }
        round
    }

    #[test]
    fn a_sphere_is_round_in_its_own_frame_alone() {
        let rows = rotation([0.4, -0.3, 0.9]);
        let [r1, r2, r3] = rows;
        let hollow = [mat3::scale(r1, -1.0), mat3::scale(r2, -1.0), r3];
        // Also where half of it is shaded and left out.
        for from in [-40.0, 0.0, 15.0] {
            let round = sphere(&rows, from, 1.0);
            assert!((round.correlation(&rows) - 1.0).abs() < 1e-12);
            assert!((round.correlation(&hollow) + 1.0).abs() < 1e-12);
            let own = round.cost(&rows);
            let all = 0.5 * ROUND_PLACES * log(ROUND / LEAST_UNEXPLAINED);
            assert!((own + log1p(exp(all))).abs() < 1e-6, "{own}");
            for turn in
                [[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, 0.1]]
            {
                let off = round.cost(&mat3::multiply(&rotation(turn), &rows));
                assert!(off > own + 0.2, "{from} {turn:?}: {off} {own}");
            }
            assert!(round.cost(&hollow) > own + 5.0);
        }
    }

    #[test]
    fn what_is_not_round_says_nothing() {
        let most = |squash: f64| {
            let round = sphere(&mat3::IDENTITY, -40.0, squash);
            let turns = (-20..=20).map(|i| rotation([0.0, 0.05 * f64::from(i), 0.0]));
            turns.map(|rows| round.cost(&rows)).fold(0.0, f64::min)
        };
        assert!(most(1.0) < -5.0, "{}", most(1.0));
        // A half cylinder and a saddle.
        assert!(most(0.0) > -0.3 && most(-1.0) > -0.1, "{} {}", most(0.0), most(-1.0));
        // Neither does nothing at all.
        assert_eq!(Round::default().correlation(&mat3::IDENTITY), 0.0);
    }
}
