"""Many pictures on a cluster of processes, one of which is killed half-way: every result is there once."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import cv2
import numpy as np
import pytest
import zarr
from dask.distributed import Client, LocalCluster

import orientation_from_color as ofc
from orientation_from_color.dask import solve_all

COUNT = 12


@pytest.fixture
def pictures(scene: ofc.Rendering, tmp_path: Path) -> Path:
    """Pictures that differ in brightness, a flat one and one that is none."""
    pixels = np.asarray(scene.pixels, np.float64)[..., ::-1]
    for i in range(COUNT):
        cv2.imwrite(str(tmp_path / f"{i:02}.png"), (pixels * (1 - 0.02 * i)).astype(np.uint8))
    cv2.imwrite(str(tmp_path / "flat.png"), np.full((80, 80, 3), 90, np.uint8))
    (tmp_path / "none.png").write_text("not a picture")
    return tmp_path


@pytest.mark.filterwarnings("default")  # of a worker that is killed
def test_every_result_is_there_once_though_a_worker_is_killed(pictures: Path) -> None:
    target = str(pictures / "run.zarr")
    results = []
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        workers = list(client.run(os.getpid).values())
        for result in solve_all(str(pictures / "*.png"), target, client):
            results.append(result)
            if len(results) == 3:
                os.kill(workers[0], signal.SIGKILL)
        again = list(solve_all(str(pictures / "*.png"), target, client))
    expected = [*(f"{i:02}.png" for i in range(COUNT)), "flat.png", "none.png"]
    assert sorted(result["name"] for result in results) == expected
    outcomes = {result["name"]: result["outcome"] for result in results}
    assert outcomes["00.png"] == "success"
    assert "flat" in outcomes["flat.png"]
    assert outcomes["none.png"].startswith("no picture")
    assert {result["name"]: result["outcome"] for result in again} == outcomes
    group = zarr.open_group(target, mode="r")
    assert sorted(group.group_keys()) == expected
    photo = cv2.imread(str(pictures / "03.png"))
    assert photo is not None
    solution = ofc.solve(photo, channels="bgr")
    assert (np.asarray(group["03.png/normals"]) == solution.normals()).all()
    assert group["03.png"].attrs["inliers"] == solution.inlier_count
