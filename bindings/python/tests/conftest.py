"""A picture whose normals are known, for all tests."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import orientation_from_color as ofc

LIGHTS = np.array([[-0.45, 0.4, 0.8], [0.5, 0.3, 0.81], [0.05, -0.6, 0.8]])
COLORS = np.array([[1.0, 0.15, 0.1], [0.2, 0.9, 0.1], [0.1, 0.2, 1.0]])


def dome(height: int, width: int) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.bool_]]:
    """The depth of an ellipsoid that closes within the picture, and where it is."""
    y, x = np.mgrid[0:height, 0:width]
    u, v = (x - (width - 1) / 2) / (0.46 * width), (y - (height - 1) / 2) / (0.46 * height)
    square = u * u + v * v
    return (0.35 * width * np.sqrt(np.maximum(1 - square, 0))).astype(np.float32), square < 0.9


def angles(found: npt.NDArray[np.float32], true: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
    """The angles in degrees between normals, where both are there."""
    both = (found != 0).any(axis=-1) & (true != 0).any(axis=-1) & np.isfinite(found).all(axis=-1)
    cosines = np.sum(found[both].astype(np.float64) * true[both], axis=-1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosines, -1, 1))))


@pytest.fixture(scope="session")
def scene() -> ofc.Rendering:
    """A dome of 120 x 90 pixels under three lights, with noise."""
    depth, mask = dome(90, 120)
    directions = LIGHTS / np.linalg.norm(LIGHTS, axis=1, keepdims=True)
    return ofc.render(depth, directions, COLORS, mask, params=ofc.RenderParams(noise=0.5, peak=240))
