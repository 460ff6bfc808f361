//! How far the normals are from where integrability and outward normals would have them.

use crate::color::inliers::Inliers;
use crate::math::mat3::Mat3;
use crate::orientation::joint;
use crate::picture::Image;
use libm::{asin, sqrt};

/// What [`joint`] would change about the normals of F.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// The angle between the normals of F and those that agree best with integrability and outward normals: the root mean
    /// square over all directions. A normal's own angle is smaller the nearer it is to the axis.
    pub angle: f64,
    /// The angle that is to be expected of a right F, as far as the picture tells.
    pub expected: f64,
    /// How clear the choice between a surface and its convex/concave twin is, see [`joint::Joint::convexity`].
    pub convexity: f64,
}

/// The turn of the inliers' normals `f_inverse` rho; `None` where the picture says nothing about it.
///
/// # Scratch
/// [`joint::workspace_len`] `f32`.
#[inline(never)]
pub(super) fn turn(
    image: &Image,
    inliers: &Inliers,
    f_inverse: &Mat3,
    workspace: &mut [f32],
) -> Option<Turn> {
    let found = joint::estimate(image, inliers, f_inverse, workspace)?;
    let angle = root_mean_square_angle(&found.rows);
    Some(Turn { angle, expected: found.expected_error(), convexity: found.convexity })
}

/// The angle whose chord is the root mean square distance between a unit vector and what an orthogonal matrix makes of it.
fn root_mean_square_angle(&[[xx, ..], [_, yy, _], [.., zz]]: &Mat3) -> f64 {
    2.0 * asin(sqrt((0.5 - (xx + yy + zz) / 6.0).clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mat3::{self, IDENTITY};
    use crate::math::rng::Rng;
    use core::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn the_angle_is_that_of_random_directions() {
        let (s, c) = libm::sincos(0.7);
        let turned = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        let mirrored = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
        let mut rng = Rng::new(4);
        for rows in [turned, mirrored] {
            let (mut sum, mut count) = (0.0, 0.0);
            while count < 20_000.0 {
                let v = [0; 3].map(|_| 2.0 * rng.unit() - 1.0);
                let square = mat3::dot(v, v);
                if (0.01..1.0).contains(&square) {
                    let w = mat3::apply(&rows, v);
                    let d = [0, 1, 2].map(|i| v[i] - w[i]);
                    sum += mat3::dot(d, d) / square;
                    count += 1.0;
                }
            }
            let chord = 2.0 * libm::sin(0.5 * root_mean_square_angle(&rows));
            assert!((chord - sqrt(sum / count)).abs() < 0.01);
        }
        assert_eq!(root_mean_square_angle(&IDENTITY), 0.0);
        assert!((root_mean_square_angle(&IDENTITY.map(|row| row.map(|v| -v))) - PI).abs() < 1e-12);
        assert!(root_mean_square_angle(&[[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]) > FRAC_PI_2);
    }
}
