//! [`Moments`] of many colors, a window at a time: sums of fixed lanes, which vector instructions of any width add in one order.

use super::{Moments, TERMS};
use crate::picture::{WINDOW, Window};

/// Sums side by side.
const LANES: usize = 4;

/// A product of two channels, of every color of a window.
type Products = [f64; WINDOW];

/// The sums of [`Moments`] in lanes, and room for a window's products.
pub(crate) struct WindowMoments {
    count: u32,
    quartic: [[f64; LANES]; 15],
    quadratic: [[f64; LANES]; TERMS],
    products: [Products; TERMS],
}

impl WindowMoments {
    /// No colors yet.
    pub const fn new() -> Self {
        Self {
            count: 0,
            quartic: [[0.0; LANES]; 15],
            quadratic: [[0.0; LANES]; TERMS],
            products: [[0.0; WINDOW]; TERMS],
        }
    }

    /// Adds the colors `bits` of a window, times `scale`.
    pub fn add(&mut self, window: &Window, bits: u64, scale: f32) {
        if bits != 0 {
            self.add_colors(&window.only(bits, scale), bits.count_ones());
        }
    }

    /// Adds so many colors among others that are black, which adds nothing.
    #[inline(never)]
    pub fn add_colors(&mut self, [r, g, b]: &[[f32; WINDOW]; 3], count: u32) {
        self.count += count;
        let [r, g, b] = [r, g, b].map(|channel| channel.map(f64::from));
        let [rr, gg, bb, rg, rb, gb] = &mut self.products;
        for (product, [x, y]) in
            [(rr, [&r, &r]), (gg, [&g, &g]), (bb, [&b, &b]), (rg, [&r, &g]), (rb, [&r, &b]), (gb, [&g, &b])]
        {
            for ((product, x), y) in product.iter_mut().zip(x).zip(y) {
                *product = x * y;
            }
        }
        let [rr, gg, bb, rg, rb, gb] = &self.products;
        let [r4, r2g2, r2b2, r3g, r3b, r2gb, g4, g2b2, rg3, rg2b, g3b, b4, rgb2, rb3, gb3] =
            &mut self.quartic;
        add_products(rr, [rr, gg, bb], [r4, r2g2, r2b2]);
        add_products(rr, [rg, rb, gb], [r3g, r3b, r2gb]);
        add_products(gg, [gg, bb, rg], [g4, g2b2, rg3]);
        add_products(gg, [rb, gb], [rg2b, g3b]);
        add_products(bb, [bb, rg], [b4, rgb2]);
        add_products(bb, [rb, gb], [rb3, gb3]);
        for (sum, products) in self.quadratic.iter_mut().zip(&self.products) {
            for lanes in products.as_chunks::<LANES>().0 {
                for (sum, product) in sum.iter_mut().zip(lanes) {
                    *sum += product;
                }
            }
        }
    }

    /// The sums over all lanes.
    pub fn sum(&self) -> Moments {
        let sum = |[a, b, c, d]: &[f64; LANES]| (a + b) + (c + d);
        Moments {
            count: self.count,
            quartic: self.quartic.each_ref().map(sum),
            quadratic: self.quadratic.each_ref().map(sum),
        }
    }
}

/// Adds the products of `a` and each of `b` to its sums, which stay in registers meanwhile.
fn add_products<const N: usize>(a: &Products, b: [&Products; N], sums: [&mut [f64; LANES]; N]) {
    let mut totals = sums.each_ref().map(|sum| **sum);
    let mut b = b.map(|b| b.as_chunks::<LANES>().0.iter());
    for a in a.as_chunks::<LANES>().0 {
        for (total, b) in totals.iter_mut().zip(&mut b) {
            let Some(b) = b.next() else { continue };
            for ((total, a), b) in total.iter_mut().zip(a).zip(b) {
                *total += a * b;
            }
        }
    }
    for (sum, total) in sums.into_iter().zip(totals) {
        *sum = total;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::picture::for_each_bit;

    #[test]
    fn the_sums_are_those_of_the_colors_one_by_one() {
        let mut rng = Rng::new(16);
        let (mut lanes, mut one_by_one) = (WindowMoments::new(), Moments::default());
        let mut window = Window::new();
        for bits in [0, 1, 1 << 63, u64::MAX, rng.next_u64(), rng.next_u64() & rng.next_u64()] {
            for channel in &mut window.color {
                channel.fill_with(|| 100.0 * rng.unit() as f32 - 10.0);
            }
            // What is not selected may be anything.
            if bits & 2 == 0 {
                window.color[0][1] = f32::NAN;
            }
            lanes.add(&window, bits, 0.125);
            for_each_bit(bits, |i| one_by_one.add(window.pixel(i).map(|value| f64::from(value) * 0.125)));
        }
        let sum = lanes.sum();
        assert_eq!(sum.count, one_by_one.count);
        let pairs = sum.quartic.iter().zip(one_by_one.quartic);
        for (sum, expected) in pairs.chain(sum.quadratic.iter().zip(one_by_one.quadratic)) {
            assert!((sum / expected - 1.0).abs() < 1e-12, "{sum} {expected}");
        }
    }
}
