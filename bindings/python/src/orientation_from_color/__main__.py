"""python -m orientation_from_color photo.png: normals, uncertainty and depth of a photograph, and how far to trust them."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt

from . import __version__, integrate, normal_map, solve, solve_relief
from .enums import Convexity, DepthMethod
from .errors import Error, Refused
from .flat import flat_field
from .params import DepthParams, LmedsParams, ReliefParams, SolveParams
from .relief import Relief
from .solution import Solution

try:
    import cv2
except ImportError:
    sys.exit("files are read by OpenCV: pip install 'orientation-from-color[files,plot]'")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m orientation_from_color", description=__doc__)
    parser.add_argument("image", help="color picture of 8 or 16 bits a channel, of linear values (PNG, TIFF, ...)")
    parser.add_argument("--mask", help="gray picture, 0 where pixels are to be left out")
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
    parser.add_argument("--pixel-pitch", type=float, default=1.0, metavar="MM", help="width of a pixel on the surface")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random subsets")
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder to write into (default: out)")
    parser.add_argument("--version", action="version", version=__version__)
    return parser


def _read(path: str, flags: int) -> npt.NDArray[np.uint8 | np.uint16 | np.float32]:
    image = cv2.imread(path, flags)
    if image is None:
        raise SystemExit(f"cannot read {path}")
    return np.asarray(image)


def _write(path: Path, image: npt.NDArray[np.uint8 | np.float32]) -> None:
    """Encodes first: what cannot be written whole is an OSError, where imwrite() may say nothing."""
    done, encoded = cv2.imencode(path.suffix, image)
    if not done:
        raise OSError(f"{path} cannot be encoded")
    path.write_bytes(encoded.tobytes())


def _solve(options: argparse.Namespace) -> Solution | Relief:
    photo = _read(options.image, cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH)
    mask = _read(options.mask, cv2.IMREAD_GRAYSCALE) if options.mask else None
    below = _read(options.background, cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH) if options.background else None
    convexity = Convexity.HOLLOW if options.hollow else Convexity.CONVEX if options.convex else Convexity.AUTO
    refusal = None
    if options.model != "relief":
        params = SolveParams(lmeds=LmedsParams(seed=options.seed), convexity=convexity)
        try:
            if below is None:
                return solve(photo, mask, channels="bgr", params=params)
            return solve(flat_field(photo, below, channels="bgr").pixels, mask, params=params)
        except Refused as error:
            if options.model == "ellipsoid":
                raise
            refusal = error
    raised = Convexity.HOLLOW if options.hollow else Convexity.AUTO
    params_of_relief = ReliefParams(seed=options.seed, ball_radius=options.ball_radius, convexity=raised)
    try:
        return solve_relief(photo, below, mask, channels="bgr", params=params_of_relief)
    except ValueError:
        if refusal is None:
            raise
        raise refusal from None  # what is wrong with the picture, not that it shows no relief either


def main() -> int:
    """Solves one photograph and writes what was found."""
    options = _parser().parse_args()
    try:
        found = _solve(options)
    except Refused as error:
        print(f"refused: {error}", file=sys.stderr)
        return 1
    except ValueError as error:
        print(f"{options.image}: {error}", file=sys.stderr)
        return 2
    try:
        _report(found, options)
    except (OSError, ValueError) as error:
        print(f"{options.out}: {error}", file=sys.stderr)
        return 1
    return 0


def _report(found: Solution | Relief, options: argparse.Namespace) -> None:
    """Says and writes what was found."""
    options.out.mkdir(parents=True, exist_ok=True)
    normals = found.normals()
    where = found.inliers if isinstance(found, Solution) else None
    params = DepthParams(pixel_pitch=options.pixel_pitch, method=DepthMethod[options.integrate.upper()])
    depth = integrate(normals, where, params=params)
    known = (normals != 0).any(axis=-1) & np.isfinite(normals).all(axis=-1)
    sigma = _uncertainty(found, known)
    lines = [*found.lines(), ("1 sigma", f"{_median(sigma):.2f} degrees at half of the normals"), *depth.lines()]
    for label, text in lines:
        print(f"{label:<10} {text}")
    _write(options.out / "normals.png", normal_map(normals)[..., ::-1])
    _write(options.out / "normals.tiff", normals[..., ::-1])
    _write(options.out / "uncertainty.tiff", sigma)
    _write(options.out / "depth.tiff", depth.depth)
    report = dict(lines) | {"version": __version__, "median_uncertainty_deg": _number(_median(sigma))}
    (options.out / "report.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    try:
        found.plot().savefig(options.out / "overview.png", dpi=120)
    except ImportError:
        print("no overview.png: pip install matplotlib")
    print(f"wrote {options.out.resolve()}", flush=True)


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
