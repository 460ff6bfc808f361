//! Up to 64 neighboring pixels at a time, and sets of them as bits.

/// Pixels read at a time, one bit of a [`Window`]'s masks each.
pub const WINDOW: usize = u64::BITS as usize;

/// Up to [`WINDOW`] neighboring pixels of one row, channels apart, with a bit a pixel for sets of them.
#[derive(Clone, Debug)]
pub struct Window {
    /// Column of the first pixel.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// How many pixels there are.
    pub len: usize,
    /// The channels r, g, b; values beyond `len` mean nothing.
    pub color: [[f32; WINDOW]; 3],
    /// A bit a pixel: in the picture and its mask.
    pub masked: u64,
}

impl Default for Window {
    fn default() -> Self {
        Self::new()
    }
}

impl Window {
    /// An empty window.
    #[must_use]
    pub const fn new() -> Self {
        Self { x: 0, y: 0, len: 0, color: [[0.0; WINDOW]; 3], masked: 0 }
    }

    /// Pixel `i` as a color, black beyond the window.
    #[must_use]
    #[inline]
    pub fn pixel(&self, i: usize) -> [f32; 3] {
        let [red, green, blue] = &self.color;
        match (red.get(i), green.get(i), blue.get(i)) {
            (Some(&r), Some(&g), Some(&b)) => [r, g, b],
            _ => [0.0; 3],
        }
    }

    /// A bit a pixel, set where `holds` says so of its color; bits beyond `len` mean nothing.
    #[inline]
    pub fn bits(&self, mut holds: impl FnMut(f32, f32, f32) -> bool) -> u64 {
        // Halves, because a bit of 32 is made where a color of 32 bits is compared.
        const HALF: usize = WINDOW / 2;
        let [red, green, blue] = self.color.each_ref().map(|channel| channel.as_chunks::<HALF>().0);
        let mut bits = 0;
        for (k, ((red, green), blue)) in red.iter().zip(green).zip(blue).enumerate() {
            let mut half = 0_u32;
            for (i, ((&r, &g), &b)) in red.iter().zip(green).zip(blue).enumerate() {
                half |= u32::from(holds(r, g, b)) << i;
            }
            bits |= u64::from(half) << (k * HALF);
        }
        bits
    }
}

/// The first `count` bits of a window.
pub(crate) const fn first_bits(count: usize) -> u64 {
    if count < WINDOW { (1 << count) - 1 } else { u64::MAX }
}

/// Visits the set bits of `bits`, lowest first.
#[inline]
pub fn for_each_bit(mut bits: u64, mut visit: impl FnMut(usize)) {
    while bits != 0 {
        visit(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}
