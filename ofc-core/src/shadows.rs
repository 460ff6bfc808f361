//! Colors that one of the lights does not reach.
//!
//! Three lights make colors that fill a cone, and where one of them is shaded the color is a sum of the other two: it lies
//! in a plane through black that is a face of the cone. Such colors are no outliers of the ellipsoid next to the border of
//! a shadow, where the missing light would be weak anyway, but their normals are wrong by as much as ten degrees. So the
//! faces are looked for, among what the ellipsoid does not explain, and all colors near them are left out.
//!
//! A plane is a face where nearly all colors lie on one side of it, many more within the noise than right beside it, and a
//! good part of these far from the ellipsoid: regular colors do not lie in planes, but those of two flat parts of a surface
//! may, and obey the model.
//!
//! # Reference
//! Section 2 (shadows are outliers). M. A. Fischler, R. C. Bolles, "Random sample consensus", Commun. ACM 24, 1981.

use crate::image::{Usable, Window, for_each_bit};
use crate::inliers::{Band, Inliers};
use crate::mat3::{self, Mat3};
use crate::pixels::Pixels;
use crate::rng::Rng;
use libm::{fabsf, sqrt};

/// At most one for each light.
pub const MAX_FACES: usize = 3;

/// Colors that are looked at.
const SAMPLE: usize = 1024;

/// Planes through two of them that are tried for each face.
const TRIALS: usize = 160;

/// Colors within this many deviations of the noise lie in the plane.
const NEAR: f32 = 2.0;
/// Right beside it lie those up to here.
const BESIDE: f32 = 10.0;
/// Beyond it lie those this far on the wrong side; no more than this share of all may.
const BEYOND: f32 = 3.0;
const MAX_BEYOND: f64 = 0.01;

/// At least this share of all colors lie in a face, at least so many times as many as would by the density beside it, and
/// at least this share of them are outliers.
const SMALLEST_SHARE: f64 = 0.02;
const CONCENTRATION: f64 = 2.0;
const SMALLEST_OUTLIERS: f64 = 0.2;

/// Fewer outliers than this have no shadows.
const SMALLEST_COUNT: usize = 16;

/// Colors within this many deviations of a face are left out.
const MARGIN: f32 = 3.0;

/// Noise is at least this share of the colors' root mean square.
const EXACT: f64 = 1e-5;

/// Times that a plane is fitted to the colors near it.
const ROUNDS: usize = 3;

/// A face: colors for which `normal . rho` is below `least` are shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Face {
    /// Of unit length; zero for none.
    pub normal: [f32; 3],
    /// In pixel values.
    pub least: f32,
}

/// The faces of the cone, as many as there are shadows of different lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shadows {
    /// Those that are not there are zero: every color is above them.
    pub faces: [Face; MAX_FACES],
}

impl Shadows {
    /// No shadows.
    pub const NONE: Self = Self { faces: [Face { normal: [0.0; 3], least: 0.0 }; MAX_FACES] };

    /// Whether there are any.
    #[must_use]
    pub fn any(&self) -> bool {
        *self != Self::NONE
    }

    /// Which of the window's colors `among` these all three lights reach.
    #[must_use]
    pub fn lit(&self, window: &Window, among: u64) -> u64 {
        let mut lit = among;
        for Face { normal: [x, y, z], least } in self.faces {
            if [x, y, z, least] != [0.0; 4] && lit != 0 {
                lit &= window.bits(|r, g, b| x * r + y * g + z * b >= least);
            }
        }
        lit
    }
}

/// The shadows in `pixels`, of which the `count` that are `usable` were fitted: `band` holds those near the ellipsoid, and
/// `noise` is the deviation of a channel.
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
) -> Shadows {
    let (room, _) = workspace.as_chunks_mut::<3>();
    let stride = count.div_ceil(room.len().clamp(1, SAMPLE)).max(1);
    let Some(colors) = room.get_mut(..count / stride) else { return Shadows::NONE };
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
        return Shadows::NONE;
    }
    let size: f64 = colors.as_flattened().iter().map(|&value| f64::from(value) * f64::from(value)).sum();
    let exact = EXACT * sqrt(size / colors.len().max(1) as f64);
    Search { colors, outliers: front, noise: noise.max(exact) as f32 }.faces(seed)
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
    near_outliers: u16,
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
        self.gain() >= SMALLEST_SHARE * all as f64
            && f64::from(self.near) >= CONCENTRATION * self.expected()
            && f64::from(self.near_outliers) >= SMALLEST_OUTLIERS * f64::from(self.near)
    }
}

impl Search<'_> {
    fn faces(mut self, seed: u64) -> Shadows {
        let mut rng = Rng::new(seed);
        let mut shadows = Shadows::NONE;
        // Planes go through outliers that lie in no other face.
        let mut free = self.outliers;
        for face in &mut shadows.faces {
            if free < SMALLEST_COUNT {
                break;
            }
            let Some(normal) = self.best(free, &mut rng) else { break };
            *face = self.face(normal);
            free = self.set_aside(free, normal);
        }
        shadows
    }

    /// The most concentrated plane through two of the first `free` colors, if it is a face.
    fn best(&self, free: usize, rng: &mut Rng) -> Option<[f32; 3]> {
        let mut best: Option<(f64, [f32; 3])> = None;
        for _ in 0..TRIALS {
            let [i, j] = rng.distinct::<2>(free as u32)?;
            let color = |i: u32| self.colors.get(i as usize).copied().unwrap_or_default().map(f64::from);
            let Some(normal) = self.inward(mat3::cross(color(i), color(j))) else { continue };
            if let Some(layers) = self.layers(normal)
                && best.is_none_or(|(most, _)| layers.gain() > most)
            {
                best = Some((layers.gain(), normal));
            }
        }
        let (_, mut normal) = best?;
        for _ in 0..ROUNDS {
            normal = self.inward(self.fitted(normal))?;
        }
        self.layers(normal)?.is_face(self.colors.len()).then_some(normal)
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

    /// How the colors lie about the plane; `None` where too many are beyond it.
    fn layers(&self, normal: [f32; 3]) -> Option<Layers> {
        let limit = MAX_BEYOND * self.colors.len() as f64;
        let (near, beside, beyond) = (NEAR * self.noise, BESIDE * self.noise, -BEYOND * self.noise);
        let mut layers = Layers::default();
        for (i, &color) in self.colors.iter().enumerate() {
            let distance = distance(normal, color);
            if fabsf(distance) <= near {
                layers.near += 1;
                layers.near_outliers += u16::from(i < self.outliers);
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

    /// Moves those of the first `free` colors that lie near the plane behind the others; how many stay.
    fn set_aside(&mut self, free: usize, normal: [f32; 3]) -> usize {
        let limit = BEYOND * self.noise;
        let mut stay = 0;
        for i in 0..free {
            let at = |i: usize| self.colors.get(i).copied().unwrap_or_default();
            let (color, other) = (at(i), at(stay));
            if fabsf(distance(normal, color)) > limit {
                for (place, value) in [(i, other), (stay, color)] {
                    if let Some(slot) = self.colors.get_mut(place) {
                        *slot = value;
                    }
                }
                stay += 1;
            }
        }
        stay
    }
}

fn distance([x, y, z]: [f32; 3], [r, g, b]: [f32; 3]) -> f32 {
    x * r + y * g + z * b
}
