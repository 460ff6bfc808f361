//! W along a row of the frame: what it takes to turn the colors of one pixel after another into slopes.

use super::terms::{Order, TERMS};
use crate::orientation::relief::RowSlopes;
use crate::picture::WINDOW;

/// The coefficients of 1, x and x^2.
type Along = [f32; 3];

/// Both slopes along a row: what each relative color, and each product of two, is multiplied by.
#[derive(Clone, Copy)]
pub(crate) struct Row {
    colors: [[Along; 3]; 2],
    products: Option<[[Along; 6]; 2]>,
}

impl Row {
    /// W at this height in [-1, 1].
    pub fn of(w: [&[f64; TERMS]; 2], order: Order, y: f64) -> Self {
        const COLORS: usize = Order::Place.len();
        let colors = w.map(|row| gather(row.iter().take(COLORS), y));
        let products = (order == Order::Products).then(|| w.map(|row| gather(row.iter().skip(COLORS), y)));
        Self { colors, products }
    }

    /// What the relative colors of a pixel at x in [-1, 1] are multiplied by.
    pub fn at(&self, x: f32) -> [[f32; 3]; 2] {
        let at = |[a, b, c]: &Along| a + x * (b + x * c);
        let [[a, b, c], [d, e, f]] = &self.colors;
        [[at(a), at(b), at(c)], [at(d), at(e), at(f)]]
    }

    /// Both slopes of a pixel at x whose color relative to the plane is `delta`, with what [`at`](Self::at) gives there.
    pub fn of_pixel(&self, x: f32, [[a, b, c], [d, e, f]]: [[f32; 3]; 2], delta: [f32; 3]) -> [f32; 2] {
        let [red, green, blue] = delta;
        let mut slopes = [a * red + b * green + c * blue, d * red + e * green + f * blue];
        if let Some(products) = &self.products {
            let values = [red * red, red * green, red * blue, green * green, green * blue, blue * blue];
            for (slope, row) in slopes.iter_mut().zip(products) {
                for (&[a, b, c], value) in row.iter().zip(values) {
                    *slope += (a + x * (b + x * c)) * value;
                }
            }
        }
        slopes
    }
}

/// From coefficients of 1, x, y, x^2, xy and y^2, N after N, to those of the powers of x alone.
fn gather<'w, const N: usize>(mut coefficients: impl Iterator<Item = &'w f64>, y: f64) -> [Along; N] {
    let mut sums = [[0.0; 3]; N];
    for (power, factor) in [(0, 1.0), (1, 1.0), (0, y), (2, 1.0), (1, y), (0, y * y)] {
        for (sum, coefficient) in sums.iter_mut().zip(coefficients.by_ref()) {
            sum.iter_mut().skip(power).take(1).for_each(|sum| *sum += coefficient * factor);
        }
    }
    sums.map(|sum| sum.map(|coefficient| coefficient as f32))
}

/// Adds the values times what they are multiplied by.
fn add(slopes: &mut [f32; WINDOW], [a, b, c]: Along, x: &[f32; WINDOW], values: &[f32; WINDOW]) {
    for ((slope, x), value) in slopes.iter_mut().zip(x).zip(values) {
        *slope += (a + x * (b + x * c)) * value;
    }
}

impl RowSlopes for Row {
    fn slopes(&self, x: &[f32; WINDOW], delta: &[[f32; WINDOW]; 3]) -> [[f32; WINDOW]; 2] {
        let mut slopes = [[0.0; WINDOW]; 2];
        for (slopes, row) in slopes.iter_mut().zip(&self.colors) {
            for (along, delta) in row.iter().zip(delta) {
                add(slopes, *along, x, delta);
            }
        }
        if let Some(products) = &self.products {
            let [red, green, blue] = delta;
            let pairs = [(red, red), (red, green), (red, blue), (green, green), (green, blue), (blue, blue)];
            for (k, (first, second)) in pairs.into_iter().enumerate() {
                let mut values = [0.0; WINDOW];
                for ((value, first), second) in values.iter_mut().zip(first).zip(second) {
                    *value = first * second;
                }
                for (slopes, row) in slopes.iter_mut().zip(products) {
                    row.iter().skip(k).take(1).for_each(|along| add(slopes, *along, x, &values));
                }
            }
        }
        slopes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::terms::terms;

    #[test]
    fn slopes_along_a_row_are_w_times_the_terms() {
        let w = [0, 1].map(|k| core::array::from_fn(|i| ((k * 31 + i * 17) % 23) as f64 / 20.0 - 0.5));
        let x: [f32; WINDOW] = core::array::from_fn(|i| i as f32 / 32.0 - 1.0);
        let delta = [3, 5, 7].map(|k| core::array::from_fn(|i| (i * k % 11) as f32 / 20.0 - 0.25));
        for order in [Order::Constant, Order::Place, Order::Products] {
            let mut w: [[f64; TERMS]; 2] = w;
            for row in &mut w {
                row[order.len()..].fill(0.0);
            }
            let row = Row::of(w.each_ref(), order, 0.3);
            let slopes = row.slopes(&x, &delta);
            for i in 0..WINDOW {
                let terms = terms([f64::from(x[i]), 0.3], [0, 1, 2].map(|k| f64::from(delta[k][i])));
                let here = row.of_pixel(x[i], row.at(x[i]), [0, 1, 2].map(|k| delta[k][i]));
                for ((slopes, here), w) in slopes.iter().zip(here).zip(&w) {
                    let expected: f64 = w.iter().zip(terms).map(|(w, term)| w * term).sum();
                    assert!((f64::from(slopes[i]) - expected).abs() < 1e-6);
                    assert!((f64::from(here) - expected).abs() < 1e-6);
                }
            }
        }
    }
}
