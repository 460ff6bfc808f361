//! The direction of a dual vector, where not all lights are known.
//!
//! One face leaves two numbers of its `E` open, and two faces one number of each. They are chosen so that the normals in the shadow
//! are those of one surface, and fit those of lit pixels across the edges of cast shadows, where the normal goes on.

use super::class::{ALL_LIGHTS, FIRST_LIGHT, mean_around};
use super::curl::{SIDE, SPAN, curl};
use super::map::{Map, Vectors};
use super::vector::{Vector, add, cross, distance_squared, dot, length, scale, unit};
use libm::{cosf, sinf, sqrtf, tanf};

/// Places in the shadow that are looked at, at most.
const SAMPLE: usize = 1500;
/// Fewer determine nothing.
const FEWEST: usize = 60;
/// Pairs across cast edges, at most, and below which they are left out.
const PAIRS: usize = 800;
const FEWEST_PAIRS: usize = 60;
/// Pairs are looked for in rows so far apart first.
const APART: usize = 8;
/// One image is right in a block of so many pixels a side.
const BLOCK: usize = 16;
/// Noise of n . curl n is at least this.
const LEAST_NOISE: f32 = 5e-4;
/// Neighboring means share pixels.
const EXCESS: f32 = 1.4;
/// No place and no pair says more than this, in squared deviations.
const MOST_OF_PLACE: f32 = 30.0;
const MOST_OF_PAIR: f32 = 4.0;
/// What normals may differ by across an edge, as a chord.
const CONTINUITY: f32 = 0.15;
/// A light that is stronger than this beside its shadow ends at a cast edge.
const CAST: f32 = 0.15;
/// Parts across e that are longer than this are impossible, and their share costs so much.
const TOO_LONG: f32 = 1.1;
const IMPOSSIBLE: f32 = 2.0;
/// Angles that are tried, in degrees: up to the widest, in steps; and how often these are halved then.
const WIDEST: f32 = 70.0;
const HALVINGS: u32 = 4;

/// Raw normals at a place in the shadow: here, right, left, above and below; and the block that it lies in.
type Place = [f32; 16];

/// What the shadow of a light shows of its dual vector.
pub(super) struct Shade<'w> {
    places: &'w mut [Place],
    pairs: &'w mut [[f32; 6]],
    variance: f32,
}

impl<'w> Shade<'w> {
    /// The shadow of `light`, whose direction is `direction`; `None` where it is too small. `deviation` is the noise of a raw normal.
    pub fn gather(
        light: usize,
        direction: Vector,
        deviation: f32,
        raw: &Vectors,
        classes: &Map<u8>,
        [room, more]: [&'w mut [f32]; 2],
    ) -> Option<Self> {
        let height = classes.data.len().div_ceil(classes.row_stride.max(1));
        let byte = ALL_LIGHTS & !(FIRST_LIGHT << light);
        let is_shaded = |x: usize, y: usize| {
            let here = classes.at(x, y);
            here != 0 && here & ALL_LIGHTS == byte && !raw.at(x, y).iter().any(|v| v.is_nan())
        };
        let is_place = |x: usize, y: usize| around(x, y).iter().all(|&(x, y)| is_shaded(x, y));
        let mut all = 0_usize;
        for y in 0..height {
            for x in 0..classes.width {
                all += usize::from(is_place(x, y));
            }
        }
        let (places, _) = room.as_chunks_mut::<16>();
        let limit = places.len().min(SAMPLE);
        let stride = all.checked_div(limit)? + 1;
        let (mut count, mut number) = (0, 0_usize);
        let same = |other: u8| other != 0 && other & ALL_LIGHTS == byte;
        // Block by block: the places of a block follow each other.
        let across = classes.width.div_ceil(BLOCK);
        for block in 0..across * height.div_ceil(BLOCK) {
            let (left, top) = (block.checked_rem(across)? * BLOCK, block.checked_div(across)? * BLOCK);
            for y in top..(top + BLOCK).min(height) {
                for x in left..(left + BLOCK).min(classes.width) {
                    if !is_place(x, y) {
                        continue;
                    }
                    number += 1;
                    if !number.is_multiple_of(stride) {
                        continue;
                    }
                    let Some(place) = places.get_mut(count) else { continue };
                    let (vectors, rest) = place.as_chunks_mut::<3>();
                    for (slot, (x, y)) in vectors.iter_mut().zip(around(x, y)) {
                        *slot = mean_around(raw, classes, [x, y], 2, same)?;
                    }
                    rest.fill(block as f32);
                    count += 1;
                }
            }
        }
        if count < FEWEST {
            return None;
        }
        let pairs = pairs(direction, raw, classes, byte, more);
        let noise = EXCESS * deviation / (SIDE * SPAN as f32) + LEAST_NOISE;
        Some(Self { places: places.get_mut(..count)?, pairs, variance: noise * noise })
    }

    /// The dual vector, given the light's direction and perhaps another's, that this shadow is most like.
    pub fn best(&self, direction: Vector, other: Option<Vector>) -> Option<Vector> {
        let (first, second) = if let Some(other) = other {
            (add(direction, -dot(direction, other), other), cross(direction, other))
        } else {
            let [.., z] = direction;
            let axis = if z.abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
            let first = unit(cross(direction, axis));
            (first, cross(direction, first))
        };
        let (first, second) = (unit(first), unit(second));
        let candidate = |[a, b]: [f32; 2]| {
            let [a, b] = [a, b].map(f32::to_radians);
            if other.is_some() {
                add(scale(first, cosf(a)), sinf(a), second)
            } else {
                add(add(direction, tanf(a), first), tanf(b), second)
            }
        };
        let mut step: f32 = if other.is_some() { 5.0 } else { 10.0 };
        let steps = libm::floorf(WIDEST / step) as i32;
        let mut best = (f32::INFINITY, [0.0; 2]);
        let mut reach = steps;
        for _ in 0..=HALVINGS {
            let [x, y] = best.1;
            let others = if other.is_some() { 0 } else { reach };
            for i in -reach..=reach {
                for j in -others..=others {
                    let angles = [x + step * i as f32, y + step * j as f32];
                    let score = self.score(unit(candidate(angles)), best.0);
                    if score < best.0 {
                        best = (score, angles);
                    }
                }
            }
            (step, reach) = (0.5 * step, 1);
        }
        let e = candidate(best.1);
        let along = dot(e, direction);
        (best.0.is_finite() && along > 0.05).then(|| scale(e, 1.0 / along))
    }

    /// How badly normals with this direction of E fit together, as squared deviations; beyond `limit` it may be anything larger.
    fn score(&self, e: Vector, limit: f32) -> f32 {
        let count = self.places.len() as f32;
        let (mut total, mut sums, mut block, mut impossible) = (0.0_f32, [0.0_f32; 2], -1.0_f32, 0.0);
        for place in self.places.iter() {
            let (vectors, rest) = place.as_chunks::<3>();
            let [a, b, c, d, f, ..] = *vectors else { continue };
            let here = rest.first().copied().unwrap_or(0.0);
            if here != block {
                let [plus, minus] = sums;
                total += plus.min(minus);
                (block, sums) = (here, [0.0; 2]);
                if total > limit * count {
                    return f32::INFINITY;
                }
            }
            let mut images = [[a, b, c, d, f]; 2];
            let [pluses, minuses] = &mut images;
            for (plus, minus) in pluses.iter_mut().zip(minuses) {
                let m = add(*plus, -dot(*plus, e), e);
                let square = dot(m, m);
                impossible += f32::from(u8::from(square > TOO_LONG));
                let m = scale(m, 1.0 / length(m).max(1.0));
                let part = sqrtf((1.0 - square).max(0.0));
                (*plus, *minus) = (add(m, part, e), add(m, -part, e));
            }
            for (sum, images) in sums.iter_mut().zip(images) {
                let curl = curl(images);
                *sum += (curl * curl / self.variance).min(MOST_OF_PLACE);
            }
        }
        let [plus, minus] = sums;
        total = (total + plus.min(minus)) / count + IMPOSSIBLE * impossible / (5.0 * count);
        if self.pairs.len() < FEWEST_PAIRS {
            return total;
        }
        let mut gaps = 0.0;
        for &[x, y, z, u, v, w] in self.pairs.iter() {
            let (shaded, lit) = ([x, y, z], [u, v, w]);
            let m = add(shaded, -dot(shaded, e), e);
            let part = sqrtf((1.0 - dot(m, m)).max(0.0));
            let m = scale(m, 1.0 / length(m).max(1.0));
            let gap = |part: f32| distance_squared(add(m, part, e), lit);
            gaps += (gap(part).min(gap(-part)) / (CONTINUITY * CONTINUITY)).min(MOST_OF_PAIR);
        }
        total + gaps / self.pairs.len() as f32
    }
}

/// Here, right, left, above and below.
const fn around(x: usize, y: usize) -> [(usize, usize); 5] {
    [(x, y), (x + SPAN, y), (x.wrapping_sub(SPAN), y), (x, y.wrapping_sub(SPAN)), (x, y + SPAN)]
}

/// Raw normals in the shadow and normals beside it, across cast edges.
fn pairs<'w>(
    direction: Vector,
    raw: &Vectors,
    classes: &Map<u8>,
    byte: u8,
    room: &'w mut [f32],
) -> &'w mut [[f32; 6]] {
    let (pairs, _) = room.as_chunks_mut::<6>();
    let height = classes.data.len().div_ceil(classes.row_stride.max(1));
    let mut count = 0;
    // Rows far apart come first, as there is room for some pairs only.
    for y in (0..APART).flat_map(|first| (first..height).step_by(APART)) {
        for x in 0..classes.width {
            let here = classes.at(x, y);
            if here == 0 || here & ALL_LIGHTS != byte || count >= PAIRS {
                continue;
            }
            let [_, sides @ ..] = around(x, y);
            for (u, v) in sides {
                if classes.at(u, v) & ALL_LIGHTS != ALL_LIGHTS {
                    continue;
                }
                let lit = mean_around(raw, classes, [u, v], 1, |byte| byte & ALL_LIGHTS == ALL_LIGHTS);
                let same = |other: u8| other != 0 && other & ALL_LIGHTS == byte;
                let shaded = mean_around(raw, classes, [x, y], 1, same);
                let (Some(lit), Some([a, b, c])) = (lit, shaded) else { continue };
                let [d, e, f] = unit(lit);
                if dot(direction, lit) > CAST
                    && let Some(slot) = pairs.get_mut(count)
                {
                    *slot = [a, b, c, d, e, f];
                    count += 1;
                }
            }
        }
    }
    pairs.get_mut(..count.min(PAIRS)).unwrap_or_default()
}
