//! Cast shadows: whether a ray from the surface to a light meets the surface again.
//!
//! The ray is followed from one grid line to the next along its faster axis, so that every step is one pixel there and
//! the height of the surface is an interpolation between two pixels only. It ends where the ray is above the highest
//! point of the surface or leaves the picture.

use super::depth_map::DepthMap;

/// How far, in pixel pitches, the surface must rise above the ray: rounding must not make a plane shadow itself.
const BIAS: f64 = 1e-3;

/// f32 depths are exact to this share of their size.
const DEPTH_ROUNDING: f64 = 1.2e-7;

/// What is the same for all rays over a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Caster<'a> {
    depth: &'a DepthMap<'a>,
    highest: f64,
    bias: f64,
}

impl<'a> Caster<'a> {
    pub(super) fn new(depth: &'a DepthMap<'a>, [lowest, highest]: [f64; 2]) -> Self {
        let bias = BIAS * depth.pitch() + DEPTH_ROUNDING * lowest.abs().max(highest.abs());
        Self { depth, highest, bias }
    }

    /// Whether the surface hides the light in `direction` from its own point at column `x` and row `y`.
    pub(super) fn hides(&self, x: usize, y: usize, direction: [f64; 3]) -> bool {
        let Some(z) = self.depth.at(x, y) else { return false };
        let [right, up, toward] = direction;
        let down = -up;
        let (width, height, rise) = (self.depth.width(), self.depth.height(), toward * self.depth.pitch());
        let start = z + self.bias;
        if right.abs() >= down.abs() {
            if right == 0.0 {
                return false;
            }
            let axes = Axes { along: (x, width, right > 0.0), across: (y, height, down / right.abs()) };
            self.meets(&axes, start, rise / right.abs(), |along, across| self.depth.at(along, across))
        } else {
            let axes = Axes { along: (y, height, down > 0.0), across: (x, width, right / down.abs()) };
            self.meets(&axes, start, rise / down.abs(), |along, across| self.depth.at(across, along))
        }
    }

    fn meets(
        &self,
        axes: &Axes,
        start: f64,
        rise: f64,
        surface: impl Fn(usize, usize) -> Option<f64>,
    ) -> bool {
        let mut steps = axes.steps();
        if rise > 0.0 {
            steps = steps.min(whole((self.highest - start) / rise));
        }
        (1..=steps).any(|step| {
            let (along, across, share) = axes.at(step);
            let height = match (surface(along, across), surface(along, across + 1)) {
                (Some(near), Some(far)) => near + share * (far - near),
                // At the mask's edge the nearer pixel decides.
                (near, far) => match if share < 0.5 { near } else { far } {
                    Some(height) => height,
                    None => return false,
                },
            };
            height > start + rise * step as f64
        })
    }
}

/// The picture's axes as a ray sees them.
struct Axes {
    /// The faster one: where the ray starts, how many pixels there are, and whether their numbers grow along the ray.
    along: (usize, usize, bool),
    /// The other one: where the ray starts, how many pixels there are, and the change in a step, at most 1.
    across: (usize, usize, f64),
}

impl Axes {
    /// How many steps stay within the picture.
    fn steps(&self) -> usize {
        let ((start, size, grows), (across, across_size, slope)) = (self.along, self.across);
        let along_steps = if grows { size - 1 - start } else { start };
        let room = if slope > 0.0 { across_size - 1 - across } else { across };
        let across_steps = if slope == 0.0 { usize::MAX } else { whole(room as f64 / slope.abs()) };
        along_steps.min(across_steps)
    }

    /// After `step` steps: the pixel along, the pixel across before the ray, and how far the ray is beyond that one.
    fn at(&self, step: usize) -> (usize, usize, f64) {
        let ((start, _, grows), (across, _, slope)) = (self.along, self.across);
        let along = if grows { start.saturating_add(step) } else { start.saturating_sub(step) };
        let position = across as f64 + slope * step as f64;
        let before = whole(position);
        (along, before, position - before as f64)
    }
}

/// The whole part of a number, 0 below zero.
#[allow(clippy::cast_sign_loss, reason = "the cast saturates at zero, which is what it is for")]
const fn whole(value: f64) -> usize {
    value as usize
}
