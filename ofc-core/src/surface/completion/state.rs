//! What the steps hand to each other: the caller's outputs, which hold what is known so far, and its workspace.

use super::cone::Cone;
use super::map::{Map, Vectors};
use super::two::Fold;
use super::vector::Vector;
use crate::math::arena::Arena;
use crate::surface::depth::{self, DepthError, DepthInput, DepthParams, DepthResult, Method, Plane, Slopes};

/// Outputs and workspace.
pub(super) struct State<'a> {
    pub size: [usize; 2],
    /// As in [`class`](super::class).
    pub classes: Map<'a, u8>,
    /// The normal that a pixel's color allows and that is chosen so far. It says all that the color says: the other image of a pixel
    /// of two lights is its mirror image, and the cone of a pixel of one light goes through it.
    pub normals: Vectors<'a>,
    /// Weights of the slopes; the angles in the end.
    pub weights: Map<'a, f32>,
    /// The surface so far.
    pub depth: Map<'a, f32>,
    /// How many times as likely the image on the side of e is, as a logarithm.
    pub ratios: &'a mut [f32],
    /// The integrator's numbers, free between integrations.
    pub singles: &'a mut [f32],
    /// The integrator's integers, free between integrations.
    pub integers: &'a mut [u32],
}

/// What is known of the lights.
pub(super) struct Known {
    pub directions: [Option<Vector>; 3],
    /// For the shadow of each light.
    pub folds: [Option<Fold>; 3],
    /// For each light alone.
    pub cones: [Option<Cone>; 3],
}

/// Normals that lean further lose weight, and their slope stops growing.
const LEAST_N3: f64 = 0.08;

impl State<'_> {
    /// Integrates the normals, by their weights.
    pub fn integrate(&mut self, method: Method, tolerance: f64) -> Result<DepthResult, DepthError> {
        let [width, height] = self.size;
        let size_error = |_| DepthError::Size;
        let normals =
            Plane::new(&*self.normals.data, width, height, 3, self.normals.row_stride).map_err(size_error)?;
        let mask =
            Plane::new(&*self.classes.data, width, height, 1, self.classes.row_stride).map_err(size_error)?;
        let weights =
            Plane::new(&*self.weights.data, width, height, 1, self.weights.row_stride).map_err(size_error)?;
        let input = DepthInput {
            slopes: Slopes::Normals(normals),
            mask: Some(mask),
            weights: Some(weights),
            prior: None,
        };
        let params = DepthParams { method, tolerance, min_n3: LEAST_N3, ..DepthParams::default() };
        let arena = Arena::new(&mut [], self.singles, self.integers);
        depth::integrate(&input, &params, arena, self.depth.data, self.depth.row_stride)
    }

    /// Makes the surface a plane that faces the camera.
    pub fn flatten(&mut self) {
        for y in 0..self.size[1] {
            self.depth.row_mut(y).fill(0.0);
        }
    }

    /// Four pictures of a number a pixel, in the integrator's memory.
    pub fn planes(singles: &mut [f32], [width, height]: [usize; 2]) -> [&mut [f32]; 4] {
        let mut planes = singles.chunks_exact_mut((width * height).max(1));
        [(); 4].map(|()| planes.next().unwrap_or_default())
    }
}
