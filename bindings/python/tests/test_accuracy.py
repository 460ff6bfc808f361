"""README's table of real photographs, through Python; without the data (OFC_DATA is their folder) there is nothing to measure."""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

import orientation_from_color as ofc
from conftest import angles

DATA = os.environ.get("OFC_DATA")


@pytest.mark.skipif(DATA is None, reason="OFC_DATA is not set")
@pytest.mark.parametrize(("name", "bound"), [("gelsight_ball_6mm", 4.6), ("gelsight_ball_9mm", 7.3), ("cat_figurine", 4.3)])
def test_photographs_are_as_accurate_as_readme_says(name: str, bound: float) -> None:
    folder = Path(DATA or "") / name
    photo, mask = cv2.imread(str(folder / "rgb.png")), cv2.imread(str(folder / "mask.png"), cv2.IMREAD_GRAYSCALE)
    assert photo is not None
    assert mask is not None
    truth = np.load(folder / "normals.npy")
    seeds = range(5)
    found = [ofc.solve(photo, mask, channels="bgr", params=ofc.SolveParams(lmeds=ofc.LmedsParams(seed=s))) for s in seeds]
    assert np.median([np.median(angles(solution.normals(), truth)) for solution in found]) <= bound
