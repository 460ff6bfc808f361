//! Depth maps of analytic surfaces, and the lights of the paper's section 4.
//!
//! All have pitch 1: depths are in pixels. Inside, a surface is a function of (u, v), x right and y up in units of half
//! the shorter side, so that its slopes do not depend on the picture's size.

use ofc_core::render::DepthMap;

/// Degrees (slant, tilt) of the three lights of section 4.
pub const TABLE_1_LIGHTS: [[f64; 2]; 3] = [[60.0, 20.0], [40.0, 160.0], [50.0, -110.0]];

/// The colors of the three lights, B of eq. 6: a row a channel, a column a light. The paper prints 50 for the last
/// entry; 40 is what reproduces its Table 1.
pub const TABLE_1_COLORS: [f64; 9] = [59.0, 13.0, 55.0, 7.0, 51.0, 49.0, 32.0, 43.0, 40.0];

/// The unit vector at a slant and tilt in degrees.
#[must_use]
pub fn direction([slant, tilt]: [f64; 2]) -> [f64; 3] {
    let (slant, tilt) = (slant.to_radians(), tilt.to_radians());
    [slant.sin() * tilt.cos(), slant.sin() * tilt.sin(), slant.cos()]
}

/// The directions of the lights of section 4, A of eq. 6: a row a light.
#[must_use]
pub fn table_1_directions() -> [f64; 9] {
    let mut a = [0.0; 9];
    for (row, light) in a.as_chunks_mut().0.iter_mut().zip(TABLE_1_LIGHTS) {
        *row = direction(light);
    }
    a
}

/// A depth map and where its object is.
#[derive(Clone, Debug)]
pub struct Relief {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Tight rows, 0 outside the mask.
    pub depth: Vec<f32>,
    /// 255 on the object.
    pub mask: Vec<u8>,
}

impl Relief {
    /// Samples z(u, v) at the pixels' centers; `None` is outside the object.
    #[must_use]
    pub fn sample(width: usize, height: usize, z: impl Fn(f64, f64) -> Option<f64>) -> Self {
        let half = 0.5 * width.min(height) as f64;
        let (mut depth, mut mask) = (Vec::new(), Vec::new());
        for row in 0..height {
            for column in 0..width {
                let u = (column as f64 + 0.5 - 0.5 * width as f64) / half;
                let v = (0.5 * height as f64 - 0.5 - row as f64) / half;
                let z = z(u, v);
                depth.push((z.unwrap_or(0.0) * half) as f32);
                mask.push(if z.is_some() { 255 } else { 0 });
            }
        }
        Self { width, height, depth, mask }
    }

    /// The depths as bytes in the machine's order.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        self.depth.iter().flat_map(|z| z.to_ne_bytes()).collect()
    }

    /// The core's view of `bytes` as this scene's depths, with its mask.
    ///
    /// # Panics
    /// When `bytes` are not [`Relief::bytes`].
    #[must_use]
    pub fn view<'a>(&'a self, bytes: &'a [u8]) -> DepthMap<'a> {
        DepthMap::new(bytes, self.width, self.height, self.width * 4, 1.0)
            .expect("the scene's own sizes")
            .with_mask(&self.mask, self.width)
            .expect("the scene's own mask")
    }
}

fn gaussian(u: f64, v: f64, center: [f64; 2], width: [f64; 2]) -> f64 {
    let (x, y) = ((u - center[0]) / width[0], (v - center[1]) / width[1]);
    (-x * x - y * y).exp()
}

/// The front half of a sphere of `radius` (in half sides), as far as its slant is at most `slant` degrees.
#[must_use]
pub fn sphere(width: usize, height: usize, radius: f64, slant: f64) -> Relief {
    let edge = radius * slant.to_radians().sin();
    Relief::sample(width, height, |u, v| {
        let squared = u * u + v * v;
        (squared <= edge * edge && squared < radius * radius).then(|| (radius * radius - squared).sqrt())
    })
}

/// An egg: an ellipsoid whose lower end is blunter.
#[must_use]
pub fn egg(width: usize, height: usize) -> Relief {
    Relief::sample(width, height, |u, v| {
        let girth = 0.62 * (1.0 - 0.16 * v);
        let left = 1.0 - (u / girth).powi(2) - (v / 0.86).powi(2);
        (left > 0.03).then(|| girth * left.sqrt())
    })
}

/// A Gaussian bump on a plane that fills the picture.
#[must_use]
pub fn bump(width: usize, height: usize) -> Relief {
    Relief::sample(width, height, |u, v| Some(0.45 * gaussian(u, v, [0.0; 2], [0.5; 2])))
}

/// MATLAB's `peaks`: hills and hollows.
#[must_use]
pub fn peaks(width: usize, height: usize) -> Relief {
    Relief::sample(width, height, |u, v| {
        let (x, y) = (3.0 * u, 3.0 * v);
        let first = 3.0 * (1.0 - x).powi(2) * (-x * x - (y + 1.0).powi(2)).exp();
        let second = -10.0 * (x / 5.0 - x.powi(3) - y.powi(5)) * (-x * x - y * y).exp();
        let third = -(-(x + 1.0).powi(2) - y * y).exp() / 3.0;
        Some(0.04 * (first + second + third))
    })
}

/// A vase: a surface of revolution about the vertical axis.
#[must_use]
pub fn vase(width: usize, height: usize) -> Relief {
    Relief::sample(width, height, |u, v| {
        let radius = 0.42 + 0.16 * (2.6 * v + 0.9).sin() - 0.05 * v;
        (v.abs() < 0.9 && u.abs() < 0.97 * radius).then(|| (radius * radius - u * u).sqrt())
    })
}

/// Rolling ground that fills the picture: waves of many directions, shorter ones lower.
#[must_use]
pub fn terrain(width: usize, height: usize) -> Relief {
    Relief::sample(width, height, |u, v| {
        let mut z = 0.0;
        for wave in 0..12 {
            let wave = f64::from(wave);
            // The golden angle spreads the directions.
            let (angle, frequency) = (wave * 2.399_963, 2.0 + wave);
            z += 0.3 / frequency * (frequency * (u * angle.cos() + v * angle.sin()) + 1.7 * wave).sin();
        }
        Some(z)
    })
}

/// The larger of two heights, rounded where they are closer than `radius`.
fn blend(a: f64, b: f64, radius: f64) -> f64 {
    0.5 * (a + b + ((a - b).powi(2) + radius * radius).sqrt())
}

/// The height of an ellipsoid's front; where it gets too steep it goes on along its tangent.
fn ellipsoid(u: f64, v: f64, center: [f64; 2], axes: [f64; 3]) -> f64 {
    const EDGE: f64 = 0.82;
    let squared = ((u - center[0]) / axes[0]).powi(2) + ((v - center[1]) / axes[1]).powi(2);
    let profile = if squared < EDGE {
        (1.0 - squared).sqrt()
    } else {
        let edge = (1.0 - EDGE).sqrt();
        // Linear in the distance, not its square: the slope stays what it is.
        edge - EDGE.sqrt() / edge * (squared.sqrt() - EDGE.sqrt())
    };
    axes[2] * profile
}

/// A bust in the manner of the paper's plaster Mozart: head with nose, brows, eyes, mouth and waved hair, neck and
/// shoulders. Smooth inside its mask.
#[must_use]
pub fn bust(width: usize, height: usize) -> Relief {
    Relief::sample(width, height, bust_height)
}

fn bust_height(u: f64, v: f64) -> Option<f64> {
    let hair_volume = blend(
        ellipsoid(u, v, [0.0, 0.44], [0.46, 0.47, 0.30]),
        blend(
            ellipsoid(u, v, [-0.37, 0.16], [0.16, 0.34, 0.17]),
            ellipsoid(u, v, [0.37, 0.16], [0.16, 0.34, 0.17]),
            0.02,
        ),
        0.06,
    );
    let waves = 0.011 * (24.0 * (side(u) + 0.35 * v) + 2.0 * (5.0 * v).sin()).sin() * (1.0 + (7.0 * v).cos());
    let face = ellipsoid(u, v, [0.0, 0.22], [0.35, 0.50, 0.44]) + features(u, v);
    let head = blend(face, hair_volume + waves, 0.05);
    let neck = ellipsoid(u, v, [0.0, -0.38], [0.20, 0.42, 0.20]);
    let shoulders = ellipsoid(u, v, [0.0, -1.12], [0.88, 0.68, 0.34]);
    let chest = 0.03 * gaussian(u, v, [0.0, -0.75], [0.10, 0.25]);
    let body = blend(neck, shoulders + chest, 0.10);
    let z = blend(head, body, 0.06);
    (z > 0.0).then_some(z)
}

/// The distance from the axis, smooth at the axis itself: both halves of a bust are alike.
fn side(u: f64) -> f64 {
    u.hypot(0.03)
}

/// What a face has beyond an ellipsoid.
fn features(u: f64, v: f64) -> f64 {
    let side = side(u);
    let nose = 0.075 * gaussian(u, v, [0.0, 0.13], [0.050, 0.085])
        + 0.045 * gaussian(u, v, [0.0, 0.24], [0.038, 0.11])
        + 0.020
            * (gaussian(u, v, [0.055, 0.095], [0.03, 0.03]) + gaussian(u, v, [-0.055, 0.095], [0.03, 0.03]));
    let brows = 0.026 * gaussian(side, v, [0.13, 0.385], [0.10, 0.035]);
    let sockets = -0.045 * gaussian(side, v, [0.14, 0.30], [0.075, 0.05]);
    let eyes = 0.030 * gaussian(side, v, [0.14, 0.295], [0.040, 0.028]);
    let cheeks = 0.022 * gaussian(side, v, [0.17, 0.13], [0.09, 0.09]);
    let lips = 0.022 * gaussian(u, v, [0.0, -0.005], [0.075, 0.020])
        + 0.024 * gaussian(u, v, [0.0, -0.062], [0.065, 0.022])
        - 0.018 * gaussian(u, v, [0.0, -0.033], [0.085, 0.012]);
    let chin = 0.035 * gaussian(u, v, [0.0, -0.16], [0.08, 0.06]);
    nose + brows + sockets + eyes + cheeks + lips + chin
}
