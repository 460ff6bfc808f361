//! Quads of the smallest squares: less detail than those of pixels, and less noise.

use super::quads::Quads;

/// Numbers of a [`Square`].
pub(super) const SQUARE_NUMBERS: usize = 4;

/// One of the smallest squares, as its neighbors in the next column and row see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Square {
    /// N in its middle, if it is known.
    pub normal: Option<[f64; 3]>,
    /// Whether it is the lower right one of a quad.
    pub ends_quad: bool,
}

impl Square {
    const KNOWN: f32 = 1.0;
    const ENDS_QUAD: f32 = 2.0;

    pub fn load(&[x, y, z, flags]: &[f32; SQUARE_NUMBERS]) -> Self {
        let normal = (flags >= Self::KNOWN).then_some([x, y, z].map(f64::from));
        Self { normal, ends_quad: flags >= Self::ENDS_QUAD }
    }

    pub fn store(&self, numbers: &mut [f32; SQUARE_NUMBERS]) {
        let flags = match (self.normal, self.ends_quad) {
            (None, _) => 0.0,
            (Some(_), false) => Self::KNOWN,
            (Some(_), true) => Self::ENDS_QUAD,
        };
        let [x, y, z] = self.normal.unwrap_or_default().map(|value| value as f32);
        *numbers = [x, y, z, flags];
    }
}

/// The quad of four squares, upper left, upper right, lower left and lower right, if it is one. What its upper left square's noise
/// does is known with it, from the quads around that.
pub(super) fn quad(a: &Square, b: &Square, c: &Square, d: &mut Square) -> Quads {
    let mut sums = Quads::default();
    if let (Some(a), Some(b), Some(c), Some(own)) = (a.normal, b.normal, c.normal, d.normal) {
        d.ends_quad = sums.add_quad(a, b, c, own);
    }
    sums.add_end([d.ends_quad, c.ends_quad, b.ends_quad, a.ends_quad], 1.0);
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_its_numbers() {
        let normal = Some([0.5, -0.25, 1.0]);
        let known = Square { normal, ends_quad: false };
        for square in [Square::default(), known, Square { ends_quad: true, ..known }] {
            let mut numbers = [f32::NAN; SQUARE_NUMBERS];
            square.store(&mut numbers);
            assert_eq!(Square::load(&numbers), square);
        }
    }

    #[test]
    fn four_known_squares_are_a_quad() {
        let known = Square { normal: Some([0.0, 0.0, 1.0]), ends_quad: false };
        let mut last = known;
        assert_eq!(quad(&known, &known, &known, &mut last).count, 1.0);
        assert!(last.ends_quad);
        let mut last = known;
        assert_eq!(quad(&known, &Square::default(), &known, &mut last).count, 0.0);
        assert!(!last.ends_quad);
    }
}
