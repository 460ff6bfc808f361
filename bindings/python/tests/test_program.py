"""python -m orientation_from_color."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from PIL import ExifTags, Image, ImageCms

import orientation_from_color as ofc
from orientation_from_color import __main__ as program
from orientation_from_color.files import Results, read_mask, read_picture


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
    for wrong in "gamma", "gamma:2x", "gamma:0", "gamma:nan", "rec709":
        done = run(photo, "--out", out, "--transfer", wrong)
        assert done.returncode == 2
        assert "is not linear, srgb, file or gamma:G" in done.stderr
    mask = tmp_path / "mask.png"
    cv2.imwrite(str(mask), inside.astype(np.uint16))
    assert (read_mask(str(mask)) == inside).all()
    jpeg = tmp_path / "mask.jpg"
    for said in {"icc_profile": profile}, {"exif": exif_of_srgb()}, {}:
        Image.fromarray(np.where(inside, 255, 20).astype(np.uint8)).convert("RGB").save(jpeg, quality=98, **said)
        assert np.count_nonzero(read_mask(str(jpeg)) != inside) < 20, said
    for suffix in "png", "jpg":
        whole, cut = tmp_path / f"whole.{suffix}", tmp_path / f"cut.{suffix}"
        Image.fromarray(upright).save(whole)
        cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
        done = run(cut, "--out", out)
        assert done.returncode == 2
        assert "cut" in done.stderr
        assert not out.exists() or not list(out.iterdir())


def exif_of_srgb() -> Image.Exif:
    exif = Image.Exif()
    exif.get_ifd(ExifTags.IFD.Exif)[ExifTags.Base.ColorSpace] = 1
    return exif


def test_a_mask_as_the_picture_is_stored_is_turned_with_it(scene: ofc.Rendering, tmp_path: Path) -> None:
    inside = scene.normals[..., 2] > 0
    inside[:, :40] = False
    stored = np.rot90(np.asarray(scene.pixels, np.uint8))
    exif = Image.Exif()
    exif[ExifTags.Base.Orientation] = 6
    photo, mask = tmp_path / "photo.png", tmp_path / "mask.png"
    Image.fromarray(np.ascontiguousarray(stored)).save(photo, exif=exif)
    picture = read_picture(str(photo))
    assert picture.pixels.shape[:2] == inside.shape
    for drawn in inside, np.rot90(inside):
        cv2.imwrite(str(mask), np.ascontiguousarray(drawn, np.uint8))
        assert (read_mask(str(mask), picture) == inside).all()


def test_a_large_picture_says_what_a_small_one_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    exif = exif_of_srgb()
    exif[ExifTags.Base.Orientation] = 6
    photo = tmp_path / "photo.png"
    Image.fromarray(np.full((30, 40, 3), 90, np.uint8)).save(photo, exif=exif)
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 1000)
    large = read_picture(str(photo))
    assert large.pixels.shape[:2] == (40, 30)
    assert large.says == "sRGB"
    assert Image.MAX_IMAGE_PIXELS == 1000


def test_clipped_pixels_are_left_out_where_a_curve_is_undone(
    scene: ofc.Rendering, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    photo, below = tmp_path / "photo.png", tmp_path / "below.png"
    bright = np.clip(2.5 * scene.pixels[..., ::-1], 0, 255)
    clipped = (np.rint(bright) >= 255).any(axis=-1)
    assert clipped.any()
    cv2.imwrite(str(photo), np.rint(bright).astype(np.uint8))
    plane = np.full(bright.shape, 200, np.uint8)
    plane[:5, :5] = 255
    cv2.imwrite(str(below), plane)
    divided: list[npt.NDArray[np.float32]] = []
    saturations: list[float] = []

    def solve(pixels: npt.NDArray[np.float32], *_: object, **__: object) -> None:
        divided.append(pixels)
        raise ofc.Refused(ofc.Status.DARK)

    def solve_relief(*_: object, params: ofc.ReliefParams, **__: object) -> None:
        saturations.append(params.saturation)
        raise ofc.Refused(ofc.Status.NO_RELIEF)

    monkeypatch.setattr(program, "solve", solve)
    monkeypatch.setattr(program, "solve_relief", solve_relief)
    for transfer in "srgb", "gamma:2.2":
        options = program._parser().parse_args([str(photo), "--transfer", transfer, "--background", str(below)])
        with pytest.raises(ofc.Refused):
            program._solve(options)
        left_out = np.asarray(np.isnan(divided[-1]).any(axis=-1))
        assert left_out[clipped].all()
        assert left_out[:5, :5].all()
        assert not left_out[~clipped & (plane[..., 0] < 255)].any()
        assert saturations[-1] == 255


def test_it_is_said_that_the_whole_surface_is_left_out(scene: ofc.Rendering, tmp_path: Path) -> None:
    photo, out = tmp_path / "photo.png", tmp_path / "out"
    # Three paints that hardly differ: the lit pixels are not those of one ellipsoid.
    paint = np.random.default_rng(1).choice([0.95, 1, 1.05], (*scene.pixels.shape[:2], 1), p=[0.2, 0.6, 0.2])
    cv2.imwrite(str(photo), np.clip(np.rint(scene.pixels[..., ::-1] * paint), 0, 255).astype(np.uint8))
    done = run(photo, "--out", out, "--model", "ellipsoid")
    assert done.returncode == 0, done.stderr
    assert "the whole surface is left out: the lit pixels do not have the colors of the solution" in done.stdout
    assert "left out" in json.loads((out / "report.json").read_text())["surface"]
    done = run(photo, "--out", out, "--model", "ellipsoid", "--lit-only")
    assert "whole surface" not in done.stdout


def test_what_a_failed_run_read_is_not_forgotten(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "inliers.png").write_bytes(b"of an earlier run")
    (out / "depth.tiff").write_bytes(b"of an earlier run")
    names = ["inliers.png", "depth.tiff", "", ".", "..", "../photo.png"]
    (out / "report.json").write_text(json.dumps({"program": "ofc", "files": names}))
    (tmp_path / "photo.png").write_bytes(b"no result")
    with pytest.raises(OSError, match="no such picture"), Results(out, ["depth.tiff"], [str(out / "inliers.png")]):
        raise OSError("no such picture")
    assert sorted(path.name for path in out.iterdir()) == ["inliers.png", "report.json"]
    assert json.loads((out / "report.json").read_text())["files"] == ["inliers.png"]
    assert (tmp_path / "photo.png").exists()
    with Results(out, ["inliers.png"], []) as results:
        results.finish({})
    assert [path.name for path in out.iterdir()] == ["report.json"]


def test_files_of_others_stay(scene: ofc.Rendering, tmp_path: Path) -> None:
    photo, out = tmp_path / "photo.png", tmp_path / "out"
    cv2.imwrite(str(photo), np.ascontiguousarray(scene.pixels[..., ::-1], np.uint8))
    out.mkdir()
    own = out / "depth.tiff"
    own.write_bytes(b"my own")
    done = run(photo, "--out", out)
    assert done.returncode == 2
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
    no_file_may_be_longer = 'ulimit -f 1; exec "$@"'
    limited = ["sh", "-c", no_file_may_be_longer, "sh", sys.executable, "-m", "orientation_from_color", str(photo)]
    disk_full = subprocess.run(
        [*limited, "--out", str(tmp_path / "disk")], capture_output=True, text=True, timeout=120, check=False
    )
    assert not (tmp_path / "disk").exists()
    # What is in the way is the caller's to move.
    done = {1: [disk_full], 2: [run(photo, "--out", out) for out in (full, in_the_way, photo)]}
    for status, runs in done.items():
        for one in runs:
            assert one.returncode == status, one.stderr
            assert "wrote" not in one.stdout
            assert "Traceback" not in one.stderr
    assert "Traceback" not in run(photo, "--out", tmp_path / "out", "--pixel-pitch", "nan").stderr
