"""A picture as C sees it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from ._abi import pointer
from ._arrays import picture_mask, row_stride, rows
from ._native import ffi, lib

Channels: TypeAlias = Literal["rgb", "bgr"]

_SUFFIX = {"uint8": "8", "uint16": "16", "float32": "32F"}


class Picture:
    """A view of an array's pixels, checked once, for all calls that take a picture.

    Nothing is copied where C can read the array in place: rows at any distance from each other (a region of interest), read-only
    memory, channels that are reversed by a view. Other arrays are copied: transposed or flipped ones, other byte orders, float64.

    Args:
        pixels: uint8, uint16 or float32 of shape (height, width, 3), or (height, width, 4) with a channel that is ignored; linear
            values, row 0 at the top. Or a sequence of three arrays of shape (height, width): the channels as planes.
        mask: (height, width) of bool or integers, zero where a pixel is to be left out.
        channels: "rgb", or "bgr" as OpenCV has them. Normals hardly depend on it; F and all that is said of a channel do.
    """

    __slots__ = ("channels", "height", "mask", "pixels", "struct", "width")

    def __init__(
        self,
        pixels: npt.ArrayLike | Sequence[npt.ArrayLike],
        mask: npt.ArrayLike | None = None,
        *,
        channels: Channels = "rgb",
    ) -> None:
        if channels not in ("rgb", "bgr"):
            raise ValueError(f"channels are 'rgb' or 'bgr', not {channels!r}")
        if isinstance(pixels, (list, tuple)) and len(pixels) == 3 and all(np.ndim(plane) == 2 for plane in pixels):
            planes = [_samples(np.asarray(plane)) for plane in pixels]
            if channels == "bgr":
                planes.reverse()
            self._from_planes(planes)
        else:
            self._from_pixels(_samples(np.asarray(pixels)), channels)
        self.mask = picture_mask(mask, (self.height, self.width))
        if self.mask is not None:
            self.struct.mask = pointer("uint8_t *", self.mask)
            self.struct.mask_stride_bytes = row_stride(self.mask)

    def _from_pixels(self, pixels: npt.NDArray[Any], channels: Channels) -> None:
        if pixels.ndim != 3 or pixels.shape[2] not in (3, 4):
            raise ValueError(f"a picture has the shape (height, width, 3) or (height, width, 4), not {pixels.shape}")
        order = channels
        if pixels.shape[2] == 3 and pixels.strides[2] < 0:
            # Somebody turned OpenCV's order around, or his own: the memory has the other one.
            pixels, order = pixels[..., ::-1], "bgr" if channels == "rgb" else "rgb"
        pixels = rows(pixels)
        self._set(pixels, f"{order.upper()}{'A' if pixels.shape[2] == 4 else ''}", pixels)

    def _from_planes(self, planes: list[npt.NDArray[Any]]) -> None:
        if len({(plane.shape, plane.dtype) for plane in planes}) != 1:
            raise ValueError("three planes have one shape and one type")
        planes = [rows(plane) for plane in planes]
        if len({row_stride(plane) for plane in planes}) != 1:
            planes = [np.ascontiguousarray(plane) for plane in planes]
        self._set(planes[0], "PLANES", tuple(planes))
        self.struct.green_plane = pointer("void *", planes[1])
        self.struct.blue_plane = pointer("void *", planes[2])

    def _set(self, first: npt.NDArray[Any], layout: str, kept: npt.NDArray[Any] | tuple[npt.NDArray[Any], ...]) -> None:
        self.pixels = kept
        self.height, self.width = int(first.shape[0]), int(first.shape[1])
        self.channels = layout
        self.struct = ffi.new("ofc_image *")
        self.struct.pixels = pointer("void *", first)
        self.struct.height, self.struct.width = self.height, self.width
        self.struct.row_stride_bytes = row_stride(first)
        self.struct.format = getattr(lib, f"OFC_PIXEL_{layout}{_SUFFIX[first.dtype.name]}")

    @property
    def shape(self) -> tuple[int, int]:
        """(height, width)."""
        return self.height, self.width

    def rgb(self) -> npt.NDArray[np.float64]:
        """The picture for a screen: (height, width, 3), red first, from 0 to 1 for the brightest finite value."""
        if isinstance(self.pixels, tuple):
            values = np.stack(self.pixels, axis=-1).astype(np.float64)
        else:
            values = self.pixels[..., :3].astype(np.float64)
            if self.channels.startswith("BGR"):
                values = values[..., ::-1]
        values = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
        return np.clip(values / max(float(values.max()), 1e-300), 0, 1)

    def __repr__(self) -> str:
        first = self.pixels[0] if isinstance(self.pixels, tuple) else self.pixels
        return (
            f"<Picture {self.width} x {self.height}, {self.channels} of {first.dtype}{'' if self.mask is None else ', masked'}>"
        )


Photo: TypeAlias = Picture | npt.ArrayLike | Sequence[npt.ArrayLike]


def picture_of(photo: Photo, mask: npt.ArrayLike | None = None, channels: Channels = "rgb") -> Picture:
    """The picture itself, or a view of an array."""
    if not isinstance(photo, Picture):
        return Picture(photo, mask, channels=channels)
    if mask is not None:
        raise ValueError("a Picture has its mask already")
    return photo


def _samples(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Numbers that C knows: those of the caller, or float64 as float32."""
    if 0 in array.shape:
        raise ValueError(f"a picture without pixels: its shape is {array.shape}")
    if array.dtype == np.float64:
        with np.errstate(over="ignore"):  # what is infinite then is left out
            return array.astype(np.float32)
    if array.dtype.newbyteorder("=").name not in _SUFFIX:
        raise ValueError(f"pixels are uint8, uint16, float32 or float64, not {array.dtype}")
    return array
