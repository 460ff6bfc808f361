//! Whether the paint has one hue: paints of two hues meet in steps of the color's direction that are all alike.
//!
//! Along a line the surface bends, and the logarithms of the colors without their brightness change with it, but slowly; what is
//! left of the change over one distance without the mean of those before and behind it is a step. Creases of the surface make steps
//! as well, of every size and direction, fewer the larger they are. A border between two hues makes the same step wherever
//! it runs, whatever the surface does there: more steps of one kind than of that kind at a part of its size.

use super::sampler::Sampler;
use core::f64::consts::TAU;
use libm::{cos, logf, round, sin, sqrt};

/// Pixels that are drawn for each distance at most.
const DRAWS: usize = 30_000;
/// Steps that are kept of each distance at most.
const STEPS: usize = 3000;
/// Length of the memory that they take, in `f32`.
pub(super) const LEN: usize = 2 * STEPS;
/// Steps that others are counted around.
const CENTERS: usize = 256;

/// A channel below so many deviations of the noise has no logarithm that says much.
const DARKEST: f64 = 12.0;
/// Smaller steps are no steps: six percent of a channel.
const SMALLEST: f64 = 0.06;
/// The smallest difference of hues that is looked for.
const SMALLEST_HUE: f64 = 0.15;
/// Beside a step the color's direction changes at most this much, as a share of the step.
const BESIDE: f64 = 0.5;
/// Steps are alike within this share of their size.
const ALIKE: f64 = 0.2;
/// Where steps are counted that are smaller and else alike.
const SMALLER: f64 = 0.6;
/// What a count of no steps may be by chance.
const CHANCE: f64 = 9.0;

/// By how many deviations the most frequent step is more frequent than its smaller likeness: at most 7.5 on pictures of one hue.
pub(super) fn excess(sampler: &mut Sampler, distance: u32, noise: f64, workspace: &mut [f32]) -> f64 {
    let (steps, _) = workspace.as_chunks_mut::<2>();
    let mut count = 0;
    for _ in 0..DRAWS {
        let Some(slot) = steps.get_mut(count).filter(|_| count < STEPS) else { break };
        if let Some(step) = step(sampler, f64::from(distance), DARKEST * noise) {
            *slot = step;
            count += 1;
        }
    }
    let steps = steps.get(..count).unwrap_or_default();
    let mut most = 0.0_f64;
    for &center in steps.iter().step_by(count.div_ceil(CENTERS).max(1)) {
        let [x, y] = center.map(f64::from);
        let size = sqrt(x * x + y * y);
        if size >= SMALLEST_HUE {
            let radius = (ALIKE * size) as f32;
            let alike = like(steps, center, radius);
            let smaller = like(steps, center.map(|c| SMALLER as f32 * c), radius);
            most = most.max((alike - smaller) / sqrt(alike + smaller + CHANCE));
        }
    }
    most
}

/// How many steps, up or down, lie within `radius` of this one.
fn like(steps: &[[f32; 2]], [x, y]: [f32; 2], radius: f32) -> f64 {
    let mut count = 0_u32;
    for &[a, b] in steps {
        let (up, down) = ([a - x, b - y], [a + x, b + y]);
        let square = (up[0] * up[0] + up[1] * up[1]).min(down[0] * down[0] + down[1] * down[1]);
        count += u32::from(square < radius * radius);
    }
    f64::from(count)
}

/// The step between the middle two of four pixels in a line, in any direction; `None` where there is none.
fn step(sampler: &mut Sampler, distance: f64, darkest: f64) -> Option<[f32; 2]> {
    let [x, y] = sampler.draw();
    let angle = TAU * sampler.rng.unit();
    let (dx, dy) = (distance * cos(angle), distance * sin(angle));
    let mut directions = [[0.0; 2]; 4];
    for (k, slot) in [-1.0, 0.0, 1.0, 2.0].into_iter().zip(&mut directions) {
        let [dx, dy] = [k * dx, k * dy].map(|step| round(step) as isize);
        let at = [x.checked_add_signed(dx)?, y.checked_add_signed(dy)?];
        let [color] = sampler.row::<1>(at)?;
        *slot = direction(color, darkest)?;
    }
    let [first, second, third, fourth] = directions;
    let before = minus(second, first);
    let behind = minus(fourth, third);
    let between = minus(third, second);
    let ([x, y], [x1, y1], [x2, y2]) = (between, before, behind);
    let step = [x - 0.5 * (x1 + x2), y - 0.5 * (y1 + y2)];
    let square = |[a, b]: [f64; 2]| a * a + b * b;
    let size = square(step);
    let is_step = size > SMALLEST * SMALLEST && square(before).max(square(behind)) < BESIDE * BESIDE * size;
    is_step.then_some(step.map(|c| c as f32))
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The logarithms of the channels without their mean, in two orthogonal directions.
fn direction(color: [f32; 3], darkest: f64) -> Option<[f64; 2]> {
    if !color.iter().all(|&value| f64::from(value) > darkest) {
        return None;
    }
    let [r, g, b] = color.map(|value| f64::from(logf(value)));
    Some([(r - g) / sqrt(2.0), (r + g - 2.0 * b) / sqrt(6.0)])
}
