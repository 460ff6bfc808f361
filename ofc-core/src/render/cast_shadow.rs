//! Cast shadows: whether a ray from the surface to a light meets the surface again.
//!
//! The ray is followed from one grid line to the next along its faster axis, so that every step is one pixel there and
//! the height of the surface is an interpolation between two pixels only. It ends where the ray is above the highest
//! point of the surface or leaves the picture. A coarse table of highest points lets it pass over low ground in one
//! step; the answer is the same without the table.

use super::depth_map::DepthMap;

/// How far, in pixel pitches, the surface must rise above the ray: rounding must not make a plane shadow itself.
const BIAS: f64 = 1e-3;

/// f32 depths are exact to this share of their size.
const DEPTH_ROUNDING: f64 = 1.2e-7;

/// The table has this many tiles a side at most.
const TILES: usize = 16;

/// The highest point of each tile, minus infinity where there is no surface.
pub(super) type Tiles = [[f32; TILES]; TILES];

/// No tile has been looked at.
pub(super) const NO_TILES: Tiles = [[f32::NEG_INFINITY; TILES]; TILES];

/// What is the same for all rays over a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Caster<'a> {
    depth: &'a DepthMap<'a>,
    highest: f64,
    bias: f64,
    /// A tile has 2^`tile_bits` pixels a side.
    tile_bits: u32,
    tiles: &'a Tiles,
}

impl<'a> Caster<'a> {
    /// `tiles` is [`NO_TILES`]; the table is big for a stack, so it is made in place.
    pub(super) fn new(depth: &'a DepthMap<'a>, [lowest, highest]: [f64; 2], tiles: &'a mut Tiles) -> Self {
        let bias = BIAS * depth.pitch() + DEPTH_ROUNDING * lowest.abs().max(highest.abs());
        let side = depth.width().max(depth.height());
        let tile_bits = side.div_ceil(TILES).next_power_of_two().trailing_zeros();
        for y in 0..depth.height() {
            let Some(row) = tiles.get_mut(y >> tile_bits) else { continue };
            for x in 0..depth.width() {
                if let (Some(tile), Some(z)) = (row.get_mut(x >> tile_bits), depth.at(x, y)) {
                    *tile = tile.max(z as f32);
                }
            }
        }
        Self { depth, highest, bias, tile_bits, tiles }
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
            let path = Path::new((x, width, right), (y, height, down));
            self.meets::<false>(&path, start, rise / right.abs())
        } else {
            let path = Path::new((y, height, down), (x, width, right));
            self.meets::<true>(&path, start, rise / down.abs())
        }
    }

    /// Whether a ray is below the surface anywhere; `DOWN` says that it is the rows that it follows step by step.
    fn meets<const DOWN: bool>(&self, path: &Path, start: f64, rise: f64) -> bool {
        let mut steps = path.steps;
        if rise > 0.0 {
            steps = steps.min(whole((self.highest - start) / rise));
        }
        let height = |step: usize| start + rise * step as f64;
        let mut first = 1;
        while first <= steps {
            let last = path.tile_end(first, self.tile_bits).min(steps);
            let lowest = height(if rise > 0.0 { first } else { last });
            if self.highest_under::<DOWN>(path, first, last) > lowest
                && (first..=last).any(|step| self.surface::<DOWN>(path, step) > height(step))
            {
                return true;
            }
            first = last + 1;
        }
        false
    }

    /// The height of the surface under a ray, minus infinity where there is none.
    #[inline]
    fn surface<const DOWN: bool>(&self, path: &Path, step: usize) -> f64 {
        let along = path.along(step);
        let at =
            |across| if DOWN { self.depth.inside(across, along) } else { self.depth.inside(along, across) };
        let (before, share) = path.across(step);
        match (at(before), at((before + 1).min(path.across_last))) {
            (Some(near), Some(far)) => near + share * (far - near),
            // At the mask's edge the nearer pixel decides.
            (near, far) => (if share < 0.5 { near } else { far }).unwrap_or(f64::NEG_INFINITY),
        }
    }

    /// The highest point of the tiles that a ray passes over from step `first` to `last`, which are in one row of tiles.
    fn highest_under<const DOWN: bool>(&self, path: &Path, first: usize, last: usize) -> f64 {
        let along = path.along(first) >> self.tile_bits;
        let ((one, _), (other, _)) = (path.across(first), path.across(last));
        let (from, to) = (one.min(other) >> self.tile_bits, (one.max(other) + 1) >> self.tile_bits);
        let mut highest = f32::NEG_INFINITY;
        for across in from..=to {
            let (x, y) = if DOWN { (across, along) } else { (along, across) };
            // Beyond the last tile there is no surface.
            if let Some(&tile) = self.tiles.get(y).and_then(|row| row.get(x)) {
                highest = highest.max(tile);
            }
        }
        f64::from(highest)
    }
}

/// Where a ray goes in the picture. Along its faster axis it moves by one pixel a step; its place on the other axis is
/// a fixed-point number: no conversion and no rounding on the way.
struct Path {
    along: usize,
    forward: bool,
    across: u64,
    across_step: i64,
    across_last: usize,
    /// How many steps stay within the picture.
    steps: usize,
}

/// Pixels' numbers are below 2^31, so 32 bits are left for the fraction.
const FRACTION_BITS: u32 = 32;
const FRACTION: u64 = 1 << FRACTION_BITS;

impl Path {
    /// The path from a pixel; of each axis its number, how many there are, and the ray's component.
    fn new(
        (along, along_size, along_component): (usize, usize, f64),
        (across, across_size, across_component): (usize, usize, f64),
    ) -> Self {
        let across_step = (across_component / along_component.abs() * FRACTION as f64) as i64;
        let across_last = across_size - 1;
        let room = if across_step > 0 { across_last - across } else { across };
        let across_steps =
            ((room as u64) << FRACTION_BITS).checked_div(across_step.unsigned_abs()).unwrap_or(u64::MAX);
        let forward = along_component > 0.0;
        let along_steps = if forward { along_size - 1 - along } else { along };
        let steps = usize::try_from(across_steps).map_or(along_steps, |steps| along_steps.min(steps));
        Self { along, forward, across: (across as u64) << FRACTION_BITS, across_step, across_last, steps }
    }

    /// The pixel along after `step` steps.
    const fn along(&self, step: usize) -> usize {
        if self.forward { self.along.wrapping_add(step) } else { self.along.wrapping_sub(step) }
    }

    /// The pixel across before the ray after `step` steps, and how far the ray is beyond it.
    const fn across(&self, step: usize) -> (usize, f64) {
        // In two's complement the low bits of a product are the same with a sign and without.
        let across = self.across.wrapping_add((step as u64).wrapping_mul(self.across_step.cast_unsigned()));
        ((across >> FRACTION_BITS) as usize, (across & (FRACTION - 1)) as f64 * (1.0 / FRACTION as f64))
    }

    /// The last step from `step` on that is in the same tile along.
    const fn tile_end(&self, step: usize, tile_bits: u32) -> usize {
        let last = (1 << tile_bits) - 1;
        let within = self.along(step) & last;
        step.saturating_add(if self.forward { last - within } else { within })
    }
}

/// The whole part of a number, 0 below zero.
#[allow(clippy::cast_sign_loss, reason = "the cast saturates at zero, which is what it is for")]
const fn whole(value: f64) -> usize {
    value as usize
}
