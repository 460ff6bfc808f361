"""render(): a picture from a surface and colored lights."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import picture_mask, plane, row_stride
from ._native import ffi, lib
from .depth import depth_map
from .params import RenderParams

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FORMATS = {"uint8": "OFC_PIXEL_RGB8", "uint16": "OFC_PIXEL_RGB16", "float32": "OFC_PIXEL_RGB32F"}


@dataclasses.dataclass(frozen=True, eq=False)
class Rendering:
    """What render() made.

    Attributes:
        pixels: (height, width, 3), red first; black outside of the mask.
        normals: (height, width, 3) float32, the true normals; zero outside of the mask.
        visible_lights: (height, width) uint32, whose bit i is set where light i reaches the pixel.
        f: (3, 3), the true F of pixels that all lights reach.
    """

    largest_modulus: float
    scale: float
    f: _abi.Matrix3
    pixels: npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | npt.NDArray[np.float32]
    normals: npt.NDArray[np.float32]
    visible_lights: npt.NDArray[np.uint32]

    _not_in_c = ("pixels", "normals", "visible_lights")

    def plot(self) -> Figure:
        """The picture and its normals, by matplotlib."""
        from .plot import rendering

        return rendering(self)


def render(
    depth: npt.ArrayLike,
    directions: npt.ArrayLike,
    colors: npt.ArrayLike,
    mask: npt.ArrayLike | None = None,
    *,
    pixel_pitch: float = 1.0,
    dtype: npt.DTypeLike = np.uint8,
    params: RenderParams = RenderParams(),
) -> Rendering:
    """Renders a depth map under distant colored lights, with shadows, scaling, noise and quantization.

    Args:
        depth: (height, width) floats, growing toward the camera; finite inside the mask.
        directions: (lights, 3), unit vectors toward the lights: x right, y up, z toward the camera.
        colors: (lights, 3), the red, green and blue that each light gives to a surface that faces it.
        mask: (height, width), zero where there is no surface.
        pixel_pitch: The distance between neighboring pixels in the unit of the depth.
        dtype: uint8, uint16 or float32.
        params: Peak, noise, seed and whether the surface casts shadows.
    """
    if np.ndim(depth) != 2:
        raise ValueError(f"depth: (height, width), not {np.shape(depth)}")
    shape = (np.shape(depth)[0], np.shape(depth)[1])
    surface, where = plane(depth, shape, "depth"), picture_mask(mask, shape)
    toward, shine = np.ascontiguousarray(directions, np.float64), np.ascontiguousarray(np.transpose(colors), np.float64)
    if toward.ndim != 2 or toward.shape[1] != 3 or shine.shape != toward.shape[::-1]:
        raise ValueError(f"directions and colors: (lights, 3) both, not {np.shape(directions)} and {np.shape(colors)}")
    if np.dtype(dtype).name not in _FORMATS:
        raise ValueError(f"dtype is uint8, uint16 or float32, not {np.dtype(dtype)}")
    lights = ffi.new("ofc_lights *")
    lights.directions, lights.colors = _abi.pointer("double *", toward), _abi.pointer("double *", shine)
    lights.count = toward.shape[0]
    pixels, normals = np.zeros((*shape, 3), np.dtype(dtype).newbyteorder("=")), np.zeros((*shape, 3), np.float32)
    visible = np.zeros(shape, np.uint32)
    result = ffi.new("ofc_rendering *")
    given = _abi.params("ofc_render_params", lib.ofc_render_params_default, params)
    _abi.check(
        lib.ofc_render(
            depth_map(surface, where, pixel_pitch),
            lights,
            given,
            _abi.pointer("void *", pixels),
            getattr(lib, _FORMATS[pixels.dtype.name]),
            row_stride(pixels),
            _abi.pointer("uint32_t *", visible),
            row_stride(visible),
            _abi.pointer("float *", normals),
            row_stride(normals),
            result,
        )
    )
    return _abi.read(Rendering, result, pixels=pixels, normals=normals, visible_lights=visible)
