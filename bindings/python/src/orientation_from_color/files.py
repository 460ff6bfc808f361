"""Pictures from files, upright and with what the file says of them; results that are whole or not there."""

from __future__ import annotations

import contextlib
import dataclasses
import io
import json
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
from PIL import ExifTags, Image, ImageCms

from ._arrays import rows

_PROGRAM = "ofc"
_PNG_GAMMA_OF_SRGB = 0.45455


@dataclasses.dataclass(frozen=True)
class FilePicture:
    """A picture from a file.

    Attributes:
        pixels: (height, width, 3), blue first, or (height, width) where the file is gray.
        mask: Where the alpha channel says that something is, (height, width) bool; None where there is none or all is opaque.
        says: How the file says that it stores light: "nothing", "linear", "sRGB" or "a curve".
        source: Where it says so.
        words: Size and samples, for people.
        orientation: How it is stored, 1 to 8 as EXIF has them; the pixels are upright.
        is_jpeg: Whether the file is a JPEG, whose black is not quite black.
    """

    pixels: npt.NDArray[Any]
    mask: npt.NDArray[np.bool_] | None
    says: str
    source: str
    words: str
    orientation: int = 1
    is_jpeg: bool = False


def read_picture(path: str) -> FilePicture:
    """Reads it as the file says that it was meant, or raises OSError where it cannot be read, or is cut or damaged."""
    content = Path(path).read_bytes()
    says, source, orientation, is_jpeg = _facts(path, content)
    decoded = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED) if content else None
    if decoded is None:
        raise OSError(f"cannot read {path} as an image: it is cut or damaged, or of a kind that is not read")
    pixels: npt.NDArray[Any] = np.asarray(decoded)
    is_tiff = content[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
    if orientation > 1 and not is_tiff:  # OpenCV turns what it reads of a TIFF
        pixels = _upright(pixels, orientation)
    words = f"{pixels.shape[1]} x {pixels.shape[0]}, {pixels.dtype}"
    if orientation > 1:
        words += "; turned upright, as its orientation says"
    mask = None
    if pixels.ndim == 3 and pixels.shape[2] == 4:
        full = 1 if pixels.dtype.kind == "f" else np.iinfo(pixels.dtype).max
        opaque = pixels[..., 3] >= full / 2
        if not opaque.any():
            raise OSError(f"{path} is empty: its alpha channel is transparent everywhere")
        if not opaque.all():
            mask = opaque
            words += "; its alpha channel is the mask where no other is given"
        pixels = np.ascontiguousarray(pixels[..., :3])
    return FilePicture(rows(pixels), mask, says, source, words, orientation, is_jpeg)


def read_mask(path: str, of: FilePicture | None = None) -> npt.NDArray[np.bool_]:
    """A mask of any depth and color: what is not zero is inside, or of a JPEG what is half as bright as its brightest.

    One that was drawn on the picture `of` as its file stores it is turned as the picture was.
    """
    picture = read_picture(path)
    values = picture.pixels if picture.pixels.ndim == 2 else picture.pixels.max(axis=2)
    half = max(1.0, 0.5 * float(values.max()))
    inside = values >= half if picture.is_jpeg else values != 0
    if picture.mask is not None:
        inside = picture.mask if not inside.any() else inside & picture.mask
    if of is not None and of.orientation >= 5 and picture.orientation == 1:
        size = of.pixels.shape[:2]
        if inside.shape != size and inside.shape[::-1] == size:
            inside = _upright(inside, of.orientation)
    if not inside.any():
        raise OSError(f"the mask {path} is empty: all its pixels are zero")
    return np.asarray(inside, np.bool_)


@contextlib.contextmanager
def _as_large_as_opencv_reads() -> Iterator[None]:
    """Pillow takes pictures above 89 megapixels for an attack, and cameras make them."""
    before = Image.MAX_IMAGE_PIXELS
    Image.MAX_IMAGE_PIXELS = 1 << 30
    try:
        yield
    finally:
        Image.MAX_IMAGE_PIXELS = before


def _facts(path: str, content: bytes) -> tuple[str, str, int, bool]:
    """What Pillow finds in the file: how it says that it stores light, where, its orientation, and whether it is a JPEG.

    OSError where it is cut.
    """
    says, source, orientation = "nothing", "", 1
    is_known = is_jpeg = False
    try:
        with _as_large_as_opencv_reads(), Image.open(io.BytesIO(content)) as image:
            is_known = True
            is_jpeg, info = image.format in ("JPEG", "MPO"), dict(image.info)
            exif = image.getexif()
            orientation = int(exif.get(ExifTags.Base.Orientation, 1))
            is_srgb_in_exif = exif.get_ifd(ExifTags.IFD.Exif).get(ExifTags.Base.ColorSpace) == 1
            image.load()  # an OSError where it is cut
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        if is_known and "truncated" in str(error):
            raise OSError(f"{path} is cut or damaged: {error}") from None
        return says, source, orientation if orientation in range(1, 9) else 1, is_jpeg
    if info.get("icc_profile"):
        says, source = _of_profile(info["icc_profile"])
    elif "srgb" in info:
        says, source = "sRGB", "its chunk sRGB"
    elif info.get("gamma"):
        linear = abs(info["gamma"] - 1) < 0.02
        says, source = "linear" if linear else "a curve", "its chunk gAMA"
    elif is_srgb_in_exif:
        says, source = "sRGB", "its EXIF color space"
    if is_jpeg and says == "nothing":
        says, source = "sRGB", "its format, as a JPEG holds sRGB unless it says otherwise"
    return says, source, orientation if orientation in range(1, 9) else 1, is_jpeg


def _of_profile(profile: bytes) -> tuple[str, str]:
    try:
        name = ImageCms.getProfileDescription(ImageCms.ImageCmsProfile(io.BytesIO(profile))).strip()
    except (OSError, ImageCms.PyCMSError):
        return "nothing", ""
    says = "sRGB" if "sRGB" in name else "linear" if "linear" in name.lower() else "a curve"
    return says, f"its ICC profile ({name})"


def _upright(stored: npt.NDArray[Any], orientation: int) -> npt.NDArray[Any]:
    turned = stored.swapaxes(0, 1) if orientation >= 5 else stored
    if orientation in (2, 3, 6, 7):
        turned = turned[:, ::-1]
    if orientation in (3, 4, 7, 8):
        turned = turned[::-1]
    return np.ascontiguousarray(turned)


class Results:
    """The files of a run in a folder, which are all there or none of them.

    report.json names the others as "files", as the C programs have it: those of an earlier run are removed first, and nothing
    else is. Leave it by an exception, and nothing is left of the run; files of an earlier one that it read are left, and named.
    """

    def __init__(self, folder: Path, names: Iterable[str], inputs: Iterable[str | None]) -> None:
        self.folder = folder
        self._names = list(names)
        self._inputs = [Path(path) for path in inputs if path]
        self._spared: list[str] = []
        self._is_new = False

    def __enter__(self) -> Results:
        self._is_new = not self.folder.exists()
        self.folder.mkdir(parents=True, exist_ok=True)
        try:
            old = self._listed()
            for name in [*self._names, "report.json"]:
                if self._is_input(name):
                    raise FileExistsError(f"{self.folder / name} is an input, and the results would overwrite it")
            for name in self._names:
                if os.path.lexists(self.folder / name) and name not in old:
                    raise FileExistsError(f"{self.folder / name} is there, and no result that report.json names: move it")
            self._spared = [name for name in old if self._is_input(name)]
            self._put("report.json", _json({"status": "not finished", "files": [*old, *self._names]}))
            for name in set(old) - set(self._spared):
                (self.folder / name).unlink(missing_ok=True)
        except BaseException:
            if self._is_new:
                self.folder.rmdir()
            raise
        return self

    def __exit__(self, kind: object, value: object, traceback: object) -> None:
        if kind is None:
            return
        for name in self._names:
            (self.folder / name).unlink(missing_ok=True)
        if self._spared:
            self._put("report.json", _json({"status": "not finished", "files": self._spared}))
        else:
            (self.folder / "report.json").unlink(missing_ok=True)
        if self._is_new:
            self.folder.rmdir()

    def write(self, name: str, image: npt.NDArray[np.uint8 | np.float32]) -> None:
        """Writes a picture, whose name says how."""
        done, encoded = cv2.imencode(Path(name).suffix, image)
        if not done:
            raise OSError(f"{self.folder / name} cannot be encoded")
        self._put(name, encoded.tobytes())

    def write_bytes(self, name: str, content: bytes) -> None:
        """Writes what is encoded."""
        self._put(name, content)

    def finish(self, report: dict[str, Any]) -> None:
        """Writes the report, after all other files."""
        files = [*self._spared, *(name for name in self._names if (self.folder / name).exists())]
        self._put("report.json", _json(report | {"files": files}))

    def _put(self, name: str, content: bytes) -> None:
        place = self.folder / name
        aside = place.with_name(f".{place.stem}.part{place.suffix}")
        try:
            with aside.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            aside.replace(place)
        finally:
            aside.unlink(missing_ok=True)

    def _is_input(self, name: str) -> bool:
        place = self.folder / name
        return place.exists() and any(path.exists() and place.samefile(path) for path in self._inputs)

    def _listed(self) -> list[str]:
        report = self.folder / "report.json"
        if not os.path.lexists(report):
            return []
        try:
            found = json.loads(report.read_bytes())
            if found["program"] == _PROGRAM:
                return [name for name in found["files"] if name and Path(name).name == name and name != ".."]
        except (ValueError, KeyError, TypeError):
            pass
        raise FileExistsError(f"{report} is not a report of this program's: move it, or give another folder")


def _json(report: dict[str, Any]) -> bytes:
    return (json.dumps({"program": _PROGRAM} | report, indent=2) + "\n").encode()
