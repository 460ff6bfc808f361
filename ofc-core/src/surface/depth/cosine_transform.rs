//! Cosine transforms of the columns of a picture, sixteen at a time, to a spectrum whose rows are the columns.
//!
//! Each complex signal of the Fourier transform is made of two columns, reordered so that its spectrum holds the cosine
//! transforms of both.
//!
//! # Reference
//! J. Makhoul, "A fast cosine transform in one and two dimensions", IEEE Trans. ASSP 28 (1980).

use super::fourier::{Lanes, Lengths, Row, add, scale, subtract};
use super::operator::{at, copy};
use core::f64::consts::PI;
use libm::sincos;

/// Columns that are transformed together.
const COLUMNS: usize = 16;

/// A transform with its tables and its scratch.
pub(super) struct CosineTransform<'a> {
    lengths: Lengths,
    twiddles: &'a mut [f32],
    order: &'a mut [u32],
    turns: &'a mut [f32],
    scratch: &'a mut [Row],
}

/// Rows of numbers in a slice, `stride` apart.
pub(super) struct Rows<T> {
    pub data: T,
    pub stride: usize,
}

impl Rows<&mut [f32]> {
    pub fn view(&self) -> Rows<&[f32]> {
        Rows { data: self.data, stride: self.stride }
    }
}

impl<'a> CosineTransform<'a> {
    /// Numbers that are needed as workspace for columns of `n`, beside `n` integers.
    pub const fn workspace_len(n: usize) -> usize {
        // Twiddles, scratch; six factors for every pair of frequencies.
        (2 + COLUMNS) * n + 6 * (n / 2 + 1)
    }

    /// Prepares the transform of columns of `n` numbers; the forward transform multiplies frequency k by `weight(k)`.
    /// `None` if `n` has large prime factors or the workspace is too short.
    pub fn new(
        n: usize,
        weight: impl Fn(usize) -> f64,
        mut workspace: &'a mut [f32],
        integers: &'a mut [u32],
    ) -> Option<Self> {
        let lengths = Lengths::new(n)?;
        let twiddles = workspace.split_off_mut(..2 * n)?;
        let order = integers.get_mut(..n)?;
        let turns = workspace.split_off_mut(..6 * (n / 2 + 1))?;
        let scratch = workspace.split_off_mut(..COLUMNS * n)?;
        let scratch = scratch.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0;
        lengths.fill_twiddles(twiddles);
        lengths.fill_order(order);
        for (k, slot) in turns.as_chunks_mut::<6>().0.iter_mut().enumerate() {
            let (sin, cos) = sincos(PI * k as f64 / (2 * n) as f64);
            let (low, high) = (0.5 * weight(k), 0.5 * weight(n - k));
            *slot = [cos * low, sin * low, cos * high, sin * high, cos, sin].map(|factor| factor as f32);
        }
        Some(Self { lengths, twiddles, order, turns, scratch })
    }

    /// `spectrum[x][k] = weight(k) * sum over y of picture[y][x] cos(pi (2 y + 1) k / 2 n)`.
    pub fn forward(&mut self, picture: &Rows<&[f32]>, width: usize, spectrum: &mut Rows<&mut [f32]>) {
        for x in (0..width).step_by(COLUMNS) {
            self.load(picture, x, width);
            self.lengths.transform(self.twiddles, self.scratch);
            self.untangle();
            self.store_spectrum(x, width, spectrum);
        }
    }

    /// Undoes [`forward`](Self::forward) but for the weights and a factor of n.
    pub fn backward(&mut self, spectrum: &Rows<&[f32]>, width: usize, picture: &mut Rows<&mut [f32]>) {
        for x in (0..width).step_by(COLUMNS) {
            self.load_spectrum(spectrum, x, width);
            self.tangle();
            self.lengths.transform(self.twiddles, self.scratch);
            self.store(x, width, picture);
        }
    }

    /// Columns from `x` on: even rows downward, then odd rows upward.
    fn load(&mut self, picture: &Rows<&[f32]>, x: usize, width: usize) {
        let n = self.lengths.n;
        let end = width.min(x + COLUMNS);
        for (y, row) in picture.data.chunks(picture.stride.max(1)).take(n).enumerate() {
            let place = if y.is_multiple_of(2) { y / 2 } else { n - 1 - y / 2 };
            let (Some(slot), Some(row)) = (self.scratch.get_mut(place), row.get(x..end)) else { continue };
            let slot = slot.as_flattened_mut().as_flattened_mut();
            if let (Some(slot), Some(row)) = (slot.first_chunk_mut::<COLUMNS>(), row.first_chunk()) {
                *slot = *row;
            } else {
                slot.fill(0.0);
                copy(slot, row);
            }
        }
    }

    /// The reverse of [`load`](Self::load), from the places where the transform has left them.
    fn store(&self, x: usize, width: usize, picture: &mut Rows<&mut [f32]>) {
        let n = self.lengths.n;
        let end = width.min(x + COLUMNS);
        for (y, row) in picture.data.chunks_mut(picture.stride.max(1)).take(n).enumerate() {
            let place = if y.is_multiple_of(2) { y / 2 } else { n - 1 - y / 2 };
            let place = at(self.order, place);
            let (Some(slot), Some(row)) = (self.scratch.get(place as usize), row.get_mut(x..end)) else {
                continue;
            };
            // Real and imaginary parts are the wrong way round: see `tangle`.
            let slot = slot.map(|[im, re]| [re, im]);
            let slot = slot.as_flattened().as_flattened();
            if let (Some(slot), Some(row)) = (slot.first_chunk(), row.first_chunk_mut::<COLUMNS>()) {
                *row = *slot;
            } else {
                copy(row, slot);
            }
        }
    }

    /// Makes cosine transforms of Fourier transforms, in their places.
    fn untangle(&mut self) {
        let mut turns = self.turns.as_chunks::<6>().0.iter();
        let others = self.order.get(1..).unwrap_or_default();
        let first = self.order.first().into_iter();
        let pairs = first.clone().zip(first).chain(others.iter().zip(others.iter().rev()));
        for ((a, b), [cos, sin, other_cos, other_sin, ..]) in pairs.zip(turns.by_ref()) {
            let (a, b) = (*a as usize, *b as usize);
            let (Some(one), Some(two)) = (self.scratch.get(a), self.scratch.get(b)) else { continue };
            let (mut low, mut high) = (*one, *two);
            for (low, high) in low.iter_mut().zip(&mut high) {
                let ([ar, ai], [br, bi]) = (*low, *high);
                let columns = [[add(ar, br), subtract(ai, bi)], [add(ai, bi), subtract(br, ar)]];
                *low = columns.map(|[re, im]| add(scale(*cos, re), scale(*sin, im)));
                *high = columns.map(|[re, im]| subtract(scale(*other_sin, re), scale(*other_cos, im)));
            }
            put(self.scratch, b, high);
            put(self.scratch, a, low);
        }
    }

    /// Makes Fourier transforms of cosine transforms, real and imaginary parts exchanged, so that the transform that
    /// follows is the inverse one.
    fn tangle(&mut self) {
        let n = self.lengths.n;
        for k in 0..=n / 2 {
            let Some(&[.., cos, sin]) = self.turns.as_chunks::<6>().0.get(k) else { continue };
            let (Some(one), two) = (self.scratch.get(k), self.scratch.get(n - k)) else { continue };
            // Frequency n is zero.
            let (mut low, mut high) = (*one, two.copied().unwrap_or_default());
            for (low, high) in low.iter_mut().zip(&mut high) {
                let ([a, b], [other_a, other_b]) = (*low, *high);
                let [[a, a_im], [b, b_im]] = [(a, other_a), (b, other_b)].map(|(one, two)| {
                    [add(scale(cos, one), scale(sin, two)), subtract(scale(sin, one), scale(cos, two))]
                });
                *low = [add(a_im, b), subtract(a, b_im)];
                *high = [subtract(b, a_im), add(a, b_im)];
            }
            put(self.scratch, n - k, high);
            put(self.scratch, k, low);
        }
    }

    /// Writes the scratch to rows `x` and following of the spectrum.
    fn store_spectrum(&self, x: usize, width: usize, spectrum: &mut Rows<&mut [f32]>) {
        let n = self.lengths.n;
        let stride = spectrum.stride.max(1);
        let data = spectrum.data.get_mut(x * stride..).unwrap_or_default();
        let mut rows = data.chunks_mut(stride).take(width.saturating_sub(x));
        let value = |place: u32| self.scratch.get(place as usize).copied().unwrap_or_default();
        for part in 0..COLUMNS / 4 {
            let lanes = |place: u32| pick(&value(place), part);
            let four = [rows.next(), rows.next(), rows.next(), rows.next()];
            if let [Some(a), Some(b), Some(c), Some(d)] = four {
                let [(a, ra), (b, rb), (c, rc), (d, rd)] =
                    [a, b, c, d].map(|row| row.get_mut(..n).unwrap_or_default().as_chunks_mut::<4>());
                let (places, rest) = self.order.as_chunks::<4>();
                for ((((a, b), c), d), places) in a.iter_mut().zip(b).zip(c).zip(d).zip(places) {
                    [*a, *b, *c, *d] = transposed(places.map(lanes));
                }
                for ((((a, b), c), d), &place) in ra.iter_mut().zip(rb).zip(rc).zip(rd).zip(rest) {
                    [*a, *b, *c, *d] = lanes(place);
                }
            } else {
                for (lane, row) in four.into_iter().flatten().enumerate() {
                    for (slot, &place) in row.iter_mut().zip(self.order.iter()) {
                        *slot = lanes(place).get(lane).copied().unwrap_or(0.0);
                    }
                }
            }
        }
    }

    /// Reads rows `x` and following of the spectrum, zero where there is none.
    fn load_spectrum(&mut self, spectrum: &Rows<&[f32]>, x: usize, width: usize) {
        let n = self.lengths.n;
        let stride = spectrum.stride.max(1);
        let data = spectrum.data.get(x * stride..).unwrap_or_default();
        let mut rows = data.chunks(stride).take(width.saturating_sub(x));
        for part in 0..COLUMNS / 4 {
            let four = [rows.next(), rows.next(), rows.next(), rows.next()];
            if let [Some(a), Some(b), Some(c), Some(d)] = four {
                let [(a, ra), (b, rb), (c, rc), (d, rd)] =
                    [a, b, c, d].map(|row| row.get(..n).unwrap_or_default().as_chunks::<4>());
                let (slots, rest) = self.scratch.as_chunks_mut::<4>();
                for ((((a, b), c), d), slots) in a.iter().zip(b).zip(c).zip(d).zip(slots) {
                    for (slot, lanes) in slots.iter_mut().zip(transposed([*a, *b, *c, *d])) {
                        replace(slot, part, lanes);
                    }
                }
                for ((((a, b), c), d), slot) in ra.iter().zip(rb).zip(rc).zip(rd).zip(rest) {
                    replace(slot, part, [*a, *b, *c, *d]);
                }
            } else {
                let [a, b, c, d] = four.map(Option::unwrap_or_default);
                for (k, slot) in self.scratch.iter_mut().enumerate() {
                    replace(slot, part, [a, b, c, d].map(|row| at(row, k)));
                }
            }
        }
    }
}

fn put(rows: &mut [Row], place: usize, row: Row) {
    if let Some(slot) = rows.get_mut(place) {
        *slot = row;
    }
}

/// Four of the sixteen numbers of a row.
#[inline(always)]
fn pick([[a, b], [c, d]]: &Row, part: usize) -> Lanes {
    match part {
        0 => *a,
        1 => *b,
        2 => *c,
        _ => *d,
    }
}

#[inline(always)]
fn replace([[a, b], [c, d]]: &mut Row, part: usize, lanes: Lanes) {
    match part {
        0 => *a = lanes,
        1 => *b = lanes,
        2 => *c = lanes,
        _ => *d = lanes,
    }
}

#[inline(always)]
fn transposed([a, b, c, d]: [Lanes; 4]) -> [Lanes; 4] {
    let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (a, b);
    let ([c0, c1, c2, c3], [d0, d1, d2, d3]) = (c, d);
    [[a0, b0, c0, d0], [a1, b1, c1, d1], [a2, b2, c2, d2], [a3, b3, c3, d3]]
}
