//! What noise adds to windows of one size: sums over them first, and one product with the noise afterwards.
//!
//! For a covariance C of N, `N x N_x` has the covariance `[N]x C [N]x^T` times a variance. It is linear in N N^T, and so
//! is the variance of `s`.

use super::form::Form;
use crate::math::mat3::{Mat3, cross, dot, scale};

/// Numbers of a [`Record`](super::record::Record) that its noise is linear in: its three variances times the six products of N.
pub(super) const TERMS: usize = 18;

/// These numbers of one window, or a weighted sum of them: six for each variance (xx, xy, yy).
pub(super) type Terms = [f64; TERMS];

/// The products of N with itself, times each of the variances.
#[inline]
pub(super) fn terms([x, y, z]: [f64; 3], variances: [f64; 3]) -> Terms {
    let products = [x * x, x * y, x * z, y * y, y * z, z * z];
    let mut terms = [0.0; TERMS];
    for (block, variance) in terms.as_chunks_mut::<6>().0.iter_mut().zip(variances) {
        *block = products.map(|product| variance * product);
    }
    terms
}

/// The sum over i of `[u]x C [v]x^T`, for a symmetric matrix that is the sum of their `u v^T`: the polarization of the cofactors.
fn mixed_cofactors(s: &Mat3, c: &Mat3) -> Mat3 {
    let ([s1, s2, s3], [c1, c2, c3]) = (*s, *c);
    let row = |a, b, c, d| {
        let ([x, y, z], [u, v, w]) = (cross(a, b), cross(c, d));
        [x + u, y + v, z + w]
    };
    [row(s2, c3, c2, s3), row(s3, c1, c3, s1), row(s1, c2, c1, s2)]
}

/// The form that the weighted sums of [`terms`] make with the covariance of N.
pub(super) fn form(terms: &Terms, noise: &Mat3) -> Form {
    let (blocks, _) = terms.as_chunks::<6>();
    let block = |i| {
        let [a, b, c, d, e, f] = blocks.get(i).copied().unwrap_or_default();
        mixed_cofactors(&[[a, b, c], [b, d, e], [c, e, f]], noise)
    };
    Form::of_blocks(&block(0), &block(1), &block(2))
}

/// The factors that make the variance of `s` of the [`terms`] of a window, for the first two rows.
pub(super) fn variance([r1, r2, _]: &Mat3, noise: &Mat3) -> Terms {
    let outer = |a: [f64; 3], b: [f64; 3]| a.map(|value| scale(b, value));
    let (one, other) = (outer(*r1, *r1), outer(*r2, *r2));
    let mut both = outer(*r1, *r2);
    for (row, line) in both.iter_mut().zip(outer(*r2, *r1)) {
        row.iter_mut().zip(line).for_each(|(entry, value)| *entry += value);
    }
    let mut factors = [0.0; TERMS];
    for (factors, products) in factors.as_chunks_mut::<6>().0.iter_mut().zip([one, both, other]) {
        let [[a, b, c], [_, d, e], [_, _, f]] = mixed_cofactors(&products, noise);
        *factors = [a, 2.0 * b, 2.0 * c, d, 2.0 * e, f];
    }
    factors
}

/// A sum of products.
#[inline]
pub(super) fn total(factors: &Terms, terms: &Terms) -> f64 {
    let (a, b) = (factors.as_chunks::<3>().0, terms.as_chunks::<3>().0);
    a.iter().zip(b).map(|(a, b)| dot(*a, *b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mat3::{apply, transpose};
    use crate::math::rng::Rng;

    #[test]
    fn noise_of_windows_is_that_of_their_terms() {
        let mut rng = Rng::new(8);
        let mut number = || 2.0 * rng.unit() - 1.0;
        for _ in 0..20 {
            let [rows, noise] = [(); 2].map(|()| [(); 3].map(|()| [(); 3].map(|()| number())));
            let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = noise;
            let noise = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            let ([r1, r2, _], mut sums, mut expected) = (rows, [0.0; TERMS], 0.0);
            for _ in 0..3 {
                let (n, v, weight) = ([(); 3].map(|()| number()), [(); 3].map(|()| number()), number());
                let crossed = noise.map(|row| cross(n, row));
                let c = transpose(&crossed).map(|column| cross(n, column));
                let ([along, mixed, across], one, other) = (v, apply(&c, r1), apply(&c, r2));
                let variance_of_s =
                    along * dot(r1, one) + 2.0 * mixed * dot(r1, other) + across * dot(r2, other);
                let own = terms(n, v);
                assert!((total(&variance(&rows, &noise), &own) - variance_of_s).abs() < 1e-12);
                sums.iter_mut().zip(own).for_each(|(sum, term)| *sum += weight * term);
                expected += weight * variance_of_s;
            }
            assert!((form(&sums, &noise).at(&rows) - expected).abs() < 1e-12);
        }
    }
}
