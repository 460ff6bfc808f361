"""integrate(): from normals or slopes to depth, and back."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import output, picture_mask, plane, row_stride
from ._native import ffi, lib
from .enums import Status
from .params import DepthParams
from .report import Report

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Depth(Report):
    """What integrate() made.

    Attributes:
        depth: (height, width) float32 in the unit of the pixel pitch, growing toward the camera; NaN where there is none.
        regions: How many connected regions there are; each floats by itself, with zero mean.
        converged: Whether the tolerance was reached; the depth is what was reached.
    """

    residual: float
    cycles: int
    regions: int
    pixel_count: int
    excluded_count: int
    converged: bool
    depth: npt.NDArray[np.float32]
    pixel_pitch: float

    _not_in_c = ("depth", "pixel_pitch")

    def normals(self, *, out: npt.NDArray[np.float32] | None = None) -> npt.NDArray[np.float32]:
        """The unit normals of the surface, (height, width, 3) float32; zero where there is none."""
        return depth_normals(self.depth, pixel_pitch=self.pixel_pitch, out=out)

    def as_map(self) -> Any:
        """C's view of it, for calls that take one."""
        return depth_map(self.depth, None, self.pixel_pitch)

    def plot(self) -> Figure:
        """The depth in colors, and the surface in a raking light, by matplotlib."""
        from .plot import depth

        return depth(self)

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        low, high = float(np.nanmin(self.depth)), float(np.nanmax(self.depth))
        end = "converged" if self.converged else "stopped"
        return [
            ("range", f"{low:.4g} to {high:.4g}, of pixels {self.pixel_pitch:g} wide"),
            (
                "pixels",
                f"{self.pixel_count} in {self.regions} region{'' if self.regions == 1 else 's'}, {self.excluded_count} left out",
            ),
            ("iteration", f"{end} at residual {self.residual:.0e} in {self.cycles} cycles"),
        ]


def depth_map(depth: npt.NDArray[np.float32], mask: npt.NDArray[np.uint8] | None, pixel_pitch: float) -> Any:
    """C's view of a depth map; the caller keeps the arrays."""
    view = ffi.new("ofc_depth_map *")
    view.depth, view.row_stride_bytes = _abi.pointer("float *", depth), row_stride(depth)
    view.height, view.width = depth.shape
    view.pixel_pitch = pixel_pitch
    if mask is not None:
        view.mask, view.mask_stride_bytes = _abi.pointer("uint8_t *", mask), row_stride(mask)
    return view


def depth_normals(
    depth: npt.ArrayLike,
    mask: npt.ArrayLike | None = None,
    *,
    pixel_pitch: float = 1.0,
    out: npt.NDArray[np.float32] | None = None,
) -> npt.NDArray[np.float32]:
    """The unit normals of a depth map of floats, (height, width, 3) float32; zero where it is not finite."""
    shape = _shape(depth, 2, "depth")
    given, kept = plane(depth, shape, "depth"), picture_mask(mask, shape)
    out = output(out, (*shape, 3))
    view = depth_map(given, kept, pixel_pitch)
    _abi.check(lib.ofc_depth_normals(view, _abi.pointer("float *", out), row_stride(out)))
    return out


def integrate(
    normals: npt.ArrayLike | None = None,
    mask: npt.ArrayLike | None = None,
    *,
    p: npt.ArrayLike | None = None,
    q: npt.ArrayLike | None = None,
    weights: npt.ArrayLike | None = None,
    prior: npt.ArrayLike | None = None,
    params: DepthParams = DepthParams(),
    out: npt.NDArray[np.float32] | None = None,
) -> Depth:
    """Integrates normals or slopes into depth.

    Args:
        normals: (height, width, 3) floats of any length: x right, y up, z toward the camera; unusable where not finite or z <= 0.
        mask: (height, width), zero where there is to be no depth.
        p, q: The slopes dz/dx and dz/dy instead, (height, width) floats.
        weights: (height, width) floats, weights of the slopes.
        prior: (height, width) floats, known depths; not finite where unknown.
        params: The pixel pitch, the method and the tolerance.
        out: Where to put the depth.
    """
    if (normals is None) == (p is None) or (p is None) != (q is None):
        raise ValueError("give normals, or p and q")
    shape = _shape(normals, 3, "normals")[:2] if normals is not None else _shape(p, 2, "p")
    view = ffi.new("ofc_depth_input *")
    view.height, view.width = shape
    kept = []
    maps = {
        "normals": (normals, (*shape, 3)),
        "p": (p, shape),
        "q": (q, shape),
        "weights": (weights, shape),
        "prior": (prior, shape),
    }
    for name, (given, wanted) in maps.items():
        if given is not None:
            kept.append(plane(given, wanted, name))
            setattr(view, name, _abi.pointer("float *", kept[-1]))
            setattr(view, f"{name}_stride_bytes", row_stride(kept[-1]))
    where = picture_mask(mask, shape)
    if where is not None:
        view.mask, view.mask_stride_bytes = _abi.pointer("uint8_t *", where), row_stride(where)
    need = lib.ofc_depth_workspace_size(shape[1], shape[0])
    memory = _abi.workspace(need)
    out = output(out, shape)
    result = ffi.new("ofc_depth_result *")
    given_params = _abi.params("ofc_depth_params", lib.ofc_depth_params_default, params)
    status = lib.ofc_depth_integrate(
        view, given_params, _abi.pointer("void *", memory), need, _abi.pointer("float *", out), row_stride(out), result
    )
    if status != Status.NOT_CONVERGED:
        _abi.check(status)
    return _abi.read(Depth, result, depth=out, pixel_pitch=params.pixel_pitch)


def _shape(array: npt.ArrayLike | None, dimensions: int, name: str) -> tuple[int, int]:
    shape = np.shape(array) if array is not None else ()
    if len(shape) != dimensions or (dimensions == 3 and shape[2] != 3):
        raise ValueError(f"{name}: {'(height, width, 3)' if dimensions == 3 else '(height, width)'}, not {shape}")
    return shape[0], shape[1]
