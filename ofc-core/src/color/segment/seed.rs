//! Where a region begins: of many random blocks of six pixels, the one that most pixels around agree with.

use super::field::{FREE, Field};
use super::params::Params;
use crate::color::ellipsoid::{Coefficients, is_positive_definite, single_residual};
use crate::color::regression::{self, TERMS};
use crate::math::rng::Rng;

/// The distances between the pixels of a block that are tried in turn.
const SPACINGS: [u32; 5] = [1, 2, 4, 8, 16];
/// Pixels around a block are looked at in these directions, and at so many distances in each.
const DIRECTIONS: [[i32; 2]; 16] = [
    [8, 0],
    [7, 3],
    [6, 6],
    [3, 7],
    [0, 8],
    [-3, 7],
    [-6, 6],
    [-7, 3],
    [-8, 0],
    [-7, -3],
    [-6, -6],
    [-3, -7],
    [0, -8],
    [3, -7],
    [6, -6],
    [7, -3],
];
const DISTANCES: i32 = 4;
/// Fewer agreeing pixels than this are chance.
const SMALLEST_AGREEMENT: u32 = 8;

/// A block and the form through its colors.
#[derive(Clone, Copy)]
pub(super) struct Seed {
    pub(super) form: Coefficients,
    /// Column and row of the top left pixel.
    pub(super) corner: [u32; 2],
    pub(super) spacing: u32,
    /// The index of the top left pixel.
    pub(super) index: usize,
}

/// The block that most pixels agree with, at least half of those that could; `None` when there is none. The queue is
/// overwritten.
pub(super) fn best(field: &mut Field, params: &Params, rng: &mut Rng) -> Option<Seed> {
    let free = field.gather_free();
    let mut best: Option<(u32, Seed)> = None;
    for trial in 0..params.blocks {
        let draw = rng.below(free as u32) as usize;
        let tall = rng.next_u64() >> 63 == 1;
        let turn = SPACINGS.get(trial as usize % SPACINGS.len()).copied().unwrap_or(1);
        let spacing = if params.spacing > 0 { params.spacing } else { turn };
        let Some(&index) = field.queue.get(draw) else { continue };
        let Some(seed) = through_block(field, index as usize, spacing, tall) else { continue };
        let agreement = agreement(field, &seed, params);
        if agreement >= SMALLEST_AGREEMENT && best.is_none_or(|(most, _)| agreement > most) {
            best = Some((agreement, seed));
        }
    }
    best.map(|(_, seed)| seed)
}

/// The form through the 3x2 or, if `tall`, 2x3 pixels from `index` on, where all are free and it is an ellipsoid.
fn through_block(field: &Field, index: usize, spacing: u32, tall: bool) -> Option<Seed> {
    let (column, row) = (index.checked_rem(field.width)?, index.checked_div(field.width)?);
    let wide = if tall { 2 } else { 3 };
    let step = spacing as usize;
    let mut colors = [[0.0; 3]; TERMS];
    for (i, slot) in colors.iter_mut().enumerate() {
        let (x, y) = (column + (i % wide) * step, row + (i / wide) * step);
        let (label, color) = field.at(x, y)?;
        if label != FREE {
            return None;
        }
        *slot = color.map(f64::from);
    }
    let form = regression::through(&colors)?;
    let corner = [column as u32, row as u32];
    is_positive_definite(&form).then_some(Seed { form, corner, spacing, index })
}

/// How many of the pixels around agree with the block's form; 0 when that is less than half of the free ones.
fn agreement(field: &Field, seed: &Seed, params: &Params) -> u32 {
    let form = seed.form.map(|c| c as f32);
    let [column, row] = seed.corner.map(|place| i64::from(place) + i64::from(seed.spacing));
    let (mut agree, mut free) = (0, 0);
    for [dx, dy] in DIRECTIONS {
        for distance in 1..=DISTANCES {
            let away = |d: i32| {
                i64::from(d) * i64::from(distance) * i64::from(params.reach) / i64::from(8 * DISTANCES)
            };
            let (Ok(x), Ok(y)) = (usize::try_from(column + away(dx)), usize::try_from(row + away(dy))) else {
                continue;
            };
            if let Some((FREE, color)) = field.at(x, y) {
                free += 1;
                agree += u32::from(single_residual(&form, color).abs() <= params.tolerance as f32);
            }
        }
    }
    if agree * 2 >= free { agree } else { 0 }
}
