//! Slopes from the colors relative to an untouched plane: the model for a picture most of which is one flat surface.
//!
//! The gel of a tactile sensor, a plate with a dent, a coin on its blank: most of the picture is a plane, and that plane is the
//! best reference there is. With B the color of the plane at a pixel, from a picture without the object or from a smooth
//! polynomial through the majority of the picture itself, delta = rho / B - 1 (channel by channel) is zero on the plane
//! wherever the lights stand, near or far. To first order delta is linear in the slope, so that
//!
//! ```text
//! (n1, n2) = W delta,   n3 = sqrt(1 - n1^2 - n2^2)
//! ```
//!
//! without an intercept. No color need lie on an ellipsoid around black, which the colors of a gel do not.
//!
//! 1. `cells` averages the picture over some 160 cells across; `reference` finds B.
//! 2. `contact` finds the cells that differ from the plane by more than noise, the contact, and a skirt around it.
//! 3. `circulation` finds W up to its scale and sign: the field (n1, n2) of a surface has no circulation around any window,
//!    to first order, so W minimizes w^T M w / w^T S w with M the sum of squared circulations and S the energy of delta.
//! 4. The sign follows from what is known beforehand: a contact rises from the plane, so its normals point outward.
//! 5. `scale` finds the scale, which integrability cannot give: from the radius of a ball that was pressed in, or by comparison
//!    with the ellipsoid of the colors of the inner contact (eq. 10), where these bend enough to have one. Otherwise it is
//!    unknown, and the uncertainty says so.
//!
//! Nothing is answered where the evidence is not that of a relief on a plane: see [`ReliefError`].

mod bit_rows;
mod cells;
mod circulation;
mod contact;
mod estimate;
mod fill;
mod grid;
mod normals;
mod outward;
mod parameters;
mod reference;
mod result;
mod scale;
mod spread;
mod survey;

pub use estimate::estimate;
pub use grid::{Grid, MOST_ALONG};
pub use normals::normals;
pub use parameters::ReliefParams;
pub use reference::{ORDER, Polynomial, TERMS};
pub use result::{PixelClass, Relief, ReliefError, ScaleSource};
pub use survey::need;

pub use bit_rows::Row as BitRow;
pub(crate) use bit_rows::{is_set, narrower, wider};
pub(crate) use cells::{DARK_SPOT, Strip};
pub(crate) use circulation::{Circulation, Least, WEIGHT};
pub(crate) use contact::{DEVIATIONS, SKIRT, distances};
pub(crate) use estimate::{
    ANISOTROPY, CIRCULATION, CIRCULATION_RATIO, LARGEST_DISAGREEMENT, LEAST_DEVIATION, USUAL_DEVIATION,
    USUAL_TILT, eigenvalues,
};
pub(crate) use normals::{Reference, RowSlopes, Slopes, normals_by};
pub(crate) use outward::arms;
pub(crate) use reference::Along;
pub(crate) use scale::Inner;
pub(crate) use spread::{Spread, unit};
pub(crate) use survey::{Memory, Survey, relative, survey};
