"""Stream: the frames of a camera, row by row or whole, under lights that stay."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import output, row_stride
from ._native import ffi, lib
from .enums import Pass, Status
from .params import StreamParams
from .picture import Channels, Photo, Picture, picture_of
from .solution import Solution

_PLANES = {"uint8": "OFC_PIXEL_PLANES8", "uint16": "OFC_PIXEL_PLANES16", "float32": "OFC_PIXEL_PLANES32F"}


@dataclasses.dataclass(frozen=True, eq=False)
class Drift:
    """What the last frame that refined the model says about the model from before it; NaN where there is no new one."""

    inlier_ratio: float
    angle_rad: _abi.Vector3
    strength_ratio: _abi.Vector3
    dispersion_ratio: float
    refined: bool


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    """What Stream.frame() made of a frame.

    Attributes:
        status: OK; COLD_START_NEEDED where the model no longer fits; or why a cold start found no F.
        was: What the frame was for.
        normals: (height, width, 3) float32; None where no F is known yet.
    """

    status: Status
    was: Pass
    normals: npt.NDArray[np.float32] | None


class Stream:
    """A model of the lights that a few rows of every frame refine. It keeps no frame.

    Args:
        width, height: The size of the frames.
        dtype: uint8, uint16 or float32.
        params: What the stream does.
    """

    def __init__(self, width: int, height: int, dtype: npt.DTypeLike = np.uint8, params: StreamParams = StreamParams()) -> None:
        kind = np.dtype(dtype).name
        if kind not in _PLANES:
            raise ValueError(f"dtype is uint8, uint16 or float32, not {kind}")
        self.width, self.height = width, height
        given = _abi.params("ofc_stream_params", lib.ofc_stream_params_default, params)
        need = lib.ofc_stream_size(width, height, given)
        self._memory = _abi.workspace(need)
        made = ffi.new("ofc_stream **")
        _abi.check(
            lib.ofc_stream_init(
                width, height, getattr(lib, _PLANES[kind]), given, _abi.pointer("void *", self._memory), need, made
            )
        )
        self._stream = made[0]

    def restart(self) -> None:
        """Forgets the model; the next frame is for colors."""
        _abi.check(lib.ofc_stream_restart(self._stream))

    def begin(self) -> Pass:
        """Begins a frame, and says what it is for."""
        what = ffi.new("ofc_stream_pass *")
        _abi.check(lib.ofc_stream_begin(self._stream, what))
        return Pass(what[0])

    def row(self, y: int, row: Photo, mask: npt.ArrayLike | None = None, *, channels: Channels = "rgb") -> None:
        """Takes the next row of the frame, a picture of height 1."""
        _abi.check(lib.ofc_stream_row(self._stream, y, picture_of(row, mask, channels).struct))

    def end(self) -> tuple[Status, Pass]:
        """Ends the frame, and says how it went and what the next one is for. A status above zero is no error."""
        what = ffi.new("ofc_stream_pass *")
        status = Status(lib.ofc_stream_end(self._stream, what))
        if status < 0 and status not in (Status.TOO_FEW_PIXELS, Status.DARK, Status.SATURATED):
            _abi.check(status)
        return status, Pass(what[0])

    def normals_row(self, row: Photo, *, channels: Channels = "rgb") -> npt.NDArray[np.float32]:
        """Unit normals of a row under the current model, (width, 3) float32; zero where there is none."""
        out = np.empty((self.width, 3), np.float32)
        _abi.check(lib.ofc_stream_normals_row(self._stream, self._row(row, channels).struct, _abi.pointer("float *", out)))
        return out

    def normals_row_packed(self, row: Photo, *, channels: Channels = "rgb") -> npt.NDArray[np.uint8]:
        """Unit normals of a row as 255 (n + 1) / 2, (width, 3) uint8; three zeros where there is none."""
        out = np.empty((self.width, 3), np.uint8)
        address = _abi.pointer("uint8_t *", out)
        _abi.check(lib.ofc_stream_normals_row_packed(self._stream, self._row(row, channels).struct, address))
        return out

    def inliers_row(self, row: Photo, *, channels: Channels = "rgb") -> npt.NDArray[np.bool_]:
        """Which pixels of a row obey the current model, (width,) bool."""
        out = np.empty(self.width, np.uint8)
        _abi.check(lib.ofc_stream_inliers_row(self._stream, self._row(row, channels).struct, _abi.pointer("uint8_t *", out)))
        return out > 0

    def frame(
        self,
        photo: Photo,
        mask: npt.ArrayLike | None = None,
        *,
        channels: Channels = "rgb",
        out: npt.NDArray[np.float32] | None = None,
    ) -> Frame:
        """Takes a whole frame, and makes its normals where F is known.

        The first frames, of a scene at rest, are for the cold start; every further one refines the model.
        """
        picture = picture_of(photo, mask, channels)
        if picture.shape != (self.height, self.width):
            raise ValueError(f"frames have {self.height} rows of {self.width}, not the shape {picture.shape}")
        was = self.begin()
        rows = [_row_of(picture, y) for y in range(self.height)]
        for y, row in enumerate(rows):
            _abi.check(lib.ofc_stream_row(self._stream, y, row))
        status, _ = self.end()
        found = ffi.new("ofc_solution *")
        if status is not Status.OK or lib.ofc_stream_solution(self._stream, found) != Status.OK:
            return Frame(status, was, None)
        out = output(out, (*picture.shape, 3))
        first, step = int(ffi.cast("uintptr_t", _abi.pointer("float *", out))), row_stride(out)
        for y, row in enumerate(rows):
            _abi.check(lib.ofc_stream_normals_row(self._stream, row, ffi.cast("float *", first + y * step)))
        return Frame(status, was, out)

    def solution(self, photo: Photo, mask: npt.ArrayLike | None = None, *, channels: Channels = "rgb") -> Solution:
        """What the last cold start found, as refined by the frames since, with the inliers of a picture."""
        picture = picture_of(photo, mask, channels)
        struct = ffi.new("ofc_solution *")
        _abi.check(lib.ofc_stream_solution(self._stream, struct))
        inliers = np.zeros(picture.shape, np.uint8)
        test = ffi.addressof(struct, "inlier_test")
        _abi.check(lib.ofc_inlier_test_apply(picture.struct, test, _abi.pointer("uint8_t *", inliers), ffi.NULL))
        return _abi.read(Solution, struct, inliers=inliers > 0, picture=picture, struct=struct)

    def drift(self) -> Drift:
        """What the last frame that refined the model says about it."""
        found = ffi.new("ofc_stream_drift *")
        _abi.check(lib.ofc_stream_drift_get(self._stream, found))
        return _abi.read(Drift, found)

    def _row(self, row: Photo, channels: Channels) -> Picture:
        picture = picture_of(row, None, channels)
        if picture.width != self.width:  # or C would write beyond the output
            raise ValueError(f"rows have {self.width} pixels, not {picture.width}")
        return picture


def _row_of(picture: Picture, y: int) -> object:
    """One row of a picture, which the caller keeps."""
    row = ffi.new("ofc_image *", picture.struct[0])
    row.height = 1
    for name, stride in (
        ("pixels", row.row_stride_bytes),
        ("green_plane", row.row_stride_bytes),
        ("blue_plane", row.row_stride_bytes),
        ("mask", row.mask_stride_bytes),
    ):
        first = getattr(row, name)
        if first != ffi.NULL:
            setattr(row, name, ffi.cast(ffi.typeof(first), int(ffi.cast("uintptr_t", first)) + y * stride))
    return row
