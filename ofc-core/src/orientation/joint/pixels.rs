//! Quads of pixels: what four by four of them add, with those to the left and above.

use super::constants::SIDE;
use super::quads::Quads;

/// N of the pixels of a smallest square, with those to the left and above.
pub(super) type Normals = [[[f64; 3]; SIDE + 1]; SIDE + 1];

/// The quads whose lower right pixel lies in a smallest square. `bits` has a row of pixels each, the first of them above the
/// square; the lowest bit is the pixel to the left.
#[inline]
pub(super) fn quads(bits: [u64; SIDE + 1], normals: &Normals) -> Quads {
    let mut sums = Quads::default();
    let mut ends = [0; SIDE];
    let pairs = normals.iter().zip(bits).zip(normals.iter().zip(bits).skip(1));
    for (((above, above_bits), (row, row_bits)), ends) in pairs.zip(&mut ends) {
        let complete = row_bits & row_bits << 1 & above_bits & above_bits << 1;
        for (i, (upper, lower)) in above.windows(2).zip(row.windows(2)).enumerate() {
            if let (&[a, b], &[c, d]) = (upper, lower)
                && complete >> (i + 1) & 1 == 1
                && sums.add_quad(a, b, c, d)
            {
                *ends |= 1 << i;
            }
        }
    }
    add_ends(ends, &mut sums);
    sums
}

/// Adds the ends at pixels that lie in no last row or column: their four quads are known. They stand for all sixteen.
fn add_ends(quads: [u64; SIDE], sums: &mut Quads) {
    const ALL: u64 = (1 << SIDE) - 1;
    const TIMES: f64 = (SIDE * SIDE) as f64 / ((SIDE - 1) * (SIDE - 1)) as f64;
    if quads.iter().all(|&row| row == ALL) {
        return;
    }
    for (upper, lower) in quads.iter().zip(quads.iter().skip(1)) {
        for column in 0..SIDE - 1 {
            let is = |row: u64, column: usize| row >> column & 1 == 1;
            let around =
                [is(*upper, column), is(*upper, column + 1), is(*lower, column), is(*lower, column + 1)];
            let [a, b, c, d] = around;
            sums.add_end([d, c, b, a], TIMES);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_quads_end_nowhere_within_and_a_hole_ends_those_around_it() {
        let normals = [[[0.0, 0.0, 1.0]; SIDE + 1]; SIDE + 1];
        let full = quads([31; SIDE + 1], &normals);
        assert_eq!((full.count, full.ends), (16.0, [0.0; 3]));
        // Without the row above and the column to the left.
        let corner = quads([0, 30, 30, 30, 30], &normals);
        assert_eq!(corner.count, 9.0);
        // Without one pixel in the middle four quads are missing.
        let hole = quads([31, 31, 0b11011, 31, 31], &normals);
        assert_eq!(hole.count, 12.0);
        let [xx, _, yy] = hole.ends;
        assert!(xx > 1.0 && (xx - yy).abs() < 1e-12);
    }
}
