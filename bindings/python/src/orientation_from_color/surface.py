"""complete(): the whole surface, a normal, its uncertainty, a depth and a class for every pixel of the mask."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Annotated

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import row_stride
from ._native import ffi, lib
from .enums import DualSource, Status, SurfaceClass
from .params import SurfaceParams
from .picture import Picture
from .report import Report

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .solution import Solution


@dataclasses.dataclass(frozen=True, eq=False)
class SurfaceLight:
    """One of the real lights, of which each channel mixes all; zeros where it was not found."""

    direction: _abi.Vector3
    color: _abi.Vector3
    dual_source: DualSource


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Surface(Report):
    """What Solution.complete() made.

    Attributes:
        normals: (height, width, 3) float32, unit normals; zero outside of the mask.
        uncertainty: (height, width) float32, the 1-sigma angle of each normal in radians; pi outside of the mask.
        depth: (height, width) float32 in the unit of the pixel pitch, growing toward the camera; NaN outside of the mask.
        flags: (height, width) uint8, the class of a pixel, which lights reach it, and whether its normal may be mirrored.
        border_gap_rad: By how much normals differ across the borders of shadows, beyond what they do among lit pixels.
    """

    lights: tuple[SurfaceLight, ...]
    border_gap_rad: float
    class_counts: Annotated[npt.NDArray[np.int32], (8,)]
    light_count: int
    regions: int
    converged: bool
    normals: npt.NDArray[np.float32]
    uncertainty: npt.NDArray[np.float32]
    depth: npt.NDArray[np.float32]
    flags: npt.NDArray[np.uint8]
    picture: Picture

    _not_in_c = ("normals", "uncertainty", "depth", "flags", "picture")

    @property
    def classes(self) -> npt.NDArray[np.uint8]:
        """What is known of each pixel, (height, width) uint8: a SurfaceClass."""
        return self.flags & np.uint8(lib.OFC_SURFACE_CLASS)

    @property
    def doubtful(self) -> npt.NDArray[np.bool_]:
        """Where the mirror image of a normal is the right one with a probability above 0.1, (height, width) bool."""
        return np.asarray((self.flags & lib.OFC_SURFACE_DOUBTFUL) != 0)

    def sees(self, light: int) -> npt.NDArray[np.bool_]:
        """Which pixels a light reaches, (height, width) bool; all where its shadow was not found."""
        if not 0 <= light < 3:
            raise ValueError(f"lights are 0, 1 and 2, not {light}")
        return np.asarray((self.flags & (lib.OFC_SURFACE_FIRST_LIGHT << light)) != 0)

    def plot(self) -> Figure:
        """The classes, the normals, how sure they are, and the depth, by matplotlib."""
        from .plot import surface

        return surface(self)

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        kinds = [kind for kind in SurfaceClass if kind is not SurfaceClass.OUTSIDE and self.class_counts[kind]]
        counts = ", ".join(f"{self.class_counts[kind]} {kind.name.lower().replace('_', ' ')}" for kind in kinds)
        inside = self.classes != SurfaceClass.OUTSIDE
        median = np.degrees(np.median(self.uncertainty[inside])) if inside.any() else np.nan
        end = "converged" if self.converged else "stopped"
        return [
            ("pixels", counts),
            ("lights", f"{self.light_count} of 3 shadows found"),
            ("1 sigma", f"{median:.2f} degrees at half of the pixels"),
            ("depth", f"{end}, {self.regions} region{'' if self.regions == 1 else 's'}"),
        ]


def complete(solution: Solution, picture: Picture, params: SurfaceParams) -> Surface:
    """The whole surface of the picture that was solved; Solution.complete() calls it."""
    given = _abi.params("ofc_surface_params", lib.ofc_surface_params_default, params)
    need = lib.ofc_surface_workspace_size(picture.width, picture.height)
    memory = _abi.workspace(need)
    normals = np.empty((*picture.shape, 3), np.float32)
    uncertainty, depth = np.empty(picture.shape, np.float32), np.empty(picture.shape, np.float32)
    classes = np.empty(picture.shape, np.uint8)
    result = ffi.new("ofc_surface_result *")
    status = lib.ofc_surface_complete(
        picture.struct,
        solution.struct,
        given,
        _abi.pointer("void *", memory),
        need,
        _abi.pointer("float *", normals),
        row_stride(normals),
        _abi.pointer("float *", uncertainty),
        row_stride(uncertainty),
        _abi.pointer("float *", depth),
        row_stride(depth),
        _abi.pointer("uint8_t *", classes),
        row_stride(classes),
        result,
    )
    if status != Status.NOT_CONVERGED:
        _abi.check(status)
    maps = {"normals": normals, "uncertainty": uncertainty, "depth": depth, "flags": classes}
    return _abi.read(Surface, result, **maps, picture=picture)
