"""A rig: many frames of one tactile sensor, which add up, with or without balls of known radius."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import output, plane, row_stride
from ._native import ffi, lib
from .enums import NoRelief, RigAdvice, Scale, Status
from .errors import Error, Refused
from .params import ReliefParams
from .picture import Channels, Photo, Picture, picture_of
from .relief import struct_of
from .report import Report

if TYPE_CHECKING:
    from collections.abc import Sequence

_ADVICE = {
    RigAdvice.NONE: "",
    RigAdvice.CONTACTS: "add contacts, of things that are round rather than long",
    RigAdvice.SCALE: "add a ball of known radius, or set the scale",
    RigAdvice.REGION: "add contacts where the frame has none",
}


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class RigModel(Report):
    """A solved rig; ofc_rig_model in ofc.h says how to read the numbers."""

    slopes: Annotated[_abi.Floats, (2, 54)]
    plane: Annotated[_abi.Floats, (3, 15)]
    noise: _abi.Vector3
    circulation: float
    circulation_ratio: float
    outward: float
    scale_deviation: float
    disagreement: float
    tilt: float
    expected_error: float
    saturation: float
    terms: int
    scale_source: Scale
    advice: RigAdvice
    region: int
    frames: int
    balls: int
    width: int
    height: int
    struct: Any

    _not_in_c = ("struct",)

    def to_bytes(self) -> bytes:
        """The model as bytes, the same on every machine, with a checksum: what from_bytes() and `ofc_live --model` read."""
        saved = ffi.new("uint8_t[]", lib.OFC_RIG_MODEL_BYTES)
        _abi.check(lib.ofc_rig_model_save(self.struct, saved, lib.OFC_RIG_MODEL_BYTES))
        return bytes(ffi.buffer(saved))

    @classmethod
    def from_bytes(cls, saved: bytes) -> RigModel:
        """The model that to_bytes() or `ofc_live --save-model` wrote; Error where the bytes are none, or damaged."""
        struct = ffi.new("ofc_rig_model *")
        _abi.check(lib.ofc_rig_model_load(ffi.from_buffer("uint8_t[]", saved), len(saved), struct))
        return _abi.read(cls, struct, struct=struct)

    def classify(self, photo: Photo, background: Photo | None = None, *, channels: Channels = "rgb") -> npt.NDArray[np.uint8]:
        """What each pixel of a frame is part of, (height, width) uint8: a ReliefClass."""
        picture, below = _frame(photo, background, channels)
        need = lib.ofc_relief_workspace_size(picture.width, picture.height)
        memory, classes = _abi.workspace(need), np.zeros(picture.shape, np.uint8)
        address = _abi.pointer("void *", memory)
        into = _abi.pointer("uint8_t *", classes)
        _abi.check(lib.ofc_rig_classify(self.struct, picture.struct, struct_of(below), address, need, into))
        return classes

    def normals(
        self,
        photo: Photo,
        background: Photo | None = None,
        *,
        classes: npt.NDArray[np.uint8] | None = None,
        channels: Channels = "rgb",
        out: npt.NDArray[np.float32] | None = None,
        uncertainty: npt.NDArray[np.float32] | None = None,
    ) -> npt.NDArray[np.float32]:
        """Unit normals of a frame, (height, width, 3) float32: (0, 0, 1) on the plane, NaN where there is no usable color.

        Where `uncertainty` is an array of (height, width) float32, it becomes the standard deviation of the angle in radians.
        """
        picture, below = _frame(photo, background, channels)
        known = self.classify(picture, below) if classes is None else np.ascontiguousarray(classes, np.uint8)
        if known.shape != picture.shape:
            raise ValueError(f"classes: (height, width) of the frame, not {known.shape}")
        out = output(out, (*picture.shape, 3))
        sigma = None if uncertainty is None else output(uncertainty, picture.shape)
        _abi.check(
            lib.ofc_rig_normals(
                self.struct,
                picture.struct,
                struct_of(below),
                _abi.pointer("uint8_t *", known),
                _abi.pointer("float *", out),
                row_stride(out),
                _abi.pointer("float *", sigma),
                0 if sigma is None else row_stride(sigma),
            )
        )
        return out

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        made_of = f"{self.frames} frames, {self.balls} balls"
        off = f"normals in a contact are expected to be off by {math.degrees(self.expected_error):.1f} degrees"
        scale = f"{self.scale_source.name.lower()}, known within {100 * self.scale_deviation:.0f} %"
        lines = [("rig", made_of), ("trust", off), ("scale", scale)]
        return lines if self.advice is RigAdvice.NONE else [*lines, ("try", _ADVICE[self.advice])]


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class RigContact(Report):
    """What is pressed in.

    Places are in pixels from the middle of the top left one, y downward; lengths in the unit of the pixel size.
    """

    area: float
    center: Annotated[_abi.Floats, (2,)]
    peak: float
    volume: float
    peak_place: Annotated[npt.NDArray[np.int32], (2,)]
    bounds: Annotated[npt.NDArray[np.int32], (4,)]

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        x, y = self.center
        return [("contact", f"{self.area:.4g} large, {self.peak:.3g} high, about {x:.1f}, {y:.1f}")]


def measure_contact(
    classes: npt.NDArray[np.uint8],
    depth: npt.ArrayLike,
    *,
    pixel_size: float = 1,
    mask: npt.NDArray[np.uint8] | None = None,
) -> RigContact | None:
    """What is pressed in, or None where there is no contact.

    Args:
        classes: What RigModel.classify() gave.
        depth: Depth in pixels of the whole frame, from integrate().
        pixel_size: The length of a pixel on the gel.
        mask: Where it is (height, width) uint8 it becomes 255 in the contact, and 0 elsewhere.
    """
    known = np.ascontiguousarray(classes, np.uint8)
    height, width = known.shape
    heights, found = plane(depth, (height, width), "depth"), ffi.new("ofc_rig_contact *")
    if mask is not None and (mask.shape != known.shape or mask.dtype != np.uint8 or not mask.flags.c_contiguous):
        raise ValueError(f"mask: contiguous uint8 of shape {known.shape}")
    status = lib.ofc_rig_contact_measure(
        _abi.pointer("uint8_t *", known),
        width,
        height,
        _abi.pointer("float *", heights),
        row_stride(heights),
        pixel_size,
        _abi.pointer("uint8_t *", mask),
        found,
    )
    if status == Status.NO_RELIEF:
        return None
    _abi.check(status)
    return _abi.read(RigContact, found)


def follow_background(
    background: npt.NDArray[np.float32],
    photo: Photo,
    classes: npt.NDArray[np.uint8] | None = None,
    *,
    rate: float = 0.03,
    saturation: float = 0,
    channels: Channels = "rgb",
) -> None:
    """Moves a background, (height, width, 3) float32 red, green, blue, by a share toward a frame where the frame is untouched.

    Begin with NaN: what is not known yet takes the frame's color.

    Args:
        background: Changed in place.
        photo: The frame.
        classes: What RigModel.classify() gave; None where nothing is pressed in.
        rate: The share, above 0 and up to 1.
        saturation: As in ReliefParams.
        channels: Those of the photo, "rgb" or "bgr".
    """
    picture = picture_of(photo, None, channels)
    known = None if classes is None else np.ascontiguousarray(classes, np.uint8)
    if known is not None and known.shape != picture.shape:
        raise ValueError(f"classes: (height, width) of the frame, not {known.shape}")
    into = output(background, (*picture.shape, 3))
    of = _abi.pointer("uint8_t *", known)
    _abi.check(
        lib.ofc_rig_background_follow(picture.struct, of, saturation, rate, _abi.pointer("float *", into), row_stride(into))
    )


class Rig:
    """Sums over the frames of one camera, lights and surface. It keeps no frame.

    Args:
        width, height: The size of the frames.
    """

    def __init__(self, width: int, height: int) -> None:
        self._rig, self._balls = ffi.new("ofc_rig *"), ffi.new("ofc_rig_balls *")
        _abi.check(lib.ofc_rig_init(width, height, self._rig, self._balls))

    @property
    def frames(self) -> int:
        """How many frames with a contact were added."""
        return int(self._rig.frames)

    @property
    def balls(self) -> int:
        """How many balls were added."""
        return int(self._balls.count)

    def add(
        self,
        photo: Photo,
        background: Photo | None = None,
        *,
        center: Sequence[float] | None = None,
        channels: Channels = "rgb",
        params: ReliefParams = ReliefParams(),
    ) -> NoRelief:
        """Adds a frame, and where `params` has a ball's radius in pixels also the ball.

        Args:
            photo: The frame.
            background: A frame without a contact.
            center: Where the ball's center is: x and y in pixels, y downward, from the middle of the top left pixel.
            channels: "rgb" or "bgr".
            params: Saturation, seed and ball_radius.

        Returns:
            NONE where the frame added something; otherwise why it did not, which is no error.
        """
        picture, below = _frame(photo, background, channels)
        given = _abi.params("ofc_relief_params", lib.ofc_relief_params_default, params)
        need = lib.ofc_relief_workspace_size(picture.width, picture.height)
        memory, why = _abi.workspace(need), ffi.new("ofc_no_relief *")
        middle = ffi.NULL if center is None else ffi.new("double[2]", list(center))
        balls = self._balls if params.ball_radius > 0 else ffi.NULL
        address = _abi.pointer("void *", memory)
        status = lib.ofc_rig_add(self._rig, balls, picture.struct, struct_of(below), given, middle, address, need, ffi.NULL, why)
        if status != Status.NO_RELIEF:
            _abi.check(status)
        return NoRelief(why[0])

    def merge(self, other: Rig) -> None:
        """Adds the frames and the balls of another rig of the same sensor."""
        _abi.check(lib.ofc_rig_merge(self._rig, self._balls, other._rig, other._balls))

    def set_scale(self, model: RigModel, factor: float, deviation: float) -> None:
        """Sets the scale: `factor` is a true height over the one that `model` gave, `deviation` that of its logarithm."""
        _abi.check(lib.ofc_rig_set_scale(self._rig, model.struct, factor, deviation))

    def solve(self, *, params: ReliefParams = ReliefParams()) -> RigModel:
        """Solves the rig. Where nothing says its scale, `scale_source` is UNKNOWN and a usual one stands in.

        Raises:
            Refused: No frame was added, they contradict each other, or more contacts are needed.
        """
        given = _abi.params("ofc_relief_params", lib.ofc_relief_params_default, params)
        struct = ffi.new("ofc_rig_model *")
        balls = self._balls if self.balls else ffi.NULL
        status = Status(lib.ofc_rig_solve(self._rig, balls, given, struct))
        if status < 0:
            raise Error(status)
        if status not in (Status.OK, Status.SCALE_UNKNOWN):
            raise Refused(status, details="add more contacts")
        return _abi.read(RigModel, struct, struct=struct)

    def __getstate__(self) -> tuple[bytes, bytes]:
        return bytes(ffi.buffer(self._rig)), bytes(ffi.buffer(self._balls))

    def __setstate__(self, state: tuple[bytes, bytes]) -> None:
        self._rig, self._balls = ffi.new("ofc_rig *"), ffi.new("ofc_rig_balls *")
        ffi.buffer(self._rig)[:], ffi.buffer(self._balls)[:] = state


def _frame(photo: Photo, background: Photo | None, channels: Channels) -> tuple[Picture, Picture | None]:
    below = None if background is None else picture_of(background, None, channels)
    return picture_of(photo, None, channels), below
