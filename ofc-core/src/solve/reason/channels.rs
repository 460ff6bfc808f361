//! A channel without a signal: black, or the same everywhere.

use super::finding::{Finding, Reason};
use super::survey::Survey;
use crate::color::inliers::Inliers;
use crate::picture::{Image, for_each_bit};

/// Spread of so many times the noise is none.
const CONSTANT: f64 = 2.0;
/// Another channel has at least this.
const VARIES: f64 = 8.0;

/// That the channel that varies least does not vary, while another one does.
pub(super) fn dead(survey: &Survey) -> Option<Finding> {
    let (channel, least) = survey.spread.into_iter().enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let varies = survey.largest_spread() > VARIES * survey.noise;
    let found = Finding::below(Reason::ChannelDead, least / survey.noise, CONSTANT)?;
    varies.then_some(found.about(Some(channel)))
}

/// Whether a channel hardly varies over the inliers of a sample of the rows: the fit takes it for a light that shines on the whole surface alike,
/// and answers.
pub(super) fn one_hardly_varies(image: &Image, inliers: &Inliers) -> bool {
    const ROWS: usize = 24;
    /// Of the variance of the channel that varies most.
    const HARDLY: f64 = 0.02;
    let (mut sum, mut squares, mut count) = ([0.0; 3], [0.0; 3], 0_u32);
    for y in (0..image.height()).step_by((image.height() / ROWS).max(1)) {
        let Some(row) = image.row(y) else { break };
        row.for_each_window(|window| {
            for_each_bit(inliers.bits(window), |i| {
                count += 1;
                for ((sum, squares), value) in sum.iter_mut().zip(&mut squares).zip(window.pixel(i)) {
                    *sum += f64::from(value);
                    *squares += f64::from(value) * f64::from(value);
                }
            });
        });
    }
    let count = f64::from(count.max(1));
    let (mut least, mut most) = (f64::INFINITY, 0.0);
    for (sum, squares) in sum.into_iter().zip(squares) {
        let mean: f64 = sum / count;
        let variance = f64::max(squares / count - mean * mean, 0.0);
        (least, most) = (f64::min(least, variance), f64::max(most, variance));
    }
    least < HARDLY * most
}
