"""The parameters of ofc_solve() and its like, with their defaults. Ranges and meanings are those of ofc.h."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from .enums import (
    Convexity,
    DepthMethod,
    Fallback,
    Fit,
    Norms,
    OrientationMethod,
    ShadowRejection,
    Tilt,
    Weighting,
)


@dataclasses.dataclass(frozen=True, kw_only=True)
class LmedsParams:
    """How the regression in color space searches and what it rejects."""

    confidence: float = 0.9999
    outlier_ratio: float = 0.5
    rejection: float = 2.5
    limits_confidence: float = 0.95
    saturation: float = 0.0
    seed: int = 0
    min_subsets: int = 500
    subsets: int = 0
    sample_size: int = 10_000
    method: Fit = Fit.LEAST_MEDIAN
    weighting: Weighting = Weighting.AUTO


@dataclasses.dataclass(frozen=True, kw_only=True)
class SolveParams:
    """What solve() does."""

    lmeds: LmedsParams = LmedsParams()
    rank_threshold: float = 1e-3
    tilt_rad: Sequence[float] = (0.0, 0.0, 0.0)
    tilt_estimator: Tilt = Tilt.PENTLAND
    slant_fallback: Fallback = Fallback.LEAST_SQUARES
    orientation_method: OrientationMethod = OrientationMethod.JOINT
    shadow_rejection: ShadowRejection = ShadowRejection.AUTO
    norm_source: Norms = Norms.FIT
    convexity: Convexity = Convexity.AUTO


@dataclasses.dataclass(frozen=True, kw_only=True)
class DepthParams:
    """How integrate() works."""

    pixel_pitch: float = 1.0
    tolerance: float = 1e-4
    min_n3: float = 0.05
    prior_weight: float = 1e-3
    smoothness: float = 0.1
    method: DepthMethod = DepthMethod.POISSON
    max_cycles: int = 1000


@dataclasses.dataclass(frozen=True, kw_only=True)
class RenderParams:
    """What render() adds to the model."""

    peak: float = 255.0
    noise: float = 0.0
    seed: int = 0
    cast_shadows: bool = True


@dataclasses.dataclass(frozen=True, kw_only=True)
class StreamParams:
    """What a Stream does."""

    solve: SolveParams = SolveParams(lmeds=LmedsParams(sample_size=2048))
    min_inlier_ratio: float = 0.5
    refine_pixels: int = 16_384


@dataclasses.dataclass(frozen=True, kw_only=True)
class PaintParams:
    """How estimate_paint() works."""

    saturation: float = 0.0
    seed: int = 0


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReliefParams:
    """What is known of a relief beforehand."""

    saturation: float = 0.0
    ball_radius: float = 0.0
    seed: int = 0
    convexity: Convexity = Convexity.AUTO


@dataclasses.dataclass(frozen=True, kw_only=True)
class SurfaceParams:
    """How Solution.complete() works."""

    pixel_pitch: float = 1.0
    seed: int = 0
    channels_are_lights: bool = False


@dataclasses.dataclass(frozen=True, kw_only=True)
class SegmentParams:
    """How segment() works."""

    tolerance: float = 0.1
    saturation: float = 0.0
    seed: int = 0
    min_pixels: int = 200
    max_regions: int = 8
    seed_blocks: int = 300
    spacing: int = 0
    search_radius: int = 24
    refits: int = 12
