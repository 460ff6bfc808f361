"""The constants of ofc.h. Their documentation is there; OFC_CONVEXITY_HOLLOW is Convexity.HOLLOW here."""

from __future__ import annotations

import enum

from ._native import ffi, lib


class Status(enum.IntEnum):
    """What a call returned: zero is success, negative an error, and positive says that the picture has no whole answer."""

    OK = 0
    RANK_DEFICIENT = 1
    NOT_POSITIVE_DEFINITE = 2
    NO_TILT = 3
    NO_CONSISTENT_SLANTS = 4
    NOT_CONVERGED = 5
    COLD_START_NEEDED = 6
    PAINT_UNKNOWN = 7
    NO_RELIEF = 8
    UNDETERMINED = 9
    SCALE_UNKNOWN = 10
    NULL_POINTER = -10
    MISALIGNED = -11
    OVERLAP = -12
    EMPTY = -20
    TOO_LARGE = -21
    STRIDE_TOO_SMALL = -22
    WORKSPACE_TOO_SMALL = -23
    UNKNOWN_FORMAT = -30
    INVALID_PARAMETER = -31
    RESERVED_NOT_ZERO = -32
    NOT_SOLVED = -33
    NO_COVARIANCE = -34
    TOO_FEW_PIXELS = -40
    DARK = -41
    SATURATED = -42
    NO_CELLS = -43
    NO_STREAM = -50
    NO_FRAME = -51
    ROW_ORDER = -52
    TOO_MANY_ROWS = -53
    TOO_FEW_ROWS = -54
    ROW_MISMATCH = -55
    NOT_A_MODEL = -60
    MODEL_VERSION = -61
    MODEL_DAMAGED = -62

    @property
    def message(self) -> str:
        """What the status means."""
        return str(ffi.string(lib.ofc_status_message(self)).decode())


class Reason(enum.IntEnum):
    """What a refusal or a doubt comes from."""

    NONE = 0
    UNKNOWN = 1
    MASK_EMPTY = 10
    MASK_INVERTED = 11
    TOO_FEW_PIXELS = 12
    NOT_FINITE = 13
    SATURATED = 20
    DARK = 21
    CHANNEL_DEAD = 22
    GRAY = 23
    TOO_FEW_LIGHTS = 30
    LIGHTS_COPLANAR = 31
    VIGNETTE = 32
    FLAT = 40
    CYLINDER = 41
    CONVEX_OR_HOLLOW = 42
    TWO_PAINTS = 50
    BACKGROUND = 51
    OUTLIERS = 52

    @property
    def message(self) -> str:
        """What the reason means."""
        return str(ffi.string(lib.ofc_reason_message(self)).decode())

    @property
    def advice(self) -> str:
        """What to try about it."""
        return str(ffi.string(lib.ofc_reason_advice(self)).decode())


class Fit(enum.IntEnum):
    """How C is fitted."""

    LEAST_MEDIAN = 0
    LEAST_SQUARES = 1


class Weighting(enum.IntEnum):
    """How much each pixel counts in the search of the fit."""

    AUTO = 0
    PIXELS = 1


class Tilt(enum.IntEnum):
    """An estimator of tilts, for the direct method."""

    PENTLAND = 0
    LEE_ROSENFELD = 1
    ZHENG_CHELLAPPA = 2
    CHOJNACKI = 3
    GIVEN = 4


class Fallback(enum.IntEnum):
    """What the direct method does where eqs. 25 have no root."""

    REFUSE = 0
    LEAST_SQUARES = 1
    TILT_INTEGRABILITY = 2
    PENTLAND = 3
    LEE_ROSENFELD = 4
    ZHENG_CHELLAPPA = 5


class OrientationMethod(enum.IntEnum):
    """How F is oriented: the joint method, or the direct one of the paper."""

    JOINT = 0
    DIRECT = 1


class ShadowRejection(enum.IntEnum):
    """Whether colors that one of the lights does not reach are left out before the fit."""

    AUTO = 0
    ON = 1
    OFF = 2


class Norms(enum.IntEnum):
    """Where the lengths of the rows of F come from."""

    FIT = 0
    CHANNEL_MAXIMA = 1


class Convexity(enum.IntEnum):
    """Whether the surface is convex or hollow."""

    AUTO = 0
    CONVEX = 1
    HOLLOW = 2


class Slants(enum.IntEnum):
    """Where slants come from."""

    NONE = 0
    ROOT = 1
    LEAST_SQUARES = 2
    TILT_INTEGRABILITY = 3
    PENTLAND = 4
    LEE_ROSENFELD = 5
    ZHENG_CHELLAPPA = 6
    JOINT = 7


class Evidence(enum.IntEnum):
    """What decided the orientation."""

    TILTS_ALONE = 0
    OUTWARD = 1
    INTEGRABILITY = 2
    BOTH = 3


class DepthMethod(enum.IntEnum):
    """What to do where a slope is unusable: leave it out, take it for flat, or bridge it."""

    POISSON = 0
    PAPER = 1
    COUPLED = 2


class PaintVerdict(enum.IntEnum):
    """What the paint is like, or why it cannot be told from the shape."""

    SMOOTH = 1
    ROUGH = 2
    BUSY = 3
    TWO_HUES = 4
    UNDETERMINED = 5
    NO_ELLIPSOID = 6


class Scale(enum.IntEnum):
    """Where the scale of a relief's slopes comes from."""

    UNKNOWN = 0
    COLORS = 1
    BALL = 2
    GIVEN = 3


class NoRelief(enum.IntEnum):
    """Why a picture shows no relief on a plane; NONE where it shows one."""

    NONE = 0
    UNTOUCHED = 1
    NO_PLANE = 2
    NOT_DETERMINED = 3
    NOT_INTEGRABLE = 4
    EDGE = 5


class RigAdvice(enum.IntEnum):
    """What would make a rig's model better, most."""

    NONE = 0
    CONTACTS = 1
    SCALE = 2
    REGION = 3


class ReliefClass(enum.IntEnum):
    """What a pixel of a relief is part of."""

    NONE = 0
    PLANE = 1
    SKIRT = 2
    CONTACT = 3


class SurfaceClass(enum.IntEnum):
    """What is known of a pixel of the whole surface."""

    OUTSIDE = 0
    THREE_LIGHTS = 1
    TWO_LIGHTS = 2
    ONE_LIGHT = 3
    INTERPOLATED = 4
    REJECTED = 5


class DualSource(enum.IntEnum):
    """How it is known what a light's shadow leaves of a color."""

    NONE = 0
    DIRECTIONS = 1
    SEARCH = 2
    REJECTED = 3


class Pass(enum.IntEnum):
    """What the rows of a stream's frame are for."""

    COLORS = 1
    TILTS = 2
    SLANTS = 3
    REFINE = 4
    OUTWARD = 5
    INTEGRABILITY = 6


class Transfer(enum.IntEnum):
    """What a file stores of light."""

    SRGB = 1
    GAMMA = 2
    TABLE = 3
