//! F from tilts: the slants that agree with them, and the choice among these (section 3.4, steps 4 to 8).

use super::choice::Choice;
use super::fallback;
use super::parameters::{NormSource, Params};
use crate::color::ellipsoid::Ellipsoid;
use crate::color::inliers::Inliers;
use crate::light::{channel_maxima, constrained_slant};
use crate::orientation::integrability;
use crate::orientation::matrix::{self, Orientation};
use crate::picture::Image;

/// The candidate slants for these tilts, and F of the one whose normals are most integrable; `None` where no slants agree with
/// the tilts and the fallback has none.
pub(super) fn choose(
    image: &Image,
    ellipsoid: &Ellipsoid,
    inliers: &Inliers,
    tilts: [f64; 3],
    params: &Params,
    workspace: &mut [f32],
) -> Option<Choice> {
    let selector = inliers.selector();
    let ellipsoid = &match params.norms {
        NormSource::Fit => *ellipsoid,
        NormSource::ChannelMaxima => {
            Ellipsoid { norms: channel_maxima::norms(image, selector)?, ..*ellipsoid }
        }
    };
    let orient = |slants| orient(ellipsoid, slants, tilts, params);
    let mut choice = Choice::none();
    // Step 4: all solutions of eqs. 25.
    choice.set_candidates(&constrained_slant::roots(tilts, ellipsoid.cosines));
    for candidate in &mut choice.candidates {
        // Steps 5 and 6: F and its inverse.
        let orientation = orient(candidate.slants);
        if orientation.rank == 3 {
            // Step 7: the normals, and the integral (15) over them.
            #[expect(
                clippy::needless_borrows_for_generic_args,
                reason = "so that one instance serves tilts_given too"
            )]
            let integral = integrability::integral(image, &selector, &orientation.f_inverse);
            candidate.integral = integral.map_or(f64::INFINITY, |integral| integral.mean);
        }
    }
    // Step 8: the smallest integral; without a solution section 3.3's other ways to slants.
    if let Some((chosen, slants)) = choice.most_integrable() {
        (choice.chosen, choice.slants) = (chosen, slants);
    } else {
        let fallback = params.fallback;
        (choice.slants, choice.source) =
            fallback::slants(fallback, image, inliers, ellipsoid, tilts, workspace)?;
    }
    choice.orientation = orient(choice.slants);
    Some(choice)
}

/// F from the lengths of its rows, their slants and tilts.
#[inline(never)]
pub(crate) fn orient(
    ellipsoid: &Ellipsoid,
    slants: [f64; 3],
    tilts: [f64; 3],
    params: &Params,
) -> Orientation {
    Orientation::new(matrix::compose(ellipsoid.norms, slants, tilts), params.rank_threshold)
}
