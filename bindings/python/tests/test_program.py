"""python -m orientation_from_color."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np

import orientation_from_color as ofc


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "orientation_from_color", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def test_a_photograph_becomes_files(scene: ofc.Rendering, tmp_path: Path) -> None:
    photo, mask, out = tmp_path / "photo.png", tmp_path / "mask.png", tmp_path / "results"
    cv2.imwrite(str(photo), np.ascontiguousarray(scene.pixels[..., ::-1], np.uint8))
    cv2.imwrite(str(mask), np.where(scene.normals[..., 2] > 0, 255, 0).astype(np.uint8))
    done = run(photo, "--mask", mask, "--out", out, "--pixel-pitch", "0.1")
    assert done.returncode == 0, done.stderr
    assert "trust" in done.stdout
    normals = cv2.imread(str(out / "normals.tiff"), cv2.IMREAD_UNCHANGED)
    assert normals is not None
    expected = ofc.solve(scene.pixels, scene.normals[..., 2] > 0).normals()
    assert (normals[..., ::-1] == expected).all()
    for name in ("normals.png", "uncertainty.tiff", "depth.tiff", "overview.png"):
        assert cv2.imread(str(out / name), cv2.IMREAD_UNCHANGED) is not None, name
    assert json.loads((out / "report.json").read_text())["median_uncertainty_deg"] > 0


def test_a_refusal_says_why_and_leaves_nothing(tmp_path: Path) -> None:
    photo, out = tmp_path / "flat.png", tmp_path / "out"
    cv2.imwrite(str(photo), np.full((80, 80, 3), 90, np.uint8))
    done = run(photo, "--out", out)
    assert done.returncode == 1
    assert "flat" in done.stderr
    assert "try:" in done.stderr
    assert not out.exists()
    assert run(tmp_path / "no.png").returncode != 0


def test_what_cannot_be_written_is_an_error(scene: ofc.Rendering, tmp_path: Path) -> None:
    photo = tmp_path / "photo.png"
    cv2.imwrite(str(photo), np.ascontiguousarray(scene.pixels[..., ::-1], np.uint8))
    full = tmp_path / "full"
    full.mkdir()
    (full / "depth.tiff").symlink_to("/dev/full")
    in_the_way = tmp_path / "way"
    (in_the_way / "normals.png").mkdir(parents=True)
    for out in (full, in_the_way, photo):
        done = run(photo, "--out", out)
        assert done.returncode == 1, out
        assert "wrote" not in done.stdout
        assert "Traceback" not in done.stderr
    assert "Traceback" not in run(photo, "--out", tmp_path / "out", "--pixel-pitch", "nan").stderr
