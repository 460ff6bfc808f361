"""Orientation from color: surface normals from one RGB picture of a uniformly colored matte surface under unknown colored lights.

::

    import orientation_from_color as ofc

    solution = ofc.solve(rgb, mask)
    normals = solution.normals()
    depth = ofc.integrate(normals, solution.inliers)

Arrays are NumPy's. x points right, y up and z toward the camera, row 0 is the top row, angles are in radians, and channels are
red, green, blue. Pixel values are linear: no gamma. Calls let other threads run, and read arrays in place where their rows are
packed.
"""

from ._native import ffi, lib
from .depth import Depth, depth_normals, integrate
from .enums import (
    Convexity,
    DepthMethod,
    DualSource,
    Evidence,
    Fallback,
    Fit,
    NoRelief,
    Norms,
    OrientationMethod,
    PaintVerdict,
    Pass,
    Reason,
    ReliefClass,
    RigAdvice,
    Scale,
    ShadowRejection,
    Slants,
    Status,
    SurfaceClass,
    Tilt,
    Transfer,
    Weighting,
)
from .errors import Error, Refused
from .flat import FlatField, flat_field
from .light import Offset, find_saturation, fit_offset, linearize, subtract_dark, subtract_offset, transfer_table
from .paint import Paint, estimate_paint
from .params import (
    DepthParams,
    LmedsParams,
    PaintParams,
    ReliefParams,
    RenderParams,
    SegmentParams,
    SolveParams,
    StreamParams,
    SurfaceParams,
)
from .picture import Picture
from .plot import normal_map
from .relief import Relief, solve_relief
from .rendering import Rendering, render
from .rig import Rig, RigContact, RigModel, follow_background, measure_contact
from .segmentation import Region, Segmentation, classify_patches, segment
from .solution import Solution, normals_from_matrix, pixel_counts, solve
from .stages import Check, Covariance, PixelCounts
from .stream import Drift, Frame, Stream
from .surface import Surface, SurfaceLight

__version__: str = ffi.string(lib.ofc_version_string()).decode()

__all__ = [
    "Check",
    "Convexity",
    "Covariance",
    "Depth",
    "DepthMethod",
    "DepthParams",
    "Drift",
    "DualSource",
    "Error",
    "Evidence",
    "Fallback",
    "Fit",
    "FlatField",
    "Frame",
    "LmedsParams",
    "NoRelief",
    "Norms",
    "Offset",
    "OrientationMethod",
    "Paint",
    "PaintParams",
    "PaintVerdict",
    "Pass",
    "Picture",
    "PixelCounts",
    "Reason",
    "Refused",
    "Region",
    "Relief",
    "ReliefClass",
    "ReliefParams",
    "RenderParams",
    "Rendering",
    "Rig",
    "RigAdvice",
    "RigContact",
    "RigModel",
    "Scale",
    "SegmentParams",
    "Segmentation",
    "ShadowRejection",
    "Slants",
    "Solution",
    "SolveParams",
    "Status",
    "Stream",
    "StreamParams",
    "Surface",
    "SurfaceClass",
    "SurfaceLight",
    "SurfaceParams",
    "Tilt",
    "Transfer",
    "Weighting",
    "classify_patches",
    "depth_normals",
    "estimate_paint",
    "find_saturation",
    "fit_offset",
    "flat_field",
    "follow_background",
    "integrate",
    "linearize",
    "measure_contact",
    "normal_map",
    "normals_from_matrix",
    "pixel_counts",
    "render",
    "segment",
    "solve",
    "solve_relief",
    "subtract_dark",
    "subtract_offset",
    "transfer_table",
]
