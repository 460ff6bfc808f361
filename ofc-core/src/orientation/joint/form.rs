//! Quadratic forms in (r1, r2).

use crate::math::mat3::Mat3;

/// A symmetric 6x6 matrix, the upper triangle row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Form(pub [f64; 21]);

impl Form {
    pub const ZERO: Self = Self([0.0; 21]);

    /// `[[xx, xy], [xy, yy]]` of symmetric 3x3 matrices.
    pub fn of_blocks(xx: &Mat3, xy: &Mat3, yy: &Mat3) -> Self {
        let ([[a, b, c], [_, d, e], [_, _, f]], [[g, h, i], [_, j, k], [_, _, l]]) = (*xx, *xy);
        let [[m, n, o], [_, p, q], [_, _, r]] = *yy;
        Self([a, b, c, g, h, i, d, e, h, j, k, f, i, k, l, m, n, o, p, q, r])
    }

    /// Adds `weight v v^T`.
    #[inline]
    pub fn add_square(&mut self, v: &[f64; 6], weight: f64) {
        let [a, b, c, d, e, f] = *v;
        let [aw, bw, cw, dw, ew, fw] = v.map(|entry| weight * entry);
        let terms = [
            [aw * a, aw * b, aw * c, aw * d, aw * e, aw * f, bw * b],
            [bw * c, bw * d, bw * e, bw * f, cw * c, cw * d, cw * e],
            [cw * f, dw * d, dw * e, dw * f, ew * e, ew * f, fw * f],
        ];
        for (slot, term) in self.0.iter_mut().zip(terms.as_flattened()) {
            *slot += term;
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
            let [xx, xy, yy] = [(); 3].map(|()| {
                let [a, b, c, d, e, f] = [(); 6].map(|()| number());
                [[a, b, c], [b, d, e], [c, e, f]]
            });
            let mut form = Form::of_blocks(&xx, &xy, &yy);
            let value = |c, a, b| dot(a, apply(c, b));
            let mut expected = value(&xx, r1, r1) + 2.0 * value(&xy, r1, r2) + value(&yy, r2, r2);
            for _ in 0..3 {
                let (v, weight): ([f64; 6], _) = ([(); 6].map(|()| number()), number());
                form.add_square(&v, weight);
                let [a, b, c, d, e, f] = v;
                let s = dot([a, b, c], r1) + dot([d, e, f], r2);
                expected += weight * s * s;
            }
            let mut twice = form;
            twice.add(&form);
            assert!((form.at(&rows) - expected).abs() < 1e-12);
            assert!((twice.at(&rows) - 2.0 * expected).abs() < 1e-12);
        }
    }
}
