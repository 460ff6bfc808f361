//! Rendered pictures with known normals that obey the model: rho = F n in f64, in any of the layouts that the core reads.

use crate::linear::{Matrix, apply, unit};
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Image, Order, Sample};

/// Table 1's color strengths: rows are channels, columns lights. The paper prints the last entry as 50, with which
/// none of its "Correct" rows come out (see DESIGN.md).
pub const TABLE_1_COLORS: Matrix = [[59.0, 13.0, 55.0], [7.0, 51.0, 49.0], [32.0, 43.0, 40.0]];

/// Table 1's light directions, one a row.
#[must_use]
pub fn table_1_lights() -> Matrix {
    [(60.0, 20.0), (40.0, 160.0), (50.0, -110.0)].map(|(slant, tilt)| direction(slant, tilt))
}

/// Table 1's F = B A.
#[must_use]
pub fn table_1_f() -> Matrix {
    crate::linear::multiply(TABLE_1_COLORS, table_1_lights())
}

/// The unit vector at a slant and a tilt in degrees.
#[must_use]
pub fn direction(slant: f64, tilt: f64) -> [f64; 3] {
    let (slant, tilt) = (slant.to_radians(), tilt.to_radians());
    [slant.sin() * tilt.cos(), slant.sin() * tilt.sin(), slant.cos()]
}

/// Three well separated lights, one a channel, that all of a cap of 40 degrees sees.
#[must_use]
pub fn three_lights() -> Matrix {
    let strong = |strength: f64, direction: [f64; 3]| direction.map(|component| component * strength);
    [
        strong(180.0, direction(35.0, 100.0)),
        strong(150.0, direction(42.0, -25.0)),
        strong(200.0, direction(38.0, -140.0)),
    ]
}

/// A normally distributed number with mean 0 and deviation 1, to the eye: the sum of twelve uniform ones.
pub fn normal(rng: &mut Rng) -> f64 {
    (0..12).map(|_| rng.unit()).sum::<f64>() - 6.0
}

/// A surface: the normal that the camera sees at (x, y), pixels from the middle of the picture with y up, or `None`
/// beside the surface.
pub trait Surface: Fn(f64, f64) -> Option<[f64; 3]> {}
impl<T: Fn(f64, f64) -> Option<[f64; 3]>> Surface for T {}

/// The cap of a sphere of that radius out to `angle` degrees from its pole.
#[must_use]
pub fn sphere(radius: f64, angle: f64) -> impl Surface {
    ellipsoid([radius; 3], angle)
}

/// An ellipsoid with these semi-axes along x, y and z, where its normal is at most `angle` degrees from z.
#[must_use]
pub fn ellipsoid([a, b, c]: [f64; 3], angle: f64) -> impl Surface {
    move |x, y| {
        let z = (1.0 - (x / a).powi(2) - (y / b).powi(2)).max(0.0).sqrt();
        let normal = unit([x / (a * a), y / (b * b), z / c]);
        (normal[2] > angle.to_radians().cos()).then_some(normal)
    }
}

/// z = -(c1 x^2 + c2 y^2) / 2 - c3 x y where its normal is at most `angle` degrees from z.
#[must_use]
pub fn paraboloid([c1, c2, c3]: [f64; 3], angle: f64) -> impl Surface {
    move |x, y| {
        let normal = unit([c1 * x + c3 * y, c2 * y + c3 * x, 1.0]);
        (normal[2] > angle.to_radians().cos()).then_some(normal)
    }
}

/// A cylinder of that radius, its axis in the picture's plane at `axis` degrees from x, out to `angle` degrees.
#[must_use]
pub fn cylinder(radius: f64, axis: f64, angle: f64) -> impl Surface {
    let (sin, cos) = axis.to_radians().sin_cos();
    move |x, y| {
        let across = (cos * y - sin * x) / radius;
        (across.abs() < angle.to_radians().sin())
            .then(|| [-sin * across, cos * across, (1.0 - across * across).sqrt()])
    }
}

/// A cone seen from above its tip, normals at `slant` degrees from z.
#[must_use]
pub fn cone(radius: f64, slant: f64) -> impl Surface {
    move |x, y| {
        let from_tip = x.hypot(y);
        (from_tip > 0.0 && from_tip < radius).then(|| direction(slant, y.atan2(x).to_degrees()))
    }
}

/// A plane with one normal everywhere.
#[must_use]
pub fn plane(normal: [f64; 3]) -> impl Surface {
    move |_, _| Some(normal)
}

/// A rendered picture.
#[derive(Clone)]
pub struct Scene {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Colors, row 0 at the top, black beside the surface.
    pub colors: Vec<[f64; 3]>,
    /// The truth, zero beside the surface.
    pub normals: Vec<[f64; 3]>,
}

impl Scene {
    /// `surface` under the color-orientation matrix `f`, without noise; shadows are black.
    pub fn render(width: usize, height: usize, f: Matrix, surface: impl Surface) -> Self {
        let (middle_x, middle_y) = (0.5 * (width - 1) as f64, 0.5 * (height - 1) as f64);
        let mut normals = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                normals.push(surface(column as f64 - middle_x, middle_y - row as f64).unwrap_or([0.0; 3]));
            }
        }
        let colors = normals.iter().map(|&n| apply(f, n).map(|c| c.max(0.0))).collect();
        Self { width, height, colors, normals }
    }

    /// Colors from a function of the column and row, and no normals.
    pub fn paint(width: usize, height: usize, mut color: impl FnMut(usize, usize) -> [f64; 3]) -> Self {
        let colors = (0..width * height).map(|i| color(i % width, i / width)).collect();
        Self { width, height, colors, normals: vec![[0.0; 3]; width * height] }
    }

    /// With normal noise of that deviation on every pixel that is not black, negative values cut off.
    #[must_use]
    pub fn with_noise(mut self, deviation: f64, rng: &mut Rng) -> Self {
        for color in self.colors.iter_mut().filter(|color| color.iter().any(|&c| c > 0.0)) {
            *color = color.map(|c| (c + deviation * normal(rng)).max(0.0));
        }
        self
    }

    /// Values rounded to whole numbers up to 254, as an 8-bit camera that does not saturate gives them.
    #[must_use]
    pub fn rounded(mut self) -> Self {
        for color in &mut self.colors {
            *color = color.map(|c| c.round().clamp(0.0, 254.0));
        }
        self
    }

    /// The same picture turned by a quarter, counter-clockwise; the truth is left behind.
    #[must_use]
    pub fn turned(&self) -> Self {
        let at = |column, row| self.colors[row * self.width + column];
        Self::paint(self.height, self.width, |column, row| at(self.width - 1 - row, column))
    }

    /// Interleaved RGB, f32, rows without gaps.
    #[must_use]
    pub fn encode(&self) -> Encoded {
        self.encode_as(Layout { sample: Sample::F32, order: Some(Order::Rgb), gap: 0 })
    }

    /// The picture in that layout; what lies between rows and the fourth sample is noise.
    #[must_use]
    pub fn encode_as(&self, layout: Layout) -> Encoded {
        let mut rng = Rng::new(5);
        let samples = layout.order.map_or(1, Order::samples);
        let row_stride = self.width * samples * layout.sample.bytes() + layout.gap;
        let planes = if layout.order.is_some() { 1 } else { 3 };
        let plane_bytes = row_stride * self.height;
        let mut bytes: Vec<u8> = (0..plane_bytes * planes).map(|_| rng.below(256) as u8).collect();
        for (i, color) in self.colors.iter().enumerate() {
            let (column, row) = (i % self.width, i / self.width);
            let start = row * row_stride + column * samples * layout.sample.bytes();
            for (channel, &value) in color.iter().enumerate() {
                let position = match layout.order {
                    None => channel * plane_bytes,
                    Some(Order::Rgb | Order::Rgba) => channel * layout.sample.bytes(),
                    Some(Order::Bgr | Order::Bgra) => (2 - channel) * layout.sample.bytes(),
                };
                put(&mut bytes[start + position..], layout.sample, value);
            }
        }
        Encoded { bytes, layout, row_stride, width: self.width, height: self.height }
    }
}

#[expect(clippy::cast_sign_loss, reason = "colors are not negative")]
fn put(bytes: &mut [u8], sample: Sample, value: f64) {
    match sample {
        Sample::U8 => bytes[0] = value as u8,
        Sample::U16 => bytes[..2].copy_from_slice(&(value as u16).to_ne_bytes()),
        Sample::F32 => bytes[..4].copy_from_slice(&(value as f32).to_ne_bytes()),
    }
}

/// How a picture is stored.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// The type of the samples.
    pub sample: Sample,
    /// Interleaved in that order, or three planes.
    pub order: Option<Order>,
    /// Bytes between rows.
    pub gap: usize,
}

/// A stored picture.
pub struct Encoded {
    bytes: Vec<u8>,
    layout: Layout,
    row_stride: usize,
    width: usize,
    height: usize,
}

impl Encoded {
    /// A view of it.
    ///
    /// # Panics
    /// Never: the sizes agree.
    #[must_use]
    pub fn image(&self) -> Image<'_> {
        let Self { bytes, layout, row_stride, width, height } = self;
        if let Some(order) = layout.order {
            Image::interleaved(bytes, *width, *height, *row_stride, layout.sample, order)
        } else {
            let plane = row_stride * height;
            let planes = [&bytes[..plane], &bytes[plane..2 * plane], &bytes[2 * plane..]];
            Image::planes(planes, *width, *height, *row_stride, layout.sample)
        }
        .expect("sizes agree")
    }
}
