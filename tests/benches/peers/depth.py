"""Depth from normals against what Python users reach for: time, error, and distance from the exact least-squares solution.

SciPy's DCT          divergence and scipy.fft.dctn in float32, natural boundaries; rectangles only, normals included
PyAMG                smoothed aggregation as preconditioner of conjugate gradients, float64, relative residual 1e-4, set-up included
conjugate gradients  SciPy's, without preconditioner, to the same residual, at most 400 iterations
"""

from pathlib import Path

import numpy as np
import pyamg
import scipy.fft
from library import Library
from scipy import ndimage, sparse
from scipy.sparse import linalg
from turns import NOTHING, table, turns

SIZE = 1024
POISSON, PAPER, COUPLED = 0, 1, 2


def scene(size: int, kind: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """True depth (zero outside of the mask), noisy normals and mask."""
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
    return np.where(mask, z, 0), normals.astype(np.float32), mask


def slopes(normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """p and q."""
    return -normals[..., 0] / normals[..., 2], -normals[..., 1] / normals[..., 2]


def dct_poisson(normals: np.ndarray) -> np.ndarray:
    """Least squares over the same edges on a rectangle, in float32."""
    p, q = slopes(normals)
    right = np.zeros_like(p)
    rise = (p[:, :-1] + p[:, 1:]) * np.float32(0.5)
    right[:, 1:] += rise
    right[:, :-1] -= rise
    rise = (q[:-1] + q[1:]) * np.float32(0.5)
    right[:-1] += rise
    right[1:] -= rise
    transform = scipy.fft.dctn(right, type=2, norm="ortho", workers=1)
    rows, columns = (2 - 2 * np.cos(np.pi * np.arange(n) / n) for n in right.shape)
    eigenvalues = (rows[:, None] + columns[None, :]).astype(np.float32)
    eigenvalues[0, 0] = 1
    transform /= eigenvalues
    transform[0, 0] = 0
    return scipy.fft.idctn(transform, type=2, norm="ortho", workers=1, overwrite_x=True)


def equations(normals: np.ndarray, mask: np.ndarray) -> tuple[sparse.csr_matrix, np.ndarray]:
    """The normal equations over a mask, float64."""
    p, q = (slope.astype(float) for slope in slopes(normals))
    index = np.cumsum(mask.ravel()).reshape(mask.shape) - 1
    across, along = mask[:, :-1] & mask[:, 1:], mask[:-1] & mask[1:]
    a = np.r_[index[:, :-1][across], index[1:][along]]
    b = np.r_[index[:, 1:][across], index[:-1][along]]
    rise = np.r_[((p[:, :-1] + p[:, 1:]) / 2)[across], ((q[:-1] + q[1:]) / 2)[along]]
    k, one = np.arange(len(a)), np.ones(len(a))
    gradient = sparse.csr_matrix((np.r_[-one, one], (np.r_[k, k], np.r_[a, b])), (len(a), mask.sum()))
    return (gradient.T @ gradient).tocsr(), gradient.T @ rise


def integration(library: Library, normals: np.ndarray, mask: np.ndarray, method: int = POISSON) -> tuple:
    """The call, and the depth that it fills."""
    height, width = mask.shape
    bytes_of_mask = None if mask.all() else mask.astype(np.uint8)
    new = library.ffi.new("ofc_depth_input *")
    new.normals, new.normals_stride_bytes, new.width, new.height = library.pointer(normals), normals.strides[0], width, height
    new.mask, new.mask_stride_bytes = library.pointer(bytes_of_mask, "uint8_t *"), width
    params = library.params("depth")
    params.method = method
    need = library.c.ofc_depth_workspace_size(width, height)
    workspace, depth, result = library.workspace(need), np.zeros(mask.shape, np.float32), library.ffi.new("ofc_depth_result *")

    def run(kept: object = bytes_of_mask) -> None:
        del kept
        library.check(
            library.c.ofc_depth_integrate(new, params, library.pointer(workspace, "void *"), need, library.pointer(depth),
                                          depth.strides[0], result)
        )  # fmt: skip

    run()
    return run, depth


def compare(ours: list[Library], repeats: int, kind: str) -> list[tuple]:
    """The rows of one scene."""
    truth, normals, mask = scene(SIZE, kind)
    labels, _ = ndimage.label(mask)
    matrix, right = equations(normals, mask)

    def centered(depth: np.ndarray) -> np.ndarray:
        values, inside = depth.astype(float)[mask], labels[mask]
        return values - (np.bincount(inside, values) / np.maximum(np.bincount(inside), 1))[inside]

    def spread(values: np.ndarray) -> np.ndarray:
        depth = np.zeros(mask.shape)
        depth[mask] = values
        return depth

    depths = {}
    runs = {}
    for library in ours:
        runs[library.name], depths[library.name] = integration(library, normals, mask)
    if kind == "rectangle":
        runs["SciPy DCT"] = lambda: depths.update({"SciPy DCT": dct_poisson(normals)})
    best = turns(runs, 3 * repeats)

    def amg() -> None:
        solver = pyamg.smoothed_aggregation_solver(matrix)
        depths["PyAMG"] = spread(solver.solve(right, tol=1e-4, accel="cg"))

    def plain() -> None:
        depths["conjugate gradients"] = spread(linalg.cg(matrix, right, rtol=1e-4, maxiter=400)[0])

    best.update(turns({"PyAMG": amg, "conjugate gradients": plain}, 2))
    # Close enough to exact to tell the others apart.
    exact = centered(spread(pyamg.ruge_stuben_solver(matrix).solve(right, tol=1e-10, accel="cg", maxiter=100)))

    def rms(values: np.ndarray) -> str:
        return f"{np.sqrt(np.mean(values**2)):.4f}"

    true = centered(truth)
    peer = best["SciPy DCT" if kind == "rectangle" else "PyAMG"]
    rows = [
        (f"{kind}, {name}", f"{time:.1f}", f"{peer / time:.2f}", rms(centered(depths[name]) - true), rms(centered(depths[name]) - exact))
        for name, time in best.items()
    ]
    return [*rows, (f"{kind}, exact", NOTHING, NOTHING, rms(exact - true), NOTHING)]


def report(ours: list[Library], repeats: int, directory: Path) -> None:
    """Three scenes; then how time grows, and the other methods."""
    del directory
    rows = [row for kind in ("rectangle", "disc", "necks, holes") for row in compare(ours, repeats, kind)]
    head = ("", "ms", "times as fast as SciPy or PyAMG", "RMSE", "to exact")
    table(f"Depth of {SIZE} x {SIZE} normals with noise 0.01, in pixels", head, rows)
    rows = []
    for size in (256, 512, 1024, 2048, 3000):
        for kind in ("rectangle", "disc"):
            _, normals, mask = scene(size, kind)
            best = turns({library.name: integration(library, normals, mask)[0] for library in ours}, repeats)
            rows.append((f"{kind} {size} x {size}", *(f"{time * 1e6 / mask.sum():.1f}" for time in best.values())))
    _, normals, mask = scene(SIZE, "disc")
    for name, method in (("the paper's method", PAPER), ("the coupled model", COUPLED)):
        best = turns({library.name: integration(library, normals, mask, method)[0] for library in ours}, 2)
        rows.append((f"disc {SIZE} x {SIZE}, {name}", *(f"{time * 1e6 / mask.sum():.1f}" for time in best.values())))
    table("Depth, nanoseconds a pixel of the mask", ("", *(library.name for library in ours)), rows)
