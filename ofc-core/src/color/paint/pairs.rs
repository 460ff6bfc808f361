//! Pairs of neighboring colors that differ in direction.

use super::sampler::Sampler;
use crate::color::ellipsoid::{Coefficients, quadratic_form};
use crate::math::mat3::{Mat3, apply, dot};
use core::f64::consts::TAU;
use libm::{cos, round, sin};

/// Pairs are drawn at so many distances, each twice the one before.
pub const DISTANCES: usize = 3;
/// Pairs of each distance.
pub(super) const PER_DISTANCE: usize = 2000;
/// Pixels that are drawn for them at most.
const DRAWS: usize = 8 * PER_DISTANCE;
/// Length of the memory that pairs take, in `f32`.
pub(super) const LEN: usize = DISTANCES * PER_DISTANCE * size_of::<Pair>() / size_of::<f32>();
/// Fewer pairs of one distance say nothing.
pub(super) const FEWEST: usize = 30;

/// Colors differ where the angle between them, once their second moments are a unit matrix, has at most this cosine: 4 degrees.
/// Others say nothing of C and much of the noise, and a flat part of a picture has no pairs.
const MOST_ALIKE: f64 = 0.997_564_050_259_824_2;

/// Two colors, scaled to about 1, and the step in pixels from the first to the second.
pub(super) type Pair = [f32; 8];

/// The pairs of each distance.
#[derive(Clone, Copy)]
pub(super) struct Pairs<'w> {
    pub(super) of: [&'w [Pair]; DISTANCES],
}

impl<'w> Pairs<'w> {
    /// Draws them. `inverse` is that of the colors' second moments.
    pub(super) fn draw(
        sampler: &mut Sampler,
        inverse: &Mat3,
        scale: f64,
        distances: [u32; DISTANCES],
        mut room: &'w mut [Pair],
    ) -> Self {
        let mut of = [<&[Pair]>::default(); DISTANCES];
        for (slot, distance) in of.iter_mut().zip(distances) {
            let own = room.split_off_mut(..PER_DISTANCE).unwrap_or_default();
            let mut count = 0;
            for _ in 0..DRAWS {
                let Some(place) = own.get_mut(count) else { break };
                if let Some(([p, q], [dx, dy])) = pair(sampler, inverse, f64::from(distance)) {
                    let [p, q] = [p, q].map(|color| color.map(|value| (value * scale) as f32));
                    *place = [p[0], p[1], p[2], q[0], q[1], q[2], dx, dy];
                    count += 1;
                }
            }
            *slot = own.get(..count).unwrap_or_default();
        }
        Self { of }
    }

    /// How many there are.
    pub(super) fn counts(&self) -> [u32; DISTANCES] {
        self.of.map(|pairs| pairs.len() as u32)
    }

    /// The first and the second half of each distance: they were drawn independently.
    pub(super) fn halves(&self) -> [Self; 2] {
        let halves = self.of.map(|pairs| pairs.split_at_checked(pairs.len() / 2).unwrap_or_default());
        [Self { of: halves.map(|(first, _)| first) }, Self { of: halves.map(|(_, second)| second) }]
    }

    /// The pair of this number, counted through all distances.
    pub(super) fn get(&self, mut number: usize) -> Option<&Pair> {
        for pairs in self.of {
            if let Some(pair) = pairs.get(number) {
                return Some(pair);
            }
            number -= pairs.len();
        }
        None
    }
}

/// The colors of two pixels so far apart in any direction, where they differ, and the step between them.
fn pair(sampler: &mut Sampler, inverse: &Mat3, distance: f64) -> Option<([[f64; 3]; 2], [f32; 2])> {
    let [x, y] = sampler.draw();
    let angle = TAU * sampler.rng.unit();
    let [dx, dy] = [distance * cos(angle), distance * sin(angle)].map(|step| round(step) as isize);
    let p = sampler.mean([x, y])?;
    let q = sampler.mean([x.checked_add_signed(dx)?, y.checked_add_signed(dy)?])?;
    let (white_p, white_q) = (apply(inverse, p), apply(inverse, q));
    let (pp, pq, qq) = (dot(p, white_p), dot(p, white_q), dot(q, white_q));
    let differ = pq < 0.0 || pq * pq < MOST_ALIKE * MOST_ALIKE * pp * qq;
    differ.then_some(([p, q], [dx as f32, dy as f32]))
}

/// rho^T C rho of both colors.
pub(super) fn lengths(z: &Coefficients, &[pr, pg, pb, qr, qg, qb, ..]: &Pair) -> [f64; 2] {
    [quadratic_form(z, pr, pg, pb), quadratic_form(z, qr, qg, qb)]
}

/// The monomials of both colors: rho^T C rho = z . m.
pub(super) fn monomials(&[pr, pg, pb, qr, qg, qb, ..]: &Pair) -> [[f64; 6]; 2] {
    [[pr, pg, pb], [qr, qg, qb]].map(|color| {
        let [r, g, b] = color.map(f64::from);
        [r * r, g * g, b * b, 2.0 * r * g, 2.0 * r * b, 2.0 * g * b]
    })
}
