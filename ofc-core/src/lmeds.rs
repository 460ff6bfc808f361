//! Least median of squares (LMS in the paper) for M z = 1, and the reweighted fit after it.
//!
//! Seeded random subsets of six pixels propose ellipsoids; each is judged by the median residual over a stratified
//! sample of the picture; concentration steps polish the best; the objective that counts is then the exact median over
//! all usable pixels. Pixels with a residual within 2.5 dispersions are inliers and are fitted by least squares.
//!
//! # Reference
//! Sections 2.1-2.2, eqs. 10-12. P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier Detection", Wiley 1987.
//! P. J. Rousseeuw, K. Van Driessen, "Computing LTS regression for large data sets", 2006 (concentration steps).

use crate::ellipsoid::{Coefficients, quadratic_form};
use crate::image::{Census, Image, Usable, for_each_bit};
use crate::inliers::{Band, Inliers};
use crate::mat3::symmetric_eigen;
use crate::pixels::Pixels;
use crate::regression::{self, Estimate, LeastSquares, Moments, TERMS};
use crate::rng::Rng;
use crate::select::{kth_smallest, median_rank};
use libm::{ceil, fabs, fabsf, log, log1p, sqrt};

/// Fewer usable pixels than this are refused: half of them must still hold the six of a subset.
pub const MIN_PIXELS: usize = 12;

/// Proposals are never more than this, whatever the parameters ask for.
pub const MAX_SUBSETS: u32 = 10_000_000;

/// The normal distribution's median absolute deviation is 1 / 1.4826 standard deviations: f of eq. 12.
pub(crate) const CONSISTENCY: f64 = 1.482_602_218_505_602;

const CONCENTRATION_STEPS: usize = 10;

/// What fits the form to the pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Least median of squares, rejection, and least squares over what is left.
    #[default]
    LeastMedian,
    /// Least squares over all usable pixels, none rejected: photometric stereo with unknown lights as R. J. Woodham, Y.
    /// Iwahori and R. A. Barman (TR 91-18, 1991) have it. For pictures in which every pixel obeys the model.
    LeastSquares,
}

/// How to search, and what to reject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// What fits. Default [`Method::LeastMedian`]; the search's parameters mean nothing to the other.
    pub method: Method,
    /// The probability that at least one subset is free of outliers, in (0, 1). Default 0.9999.
    pub confidence: f64,
    /// The share of outliers for which that holds, in [0, 1). Default 0.5.
    pub outlier_share: f64,
    /// At least this many subsets are drawn. Default 500.
    pub min_subsets: u32,
    /// Exactly this many subsets, or 0 for the number that `confidence` and `outlier_share` ask for. Default 0.
    pub subsets: u32,
    /// Pixels that the search looks at; all are looked at when there are fewer. Default 10,000.
    pub sample_size: u32,
    /// Fixes every random choice. Default 0.
    pub seed: u64,
    /// Residuals above this many dispersions are outliers. Default 2.5.
    pub rejection: f64,
    /// The confidence of the limits given with each coefficient, in (0, 1). Default 0.95.
    pub limits_confidence: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            method: Method::LeastMedian,
            confidence: 0.9999,
            outlier_share: 0.5,
            min_subsets: 500,
            subsets: 0,
            sample_size: 10_000,
            seed: 0,
            rejection: 2.5,
            limits_confidence: 0.95,
        }
    }
}

impl Params {
    /// How many subsets these parameters ask for, or `None` when one of them is out of its range.
    #[must_use]
    pub fn subset_count(&self) -> Option<u32> {
        let in_range = self.rejection > 0.0
            && self.rejection.is_finite()
            && self.limits_confidence > 0.0
            && self.limits_confidence < 1.0
            && self.sample_size as usize >= MIN_PIXELS
            && self.subsets <= MAX_SUBSETS;
        let count = subset_count(self.confidence, self.outlier_share, self.min_subsets)?;
        in_range.then_some(if self.subsets > 0 { self.subsets } else { count })
    }
}

/// The number of random six-pixel subsets of which, with probability `confidence`, at least one holds no outlier when
/// the share of outliers is `outlier_share`; at least `min_subsets` and at least 1.
///
/// `None` when a parameter is out of range (see [`Params`]) or the answer is above [`MAX_SUBSETS`].
#[must_use]
#[expect(clippy::cast_sign_loss, reason = "a count of at least 1")]
pub fn subset_count(confidence: f64, outlier_share: f64, min_subsets: u32) -> Option<u32> {
    let in_range = confidence > 0.0
        && confidence < 1.0
        && (0.0..1.0).contains(&outlier_share)
        && min_subsets <= MAX_SUBSETS;
    if !in_range {
        return None;
    }
    let share = 1.0 - outlier_share;
    let good = (share * share * share) * (share * share * share);
    // log1p(-1) is -infinity when every subset is good, and then the quotient is 0.
    let count = ceil(log(1.0 - confidence) / log1p(-good)).max(1.0).max(f64::from(min_subsets));
    (count <= f64::from(MAX_SUBSETS)).then_some(count as u32)
}

/// Why there is no fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitError {
    /// A parameter is out of its range.
    Params,
    /// The workspace is shorter than [`workspace_len`].
    WorkspaceTooShort,
    /// Fewer than [`MIN_PIXELS`] usable pixels.
    TooFewPixels,
    /// As [`FitError::TooFewPixels`], because most pixels are black.
    Dark,
    /// As [`FitError::TooFewPixels`], because most pixels are saturated.
    Saturated,
    /// The colors do not determine the six coefficients: they, or the normals, span less than three dimensions.
    RankDeficient {
        /// As [`Fit::color_deviations`], over all usable pixels.
        color_deviations: [f64; 3],
    },
}

/// What the regression found. Coefficients are in (pixel value)^-2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The z that minimises the median squared residual; that of least squares where that is the method.
    pub robust: Coefficients,
    /// The square root of that median, over all usable pixels.
    pub median_residual: f64,
    /// The robust dispersion s0 of eq. 12.
    pub dispersion: f64,
    /// The robust coefficient of determination, 1 - `median_residual`^2.
    pub r_squared: f64,
    /// The rejection that follows from `robust` and `dispersion`; everything is accepted under least squares.
    pub band: Band,
    /// The reweighted fit: least squares over the inliers.
    pub coefficients: [Estimate; TERMS],
    /// The standard deviation of the inliers' residuals under the reweighted fit.
    pub residual_deviation: f64,
    /// The singular values of the inliers' colors, root mean square, descending, in pixel values.
    pub color_deviations: [f64; 3],
    /// The noise in each channel that explains the inliers' residuals, as a standard deviation in pixel values; at least
    /// what rounding to the picture's steps makes.
    pub noise_deviation: f64,
    /// The noise in each channel with which colors that do not determine C could look like these. The coefficients are
    /// biased by about (`noise_deviation` / `degenerate_noise_deviation`)^2, whatever their standard errors say.
    pub degenerate_noise_deviation: f64,
    /// Usable pixels.
    pub usable: usize,
    /// Usable pixels within the band.
    pub inliers: usize,
    /// Subsets drawn; none under least squares.
    pub subsets: u32,
}

impl Fit {
    /// The coefficients of the reweighted fit.
    #[must_use]
    pub fn z(&self) -> Coefficients {
        self.coefficients.map(|estimate| estimate.value)
    }
}

/// How many `f32` [`fit`] needs for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize, sample_size: u32) -> usize {
    let sample = if pixels < sample_size as usize { pixels } else { sample_size as usize };
    let search = sample.saturating_mul(4);
    if pixels > search { pixels } else { search }
}

/// Fits the colour-space quadratic form to the usable pixels of `image`.
///
/// # Errors
/// See [`FitError`].
///
/// # Scratch
/// [`workspace_len`] `f32`; what they hold before does not matter.
pub fn fit(image: &Image, usable: Usable, params: &Params, workspace: &mut [f32]) -> Result<Fit, FitError> {
    let subsets = params.subset_count().ok_or(FitError::Params)?;
    let pixels = image.width() * image.height();
    let workspace =
        workspace.get_mut(..workspace_len(pixels, params.sample_size)).ok_or(FitError::WorkspaceTooShort)?;

    let census = usable.count(image);
    enough(&census, pixels)?;
    // A power of two, so that scaling is exact.
    let scale = reciprocal_power_of_two(census.largest);
    let scaled = match params.method {
        Method::LeastMedian => {
            let mut rng = Rng::new(params.seed);
            let sample_len = census.usable.min(params.sample_size as usize);
            Sample::gather(image, usable, census.usable, sample_len, scale, &mut rng, workspace)
                .ok_or(FitError::WorkspaceTooShort)?
                .best(subsets, &mut rng)
        }
        Method::LeastSquares => least_squares(image, usable, scale),
    };
    let mut fit = None;
    judge(image, usable, census.usable, scale, scaled, params, workspace, &mut fit)?;
    fit.ok_or(FitError::TooFewPixels)
}

/// The scaled z that `subsets` find among these scaled colors, channels apart; `None` when none determines one. `residuals`
/// is room for one of each color.
pub(crate) fn search(
    [red, green, blue]: [&[f32]; 3],
    residuals: &mut [f32],
    subsets: u32,
    rng: &mut Rng,
) -> Option<Coefficients> {
    Sample { red, green, blue, residuals }.best(subsets, rng)
}

/// Whether there are enough usable pixels for a fit, out of `pixels`.
pub(crate) fn enough(census: &Census, pixels: usize) -> Result<(), FitError> {
    if census.usable >= MIN_PIXELS {
        return Ok(());
    }
    let offered = pixels - census.masked_out;
    Err(if census.dark * 2 > offered {
        FitError::Dark
    } else if census.saturated * 2 > offered {
        FitError::Saturated
    } else {
        FitError::TooFewPixels
    })
}

/// The scaled z of all usable pixels.
#[inline(never)]
pub(crate) fn least_squares(pixels: &impl Pixels, usable: Usable, scale: f64) -> Option<Coefficients> {
    moments(pixels, &Inliers::all(usable), scale).solve().map(|fit| fit.coefficients)
}

/// The fit that follows from the `scaled` z that was found: rejection and the reweighted fit, over the `count` usable ones
/// of these pixels. It is in `out` unless there is an error.
#[inline(never)]
#[expect(clippy::too_many_arguments, reason = "what a search leaves, and what it was given")]
pub(crate) fn judge(
    pixels: &impl Pixels,
    usable: Usable,
    count: usize,
    scale: f64,
    scaled: Option<Coefficients>,
    params: &Params,
    workspace: &mut [f32],
    out: &mut Option<Fit>,
) -> Result<(), FitError> {
    let degenerate = || degenerate(pixels, usable, scale);
    let robust = scaled.ok_or_else(degenerate)?.map(|c| c * scale * scale);
    let rejection =
        Rejection::new(robust, count, median_residual(pixels, usable, &robust, workspace), params);
    let inliers = Inliers { residual: rejection.band, ..Inliers::all(usable) };
    let refit = reweighted(pixels, &inliers, scale, params.limits_confidence);
    rejection.finish(refit.as_ref().ok_or_else(degenerate)?, count, params, out);
    Ok(())
}

/// What follows from the robust z alone.
struct Rejection {
    median_residual: f64,
    dispersion: f64,
    band: Band,
}

impl Rejection {
    fn new(robust: Coefficients, count: usize, median_residual: f64, params: &Params) -> Self {
        let dispersion = CONSISTENCY * (1.0 + 5.0 / (count as f64 - TERMS as f64)) * median_residual;
        let band = match params.method {
            Method::LeastMedian => Band::residual(robust, dispersion, params.rejection),
            Method::LeastSquares => Band { form: robust, ..Band::EVERYTHING },
        };
        Self { median_residual, dispersion, band }
    }

    /// The whole fit, where it is wanted.
    #[inline(never)]
    fn finish(&self, refit: &Refit, count: usize, params: &Params, out: &mut Option<Fit>) {
        *out = Some(Fit {
            robust: self.band.form,
            median_residual: self.median_residual,
            dispersion: self.dispersion,
            r_squared: 1.0 - self.median_residual * self.median_residual,
            band: self.band,
            coefficients: refit.coefficients,
            residual_deviation: refit.residual_deviation,
            color_deviations: refit.color_deviations,
            noise_deviation: refit.noise_deviation,
            degenerate_noise_deviation: refit.degenerate_noise_deviation,
            usable: count,
            inliers: refit.count as usize,
            subsets: match params.method {
                Method::LeastMedian => params.subset_count().unwrap_or(0),
                Method::LeastSquares => 0,
            },
        });
    }
}

/// The error where the usable pixels determine no z.
#[inline(never)]
fn degenerate(pixels: &impl Pixels, usable: Usable, scale: f64) -> FitError {
    let moments = moments(pixels, &Inliers::all(usable), scale);
    FitError::RankDeficient { color_deviations: deviations(&moments, scale) }
}

/// The median absolute residual of the usable pixels.
#[inline(never)]
fn median_residual(pixels: &impl Pixels, usable: Usable, z: &Coefficients, workspace: &mut [f32]) -> f64 {
    let residuals = pixels
        .gather(Inliers::all(usable).selector(), workspace, |r, g, b| fabs(quadratic_form(z, r, g, b) - 1.0));
    kth_smallest(residuals, median_rank(residuals.len())).map_or(0.0, f64::from)
}

/// The sums over the inliers' scaled colors.
#[inline(never)]
fn moments(pixels: &impl Pixels, inliers: &Inliers, scale: f64) -> Moments {
    let mut moments = Moments::default();
    pixels.for_each_window(|window| {
        let mut sums = Moments::default();
        for_each_bit(inliers.bits(window), |i| sums.add(window.pixel(i).map(|c| f64::from(c) * scale)));
        moments.merge(&sums);
    });
    moments
}

/// Rounding to whole steps is noise of this many steps: 1 / sqrt(12).
const ROUNDING: f64 = 0.288_675_134_594_812_9;

/// The smallest difference in a channel between an inlier and the one before it, other than none: how finely the
/// picture is quantised, whatever the type of its pixels. Zero when there are no differences.
#[inline(never)]
fn smallest_step(pixels: &impl Pixels, inliers: &Inliers) -> f64 {
    let mut smallest = f32::INFINITY;
    let mut previous = None;
    pixels.for_each_window(|window| {
        for_each_bit(inliers.bits(window), |i| {
            let pixel = window.pixel(i);
            for (now, before) in pixel.into_iter().zip(previous.unwrap_or(pixel)) {
                let step = fabsf(now - before);
                if step > 0.0 && step < smallest {
                    smallest = step;
                }
            }
            previous = Some(pixel);
        });
    });
    if smallest.is_finite() { f64::from(smallest) } else { 0.0 }
}

#[inline(never)]
fn deviations(moments: &Moments, scale: f64) -> [f64; 3] {
    symmetric_eigen(&moments.second_moments()).values.map(|square| sqrt(square.max(0.0)) / scale)
}

/// Least squares over inliers.
pub(crate) struct Refit {
    pub coefficients: [Estimate; TERMS],
    pub residual_deviation: f64,
    pub noise_deviation: f64,
    pub degenerate_noise_deviation: f64,
    pub color_deviations: [f64; 3],
    pub count: u32,
}

impl Refit {
    /// The coefficients.
    pub fn z(&self) -> Coefficients {
        self.coefficients.map(|estimate| estimate.value)
    }

    /// From the sums of colors times `scale`, their least squares, and the sum of squares of its residuals. Noise is at least
    /// `rounding`.
    pub fn new(
        moments: &Moments,
        fit: &LeastSquares,
        scale: f64,
        confidence: f64,
        residual_sum: f64,
        rounding: f64,
    ) -> Option<Self> {
        if (moments.count as usize) < MIN_PIXELS {
            return None;
        }
        let variance = residual_sum / (f64::from(moments.count) - TERMS as f64);
        let noise = moments.noise(&fit.coefficients, residual_sum) / scale;
        let degenerate_noise_deviation = moments.degenerate_noise(fit) / scale;
        let color_deviations = deviations(moments, scale);
        let mut coefficients = regression::estimates(fit, variance, moments.count, confidence);
        for e in &mut coefficients {
            for value in [&mut e.value, &mut e.standard_error, &mut e.low, &mut e.high] {
                *value *= scale * scale;
            }
        }
        Some(Self {
            coefficients,
            residual_deviation: sqrt(variance),
            noise_deviation: noise.max(rounding),
            degenerate_noise_deviation,
            color_deviations,
            count: moments.count,
        })
    }
}

/// The least-squares fit to the inliers with its statistics, in pixel values.
#[inline(never)]
fn reweighted(pixels: &impl Pixels, inliers: &Inliers, scale: f64, confidence: f64) -> Option<Refit> {
    let moments = moments(pixels, inliers, scale);
    let fit = moments.solve();
    let fit = fit.as_ref()?;
    let residual_sum = residual_sum(pixels, inliers, &fit.coefficients.map(|c| c * (scale * scale)));
    let rounding = smallest_step(pixels, inliers) * ROUNDING;
    Refit::new(&moments, fit, scale, confidence, residual_sum, rounding)
}

/// The sum of the squared residuals of the inliers.
#[inline(never)]
fn residual_sum(pixels: &impl Pixels, inliers: &Inliers, z: &Coefficients) -> f64 {
    let mut residual_sum = 0.0;
    pixels.for_each_window(|window| {
        let mut sum = 0.0;
        for_each_bit(inliers.bits(window), |i| {
            let [r, g, b] = window.pixel(i);
            let residual = quadratic_form(z, r, g, b) - 1.0;
            sum += residual * residual;
        });
        residual_sum += sum;
    });
    residual_sum
}

/// 2^-k for the k that brings `largest` into [1, 2).
pub(crate) fn reciprocal_power_of_two(largest: f32) -> f64 {
    libm::ldexp(1.0, -libm::ilogbf(largest))
}

/// Scaled colors of some usable pixels, channels apart, and room for a residual each.
struct Sample<'w> {
    red: &'w [f32],
    green: &'w [f32],
    blue: &'w [f32],
    residuals: &'w mut [f32],
}

impl<'w> Sample<'w> {
    /// One pixel from each of `len` equal parts of the usable pixels in picture order, at a random place within it.
    fn gather(
        image: &Image,
        usable: Usable,
        available: usize,
        len: usize,
        scale: f64,
        rng: &mut Rng,
        workspace: &'w mut [f32],
    ) -> Option<Self> {
        let (red, rest) = workspace.split_at_mut_checked(len)?;
        let (green, rest) = rest.split_at_mut_checked(len)?;
        let (blue, rest) = rest.split_at_mut_checked(len)?;
        let residuals = rest.get_mut(..len)?;
        let mut stratum = |i: usize| {
            let border = |i: usize| (available * i).checked_div(len).unwrap_or(0);
            border(i) + rng.below((border(i + 1) - border(i)) as u32) as usize
        };
        let (mut taken, mut seen) = (0, 0);
        let mut wanted = stratum(0);
        image.for_each_window(|window| {
            for_each_bit(usable.bits(window), |i| {
                if seen == wanted && taken < len {
                    let pixel = window.pixel(i).map(|c| (f64::from(c) * scale) as f32);
                    if let (Some(r), Some(g), Some(b)) =
                        (red.get_mut(taken), green.get_mut(taken), blue.get_mut(taken))
                    {
                        [*r, *g, *b] = pixel;
                    }
                    taken += 1;
                    if taken < len {
                        wanted = stratum(taken);
                    }
                }
                seen += 1;
            });
        });
        Some(Self { red, green, blue, residuals })
    }

    fn len(&self) -> usize {
        self.red.len()
    }

    fn color(&self, i: u32) -> [f64; 3] {
        [self.red, self.green, self.blue]
            .map(|channel| channel.get(i as usize).map_or(0.0, |&value| f64::from(value)))
    }

    fn colors(&self) -> impl Iterator<Item = (f32, f32, f32)> {
        self.red.iter().zip(self.green).zip(self.blue).map(|((&r, &g), &b)| (r, g, b))
    }

    /// The z that the search finds; `None` when no subset determines an ellipsoid.
    fn best(mut self, subsets: u32, rng: &mut Rng) -> Option<Coefficients> {
        let proposal = self.search(subsets, rng)?;
        Some(self.concentrate(proposal))
    }

    /// The proposal with the smallest median residual; `None` when no subset determines an ellipsoid.
    fn search(&mut self, subsets: u32, rng: &mut Rng) -> Option<Proposal> {
        let mut best: Option<Proposal> = None;
        for _ in 0..subsets {
            let subset = rng.distinct::<TERMS>(self.len() as u32)?;
            let Some(z) = regression::through(&subset.map(|i| self.color(i))) else { continue };
            // The median can only be smaller if more than half of the residuals are: counting is cheaper.
            if best.as_ref().is_none_or(|best| self.count_below(&z, best.objective) > median_rank(self.len()))
            {
                best = Some(Proposal { objective: self.objective(&z), z });
            }
        }
        best
    }

    /// Least squares over the better half, again and again, for as long as the objective falls.
    fn concentrate(&mut self, start: Proposal) -> Coefficients {
        let mut best = start;
        for _ in 0..CONCENTRATION_STEPS {
            let mut moments = Moments::default();
            for (r, g, b) in self.colors() {
                if absolute_residual(&best.z.map(|c| c as f32), r, g, b) <= best.objective {
                    moments.add([r, g, b].map(f64::from));
                }
            }
            let Some(fit) = moments.solve() else { break };
            let objective = self.objective(&fit.coefficients);
            if objective >= best.objective {
                break;
            }
            best = Proposal { objective, z: fit.coefficients };
        }
        best.z
    }

    fn count_below(&self, z: &Coefficients, limit: f32) -> usize {
        let z = z.map(|c| c as f32);
        let mut count = 0_u32;
        for (r, g, b) in self.colors() {
            count += u32::from(absolute_residual(&z, r, g, b) < limit);
        }
        count as usize
    }

    fn objective(&mut self, z: &Coefficients) -> f32 {
        let z = z.map(|c| c as f32);
        let Self { red, green, blue, residuals } = self;
        for (((&r, &g), &b), residual) in red.iter().zip(*green).zip(*blue).zip(residuals.iter_mut()) {
            *residual = absolute_residual(&z, r, g, b);
        }
        kth_smallest(residuals, median_rank(residuals.len())).unwrap_or(f32::INFINITY)
    }
}

/// |rho^T C rho - 1| in single precision: what the search compares. The answer's residuals are computed in double.
#[inline]
fn absolute_residual(z: &[f32; TERMS], r: f32, g: f32, b: f32) -> f32 {
    let [c11, c22, c33, c12, c13, c23] = *z;
    let red = r * (c11 * r + 2.0 * (c12 * g + c13 * b));
    let green = g * (c22 * g + 2.0 * c23 * b);
    (red + green + c33 * b * b - 1.0).abs()
}

#[derive(Clone, Copy)]
struct Proposal {
    z: Coefficients,
    objective: f32,
}
