//! Quadratic forms in (r1, r2).

use crate::math::mat3::Mat3;

/// A symmetric 6x6 matrix, the upper triangle row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Form(pub [f64; 21]);

impl Form {
    pub const ZERO: Self = Self([0.0; 21]);

    /// Adds `weight v v^T`.
    pub fn add_square(&mut self, v: &[f64; 6], weight: f64) {
        let mut slots = self.0.iter_mut();
        for (i, a) in v.iter().enumerate() {
            for b in v.iter().skip(i) {
                if let Some(slot) = slots.next() {
                    *slot += weight * a * b;
                }
            }
        }
    }

    /// Adds `weight [[xx c, xy c], [xy c, yy c]]` with a symmetric 3x3 matrix `c`.
    pub fn add_noise(&mut self, c: &Mat3, [xx, xy, yy]: [f64; 3], weight: f64) {
        let mut slots = self.0.iter_mut();
        for (i, row) in c.iter().enumerate() {
            let upper = row.iter().skip(i).map(|entry| xx * entry);
            for term in upper.chain(row.iter().map(|entry| xy * entry)) {
                if let Some(slot) = slots.next() {
                    *slot += weight * term;
                }
            }
        }
        for (i, row) in c.iter().enumerate() {
            for entry in row.iter().skip(i) {
                if let Some(slot) = slots.next() {
                    *slot += weight * yy * entry;
                }
            }
        }
    }

    /// Adds another form.
    pub fn add(&mut self, other: &Self) {
        for (slot, term) in self.0.iter_mut().zip(other.0) {
            *slot += term;
        }
    }

    /// The value at the first two rows.
    pub fn at(&self, rows: &Mat3) -> f64 {
        let v = flat(rows);
        let mut entries = self.0.iter();
        let mut sum = 0.0;
        for (i, a) in v.iter().enumerate() {
            let mut line = 0.0;
            for (j, b) in v.iter().enumerate().skip(i) {
                let entry = entries.next().copied().unwrap_or(0.0);
                line += if j == i { entry * b } else { 2.0 * entry * b };
            }
            sum += a * line;
        }
        sum
    }
}

/// (r1, r2).
pub(super) const fn flat(rows: &Mat3) -> [f64; 6] {
    let [[a, b, c], [d, e, f], _] = *rows;
    [a, b, c, d, e, f]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mat3::{apply, dot};
    use crate::math::rng::Rng;

    #[test]
    fn a_form_has_the_value_of_what_was_added() {
        let mut rng = Rng::new(8);
        let mut number = || 2.0 * rng.unit() - 1.0;
        for _ in 0..20 {
            let rows = [(); 3].map(|()| [(); 3].map(|()| number()));
            let [r1, r2, _] = rows;
            let (mut form, mut expected) = (Form::ZERO, 0.0);
            for _ in 0..3 {
                let (v, weight): ([f64; 6], _) = ([(); 6].map(|()| number()), number());
                form.add_square(&v, weight);
                let [a, b, c, d, e, f] = v;
                let s = dot([a, b, c], r1) + dot([d, e, f], r2);
                expected += weight * s * s;
                let [xx, xy, xz, yy, yz, zz] = [(); 6].map(|()| number());
                let c = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
                let (variance, weight) = ([(); 3].map(|()| number()), number());
                form.add_noise(&c, variance, weight);
                let [along, mixed, across] = variance;
                let (one, other) = (apply(&c, r1), apply(&c, r2));
                let noise = along * dot(r1, one) + 2.0 * mixed * dot(r1, other) + across * dot(r2, other);
                expected += weight * noise;
            }
            let mut twice = form;
            twice.add(&form);
            assert!((form.at(&rows) - expected).abs() < 1e-12);
            assert!((twice.at(&rows) - 2.0 * expected).abs() < 1e-12);
        }
    }
}
