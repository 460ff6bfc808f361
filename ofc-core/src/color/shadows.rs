//! Colors that one of the lights does not reach.
//!
//! Three lights make colors that fill a cone, and where one of them is shaded the color is a sum of the other two: it lies
//! in a plane through black that is a face of the cone. Such colors are no outliers of the ellipsoid next to the border of
//! a shadow, where the missing light would be weak anyway, but their normals are wrong by as much as ten degrees. So the
//! faces are looked for, among what the ellipsoid does not explain, and all colors near them are left out.
//!
//! A plane is a face where nearly all colors lie on one side of it, many more within the noise than right beside it, and a
//! good part of these far from an ellipsoid that is fitted without them.
//!
//! # Reference
//! Section 2 (shadows are outliers). M. A. Fischler, R. C. Bolles, "Random sample consensus", Commun. ACM 24, 1981.

use crate::color::inliers::{Band, Inliers};
use crate::math::mat3::{self, Mat3};
use crate::math::rng::Rng;
use crate::picture::{Face, Faces, MAX_FACES, Pixels, Usable, distance, for_each_bit};
use libm::{fabsf, sqrt};

/// Colors that are looked at.
const SAMPLE: usize = 1024;

/// Planes through two of them that are tried for each face.
const TRIALS: usize = 320;

/// Colors within this many deviations of the noise lie in the plane.
const NEAR: f32 = 2.0;
/// Right beside it lie those up to here.
const BESIDE: f32 = 10.0;
/// Beyond it lie those this far on the wrong side; no more than this share of all may.
const BEYOND: f32 = 3.0;
const MAX_BEYOND: f64 = 0.01;

/// At least this share of all colors lie in a face, and at least so many times as many as would by the density beside it.
const SMALLEST_SHARE: f64 = 0.02;
const CONCENTRATION: f64 = 2.0;

/// At least this share of the colors of a face are outliers of an ellipsoid that was fitted without them.
const SMALLEST_OUTLIERS: f64 = 0.08;

/// Fewer outliers than this have no shadows.
const SMALLEST_COUNT: usize = 16;

/// Colors within this many deviations of a face are left out.
const MARGIN: f32 = 3.0;

/// Noise is at least this share of the colors' root mean square.
const EXACT: f64 = 1e-5;

/// Times that a plane is fitted to the colors near it.
const ROUNDS: usize = 3;

/// The shadows in `pixels`, of which the `count` that are `usable` were fitted: `band` holds those near the ellipsoid, and
/// `noise` is the deviation of a channel. `None` where there are none.
///
/// # Scratch
/// The longer, the more colors are looked at: 3072 `f32` are used at most. Two passes over the pixels.
pub fn find(
    pixels: &impl Pixels,
    usable: Usable,
    count: usize,
    band: Band,
    noise: f64,
    seed: u64,
    workspace: &mut [f32],
) -> Option<Faces> {
    let (room, _) = workspace.as_chunks_mut::<3>();
    let stride = 1 + count.checked_div(room.len().min(SAMPLE))?;
    let colors = room.get_mut(..count.checked_div(stride)?)?;
    let inliers = Inliers { residual: band, ..Inliers::all(usable) };
    // Outliers come from the front, the others from the back.
    let (mut front, mut back, mut number) = (0, colors.len(), 0_usize);
    pixels.for_each_window(|window| {
        let inside = inliers.bits(window);
        for_each_bit(usable.bits(window), |i| {
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
            if let Some(slot) = colors.get_mut(slot) {
                *slot = window.pixel(i);
            }
        });
    });
    if front != back {
        return None;
    }
    let size: f64 = colors.as_flattened().iter().map(|&value| f64::from(value) * f64::from(value)).sum();
    let exact = EXACT * sqrt(size / colors.len().max(1) as f64);
    let shadows = Search { colors, outliers: front, noise: noise.max(exact) as f32 }.faces(seed);
    (shadows != Faces::NONE).then_some(shadows)
}

/// Those of which enough colors are outliers of `band`, which was fitted without them: a part of a surface that is a
/// cylinder makes a plane of colors too, but they obey the model. `None` where there is none.
#[inline(never)]
pub fn confirmed(shadows: &Faces, pixels: &impl Pixels, usable: Usable, band: Band) -> Option<Faces> {
    let inliers = Inliers { residual: band, ..Inliers::all(usable) };
    let mut shaded = [[0_usize; 2]; MAX_FACES];
    pixels.for_each_window(|window| {
        let (among, inside) = (usable.bits(window), inliers.bits(window));
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

/// Colors, the outliers first.
struct Search<'w> {
    colors: &'w mut [[f32; 3]],
    outliers: usize,
    noise: f32,
}

/// How colors lie about a plane.
#[derive(Clone, Copy, Default)]
struct Layers {
    near: u16,
    beside: u16,
    beyond: u16,
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

impl Search<'_> {
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
            let from = if trial % 2 == 0 { self.outliers } else { self.colors.len() };
            let Some(pair) = rng.distinct::<2>(from as u32) else { continue };
            let [a, b] = pair.map(|i| self.colors.get(i as usize).copied().unwrap_or_default());
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
        self.layers(normal, MAX_BEYOND)?.is_face(self.colors.len()).then_some(normal)
    }

    /// The plane fitted to the colors near this one, if it holds more than `least` of them by itself, and its gain.
    fn settled(&self, normal: [f32; 3], least: f64) -> Option<(f64, [f32; 3])> {
        // Two colors alone do not make it quite right.
        let mut normal = normal;
        for round in 0..ROUNDS {
            let layers = self.layers(normal, 3.0 * MAX_BEYOND)?;
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
        let sum = self
            .colors
            .iter()
            .fold([0.0; 3], |[x, y, z], &[r, g, b]| [x + f64::from(r), y + f64::from(g), z + f64::from(b)]);
        let sign = if mat3::dot(direction, sum) < 0.0 { -1.0 } else { 1.0 };
        Some(mat3::scale(direction, sign / length).map(|x| x as f32))
    }

    /// How the colors lie about the plane; `None` where more than this share are beyond it.
    fn layers(&self, normal: [f32; 3], beyond: f64) -> Option<Layers> {
        let limit = beyond * self.colors.len() as f64;
        let (near, beside, beyond) = (NEAR * self.noise, BESIDE * self.noise, -BEYOND * self.noise);
        let mut layers = Layers::default();
        for &color in self.colors.iter() {
            let distance = distance(normal, color);
            if fabsf(distance) <= near {
                layers.near += 1;
            } else if distance > 0.0 && distance <= beside {
                layers.beside += 1;
            } else if distance < beyond {
                layers.beyond += 1;
                if f64::from(layers.beyond) > limit {
                    return None;
                }
            }
        }
        Some(layers)
    }

    /// The normal of the plane through black that is nearest to the colors near this one.
    fn fitted(&self, normal: [f32; 3]) -> [f64; 3] {
        let mut scatter: Mat3 = [[0.0; 3]; 3];
        for &color in self.colors.iter().filter(|&&color| fabsf(distance(normal, color)) <= NEAR * self.noise)
        {
            let color = color.map(f64::from);
            for (row, a) in scatter.iter_mut().zip(color) {
                for (entry, b) in row.iter_mut().zip(color) {
                    *entry += a * b;
                }
            }
        }
        let [.., least] = mat3::symmetric_eigen(&scatter).vectors;
        least
    }

    /// The face, with the margin that the noise on its other side asks for.
    fn face(&self, normal: [f32; 3]) -> Face {
        let (mut squares, mut count) = (0.0, 0);
        for &color in self.colors.iter() {
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
