"""What every stage of a solve found: the structs of ofc.h, field by field, where the documentation of each field is."""

from __future__ import annotations

import dataclasses
from typing import Annotated

from ._abi import Floats, Floats32, Matrix3, Vector3
from .enums import Evidence


@dataclasses.dataclass(frozen=True, eq=False)
class PixelCounts:
    """What became of the pixels before any fit."""

    usable: int
    masked_out: int
    dark: int
    saturated: int
    non_finite: int
    shadowed: int
    largest: float


@dataclasses.dataclass(frozen=True, eq=False)
class Estimate:
    """A regression coefficient and what the regression knows of it."""

    value: float
    standard_error: float
    t: float
    p: float
    low: float
    high: float


@dataclasses.dataclass(frozen=True, eq=False)
class ColorFit:
    """The quadratic form of the colors; coefficients are c11, c22, c33, c12, c13, c23."""

    robust: Annotated[Floats, (6,)]
    median_residual: float
    dispersion: float
    r_squared: float
    coefficients: tuple[Estimate, ...]
    covariance: Annotated[Floats, (21,)]
    residual_deviation: float
    color_deviations: Vector3
    noise_deviation: float
    pixel_noise: float
    degenerate_noise_deviation: float
    inlier_count: int
    subsets: int
    by_colors: bool


@dataclasses.dataclass(frozen=True, eq=False)
class Rank:
    """Effective ranks of colors and normals, and the deviations behind them."""

    color_deviations: Vector3
    color_noise: float
    normal_deviations: Vector3
    normal_noise: float
    colors: int
    normals: int


@dataclasses.dataclass(frozen=True, eq=False)
class Location:
    """Where most of a set of numbers lies."""

    location: float
    median_distance: float
    dispersion: float


@dataclasses.dataclass(frozen=True, eq=False)
class ShadowPlane:
    """A plane that bounds the colors under three lights; colors below the threshold are in a shadow."""

    normal: Annotated[Floats32, (3,)]
    threshold: float


@dataclasses.dataclass(frozen=True, eq=False)
class InlierTest:
    """A test of a pixel's color that says whether the pixel obeys the model."""

    saturation: float
    residual_form: Annotated[Floats, (6,)]
    residual_low: float
    residual_high: float
    norm_form: Annotated[Floats, (6,)]
    norm_low: float
    norm_high: float
    shadow_planes: tuple[ShadowPlane, ...]


@dataclasses.dataclass(frozen=True, eq=False)
class Ellipsoid:
    """What C says of F before the orthogonal transformation is known."""

    c: Matrix3
    eigenvalues: Vector3
    root: Matrix3
    f_f_transposed: Matrix3
    norms: Vector3
    cosines: Vector3


@dataclasses.dataclass(frozen=True, eq=False)
class Tilts:
    """Tilts of the rows of F, and the mean gradients (x, y) of the channels."""

    tilt_rad: Vector3
    mean_gradient: Annotated[Floats, (3, 2)]


@dataclasses.dataclass(frozen=True, eq=False)
class SlantCandidate:
    """Slants of the rows of F that are consistent with their tilts."""

    slant_rad: Vector3
    residual: float
    integral: float
    branch: int


@dataclasses.dataclass(frozen=True, eq=False)
class Orientation:
    """F, its inverse and its singular values."""

    f: Matrix3
    f_inverse: Matrix3
    singular_values: Vector3
    rank: int


@dataclasses.dataclass(frozen=True, eq=False)
class Confidence:
    """How sure the orientation of F is; NaN where that is not known."""

    covariance: Matrix3
    error_rad: float
    convexity: float
    log_likelihood_margin: float
    evidence: Evidence


@dataclasses.dataclass(frozen=True, eq=False)
class Covariance:
    """Expected squares and products of errors that all pixels of a picture share."""

    c: Annotated[Floats, (6, 6)]
    f: Annotated[Floats, (9, 9)]
    f_inverse: Annotated[Floats, (9, 9)]
    rotation: Matrix3
    pixel_noise: float


@dataclasses.dataclass(frozen=True, eq=False)
class Check:
    """How well a solution explains its own picture; ofc_check_result in ofc.h says how to read it."""

    correlation: Vector3
    norm_median: float
    norm_min: float
    norm_max: float
    tilts: Tilts
    relit_tilts: Tilts
    tilt_difference_rad: Vector3
    tilt_residual_rad: Vector3
    depth_angle_median_rad: float
    depth_tilts: Tilts
    depth_tilt_difference_rad: Vector3
    largest_p: float
    turn_rad: float
    turn_expected_rad: float
    convexity: float
    inlier_count: int
    has_tilts: bool
    depth_pixel_count: int
    has_depth_tilts: bool
    has_turn: bool
