//! Integrability: how likely the products of neighbors are those of one surface.
//!
//! For a surface `r1.(N x N_x) + r2.(N x N_y) = 0`. The mean s of the left side over a window has the variance
//! `e = noise(R) + eps^2 b`: what noise adds, and an error of the model that is relative to how much the surface bends there, b. Where C is
//! bent by near lights or paint, s is wrong by a share of what it is made of; eps, one number a picture, is that share and is estimated
//! with R. A window's density is Student's with three degrees of freedom: some lie over creases and shadows' borders.

use super::constants::{INDEPENDENT, LARGEST_EPS, SMALLEST_EPS, SMALLEST_VARIANCE};
use super::value::Value;
use super::window::{NUMBERS, Window};
use crate::math::mat3::{self, Mat3};
use libm::{log, log1p};

/// Windows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Integrable<'w> {
    pub windows: &'w [[f32; NUMBERS]],
    /// Every so many windows count.
    pub stride: usize,
    /// The covariance of a pixel's N.
    pub noise: Mat3,
}

/// The negative log likelihood, and its derivatives by log eps^2.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Likelihood {
    pub value: Value,
    pub by_eps: f64,
    pub eps_information: f64,
}

/// Degrees of freedom of Student's distribution.
const FREEDOM: f64 = 3.0;

impl Integrable<'_> {
    /// That of `rows` and eps^2.
    #[inline(never)]
    pub fn likelihood(&self, rows: &Mat3, eps_squared: f64) -> Likelihood {
        let [r1, r2, r3] = *rows;
        let mut sum = Likelihood::default();
        for window in self.windows.iter().step_by(self.stride.max(1)).map(Window::load) {
            let ([vx, vy], m, [xx, xy, yy]) = (window.products, window.normal, window.variance);
            let s = mat3::dot(r1, vx) + mat3::dot(r2, vy);
            let ds = [-mat3::dot(r3, vy), mat3::dot(r3, vx), mat3::dot(r1, vy) - mat3::dot(r2, vx)];
            // noise = xx a K a + 2 xy a K b + yy b K b with a = r1 x m and b = r2 x m.
            let of_noise = |row| mat3::apply(&self.noise, mat3::cross(row, m));
            let ([a0, a1, a2], [b0, b1, b2]) = (of_noise(r1), of_noise(r2));
            let mixed = |u: f64, v: f64| mat3::cross(m, [u * a0 + v * b0, u * a1 + v * b1, u * a2 + v * b2]);
            let (p, q) = (mixed(xx, xy), mixed(xy, yy));
            let noise = (mat3::dot(r1, p) + mat3::dot(r2, q)).max(0.0);
            let dn = [
                -2.0 * mat3::dot(r3, q),
                2.0 * mat3::dot(r3, p),
                2.0 * (mat3::dot(r1, q) - mat3::dot(r2, p)),
            ];
            let model = eps_squared * window.bending;
            let e = noise + model + SMALLEST_VARIANCE;
            let t = s * s / (FREEDOM * e);
            let weight = window.share;
            let (along, across) =
                ((FREEDOM + 1.0) / FREEDOM / (e * (1.0 + t)), (0.5 - 2.0 * t / (1.0 + t)) / e);
            sum.value.cost += weight * (0.5 * log(e) + 0.5 * (FREEDOM + 1.0) * log1p(t));
            for ((g, ds), dn) in sum.value.gradient.iter_mut().zip(ds).zip(dn) {
                *g += weight * (along * s * ds + across * dn);
            }
            let by_noise = 0.25 / (e * e);
            for ((row, a), c) in sum.value.information.iter_mut().zip(ds).zip(dn) {
                for ((entry, b), d) in row.iter_mut().zip(ds).zip(dn) {
                    *entry += weight * (along * a * b + by_noise * c * d);
                }
            }
            let f = model / e;
            sum.by_eps += weight * f * e * across;
            sum.eps_information += weight * 0.25 * f * f;
        }
        let each = INDEPENDENT * self.stride.max(1) as f64;
        let mut value = Value::default();
        value.add(&sum.value, each);
        Likelihood { value, by_eps: each * sum.by_eps, eps_information: each * sum.eps_information }
    }

    /// eps^2 within what is possible.
    pub fn bounded(eps_squared: f64) -> f64 {
        eps_squared.clamp(SMALLEST_EPS * SMALLEST_EPS, LARGEST_EPS * LARGEST_EPS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::orientation::orthogonal::polish::rotation;
    use libm::sqrt;

    /// Windows of a paraboloid in another frame, n = `rows` N, whose s is wrong by about `eps` of their bending.
    fn windows(rows: &Mat3, eps: f64, count: usize) -> std::vec::Vec<[f32; NUMBERS]> {
        let mut rng = Rng::new(3);
        let back = mat3::transpose(rows);
        let mut one = || {
            let [p, q] = [(); 2].map(|()| 1.2 * rng.unit() - 0.6);
            let length = sqrt(1.0 + p * p + q * q);
            let n = [p / length, q / length, 1.0 / length];
            let (a, b, c) = (0.02, 0.01 * (rng.unit() - 0.5), 0.03);
            // What slopes add along n falls away.
            let product = |slope: [f64; 3]| mat3::scale(mat3::cross(n, slope), 1.0 / length);
            let ([u, v, w], y) = (product([a, b, 0.0]), product([b, c, 0.0]));
            let bending = u * u + v * v + w * w + mat3::dot(y, y);
            let normal: f64 = (0..12).map(|_| rng.unit()).sum::<f64>() - 6.0;
            let x = [u + eps * sqrt(bending) * normal, v, w];
            let window = Window {
                products: [mat3::apply(&back, x), mat3::apply(&back, y)],
                variance: [1e-3, 1e-4, 2e-3],
                normal: mat3::apply(&back, n),
                bending,
                share: 1.0,
            };
            let mut numbers = [0.0; NUMBERS];
            window.store(&mut numbers);
            numbers
        };
        (0..count).map(|_| one()).collect()
    }

    const NOISE: Mat3 = [[1e-6, 2e-7, 0.0], [2e-7, 3e-6, 1e-7], [0.0, 1e-7, 2e-6]];

    #[test]
    fn derivatives_are_those_of_the_cost_and_eps_is_found() {
        let rows = rotation([0.4, -0.3, 0.9]);
        let windows = windows(&rows, 0.05, 2000);
        let integrable = Integrable { windows: &windows, stride: 1, noise: NOISE };
        let off = mat3::multiply(&rotation([0.02, 0.03, -0.01]), &rows);
        let there = integrable.likelihood(&off, 0.0025);
        let by_differences = Value::of(&off, |rows| integrable.likelihood(rows, 0.0025).value.cost);
        for (a, b) in there.value.gradient.iter().zip(by_differences.gradient) {
            assert!((a - b).abs() < 1e-2 * b.abs().max(1.0), "{a} {b}");
        }
        let h = 1e-4;
        let [more, less] = [1.0 + h, 1.0 - h].map(|by| integrable.likelihood(&off, 0.0025 * by).value.cost);
        let slope = (more - less) / (2.0 * h);
        assert!((there.by_eps - slope).abs() < 1e-3 * slope.abs().max(1.0), "{} {slope}", there.by_eps);
        // A normal distribution of 0.05 is nearest to a Student's that is a little narrower.
        let cost = |eps: f64| integrable.likelihood(&rows, eps * eps).value.cost;
        assert!(cost(0.04) < cost(0.02) && cost(0.04) < cost(0.08));
        // It is cheapest in its own frame, and its twin costs the same.
        let own = cost(0.05);
        let [r1, r2, r3] = rows;
        let twin = [mat3::scale(r1, -1.0), mat3::scale(r2, -1.0), r3];
        assert!((integrable.likelihood(&twin, 0.0025).value.cost - own).abs() < 1e-9 * own.abs());
        assert!(there.value.cost > own + 10.0, "{} {own}", there.value.cost);
    }

    #[test]
    fn every_fourth_window_says_about_as_much() {
        let rows = rotation([0.1, 0.2, 0.3]);
        let windows = windows(&rows, 0.05, 2000);
        let all = Integrable { windows: &windows, stride: 1, noise: NOISE };
        let some = Integrable { stride: 4, ..all };
        let [a, b] = [all, some].map(|windows| windows.likelihood(&rows, 0.0025).value.information[2][2]);
        assert!((b / a - 1.0).abs() < 0.1, "{a} {b}");
    }
}
