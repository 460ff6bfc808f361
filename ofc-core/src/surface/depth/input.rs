//! What the caller hands in, and how a row of it becomes slopes and weights.

use crate::picture::{ImageError, span};
use libm::sqrtf;

/// Rows of a picture over borrowed numbers, checked once when made.
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a, T> {
    data: &'a [T],
    row: usize,
    row_stride: usize,
    width: usize,
    height: usize,
}

impl<'a, T> Plane<'a, T> {
    /// A view of `width` x `height` pixels of `channels` numbers each, rows `row_stride` numbers (not bytes) apart.
    ///
    /// # Errors
    /// What [`span`] refuses, and [`ImageError::TooShort`] when `data` ends before the last row does.
    pub fn new(
        data: &'a [T],
        width: usize,
        height: usize,
        channels: usize,
        row_stride: usize,
    ) -> Result<Self, ImageError> {
        let need = span(width, height, channels, row_stride)?;
        let data = data.get(..need).ok_or(ImageError::TooShort)?;
        Ok(Self { data, row: width * channels, row_stride, width, height })
    }

    pub(super) fn row(&self, y: usize) -> &'a [T] {
        let start = y * self.row_stride;
        self.data.get(start..start + self.row).unwrap_or_default()
    }

    fn fits(&self, width: usize, height: usize, channels: usize) -> bool {
        self.width == width && self.height == height && self.row == width * channels
    }
}

/// The orientation of every pixel.
#[derive(Clone, Copy, Debug)]
pub enum Slopes<'a> {
    /// Three numbers a pixel, x right, y up, z toward the camera, of any length.
    Normals(Plane<'a, f32>),
    /// p = dz/dx and q = dz/dy, y up.
    Gradients {
        /// dz/dx.
        p: Plane<'a, f32>,
        /// dz/dy.
        q: Plane<'a, f32>,
    },
}

/// Everything there is to integrate.
#[derive(Clone, Copy, Debug)]
pub struct DepthInput<'a> {
    /// Normals or gradients. A pixel whose normal is not finite or has no positive n3 is unusable.
    pub slopes: Slopes<'a>,
    /// Where depth is wanted: pixels that are not zero. `None` is the whole picture.
    pub mask: Option<Plane<'a, u8>>,
    /// How far to trust each pixel's slope, 1 by default. Zero, negative and non-finite make the pixel unusable;
    /// others are limited to [`WEIGHT_RANGE`].
    pub weights: Option<Plane<'a, f32>>,
    /// Known depths in the unit of the result, not finite where nothing is known.
    pub prior: Option<Plane<'a, f32>>,
}

/// Weights beyond this contrast are brought into it.
pub const WEIGHT_RANGE: [f32; 2] = [1e-4, 1e4];

/// The squares of the shortest and longest normals whose squares f32 holds well.
const SQUARES: [f32; 2] = [1e-30, 1e30];

/// A row of slopes to fill in.
pub(super) struct SlopeRow<'a> {
    pub p: &'a mut [f32],
    pub q: &'a mut [f32],
    /// The root of the weight, zero where the pixel is unusable.
    pub root: &'a mut [f32],
}

impl DepthInput<'_> {
    /// Width and height.
    #[must_use]
    pub const fn size(&self) -> [usize; 2] {
        match &self.slopes {
            Slopes::Normals(plane) | Slopes::Gradients { p: plane, .. } => [plane.width, plane.height],
        }
    }

    /// Whether all planes have the same size and the right number of channels.
    pub(super) fn is_consistent(&self) -> bool {
        let [width, height] = self.size();
        let fits = |plane: &Option<Plane<f32>>| plane.is_none_or(|plane| plane.fits(width, height, 1));
        let slopes = match &self.slopes {
            Slopes::Normals(normals) => normals.fits(width, height, 3),
            Slopes::Gradients { p, q } => p.fits(width, height, 1) && q.fits(width, height, 1),
        };
        slopes
            && fits(&self.weights)
            && fits(&self.prior)
            && self.mask.is_none_or(|mask| mask.fits(width, height, 1))
    }

    /// Whether pixel `x` of row `y` is in the mask, as an iterator over a row.
    pub(super) fn masked(&self, y: usize) -> impl Iterator<Item = bool> {
        let row = self.mask.map(|mask| mask.row(y));
        (0..self.size()[0]).map(move |x| row.is_none_or(|row| row.get(x).is_some_and(|&m| m != 0)))
    }

    /// Fills in row `y`. Returns how many pixels are in the mask and how many of these are usable.
    pub(super) fn read(&self, y: usize, min_n3: f32, row: &mut SlopeRow) -> [usize; 2] {
        let again = match &self.slopes {
            Slopes::Normals(normals) => {
                let pixels = normals.row(y).as_chunks::<3>().0;
                convert(pixels.iter().copied(), min_n3, row)
            }
            Slopes::Gradients { p, q } => {
                let pixels = p.row(y).iter().zip(q.row(y));
                convert(pixels.map(|(&p, &q)| [-p, -q, 1.0]), min_n3, row)
            }
        };
        if again {
            self.convert_again(y, min_n3, row);
        }
        let width = row.root.len();
        let mut masked = width;
        if let Some(mask) = self.mask {
            masked = 0;
            let pixels = row.p.iter_mut().zip(row.q.iter_mut()).zip(row.root.iter_mut());
            for (((p, q), root), &inside) in pixels.zip(mask.row(y)) {
                let keep = inside != 0;
                masked += usize::from(keep);
                *root = if keep { *root } else { 0.0 };
                *p = if keep { *p } else { 0.0 };
                *q = if keep { *q } else { 0.0 };
            }
        }
        if let Some(weights) = self.weights {
            let [least, most] = WEIGHT_RANGE;
            let pixels = row.p.iter_mut().zip(row.q.iter_mut()).zip(row.root.iter_mut());
            for (((p, q), root), &weight) in pixels.zip(weights.row(y)) {
                let keep = weight > 0.0 && weight <= f32::MAX;
                let weight = if keep { weight.clamp(least, most) } else { 0.0 };
                *root *= sqrtf(weight);
                *p = if keep { *p } else { 0.0 };
                *q = if keep { *q } else { 0.0 };
            }
        }
        let usable: usize = row.root.iter().map(|&root| usize::from(root > 0.0)).sum();
        [masked, usable]
    }

    /// Does what [`convert`] leaves. Normals of row `y` that lean further than `min_n3` lose weight with the square of their
    /// n3, and their slope stops growing; the very long and short ones are scaled by their largest component.
    fn convert_again(&self, y: usize, min_n3: f32, row: &mut SlopeRow) {
        for x in 0..row.root.len() {
            let normal = match &self.slopes {
                Slopes::Normals(normals) => normals.row(y).as_chunks::<3>().0.get(x).copied(),
                Slopes::Gradients { p, q } => match (p.row(y).get(x), q.row(y).get(x)) {
                    (Some(&p), Some(&q)) => Some([-p, -q, 1.0]),
                    _ => None,
                },
            };
            let (Some(mut normal), Some(p), Some(q), Some(root)) =
                (normal, row.p.get_mut(x), row.q.get_mut(x), row.root.get_mut(x))
            else {
                return;
            };
            let [_, _, n3] = normal;
            let largest = normal.iter().fold(0.0, |largest: f32, n| largest.max(n.abs()));
            if *root == 0.0 && n3 > 0.0 && normal.iter().all(|n| n.is_finite()) {
                normal = normal.map(|n| n / largest);
                let [n1, n2, n3] = normal;
                (*p, *q, *root) = (-n1 / n3, -n2 / n3, 1.0);
            }
            let [n1, n2, n3] = normal;
            let squared = n1 * n1 + n2 * n2 + n3 * n3;
            if *root > 0.0 && n3 * n3 < min_n3 * min_n3 * squared {
                let scale = 1.0 / (min_n3 * sqrtf(squared));
                *p = -n1 * scale;
                *q = -n2 * scale;
                // At least the root of the least weight that there may be.
                *root = (n3 * scale).max(0.01);
            }
        }
    }
}

/// Slopes without mask and weights; returns whether a normal that faces the camera is left for a closer look.
#[inline(always)]
fn convert(pixels: impl Iterator<Item = [f32; 3]>, min_n3: f32, row: &mut SlopeRow) -> bool {
    let limit = min_n3 * min_n3;
    let [shortest, longest] = SQUARES;
    let mut again = false;
    let out = row.p.iter_mut().zip(row.q.iter_mut()).zip(row.root.iter_mut());
    for (((p, q), root), [n1, n2, n3]) in out.zip(pixels) {
        let squared = n1 * n1 + n2 * n2 + n3 * n3;
        let usable = n3 > 0.0 && squared > shortest && squared < longest;
        again |= n3 > 0.0 && !(usable && n3 * n3 >= limit * squared);
        let scale = -1.0 / n3;
        *p = if usable { n1 * scale } else { 0.0 };
        *q = if usable { n2 * scale } else { 0.0 };
        *root = if usable { 1.0 } else { 0.0 };
    }
    again
}
