"""python -m orientation_from_color photo.png: normals, uncertainty and depth of a photograph, and how far to trust them."""

from __future__ import annotations

import argparse
import dataclasses
import io
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import __version__, integrate, linearize, normal_map, solve, solve_relief
from .enums import Convexity, DepthMethod, Status, Transfer
from .errors import Error, Refused
from .flat import flat_field
from .params import DepthParams, LmedsParams, ReliefParams, SolveParams, SurfaceParams
from .relief import Relief
from .solution import Solution
from .surface import Surface

try:
    import cv2

    from .files import FilePicture, Results, read_mask, read_picture
except ImportError:
    sys.exit("files are read by OpenCV and Pillow: pip install 'orientation-from-color[files,plot]'")

if TYPE_CHECKING:
    from .picture import Channels

_NAMES = ("normals.png", "normals.tiff", "uncertainty.tiff", "depth.tiff", "overview.png")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m orientation_from_color", description=__doc__)
    parser.add_argument("image", help="color picture of 8 or 16 bits or floats a channel (PNG, JPEG, TIFF, ...)")
    parser.add_argument(
        "--mask", help="picture of any depth and color, 0 where pixels are to be left out (default: the alpha channel)"
    )
    parser.add_argument(
        "--transfer",
        type=_transfer,
        metavar="CURVE",
        help="how the file stores light, which is undone: linear, srgb, gamma:G, or file for what it says (default: linear)",
    )
    parser.add_argument("--background", help="picture of the same flat surface without the object: for near lights")
    parser.add_argument(
        "--model",
        choices=("auto", "ellipsoid", "relief"),
        default="auto",
        help="relief is for pictures most of which is one flat surface; auto tries it where the first one refuses",
    )
    shape = parser.add_mutually_exclusive_group()
    shape.add_argument("--convex", action="store_true", help="the surface is raised: no doubt about it")
    shape.add_argument("--hollow", action="store_true", help="the surface is hollow: an engraving, a mold, a pit")
    parser.add_argument("--ball-radius", type=float, default=0.0, metavar="PX", help="radius of the one ball that is pressed in")
    parser.add_argument(
        "--integrate",
        choices=[method.name.lower() for method in DepthMethod],
        default="poisson",
        help="how to span pixels without a normal: leave them out, set them flat, or bridge them",
    )
    parser.add_argument(
        "--lit-only",
        action="store_true",
        help="normals and depth of the pixels that see all lights; without it the whole surface in the mask, shadows too",
    )
    parser.add_argument("--pixel-pitch", type=float, default=1.0, metavar="MM", help="width of a pixel on the surface")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random subsets")
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder to write into (default: out)")
    parser.add_argument("--version", action="version", version=__version__)
    return parser


def _transfer(text: str) -> tuple[str, float]:
    """What --transfer says: linear, srgb, file or gamma, with its number."""
    kind, _, number = text.partition(":")
    try:
        gamma = float(number) if kind == "gamma" else 0.0
    except ValueError:
        gamma = math.nan
    if (
        kind not in ("linear", "srgb", "file", "gamma")
        or (number and kind != "gamma")
        or (kind == "gamma" and not 0.1 <= gamma <= 10)
    ):
        raise argparse.ArgumentTypeError(f"{text} is not linear, srgb, file or gamma:G with G from 0.1 to 10")
    return kind, gamma


@dataclasses.dataclass(frozen=True)
class _Light:
    """The light of a picture.

    Attributes:
        pixels: As they are in the file, or floats where a curve was undone.
        order: What is first in them.
        full: The full scale of what was undone; zero where the type of the pixels tells it.
        doubt: What is to be doubted of them.
    """

    pixels: npt.NDArray[Any]
    order: Channels
    full: float
    doubt: str | None

    def without_clipped(self) -> npt.NDArray[Any]:
        """The pixels, NaN where one of the channels is at full scale."""
        if not self.full:
            return self.pixels
        return np.where((self.pixels >= self.full).any(axis=-1, keepdims=True), np.float32(np.nan), self.pixels)


def _as_light(picture: FilePicture, options: argparse.Namespace) -> _Light:
    """The picture's light, as --transfer says."""
    kind, gamma = options.transfer or ("linear", 0.0)
    if kind == "file":
        known = {"linear": "linear", "sRGB": "srgb"}.get(picture.says)
        if known is None:
            raise OSError(f"the file says {picture.says} of how it stores light: give --transfer linear, srgb or gamma:G")
        kind = known
    doubt = None
    if options.transfer is None and picture.says in ("sRGB", "a curve"):
        doubt = (
            f"{picture.source} says that it holds {picture.says}, and it was taken for linear: --transfer srgb undoes sRGB, "
            "--transfer linear rules it out"
        )
    if kind == "linear":
        return _Light(picture.pixels, "bgr", 0.0, doubt)
    # Linear light of 8 or 16 bits in floats keeps its full scale.
    full = float(np.iinfo(picture.pixels.dtype).max) if picture.pixels.dtype.kind == "u" else 0.0
    curve = Transfer.SRGB if kind == "srgb" else Transfer.GAMMA
    return _Light(linearize(picture.pixels, curve, gamma=gamma, channels="bgr"), "rgb", full, doubt)


def _solve(options: argparse.Namespace) -> tuple[Solution | Relief, list[tuple[str, str]]]:
    """What was found, and what is to be said of the file first."""
    file = read_picture(options.image)
    light = _as_light(file, options)
    photo, order, full = light.pixels, light.order, light.full
    said = [("picture", file.words)] + ([("doubt", light.doubt)] if light.doubt else [])
    mask = read_mask(options.mask, file) if options.mask else file.mask
    below = _as_light(read_picture(options.background), options) if options.background else None
    convexity = Convexity.HOLLOW if options.hollow else Convexity.CONVEX if options.convex else Convexity.AUTO
    refusal = None
    if options.model != "relief":
        params = SolveParams(lmeds=LmedsParams(seed=options.seed, saturation=full), convexity=convexity)
        try:
            if below is None:
                return solve(photo, mask, channels=order, params=params), said
            params = SolveParams(lmeds=LmedsParams(seed=options.seed), convexity=convexity)
            divided = flat_field(light.without_clipped(), below.without_clipped(), channels=order)
            return solve(divided.pixels, mask, params=params), said
        except Refused as error:
            if options.model == "ellipsoid":
                raise
            refusal = error
    raised = Convexity.HOLLOW if options.hollow else Convexity.AUTO
    params_of_relief = ReliefParams(saturation=full, seed=options.seed, ball_radius=options.ball_radius, convexity=raised)
    plane = None if below is None else below.pixels
    try:
        return solve_relief(photo, plane, mask, channels=order, params=params_of_relief), said
    except ValueError:
        if refusal is None:
            raise
        raise refusal from None  # what is wrong with the picture, not that it shows no relief either


def main() -> int:
    """Solves one photograph and writes what was found."""
    options = _parser().parse_args()
    try:
        with Results(options.out, _NAMES, (options.image, options.mask, options.background)) as results:
            try:
                found, said = _solve(options)
            except OSError as error:
                raise _UnusableError(str(error)) from None
            _report(found, said, options, results)
        print(f"wrote {options.out.resolve()}", flush=True)
    except Refused as error:
        print(f"refused: {error}", file=sys.stderr)
        return 1
    except _UnusableError as error:
        print(error, file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{options.out}: {error}", file=sys.stderr)
        return 2 if isinstance(error, FileExistsError) else 1  # a file of the caller's is in the way
    except ValueError as error:
        print(f"{options.image}: {error}", file=sys.stderr)
        return 2
    return 0


class _UnusableError(Exception):
    """A file that was given cannot be used."""


def _whole(found: Solution | Relief, options: argparse.Namespace) -> Surface | Error | None:
    """The whole surface, or why there is none; None where it is not wanted."""
    if not isinstance(found, Solution) or options.lit_only or options.integrate != "poisson" or found.picture is None:
        return None
    picture = found.picture
    mask = picture.mask
    if mask is None:
        shown = (picture.rgb().max(axis=2) > 0).astype(np.uint8)
        outlines, _ = cv2.findContours(shown, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        mask = cv2.drawContours(np.zeros_like(shown), outlines, -1, 255, cv2.FILLED).astype(np.uint8)
    pixels = picture.pixels
    order: Channels = "bgr" if picture.channels.startswith("BGR") else "rgb"
    try:
        return found.complete(pixels, mask, channels=order, params=SurfaceParams(pixel_pitch=options.pixel_pitch))
    except Error as error:
        return error


def _report(found: Solution | Relief, said: list[tuple[str, str]], options: argparse.Namespace, results: Results) -> None:
    """Says and writes what was found."""
    surface = _whole(found, options)
    if isinstance(surface, Surface):
        normals, depth = surface.normals, surface.depth
        inside = np.isfinite(depth)
        sigma = np.where(inside, np.degrees(surface.uncertainty), np.nan).astype(np.float32)
        rest = surface.lines()
    else:
        normals = found.normals()
        where = found.inliers if isinstance(found, Solution) else None
        params = DepthParams(pixel_pitch=options.pixel_pitch, method=DepthMethod[options.integrate.upper()])
        integrated = integrate(normals, where, params=params)
        depth = integrated.depth
        sigma = _uncertainty(found, (normals != 0).any(axis=-1) & np.isfinite(normals).all(axis=-1))
        rest = [("1 sigma", f"{_median(sigma):.2f} degrees at half of the normals"), *integrated.lines()]
        if surface is not None:
            why = "the lit pixels do not have the colors of the solution" if surface.status is Status.NOT_SOLVED else str(surface)
            rest.append(("surface", f"only pixels that all lights reach, the whole surface is left out: {why}"))
    lines = [*said, *found.lines(), *rest]
    for label, text in lines:
        print(f"{label:<10} {text}")
    results.write("normals.png", normal_map(normals)[..., ::-1])
    results.write("normals.tiff", np.ascontiguousarray(normals[..., ::-1]))
    results.write("uncertainty.tiff", sigma)
    results.write("depth.tiff", depth)
    try:
        drawn = io.BytesIO()
        (surface if isinstance(surface, Surface) else found).plot().savefig(drawn, format="png", dpi=120)
        results.write_bytes("overview.png", drawn.getvalue())
    except ImportError:
        print("no overview.png: pip install matplotlib")
    results.finish(dict(lines) | {"version": __version__, "median_uncertainty_deg": _number(_median(sigma))})


def _uncertainty(found: Solution | Relief, known: npt.NDArray[np.bool_]) -> npt.NDArray[np.float32]:
    """In degrees, NaN where it is not known: everywhere for a picture that is too small for the joint method."""
    try:
        return np.where(known, np.degrees(found.uncertainty()), np.nan).astype(np.float32)
    except Error:
        return np.full(known.shape, np.nan, np.float32)


def _median(values: npt.NDArray[np.float32]) -> float:
    finite = values[np.isfinite(values)]
    return float(np.median(finite)) if finite.size else math.nan


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


if __name__ == "__main__":
    sys.exit(main())
