//! Normals point outward: how N changes with position, as a whole, is to be along x and y.
//!
//! For a sphere the slopes of n over x and y are (1, 0, 0) and (0, 1, 0) over its radius. For other closed surfaces they
//! are so on the whole, as far as the surface is round; how far that is, the parts of the picture tell by how much each of
//! them matters. Slopes are taken twice: by regression over all inliers, and as the mean of the gradients of small cells,
//! which the border alone decides and which Pentland's tilts are made of. They are mixed so that the parts agree best.
//!
//! Where a part of the surface is shaded the rest does not face the camera as a whole: n3 then falls with the distance from
//! the middle of all of the surface, by its curvature.

use super::cells::Cells;
use super::constants::{PARTS, SLOPE_NEIGHBORS, SLOPE_WEIGHTS, SMALLEST_N3, SMALLEST_SLOPE_VARIANCE};
use super::moments::Moments;
use super::round::Round;
use crate::math::mat3::{self, Mat3};
use libm::sqrt;

/// Slopes of N over x and y, and the variance of their components.
#[derive(Clone, Copy, Debug)]
struct Slopes {
    along: [[f64; 3]; 2],
    variance: f64,
}

/// Slopes of both kinds.
type Pair = [[[f64; 3]; 2]; 2];

/// The length of slopes: kappa times the square root of two where they are those of a sphere.
fn size(slopes: [[f64; 3]; 2]) -> f64 {
    sqrt(slopes.as_flattened().iter().map(|value| value * value).sum())
}

fn normalized(slopes: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let length = size(slopes);
    slopes.map(|slope| mat3::scale(slope, if length > 0.0 { 1.0 / length } else { 0.0 }))
}

impl Slopes {
    /// Of `whole`, what all parts say together, the first kind with this weight and the second with the rest, and the
    /// variance of a jackknife over what they say without one of them. Slopes are of unit length and become as long as `size`.
    fn jackknife(whole: Pair, replicates: &[Option<Pair>], weight: f64, size: f64) -> Option<Self> {
        let used = replicates.iter().flatten().count();
        if used < 2 {
            return None;
        }
        let component = |[first, second]: &Pair, i: usize| {
            let at = |slopes: &[[f64; 3]; 2]| slopes.as_flattened().get(i).copied().unwrap_or(0.0);
            size * (weight * at(first) + (1.0 - weight) * at(second))
        };
        let (mut sum, mut along) = (0.0, [[0.0; 3]; 2]);
        for (i, slot) in along.as_flattened_mut().iter_mut().enumerate() {
            let values = || replicates.iter().flatten().map(|pair| component(pair, i));
            let mean = values().sum::<f64>() / used as f64;
            sum += values().map(|value| (value - mean) * (value - mean)).sum::<f64>();
            *slot = component(&whole, i);
        }
        let variance = SLOPE_NEIGHBORS * sum * (used - 1) as f64 / used as f64 / 6.0;
        Some(Self { along, variance: variance.max(SMALLEST_SLOPE_VARIANCE * size * size) })
    }

    /// The negative log likelihood that slopes in the frame of `rows` are kappa (1, 0, -kappa `x0`) and
    /// kappa (0, 1, -kappa `y0`), kappa > 0: those of a sphere at that place from its middle.
    fn cost(&self, rows: &Mat3, [x0, y0]: [f64; 2]) -> f64 {
        let [x, y] = self.along.map(|slope| mat3::apply(rows, slope));
        let ([a, b, c], [d, e, f]) = (x, y);
        let kappa = (0.5 * (a + e)).max(0.0);
        let rest = [a - kappa, b, c + kappa * kappa * x0, d, e - kappa, f + kappa * kappa * y0];
        if self.variance > 0.0 { 0.5 * rest.iter().map(|v| v * v).sum::<f64>() / self.variance } else { 0.0 }
    }
}

/// All that positions say.
#[derive(Clone, Debug)]
pub(super) struct Outward {
    slopes: Slopes,
    round: Round,
    /// The sum of N.
    normal: [f64; 3],
    /// The mean position of the inliers from the middle of the whole surface, of which parts may be shaded.
    from_middle: [f64; 2],
    parts: [Part; PARTS * PARTS],
}

/// A part of the surface.
#[derive(Clone, Copy, Debug)]
struct Part {
    count: f32,
    /// Its mean position from that of all inliers.
    position: [f32; 2],
    /// The mean of N.
    normal: [f32; 3],
}

impl Outward {
    /// From cells and what lies behind them, where the mean position of the whole surface is `whole`; `None` where there
    /// are too few.
    pub fn of(cells: &Cells, rest: &[f32], whole: [f64; 2]) -> Option<Self> {
        let parts = cells.parts()?;
        let [x0, y0] = parts.middle();
        let mut moments = [Moments::default(); PARTS * PARTS];
        let mut gradients = [[[0.0; 3]; 2]; PARTS * PARTS];
        let [width, height] = cells.size();
        for y in 0..height {
            for x in 0..width {
                let cell = cells.at(x, y);
                let at = cells.middle(x, y);
                let part = parts.of(at);
                let [right, up] = at;
                if let Some(sums) = moments.get_mut(part) {
                    sums.add(&cell, right - x0, up - y0);
                }
                if let Some(sums) = gradients.get_mut(part) {
                    let gradient = cells.gradient(x, y, rest);
                    for (sum, value) in sums.as_flattened_mut().iter_mut().zip(gradient.as_flattened()) {
                        *sum += value;
                    }
                }
            }
        }
        let total = all_but(&moments, PARTS * PARTS);
        let pair = |left_out: usize| {
            let regression = all_but(&moments, left_out).plane()?.gradient;
            Some([normalized(regression), normalized(sum_but(&gradients, left_out))])
        };
        let mut left_out = [None; PARTS * PARTS];
        for (i, (slot, part)) in left_out.iter_mut().zip(&moments).enumerate() {
            if part.count() > 0.0 {
                *slot = pair(i);
            }
        }
        let both = pair(PARTS * PARTS)?;
        let size = size(total.plane()?.gradient);
        let mut slopes: Option<Slopes> = None;
        for i in 0..SLOPE_WEIGHTS {
            let weight = i as f64 / (SLOPE_WEIGHTS - 1) as f64;
            let mixed = Slopes::jackknife(both, &left_out, weight, size)?;
            if slopes.is_none_or(|least| mixed.variance < least.variance) {
                slopes = Some(mixed);
            }
        }
        let slopes = slopes?;
        let [n, x, y, ..] = total.position;
        let ([x, y], [wx, wy]) = ([x / n, y / n], whole);
        let parts = moments.map(|part| {
            let [n, right, up, ..] = part.position;
            Part {
                count: n as f32,
                position: [right / n - x, up / n - y].map(|mean| mean as f32),
                normal: part.normal.map(|sum| (sum / n) as f32),
            }
        });
        let round = Round::of(cells, whole);
        Some(Self { slopes, round, normal: total.normal, from_middle: [x0 + x - wx, y0 + y - wy], parts })
    }

    /// The negative log likelihood of `rows`.
    pub fn cost(&self, rows: &Mat3) -> f64 {
        let rows = &self.facing(*rows);
        self.slopes.cost(rows, self.from_middle) + self.round.cost(rows)
    }

    /// `rows` with the sign of r3 that lets the surface face the camera.
    pub fn facing(&self, [r1, r2, r3]: Mat3) -> Mat3 {
        [r1, r2, if mat3::dot(r3, self.normal) < 0.0 { mat3::scale(r3, -1.0) } else { r3 }]
    }

    /// `rows` or their twin, whichever makes of the surface a dome rather than a hollow: the sum over its parts of
    /// `(x n1 + y n2) / n3` is positive. And that sum over the sum of its absolute terms, from 0 to 1.
    pub fn convex(&self, rows: Mat3) -> (Mat3, f64) {
        let [r1, r2, r3] = rows;
        let (mut sum, mut absolute) = (0.0, 0.0);
        for part in self.parts.iter().filter(|part| part.count > 0.0) {
            let ([x, y], normal) = (part.position.map(f64::from), part.normal.map(f64::from));
            let n3 = mat3::dot(r3, normal);
            if n3 > SMALLEST_N3 {
                let outward = (x * mat3::dot(r1, normal) + y * mat3::dot(r2, normal)) / n3;
                sum += f64::from(part.count) * outward;
                absolute += f64::from(part.count) * outward.abs();
            }
        }
        let convexity = if absolute > 0.0 { sum / absolute } else { 0.0 };
        if convexity < 0.0 {
            ([mat3::scale(r1, -1.0), mat3::scale(r2, -1.0), r3], -convexity)
        } else {
            (rows, convexity)
        }
    }
}

/// The sums over all parts but one.
fn all_but(parts: &[Moments], left_out: usize) -> Moments {
    let mut total = Moments::default();
    for (i, part) in parts.iter().enumerate() {
        if i != left_out {
            total.add(part, 0.0, 0.0);
        }
    }
    total
}

/// The sums of gradients over all parts but one.
fn sum_but(parts: &[[[f64; 3]; 2]], left_out: usize) -> [[f64; 3]; 2] {
    let mut total = [[0.0; 3]; 2];
    for (_, sums) in parts.iter().enumerate().filter(|(i, _)| *i != left_out) {
        for (entry, sum) in total.as_flattened_mut().iter_mut().zip(sums.as_flattened()) {
            *entry += sum;
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::super::grid::{Grid, SUMS};
    use super::*;
    use crate::orientation::orthogonal::polish::rotation;

    /// A dome of which N is the normal in another frame: n = `rows` N.
    fn dome(rows: &Mat3) -> Outward {
        const SIZE: usize = 64;
        let back = mat3::transpose(rows);
        let normal = |x: usize, y: usize| {
            let (n1, n2) = ((x as f64 - 31.5) / 60.0, (31.5 - y as f64) / 60.0);
            mat3::apply(&back, [n1, n2, sqrt(1.0 - n1 * n1 - n2 * n2)])
        };
        let mut numbers = std::vec![f32::NAN; 256 * SUMS];
        let grid = Grid::finest(SIZE, SIZE, numbers.len()).unwrap();
        grid.clear(&mut numbers);
        for y in (0..SIZE).step_by(4) {
            grid.add([0, y], SIZE, [u64::MAX; 4], |row, column| normal(column, y + row), &mut numbers);
        }
        let (cells, rest) = Cells::of(&grid, &mut numbers).unwrap();
        Outward::of(&cells, rest, [31.5, -31.5]).unwrap()
    }

    #[test]
    fn a_dome_is_cheapest_in_its_own_frame_and_its_twin_is_a_hollow() {
        let rows = rotation([0.4, -0.3, 0.9]);
        let outward = dome(&rows);
        let own = outward.cost(&rows);
        for axis in 0..3 {
            for by in [-0.2, 0.2] {
                let mut turn = [0.0; 3];
                turn[axis] = by;
                let off = outward.cost(&mat3::multiply(&rotation(turn), &rows));
                assert!(off > own + 1.0, "{axis}: {off} {own}");
            }
        }
        let [r1, r2, r3] = rows;
        let twin = [mat3::scale(r1, -1.0), mat3::scale(r2, -1.0), r3];
        assert_eq!(outward.facing([r1, r2, mat3::scale(r3, -1.0)]), rows);
        for candidate in [rows, twin] {
            let (chosen, convexity) = outward.convex(candidate);
            assert!(chosen == rows && convexity > 0.999, "{convexity}");
        }
        assert!(outward.cost(&twin) > own + 1.0);
    }

    #[test]
    fn slopes_of_a_sphere_away_from_its_middle_cost_nothing() {
        // N = n, radius 50, at (10, -5) from the middle: n3 falls outward.
        let (kappa, at) = (0.02, [10.0, -5.0]);
        let [x, y] = at;
        let along = [[kappa, 0.0, -kappa * kappa * x], [0.0, kappa, -kappa * kappa * y]];
        let slopes = Slopes { along, variance: 1e-6 };
        assert!(slopes.cost(&mat3::IDENTITY, at) < 1e-20);
        // Each entry counts half of its square over the variance.
        let off = Slopes { along: [[kappa, 3e-3, along[0][2]], along[1]], variance: 1e-6 };
        assert!((off.cost(&mat3::IDENTITY, at) - 4.5).abs() < 1e-9);
        assert!(slopes.cost(&mat3::IDENTITY, [-10.0, 5.0]) > 1.0);
    }
}
