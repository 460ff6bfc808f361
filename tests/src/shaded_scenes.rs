//! Small pictures rendered from a depth function under any number of lights, with the shadows on what is turned away from
//! them. Shares no code with the core.

use ofc_core::picture::{Image, Order, Sample};

/// A 3x3 matrix, row-major.
pub type Matrix = [[f64; 3]; 3];

/// Directions (slant, tilt) in degrees and colors r, g, b of distant lights.
pub type Light = ([f64; 2], [f64; 3]);

/// The lights of the paper's section 4, with the misprint of Table 1 corrected.
pub const PAPER: [Light; 3] = [
    ([60.0, 20.0], [59.0, 7.0, 32.0]),
    ([40.0, 160.0], [13.0, 51.0, 43.0]),
    ([50.0, -110.0], [55.0, 49.0, 40.0]),
];

/// Three lights of clean colors, not far from the camera, as in the paper's section 5.
pub const CLEAN: [Light; 3] = [
    ([30.0, 80.0], [150.0, 30.0, 20.0]),
    ([28.0, -40.0], [25.0, 150.0, 30.0]),
    ([32.0, -160.0], [20.0, 35.0, 150.0]),
];

/// The lights of the second sphere: other colors from other directions.
pub const OTHER: [Light; 3] = [
    ([25.0, 10.0], [90.0, 20.0, 70.0]),
    ([35.0, 130.0], [20.0, 95.0, 15.0]),
    ([30.0, -100.0], [15.0, 10.0, 80.0]),
];

/// A rendered picture and its truth.
pub struct Scene {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// r, g, b of every pixel; zero where there is no surface.
    pub colors: Vec<[f64; 3]>,
    /// 255 where there is a surface.
    pub mask: Vec<u8>,
    /// Unit normals, zero where there is no surface.
    pub normals: Vec<[f64; 3]>,
    /// rho = F n where all lights are seen.
    pub f: Matrix,
    bytes: Vec<u8>,
    sample: Sample,
}

/// The unit vector at a slant and a tilt in degrees.
#[must_use]
pub fn direction([slant, tilt]: [f64; 2]) -> [f64; 3] {
    let (s, t) = (slant.to_radians(), tilt.to_radians());
    [s.sin() * t.cos(), s.sin() * t.sin(), s.cos()]
}

/// F = B A.
#[must_use]
pub fn color_orientation(lights: &[Light]) -> Matrix {
    let mut f = [[0.0; 3]; 3];
    for (angles, color) in lights {
        let a = direction(*angles);
        for (row, b) in f.iter_mut().zip(color) {
            for (entry, component) in row.iter_mut().zip(a) {
                *entry += b * component;
            }
        }
    }
    f
}

/// The dot product.
#[must_use]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Scene {
    /// Renders depth z(x, y), x and y in pixels from the middle of the picture with y up; `None` is background. A light
    /// below a pixel's horizon does not reach it. Values are f32.
    #[must_use]
    pub fn new(
        width: usize,
        height: usize,
        lights: &[Light],
        depth: impl Fn(f64, f64) -> Option<f64>,
    ) -> Self {
        let mut colors = vec![[0.0; 3]; width * height];
        let mut normals = colors.clone();
        let mut mask = vec![0; width * height];
        for row in 0..height {
            for column in 0..width {
                let x = column as f64 + 0.5 - width as f64 / 2.0;
                let y = height as f64 / 2.0 - row as f64 - 0.5;
                let h = 1e-4;
                let around = (depth(x + h, y), depth(x - h, y), depth(x, y + h), depth(x, y - h));
                let (Some(e), Some(w), Some(n), Some(s)) = around else { continue };
                let (p, q) = ((e - w) / (2.0 * h), (n - s) / (2.0 * h));
                let length = (1.0 + p * p + q * q).sqrt();
                let normal = [-p / length, -q / length, 1.0 / length];
                let at = row * width + column;
                normals[at] = normal;
                mask[at] = 255;
                for (angles, color) in lights {
                    let shading = dot(direction(*angles), normal).max(0.0);
                    for (value, b) in colors[at].iter_mut().zip(color) {
                        *value += b * shading;
                    }
                }
            }
        }
        let f = color_orientation(lights);
        let mut scene =
            Self { width, height, colors, mask, normals, f, bytes: Vec::new(), sample: Sample::F32 };
        scene.store(Sample::F32);
        scene
    }

    /// Adds normal noise of this deviation to every value of the surface.
    #[must_use]
    pub fn with_noise(mut self, deviation: f64, seed: u64) -> Self {
        let mut state = seed.wrapping_mul(2).wrapping_add(0x1234_5678_9abc_def1);
        let mut uniform = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for (color, mask) in self.colors.iter_mut().zip(&self.mask) {
            for value in color {
                if *mask > 0 {
                    let gauss =
                        (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
                    *value += deviation * gauss;
                }
            }
        }
        self.store(self.sample);
        self
    }

    /// Puts the surface of another scene of the same size in front of this one.
    #[must_use]
    pub fn behind(mut self, other: &Self) -> Self {
        for (at, &mask) in other.mask.iter().enumerate() {
            if mask > 0 {
                self.colors[at] = other.colors[at];
                self.normals[at] = other.normals[at];
                self.mask[at] = mask;
            }
        }
        self.store(self.sample);
        self
    }

    /// Rounds to 8 bits.
    #[must_use]
    pub fn quantized(mut self) -> Self {
        self.store(Sample::U8);
        self
    }

    fn store(&mut self, sample: Sample) {
        self.sample = sample;
        self.bytes = match sample {
            Sample::U8 => {
                // Negative values become zero, as `as` has it.
                #[allow(clippy::cast_sign_loss)]
                self.colors.iter().flatten().map(|value| value.round() as u8).collect()
            }
            _ => self.colors.iter().flatten().flat_map(|value| (*value as f32).to_ne_bytes()).collect(),
        };
    }

    /// The picture, restricted to its surface.
    ///
    /// # Panics
    /// Never: the sizes agree.
    #[must_use]
    pub fn image(&self) -> Image<'_> {
        self.whole().with_mask(&self.mask, self.width).expect("sizes agree")
    }

    /// The picture with its background.
    ///
    /// # Panics
    /// Never: the sizes agree.
    #[must_use]
    pub fn whole(&self) -> Image<'_> {
        let stride = self.width * 3 * self.sample.bytes();
        Image::interleaved(&self.bytes, self.width, self.height, stride, self.sample, Order::Rgb)
            .expect("sizes agree")
    }
}

/// A spherical cap of this radius that is `rim` pixels wide.
pub fn cap(radius: f64, rim: f64) -> impl Fn(f64, f64) -> Option<f64> {
    move |x, y| {
        let square = x * x + y * y;
        (square <= rim * rim && square < radius * radius).then(|| (radius * radius - square).sqrt())
    }
}

/// The same surface with its middle at (x, y).
pub fn moved(depth: impl Fn(f64, f64) -> Option<f64>, to: [f64; 2]) -> impl Fn(f64, f64) -> Option<f64> {
    move |x, y| depth(x - to[0], y - to[1])
}

/// A smooth closed bump without symmetry: a lopsided dome with a second, smaller one on its flank.
pub fn lopsided(size: f64) -> impl Fn(f64, f64) -> Option<f64> {
    move |x, y| {
        let (u, v) = (x / size, y / size);
        let dome = (1.0 - 0.9 * u * u - 0.3 * u * v - 1.2 * v * v) * (1.0 + 0.25 * u - 0.2 * v);
        let flank = 0.12 * (-((u - 0.35).powi(2) + (v + 0.3).powi(2)) / 0.08).exp();
        (u * u + v * v <= 0.8).then_some(0.28 * size * (dome + flank))
    }
}

/// The median angle, in degrees, between the true normals and those that `f_inverse` makes, over the surface.
#[must_use]
pub fn median_error(scene: &Scene, f_inverse: &Matrix) -> f64 {
    let mut errors: Vec<f64> = scene
        .colors
        .iter()
        .zip(&scene.normals)
        .zip(&scene.mask)
        .filter(|&(_, &mask)| mask > 0)
        .map(|((&color, &truth), _)| {
            let n = f_inverse.map(|row| dot(row, color));
            (dot(n, truth) / dot(n, n).sqrt()).clamp(-1.0, 1.0).acos().to_degrees()
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN)
}
