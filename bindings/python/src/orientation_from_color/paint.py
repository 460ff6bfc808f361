"""Uneven paint: C from pairs of neighbors, the albedo, and the picture without it."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import output, plane, row_stride
from ._native import ffi, lib
from .enums import PaintVerdict, Status
from .errors import Error, Refused
from .params import PaintParams
from .picture import Channels, Photo, Picture, picture_of
from .report import Report
from .stages import PixelCounts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_Int32s = npt.NDArray[np.int32]


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Paint(Report):
    """What estimate_paint() found; ofc_paint in ofc.h says how to read the numbers."""

    coefficients: Annotated[_abi.Floats, (6,)]
    margin: float
    direction_noise: float
    ratio: float
    disagreement: float
    hue_excess: float
    gradient: Annotated[_abi.Floats, (2,)]
    variogram: _abi.Vector3
    pixel_counts: PixelCounts
    distances: Annotated[_Int32s, (3,)]
    pair_counts: Annotated[_Int32s, (3,)]
    verdict: PaintVerdict
    picture: Picture
    params: PaintParams

    _not_in_c = ("picture", "params")

    def albedo(self, *, out: npt.NDArray[np.float32] | None = None) -> npt.NDArray[np.float32]:
        """The paint, (height, width) float32 with the median 1; NaN where a pixel is not usable."""
        picture = self.picture
        out = output(out, picture.shape)
        need = lib.ofc_paint_albedo_workspace_size(picture.width, picture.height)
        memory, c = _abi.workspace(need), np.ascontiguousarray(self.coefficients)
        _abi.check(
            lib.ofc_paint_albedo(
                picture.struct,
                _params(self.params),
                _abi.pointer("double *", c),
                _abi.pointer("void *", memory),
                need,
                _abi.pointer("float *", out),
                row_stride(out),
            )
        )
        return out

    def divide(
        self, albedo: npt.NDArray[np.float32] | None = None, *, out: npt.NDArray[np.float32] | None = None
    ) -> npt.NDArray[np.float32]:
        """The picture as if its paint were even, (height, width, 3) float32, red first; solve() takes it."""
        picture = self.picture
        known = plane(self.albedo() if albedo is None else albedo, picture.shape, "albedo")
        out = output(out, (*picture.shape, 3))
        _abi.check(
            lib.ofc_paint_divide(
                picture.struct,
                _params(self.params),
                _abi.pointer("float *", known),
                row_stride(known),
                _abi.pointer("float *", out),
                row_stride(out),
            )
        )
        return out

    def plot(self) -> Figure:
        """The picture, its paint, and the picture without it, by matplotlib."""
        from .plot import paint

        return paint(self)

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        variogram = "  ".join(f"{value:.2f}" for value in self.variogram)
        return [("paint", self.verdict.name.lower()), ("margin", f"{self.margin:.1f}"), ("variogram", variogram)]


def estimate_paint(
    photo: Photo, mask: npt.ArrayLike | None = None, *, channels: Channels = "rgb", params: PaintParams = PaintParams()
) -> Paint:
    """Estimates C where the paint is uneven, from pairs of neighboring pixels: they share their paint, whatever it is.

    Raises:
        Refused: The paint cannot be told from the shape, or C is not determined; `result` is the Paint.
    """
    picture = picture_of(photo, mask, channels)
    need = lib.ofc_paint_workspace_size()
    memory = _abi.workspace(need)
    struct = ffi.new("ofc_paint *")
    status = Status(lib.ofc_paint_estimate(picture.struct, _params(params), _abi.pointer("void *", memory), need, struct))
    if status < 0:
        raise Error(status)
    paint = _abi.read(Paint, struct, picture=picture, params=params)
    if status is not Status.OK:
        raise Refused(status, paint)
    return paint


def _params(params: PaintParams) -> Any:
    return _abi.params("ofc_paint_params", lib.ofc_paint_params_default, params)
