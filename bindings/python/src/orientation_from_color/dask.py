"""Many pictures on many machines: a folder or a bucket of pictures becomes a Zarr group, on the workers of a Dask cluster.

::

    from dask.distributed import Client
    from orientation_from_color.dask import solve_all

    with Client() as client:
        for result in solve_all("s3://pictures/*.png", "s3://normals/run.zarr", client):
            print(result["name"], result["outcome"])

A picture that is refused or cannot be read is a result too, and does not stop the rest. What is done stays done: a second call
solves what is lacking. A worker that dies loses its picture to another one.
"""

from __future__ import annotations

import math
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

import cv2
import fsspec
import numpy as np
import zarr
from dask.distributed import as_completed

from .errors import Error, Refused
from .params import SolveParams
from .solution import solve

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dask.distributed import Client

_DONE = "outcome"


def solve_all(
    pictures: str,
    target: str,
    client: Client,
    *,
    masks: str | None = None,
    params: SolveParams = SolveParams(),
    retries: int = 3,
) -> Iterator[dict[str, Any]]:
    """Solves pictures on a cluster, and gives each result as it comes.

    Each picture has a group of its name in `target`: `normals`, `uncertainty` and `inliers`, and attributes as given here.
    A group has the attribute `outcome` once it is whole, and is not made again.

    Args:
        pictures: A pattern that fsspec knows, such as "folder/*.png" or "s3://bucket/*.tiff"; names are unique.
        target: Where the Zarr group is or will be.
        client: The cluster's client.
        masks: A folder with a gray picture of the same name for each picture.
        params: What solve() does.
        retries: How often a picture is tried again whose worker died or could not write.

    Yields:
        `name`, `outcome` ("success", or why not), and for a success `inliers`, `median_uncertainty_deg` and `f`.
    """
    file_system, _, paths = fsspec.get_fs_token_paths(pictures)
    zarr.open_group(target, mode="a")
    sources = [file_system.unstrip_protocol(path) for path in sorted(paths)]
    if len({_name(source) for source in sources}) != len(sources):
        raise ValueError("two pictures have one name")
    futures = client.map(_solve_one, sources, target=target, masks=masks, params=params, retries=retries, pure=False)
    for future in as_completed(futures):
        if future.status == "error":
            yield {"name": "", "outcome": f"failed: {future.exception()}"}
        else:
            yield future.result()


def _name(source: str) -> str:
    return PurePosixPath(source).name


def _solve_one(source: str, *, target: str, masks: str | None, params: SolveParams) -> dict[str, Any]:
    """On a worker: one picture, unless it is done."""
    group = zarr.open_group(target, mode="a").require_group(_name(source))
    if _DONE in group.attrs:
        return {"name": _name(source), **group.attrs.asdict()}
    result: dict[str, Any] = {}
    try:
        photo = _read(source, cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH)
        mask = None if masks is None else _read(f"{masks}/{_name(source)}", cv2.IMREAD_GRAYSCALE)
        solution = solve(photo, mask, channels="bgr", params=params)
        arrays: dict[str, Any] = {"normals": solution.normals(), "inliers": solution.inliers}
        median = math.nan
        try:
            sigma = arrays["uncertainty"] = solution.uncertainty()
            median = math.degrees(float(np.median(sigma[solution.inliers])))
        except Error:  # the direct method knows none
            pass
        for key, array in arrays.items():
            group.create_array(key, data=array, overwrite=True)
        result = {"inliers": solution.inlier_count, "median_uncertainty_deg": median, "f": solution.f.tolist()}
        outcome = "success"
    except Refused as refusal:
        outcome = f"refused: {refusal}"
    except (ValueError, FileNotFoundError) as error:
        outcome = f"no picture: {error}"
    # At last, and at once: a group that a dying worker left half-way has no outcome.
    group.attrs.update({**result, _DONE: outcome})
    return {"name": _name(source), **result, _DONE: outcome}


def _read(source: str, flags: int) -> Any:
    with fsspec.open(source, "rb") as file:
        image = cv2.imdecode(np.frombuffer(file.read(), np.uint8), flags)
    if image is None:
        raise ValueError(f"{source} cannot be decoded")
    return image
