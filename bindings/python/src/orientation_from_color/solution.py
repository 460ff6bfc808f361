"""solve() and its Solution: from one picture to F, normals and how sure they are."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._arrays import output, row_stride
from ._native import ffi, lib
from .enums import Evidence, Reason, Slants, Status
from .errors import Error, Refused
from .params import SolveParams, SurfaceParams
from .picture import Channels, Photo, Picture, picture_of
from .report import Report
from .stages import (
    Check,
    ColorFit,
    Confidence,
    Covariance,
    Ellipsoid,
    InlierTest,
    Location,
    Orientation,
    PixelCounts,
    Rank,
    SlantCandidate,
    Tilts,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .depth import Depth
    from .surface import Surface


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Solution(Report):
    """What solve() found. Each method takes another frame under the same lights, or the picture that was solved.

    Attributes:
        inliers: (height, width) bool, the pixels that obey the model.
        picture: The picture that was solved; None in a solution that was pickled, where each method needs one.
    """

    outcome: Status
    slant_source: Slants
    candidate_count: int
    chosen: int
    inlier_count: int
    lights_from_behind: int
    reason: Reason
    reason_channel: int
    reason_value: float
    reason_limit: float
    pixel_counts: PixelCounts
    fit: ColorFit
    rank: Rank
    norm_location: Location
    inlier_test: InlierTest
    ellipsoid: Ellipsoid
    tilts: Tilts
    slant_rad: _abi.Vector3
    confidence: Confidence
    candidates: tuple[SlantCandidate, ...]
    orientation: Orientation
    inliers: npt.NDArray[np.bool_]
    picture: Picture | None
    struct: Any

    _not_in_c = ("inliers", "picture", "struct")

    @property
    def f(self) -> npt.NDArray[np.float64]:
        """F, (3, 3): row c is the one light that channel c could have been lit by, in pixel values; red is first."""
        return self.orientation.f

    def normals(
        self,
        photo: Photo | None = None,
        mask: npt.ArrayLike | None = None,
        *,
        channels: Channels = "rgb",
        out: npt.NDArray[np.float32] | None = None,
    ) -> npt.NDArray[np.float32]:
        """Unit normals, (height, width, 3) float32: x right, y up, z toward the camera; zero where there is none."""
        picture = self._picture(photo, mask, channels)
        out = output(out, (*picture.shape, 3))
        _abi.check(lib.ofc_normals_compute(picture.struct, self.struct, _abi.pointer("float *", out), row_stride(out)))
        return out

    def uncertainty(
        self,
        photo: Photo | None = None,
        mask: npt.ArrayLike | None = None,
        *,
        channels: Channels = "rgb",
        out: npt.NDArray[np.float32] | None = None,
    ) -> npt.NDArray[np.float32]:
        """The 1-sigma angle of each normal in radians, (height, width) float32; pi where there is no normal.

        Raises:
            Error: NO_COVARIANCE for a solution by the direct method.
        """
        picture = self._picture(photo, mask, channels)
        out = output(out, picture.shape)
        _abi.check(lib.ofc_normals_uncertainty(picture.struct, self.struct, _abi.pointer("float *", out), row_stride(out)))
        return out

    def matte_weight(
        self,
        photo: Photo | None = None,
        mask: npt.ArrayLike | None = None,
        *,
        refractive_index: float = 1.5,
        channels: Channels = "rgb",
        out: npt.NDArray[np.float32] | None = None,
    ) -> npt.NDArray[np.float32]:
        """How far to trust each color by Wolff's model of smooth dielectrics, (height, width) float32 from 0 to 1."""
        picture = self._picture(photo, mask, channels)
        out = output(out, picture.shape)
        address = _abi.pointer("float *", out)
        _abi.check(lib.ofc_normals_matte_weight(picture.struct, self.struct, refractive_index, address, row_stride(out)))
        return out

    def covariance(self) -> Covariance:
        """The covariances of C and F, to first order; NO_COVARIANCE for a solution by the direct method."""
        found = ffi.new("ofc_covariance *")
        _abi.check(lib.ofc_solution_covariance(self.struct, found))
        return _abi.read(Covariance, found)

    def check(
        self,
        photo: Photo | None = None,
        mask: npt.ArrayLike | None = None,
        *,
        depth: Depth | None = None,
        channels: Channels = "rgb",
    ) -> Check:
        """How well the solution explains the picture, and with a depth also the surface."""
        picture = self._picture(photo, mask, channels)
        need = lib.ofc_check_workspace_size(picture.width, picture.height)
        memory = _abi.workspace(need)
        found = ffi.new("ofc_check_result *")
        surface = ffi.NULL if depth is None else depth.as_map()
        _abi.check(lib.ofc_check(picture.struct, self.struct, surface, _abi.pointer("void *", memory), need, found))
        return _abi.read(Check, found)

    def complete(
        self,
        photo: Photo | None = None,
        mask: npt.ArrayLike | None = None,
        *,
        channels: Channels = "rgb",
        params: SurfaceParams = SurfaceParams(),
    ) -> Surface:
        """The whole surface: a normal, its uncertainty, a depth and a class for every pixel of the mask.

        Raises:
            Error: NO_COVARIANCE for a solution by the direct method.
        """
        from .surface import complete

        return complete(self, self._picture(photo, mask, channels), params)

    def plot(self) -> Figure:
        """The picture, its inliers, the normals and how sure they are, by matplotlib."""
        from .plot import solution

        return solution(self)

    def trust(self) -> str:
        """How far to trust the normals, in a sentence."""
        sure = self.confidence
        if self.orientation.rank < 3:
            return "there are no normals"
        if sure.evidence is Evidence.TILTS_ALONE or math.isnan(sure.error_rad):
            return "how far the normals are off is not known: the orientation rests on tilts alone"
        words = f"as a whole the normals are expected to be off by {math.degrees(sure.error_rad):.1f} degrees"
        if sure.log_likelihood_margin < 4.6:  # a hundredth as likely
            words += "; another orientation is not ruled out"
        if self.reason is Reason.CONVEX_OR_HOLLOW:
            words += "; convex or hollow is a guess"
        return words

    def lines(self) -> list[tuple[str, str]]:
        """What a person wants to know first."""
        lines = [("outcome", self.outcome.message)]
        if self.reason is not Reason.NONE:
            lines += [("reason", reason_in_words(self)), ("try", self.reason.advice)]
        lines += [("inliers", f"{self.inlier_count} of {self.pixel_counts.usable} usable pixels"), ("trust", self.trust())]
        lines += [(f"F, {name}", "  ".join(f"{value:8.2f}" for value in row)) for name, row in zip("rgb", self.f, strict=True)]
        return lines

    def _picture(self, photo: Photo | None, mask: npt.ArrayLike | None, channels: Channels) -> Picture:
        if photo is not None:
            return picture_of(photo, mask, channels)
        if self.picture is None:
            raise ValueError("a solution that was pickled has left its picture behind: give it")
        return self.picture

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (bytes(ffi.buffer(self.struct)), self.inliers)


def _restored(memory: bytes, inliers: npt.NDArray[np.bool_]) -> Solution:
    struct = ffi.new("ofc_solution *")
    ffi.buffer(struct)[:] = memory
    return _abi.read(Solution, struct, inliers=inliers, picture=None, struct=struct)


def reason_in_words(solution: Solution) -> str:
    """The reason, its channel, and the numbers behind it."""
    words = solution.reason.message
    if solution.reason_channel >= 0:
        words += f", channel {'rgb'[solution.reason_channel]}"
    if solution.reason_value != 0 or solution.reason_limit != 0:
        words += f" ({solution.reason_value:.3g}, limit {solution.reason_limit:.3g})"
    return words


def solve(
    photo: Photo,
    mask: npt.ArrayLike | None = None,
    *,
    channels: Channels = "rgb",
    params: SolveParams = SolveParams(),
) -> Solution:
    """Finds the color-orientation matrix F of a picture, and the pixels that obey the model.

    Args:
        photo: Linear pixel values of shape (height, width, 3), or what else Picture takes.
        mask: (height, width), zero where a pixel is to be left out.
        channels: "rgb", or "bgr" as OpenCV has them.
        params: What to do in detail.

    Raises:
        Refused: The picture does not determine F; `reason` says why and `advice` what to try.
        Error: An argument that the call cannot take.
    """
    picture = picture_of(photo, mask, channels)
    given = _abi.params("ofc_solve_params", lib.ofc_solve_params_default, params)
    need = lib.ofc_solve_workspace_size(picture.width, picture.height, given)
    memory = _abi.workspace(need)
    inliers = np.zeros(picture.shape, np.uint8)
    struct = ffi.new("ofc_solution *")
    status = lib.ofc_solve(
        picture.struct, given, _abi.pointer("void *", memory), need, _abi.pointer("uint8_t *", inliers), struct
    )
    if status in (Status.TOO_FEW_PIXELS, Status.DARK, Status.SATURATED):
        counts, reason = _counts(picture, given, memory)
        raise Refused(Status(status), counts, reason)
    if status < 0:
        raise Error(Status(status))
    inliers &= 1
    solution = _abi.read(Solution, struct, inliers=inliers.view(np.bool_), picture=picture, struct=struct)
    if status != Status.OK:
        details = reason_in_words(solution) if solution.reason is not Reason.NONE else ""
        raise Refused(Status(status), solution, solution.reason, details)
    return solution


def pixel_counts(
    photo: Photo,
    mask: npt.ArrayLike | None = None,
    *,
    channels: Channels = "rgb",
    params: SolveParams = SolveParams(),
) -> tuple[PixelCounts, Reason]:
    """Counts the pixels that solve() would use and why not the others; the reason is NONE where there are enough."""
    picture = picture_of(photo, mask, channels)
    given = _abi.params("ofc_solve_params", lib.ofc_solve_params_default, params)
    memory = _abi.workspace(lib.ofc_solve_workspace_size(picture.width, picture.height, given))
    return _counts(picture, given, memory)


def _counts(picture: Picture, params: Any, memory: npt.NDArray[np.uint8]) -> tuple[PixelCounts, Reason]:
    counts, reason = ffi.new("ofc_pixel_counts *"), ffi.new("ofc_reason *")
    address = _abi.pointer("void *", memory)
    _abi.check(lib.ofc_pixel_counts_compute(picture.struct, params, address, memory.nbytes, counts, reason))
    return _abi.read(PixelCounts, counts), Reason(reason[0])


def normals_from_matrix(
    photo: Photo,
    f_inverse: npt.ArrayLike,
    mask: npt.ArrayLike | None = None,
    *,
    inliers_of: Solution | None = None,
    unit: bool = True,
    channels: Channels = "rgb",
    out: npt.NDArray[np.float32] | None = None,
) -> npt.NDArray[np.float32]:
    """Normals F^-1 rho with any F^-1, (height, width, 3) float32; zero where a pixel is no inlier of `inliers_of`."""
    picture = picture_of(photo, mask, channels)
    matrix = np.ascontiguousarray(f_inverse, np.float64)
    if matrix.shape != (3, 3):
        raise ValueError(f"f_inverse has the shape (3, 3), not {matrix.shape}")
    out = output(out, (*picture.shape, 3))
    test = ffi.NULL if inliers_of is None else ffi.addressof(inliers_of.struct, "inlier_test")
    how = lib.OFC_NORMALIZATION_UNIT if unit else lib.OFC_NORMALIZATION_NONE
    address = _abi.pointer("double *", matrix)
    _abi.check(lib.ofc_normals_from_matrix(picture.struct, test, address, how, _abi.pointer("float *", out), row_stride(out)))
    return out
