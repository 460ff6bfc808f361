//! The one word that the finest grid keeps for each pixel, and who reads what in it.
//!
//! While equations are solved, a word is a number in f32 with flags in the bits that the number can spare:
//!
//! | bits | meaning |
//! | --- | --- |
//! | 31 | the pixel's depth is known beforehand: [`KNOWN`] |
//! | 30 to 2 | the number, which is never negative: the root of the pixel's weight, zero outside of the mask |
//! | 1 and 0 | where the pixel belongs at the next coarser grid: [`Attachment`] |
//!
//! The number is read with the attachment's bits in it. They change a weight by less than what f32 rounds, and masking them
//! out would cost an operation for every neighbor of every pixel.
//!
//! Afterwards the first word of every run of pixels belongs to [`regions`](super::regions); the others, and every zero, stay.

/// Set where the pixel's depth is known beforehand.
const KNOWN: u32 = 1 << 31;

/// The bits of the attachment.
const ATTACHMENT: u32 = 3;

/// How a pixel takes part in the next coarser grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attachment {
    /// It belongs to the block it lies in.
    Own,
    /// It is cut off from the rest of its block and from its neighbors' blocks.
    None,
    /// It belongs to the block beyond its horizontal edge out of the block.
    Beside,
    /// It belongs to the block beyond its vertical edge out of the block.
    Across,
}

impl Attachment {
    pub const fn bits(self) -> u32 {
        match self {
            Self::Own => 0,
            Self::None => 1,
            Self::Beside => 2,
            Self::Across => 3,
        }
    }

    pub const fn from_bits(bits: u32) -> Self {
        match bits & ATTACHMENT {
            0 => Self::Own,
            1 => Self::None,
            2 => Self::Beside,
            _ => Self::Across,
        }
    }
}

/// The word of a pixel that stands for its own block, with a number that is not negative.
pub(super) const fn word(number: f32) -> u32 {
    number.to_bits() & !(KNOWN | ATTACHMENT)
}

/// The word of a pixel of weight one without flags.
pub(super) const ONE: u32 = word(1.0);

/// The number of a word.
#[inline(always)]
pub(super) const fn number(word: u32) -> f32 {
    f32::from_bits(word & !KNOWN)
}

/// Whether the pixel's depth is known beforehand.
#[inline(always)]
pub(super) const fn is_known(word: u32) -> bool {
    word & KNOWN != 0
}

/// The word of the same pixel, of which the depth is known beforehand.
pub(super) const fn known(word: u32) -> u32 {
    word | KNOWN
}

/// Where the pixel belongs at the next coarser grid.
#[inline(always)]
pub(super) const fn attachment(word: u32) -> Attachment {
    Attachment::from_bits(word)
}

/// The word of the same pixel with another attachment.
pub(super) const fn attached(word: u32, attachment: Attachment) -> u32 {
    word & !ATTACHMENT | attachment.bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_do_not_touch_each_other() {
        let all = [Attachment::Own, Attachment::None, Attachment::Beside, Attachment::Across];
        for weight in [1e-2_f32, 0.7, 1.0, 100.0] {
            let plain = word(weight);
            assert!((number(plain) - weight).abs() <= 4.0 * f32::EPSILON * weight && !is_known(plain));
            for place in all {
                let other = attached(known(attached(plain, Attachment::Across)), place);
                assert!(is_known(other) && attachment(other) == place);
                assert!((number(other) - weight).abs() <= 4.0 * f32::EPSILON * weight);
            }
        }
        assert_eq!((word(0.0), word(-0.0), number(ONE)), (0, 0, 1.0));
    }
}
