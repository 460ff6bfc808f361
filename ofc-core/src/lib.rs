//! Orientation from color: surface normals from one RGB picture of a uniformly colored matte surface under several
//! unknown colored lights.
//!
//! `no_std`, no allocation, no unsafe code, no panic: every function works over borrowed buffers.
//!
//! ```
//! use ofc_core::{Image, Order, Params, Sample, normals, solve};
//!
//! // A ball under red, green and blue light; the rows of F are the three channels' lights.
//! const SIZE: usize = 96;
//! let f = [[110.0, 15.0, 95.0], [-65.0, 90.0, 100.0], [-40.0, -95.0, 90.0]];
//! let ball = |x: usize, y: usize| {
//!     let [x, y] = [x as f64 - 47.5, 47.5 - y as f64].map(|v| v / 60.0);
//!     [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
//! };
//! let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
//! let pixels: Vec<u8> = (0..SIZE * SIZE)
//!     .flat_map(|i| f.map(|row| dot(row, ball(i % SIZE, i / SIZE)).max(0.0).round() as u8))
//!     .collect();
//!
//! let image = Image::interleaved(&pixels, SIZE, SIZE, 3 * SIZE, Sample::U8, Order::Rgb).unwrap();
//! let params = Params::default();
//! let mut workspace = vec![0.0; solve::workspace_len(SIZE * SIZE, params.lmeds.sample_size)];
//! let solution = solve(&image, &params, &mut workspace).unwrap();
//!
//! let orientation = solution.choice.as_ref().expect("the picture determines F").orientation;
//! let mut found = vec![0.0; 3 * SIZE * SIZE];
//! let inliers = solution.inliers.selector();
//! let row = 3 * SIZE;
//! normals::compute(&image, inliers, &orientation.f_inverse, normals::Length::Unit, &mut found, row).unwrap();
//!
//! let (x, y) = (60, 40);
//! let normal = [0, 1, 2].map(|i| f64::from(found[y * row + 3 * x + i]));
//! assert!(dot(normal, ball(x, y)).acos().to_degrees() < 2.0);
//! ```
//!
//! # The pipeline
//!
//! A room (a folder of `src`) uses only the rooms above it; [`math`] is under all of them.
//!
//! ```text
//!   one RGB picture, any layout, any mask         picture/      Image
//!          |   finite, not black, not saturated   picture/      Usable
//!   the ellipsoid of the colors,                  color/        lmeds: subsets, median, then least squares
//!   rho^T C rho = 1                                             over what the first rejection leaves
//!          |   no color in a shadow               color/        shadows
//!          |   second rejection: by length        color/        norms, inliers
//!   lengths and angles of the rows of F           color/        ellipsoid
//!          |
//!          +--- direct method: the paper's        light/        tilt, constrained_slant
//!          |                                      orientation/  integrability chooses among the slants
//!          +--- joint method: the default         orientation/  joint
//!          |
//!   F and F^-1                                    orientation/  matrix
//!   normals n = F^-1 rho, and how sure            surface/      normals, uncertainty
//!   depth                                         surface/      depth
//! ```
//!
//! [`solve()`] goes from the top to F; [`stream`] does so over the rows of a camera, and [`check`](mod@check) asks whether to
//! believe an answer. [`render`](mod@render) is the way back: from a depth map and lights to a picture.
//!
//! # From the paper to the code
//!
//! M. S. Drew, "Direct Solution of Orientation-from-Color Problem using a Modification of Pentland's Light Source Direction
//! Estimator". Numbers in the documentation are its sections, equations, tables and references.
//!
//! | in the paper | what it is | name | file |
//! | --- | --- | --- | --- |
//! | eqs. 1-4, 6 | lights a, their colors b, shadows | [`render::Lights`], [`render()`](render::render) | `render.rs`, `render/lights.rs` |
//! | eqs. 5, 7: F = B A | rho = F n | [`render::Lights::orientation`], [`orientation::matrix`] | `orientation/matrix.rs` |
//! | eq. 8: G = F^-1 | n = G rho | [`normals::compute`] | `surface/normals.rs` |
//! | eqs. 9, 10: C, z | the ellipsoid and its six coefficients | [`color::ellipsoid`] | `color/ellipsoid.rs` |
//! | eq. 11: M z = 1 | least squares, standard errors, limits | [`color::regression`] | `color/regression.rs` |
//! | eq. 11 by LMS | least median of squares | [`color::lmeds`] | `color/lmeds.rs`, `color/lmeds/search.rs` |
//! | eq. 12: s0, f | the robust dispersion | `dispersion` | `color/dispersion.rs` |
//! | 2.2: abs(r / s0) <= 2.5 | the first rejection | [`Band::residual`](color::inliers::Band::residual) | `color/inliers.rs` |
//! | 2.2 | reweighted least squares | `reweighted` | `color/lmeds/reweighted.rs` |
//! | 2.2 | the second rejection: lengths too far from their location | [`color::norms`], [`Band::norm`](color::inliers::Band::norm) | `color/norms.rs`, `color/location.rs`, `color/inliers.rs` |
//! | eqs. 13, 14: N, R | what C leaves open | [`orientation::orthogonal`] | `orientation/orthogonal.rs` |
//! | eq. 15 | the integral, by differences on cells of four pixels | [`orientation::integrability`] | `orientation/integrability.rs` |
//! | eq. 15 by annealing \[14\] | R of least integral | [`annealing()`](orientation::orthogonal::annealing::annealing) | `orientation/orthogonal/annealing.rs` |
//! | eq. 16 \[15\] | R from smoothness, in closed form | [`closed_form()`](orientation::orthogonal::closed_form::closed_form) | `orientation/orthogonal/closed_form.rs` |
//! | 2.4 | a surface and its convex/concave twin | [`orientation::orthogonal::TwinChoice`] | `orientation/orthogonal.rs` |
//! | eqs. 17, 18: `f_i`, F F^T = C^-1 | lengths and angles of the rows of F | [`decompose`](color::ellipsoid::decompose) | `color/ellipsoid.rs` |
//! | eq. 19 | a direction from slant and tilt | [`orientation::matrix::direction`] | `orientation/matrix.rs` |
//! | eq. 20 | the mean gradient, by regression | `gradient` | `light/gradient.rs` |
//! | eq. 21: tau | Pentland's tilt | [`light::tilt::pentland`] | `light/tilt/pentland.rs` |
//! | \[19\], \[20\], \[22\] | the other tilts | [`light::tilt`] | `light/tilt/` |
//! | eq. 22 | Pentland's slant | [`light::slant::pentland`] | `light/slant/pentland.rs` |
//! | eq. 23 | Lee and Rosenfeld's slant | [`light::slant::lee_rosenfeld`] | `light/slant/lee_rosenfeld.rs` |
//! | eq. 24: `k_ij`, `h_ij` | what tilts and angles say of the slants | [`light::constrained_slant`] | `light/constrained_slant.rs` |
//! | eq. 24 | all its solutions | [`roots()`](light::constrained_slant::roots()) | `light/constrained_slant/roots.rs` |
//! | eqs. 25 | the curves of Figures 2 and 4 | [`curve()`](light::constrained_slant::curve()) | `light/constrained_slant/curve.rs` |
//! | eqs. 25, cases 1-8 | the numbers of the branches | [`SlantRoot::branch`](light::constrained_slant::SlantRoot::branch) | `light/constrained_slant/branch.rs` |
//! | 3.3 | what to do without a solution | [`SlantFallback`](solve::SlantFallback) | `solve/fallback.rs`, `orientation/orthogonal/tilts_given.rs` |
//! | 3.4, steps 1-8 | the whole pipeline | [`solve()`] | `solve.rs` |
//! | 4 | channel maxima instead of norms | [`light::channel_maxima`] | `light/channel_maxima.rs` |
//! | 5 | correlations, tilts of the output, norms | [`check()`](check::check) | `check.rs` |
//! | 5, Fig. 8 | depth by a Poisson equation; p = q = 0 at outliers | [`depth::Method`] | `surface/depth/poisson.rs`, `surface/depth/job.rs` |
//! | \[25\] Harris | the energy of the coupled depth/slope model | [`depth::Method::Coupled`] | `surface/depth/coupled.rs` |
//! | \[13\] Petrov, Kontsevich | ranks of colors and normals, and of the light and the surface of each patch | [`color::rank`](mod@color::rank), [`color::rank::Class`], [`color::rank::patches`](mod@color::rank::patches) | `color/rank.rs`, `color/rank/class.rs`, `color/rank/patches.rs` |
//! | \[26\] Wolff | departure from the matte model toward grazing views | [`surface::wolff`](mod@surface::wolff) | `surface/wolff.rs` |
//! | \[14\] Kontsevich et al. | regions of one material | [`color::segment`](mod@color::segment) | `color/segment.rs` |
//!
//! Joint orientation, shadows, uneven paint and uncertainty are not in the paper: `docs/` derives them, and
//! [`orientation::joint`], [`color::shadows`], [`color::paint`] and [`surface::uncertainty`] compute them.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod math;
pub mod picture;

pub mod color;
pub mod light;
pub mod orientation;
pub mod surface;

pub mod render;

pub mod check;
pub mod rig;
pub mod solve;
pub mod stream;

pub use picture::{Image, Order, Sample};
pub use solve::{Outcome, Params, Solution, solve};
pub use surface::uncertainty::Uncertainty;
pub use surface::{depth, normals};
