//! Random pictures that cannot be solved, each for one known reason, and ones that can.

mod shapes;

use crate::linear::{apply, inverse, length, unit};
use crate::linear_scenes::{direction, normal};
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Image, Order, Sample};
use std::f64::consts::TAU;

/// A picture of 8 bits, or of floats where it holds what is no number, and a mask where it has one.
pub struct Scene {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The channel that the reason is about.
    pub channel: Option<usize>,
    sample: Sample,
    /// Not zero where pixels are to be used.
    pub mask: Option<Vec<u8>>,
    bytes: Vec<u8>,
}

impl Scene {
    /// A view of it.
    #[must_use]
    pub fn image(&self) -> Image<'_> {
        let (width, height) = (self.width, self.height);
        let stride = 3 * width * self.sample.bytes();
        let image = Image::interleaved(&self.bytes, width, height, stride, self.sample, Order::Rgb)
            .expect("sizes agree");
        match &self.mask {
            Some(mask) => image.with_mask(mask, width).expect("sizes agree"),
            None => image,
        }
    }
}

/// A direction and the color of its light.
type Light = ([f64; 3], [f64; 3]);

/// Colors times a number.
fn scaled(colors: &[[f64; 3]], gain: f64) -> Vec<[f64; 3]> {
    colors.iter().map(|color| color.map(|value| value * gain)).collect()
}

/// What is drawn of a scene: its numbers come from one generator.
pub struct Draw {
    rng: Rng,
    magnification: usize,
}

impl Draw {
    /// Of small pictures, or of ones that are so many times as wide and high.
    #[must_use]
    pub const fn new(seed: u64, magnification: usize) -> Self {
        Self { rng: Rng::new(seed), magnification }
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.rng.unit()
    }

    fn chance(&mut self, of: f64) -> bool {
        self.rng.unit() < of
    }

    fn size(&mut self) -> [usize; 2] {
        [0; 2].map(|_| self.magnification * (64 + self.rng.below(41) as usize))
    }

    /// Three lights around the object, none in the plane of the other two, one mostly red, one green, one blue.
    fn lights(&mut self) -> [Light; 3] {
        let start = self.within(0.0, 360.0);
        let crosstalk = self.within(0.05, 0.4);
        [0, 1, 2].map(|i: u8| {
            let slant = self.within(22.0, 45.0);
            let tilt = start + 120.0 * f64::from(i) + self.within(-25.0, 25.0);
            let strength = self.within(0.75, 1.0);
            let color =
                [0, 1, 2].map(|c| strength * if c == i { 1.0 } else { crosstalk * self.within(0.3, 1.0) });
            (direction(slant, tilt), color)
        })
    }

    /// A surface in the light: black beside it, and where no light reaches.
    fn lit(
        &mut self,
        size: [usize; 2],
        lights: &[Light],
        surface: &dyn Fn(f64, f64) -> Option<[f64; 3]>,
    ) -> Vec<[f64; 3]> {
        self.exposed(size, lights, surface).0
    }

    /// The same, and what it was multiplied by for the camera.
    fn exposed(
        &mut self,
        size: [usize; 2],
        lights: &[Light],
        surface: &dyn Fn(f64, f64) -> Option<[f64; 3]>,
    ) -> (Vec<[f64; 3]>, f64) {
        let [width, height] = size;
        let mut colors = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let at = [column as f64 - 0.5 * (width - 1) as f64, 0.5 * (height - 1) as f64 - row as f64];
                let mut color = [0.0; 3];
                if let Some(n) = surface(at[0], at[1]) {
                    for (toward, light) in lights {
                        let shading = (toward[0] * n[0] + toward[1] * n[1] + toward[2] * n[2]).max(0.0);
                        for (value, strength) in color.iter_mut().zip(light) {
                            *value += strength * shading;
                        }
                    }
                }
                colors.push(color);
            }
        }
        let largest = colors.iter().flatten().copied().fold(0.0, f64::max);
        let gain = self.within(140.0, 240.0) / largest;
        (scaled(&colors, gain), gain)
    }

    /// As a camera of 8 bits gives it, with noise on everything that is not black.
    fn taken(
        &mut self,
        [width, height]: [usize; 2],
        colors: &[[f64; 3]],
        noise: f64,
        mask: Option<Vec<u8>>,
    ) -> Scene {
        let mut bytes = Vec::with_capacity(3 * colors.len());
        for color in colors {
            let is_lit = color.iter().any(|&value| value > 0.0);
            for value in color {
                let noisy = if is_lit { value + noise * normal(&mut self.rng) } else { 0.0 };
                #[expect(clippy::cast_sign_loss, reason = "it is clamped")]
                bytes.push(noisy.round().clamp(0.0, 255.0) as u8);
            }
        }
        Scene { width, height, channel: None, mask, sample: Sample::U8, bytes }
    }

    fn noise(&mut self) -> f64 {
        self.within(0.2, 1.5)
    }

    /// One that can be solved, with a few highlights now and then.
    pub fn good(&mut self) -> Scene {
        let size = self.size();
        let (lights, closes) = (self.lights(), self.chance(0.5));
        let surface = self.surface(size, closes);
        let mut colors = self.lit(size, &lights, &surface);
        let share = if self.chance(0.5) { self.within(0.0, 0.1) } else { 0.0 };
        self.spoil(size, &mut colors, share);
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// Discs of other colors over this share of the picture.
    fn spoil(&mut self, [width, height]: [usize; 2], colors: &mut [[f64; 3]], share: f64) {
        let mut left = share * (width * height) as f64;
        while left > 0.0 {
            let radius = self.within(1.5, 4.0);
            let [x0, y0] = [width, height].map(|side| self.within(0.0, side as f64));
            let color = [0; 3].map(|_| self.within(10.0, 250.0));
            for (i, slot) in colors.iter_mut().enumerate() {
                let (x, y) = ((i % width) as f64, (i / width) as f64);
                if (x - x0).hypot(y - y0) < radius && slot.iter().any(|&value| value > 0.0) {
                    *slot = color.map(|value| value + self.within(-20.0, 5.0));
                }
            }
            left -= TAU / 2.0 * radius * radius;
        }
    }

    /// Most of the object is saturated.
    pub fn saturated(&mut self) -> Scene {
        let size = self.size();
        let (lights, closes) = (self.lights(), self.chance(0.5));
        let surface = self.surface(size, closes);
        let colors = self.lit(size, &lights, &surface);
        let mut largest: Vec<f64> =
            colors.iter().map(|c| c[0].max(c[1]).max(c[2])).filter(|&value| value > 0.0).collect();
        largest.sort_by(f64::total_cmp);
        let percent = 2 + self.rng.below(39) as usize;
        let gain = 255.0 / largest[largest.len() * percent / 100];
        let noise = self.noise();
        self.taken(size, &scaled(&colors, gain), noise, None)
    }

    /// A few gray levels of light.
    pub fn dark(&mut self) -> Scene {
        let size = self.size();
        let (lights, closes) = (self.lights(), self.chance(0.5));
        let surface = self.surface(size, closes);
        let colors = self.lit(size, &lights, &surface);
        let gain = self.within(0.5, 5.0) / 240.0;
        let noise = self.within(0.3, 1.0);
        self.taken(size, &scaled(&colors, gain), noise, None)
    }

    /// A mask without a pixel, or with so few that nothing can be fitted.
    pub fn masked_away(&mut self) -> Scene {
        let mut scene = self.good();
        let mut mask = vec![0; scene.width * scene.height];
        for _ in 0..self.rng.below(10) {
            let at = self.rng.below(mask.len() as u32) as usize;
            mask[at] = 255;
        }
        scene.mask = Some(mask);
        scene
    }

    /// The mask of the object, inverted; the background black, dark with noise, or pale.
    pub fn inverted_mask(&mut self) -> Scene {
        let size = self.size();
        let lights = self.lights();
        let surface = self.surface(size, true);
        let mut colors = self.lit(size, &lights, &surface);
        let mask =
            colors.iter().map(|color| if color[0] + color[1] + color[2] > 0.0 { 0 } else { 255 }).collect();
        let background = match self.rng.below(3) {
            0 => [0.0; 3],
            1 => [0; 3].map(|_| self.within(1.0, 12.0)),
            _ => [0; 3].map(|_| self.within(60.0, 220.0)),
        };
        for color in colors.iter_mut().filter(|color| color[0] + color[1] + color[2] == 0.0) {
            *color = background;
        }
        let noise = self.noise();
        self.taken(size, &colors, noise, Some(mask))
    }

    /// A pale background around the object, and no mask.
    pub fn background(&mut self) -> Scene {
        let size = self.size();
        let lights = self.lights();
        let surface = self.surface(size, true);
        // The object is a smaller part of the picture than its background.
        let scale = self.within(1.3, 1.8);
        let (colors, gain) = self.exposed(size, &lights, &|x, y| surface(scale * x, scale * y));
        let f = [0, 1, 2].map(|c| {
            [0, 1, 2].map(|i| lights.iter().map(|(toward, light)| gain * light[c] * toward[i]).sum())
        });
        let back = inverse(f);
        // Of a color that the object has nowhere: the lengths of normals that it would have are off by a fourth.
        let pale = loop {
            let pale = [0; 3].map(|_| self.within(60.0, 220.0));
            if (length(apply(back, pale)) - 1.0).abs() > 0.25 {
                break pale;
            }
        };
        let slope = [0; 2].map(|_| self.within(-0.06, 0.06));
        let [width, height] = size;
        let colors: Vec<_> = colors
            .iter()
            .enumerate()
            .map(|(i, &color)| {
                let [u, v] =
                    [i % width, i / width].map(|at| at as f64).map(|at| at / width.max(height) as f64 - 0.5);
                let shade = 1.0 + slope[0] * u + slope[1] * v;
                if color[0] + color[1] + color[2] > 0.0 { color } else { pale.map(|value| value * shade) }
            })
            .collect();
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// One channel says nothing: black, or the same everywhere.
    pub fn dead_channel(&mut self) -> Scene {
        let size = self.size();
        let (lights, closes) = (self.lights(), self.chance(0.5));
        let surface = self.surface(size, closes);
        let mut colors = self.lit(size, &lights, &surface);
        let channel = self.rng.below(3) as usize;
        let level = if self.chance(0.5) { 0.0 } else { self.within(1.0, 60.0) };
        for color in colors.iter_mut().filter(|color| color[0] + color[1] + color[2] > 0.0) {
            color[channel] = level;
        }
        let noise = self.noise();
        Scene { channel: Some(channel), ..self.taken(size, &colors, noise, None) }
    }

    /// A gray picture stored as color, or one under white lights: channels are equal or proportional.
    pub fn gray(&mut self) -> Scene {
        let size = self.size();
        let (lights, closes) = (self.lights(), self.chance(0.5));
        let surface = self.surface(size, closes);
        let tint = if self.chance(0.5) { [1.0; 3] } else { [0; 3].map(|_| self.within(0.4, 1.0)) };
        let lights = lights.map(|(toward, color)| (toward, tint.map(|t| t * color[1])));
        let colors = self.lit(size, &lights, &surface);
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// Two lights for three channels.
    pub fn two_lights(&mut self) -> Scene {
        let size = self.size();
        let (lights, closes) = (self.lights(), self.chance(0.5));
        let surface = self.surface(size, closes);
        // The first is mostly in one channel, the second mostly in another.
        let mut own = [
            [1.0, self.within(0.0, 0.4)],
            [self.within(0.0, 0.4), 1.0],
            [self.within(0.2, 0.8), self.within(0.2, 0.8)],
        ];
        own.rotate_left(self.rng.below(3) as usize);
        let [first, second, _] = lights;
        let lights = [(first.0, own.map(|m| m[0])), (second.0, own.map(|m| m[1]))];
        let colors = self.lit(size, &lights, &surface);
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// Three lights nearly in a plane, and the one that is to be moved: the two others are the farthest apart.
    pub fn coplanar_lights(&mut self) -> Scene {
        let size = self.size();
        let closes = self.chance(0.5);
        let surface = self.surface(size, closes);
        let tilt = self.within(0.0, 360.0);
        let mut slants = [self.within(-45.0, -30.0), self.within(-8.0, 8.0), self.within(30.0, 45.0)];
        let middle = self.rng.below(3) as usize;
        slants.swap(1, middle);
        let out_of_plane = self.within(2.0, 3.5);
        let colors = [0, 1, 2].map(|i| [0, 1, 2].map(|c| if c == i { 1.0 } else { 0.0 }));
        let lights = [0, 1, 2].map(|i| {
            let off = if i == middle { out_of_plane } else { 0.0 };
            let ([x, y, z], [sx, sy, _]) = (direction(slants[i], tilt), direction(90.0, tilt + 90.0));
            let off = off.to_radians().tan();
            (unit([x + off * sx, y + off * sy, z]), colors[i])
        });
        let colors = self.lit(size, &lights, &surface);
        let noise = self.within(0.2, 0.5);
        Scene { channel: Some(middle), ..self.taken(size, &colors, noise, None) }
    }

    /// Two paints, one brighter or of another hue, in stripes, halves or squares.
    pub fn two_paints(&mut self) -> Scene {
        let size = self.size();
        let (lights, closes) = (self.lights(), self.chance(0.5));
        let surface = self.surface(size, closes);
        let mut colors = self.lit(size, &lights, &surface);
        let ratio = self.within(0.4, 0.7);
        let paint = if self.chance(0.5) { [ratio; 3] } else { [0; 3].map(|_| self.within(0.3, 0.8)) };
        let side = self.within(6.0, 11.0);
        let (sin, cos) = self.within(0.0, TAU).sin_cos();
        let squares = self.chance(0.5);
        for (i, color) in colors.iter_mut().enumerate() {
            let (x, y) = ((i % size[0]) as f64, (i / size[0]) as f64);
            let (u, v) = ((cos * x + sin * y) / side, (cos * y - sin * x) / side);
            let odd = if squares { u.floor() + v.floor() } else { u.floor() };
            if odd.rem_euclid(2.0) >= 1.0 {
                *color = [0, 1, 2].map(|c| color[c] * paint[c]);
            }
        }
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// A flat plate.
    pub fn flat(&mut self) -> Scene {
        let size = self.size();
        let lights = self.lights();
        let (slant, tilt) = (self.within(0.0, 30.0), self.within(0.0, 360.0));
        let colors = self.lit(size, &lights, &|_, _| Some(direction(slant, tilt)));
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// A flat plate that darkens toward the corners.
    pub fn vignette(&mut self) -> Scene {
        let size = self.size();
        let lights = self.lights();
        let (slant, tilt) = (self.within(0.0, 30.0), self.within(0.0, 360.0));
        let mut colors = self.lit(size, &lights, &|_, _| Some(direction(slant, tilt)));
        let [w, h] = size.map(|side| side as f64);
        let corner = self.within(0.15, 0.6);
        let [x0, y0] = [w, h].map(|side| side * (0.5 + self.within(-0.06, 0.06)));
        for (i, color) in colors.iter_mut().enumerate() {
            let (x, y) = ((i % size[0]) as f64 - x0, (i / size[0]) as f64 - y0);
            let square = 4.0 * (x * x + y * y) / (w * w + h * h);
            *color = color.map(|value| value * (1.0 - corner * square));
        }
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// A cylinder, a groove or waves.
    pub fn cylinder(&mut self) -> Scene {
        let size = self.size();
        let lights = self.lights();
        let surface = self.bent_one_way(size);
        let colors = self.lit(size, &lights, &surface);
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// Most of the pixels are of other materials: discs of any color, or every color by itself.
    pub fn outliers(&mut self) -> Scene {
        let size = self.size();
        let (lights, closes) = (self.lights(), self.chance(0.5));
        let surface = self.surface(size, closes);
        let mut colors = self.lit(size, &lights, &surface);
        if self.chance(0.5) {
            let share = self.within(1.5, 3.0);
            self.spoil(size, &mut colors, share);
        } else {
            let share = self.within(0.6, 1.0);
            for color in &mut colors {
                if self.chance(share) && color[0] + color[1] + color[2] > 0.0 {
                    *color = [0; 3].map(|_| self.within(1.0, 250.0));
                }
            }
        }
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// As many bumps as dents, side by side over the whole picture.
    pub fn neither_convex_nor_hollow(&mut self) -> Scene {
        let size = self.size();
        let lights = self.lights();
        let (side, steep) = (self.within(7.0, 10.0), self.within(0.4, 0.7));
        let [a, b] = [0; 2].map(|_| self.within(0.0, TAU));
        let colors = self.lit(size, &lights, &|x, y| {
            let (u, v) = (TAU / 2.0 * x / side + a, TAU / 2.0 * y / side + b);
            Some(unit([steep * u.sin() * v.cos(), steep * u.cos() * v.sin(), 1.0]))
        });
        let noise = self.noise();
        self.taken(size, &colors, noise, None)
    }

    /// Floats, most of which are no numbers.
    pub fn not_finite(&mut self) -> Scene {
        let size = self.size();
        let nothing = if self.chance(0.5) { f32::NAN } else { f32::INFINITY };
        let numbers = self.rng.below(9);
        let count = size[0] * size[1];
        let bytes = (0..3 * count)
            .flat_map(|i| if i < 3 * numbers as usize { 100.0 } else { nothing }.to_ne_bytes())
            .collect();
        Scene { width: size[0], height: size[1], channel: None, mask: None, sample: Sample::F32, bytes }
    }

    /// A picture of a few pixels.
    pub fn tiny(&mut self) -> Scene {
        let [width, height] = [1 + self.rng.below(3) as usize, 1 + self.rng.below(3) as usize];
        let colors: Vec<_> = (0..width * height).map(|_| [0; 3].map(|_| self.within(20.0, 200.0))).collect();
        self.taken([width, height], &colors, 1.0, None)
    }
}
