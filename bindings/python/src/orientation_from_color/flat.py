"""flat_field(): against lights that fall off across the picture."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import output, row_stride
from ._native import ffi, lib
from .picture import Channels, Photo, picture_of


@dataclasses.dataclass(frozen=True, eq=False)
class FlatField:
    """What flat_field() made.

    Attributes:
        pixels: (height, width, 3) float32, red first, in the pixel values of the picture; NaN where a pixel has no value.
        mean: The mean of each channel of the background.
    """

    mean: _abi.Vector3
    used: int
    dark: int
    saturated: int
    pixels: npt.NDArray[np.float32]

    _not_in_c = ("pixels",)


def flat_field(
    photo: Photo, background: Photo, *, channels: Channels = "rgb", out: npt.NDArray[np.float32] | None = None
) -> FlatField:
    """Divides a picture by a picture of the same flat, uniform surface without the object. solve() takes the pixels."""
    picture, plane = picture_of(photo, None, channels), picture_of(background, None, channels)
    out = output(out, (*picture.shape, 3))
    result = ffi.new("ofc_flat_field_result *")
    _abi.check(lib.ofc_flat_field(picture.struct, plane.struct, _abi.pointer("float *", out), row_stride(out), result))
    return _abi.read(FlatField, result, pixels=out)
