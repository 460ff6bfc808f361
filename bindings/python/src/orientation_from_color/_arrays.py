"""What C reads and writes in place: rows of packed pixels, at any distance from each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


def rows(array: npt.NDArray[Any], dtype: npt.DTypeLike | None = None) -> npt.NDArray[Any]:
    """The array itself where its rows are packed, in the machine's byte order and of the type that is asked for; else a copy."""
    wanted = np.dtype(array.dtype if dtype is None else dtype).newbyteorder("=")
    packed = wanted.itemsize
    fits = array.dtype == wanted and array.flags.aligned
    for size, stride in zip(array.shape[:0:-1], array.strides[:0:-1], strict=True):
        fits = fits and (stride == packed or size == 1)
        packed *= size
    fits = fits and (array.shape[0] == 1 or (array.strides[0] >= packed and array.strides[0] % wanted.itemsize == 0))
    return array if fits else np.ascontiguousarray(array, wanted)


def row_stride(array: npt.NDArray[Any]) -> int:
    """The bytes from one packed row to the next; NumPy has any number where there is one row."""
    return int(array.strides[0] if array.shape[0] > 1 else array.nbytes)


def picture_mask(mask: npt.ArrayLike | None, shape: tuple[int, int]) -> npt.NDArray[np.uint8] | None:
    """A mask as bytes, zero where a pixel is left out; masks of bool or uint8 are not copied."""
    if mask is None:
        return None
    array = np.asarray(mask)
    if array.shape != shape or array.dtype.kind not in "biu":
        raise ValueError(f"a mask is bool or integers of shape {shape}, not {array.dtype} of shape {array.shape}")
    if array.dtype == np.bool_:
        array = array.view(np.uint8)
    return rows(array if array.dtype == np.uint8 else array != 0, np.uint8)


def plane(array: npt.ArrayLike, shape: tuple[int, ...], name: str) -> npt.NDArray[np.float32]:
    """A map of float32 that C can read, of the shape that is asked for."""
    given = np.asarray(array)
    if given.shape != shape or given.dtype.kind != "f":
        raise ValueError(f"{name}: floats of shape {shape}, not {given.dtype} of shape {given.shape}")
    if 0 in shape:
        raise ValueError(f"{name}: empty, of shape {shape}")
    return rows(given, np.float32)


def output(out: npt.NDArray[np.float32] | None, shape: tuple[int, ...]) -> npt.NDArray[np.float32]:
    """New memory for a result, or the caller's, which must be writable and have packed rows."""
    if out is None:
        return np.empty(shape, np.float32)
    if out.shape != shape or out.dtype != np.float32 or not out.flags.writeable or rows(out) is not out:
        raise ValueError(f"out: a writable float32 array of shape {shape} with packed rows, in the machine's byte order")
    return out
