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

    /// The channels of the pixels `bits`, times `scale`; zero elsewhere.
    pub(crate) fn only(&self, bits: u64, scale: f32) -> [[f32; WINDOW]; 3] {
        const HALF: usize = WINDOW / 2;
        let mut color = [[0.0; WINDOW]; 3];
        for (channel, out) in self.color.iter().zip(&mut color) {
            let halves = channel.as_chunks::<HALF>().0.iter().zip(out.as_chunks_mut::<HALF>().0);
            for ((half, out), bits) in halves.zip([bits as u32, (bits >> HALF) as u32]) {
                for (i, (value, out)) in half.iter().zip(out).enumerate() {
                    *out = if bits & 1 << i == 0 { 0.0 } else { value * scale };
                }
            }
        }
        color
    }

    /// A bit a pixel, set where `holds` says so of its color; bits beyond `len` mean nothing.
    #[inline]
    pub fn bits(&self, mut holds: impl FnMut(f32, f32, f32) -> bool) -> u64 {
        let [bits] = self.flags(|[r, g, b]| u8::from(holds(r, g, b)));
        bits
    }

    /// A bit a pixel for each of the first flags that `flags` says of its color, the lowest one first; bits beyond `len` mean nothing.
    #[inline]
    pub(crate) fn flags<const N: usize>(&self, mut flags: impl FnMut([f32; 3]) -> u8) -> [u64; N] {
        let [red, green, blue] = &self.color;
        let mut bytes = [0_u8; WINDOW];
        for (((byte, &r), &g), &b) in bytes.iter_mut().zip(red).zip(green).zip(blue) {
            *byte = flags([r, g, b]);
        }
        let mut flag = 0;
        [(); N].map(|()| {
            flag += 1;
            packed(&bytes, flag - 1)
        })
    }
}

/// Bit `flag` of every byte. Bytes are what vector instructions narrow comparisons to, and a product gathers the bits of eight: no two
/// of its terms meet.
#[inline(never)]
pub(crate) fn packed(bytes: &[u8; WINDOW], flag: u32) -> u64 {
    const LOWEST: u64 = 0x0101_0101_0101_0101;
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let (mut bits, mut place) = (0, 0);
    for eight in bytes.as_chunks::<8>().0 {
        let flags = u64::from_le_bytes(*eight) >> flag & LOWEST;
        bits |= (flags.wrapping_mul(GATHER) >> 56) << place;
        place += 8;
    }
    bits
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
