"""Unit normals against a fused numba kernel, NumPy and OpenCV, and against storing as much as the output is."""

from pathlib import Path

import cv2
import numba
import numpy as np
from library import BGRA8, PLANES8, PLANES32F, RGB8, RGB16, RGB32F, Library
from turns import NOTHING, table, turns


@numba.njit(fastmath=True)
def interleaved(pixels, first, step, f, out):
    """No test whether a pixel obeys the model: a pixel that is not black has a normal."""
    for i in range(pixels.shape[0]):
        r, g, b = np.float32(pixels[i, first]), np.float32(pixels[i, first + step]), np.float32(pixels[i, first + 2 * step])
        x = f[0, 0] * r + f[0, 1] * g + f[0, 2] * b
        y = f[1, 0] * r + f[1, 1] * g + f[1, 2] * b
        z = f[2, 0] * r + f[2, 1] * g + f[2, 2] * b
        square = x * x + y * y + z * z
        scale = np.float32(1) / np.sqrt(square) if square > 0 else np.float32(0)
        out[i, 0], out[i, 1], out[i, 2] = x * scale, y * scale, z * scale


@numba.njit(fastmath=True)
def masked(pixels, mask, f, out):
    """The same inside of a mask."""
    for i in range(pixels.shape[0]):
        r, g, b = np.float32(pixels[i, 0]), np.float32(pixels[i, 1]), np.float32(pixels[i, 2])
        x = f[0, 0] * r + f[0, 1] * g + f[0, 2] * b
        y = f[1, 0] * r + f[1, 1] * g + f[1, 2] * b
        z = f[2, 0] * r + f[2, 1] * g + f[2, 2] * b
        square = x * x + y * y + z * z
        scale = np.float32(1) / np.sqrt(square) if mask[i] and square > 0 else np.float32(0)
        out[i, 0], out[i, 1], out[i, 2] = x * scale, y * scale, z * scale


@numba.njit(fastmath=True)
def planar(planes, f, out):
    """The same of three planes."""
    for i in range(planes.shape[1]):
        r, g, b = np.float32(planes[0, i]), np.float32(planes[1, i]), np.float32(planes[2, i])
        x = f[0, 0] * r + f[0, 1] * g + f[0, 2] * b
        y = f[1, 0] * r + f[1, 1] * g + f[1, 2] * b
        z = f[2, 0] * r + f[2, 1] * g + f[2, 2] * b
        square = x * x + y * y + z * z
        scale = np.float32(1) / np.sqrt(square) if square > 0 else np.float32(0)
        out[i, 0], out[i, 1], out[i, 2] = x * scale, y * scale, z * scale


@numba.njit
def store(out):
    """What any of them must do."""
    for i in range(out.shape[0]):
        out[i, 0], out[i, 1], out[i, 2] = np.float32(1), np.float32(2), np.float32(3)


def in_numpy(pixels, f):
    """As one writes it first."""
    normals = pixels.reshape(-1, 3).astype(np.float32) @ f.T
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.float32(1e-20))


def in_opencv(pixels, f):
    """By whole pictures."""
    normals = cv2.transform(pixels.astype(np.float32), f)
    x, y, z = cv2.split(normals)
    length = cv2.sqrt(x * x + y * y + z * z)
    return cv2.merge([cv2.divide(plane, length) for plane in (x, y, z)])


def pixels_of(dome: np.ndarray, form: int) -> np.ndarray:
    """The picture in another format."""
    if form == BGRA8:
        return np.ascontiguousarray(np.concatenate([dome[..., ::-1], dome[..., :1]], -1))
    if form in (PLANES8, PLANES32F):
        planes = np.ascontiguousarray(np.moveaxis(dome, -1, 0))
        return planes if form == PLANES8 else planes.astype(np.float32)
    return {RGB8: dome, RGB16: dome.astype(np.uint16) * 257, RGB32F: dome.astype(np.float32)}[form]


def runs(ours: list[Library], pixels: np.ndarray, form: int, mask: np.ndarray | None, out: np.ndarray) -> dict:
    """What takes turns on a picture."""
    height, width = out.shape[:2]
    flat, result = out.reshape(-1, 3), {}
    for library in ours:
        image = library.image(pixels, form, mask)
        solution, _ = library.solve(image)

        def run(library: Library = library, image: object = image, solution: object = solution) -> None:
            library.check(library.c.ofc_normals_compute(image, solution, library.pointer(out), out.strides[0]))

        result[library.name] = run
    f = np.array(list(solution.orientation.f_inverse), np.float32).reshape(3, 3)
    if mask is not None:
        result["numba"] = lambda: masked(pixels.reshape(-1, 3), mask.reshape(-1), f, flat)
    elif form in (PLANES8, PLANES32F):
        result["numba"] = lambda: planar(pixels.reshape(3, -1), f, flat)
    else:
        first, step = (2, -1) if form == BGRA8 else (0, 1)
        result["numba"] = lambda: interleaved(pixels.reshape(width * height, -1), first, step, f, flat)
    result["store"] = lambda: store(flat)
    if form == RGB8 and mask is None:
        result["NumPy"] = lambda: in_numpy(pixels, f)
        result["OpenCV"] = lambda: in_opencv(pixels, f)
    return result


def report(ours: list[Library], repeats: int, directory: Path) -> None:
    """A row for each picture."""
    del directory
    names = [*(library.name for library in ours), "numba", "store", "NumPy", "OpenCV"]
    forms = {
        "u8": RGB8, "u8 with mask": RGB8, "u8, four samples": BGRA8, "u8 planes": PLANES8, "u16": RGB16, "float": RGB32F,
        "float planes": PLANES32F,
    }  # fmt: skip
    rows = []
    for width, height in ((1280, 800), (4000, 3000)):
        dome, inside = ours[0].scene("dome", width, height)
        out = np.ones((height, width, 3), np.float32)
        for name, form in forms.items():
            mask = inside if "mask" in name else None
            contenders = runs(ours, pixels_of(dome, form), form, mask, out)
            for run in contenders.values():
                run()
            best = turns(contenders, repeats)
            cells = [f"{best[who] * 1e6 / (width * height):.2f}" if who in best else NOTHING for who in names]
            rows.append((f"{width} x {height}, {name}", *cells))
    table("Unit normals of a dome, nanoseconds a pixel; numba has no test whether a pixel obeys the model", ("", *names), rows)
