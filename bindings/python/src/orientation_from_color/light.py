"""From what files hold to light: transfer curves, clipping, and light that is not the model's."""

from __future__ import annotations

import dataclasses
from typing import Annotated

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import output, row_stride
from ._native import ffi, lib
from .enums import Transfer
from .picture import Channels, Photo, picture_of
from .solution import Solution

_Pixels = npt.NDArray[np.float32]


def transfer_table(transfer: Transfer, gamma: float = 2.2, *, bits: int = 8) -> _Pixels:
    """The light of every number that a sample of 8 or 16 bits can be, in the numbers' own scale."""
    table = np.empty(1 << bits, np.float32)
    _abi.check(lib.ofc_transfer_table(transfer, gamma, len(table), _abi.pointer("float *", table)))
    return table


def linearize(
    photo: Photo,
    transfer: Transfer = Transfer.SRGB,
    *,
    gamma: float = 2.2,
    table: npt.ArrayLike | None = None,
    channels: Channels = "rgb",
    out: _Pixels | None = None,
) -> _Pixels:
    """The picture as light, (height, width, 3) float32, red first, in the picture's own scale; solve() takes it.

    Full scale stays full scale, so LmedsParams(saturation=255) finds saturated pixels of 8 bits. `table` is for
    Transfer.TABLE and has the light of each of 256 or 65,536 numbers.
    """
    picture = picture_of(photo, None, channels)
    out = output(out, (*picture.shape, 3))
    entries = None if table is None else np.ascontiguousarray(table, np.float32)
    count = 0 if entries is None else entries.size
    address, pixels = _abi.pointer("float *", entries), _abi.pointer("float *", out)
    _abi.check(lib.ofc_transfer_linearize(picture.struct, transfer, gamma, address, count, pixels, row_stride(out)))
    return out


def find_saturation(photo: Photo, mask: npt.ArrayLike | None = None, *, channels: Channels = "rgb") -> tuple[float, int] | None:
    """The level below full scale at which pixels pile up, for LmedsParams(saturation=level), and how many do; or None."""
    picture = picture_of(photo, mask, channels)
    level, count = ffi.new("double *"), ffi.new("int32_t *")
    _abi.check(lib.ofc_saturation_find(picture.struct, level, count))
    return (float(level[0]), int(count[0])) if level[0] > 0 else None


def subtract_dark(photo: Photo, dark: Photo, *, channels: Channels = "rgb", out: _Pixels | None = None) -> _Pixels:
    """The picture less a picture of the same scene with the lights off, (height, width, 3) float32, red first."""
    picture, below = picture_of(photo, None, channels), picture_of(dark, None, channels)
    out = output(out, (*picture.shape, 3))
    _abi.check(lib.ofc_dark_subtract(picture.struct, below.struct, _abi.pointer("float *", out), row_stride(out)))
    return out


def subtract_offset(photo: Photo, offset: npt.ArrayLike, *, channels: Channels = "rgb", out: _Pixels | None = None) -> _Pixels:
    """The picture less one color, red first, as fit_offset() finds it: (height, width, 3) float32, red first."""
    picture = picture_of(photo, None, channels)
    out = output(out, (*picture.shape, 3))
    color = np.ascontiguousarray(offset, np.float64)
    if color.shape != (3,):
        raise ValueError(f"an offset is red, green, blue, not of shape {color.shape}")
    _abi.check(
        lib.ofc_offset_subtract(picture.struct, _abi.pointer("double *", color), _abi.pointer("float *", out), row_stride(out))
    )
    return out


@dataclasses.dataclass(frozen=True, eq=False)
class Offset:
    """What fit_offset() found; ofc_offset in ofc.h says how to read the numbers."""

    offset: _abi.Vector3
    covariance: _abi.Matrix3
    coefficients: Annotated[_abi.Floats, (6,)]
    deviation: float
    deviation_around_black: float
    noise: float
    chi_squared: float
    count: int
    blocks: int


def fit_offset(solution: Solution, *, sample_size: int = 8192) -> Offset:
    """Light that is the same everywhere and not the model's, as the center of the ellipsoid of a solved picture's colors.

    Subtract it, solve what is left, and do it again; three times are enough.
    """
    if solution.picture is None:
        raise ValueError("a solution that was pickled has left its picture behind")
    need = lib.ofc_offset_workspace_size(sample_size)
    memory, found = _abi.workspace(need), ffi.new("ofc_offset *")
    c = np.ascontiguousarray(solution.ellipsoid.c.ravel()[[0, 4, 8, 1, 2, 5]])
    test = ffi.addressof(solution.struct[0], "inlier_test")
    address = _abi.pointer("void *", memory)
    _abi.check(lib.ofc_offset_fit(solution.picture.struct, test, _abi.pointer("double *", c), sample_size, address, need, found))
    return _abi.read(Offset, found)
