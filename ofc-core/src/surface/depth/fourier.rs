//! Fast Fourier transforms of several signals side by side, of any length without prime factors above 7.
//!
//! Decimation in frequency, in place, in radices 4, 2, 3, 5 and 7: frequency k ends up where [`Lengths::fill_order`] says. Each
//! number of a [`Row`] belongs to a signal of its own, so that all arithmetic is on neighboring numbers and nobody needs
//! to know how wide the machine's registers are.
//!
//! # Reference
//! C. Van Loan, "Computational Frameworks for the Fast Fourier Transform" (1992), sections 1.9 and 2.1.

use core::array::from_fn;
use core::f64::consts::TAU;
use libm::sincos;

/// Four numbers that are worked on together.
pub(super) type Lanes = [f32; 4];

/// Four complex numbers: real and imaginary parts.
pub(super) type Complex = [Lanes; 2];

/// One sample of eight complex signals.
pub(super) type Row = [Complex; 2];

/// Factors of a length below 2^29 at most.
const MAX_FACTORS: usize = 20;

/// A length and its factors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lengths {
    pub n: usize,
    radices: [usize; MAX_FACTORS],
}

impl Lengths {
    /// `None` if `n` has a prime factor above 7.
    pub fn new(n: usize) -> Option<Self> {
        let mut radices = [1; MAX_FACTORS];
        let mut slots = radices.iter_mut();
        let mut rest = n;
        // The fours come last: the last of them needs no twiddles.
        for radix in [7, 5, 3] {
            while rest > 0 && rest.is_multiple_of(radix) {
                *slots.next()? = radix;
                rest /= radix;
            }
        }
        if rest.trailing_zeros() % 2 == 1 {
            *slots.next()? = 2;
            rest /= 2;
        }
        while rest > 1 && rest.is_multiple_of(4) {
            *slots.next()? = 4;
            rest /= 4;
        }
        (rest == 1).then_some(Self { n, radices })
    }

    /// Every radix with the length of the blocks that it splits.
    fn stages(&self) -> impl Iterator<Item = (usize, usize)> {
        let mut rest = self.n;
        self.radices.into_iter().take_while(|&radix| radix > 1).map(move |radix| {
            let len = rest;
            rest /= radix;
            (radix, len)
        })
    }

    /// Writes the twiddles: of every stage, for every j, `exp(-2 pi i j m / len)` for m from 1 to radix - 1.
    pub fn fill_twiddles(&self, twiddles: &mut [f32]) {
        let mut slots = twiddles.as_chunks_mut::<2>().0.iter_mut();
        for (radix, len) in self.stages() {
            for j in 0..len / radix {
                for (m, slot) in (1..radix).zip(slots.by_ref()) {
                    let (sin, cos) = sincos(TAU * (j * m) as f64 / len as f64);
                    *slot = [cos as f32, -sin as f32];
                }
            }
        }
    }

    /// Writes where each frequency ends up.
    pub fn fill_order(&self, order: &mut [u32]) {
        let mut filled = 1;
        if let Some(first) = order.first_mut() {
            *first = 0;
        }
        for (radix, len) in self.stages() {
            for m in 1..radix {
                let (done, rest) = order.split_at_mut_checked(m * filled).unwrap_or_default();
                for (slot, before) in rest.iter_mut().zip(done).take(filled) {
                    *slot = *before + u32::try_from(m * (len / radix)).unwrap_or(0);
                }
            }
            filled *= radix;
        }
    }

    /// Transforms in place.
    pub fn transform(&self, mut twiddles: &[f32], data: &mut [Row]) {
        for (radix, len) in self.stages() {
            let (own, rest) = twiddles.split_at_checked(2 * (radix - 1) * (len / radix)).unwrap_or_default();
            twiddles = rest;
            match radix {
                2 => data.chunks_exact_mut(len.max(1)).for_each(|block| halve(block, own)),
                3 => split_odd::<3, 1>(data, len, own),
                4 if len == 4 => data.as_chunks_mut::<4>().0.iter_mut().for_each(quarter_last),
                4 => data.chunks_exact_mut(len.max(1)).for_each(|block| quarter(block, own)),
                5 => split_odd::<5, 2>(data, len, own),
                _ => split_odd::<7, 3>(data, len, own),
            }
        }
    }
}

#[inline(always)]
pub(super) fn add([a, b, c, d]: Lanes, [e, f, g, h]: Lanes) -> Lanes {
    [a + e, b + f, c + g, d + h]
}

#[inline(always)]
pub(super) fn subtract([a, b, c, d]: Lanes, [e, f, g, h]: Lanes) -> Lanes {
    [a - e, b - f, c - g, d - h]
}

#[inline(always)]
pub(super) fn scale(factor: f32, [a, b, c, d]: Lanes) -> Lanes {
    [factor * a, factor * b, factor * c, factor * d]
}

#[inline(always)]
fn both(a: Complex, b: Complex, operation: impl Fn(Lanes, Lanes) -> Lanes) -> Complex {
    let ([ar, ai], [br, bi]) = (a, b);
    [operation(ar, br), operation(ai, bi)]
}

/// The product with one complex number.
#[inline(always)]
fn turn([re, im]: Complex, [cos, sin]: [f32; 2]) -> Complex {
    [subtract(scale(cos, re), scale(sin, im)), add(scale(cos, im), scale(sin, re))]
}

/// Sums of four values times the powers of -i.
#[inline(always)]
fn fourth_roots([a, b, c, d]: [Complex; 4]) -> [Complex; 4] {
    let (even, odd) = (both(a, c, add), both(a, c, subtract));
    let (sum, [re, im]) = (both(b, d, add), both(b, d, subtract));
    let ([odd_re, odd_im], zero) = (odd, both(even, sum, add));
    let one = [add(odd_re, im), subtract(odd_im, re)];
    let three = [subtract(odd_re, im), add(odd_im, re)];
    [zero, one, both(even, sum, subtract), three]
}

fn quarter(block: &mut [Row], twiddles: &[f32]) {
    let n = block.len() / 4;
    let (first, second) = block.split_at_mut_checked(2 * n).unwrap_or_default();
    let (a, b) = first.split_at_mut_checked(n).unwrap_or_default();
    let (c, d) = second.split_at_mut_checked(n).unwrap_or_default();
    for ((((a, b), c), d), w) in a.iter_mut().zip(b).zip(c).zip(d).zip(twiddles.as_chunks::<6>().0) {
        let [wb, wb_im, wc, wc_im, wd, wd_im] = *w;
        for (((a, b), c), d) in a.iter_mut().zip(b).zip(c).zip(d) {
            let [zero, one, two, three] = fourth_roots([*a, *b, *c, *d]);
            *a = zero;
            *b = turn(one, [wb, wb_im]);
            *c = turn(two, [wc, wc_im]);
            *d = turn(three, [wd, wd_im]);
        }
    }
}

/// The last step of [`quarter`]s, in which nothing is left to turn.
fn quarter_last([a, b, c, d]: &mut [Row; 4]) {
    for (((a, b), c), d) in a.iter_mut().zip(b).zip(c).zip(d) {
        [*a, *b, *c, *d] = fourth_roots([*a, *b, *c, *d]);
    }
}

fn halve(block: &mut [Row], twiddles: &[f32]) {
    let (a, b) = block.split_at_mut_checked(block.len() / 2).unwrap_or_default();
    for ((a, b), w) in a.iter_mut().zip(b).zip(twiddles.as_chunks::<2>().0) {
        for (a, b) in a.iter_mut().zip(b) {
            (*a, *b) = (both(*a, *b, add), turn(both(*a, *b, subtract), *w));
        }
    }
}

/// Radix `R = 2 H + 1`, a prime, by the symmetry of cosine and sine, on blocks of `len`.
fn split_odd<const R: usize, const H: usize>(data: &mut [Row], len: usize, twiddles: &[f32]) {
    // Of 2 pi (j + 1) (m + 1) / R, j by row.
    let roots: [[[f32; 2]; H]; H] = from_fn(|j| {
        from_fn(|m| {
            let (sin, cos) = sincos(TAU * ((j + 1) * (m + 1)) as f64 / R as f64);
            [cos as f32, sin as f32]
        })
    });
    let n = len / R;
    for block in data.chunks_exact_mut(len.max(1)) {
        let mut twiddles = twiddles.chunks_exact(2 * (R - 1));
        for place in 0..n {
            let w = twiddles.next().unwrap_or_default().as_chunks::<2>().0;
            for half in 0..2 {
                let slot = |m| block.get(place + m * n).and_then(|row: &Row| row.get(half));
                let values: [Complex; R] = from_fn(|m| slot(m).copied().unwrap_or_default());
                let mut results = odd_roots(&values, &roots).into_iter();
                let mut store = |m: usize, value: Complex| {
                    if let Some(slot) = block.get_mut(place + m * n).and_then(|row| row.get_mut(half)) {
                        *slot = value;
                    }
                };
                store(0, results.next().unwrap_or_default());
                for (m, (value, w)) in results.zip(w).enumerate() {
                    store(m + 1, turn(value, *w));
                }
            }
        }
    }
}

/// Sums of `R` values times the powers of each `R`-th root of one.
#[inline(always)]
fn odd_roots<const R: usize, const H: usize>(
    values: &[Complex; R],
    roots: &[[[f32; 2]; H]; H],
) -> [Complex; R] {
    let value = |m: usize| values.get(m).copied().unwrap_or_default();
    let sums: [Complex; H] = from_fn(|m| both(value(m + 1), value(R - 1 - m), add));
    let differences: [Complex; H] = from_fn(|m| both(value(m + 1), value(R - 1 - m), subtract));
    let mut results = [value(0); R];
    let [first, others @ ..] = results.as_mut_slice() else { return results };
    *first = sums.into_iter().fold(*first, |sum, s| both(sum, s, add));
    let (low, high) = others.split_at_mut_checked(H).unwrap_or_default();
    for ((low, high), roots) in low.iter_mut().zip(high.iter_mut().rev()).zip(roots) {
        let (mut even, mut odd) = (*low, Complex::default());
        for ((s, d), [cos, sin]) in sums.iter().zip(&differences).zip(roots) {
            even = both(even, s.map(|lanes| scale(*cos, lanes)), add);
            odd = both(odd, d.map(|lanes| scale(*sin, lanes)), add);
        }
        // The odd part times -i.
        let [re, im] = odd;
        *low = both(even, [im, scale(-1.0, re)], add);
        *high = both(even, [im, scale(-1.0, re)], subtract);
    }
    results
}
