"""Pictures with several materials or light environments: regions that share a C, and what lights and surface a patch is of."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Annotated

import numpy as np
import numpy.typing as npt

from . import _abi
from ._native import ffi, lib
from .params import SegmentParams
from .picture import Channels, Photo, picture_of
from .report import Report
from .stages import Rank

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclasses.dataclass(frozen=True, eq=False)
class Region:
    """One region of pixels that share a C: c11, c22, c33, c12, c13, c23 in (pixel value)^-2."""

    coefficients: Annotated[_abi.Floats, (6,)]
    residual_deviation: float
    rank: Rank
    pixel_count: int
    label: int
    seed_block: Annotated[npt.NDArray[np.int32], (2,)]
    spacing: int


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Segmentation(Report):
    """What segment() found.

    Attributes:
        labels: (height, width) uint16, the label of each pixel's region, or 0; `labels == 2` is a mask for solve().
        regions: The regions, in the order found.
    """

    labels: npt.NDArray[np.uint16]
    regions: tuple[Region, ...]

    def plot(self) -> Figure:
        """The labels in colors, by matplotlib."""
        from .plot import segmentation

        return segmentation(self)

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        found = [(f"region {r.label}", f"{r.pixel_count} pixels, colors of rank {r.rank.colors}") for r in self.regions]
        return found or [("regions", "none")]


def segment(
    photo: Photo, mask: npt.ArrayLike | None = None, *, channels: Channels = "rgb", params: SegmentParams = SegmentParams()
) -> Segmentation:
    """Finds regions that share a C: each starts from six contiguous pixels and grows as far as the tolerance allows."""
    picture = picture_of(photo, mask, channels)
    given = _abi.params("ofc_segment_params", lib.ofc_segment_params_default, params)
    need = lib.ofc_segment_workspace_size(picture.width, picture.height)
    memory = _abi.workspace(need)
    labels = np.zeros(picture.shape, np.uint16)
    regions, count = ffi.new("ofc_region[]", lib.OFC_MAX_REGIONS), ffi.new("int32_t *")
    _abi.check(
        lib.ofc_segment(
            picture.struct, given, _abi.pointer("void *", memory), need, _abi.pointer("uint16_t *", labels), regions, count
        )
    )
    return Segmentation(labels, tuple(_abi.read(Region, regions[i]) for i in range(count[0])))


def classify_patches(
    photo: Photo, mask: npt.ArrayLike | None = None, *, side: int, noise: float, light: int = 0, channels: Channels = "rgb"
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]:
    """The rank of the light and the rank of the surface of each patch, two arrays of (rows, columns) uint8.

    Args:
        photo: The picture.
        mask: (height, width), zero where a pixel is to be left out.
        side: The side of a patch, 3 to 64 pixels.
        noise: The standard deviation of a channel in pixel values; Solution.fit.pixel_noise is one.
        light: The rank of the light that all patches share, 1 to 3; 0 where it is not known.
    """
    picture = picture_of(photo, mask, channels)
    counts = [lib.ofc_rank_patches_count(length, side) for length in picture.shape]
    classes = np.zeros((max(1, counts[0]), max(1, counts[1]), 2), np.uint8)
    _abi.check(lib.ofc_rank_patches(picture.struct, side, noise, light, _abi.pointer("ofc_patch_class *", classes)))
    return classes[..., 0], classes[..., 1]
