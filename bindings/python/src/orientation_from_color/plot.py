"""The pictures of results, by matplotlib, which is an optional dependency."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .errors import Error

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .depth import Depth
    from .paint import Paint
    from .relief import Relief
    from .rendering import Rendering
    from .segmentation import Segmentation
    from .solution import Solution
    from .surface import Surface


def normal_map(normals: npt.NDArray[np.floating[Any]]) -> npt.NDArray[np.uint8]:
    """Normals as colors, (height, width, 3) uint8, red first: 255 (n + 1) / 2, and black where there is none.

    Raises:
        ValueError: They are not unit vectors of shape (height, width, 3).
    """
    normals = np.asarray(normals)
    if normals.ndim != 3 or normals.shape[2] != 3 or normals.dtype.kind != "f":
        raise ValueError(f"normals: floats of shape (height, width, 3), not {normals.dtype} of shape {normals.shape}")
    if np.nanmax(np.abs(normals), initial=0) > 1.001:
        raise ValueError("normals: components are from -1 to 1")
    known = np.isfinite(normals).all(axis=-1) & (normals != 0).any(axis=-1)
    return np.where(known[..., None], np.rint(255 * (np.nan_to_num(normals) + 1) / 2), 0).astype(np.uint8)


def solution(found: Solution) -> Figure:
    """The picture, its inliers, the normals and how sure they are."""
    picture = found._picture(None, None, "rgb")
    figure, (photo, inliers, normals, sigma) = _panels(4, picture.shape)
    _image(photo, picture.rgb(), "picture")
    _image(inliers, found.inliers, f"{found.inlier_count} inliers")
    _image(normals, normal_map(found.normals()), "normals: x red, y green, z blue")
    try:
        angle = np.degrees(found.uncertainty())
    except Error:  # the direct method knows none
        angle = np.full(picture.shape, np.nan, np.float32)
    _scale(sigma, np.where(found.inliers, angle, np.nan), "1 sigma of the normals, degrees")
    return figure


def depth(found: Depth) -> Figure:
    """The depth in colors, and the surface in a raking light."""
    figure, (height, raking) = _panels(2, found.depth.shape)
    _scale(height, found.depth, "depth toward the camera")
    normals = found.normals()
    light = np.array([-1.0, 1.0, 1.0]) / np.sqrt(3)
    _image(raking, np.clip(normals @ light, 0, 1), "lit from the upper left")
    return figure


def surface(found: Surface) -> Figure:
    """The classes, the normals, how sure they are, and the depth."""
    figure, (classes, normals, sigma, height) = _panels(4, found.depth.shape)
    inside = found.classes != 0
    shown = classes.imshow(np.ma.masked_equal(found.classes, 0), cmap="tab10", vmin=-0.5, vmax=9.5, interpolation="nearest")
    names = classes.figure.colorbar(shown, ax=classes, shrink=0.8, ticks=range(1, 6), boundaries=np.arange(0.5, 6))
    names.set_ticklabels(["three lights", "two", "one", "interpolated", "rejected"])
    classes.set_title("what is known of a pixel")
    _image(normals, normal_map(found.normals), "normals: x red, y green, z blue")
    _scale(sigma, np.where(inside, np.degrees(found.uncertainty), np.nan), "1 sigma of the normals, degrees")
    _scale(height, found.depth, "depth toward the camera")
    return figure


def relief(found: Relief) -> Figure:
    """The picture, what is plane and contact, the normals and how sure they are."""
    figure, (photo, classes, normals, sigma) = _panels(4, found.picture.shape)
    _image(photo, found.picture.rgb(), "picture")
    _image(classes, found.classes, "contact, skirt, plane")
    _image(normals, normal_map(found.normals()), "normals: x red, y green, z blue")
    _scale(sigma, np.degrees(found.uncertainty()), "1 sigma of the normals, degrees")
    return figure


def paint(found: Paint) -> Figure:
    """The picture, its paint, and the picture without it."""
    figure, (photo, albedo, even) = _panels(3, found.picture.shape)
    _image(photo, found.picture.rgb(), "picture")
    known = found.albedo()
    _scale(albedo, known, "albedo over its median")
    pixels = np.nan_to_num(found.divide(known))
    _image(even, np.clip(pixels / max(float(np.percentile(pixels, 99.5)), 1e-30), 0, 1), "without the paint")
    return figure


def segmentation(found: Segmentation) -> Figure:
    """The labels in colors."""
    figure, (labels,) = _panels(1, found.labels.shape)
    labels.imshow(np.ma.masked_equal(found.labels, 0), cmap="tab20", vmin=1, vmax=20, interpolation="nearest")
    labels.set_title(f"{len(found.regions)} regions")
    return figure


def rendering(found: Rendering) -> Figure:
    """The picture and its normals."""
    figure, (photo, normals) = _panels(2, found.normals.shape[:2])
    top = max(float(found.pixels.max()), 1e-30)
    _image(photo, np.clip(found.pixels.astype(np.float64) / top, 0, 1), "rendered")
    _image(normals, normal_map(found.normals), "normals: x red, y green, z blue")
    return figure


def _panels(count: int, shape: tuple[int, ...]) -> tuple[Figure, list[Axes]]:
    import matplotlib.pyplot as plt

    columns = 2 if count == 4 else count
    rows = count // columns
    width = 4.5
    figure, axes = plt.subplots(
        rows, columns, figsize=(width * columns, (width * shape[0] / shape[1] + 0.4) * rows), squeeze=False, layout="constrained"
    )
    panels = list(axes.ravel())
    for panel in panels:
        panel.set_axis_off()
    return figure, panels


def _image(panel: Axes, values: npt.NDArray[Any], title: str) -> None:
    panel.imshow(values, cmap="gray")
    panel.set_title(title)


def _scale(panel: Axes, values: npt.NDArray[Any], title: str) -> None:
    """Values in colors, from the first to the 99th percentile."""
    finite = values[np.isfinite(values)]
    low, high = np.percentile(finite, (1, 99)) if finite.size else (0.0, 1.0)
    shown = panel.imshow(values, cmap="viridis", vmin=float(low), vmax=float(high))
    panel.figure.colorbar(shown, ax=panel, shrink=0.8)
    panel.set_title(title)
