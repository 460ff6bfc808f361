//! Windows where there is no room for all: of every size as many as there is, spread evenly over the surface.

use super::area::Area;
use super::constants::{SHARES, WINDOW_SIZES};
use super::moments::{Moments, NUMBERS};
use super::record::{self, Record};
use crate::math::mat3::{self, Mat3};
use crate::picture::{Window, first_bits, for_each_bit};
use core::num::NonZero;

/// Numbers of a window, and two of scratch.
const ROOM: usize = NUMBERS + 2;

/// Windows of one size in rows and columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    /// Pixels along the side of a window.
    pub size: usize,
    /// Pixels from one to the next: less than `size` where they overlap.
    pitch: NonZero<usize>,
    columns: usize,
    rows: usize,
    from: [usize; 2],
    /// Which window comes first in memory.
    first: usize,
}

impl Spread {
    /// As many as `most` windows in this area, at least half a window apart; `first` windows are there already.
    fn new(size: usize, area: &Area, most: usize, first: usize) -> Self {
        let [width, height] = area.size.map(|pixels| pixels as usize);
        let pitch = NonZero::new(size / 2).unwrap_or(NonZero::<usize>::MIN);
        let mut spread = Self { size, pitch, columns: 0, rows: 0, from: [0; 2], first };
        if most == 0 || width < size || height < size {
            return spread;
        }
        let along = |pixels: usize, pitch: NonZero<usize>| (pixels - size) / pitch + 1;
        while along(width, spread.pitch) * along(height, spread.pitch) > most {
            spread.pitch = spread.pitch.saturating_add(1);
        }
        (spread.columns, spread.rows) = (along(width, spread.pitch), along(height, spread.pitch));
        let margin = |from: u32, pixels: usize, count: usize| {
            from as usize + (pixels - size - (count - 1) * spread.pitch.get()) / 2
        };
        let [x, y] = area.from;
        spread.from = [margin(x, width, spread.columns), margin(y, height, spread.rows)];
        spread
    }

    /// How many there are.
    pub const fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// As how many windows beside each other one of them counts.
    pub fn independent(&self) -> f64 {
        record::independent(self.pitch.get() as f64 / self.size as f64)
    }

    /// The pixel in the top left corner.
    fn corner(&self, column: usize, row: usize) -> [usize; 2] {
        let [x, y] = self.from;
        [x + column * self.pitch.get(), y + row * self.pitch.get()]
    }

    /// Which windows along an axis hold one of the pixels from `at` to `last`.
    fn around(&self, from: usize, count: usize, at: usize, last: usize) -> core::ops::Range<usize> {
        let beyond = (at + 1).saturating_sub(from + self.size);
        let begin = (beyond + self.pitch.get() - 1) / self.pitch;
        let end = if last < from { 0 } else { (last - from) / self.pitch + 1 };
        begin..end.min(count)
    }

    /// Adds the pixels `bits` of a window, whose N is `root` rho.
    fn add(&self, y: usize, window: &Window, bits: u64, root: &Mat3, numbers: &mut [[f32; NUMBERS]]) {
        let ([x0, y0], half) = (self.from, 0.5 * (self.size as f64 - 1.0));
        let last = window.x + window.len.saturating_sub(1);
        for row in self.around(y0, self.rows, y, y) {
            for column in self.around(x0, self.columns, window.x, last) {
                let [left, top] = self.corner(column, row);
                let bits = bits & among(window.x, left, self.size);
                if bits == 0 {
                    continue;
                }
                let mut sums = Moments::default();
                let up = half - (y - top) as f64;
                for_each_bit(bits, |i| {
                    let n = mat3::apply(root, window.pixel(i).map(f64::from));
                    sums.add_pixel((window.x + i) as f64 - left as f64 - half, up, n);
                });
                if let Some(numbers) = numbers.get_mut(self.first + row * self.columns + column) {
                    let mut all = Moments::load(numbers);
                    all.add(&sums, 0.0, 0.0);
                    all.store(numbers);
                }
            }
        }
    }

    /// Replaces the sums of every window by what `record` makes of them and of the window's middle, where it makes anything: how
    /// many there are, one after the other at the start of `numbers`.
    pub fn replace(
        &self,
        numbers: &mut [f32],
        record: impl Fn(&Moments, [f64; 2]) -> Option<Record>,
    ) -> usize {
        let (mut n, half) = (0, 0.5 * (self.size as f64 - 1.0));
        let places = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        for (i, (column, row)) in places.enumerate() {
            let read = numbers.get(i * NUMBERS..).and_then(<[f32]>::first_chunk).map(Moments::load);
            let [x, y] = self.corner(column, row).map(|at| at as f64);
            if let Some(sums) = read
                && let Some(made) = record(&sums, [x + half, -y - half])
                && let Some(out) = numbers.get_mut(n * record::NUMBERS..).and_then(<[f32]>::first_chunk_mut)
            {
                made.store(out);
                n += 1;
            }
        }
        n
    }
}

/// The bits of a window that begins at column `x` which lie in the `size` columns from `left` on.
const fn among(x: usize, left: usize, size: usize) -> u64 {
    first_bits((left + size).saturating_sub(x)) & !first_bits(left.saturating_sub(x))
}

/// Windows of all sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Windows {
    spreads: [Spread; WINDOW_SIZES.len()],
}

impl Windows {
    /// In an area, as many as `numbers` have room for.
    pub fn new(area: &Area, numbers: usize) -> Self {
        let most = numbers / ROOM;
        let ([a, b, c, d], [of_d, of_c, of_b]) = (WINDOW_SIZES, SHARES);
        let spread = |size, most, first| Spread::new(size, area, most, first);
        let d = spread(d, most / of_d, 0);
        let c = spread(c, most / of_c, d.count());
        let b = spread(b, most / of_b, c.first + c.count());
        let first = b.first + b.count();
        let a = spread(a, most - first, first);
        Self { spreads: [a, b, c, d] }
    }

    fn count(&self) -> usize {
        let [smallest, ..] = &self.spreads;
        smallest.first + smallest.count()
    }

    /// Before the first row.
    pub fn clear(&self, numbers: &mut [f32]) {
        numbers.iter_mut().take(self.count() * NUMBERS).for_each(|number| *number = 0.0);
    }

    /// Adds the pixels `bits` of a window of row `y`, whose N is `root` rho.
    pub fn add(&self, y: usize, window: &Window, bits: u64, root: &Mat3, numbers: &mut [f32]) {
        if bits != 0 {
            let (numbers, _) = numbers.as_chunks_mut();
            for spread in &self.spreads {
                spread.add(y, window, bits, root, numbers);
            }
        }
    }

    /// The windows of every size, smallest first.
    pub fn spreads(&self) -> impl Iterator<Item = &Spread> {
        self.spreads.iter()
    }

    /// The windows' own numbers, and the room behind all of them.
    pub fn split<'w>(
        &self,
        spread: &Spread,
        numbers: &'w mut [f32],
    ) -> Option<(&'w mut [f32], &'w mut [f32])> {
        let (numbers, scratch) = numbers.split_at_mut_checked(self.count() * NUMBERS)?;
        let range = spread.first * NUMBERS..(spread.first + spread.count()) * NUMBERS;
        Some((numbers.get_mut(range)?, scratch))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Area = Area { from: [10, 20], size: [100, 90] };

    #[test]
    fn as_many_as_there_is_room_for() {
        for numbers in [0, 17, 500, 5000, 50_000, 500_000] {
            let windows = Windows::new(&AREA, numbers);
            assert!(windows.count() * ROOM <= numbers);
            let mut first = windows.count();
            for spread in &windows.spreads {
                first -= spread.count();
                assert_eq!(spread.first, first);
                if spread.count() > 0 {
                    let [right, bottom] = spread.corner(spread.columns - 1, spread.rows - 1);
                    assert!(spread.from[0] >= 10 && spread.from[1] >= 20);
                    assert!(right + spread.size <= 110 && bottom + spread.size <= 110);
                    assert!(spread.pitch.get() >= spread.size / 2);
                }
            }
        }
        let [smallest, ..] = Windows::new(&AREA, 500_000).spreads;
        assert_eq!((smallest.columns, smallest.rows), (24, 21));
        // Half a window apart they overlap fourfold, and each counts a quarter of what one alone does.
        assert!((smallest.independent() - 0.125).abs() < 1e-15);
        let apart = Spread { pitch: NonZero::new(30).unwrap(), ..smallest };
        assert!((apart.independent() - 0.5).abs() < 1e-15);
    }

    #[test]
    fn every_pixel_is_in_the_windows_around_it() {
        for room in [2000, 10_000, 100_000] {
            let windows = Windows::new(&AREA, room);
            let mut numbers = std::vec![f32::NAN; room];
            windows.clear(&mut numbers);
            let mut window = Window::new();
            for y in 0..130 {
                for x in [0, 64] {
                    (window.x, window.y, window.len) = (x, y, if x == 0 { 64 } else { 36 });
                    window.color = [[1.0; 64]; 3];
                    windows.add(
                        y,
                        &window,
                        if x == 0 { u64::MAX } else { (1 << 36) - 1 },
                        &mat3::IDENTITY,
                        &mut numbers,
                    );
                }
            }
            for spread in windows.spreads() {
                let (own, _) = windows.split(spread, &mut numbers).unwrap();
                let side = spread.size as f64;
                spread.replace(own, |sums, [x, y]| {
                    // Columns up to 99 are there.
                    let width = (100.0 - (x - 0.5 * (side - 1.0))).clamp(0.0, side);
                    assert_eq!(sums.count(), width * side, "{x} {y} {}", spread.size);
                    None
                });
            }
        }
    }
}
