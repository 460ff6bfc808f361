//! Surfaces with known depth, slopes and masks of every kind, and how to integrate them.

use crate::depth_oracle::{self, Field};
use crate::depth_workspace::Workspace;
use ofc_core::math::rng::Rng;
use ofc_core::surface::depth::{DepthError, DepthInput, DepthParams, DepthResult, Plane, Slopes, integrate};

/// A scene: truth, slopes and mask.
#[derive(Clone)]
pub struct Scene {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Depth of each pixel.
    pub truth: Vec<f64>,
    /// Three numbers a pixel.
    pub normals: Vec<f32>,
    /// 1 inside.
    pub mask: Vec<u8>,
}

/// Depth, p and q at a place in pixels from the middle, y up.
pub type Surface = fn(f64, f64) -> [f64; 3];

/// A paraboloid with a slope.
pub fn quadratic(x: f64, y: f64) -> [f64; 3] {
    let z = 0.001 * x * x - 0.0015 * x * y - 0.002 * y * y + 0.1 * x - 0.3 * y;
    [z, 0.002 * x - 0.0015 * y + 0.1, -0.0015 * x - 0.004 * y - 0.3]
}

/// Waves on a parabolic trough.
pub fn bumps(x: f64, y: f64) -> [f64; 3] {
    let (a, b) = (0.11, 0.07);
    let z = 4.0 * (a * x).sin() * (b * y).cos() + 0.002 * x * x;
    let p = 4.0 * a * (a * x).cos() * (b * y).cos() + 0.004 * x;
    [z, p, -4.0 * b * (a * x).sin() * (b * y).sin()]
}

fn gaussian(rng: &mut Rng) -> f64 {
    (-2.0 * (1.0 - rng.unit()).ln()).sqrt() * (std::f64::consts::TAU * rng.unit()).cos()
}

/// A scene of this surface, its normals with noise of this deviation in each component.
pub fn scene(size: [usize; 2], surface: Surface, noise: f64, inside: impl Fn(usize, usize) -> bool) -> Scene {
    let [width, height] = size;
    let mut rng = Rng::new(7);
    let mut scene = Scene { width, height, truth: vec![], normals: vec![], mask: vec![] };
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (x as f64 - (width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0 - y as f64);
            let [z, p, q] = surface(u, v);
            let length = (1.0 + p * p + q * q).sqrt();
            scene.truth.push(z);
            scene.normals.extend(
                [-p, -q, 1.0].map(|n| {
                    (n / length + if noise > 0.0 { noise * gaussian(&mut rng) } else { 0.0 }) as f32
                }),
            );
            scene.mask.push(u8::from(inside(x, y)));
        }
    }
    scene
}

/// Every pixel.
pub fn all(_: usize, _: usize) -> bool {
    true
}

/// A disc that nearly fills a square.
pub fn disc(size: usize) -> impl Fn(usize, usize) -> bool {
    let middle = (size - 1) as f64 / 2.0;
    move |x, y| (x as f64 - middle).hypot(y as f64 - middle) < 0.48 * size as f64
}

/// A disc cut in two but for a neck one pixel wide, with holes, an island in a hole, islands of one pixel, and a cut one
/// pixel wide that does not separate anything.
pub fn messy(size: usize) -> impl Fn(usize, usize) -> bool {
    let disc = disc(size);
    move |x, y| {
        let near = |cx: f64, cy: f64, r: f64| {
            (x as f64 - cx * size as f64).hypot(y as f64 - cy * size as f64) < r * size as f64
        };
        let wall = y == size / 2 || y == size / 2 + 1;
        let neck = x == size / 2;
        let hole = near(0.3, 0.25, 0.1) && !near(0.3, 0.25, 0.04);
        let cut = x == size / 3 && y > size * 6 / 10;
        let slant = x + 20 == y && y > size * 6 / 10 && y < size * 8 / 10;
        let island = (x, y) == (1, 1) || (x, y) == (size - 1, 0);
        island || disc(x, y) && !hole && !cut && !slant && (!wall || neck)
    }
}

impl Scene {
    /// Its normals and its mask.
    pub fn input(&self) -> DepthInput<'_> {
        let (w, h) = (self.width, self.height);
        DepthInput {
            slopes: Slopes::Normals(Plane::new(&self.normals, w, h, 3, 3 * w).unwrap()),
            mask: Some(Plane::new(&self.mask, w, h, 1, w).unwrap()),
            weights: None,
            prior: None,
        }
    }

    /// Its slopes for the oracle, of weight one in the mask.
    pub fn field(&self) -> Field {
        let slope = |k: usize| {
            self.normals.as_chunks::<3>().0.iter().map(|n| -f64::from(n[k]) / f64::from(n[2])).collect()
        };
        Field {
            width: self.width,
            height: self.height,
            p: slope(0),
            q: slope(1),
            weight: self.mask.iter().map(|&m| f64::from(m)).collect(),
        }
    }

    /// Its depth without the mean of every region.
    pub fn truth(&self) -> Vec<f64> {
        let field = self.field();
        depth_oracle::free_of_means(&field, self.truth.clone(), None, &vec![true; self.truth.len()])
    }
}

/// Integrates with a dirty workspace into a dirty depth.
///
/// # Errors
/// What [`integrate`] refuses.
pub fn run(input: &DepthInput, params: &DepthParams) -> Result<(Vec<f32>, DepthResult), DepthError> {
    let [width, height] = input.size();
    let mut workspace = Workspace::new(width, height, f32::NAN);
    let mut depth = vec![9.0; width * height];
    let result = integrate(input, params, workspace.arena(), &mut depth, width)?;
    Ok((depth, result))
}

/// The smallest tolerance.
pub fn precise() -> DepthParams {
    DepthParams { tolerance: 1e-6, ..DepthParams::default() }
}

/// Root mean square of the difference; both must be NaN at the same pixels.
pub fn distance(depth: &[f32], other: &[f64]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (&a, &b) in depth.iter().zip(other) {
        assert_eq!(a.is_nan(), b.is_nan());
        if !b.is_nan() {
            sum += (f64::from(a) - b) * (f64::from(a) - b);
            count += 1.0;
        }
    }
    f64::sqrt(sum / count)
}

/// Root mean square of what is not NaN.
pub fn rms(values: &[f64]) -> f64 {
    distance(&values.iter().map(|v| if v.is_nan() { f32::NAN } else { 0.0 }).collect::<Vec<_>>(), values)
}
