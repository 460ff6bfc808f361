//! Pixels that see one light: a . n is known, and n lies on a cone about the light.

use super::vector::{Vector, add, cross, distance_squared, dot, length, scale, unit};
use libm::{cosf, sinf, sqrtf};

/// Normals of the cone that are compared.
const SAMPLES: usize = 24;
/// A normal that leans further than this faces away.
pub(super) const LEAST_N3: f32 = 0.02;

/// The cone about a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    axis: Vector,
    side: Vector,
    turns: [[f32; 2]; SAMPLES],
}

/// A light whose attached shadow a pixel is in: the surface is turned away from it.
pub(super) type Hidden = Option<Vector>;

impl Cone {
    pub fn new(axis: Vector) -> Self {
        let [.., z] = axis;
        let other = if z.abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
        let mut turns = [[0.0; 2]; SAMPLES];
        for (k, turn) in turns.iter_mut().enumerate() {
            let angle = core::f32::consts::TAU * k as f32 / SAMPLES as f32;
            *turn = [cosf(angle), sinf(angle)];
        }
        Self { axis, side: unit(cross(axis, other)), turns }
    }

    /// The unit normal n with axis . n = `cosine` that is nearest to `guess`, where turning toward a hidden light costs `strictness`
    /// times the squared cosine. `None` where all of them face away.
    pub fn nearest(
        &self,
        cosine: f32,
        guess: Vector,
        hidden: &[Hidden; 3],
        strictness: f32,
    ) -> Option<Vector> {
        let across = add(guess, -dot(guess, self.axis), self.axis);
        let first = if length(across) > 1e-4 { unit(across) } else { self.side };
        let second = cross(self.axis, first);
        let sine = sqrtf((1.0 - cosine * cosine).max(0.0));
        let base = scale(self.axis, cosine);
        let mut best = (f32::INFINITY, None);
        for [c, s] in self.turns {
            let n = add(add(base, sine * c, first), sine * s, second);
            let [.., z] = n;
            if z < LEAST_N3 {
                continue;
            }
            let mut cost = distance_squared(n, guess);
            for light in hidden.iter().flatten() {
                let toward = dot(n, *light).max(0.0);
                cost += strictness * toward * toward;
            }
            if cost < best.0 {
                best = (cost, Some(n));
            }
        }
        best.1
    }
}
