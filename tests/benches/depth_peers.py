#!/usr/bin/env python3
"""Depth from normals: this library against what Python users reach for, in one run on one core.

    tests/benches/depth_peers.py [--size 1024] [--repeats 5] [--venv DIR] [--direct]

Makes a virtual environment (by default target/depth-peers) with numpy, scipy and pyamg, builds the release example
`depth_timer`, and prints for a rectangle, a disc and a disc with necks, holes and islands: the time of every peer, the
error against the true surface, and the distance from the exact least-squares solution. Nothing of it is part of the normal
build. `--direct` adds the sparse factorization (SciPy's SuperLU) as a peer and reference; it is slow above 512.

The peers:
  scipy DCT f32   divergence and scipy.fft.dctn in float32, natural boundaries; rectangles only, normals included. It
                  takes turns with ours, so that both see the same machine
  pyamg SA+CG     smoothed aggregation as preconditioner of conjugate gradients, float64, relative residual 1e-4
  scipy CG        conjugate gradients without preconditioner to the same residual (at most 400 iterations)
"""
import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"
# In favor of the peers, who make new arrays all the time: glibc keeps what they give back (half the time of the cosine
# transform is page faults otherwise).
for variable in ("MALLOC_MMAP_THRESHOLD_", "MALLOC_TRIM_THRESHOLD_"):
    os.environ.setdefault(variable, str(2**30))


def in_environment(directory):
    """Runs this script again inside a virtual environment that has the peers."""
    python = directory / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", directory], check=True)
    missing = subprocess.run([python, "-c", "import numpy, scipy, pyamg"], stderr=subprocess.DEVNULL)
    if missing.returncode:
        subprocess.run([python, "-m", "pip", "install", "-q", "numpy", "scipy", "pyamg"], check=True)
    os.execv(python, [str(python), __file__, *sys.argv[1:], "--inside"])


def scene(np, size, kind):
    """True depth (NaN outside the mask), noisy normals (f32) and mask."""
    rng = np.random.default_rng(1)
    x = np.arange(size) - (size - 1) / 2
    x, y = np.meshgrid(x, -x)
    bell, width, wave = 0.3 * size * np.exp(-(x**2 + y**2) / (2 * (size / 4) ** 2)), size / 4, size / 8
    z = bell + 0.02 * size * np.sin(x / wave) * np.cos(1.3 * y / wave)
    p = -x * bell / width**2 + 0.02 * size / wave * np.cos(x / wave) * np.cos(1.3 * y / wave)
    q = -y * bell / width**2 - 0.026 * size / wave * np.sin(x / wave) * np.sin(1.3 * y / wave)
    normals = np.stack([-p, -q, np.ones_like(p)], -1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals += 0.01 * rng.standard_normal(normals.shape)
    radius = np.hypot(x, y)
    mask = np.ones((size, size), bool) if kind == "rectangle" else radius < 0.48 * size
    if kind == "necks, holes":
        hole = np.hypot(x - 0.2 * size, y - 0.2 * size)
        mask &= ~((abs(y) < 2) & (abs(x) > 1)) & ((hole > 0.1 * size) | (hole < 0.04 * size))
        mask[2, 2] = mask[0, -1] = True
    return np.where(mask, z, np.nan), normals.astype(np.float32), mask


def slopes(normals):
    return -normals[..., 0] / normals[..., 2], -normals[..., 1] / normals[..., 2]


def dct_poisson(np, fft, normals):
    """Least squares over the same edges on a rectangle, in float32."""
    p, q = slopes(normals)
    right = np.zeros_like(p)
    rise = (p[:, :-1] + p[:, 1:]) * np.float32(0.5)
    right[:, 1:] += rise
    right[:, :-1] -= rise
    rise = (q[:-1] + q[1:]) * np.float32(0.5)
    right[:-1] += rise
    right[1:] -= rise
    transform = fft.dctn(right, type=2, norm="ortho", workers=1)
    rows, columns = (2 - 2 * np.cos(np.pi * np.arange(n) / n) for n in right.shape)
    eigenvalues = (rows[:, None] + columns[None, :]).astype(np.float32)
    eigenvalues[0, 0] = 1
    transform /= eigenvalues
    transform[0, 0] = 0
    return fft.idctn(transform, type=2, norm="ortho", workers=1, overwrite_x=True)


def equations(np, sparse, normals, mask):
    """The normal equations over a mask, float64."""
    p, q = (s.astype(float) for s in slopes(normals))
    index = np.cumsum(mask.ravel()).reshape(mask.shape) - 1
    across, along = mask[:, :-1] & mask[:, 1:], mask[:-1] & mask[1:]
    a = np.r_[index[:, :-1][across], index[1:][along]]
    b = np.r_[index[:, 1:][across], index[:-1][along]]
    rise = np.r_[((p[:, :-1] + p[:, 1:]) / 2)[across], ((q[:-1] + q[1:]) / 2)[along]]
    k, one = np.arange(len(a)), np.ones(len(a))
    gradient = sparse.csr_matrix((np.r_[-one, one], (np.r_[k, k], np.r_[a, b])), (len(a), mask.sum()))
    return (gradient.T @ gradient).tocsr(), gradient.T @ rise


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--venv", type=Path, default=ROOT / "target" / "depth-peers")
    parser.add_argument("--direct", action="store_true")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not arguments.inside:
        in_environment(arguments.venv.absolute())

    import numpy as np
    import pyamg
    import scipy.fft
    from scipy import ndimage, sparse
    from scipy.sparse import linalg

    subprocess.run(
        ["cargo", "build", "-q", "--release", "-p", "ofc-tests", "--example", "depth_timer"], cwd=ROOT, check=True
    )
    work = ROOT / "target" / "depth-peers-data"
    work.mkdir(parents=True, exist_ok=True)

    def ours(normals, mask, method="poisson", repeats=arguments.repeats):
        """Depth, and its own words: best and median milliseconds and the result."""
        size = normals.shape[1]
        normals.tofile(work / "normals.f32")
        mask.astype(np.uint8).tofile(work / "mask.u8")
        masked = work / "mask.u8" if not mask.all() else "-"
        program = ROOT / "target" / "release" / "examples" / "depth_timer"
        line = subprocess.run(
            [program, work / "normals.f32", masked, str(size), str(normals.shape[0]), work / "depth.f32", method,
             str(repeats)],
            check=True, capture_output=True, text=True,
        ).stdout.split()
        words = dict(zip(line[::2], line[1::2]))
        depth = np.fromfile(work / "depth.f32", np.float32).reshape(mask.shape)
        return depth, float(words["best"]), float(words["median"]), f"{words['cycles']} cycles, residual {words['residual']}"

    def timed(function, repeats=arguments.repeats):
        times = []
        for _ in range(repeats):
            start = time.perf_counter()
            result = function()
            times.append((time.perf_counter() - start) * 1e3)
        times.sort()
        return result, times[0], times[len(times) // 2]

    size = arguments.size
    print(f"{size} x {size}, normals with noise 0.01, one core; milliseconds, best and median of {arguments.repeats}")
    print(f"{'':14}{'':18}{'best':>9}{'median':>9}  {'RMSE':>10}  {'to exact':>10}")
    for kind in ("rectangle", "disc", "necks, holes"):
        truth, normals, mask = scene(np, size, kind)
        labels, count = ndimage.label(mask)

        def centered(depth):
            values, inside = depth.astype(float)[mask], labels[mask]
            return values - (np.bincount(inside, values) / np.maximum(np.bincount(inside), 1))[inside]

        truth = centered(np.where(mask, truth, 0))
        if kind == "rectangle":
            rounds = [
                (ours(normals, mask, repeats=3), timed(lambda: dct_poisson(np, scipy.fft, normals), 3))
                for _ in range(arguments.repeats)
            ]
            pairs = [[times[1] for times in pair] for pair in rounds]
            our_times, peer_times = (sorted(times) for times in zip(*pairs))
            middle, wins = arguments.repeats // 2, sum(a < b for a, b in pairs)
            (depth, _, _, note), (other, *_) = rounds[0]
            rows = [
                ("ofc", depth, our_times[0], our_times[middle], note),
                ("scipy DCT f32", other, peer_times[0], peer_times[middle], f"{wins} of {len(pairs)} turns to ofc"),
            ]
        else:
            rows = [("ofc", *ours(normals, mask))]
        matrix, right = equations(np, sparse, normals, mask)

        def spread(values):
            depth = np.zeros(mask.shape)
            depth[mask] = values
            return depth

        def amg():
            steps = []
            solver = pyamg.smoothed_aggregation_solver(matrix)
            return spread(solver.solve(right, tol=1e-4, accel="cg", residuals=steps)), len(steps) - 1

        (depth, steps), best, median = timed(amg, 1)
        rows.append(("pyamg SA+CG", depth, best, median, f"{steps} cycles, set-up included"))
        (values, _), best, median = timed(lambda: linalg.cg(matrix, right, rtol=1e-4, maxiter=400), 1)
        rows.append(("scipy CG", spread(values), best, median, ""))
        if arguments.direct:
            inside = labels[mask]
            first = np.unique(inside, return_index=True)[1]
            ground = sparse.csr_matrix((np.ones(count), (first, first)), matrix.shape)

            def factor():
                return linalg.splu((matrix + ground).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0,
                                   options={"SymmetricMode": True}).solve(right)

            values, best, median = timed(factor, 1)
            rows.append(("scipy SuperLU", spread(values), best, median, ""))
            exact = centered(spread(values))
        else:
            # Close enough to exact to tell the others apart.
            solver = pyamg.ruge_stuben_solver(matrix)
            exact = centered(spread(solver.solve(right, tol=1e-10, accel="cg", maxiter=100)))
        rms = lambda values: float(np.sqrt(np.mean(values**2)))
        for name, depth, best, median, note in rows:
            depth = centered(depth)
            print(f"{kind:14}{name:18}{best:9.1f}{median:9.1f}  {rms(depth - truth):10.3e}  {rms(depth - exact):10.3e}  {note}")
        print(f"{kind:14}{'exact':18}{'':18}  {rms(exact - truth):10.3e}", flush=True)

    print("\ncost per pixel by size, nanoseconds (rectangle, disc)")
    for size in (256, 512, 1024, 2048):
        cost = []
        for kind in ("rectangle", "disc"):
            _, normals, mask = scene(np, size, kind)
            cost.append(ours(normals, mask)[1] * 1e6 / mask.sum())
        print(f"{size:6}  {cost[0]:6.1f}  {cost[1]:6.1f}", flush=True)
    print("\nother methods, milliseconds (disc)")
    _, normals, mask = scene(np, arguments.size, "disc")
    for method in ("paper", "coupled"):
        _, best, median, note = ours(normals, mask, method)
        print(f"{method:10}{best:9.1f}{median:9.1f}  {note}")


if __name__ == "__main__":
    main()
