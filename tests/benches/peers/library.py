"""The library through its C ABI, and the scenes of tests/benches/counts."""

from pathlib import Path
from typing import Any

import cffi
import numpy as np

RGB8, BGRA8, PLANES8, RGB16, RGB32F, PLANES32F = 1, 4, 5, 11, 21, 25


class Library:
    """One build of the library."""

    def __init__(self, name: str, path: str, directory: Path) -> None:
        self.name = name
        self.ffi = cffi.FFI()
        self.ffi.cdef((directory / "scenes.h").read_text())
        self.c = self.ffi.dlopen(str(Path(path).absolute()))
        self.scenes = self.ffi.dlopen(str((directory / "scenes.so").absolute()))

    def check(self, status: int) -> None:
        """Raises what a status says, unless it is OFC_STATUS_OK."""
        if status:
            raise RuntimeError(self.ffi.string(self.c.ofc_status_message(status)).decode())

    def params(self, kind: str) -> Any:
        """Default parameters of a kind: "solve", "lmeds", "depth"."""
        params = self.ffi.new(f"ofc_{kind}_params *")
        self.check(getattr(self.c, f"ofc_{kind}_params_default")(params))
        return params

    def pointer(self, array: np.ndarray | None, kind: str = "float *") -> Any:
        """An array's memory for C."""
        return self.ffi.NULL if array is None else self.ffi.cast(kind, array.ctypes.data)

    def workspace(self, size: int) -> np.ndarray:
        """A workspace whose pages are there."""
        return np.ones(size // 8 + 1)

    def scene(self, name: str, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
        """Pixels (height, width, 3) of 8 bits and mask of a scene."""
        scene = getattr(self.scenes, name)(width, height)
        pixels = np.frombuffer(self.ffi.buffer(self.ffi.cast("uint8_t *", scene.image.pixels), width * height * 3), np.uint8)
        mask = np.frombuffer(self.ffi.buffer(scene.mask, width * height), np.uint8)
        return pixels.reshape(height, width, 3), mask.reshape(height, width)

    def points(self, count: int, share: int) -> np.ndarray:
        """Colors (count, 3), of which a share in percent are outliers."""
        scene = self.scenes.points(count, 1, share)
        buffer = self.ffi.buffer(self.ffi.cast("uint8_t *", scene.image.pixels), count * 12)
        return np.frombuffer(buffer, np.float32).reshape(count, 3)

    def image(self, pixels: np.ndarray, form: int, mask: np.ndarray | None = None) -> Any:
        """The picture (height, width, samples), or (3, height, width) for planes."""
        image = self.ffi.new("ofc_image *")
        planes = pixels if form in (PLANES8, PLANES32F) else None
        image.height, image.width = pixels.shape[:2] if planes is None else pixels.shape[1:]
        image.pixels = self.pointer(pixels, "void *")
        image.row_stride_bytes = pixels.strides[0] if planes is None else pixels.strides[1]
        if planes is not None:
            image.green_plane, image.blue_plane = (self.pointer(plane, "void *") for plane in planes[1:])
        image.format = form
        if mask is not None:
            image.mask, image.mask_stride_bytes = self.pointer(mask, "uint8_t *"), mask.strides[0]
        return image

    def solve(self, image: Any) -> Any:
        """The solution of a picture, and the call that finds it once more."""
        params = self.params("solve")
        need = self.c.ofc_solve_workspace_size(image.width, image.height, params)
        workspace, solution = self.workspace(need), self.ffi.new("ofc_solution *")

        def again() -> None:
            self.check(self.c.ofc_solve(image, params, self.pointer(workspace, "void *"), need, self.ffi.NULL, solution))

        again()
        return solution, again
