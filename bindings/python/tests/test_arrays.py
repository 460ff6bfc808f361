"""Arrays as NumPy has them: what C can read is read in place, other arrays give the same bits, and nonsense is a ValueError."""

from __future__ import annotations

import threading
import time
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import orientation_from_color as ofc
from orientation_from_color._native import ffi


def address(pointer: Any) -> int:
    return int(ffi.cast("uintptr_t", pointer))


def canvas(scene: ofc.Rendering, dtype: npt.DTypeLike = np.uint8) -> npt.NDArray[Any]:
    """The scene in the middle of a larger array."""
    large = np.zeros((110, 150, 3), dtype)
    large[5:95, 7:127] = scene.pixels
    return large


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_packed_rows_are_read_in_place(scene: ofc.Rendering, dtype: npt.DTypeLike) -> None:
    whole = np.ascontiguousarray(scene.pixels, dtype)
    region = canvas(scene, dtype)[5:95, 7:127]
    every_other = whole[::2]
    reversed_channels = whole[..., ::-1]
    whole.flags.writeable = False
    four = np.zeros((90, 120, 4), dtype)
    for array in (whole, region, every_other, four):
        picture = ofc.Picture(array)
        assert address(picture.struct.pixels) == array.ctypes.data
        assert picture.struct.row_stride_bytes == array.strides[0]
    turned = ofc.Picture(reversed_channels)
    assert address(turned.struct.pixels) == whole.ctypes.data
    assert turned.channels == "BGR"


def test_planes_and_masks_are_read_in_place(scene: ofc.Rendering) -> None:
    planes = [np.ascontiguousarray(scene.pixels[..., c]) for c in range(3)]
    mask = np.ones((110, 150), np.bool_)[5:95, 7:127]
    struct = ofc.Picture(planes, mask).struct
    assert [address(struct.pixels), address(struct.green_plane), address(struct.blue_plane)] == [p.ctypes.data for p in planes]
    assert address(struct.mask) == mask.ctypes.data
    assert struct.mask_stride_bytes == 150
    assert ofc.Picture(planes, channels="bgr").struct.pixels == struct.blue_plane


def test_no_call_copies_a_picture(scene: ofc.Rendering) -> None:
    large = np.tile(canvas(scene), (6, 6, 1))
    region = large[3:650, 5:890]
    solution = ofc.solve(scene.pixels)
    out = np.empty((*region.shape[:2], 3), np.float32)
    workspace = 8 * out[..., 0].size
    tracemalloc.start()
    solution.normals(region, out=out)
    of_normals = tracemalloc.get_traced_memory()[1]
    tracemalloc.reset_peak()
    before = tracemalloc.get_traced_memory()[0]
    ofc.solve(region)
    of_solve = tracemalloc.get_traced_memory()[1] - before
    tracemalloc.stop()
    assert of_normals < 20_000
    # The workspace, the inliers, and a little for the result: a copy of the picture would be three bytes a pixel more.
    assert workspace + out[..., 0].size <= of_solve < workspace + out[..., 0].size + 100_000


def test_other_threads_run_during_a_call(scene: ofc.Rendering) -> None:
    large = np.tile(canvas(scene), (12, 12, 1))
    woken = 0
    done = threading.Event()

    def count() -> None:
        nonlocal woken
        while not done.wait(0.001):
            woken += 1

    thread = threading.Thread(target=count)
    thread.start()
    time.sleep(0.01)
    before, began = woken, time.perf_counter()
    ofc.solve(large, params=ofc.SolveParams(lmeds=ofc.LmedsParams(subsets=20_000)))
    during, took = woken - before, time.perf_counter() - began
    done.set()
    thread.join()
    assert took > 0.1
    assert during > 10


FORMS: dict[str, Callable[[npt.NDArray[Any]], npt.NDArray[Any]]] = {
    "as it is": lambda a: a,
    "Fortran order": np.asfortranarray,
    "rows upside down in memory": lambda a: np.ascontiguousarray(a[::-1])[::-1],
    "columns reversed in memory": lambda a: np.ascontiguousarray(a[:, ::-1])[:, ::-1],
    "channels reversed in memory": lambda a: np.ascontiguousarray(a[..., ::-1])[..., ::-1],
    "transposed in memory": lambda a: np.ascontiguousarray(a.transpose(1, 0, 2)).transpose(1, 0, 2),
    "every other column": lambda a: np.repeat(a, 2, axis=1)[:, ::2],
    "every other row": lambda a: np.repeat(a, 2, axis=0)[::2],
    "the first three of four channels": lambda a: np.concatenate([a, a[..., :1]], axis=-1)[..., :3],
    "the other byte order": lambda a: a.astype(a.dtype.newbyteorder("S")),
    "an odd address": lambda a: np.frombuffer(bytearray(b"x" + a.tobytes()), np.uint8)[1:].view(a.dtype).reshape(a.shape),
}


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("writeable", [True, False])
def test_every_form_of_an_array_gives_the_same_bits(
    scene: ofc.Rendering, form: str, dtype: npt.DTypeLike, writeable: bool
) -> None:
    plain = np.ascontiguousarray(scene.pixels, dtype)
    mask = (scene.normals != 0).any(axis=-1)
    array = FORMS[form](plain)
    assert (array == plain).all()
    array.flags.writeable = writeable
    expected = ofc.solve(plain, mask)
    for where in (mask, np.asfortranarray(mask), mask.astype(np.int64) * 3, mask[::-1].copy()[::-1]):
        found = ofc.solve(array, where)
        assert bytes(ffi.buffer(found.struct)) == bytes(ffi.buffer(expected.struct))
        assert (found.normals() == expected.normals()).all()


def test_float64_is_float32_and_four_channels_are_three(scene: ofc.Rendering) -> None:
    expected = ofc.solve(scene.pixels.astype(np.float32)).f
    assert (ofc.solve(scene.pixels.astype(np.float64)).f == expected).all()
    four = np.dstack([scene.pixels, np.full((90, 120), 9, np.uint8)])
    assert (ofc.solve(four).f == ofc.solve(scene.pixels).f).all()
    planes = [scene.pixels[..., c] for c in range(3)]
    assert (ofc.solve(planes).f == ofc.solve(scene.pixels).f).all()
    assert (ofc.solve(scene.pixels[..., ::-1].copy(), channels="bgr").f == ofc.solve(scene.pixels).f).all()


@settings(max_examples=150, deadline=None)
@given(
    array=hnp.arrays(
        st.one_of(
            hnp.integer_dtypes(endianness="?"), hnp.unsigned_integer_dtypes(endianness="?"), hnp.floating_dtypes(endianness="?"),
            hnp.boolean_dtypes(), hnp.complex_number_dtypes(), hnp.unicode_string_dtypes(max_len=2),
        ),
        hnp.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5),
    )
)  # fmt: skip
def test_any_array_is_a_picture_or_a_value_error(array: npt.NDArray[Any]) -> None:
    fits = array.ndim == 3 and array.shape[2] in (3, 4) and 0 not in array.shape
    fits = fits and array.dtype.newbyteorder("=").name in ("uint8", "uint16", "float32", "float64")
    if not fits:
        with pytest.raises(ValueError, match=r"picture|pixels"):
            ofc.solve(array)
        return
    picture = ofc.Picture(array)
    assert picture.shape == array.shape[:2]
    with pytest.raises(ofc.Refused):  # so few pixels are never enough
        ofc.solve(picture)


@settings(max_examples=100, deadline=None)
@given(
    array=hnp.arrays(np.float32, hnp.array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=6), elements=st.floats(width=32)),
    data=st.data(),
)
def test_depth_of_any_view_is_that_of_its_copy(array: npt.NDArray[np.float32], data: st.DataObject) -> None:
    index = data.draw(hnp.basic_indices(array.shape, allow_newaxis=False, allow_ellipsis=False))
    view = np.asarray(array[index])
    if view.ndim != 2 or 0 in view.shape:
        with pytest.raises(ValueError, match="depth"):
            ofc.depth_normals(view)
        return
    assert np.array_equal(ofc.depth_normals(view), ofc.depth_normals(view.copy()))


@pytest.mark.parametrize(
    ("photo", "mask"),
    [
        (np.zeros((5, 0, 3), np.uint8), None),
        (np.zeros((0, 5, 3), np.uint8), None),
        (np.zeros((5, 5), np.uint8), None),
        (np.zeros((5, 5, 2), np.uint8), None),
        (np.zeros((5, 5, 3), np.int32), None),
        (np.zeros((5, 5, 3), np.uint8), np.ones((5, 4), np.bool_)),
        (np.zeros((5, 5, 3), np.uint8), np.ones((5, 5), np.float32)),
        ([np.zeros((5, 5), np.uint8), np.zeros((5, 5), np.uint8), np.zeros((5, 4), np.uint8)], None),
        ([np.zeros((5, 5), np.uint8), np.zeros((5, 5), np.uint8), np.zeros((5, 5), np.uint16)], None),
        ("photo.png", None),
        (None, None),
    ],
)
def test_what_is_no_picture_is_a_value_error(photo: Any, mask: Any) -> None:
    with pytest.raises(ValueError, match=r"picture|pixels|mask|planes"):
        ofc.solve(photo, mask)


def test_outputs_that_c_cannot_write_are_value_errors(scene: ofc.Rendering) -> None:
    solution = ofc.solve(scene.pixels)
    read_only = np.zeros((90, 120, 3), np.float32)
    read_only.flags.writeable = False
    outs: list[npt.NDArray[Any]] = [
        read_only,
        np.zeros((90, 120, 3), np.float64),
        np.zeros((90, 119, 3), np.float32),
        np.zeros((90, 120, 3), ">f4"),
        np.zeros((120, 90, 3), np.float32).transpose(1, 0, 2),
        np.zeros((90, 120, 3), np.float32)[::-1],
    ]
    for out in outs:
        with pytest.raises(ValueError, match="out"):
            solution.normals(out=out)
    wide = np.full((90, 130, 3), 7, np.float32)
    assert np.shares_memory(solution.normals(out=wide[:, 4:124]), wide)
    assert (wide[:, 4:124] == solution.normals()).all()
    assert (wide[:, :4] == 7).all()
    assert (wide[:, 124:] == 7).all()
