"""A relief on a plane: pictures most of which is one flat surface, as the frames of a tactile sensor."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import output, row_stride
from ._native import ffi, lib
from .enums import NoRelief, ReliefClass, Scale, Status
from .errors import Error, Refused
from .params import ReliefParams
from .picture import Channels, Photo, Picture, picture_of
from .report import Report

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_NONE = {
    NoRelief.NONE: "",
    NoRelief.UNTOUCHED: "nothing differs from a smooth plane",
    NoRelief.NO_PLANE: "more than half of the picture differs from a smooth plane",
    NoRelief.NOT_DETERMINED: "what differs from the plane bends in one direction only, or hardly beyond noise",
    NoRelief.NOT_INTEGRABLE: "what differs from the plane is paint, spots or shadows: its slopes would not be those of a surface",
    NoRelief.EDGE: "what differs from the plane has an edge: it lies on the plane, or it is paint",
}


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Relief(Report):
    """What solve_relief() found; ofc_relief in ofc.h says how to read the numbers.

    Attributes:
        slopes: W, (2, 3): (n1, n2) = W delta, where delta is a pixel's color over that of the plane, less 1.
        classes: (height, width) uint8, a ReliefClass for each pixel.
    """

    slopes: Annotated[_abi.Floats, (2, 3)]
    plane: Annotated[_abi.Floats, (3, 15)]
    noise: _abi.Vector3
    circulation: float
    circulation_ratio: float
    anisotropy: float
    signal_to_noise: float
    border: float
    outward: float
    scale_deviation: float
    disagreement: float
    tilt: float
    expected_error: float
    saturation: float
    scale_source: Scale
    has_background: bool
    reason: NoRelief
    width: int
    height: int
    cells: Annotated[npt.NDArray[np.int32], (4,)]
    classes: npt.NDArray[np.uint8]
    picture: Picture
    background: Picture | None
    struct: Any

    _not_in_c = ("classes", "picture", "background", "struct")

    def normals(
        self,
        *,
        out: npt.NDArray[np.float32] | None = None,
        uncertainty: npt.NDArray[np.float32] | None = None,
    ) -> npt.NDArray[np.float32]:
        """Unit normals, (height, width, 3) float32: (0, 0, 1) on the plane, NaN where there is no usable color.

        Where `uncertainty` is an array of (height, width) float32, it becomes the standard deviation of the angle in radians.
        """
        out = output(out, (*self.picture.shape, 3))
        sigma = None if uncertainty is None else output(uncertainty, self.picture.shape)
        _abi.check(
            lib.ofc_relief_normals(
                self.picture.struct,
                struct_of(self.background),
                self.struct,
                _abi.pointer("uint8_t *", self.classes),
                _abi.pointer("float *", out),
                row_stride(out),
                _abi.pointer("float *", sigma),
                0 if sigma is None else row_stride(sigma),
            )
        )
        return out

    def uncertainty(self) -> npt.NDArray[np.float32]:
        """The standard deviation of each angle in radians, (height, width) float32; 0 on the plane, NaN without a normal."""
        sigma = np.empty(self.picture.shape, np.float32)
        self.normals(uncertainty=sigma)
        return sigma

    def trust(self) -> str:
        """How far to trust the relief, in a sentence."""
        if self.reason is not NoRelief.NONE:
            return _NONE[self.reason]
        if self.scale_source is Scale.UNKNOWN:
            off = 100 * (math.exp(self.scale_deviation) - 1)
            words = f"the shape, not its height: the scale of slopes and depth is a usual one, and may be off by {off:.0f} %"
        else:
            words = (
                f"normals in the contact are expected to be off by {math.degrees(self.expected_error):.1f} degrees; the scale "
                f"is known within {100 * self.scale_deviation:.0f} %"
            )
        return words + ("; the picture hardly tells whether it rises or goes down" if self.outward < 0.2 else "")

    def plot(self) -> Figure:
        """The picture, its classes and its normals, by matplotlib."""
        from .plot import relief

        return relief(self)

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        share = 100 * np.bincount(self.classes.ravel(), minlength=4) / max(1, self.classes.size)
        parts = f"{share[ReliefClass.CONTACT]:.1f} % of the picture is contact, {share[ReliefClass.PLANE]:.1f} % plane"
        return [("relief", parts), ("trust", self.trust())]


def solve_relief(
    photo: Photo,
    background: Photo | None = None,
    mask: npt.ArrayLike | None = None,
    *,
    channels: Channels = "rgb",
    params: ReliefParams = ReliefParams(),
) -> Relief:
    """Finds the plane that most of a picture shows, and what turns colors into the normals of the relief on it.

    Args:
        photo: The picture.
        background: A picture of the plane alone, of the same size; without it the plane is estimated from the picture.
        mask: (height, width), zero where a pixel is to be left out.
        params: The radius of a ball that is pressed in, hollow or not, and the seed.

    Raises:
        Refused: The picture shows no relief on a plane; `result` is the Relief, whose `reason` says why.
    """
    picture = picture_of(photo, mask, channels)
    plane = None if background is None else picture_of(background, None, channels)
    given = _abi.params("ofc_relief_params", lib.ofc_relief_params_default, params)
    need = lib.ofc_relief_workspace_size(picture.width, picture.height)
    memory = _abi.workspace(need)
    classes = np.zeros(picture.shape, np.uint8)
    struct = ffi.new("ofc_relief *")
    status = Status(
        lib.ofc_relief_solve(
            picture.struct,
            struct_of(plane),
            given,
            _abi.pointer("void *", memory),
            need,
            _abi.pointer("uint8_t *", classes),
            struct,
        )
    )
    if status < 0:
        raise Error(status)
    relief = _abi.read(Relief, struct, classes=classes, picture=picture, background=plane, struct=struct)
    if status is not Status.OK:
        raise Refused(status, relief, details=_NONE[relief.reason])
    return relief


def struct_of(picture: Picture | None) -> Any:
    """C's view of a picture that may not be there."""
    return ffi.NULL if picture is None else picture.struct
