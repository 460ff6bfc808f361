"""python -m orientation_from_color."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
from PIL import ExifTags, Image, ImageCms

import orientation_from_color as ofc
from orientation_from_color.files import read_mask, read_picture


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "orientation_from_color", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def test_a_photograph_becomes_files(scene: ofc.Rendering, tmp_path: Path) -> None:
    photo, mask, out = tmp_path / "photo.png", tmp_path / "mask.png", tmp_path / "results"
    cv2.imwrite(str(photo), np.ascontiguousarray(scene.pixels[..., ::-1], np.uint8))
    cv2.imwrite(str(mask), np.where(scene.normals[..., 2] > 0, 255, 0).astype(np.uint8))
    done = run(photo, "--mask", mask, "--out", out, "--pixel-pitch", "0.1", "--lit-only")
    assert done.returncode == 0, done.stderr
    assert "trust" in done.stdout
    assert "120 x 90" in done.stdout
    normals = cv2.imread(str(out / "normals.tiff"), cv2.IMREAD_UNCHANGED)
    assert normals is not None
    expected = ofc.solve(scene.pixels, scene.normals[..., 2] > 0).normals()
    assert (normals[..., ::-1] == expected).all()
    for name in ("normals.png", "uncertainty.tiff", "depth.tiff", "overview.png"):
        assert cv2.imread(str(out / name), cv2.IMREAD_UNCHANGED) is not None, name
    assert json.loads((out / "report.json").read_text())["median_uncertainty_deg"] > 0
    assert run(photo, "--mask", mask, "--out", out, "--pixel-pitch", "0.1").returncode == 0
    depth = cv2.imread(str(out / "depth.tiff"), cv2.IMREAD_UNCHANGED)
    inside = scene.normals[..., 2] > 0
    assert depth is not None
    assert np.isfinite(depth[inside]).all()
    whole = ofc.solve(scene.pixels, inside).complete(params=ofc.SurfaceParams(pixel_pitch=0.1))
    assert (depth[inside] == whole.depth[inside]).all()
    assert run(tmp_path / "no.png", "--out", out).returncode == 2
    assert not out.exists() or not list(out.iterdir()), "what an earlier run left"


def test_files_are_read_as_they_were_meant(scene: ofc.Rendering, tmp_path: Path) -> None:
    upright = np.ascontiguousarray(scene.pixels, np.uint8)
    inside = scene.normals[..., 2] > 0
    exif = Image.Exif()
    exif[ExifTags.Base.Orientation] = 6
    photo = tmp_path / "photo.png"
    Image.fromarray(np.ascontiguousarray(np.rot90(upright))).save(photo, exif=exif)
    picture = read_picture(str(photo))
    assert (picture.pixels[..., ::-1] == upright).all()
    Image.fromarray(np.dstack([upright, np.where(inside, 255, 0).astype(np.uint8)])).save(photo)
    alpha = read_picture(str(photo)).mask
    assert alpha is not None
    assert (alpha == inside).all()
    stored = np.rint(
        255 * np.where(upright / 255 <= 0.0031308, 12.92 * upright / 255, 1.055 * (upright / 255) ** (1 / 2.4) - 0.055)
    )
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    Image.fromarray(stored.astype(np.uint8)).save(photo, icc_profile=profile)
    out = tmp_path / "out"
    for options, words in (
        ((), "--transfer srgb undoes"),
        (("--transfer", "linear"), ""),
        (("--transfer", "file"), ""),
        (("--transfer", "srgb"), ""),
    ):
        done = run(photo, "--out", out, *options)
        assert done.returncode == 0, done.stderr
        assert ("doubt" in done.stdout) == bool(words)
        assert words in done.stdout
    for wrong in "gamma", "gamma:0", "gamma:nan", "rec709":
        assert run(photo, "--out", out, "--transfer", wrong).returncode == 2
    mask = tmp_path / "mask.png"
    cv2.imwrite(str(mask), inside.astype(np.uint16))
    assert (read_mask(str(mask)) == inside).all()
    for suffix in "png", "jpg":
        whole, cut = tmp_path / f"whole.{suffix}", tmp_path / f"cut.{suffix}"
        Image.fromarray(upright).save(whole)
        cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
        done = run(cut, "--out", out)
        assert done.returncode == 2
        assert "cut" in done.stderr
        assert not out.exists() or not list(out.iterdir())


def test_files_of_others_stay(scene: ofc.Rendering, tmp_path: Path) -> None:
    photo, out = tmp_path / "photo.png", tmp_path / "out"
    cv2.imwrite(str(photo), np.ascontiguousarray(scene.pixels[..., ::-1], np.uint8))
    out.mkdir()
    own = out / "depth.tiff"
    own.write_bytes(b"my own")
    done = run(photo, "--out", out)
    assert done.returncode == 1
    assert "depth.tiff is there" in done.stderr
    assert own.read_bytes() == b"my own"
    assert list(out.iterdir()) == [own]


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
