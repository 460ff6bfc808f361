//! Pictures of which most is one plane under three near, colored lights: with a relief on it, or with something that only
//! looks like one.

#![allow(clippy::cast_sign_loss, reason = "pixels and counts that are not negative")]

use ofc_core::math::rng::Rng;

/// The scenes' width.
pub const WIDTH: usize = 320;
/// The scenes' height.
pub const HEIGHT: usize = 240;

/// What is on the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A ball pressed into a gel that comes up around it.
    Ball,
    /// One smooth bump, longer than wide.
    Bump,
    /// Three to five bumps.
    Bumps,
    /// A ring.
    Ring,
    /// Black dots.
    Markers,
    /// Blurred white spots.
    Highlights,
    /// Patches of another paint.
    TwoPaints,
    /// Patches of five other hues.
    Hues,
    /// Patches of hues that vary smoothly.
    SmoothHues,
    /// A straight ridge.
    Groove,
    /// Two parallel ridges.
    Ridges,
    /// A wide cylinder with highlights on it.
    Cylinder,
    /// An egg of the plane's lights that lies on a table of another color.
    Egg,
    /// Soft shadows, each of one light.
    Shadows,
    /// Nothing but lights that fall off.
    Vignette,
    /// Patches that are tilted as a whole.
    TiltedPatches,
}

/// Those that are reliefs on a plane.
pub const RELIEFS: [Kind; 4] = [Kind::Ball, Kind::Bump, Kind::Bumps, Kind::Ring];

/// Those that are not.
pub const OTHERS: [Kind; 12] = [
    Kind::Markers,
    Kind::Highlights,
    Kind::TwoPaints,
    Kind::Hues,
    Kind::SmoothHues,
    Kind::Groove,
    Kind::Ridges,
    Kind::Cylinder,
    Kind::Egg,
    Kind::Shadows,
    Kind::Vignette,
    Kind::TiltedPatches,
];

/// A picture, and what is true of it.
pub struct ReliefScene {
    /// RGB, 8 bits, tight rows.
    pub rgb: Vec<u8>,
    /// The plane alone, under other noise.
    pub background: Vec<u8>,
    /// Unit normals.
    pub normals: Vec<[f64; 3]>,
    /// The radius of the ball in pixels and its center, y down, where there is one.
    pub ball: Option<(f64, [f64; 2])>,
}

type Vector = [f64; 3];

struct Maker {
    rng: Rng,
    lights: [Vector; 3],
    gains: [[f64; 5]; 3],
    place: [f64; 2],
    ball: Option<(f64, [f64; 2])>,
}

/// The scene of this kind and number.
pub fn scene(kind: Kind, number: u64) -> ReliefScene {
    maker(kind, Rng::new(7919 * number + kind as u64)).make(kind)
}

/// A frame of the rig of this number, whose lights stay: a contact of this kind, and a ball anywhere.
pub fn frame(rig: u64, kind: Kind, number: u64) -> ReliefScene {
    let mut maker = maker(Kind::Ball, Rng::new(104_729 * rig + 1));
    maker.rng = Rng::new(7919 * number + 31 * rig + kind as u64);
    maker.place = [160.0, 100.0].map(|range| range * (maker.rng.unit() - 0.5));
    maker.make(kind)
}

fn maker(kind: Kind, mut rng: Rng) -> Maker {
    let first = rng.unit() * 2.0 * core::f64::consts::PI;
    let lights = [0.0, 1.0, 2.0].map(|i| {
        let azimuth = first + (120.0 * i + 50.0 * rng.unit() - 25.0).to_radians();
        let slant = (30.0 + 35.0 * rng.unit()).to_radians();
        let strength = 90.0 + 85.0 * rng.unit();
        [slant.sin() * azimuth.cos(), slant.sin() * azimuth.sin(), slant.cos()].map(|c| strength * c)
    });
    let mix = [[(); 3]; 3].map(|row| row.map(|()| 0.2 * rng.unit()));
    let mixed = [0, 1, 2]
        .map(|i| [0, 1, 2].map(|k| lights[i][k] + (0..3).map(|j| mix[i][j] * lights[j][k]).sum::<f64>()));
    let spread = if kind == Kind::Vignette { 0.3 } else { 0.12 };
    let gains = [[(); 5]; 3].map(|row| row.map(|()| spread * rng.normal_pair()[0]));
    Maker { rng, lights: mixed, gains, place: [0.0; 2], ball: None }
}

impl Maker {
    fn make(mut self, kind: Kind) -> ReliefScene {
        let heights = self.heights(kind);
        let mut normals = normals(&heights);
        let mut paint = vec![[1.0; 3]; WIDTH * HEIGHT];
        let mut glow = vec![0.0; WIDTH * HEIGHT];
        match kind {
            Kind::Markers => self.patches(0.08, 4.0, 12.0, |i| paint[i] = [0.08; 3]),
            Kind::Highlights | Kind::Cylinder => {
                let strength = 40.0 + 110.0 * self.rng.unit();
                self.patches(0.07, 4.0, 12.0, |i| glow[i] = strength);
                glow = blurred(&glow, 3);
            }
            Kind::TwoPaints => {
                let other = [(); 3].map(|()| 0.4 + 1.0 * self.rng.unit());
                self.patches(0.15, 20.0, 50.0, |i| paint[i] = other);
            }
            Kind::Hues => {
                for _ in 0..5 {
                    let other = [(); 3].map(|()| 0.3 + 1.0 * self.rng.unit());
                    self.patches(0.04, 8.0, 25.0, |i| paint[i] = other);
                }
            }
            Kind::SmoothHues => {
                let mut mask = vec![0.0; WIDTH * HEIGHT];
                self.patches(0.12, 10.0, 30.0, |i| mask[i] = 1.0);
                let mask = blurred(&mask, 6);
                for channel in 0..3 {
                    let field = self.field();
                    for (i, paint) in paint.iter_mut().enumerate() {
                        paint[channel] = (0.3 * mask[i] * field[i]).exp();
                    }
                }
            }
            Kind::Shadows => {
                for channel in 0..2 {
                    let mut mask = vec![0.0; WIDTH * HEIGHT];
                    self.patches(0.12, 20.0, 40.0, |i| mask[i] = 1.0);
                    for (paint, mask) in paint.iter_mut().zip(blurred(&mask, 4)) {
                        paint[channel] *= 1.0 - 0.8 * mask;
                    }
                }
            }
            Kind::TiltedPatches => {
                let [a, b] = [(); 2].map(|()| 1.2 * self.rng.unit() - 0.6);
                let tilted = unit([a, b, 1.0]);
                self.patches(0.15, 20.0, 50.0, |i| normals[i] = tilted);
            }
            _ => {}
        }
        if kind == Kind::Egg {
            let table = [(); 3].map(|()| 90.0 + 110.0 * self.rng.unit());
            let (scale, inside) = (0.2 + 0.1 * self.rng.unit(), 0.97);
            let (a, b) = (scale * WIDTH as f64, scale * HEIGHT as f64);
            for (i, normal) in normals.iter_mut().enumerate() {
                let (x, y) = centered(i);
                let square = (x / a).powi(2) + (y / b).powi(2);
                if square < inside {
                    *normal = unit([x / a / a, y / b / b, 2.0 * (1.0 - square).sqrt() / a]);
                } else {
                    let flat = self.plain(i);
                    paint[i] = [0, 1, 2].map(|k| table[k] / flat[k]);
                }
            }
        }
        let picture: Vec<Vector> = (0..WIDTH * HEIGHT)
            .map(|i| {
                let gain = self.gain(i);
                [0, 1, 2].map(|k| dot(self.lights[k], normals[i]).max(0.0) * gain[k] * paint[i][k] + glow[i])
            })
            .collect();
        let plane: Vec<Vector> = (0..WIDTH * HEIGHT).map(|i| self.plain(i)).collect();
        ReliefScene {
            rgb: self.quantized(&picture),
            background: self.quantized(&plane),
            normals,
            ball: self.ball,
        }
    }

    fn plain(&self, i: usize) -> Vector {
        let gain = self.gain(i);
        [0, 1, 2].map(|k| self.lights[k][2] * gain[k])
    }

    fn gain(&self, i: usize) -> Vector {
        let (x, y) = centered(i);
        let (x, y) = (2.0 * x / WIDTH as f64, 2.0 * y / HEIGHT as f64);
        self.gains.map(|[a, b, c, d, e]| (a * x + b * y + c * x * y + 0.5 * (d * x * x + e * y * y)).exp())
    }

    fn quantized(&mut self, colors: &[Vector]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(3 * colors.len());
        for color in colors {
            for value in color {
                bytes.push((value + 0.8 * self.rng.normal_pair()[0]).round().clamp(0.0, 255.0) as u8);
            }
        }
        bytes
    }

    /// Calls `visit` with the pixels of discs, until they cover this share of the picture.
    fn patches(&mut self, share: f64, least: f64, most: f64, mut visit: impl FnMut(usize)) {
        let mut covered = vec![false; WIDTH * HEIGHT];
        while (covered.iter().filter(|c| **c).count() as f64) < share * covered.len() as f64 {
            let center = [self.rng.unit() * WIDTH as f64, self.rng.unit() * HEIGHT as f64];
            let radius = least + (most - least) * self.rng.unit();
            for (i, covered) in covered.iter_mut().enumerate() {
                let (x, y) = ((i % WIDTH) as f64 - center[0], (i / WIDTH) as f64 - center[1]);
                if x * x + y * y < radius * radius && !*covered {
                    *covered = true;
                    visit(i);
                }
            }
        }
    }

    /// A smooth random field of deviation 1.
    fn field(&mut self) -> Vec<f64> {
        let noise: Vec<f64> = (0..WIDTH * HEIGHT).map(|_| self.rng.normal_pair()[0]).collect();
        let smooth = blurred(&blurred(&noise, 12), 12);
        let deviation = (smooth.iter().map(|v| v * v).sum::<f64>() / smooth.len() as f64).sqrt();
        smooth.iter().map(|v| v / deviation).collect()
    }

    fn heights(&mut self, kind: Kind) -> Vec<f64> {
        let mut uniform = |low: f64, high: f64| low + (high - low) * self.rng.unit();
        let each = |height: &dyn Fn(f64, f64) -> f64| {
            (0..WIDTH * HEIGHT).map(centered).map(|(x, y)| height(x, y)).collect()
        };
        match kind {
            Kind::Ball => {
                let (share, steepest) = (uniform(0.03, 0.3), uniform(25.0, 55.0).to_radians());
                let radius = (share * (WIDTH * HEIGHT) as f64 / core::f64::consts::PI).sqrt();
                let (ball, skirt, slope) = (radius / steepest.sin(), 0.25 * radius, steepest.tan());
                let [right, up] = self.place;
                let center = [right + 0.5 * (WIDTH - 1) as f64, 0.5 * (HEIGHT - 1) as f64 - up];
                self.ball = Some((ball, center));
                each(&|x, y| {
                    let d = (x - right).hypot(y - up);
                    if d < radius {
                        (ball * ball - d * d).sqrt() - ball * steepest.cos() + 0.5 * skirt * slope
                    } else {
                        slope / (2.0 * skirt) * (radius + skirt - d).max(0.0).powi(2)
                    }
                })
            }
            Kind::Bump | Kind::Bumps => {
                let count = if kind == Kind::Bump { 1 } else { 3 + (uniform(0.0, 2.99) as usize) };
                let bumps: Vec<[f64; 6]> = (0..count)
                    .map(|_| {
                        let (size, steepest) = (uniform(10.0, 25.0), uniform(25.0, 50.0).to_radians());
                        let place = [uniform(-110.0, 110.0), uniform(-70.0, 70.0)];
                        let (longer, angle) = (uniform(0.6, 1.6), uniform(0.0, 3.1));
                        [place[0], place[1], size, steepest.tan() * size * 1.6, longer, angle]
                    })
                    .collect();
                each(&|x, y| {
                    bumps.iter().fold(0.0, |sum, [cx, cy, size, height, longer, angle]| {
                        let (s, c) = angle.sin_cos();
                        let (u, v) = ((x - cx) * c + (y - cy) * s, (y - cy) * c - (x - cx) * s);
                        sum + height * (-(u * u / longer + v * v * longer) / (2.0 * size * size)).exp()
                    })
                })
            }
            Kind::Ring => {
                let (radius, width, height) = (uniform(30.0, 70.0), uniform(7.0, 14.0), uniform(8.0, 14.0));
                let (cx, cy) = (uniform(-50.0, 50.0), uniform(-20.0, 20.0));
                each(&|x, y| {
                    height * (-((x - cx).hypot(y - cy) - radius).powi(2) / (2.0 * width * width)).exp()
                })
            }
            Kind::Groove | Kind::Ridges | Kind::Cylinder => {
                let (angle, width) = (uniform(0.0, 3.1), uniform(8.0, 16.0));
                let (s, c) = angle.sin_cos();
                each(&|x, y| {
                    let u = x * c + y * s;
                    match kind {
                        Kind::Groove => 18.0 * (-u * u / (2.0 * width * width)).exp(),
                        Kind::Ridges => {
                            14.0 * (-(u - 40.0).powi(2) / 200.0).exp()
                                + 10.0 * (-(u + 50.0).powi(2) / 288.0).exp()
                        }
                        _ => (260.0_f64.powi(2) - u * u).sqrt(),
                    }
                })
            }
            _ => vec![0.0; WIDTH * HEIGHT],
        }
    }
}

/// A pixel's place from the middle, x to the right, y up.
fn centered(i: usize) -> (f64, f64) {
    ((i % WIDTH) as f64 - 0.5 * (WIDTH - 1) as f64, 0.5 * (HEIGHT - 1) as f64 - (i / WIDTH) as f64)
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

/// The normals of heights in pixels.
fn normals(heights: &[f64]) -> Vec<Vector> {
    let at = |x: usize, y: usize| heights[y.min(HEIGHT - 1) * WIDTH + x.min(WIDTH - 1)];
    (0..WIDTH * HEIGHT)
        .map(|i| {
            let (x, y) = (i % WIDTH, i / WIDTH);
            let p = 0.5 * (at(x + 1, y) - at(x.saturating_sub(1), y));
            let q = 0.5 * (at(x, y.saturating_sub(1)) - at(x, y + 1));
            unit([-p, -q, 1.0])
        })
        .collect()
}

/// Twice the mean over so many pixels to each side: smooth enough for an edge that is soft.
fn blurred(values: &[f64], radius: usize) -> Vec<f64> {
    let mut now = values.to_vec();
    for _ in 0..2 {
        for transposed in [false, true] {
            let (len, lines) = if transposed { (HEIGHT, WIDTH) } else { (WIDTH, HEIGHT) };
            let index = |line: usize, i: usize| if transposed { i * WIDTH + line } else { line * WIDTH + i };
            let before = now.clone();
            for line in 0..lines {
                for i in 0..len {
                    let range = i.saturating_sub(radius)..(i + radius + 1).min(len);
                    let count = range.len() as f64;
                    now[index(line, i)] = range.map(|i| before[index(line, i)]).sum::<f64>() / count;
                }
            }
        }
    }
    now
}
