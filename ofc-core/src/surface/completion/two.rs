//! Pixels in the shadow of one light: v = n - E (a . n), so the part of v across the direction e of E is that of n.
//!
//! The part along e follows from the length, but for its sign: n = m +- y e. The two images are mirrored at the plane of the two
//! lights that are seen.

use super::cone::LEAST_N3;
use super::vector::{Matrix, Vector, add, apply, dot, form, length, scale, trace, unit};
use libm::sqrtf;

/// A part that is longer than 1 by this much, or by so many deviations of its noise, is no pixel of two lights.
const TOO_LONG: f32 = 0.2;
const TOO_LONG_BY_NOISE: f32 = 6.0;

/// What the direction of a dual vector makes of raw normals and their noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fold {
    /// Of unit length, across the two lights that are seen.
    pub e: Vector,
    /// The covariance of noise across e.
    noise: Matrix,
}

impl Fold {
    /// `noise` is the covariance of the means of raw normals.
    pub fn new(e: Vector, noise: &Matrix) -> Self {
        let e = unit(e);
        let ne = apply(noise, e);
        let ene = dot(e, ne);
        let mut across = *noise;
        for ((row, e_i), ne_i) in across.iter_mut().zip(e).zip(ne) {
            for ((entry, e_j), ne_j) in row.iter_mut().zip(e).zip(ne) {
                *entry += e_i * e_j * ene - e_i * ne_j - ne_i * e_j;
            }
        }
        Self { e, noise: across }
    }

    /// The image on the side of e; `None` where v is no pixel of two lights, or both images face away.
    pub fn image(&self, v: Vector) -> Option<Vector> {
        let m = add(v, -dot(v, self.e), self.e);
        let size = length(m);
        let noise = sqrtf(form(&self.noise, unit(m)).max(0.0));
        if size > 1.0 + TOO_LONG + TOO_LONG_BY_NOISE * noise {
            return None;
        }
        let image = self.on_sphere(m, size);
        let faces = |[.., z]: Vector| z >= LEAST_N3;
        (faces(image) || faces(self.mirrored(image))).then_some(image)
    }

    /// The same without a limit.
    pub fn nearest_image(&self, v: Vector) -> Vector {
        let m = add(v, -dot(v, self.e), self.e);
        self.on_sphere(m, length(m))
    }

    fn on_sphere(&self, m: Vector, size: f32) -> Vector {
        let m = scale(m, 1.0 / size.max(1.0));
        add(m, sqrtf((1.0 - dot(m, m)).max(0.0)), self.e)
    }

    /// The other image.
    pub fn mirrored(&self, n: Vector) -> Vector {
        add(n, -2.0 * dot(n, self.e), self.e)
    }

    /// Both images: on the side of e, and the other.
    pub fn both(&self, n: Vector) -> [Vector; 2] {
        let other = self.mirrored(n);
        if dot(n, self.e) >= 0.0 { [n, other] } else { [other, n] }
    }

    /// The expected square of the error of an image, in radians squared, across the normal.
    ///
    /// With y = sqrt(1 - |m|^2), dn = dm - e (m . dm) / y; where y is hardly more than its own noise it is taken for larger.
    pub fn variance(&self, n: Vector) -> f32 {
        let y = dot(n, self.e);
        let m = add(n, -y, self.e);
        let along = form(&self.noise, m).max(0.0);
        let y = y * y + 2.0 * sqrtf(along / dot(m, m).max(1e-6));
        trace(&self.noise) + along / y.max(1e-6)
    }
}

/// The image that is more likely, or the other one where that faces away. At least one of them faces the camera.
pub(super) fn facing(ratio: f32, plus: Vector, minus: Vector) -> Vector {
    let (more, less) = if ratio > 0.0 { (plus, minus) } else { (minus, plus) };
    let [.., z] = more;
    if z >= LEAST_N3 { more } else { less }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::completion::vector::{cross, distance_squared};

    #[test]
    fn one_of_the_images_is_the_normal() {
        let (a, b, c) = (unit([0.5, 0.1, 0.8]), unit([-0.6, 0.2, 0.7]), unit([0.1, -0.7, 0.6]));
        // Dual to c.
        let dual = scale(cross(a, b), 1.0 / dot(cross(a, b), c));
        let tiny = [[1e-6, 0.0, 0.0], [0.0, 1e-6, 0.0], [0.0, 0.0, 1e-6]];
        let fold = Fold::new(dual, &tiny);
        for n in [[0.1, 0.2, 0.9], [-0.5, 0.6, 0.3], [0.0, 0.0, 1.0]].map(unit) {
            let v = add(n, -dot(c, n), dual);
            let [plus, minus] = fold.both(fold.image(v).unwrap());
            assert!(distance_squared(plus, n).min(distance_squared(minus, n)) < 1e-9);
            // Both send the same light of the two that are seen.
            assert!((dot(a, plus) - dot(a, n)).abs() < 1e-5 && (dot(b, minus) - dot(b, n)).abs() < 1e-5);
            assert!(fold.variance(n) > 0.0);
        }
        assert_eq!(fold.image([3.0, 3.0, 3.0]), None);
    }
}
