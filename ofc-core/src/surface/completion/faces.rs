//! Directions of lights, from the shadows that they leave.
//!
//! In raw normals v = F^-1 rho a pixel in the shadow of light i has `a_i . v` = 0: the shadow's colors lie in a plane through black
//! that all other colors are above, and the normal of this plane is the light's direction. Such planes are looked for among means
//! over windows, which shows them where single colors are too noisy.
//!
//! # Reference
//! M. A. Fischler, R. C. Bolles, "Random sample consensus", Commun. ACM 24, 1981. `docs/whole-surface.md`.

use super::class::mean_around;
use super::histogram::Histogram;
use super::map::{Map, Vectors};
use super::vector::{Matrix, Vector, ZERO, add, cross, dot, length, scale, transposed, unit};
use crate::color::second_moments::SecondMoments;
use crate::math::mat3;
use crate::math::rng::Rng;

// As in color/shadows.rs: multiples of the noise or shares of the colors; those that no formula gives were chosen on rendered scenes
// and photographs.

/// Means that are looked at.
const SAMPLE: usize = 3000;
/// A mean is over the window of `2 RADIUS + 1` pixels a side.
const RADIUS: usize = 2;
/// The noise of such a mean is that of a pixel, divided by this: neighbors share some.
const AVERAGING: f32 = 3.5;
/// Of so many means one is looked at before all are.
const GLANCE: usize = 4;
/// Planes through two means that are tried for each face.
const TRIALS: usize = 1500;
/// Means within this many deviations of the noise lie in the plane.
const NEAR: f32 = 2.0;
/// Means up to so many deviations above the plane say how dense they are where there is no face.
const BESIDE: f32 = 10.0;
/// Means this many deviations below the plane are on the wrong side.
const BEYOND: f32 = 3.0;
/// At most this share is.
const MAX_BEYOND: f32 = 0.015;
/// The same while a plane is being fitted.
const MAX_BEYOND_AT_FIRST: f32 = 2.0 * MAX_BEYOND;
/// At least this share of all means lies in a face, beyond those that would by the density beside it.
const SMALLEST_SHARE: f32 = 0.006;
/// At least so many times as many lie in a face as would by that density.
const CONCENTRATION: f32 = 1.6;
/// At least this share of a face's means are outliers of the ellipsoid: a cylinder makes a plane too, whose colors obey the model.
const SMALLEST_OUTLIERS: f32 = 0.08;
/// Means below so many deviations above a face belong to it when the next one is looked for.
const MARGIN: f32 = 2.5;
/// Times that a plane is fitted to the means near it.
const ROUNDS: usize = 4;
/// The median of the absolute values of normally distributed numbers of deviation 1.
const MEDIAN_OF_NORMAL: f32 = 0.674_5;
/// Fewer means than this show nothing.
const FEWEST: usize = 50;

/// Means over windows all over the mask.
pub(super) struct Means<'w> {
    /// Those off the unit sphere first.
    colors: &'w mut [Vector],
    outliers: usize,
    root: Matrix,
}

impl<'w> Means<'w> {
    /// `root` is such that v has the noise `root` times that of the colors; `room` holds the means.
    pub fn gather(
        raw: &Vectors,
        classes: &Map<u8>,
        masked: usize,
        root: &Matrix,
        room: &'w mut [f32],
    ) -> Self {
        let (room, _) = room.as_chunks_mut::<3>();
        let count = room.len().min(SAMPLE);
        let colors = room.get_mut(..count).unwrap_or_default();
        let root = root.map(|row| scale(row, 1.0 / AVERAGING));
        let (front, back) = gather(raw, classes, masked, &root, colors);
        // What was found last is moved behind what was found first.
        let last = colors.len();
        for (k, i) in (back..last).enumerate() {
            exchange(colors, front + k, i);
        }
        let colors = colors.get_mut(..front + (last - back)).unwrap_or_default();
        Self { colors, outliers: front, root }
    }

    /// The part of a pixel's noise that means keep: what they say of lengths that should be 1. Noise of the camera leaves a fifth; on
    /// photographs most of what is taken for noise is what the model does not explain, and stays.
    pub fn noise_left(&self) -> f32 {
        let mut parts = Histogram::over(0.0, 1.0);
        for &mean in self.colors.iter().skip(self.outliers) {
            let deviation = AVERAGING * length(transposed(&self.root, unit(mean)));
            parts.add((length(mean) - 1.0).abs() / deviation.max(1e-12));
        }
        parts.median().unwrap_or(0.0) / MEDIAN_OF_NORMAL
    }

    /// The directions of at most three lights, whose shadows are in the picture.
    pub fn directions(self, seed: u64) -> [Option<Vector>; 3] {
        let Self { colors, outliers, root } = self;
        let sum = colors.iter().fold(ZERO, |sum, &v| add(sum, 1.0, v));
        Search { live: colors.len(), outliers, all: colors.len(), colors, sum, root }.faces(seed)
    }
}

/// Means of whole windows all over the mask: outliers of the unit sphere from the front, the others from the back.
fn gather(
    raw: &Vectors,
    classes: &Map<u8>,
    masked: usize,
    root: &Matrix,
    colors: &mut [Vector],
) -> (usize, usize) {
    let stride = 1 + masked.checked_div(colors.len()).unwrap_or(0);
    let (mut front, mut back, mut number) = (0, colors.len(), 0_usize);
    let height = classes.data.len().div_ceil(classes.row_stride.max(1));
    for y in 0..height {
        for (x, &byte) in classes.row(y).iter().enumerate() {
            if byte == 0 {
                continue;
            }
            number += 1;
            // Every row begins elsewhere.
            if !(number + 7 * y).is_multiple_of(stride) || front >= back || !is_whole(raw, classes, [x, y]) {
                continue;
            }
            let Some(mean) = mean_around(raw, classes, [x, y], RADIUS, |byte| byte != 0) else { continue };
            let deviation = AVERAGING * length(transposed(root, unit(mean)));
            let slot = if (length(mean) - 1.0).abs() < deviation {
                back -= 1;
                back
            } else {
                front += 1;
                front - 1
            };
            if let Some(slot) = colors.get_mut(slot) {
                *slot = mean;
            }
        }
    }
    (front, back)
}

/// Whether all pixels of the window are known.
fn is_whole(raw: &Vectors, classes: &Map<u8>, [x, y]: [usize; 2]) -> bool {
    let (Some(left), Some(top)) = (x.checked_sub(RADIUS), y.checked_sub(RADIUS)) else { return false };
    (top..=y + RADIUS).all(|y| {
        let bytes = classes.row(y).get(left..=x + RADIUS).unwrap_or_default();
        let row = raw.row(y).get(left..=x + RADIUS).unwrap_or_default();
        !bytes.is_empty() && bytes.iter().zip(row).all(|(&byte, [first, ..])| byte != 0 && !first.is_nan())
    })
}

/// Exchanges two of the means; `swap` of slices can panic.
fn exchange(colors: &mut [Vector], i: usize, j: usize) {
    let (Some(&a), Some(&b)) = (colors.get(i), colors.get(j)) else { return };
    for (place, value) in [(i, b), (j, a)] {
        if let Some(slot) = colors.get_mut(place) {
            *slot = value;
        }
    }
}

/// How means lie about a plane.
#[derive(Clone, Copy, Default)]
struct Layers {
    near: f32,
    beside: f32,
}

impl Layers {
    /// How many would be near the plane by the density beside it.
    fn expected(self) -> f32 {
        self.beside * (2.0 * NEAR / (BESIDE - NEAR))
    }

    fn gain(self) -> f32 {
        self.near - self.expected()
    }
}

/// Means, of which the first `live` lie in no face so far; of these, the first `outliers` are off the unit sphere.
struct Search<'w> {
    colors: &'w mut [Vector],
    live: usize,
    outliers: usize,
    all: usize,
    sum: Vector,
    root: Matrix,
}

impl Search<'_> {
    fn faces(mut self, seed: u64) -> [Option<Vector>; 3] {
        let mut rng = Rng::new(seed);
        let mut faces = [None; 3];
        for face in &mut faces {
            if self.live < FEWEST {
                break;
            }
            let Some((layers, normal)) = self.best(&mut rng) else { break };
            let is_face = layers.gain() >= SMALLEST_SHARE * self.all as f32
                && layers.near >= CONCENTRATION * layers.expected();
            if !is_face {
                break;
            }
            let deviation = self.deviation(normal);
            let is_near = |v: &Vector| dot(normal, *v).abs() <= NEAR * deviation;
            let outliers = self.colors.iter().take(self.outliers).filter(|v| is_near(v)).count();
            if (outliers as f32) < SMALLEST_OUTLIERS * layers.near {
                self.keep(|v| !is_near(&v));
                continue;
            }
            *face = Some(normal);
            self.keep(|v| dot(normal, v) > MARGIN * deviation);
        }
        faces
    }

    /// Moves the live means that do not `stay` behind those that do.
    fn keep(&mut self, stay: impl Fn(Vector) -> bool) {
        let (mut live, mut outliers) = (0, 0);
        for i in 0..self.live {
            let Some(&v) = self.colors.get(i) else { break };
            if stay(v) {
                exchange(self.colors, i, live);
                live += 1;
                outliers += usize::from(i < self.outliers);
            }
        }
        (self.live, self.outliers) = (live, outliers);
    }

    /// The noise of means along a direction.
    fn deviation(&self, direction: Vector) -> f32 {
        length(transposed(&self.root, direction))
    }

    fn best(&self, rng: &mut Rng) -> Option<(Layers, Vector)> {
        let mut best: Option<(Layers, Vector)> = None;
        for trial in 0..TRIALS {
            let from = if trial % 2 == 0 && self.outliers > 20 { self.outliers } else { self.live };
            let Some(pair) = rng.distinct::<2>(from as u32) else { continue };
            let [a, b] = pair.map(|i| self.colors.get(i as usize).copied().unwrap_or(ZERO));
            let Some(normal) = self.inward(cross(a, b)) else { continue };
            let most = best.map_or(0.0, |(layers, _)| layers.gain());
            let Some(glance) = self.glance(normal) else { continue };
            if glance <= 0.25 * most {
                continue;
            }
            let Some(layers) = self.layers(normal, self.live, MAX_BEYOND_AT_FIRST) else { continue };
            if layers.gain() <= 0.5 * most {
                continue;
            }
            if let Some((layers, normal)) = self.settled(normal, 0.7 * most)
                && layers.gain() > most
            {
                best = Some((layers, normal));
            }
        }
        best
    }

    /// The plane fitted to the means near it, if few are on its wrong side and its gain after one round is above this.
    fn settled(&self, normal: Vector, least: f32) -> Option<(Layers, Vector)> {
        let mut normal = normal;
        for round in 0..ROUNDS {
            if round == 1 && self.layers(normal, self.live, 1.0)?.gain() <= least {
                return None;
            }
            let near = NEAR * self.deviation(normal);
            let mut moments = SecondMoments::default();
            for &v in self.colors.iter().take(self.live).filter(|v| dot(normal, **v).abs() <= near) {
                moments.add(v.map(f64::from));
            }
            let [.., least] = mat3::symmetric_eigen(&moments.sum()).vectors;
            normal = self.inward(least.map(|x| x as f32))?;
        }
        let _ = self.layers(normal, self.all, MAX_BEYOND)?;
        Some((self.layers(normal, self.live, 1.0)?, normal))
    }

    /// The direction or its opposite, so that most means lie on its side; `None` for none.
    fn inward(&self, direction: Vector) -> Option<Vector> {
        let length = length(direction);
        if !(length > 1e-3 && length.is_finite()) {
            return None;
        }
        let sign = if dot(direction, self.sum) < 0.0 { -1.0 } else { 1.0 };
        Some(scale(direction, sign / length))
    }

    /// The gain of a plane as one of [`GLANCE`] live means has it, `None` where far too many are beyond it.
    fn glance(&self, normal: Vector) -> Option<f32> {
        let (groups, _) = self.colors.get(..self.live)?.as_chunks::<GLANCE>();
        let some = groups.iter().filter_map(|group| group.first());
        let limit = 2.0 * MAX_BEYOND_AT_FIRST * groups.len() as f32 + 3.0;
        let layers = layers(some, normal, self.deviation(normal), limit)?;
        Some(GLANCE as f32 * layers.gain())
    }

    /// How the first `count` means lie about a plane; `None` where more than this share are beyond it.
    fn layers(&self, normal: Vector, count: usize, share: f32) -> Option<Layers> {
        layers(self.colors.iter().take(count), normal, self.deviation(normal), share * count as f32)
    }
}

/// How means lie about a plane; `None` where more than `limit` are beyond it.
fn layers<'a>(
    means: impl Iterator<Item = &'a Vector>,
    normal: Vector,
    deviation: f32,
    limit: f32,
) -> Option<Layers> {
    let mut beyond = 0.0;
    let mut layers = Layers::default();
    for &v in means {
        let distance = dot(normal, v);
        if distance.abs() <= NEAR * deviation {
            layers.near += 1.0;
        } else if distance > 0.0 && distance <= BESIDE * deviation {
            layers.beside += 1.0;
        } else if distance < -BEYOND * deviation {
            beyond += 1.0;
            if beyond > limit {
                return None;
            }
        }
    }
    Some(layers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_of_colors_are_found_and_nothing_else_is() {
        let direction = unit([0.5, -0.3, 0.8]);
        let mut rng = Rng::new(3);
        let mut colors: std::vec::Vec<Vector> = (0..1200)
            .map(|i| {
                let [a, b] = rng.normal_pair().map(|x| x as f32);
                let n = unit([0.5 * a, 0.5 * b, 1.0]);
                let cosine = dot(direction, n);
                // Outliers first: one in four is in the shadow of the light.
                if i < 300 { add(n, -cosine, direction) } else { n }
            })
            .filter(|v| v.iter().all(|x| x.is_finite()))
            .collect();
        let sum = colors.iter().fold(ZERO, |sum, &v| add(sum, 1.0, v));
        let root = [[1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0], [0.0, 0.0, 1e-3]];
        let all = colors.len();
        // Of unshaded colors some lie beyond the light's horizon, which no light of a picture allows: they are few here.
        let search = |colors| Search { colors, live: all, outliers: 300, all, sum, root };
        colors.retain(|v| dot(direction, *v) > -1e-3);
        let all = colors.len();
        let found = Search { live: all, all, ..search(&mut colors) }.faces(0);
        let face = found[0].unwrap();
        assert!(dot(face, direction) > 0.9999, "{face:?}");
        assert_eq!(found[1], None);
    }
}
