//! Random surfaces, as normals over the place in the picture.

use super::Draw;
use crate::linear::unit;
use std::f64::consts::TAU;

impl Draw {
    /// A surface that bends in both directions: an ellipsoid that closes within the picture, with its background, or a relief
    /// that fills it.
    pub(super) fn surface(
        &mut self,
        [width, height]: [usize; 2],
        closes: bool,
    ) -> Box<dyn Fn(f64, f64) -> Option<[f64; 3]>> {
        let (w, h) = (width as f64, height as f64);
        if closes {
            let [a, b] = [w, h].map(|side| side * self.within(0.32, 0.46));
            let c = 0.5 * (a + b) * self.within(0.7, 1.1);
            let [x0, y0] =
                [(w, a), (h, b)].map(|(side, axis)| (0.5 * side - axis - 1.0) * self.within(-1.0, 1.0));
            Box::new(move |x, y| {
                let (u, v) = ((x - x0) / a, (y - y0) / b);
                let rest = 1.0 - u * u - v * v;
                (rest > 0.02).then(|| unit([u / a, v / b, rest.sqrt() / c]))
            })
        } else {
            let bumps: Vec<_> = (0..3)
                .map(|_| {
                    let size = self.within(0.18, 0.3) * w.min(h);
                    let at = [w, h].map(|side| side * self.within(-0.35, 0.35));
                    (at, size, size * self.within(0.6, 1.0))
                })
                .collect();
            Box::new(move |x, y| {
                let (mut p, mut q) = (0.0, 0.0);
                for ([x0, y0], size, height) in &bumps {
                    let (u, v) = ((x - x0) / size, (y - y0) / size);
                    let bump = height / size * (-0.5 * (u * u + v * v)).exp();
                    p -= bump * u;
                    q -= bump * v;
                }
                Some(unit([-p, -q, 1.0]))
            })
        }
    }

    /// A cylinder, a groove or waves: it bends in one direction.
    pub(super) fn bent_one_way(
        &mut self,
        [width, height]: [usize; 2],
    ) -> Box<dyn Fn(f64, f64) -> Option<[f64; 3]>> {
        let size = width.min(height) as f64;
        let (sin, cos) = self.within(0.0, TAU).sin_cos();
        let tip = self.within(-0.25, 0.25);
        let axis = [-sin, cos, tip];
        let waves = self.chance(0.5);
        let radius = size * self.within(0.45, 0.6);
        let (steep, length) = (self.within(0.5, 0.8), size * self.within(0.3, 0.9));
        Box::new(move |x, y| {
            let across = cos * x + sin * y;
            let slope = if waves {
                steep * (TAU * across / length).sin()
            } else {
                let u = across / radius;
                if u.abs() > 0.8 {
                    return None;
                }
                -u / (1.0 - u * u).sqrt()
            };
            // The normal of a profile along `across`, and of an axis that is tipped toward the camera.
            let [ax, ay, az] = unit(axis);
            let along = [cos, sin, 0.0];
            let out = [ay * 0.0 - az * along[1], az * along[0] - ax * 0.0, ax * along[1] - ay * along[0]];
            let out = unit(if out[2] < 0.0 { out.map(|c| -c) } else { out });
            Some(unit([0, 1, 2].map(|i| out[i] - slope * along[i])))
        })
    }
}
