//! Colors that one of the lights does not reach.
//!
//! Three lights make colors that fill a cone, and where one of them is shaded the color is a sum of the other two: it lies
//! in a plane through black that is a face of the cone. Such colors are no outliers of the ellipsoid next to the border of
//! a shadow, where the missing light would be weak anyway, but their normals are wrong by as much as ten degrees. So the
//! faces are looked for, among what the ellipsoid does not explain, and all colors near them are left out.
//!
//! A plane is a face where nearly all colors lie on one side of it, many more within the noise than right beside it, and a
//! good part of these far from an ellipsoid that is fitted without them. `docs/shadows.md` derives this, and says where it fails.
//!
//! # Reference
//! Section 2 (shadows are outliers). M. A. Fischler, R. C. Bolles, "Random sample consensus", Commun. ACM 24, 1981.

use super::inliers::{Band, Inliers};
use super::lmeds::{Fit, Problem};
use super::second_moments::SecondMoments;
use crate::math::mat3;
use crate::math::rng::Rng;
use crate::picture::{Face, Faces, MAX_FACES, Pixels, WINDOW, distance, for_each_bit, packed, stretches};
use libm::{fabsf, sqrt};

// The numbers below are multiples of the noise or shares of the colors. "By trial" says that no formula gives a number: it was
// chosen on the rendered scenes of `tests/tests/shadows.rs` and `tests/tests/joint.rs` and on the photographs, which hold it.

/// Colors that are looked at: of the smallest face ([`SMALLEST_SHARE`]) there are twenty among them.
const SAMPLE: usize = 1024;

/// Planes through two of the colors that are tried for each face: where one in eight colors lies in it, one pair in 64 does, and
/// the chance that all trials miss is (63/64)^320 = 0.6 %. Outliers alone are drawn for half of them, of which more do.
const TRIALS: usize = 320;

/// Colors within this many deviations of the noise lie in the plane: 95 % of those that do, where noise is normal.
const NEAR: f32 = 2.0;
/// Colors up to so many deviations above the plane lie beside it, and say how dense colors are where there is no face: twice the
/// breadth of what is near. By trial.
const BESIDE: f32 = 10.0;
/// Colors this many deviations below the plane are on the wrong side: one in 740 of those in it, where noise is normal.
const BEYOND: f32 = 3.0;
/// No more than this share of all colors may be on the wrong side, highlights and interreflections among them. By trial.
const MAX_BEYOND: f64 = 0.01;
/// The share that may be on the wrong side while the plane is still being fitted: a multiple of [`MAX_BEYOND`], by trial.
const MAX_BEYOND_AT_FIRST: f64 = 3.0 * MAX_BEYOND;

/// At least this share of all colors lie in a face, beyond those that would by the density beside it. By trial.
const SMALLEST_SHARE: f64 = 0.02;
/// At least so many times as many colors lie in a face as would by the density beside it. By trial.
const CONCENTRATION: f64 = 2.0;

/// At least this share of the colors of a face are outliers of an ellipsoid that was fitted without them. Of colors that obey the
/// model 1.2 % are, where noise is normal and residuals above 2.5 deviations are rejected; the rest is by trial.
const SMALLEST_OUTLIERS: f64 = 0.08;

/// Where fewer colors than this lie below a plane, their scatter is not told from the noise: a deviation of 16 numbers is good to
/// 18 %.
const SMALLEST_COUNT: usize = 16;

/// Colors below this many deviations above a face are left out: of those that lie in it all but one in 740.
const MARGIN: f32 = 3.0;

/// Noise is at least this share of the colors' root mean square: a hundred roundings of f32.
const EXACT: f64 = 1e-5;

/// Times that a plane is fitted to the colors near it. By trial.
const ROUNDS: usize = 3;

/// The shadows among the pixels of `problem`, to all of which `fit` was fitted; `None` where there are none.
///
/// # Scratch
/// The longer, the more colors are looked at: 3072 `f32` are used at most. Two passes over the pixels.
pub(crate) fn find<P: Pixels>(problem: &Problem<P>, fit: &Fit, workspace: &mut [f32]) -> Option<Faces> {
    let stride = 1 + problem.count.checked_div((workspace.len() / 3).min(SAMPLE))?;
    let len = problem.count.checked_div(stride)?;
    let (red, rest) = workspace.split_at_mut_checked(len)?;
    let (green, rest) = rest.split_at_mut_checked(len)?;
    let blue = rest.get_mut(..len)?;
    let inliers = Inliers { residual: fit.band, ..Inliers::all(problem.usable) };
    // Outliers come from the front, the others from the back.
    let (mut front, mut back, mut number) = (0, len, 0_usize);
    problem.pixels.for_each_window(|window| {
        let inside = inliers.bits(window);
        for_each_bit(problem.usable.bits(window), |i| {
            number += 1;
            if !number.is_multiple_of(stride) || front >= back {
                return;
            }
            let slot = if inside >> i & 1 == 1 {
                back -= 1;
                back
            } else {
                front += 1;
                front - 1
            };
            if let (Some(r), Some(g), Some(b)) = (red.get_mut(slot), green.get_mut(slot), blue.get_mut(slot))
            {
                [*r, *g, *b] = window.pixel(i);
            }
        });
    });
    if front != back {
        return None;
    }
    let search = Search::new([red, green, blue], front, fit.noise_deviation);
    let shadows = search.faces(problem.params.seed);
    (shadows != Faces::NONE).then_some(shadows)
}

/// The `shadows` of which enough colors are outliers of `band`, which was fitted without them: a part of a surface that is a
/// cylinder makes a plane of colors too, but they obey the model. `None` where there is none.
#[inline(never)]
pub(crate) fn confirmed<P: Pixels>(shadows: &Faces, problem: &Problem<P>, band: Band) -> Option<Faces> {
    let inliers = Inliers { residual: band, ..Inliers::all(problem.usable) };
    let mut shaded = [[0_usize; 2]; MAX_FACES];
    problem.pixels.for_each_window(|window| {
        let (among, inside) = (problem.usable.bits(window), inliers.bits(window));
        for (face, [all, outliers]) in shadows.faces.iter().zip(&mut shaded) {
            let bits = among & !face.lit(window);
            *all += bits.count_ones() as usize;
            *outliers += (bits & !inside).count_ones() as usize;
        }
    });
    let mut confirmed = *shadows;
    for (face, [all, outliers]) in confirmed.faces.iter_mut().zip(shaded) {
        if (outliers as f64) < SMALLEST_OUTLIERS * all as f64 {
            *face = Face::default();
        }
    }
    (confirmed != Faces::NONE).then_some(confirmed)
}

/// Colors, channels apart, the outliers first.
struct Search<'w> {
    channels: [&'w [f32]; 3],
    outliers: usize,
    noise: f32,
    /// Of all colors.
    sum: [f64; 3],
}

/// How colors lie about a plane.
#[derive(Clone, Copy, Default)]
struct Layers {
    near: u32,
    beside: u32,
    beyond: u32,
}

impl Layers {
    /// How many would be near the plane by the density beside it.
    fn expected(self) -> f64 {
        f64::from(self.beside) * f64::from(2.0 * NEAR / (BESIDE - NEAR))
    }

    fn gain(self) -> f64 {
        f64::from(self.near) - self.expected()
    }

    fn is_face(self, all: usize) -> bool {
        self.gain() >= SMALLEST_SHARE * all as f64 && f64::from(self.near) >= CONCENTRATION * self.expected()
    }
}

impl<'w> Search<'w> {
    fn new(channels: [&'w [f32]; 3], outliers: usize, noise: f64) -> Self {
        let mut search = Self { channels, outliers, noise: 0.0, sum: [0.0; 3] };
        let (sum, size) = search
            .colors()
            .map(|color| color.map(f64::from))
            .fold(([0.0; 3], 0.0), |([x, y, z], size), [r, g, b]| {
                ([x + r, y + g, z + b], size + (r * r + g * g + b * b))
            });
        let exact = EXACT * sqrt(size / search.len().max(1) as f64);
        (search.sum, search.noise) = (sum, noise.max(exact) as f32);
        search
    }

    fn len(&self) -> usize {
        let [red, ..] = self.channels;
        red.len()
    }

    fn colors(&self) -> impl Iterator<Item = [f32; 3]> {
        let [red, green, blue] = self.channels;
        red.iter().zip(green).zip(blue).map(|((&r, &g), &b)| [r, g, b])
    }

    fn color(&self, i: u32) -> [f32; 3] {
        self.channels.map(|channel| channel.get(i as usize).copied().unwrap_or(0.0))
    }

    fn faces(self, seed: u64) -> Faces {
        let mut rng = Rng::new(seed);
        let mut shadows = Faces::NONE;
        for i in 0..MAX_FACES {
            let Some(normal) = self.best(&shadows, &mut rng) else { break };
            if let Some(face) = shadows.faces.get_mut(i) {
                *face = self.face(normal);
            }
        }
        shadows
    }

    /// The most concentrated plane through two colors above all faces so far, if it is a face.
    fn best(&self, shadows: &Faces, rng: &mut Rng) -> Option<[f32; 3]> {
        let mut best: Option<(f64, [f32; 3])> = None;
        for trial in 0..TRIALS {
            // Where they bend the ellipsoid enough, few shaded colors are outliers.
            let from = if trial % 2 == 0 { self.outliers } else { self.len() };
            let Some(pair) = rng.distinct::<2>(from as u32) else { continue };
            let [a, b] = pair.map(|i| self.color(i));
            if !(shadows.is_lit(a) && shadows.is_lit(b)) {
                continue;
            }
            let Some(normal) = self.inward(mat3::cross(a.map(f64::from), b.map(f64::from))) else { continue };
            let least = best.map_or(0.0, |(most, _)| 0.5 * most);
            if let Some((gain, normal)) = self.settled(normal, least)
                && best.is_none_or(|(most, _)| gain > most)
            {
                best = Some((gain, normal));
            }
        }
        let (_, normal) = best?;
        self.layers(normal, MAX_BEYOND)?.is_face(self.len()).then_some(normal)
    }

    /// The plane fitted to the colors near this one, if it holds more than `least` of them by itself, and its gain.
    fn settled(&self, normal: [f32; 3], least: f64) -> Option<(f64, [f32; 3])> {
        // Two colors alone do not make it quite right.
        let mut normal = normal;
        for round in 0..ROUNDS {
            let layers = self.layers(normal, MAX_BEYOND_AT_FIRST)?;
            if round == 0 && layers.gain() <= least {
                return None;
            }
            normal = self.inward(self.fitted(normal))?;
        }
        Some((self.layers(normal, MAX_BEYOND)?.gain(), normal))
    }

    /// The direction or its opposite, of unit length, so that most colors lie on its side; `None` for none.
    fn inward(&self, direction: [f64; 3]) -> Option<[f32; 3]> {
        let length = sqrt(mat3::dot(direction, direction));
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let sign = if mat3::dot(direction, self.sum) < 0.0 { -1.0 } else { 1.0 };
        Some(mat3::scale(direction, sign / length).map(|x| x as f32))
    }

    /// How the colors lie about the plane; `None` where more than this share are beyond it.
    #[expect(clippy::needless_bitwise_bool, reason = "vector instructions do not branch")]
    fn layers(&self, normal: [f32; 3], beyond: f64) -> Option<Layers> {
        let limit = beyond * self.len() as f64;
        let (near, beside, beyond) = (NEAR * self.noise, BESIDE * self.noise, -BEYOND * self.noise);
        let mut layers = Layers::default();
        for [red, green, blue] in stretches(self.channels) {
            for ((&r, &g), &b) in red.iter().zip(green).zip(blue) {
                let distance = distance(normal, [r, g, b]);
                layers.near += u32::from(fabsf(distance) <= near);
                layers.beside += u32::from((distance > near) & (distance <= beside));
                layers.beyond += u32::from(distance < beyond);
            }
            if f64::from(layers.beyond) > limit {
                return None;
            }
        }
        Some(layers)
    }

    /// The normal of the plane through black that is nearest to the colors near this one.
    fn fitted(&self, normal: [f32; 3]) -> [f64; 3] {
        let mut moments = SecondMoments::default();
        let near = NEAR * self.noise;
        for [red, green, blue] in stretches(self.channels) {
            let mut is_near = [0; WINDOW];
            for (((is_near, &r), &g), &b) in is_near.iter_mut().zip(red).zip(green).zip(blue) {
                *is_near = u8::from(fabsf(distance(normal, [r, g, b])) <= near);
            }
            for_each_bit(packed(&is_near, 0), |i| {
                let color = [red, green, blue].map(|channel| channel.get(i).copied().unwrap_or(0.0));
                moments.add(color.map(f64::from));
            });
        }
        let [.., least] = mat3::symmetric_eigen(&moments.sum()).vectors;
        least
    }

    /// The face, with the margin that the noise on its other side asks for.
    fn face(&self, normal: [f32; 3]) -> Face {
        let (mut squares, mut count) = (0.0, 0);
        for color in self.colors() {
            let distance = distance(normal, color);
            if distance <= 0.0 && distance >= -BEYOND * self.noise {
                squares += f64::from(distance) * f64::from(distance);
                count += 1;
            }
        }
        let noise =
            if count >= SMALLEST_COUNT { sqrt(squares / count as f64) } else { f64::from(self.noise) };
        Face { normal, least: (f64::from(MARGIN) * noise) as f32 }
    }
}
