//! Why a picture is refused, or its answer doubted: the cause in the scene, beside the status that says how far the pipeline came.
//!
//! `find` runs once, at the end of [`solve`](fn@super::solve). An answer that is well determined by most of the pixels costs it a
//! look at the counts and at a few rows. Otherwise it passes over the picture and tries the causes one by one, those first that
//! would look like others: an inverted mask leaves something flat, and a picture that is too dark has no third dimension.
//! Of a large picture it looks at a sample of the rows.
//! What it compares with is mostly the noise, which it measures from pixel to pixel: the residuals of a fit that failed say
//! nothing of it.
//!
//! | cause | what shows it | where |
//! | --- | --- | --- |
//! | too few pixels, saturation | the counts | here |
//! | an inverted mask | it leaves the frame and nothing that bends, and leaves out what does | `mask` |
//! | darkness | brightness over noise, in the lowest part of the range | here |
//! | a channel without a signal | its spread over the noise | `channels` |
//! | two paints | steps of the colors by one ratio everywhere | `steps` |
//! | a plane, one hue, two lights | the spread of the colors, and their second and third deviation over the noise | `shape` |
//! | a vignette | brightness that is a quadratic function of the place | `falloff` |
//! | a cylinder | colors that change in one direction of the picture | `shape` |
//! | a background | a border of one color around something that bends | `border` |
//! | lights nearly in a plane | the singular values of F, or the third deviation over the second | `lights` |
//! | outliers | how many there are, or residuals of many times the noise | here |
//! | dome or hollow | the evidence of [`joint`](mod@crate::orientation::joint) | here |

mod border;
mod channels;
mod falloff;
mod finding;
mod lights;
mod mask;
mod shape;
mod steps;
mod survey;

pub use finding::{Finding, Reason};

use super::outcome::Outcome;
use super::parameters::{Convexity, Params};
use super::solution::Solution;
use crate::color::lmeds::MIN_PIXELS;
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{Image, PixelCounts, Pixels, Sample, Usable, Window};
use finding::{MOST, share};
use steps::Steps;
use survey::{SMOOTH, Survey};

/// The numbers of pixels, and where they are too few for a fit, why.
///
/// # Scratch
/// One `f32` a pixel; what they hold before does not matter.
#[must_use]
pub fn of_pixels(image: &Image, params: &Params, workspace: &mut [f32]) -> (PixelCounts, Finding) {
    let usable = params.usable(image);
    let counts = usable.count(image);
    if counts.usable >= MIN_PIXELS {
        return (counts, Finding::NONE);
    }
    let offered = image.width() * image.height() - counts.masked_out;
    let least = MIN_PIXELS as f64;
    let found = if offered < MIN_PIXELS && counts.masked_out > 0 {
        Finding::of(Reason::MaskEmpty, offered as f64, least)
    } else {
        mask::inverted(image, usable, None, workspace)
            .or_else(|| Finding::above(Reason::NotFinite, share(counts.non_finite, offered), MOST))
            .or_else(|| Finding::above(Reason::Dark, share(counts.dark, offered), MOST))
            .or_else(|| Finding::above(Reason::Saturated, share(counts.saturated, offered), MOST))
            .unwrap_or(Finding::of(Reason::TooFewPixels, counts.usable as f64, least))
    };
    (counts, found)
}

/// Why this solution of the picture is none, or one to doubt.
#[inline(never)]
pub(super) fn find(image: &Image, params: &Params, solution: &Solution, workspace: &mut [f32]) -> Finding {
    let counts = &solution.pixel_counts;
    let object = counts.usable + counts.shaded + counts.saturated;
    if let Some(found) = Finding::above(Reason::Saturated, share(counts.saturated, object), MOST) {
        return found;
    }
    let is_refused = solution.outcome != Outcome::Solved;
    if is_refused || is_weak(params, solution) || channels::one_hardly_varies(image, &solution.inliers) {
        let usable = without_extremes(image, solution.inliers.usable.saturation, workspace);
        if let Some(survey) = Survey::of(image, |window| usable.exposed(window), workspace)
            && let Some(found) = look(image, usable, solution, &survey, workspace)
        {
            return found;
        }
    }
    if is_refused {
        return Finding::of(Reason::Unknown, 0.0, 0.0);
    }
    Finding::above(Reason::Outliers, 1.0 - share(solution.inlier_count, counts.usable), MOST)
        .or_else(|| lights::nearly_coplanar(solution))
        .or_else(|| orientation(params, solution))
        .unwrap_or(Finding::NONE)
}

/// Whether an answer rests on too few of the pixels, or on too little, to go without a look at the picture. Where shadows are not
/// looked for they are outliers, and often a quarter of the pixels.
fn is_weak(params: &Params, solution: &Solution) -> bool {
    const SAFE_MARGIN: f64 = 2.0;
    let least_quarters = if params.rejects_shadows() { 3 } else { 2 };
    let few = 4 * solution.inlier_count < least_quarters * solution.pixel_counts.usable;
    let safe = |noise: f64, degenerate: f64| degenerate > SAFE_MARGIN * noise;
    few || !solution.fit.as_ref().is_some_and(|fit| safe(fit.noise_deviation, fit.degenerate_noise_deviation))
}

/// The pixels that are not many times as bright as half of them are: a few hot ones of a float picture would be all that its
/// moments show.
fn without_extremes(image: &Image, saturation: f32, workspace: &mut [f32]) -> Usable {
    const MANY_TIMES: f32 = 20.0;
    let usable = Usable::below(saturation);
    let brightest = |r: f32, g: f32, b: f32| f64::from(r.max(g).max(b));
    let values = image.sample_rows().gather(|window| usable.exposed(window), workspace, brightest);
    let median = kth_smallest(values, median_rank(values.len()));
    Usable::below(median.map_or(saturation, |median| saturation.min(MANY_TIMES * median)))
}

/// The cause that the picture shows.
fn look(
    image: &Image,
    usable: Usable,
    solution: &Solution,
    survey: &Survey,
    workspace: &mut [f32],
) -> Option<Finding> {
    let exposed = |window: &Window| usable.exposed(window);
    mask::inverted(image, usable, Some(survey), workspace)
        .or_else(|| dark(image, solution, survey))
        .or_else(|| channels::dead(survey))
        .or_else(|| {
            // The steps of paints on a flat surface are its only colors; those of a rim may be alike by chance.
            let steps = Steps::of(image, exposed, survey.noise, workspace);
            steps
                .of_two_paints(survey, steps::ALIKE)
                .or_else(|| shape::degenerate(image, exposed, survey))
                .or_else(|| steps.of_two_paints(survey, steps::MOSTLY_ALIKE))
        })
        .or_else(|| {
            let misfit = misfit(solution, survey);
            // Where most pixels obey the model, there is no background among them.
            let lights = if misfit.is_none() { lights::hardly_span(solution, survey) } else { None };
            lights.or_else(|| border::background(image, exposed, survey, workspace)).or(misfit)
        })
        .map(
            |found| {
                if solution.outcome == Outcome::Solved { lights::of_answer(found, solution) } else { found }
            },
        )
}

/// Little light for the noise, in the lowest part of the camera's range.
fn dark(image: &Image, solution: &Solution, survey: &Survey) -> Option<Finding> {
    const NOISES: f64 = 25.0;
    const LOWEST_PART: f32 = 0.1;
    let [brightness, ..] = survey.deviations;
    let has_range = matches!(image.sample(), Sample::U8 | Sample::U16);
    let is_dim =
        has_range && solution.pixel_counts.largest < LOWEST_PART * solution.inliers.usable.saturation;
    if is_dim { Finding::below(Reason::Dark, brightness / survey.noise, NOISES) } else { None }
}

/// That most pixels of a refused picture do not obey the model, or that those of any picture are those of no surface.
fn misfit(solution: &Solution, survey: &Survey) -> Option<Finding> {
    const MANY_NOISES: f64 = 4.0;
    let [brightness, ..] = survey.deviations;
    let rough = Finding::above(Reason::Outliers, survey.noise / brightness, SMOOTH);
    if solution.outcome == Outcome::Solved {
        return rough;
    }
    let fit = solution.fit.as_ref();
    let outliers = fit.map_or(1.0, |fit| 1.0 - share(fit.inliers, fit.usable));
    let noises = fit.map_or(0.0, |fit| fit.noise_deviation / survey.noise);
    rough
        .or_else(|| Finding::above(Reason::Outliers, outliers, MOST))
        .or_else(|| Finding::above(Reason::Outliers, noises, MANY_NOISES))
}

/// What an answer does not know of its orientation.
fn orientation(params: &Params, solution: &Solution) -> Option<Finding> {
    /// Of twenty-five parts that are convex or hollow by chance, the sum is within this share of the whole mostly.
    const CLEAR: f64 = 0.2;
    match &solution.joint {
        None if params.is_joint() => {
            Some(Finding::of(Reason::TooFewPixels, solution.inlier_count as f64, 0.0))
        }
        Some(joint) if params.convexity == Convexity::Auto => {
            Finding::below(Reason::ConvexOrHollow, joint.convexity, CLEAR)
        }
        _ => None,
    }
}
