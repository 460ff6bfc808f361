//! The orthogonal transformation from smoothness: r3 is an eigenvector, and one angle is left.
//!
//! What the paper tells of \[15\] is what this does; the original was not at hand, so the derivation is our own. Minimise
//! the smoothness (16) of one row's component, `sum (r . N_x)^2 + (r . N_y)^2 = r^T S r`, over unit vectors r: with a
//! Lagrange multiplier for r^T r = 1 the Euler equation is `S r = lambda r`,
//! `S = sum(N_x N_x^T + N_y N_y^T)`, and the constraint that R be orthogonal makes all three rows eigenvectors of S.
//! (The sum of (16) over all three rows is the trace of S whatever R is: smoothness names the axes, but not which is
//! which.) Of the three, the row r3 is "such that n3 = r3 . N is maximized": the one along which the mean of N is
//! longest, with the sign that makes that mean positive, since every visible normal has n3 > 0. On a shallow surface it
//! is also the eigenvector of the smallest eigenvalue, for n3 varies least; on a whole hemisphere it is that of the
//! largest, and the mean still finds it.
//!
//! With r3 given and r1 = cos a u + sin a v, r2 = +-(-sin a u + cos a v) in the plane across, n3 is known at every
//! pixel, and (15) in the form of the parent module is a quadratic form in (cos a, sin a): its smaller eigenvector is
//! the global minimum, exactly. This is done for both signs of the determinant and the smaller integral counts.
//!
//! The axes of S are those of the picture for surfaces that are symmetric on the whole, and near them otherwise. A few
//! Newton steps on (15) over all three angles then lead to the minimum nearby; with `polish_evaluations` = 0 the answer
//! is the closed form alone.
//!
//! # Reference
//! Sections 2.3-2.4, eqs. 15-16. \[15\]: M. S. Drew, L. L. Kontsevich, "Closed-form attitude determination under spectrally
//! varying illumination", CVPR 1994.

use super::problem::Problem;
use super::result::{Found, OrthogonalError};
use super::sample::for_each_cell;
use crate::math::angle::sincos;
use crate::math::mat3::{self, Mat3};
use crate::orientation::integrability::SMALLEST_N3;
use crate::picture::{Image, Window, for_each_bit};
use libm::{atan2, sqrt};

/// Times that the polish may compute (15) over the picture, unless the caller says otherwise.
pub const POLISH_EVALUATIONS: u32 = 60;

/// The transformation of the normals `root` rho of the pixels that `inliers` gives the bits of.
///
/// `tilts` of the rows of F, where known, choose between the twins.
///
/// # Units
/// `root` in (pixel value)^-1, tilts in radians, the integral in pixel^-2.
///
/// # Errors
/// See [`OrthogonalError`]; the workspace is never too short.
///
/// # Scratch
/// None but about 6 KiB of stack. Four passes over the picture, and one for each evaluation of the polish.
pub fn closed_form(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    root: &Mat3,
    tilts: Option<[f64; 3]>,
    polish_evaluations: u32,
) -> Result<Found, OrthogonalError> {
    let problem = Problem::new(image, inliers, root, tilts)?;
    let r3 = view_axis(image, &problem.inliers, root).ok_or(OrthogonalError::NoCells)?;
    let rows = remaining_angle(image, &problem.inliers, root, r3).ok_or(OrthogonalError::NoCells)?;
    problem.finish(rows, polish_evaluations)
}

/// The mean of N over the inliers, not divided by their number; zero when there are none.
fn sum_of_normals(image: &Image, inliers: impl Fn(&Window) -> u64, root: &Mat3) -> [f64; 3] {
    let mut sum = [0.0; 3];
    image.for_each_window(|window| {
        let mut colors = [0.0; 3];
        for_each_bit(inliers(window), |i| {
            for (color, value) in colors.iter_mut().zip(window.pixel(i)) {
                *color += f64::from(value);
            }
        });
        for (sum, value) in sum.iter_mut().zip(mat3::apply(root, colors)) {
            *sum += value;
        }
    });
    sum
}

/// r3: the axis of smoothness that the normals point along.
fn view_axis(image: &Image, inliers: impl Fn(&Window) -> u64, root: &Mat3) -> Option<[f64; 3]> {
    let mut smoothness = [[0.0; 3]; 3];
    for_each_cell(image, &inliers, root, |_, n_x, n_y| {
        for (i, row) in smoothness.iter_mut().enumerate() {
            let (x, y) = (n_x.get(i).copied().unwrap_or(0.0), n_y.get(i).copied().unwrap_or(0.0));
            for (entry, (a, b)) in row.iter_mut().zip(n_x.into_iter().zip(n_y)) {
                *entry += x * a + y * b;
            }
        }
    });
    let eigen = mat3::symmetric_eigen(&smoothness);
    let [largest, ..] = eigen.values;
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let mean = sum_of_normals(image, &inliers, root);
    let [a, b, c] = eigen.vectors.map(|vector| (mat3::dot(vector, mean), vector));
    let mut best = a;
    for axis in [b, c] {
        if axis.0.abs() > best.0.abs() {
            best = axis;
        }
    }
    let (along, axis) = best;
    unit(mat3::scale(axis, if along < 0.0 { -1.0 } else { 1.0 }))
}

/// The sums of X^2, XY, Y^2 that (15) is made of when its curl is X cos a + Y sin a.
#[derive(Clone, Copy, Default)]
struct Angle {
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Angle {
    fn add(&mut self, x: f64, y: f64) {
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
    }

    /// The angle at which the form is smallest, and the form there.
    fn minimum(&self) -> (f64, f64) {
        let (half_sum, half_difference) = (0.5 * (self.xx + self.yy), 0.5 * (self.xx - self.yy));
        let radius = sqrt(half_difference * half_difference + self.xy * self.xy);
        // The form is half_sum + half_difference cos 2a + xy sin 2a.
        (0.5 * atan2(-self.xy, -half_difference), half_sum - radius)
    }
}

/// The rows with the given r3 for which (15) is smallest.
fn remaining_angle(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    root: &Mat3,
    r3: [f64; 3],
) -> Option<Mat3> {
    // The coordinate axis least along r3 is the farthest from having no part across it.
    let [x, y, z] = r3.map(f64::abs);
    let axis = if x <= y && x <= z {
        [1.0, 0.0, 0.0]
    } else if y <= z {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    let u = unit(mat3::cross(r3, axis))?;
    let v = mat3::cross(r3, u);
    let (mut right, mut left, mut cells) = (Angle::default(), Angle::default(), 0_u64);
    for_each_cell(image, inliers, root, |n, n_x, n_y| {
        let n3 = mat3::dot(r3, n).max(SMALLEST_N3);
        let (a, b) = (mat3::cross(n, n_x), mat3::cross(n, n_y));
        let [ua, va, ub, vb] =
            [mat3::dot(u, a), mat3::dot(v, a), mat3::dot(u, b), mat3::dot(v, b)].map(|x| x / (n3 * n3));
        right.add(ua + vb, va - ub);
        left.add(ua - vb, va + ub);
        cells += 1;
    });
    if cells == 0 {
        return None;
    }
    let ((right_angle, right_least), (left_angle, left_least)) = (right.minimum(), left.minimum());
    let (angle, sign) = if left_least < right_least { (left_angle, -1.0) } else { (right_angle, 1.0) };
    let (s, c) = sincos(angle);
    let combine = |c: f64, s: f64| {
        let ([u1, u2, u3], [v1, v2, v3]) = (u, v);
        [c * u1 + s * v1, c * u2 + s * v2, c * u3 + s * v3]
    };
    Some([combine(c, s), mat3::scale(combine(-s, c), sign), r3])
}

/// A unit vector along `v`; `None` when it has no direction.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = sqrt(mat3::dot(v, v));
    (length > 0.0 && length.is_finite()).then(|| mat3::scale(v, 1.0 / length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn no_angle_is_better_than_the_best() {
        let mut rng = Rng::new(2);
        for _ in 0..50 {
            let mut sums = Angle::default();
            let terms = [(); 5].map(|()| [2.0 * rng.unit() - 1.0, 3.0 * rng.unit() - 1.0]);
            for [x, y] in terms {
                sums.add(x, y);
            }
            let at = |angle: f64| {
                let (s, c) = sincos(angle);
                terms.iter().map(|[x, y]| (x * c + y * s) * (x * c + y * s)).sum::<f64>()
            };
            let (angle, least) = sums.minimum();
            assert!((at(angle) - least).abs() < 1e-12, "{least}");
            assert!((0..400).all(|i| at(f64::from(i) * 0.01) >= least - 1e-12));
        }
    }
}
