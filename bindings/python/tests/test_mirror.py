"""Nothing of ofc.h is forgotten: exports are wrapped or named here, structs have all their fields, constants their values."""

from __future__ import annotations

import dataclasses
import enum
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import orientation_from_color as ofc
from orientation_from_color import _abi, enums, stages
from orientation_from_color._native import ffi, lib

HEADER = (Path(__file__).parents[3] / "include/ofc.h").read_text(encoding="utf-8")
SOURCES = "".join(path.read_text(encoding="utf-8") for path in Path(ofc.__file__).parent.glob("*.py"))

# Not wrapped, and why.
A_STAGE = "a stage of ofc_solve(), whose Solution has what it finds"
ROWS = "for microcontrollers; RigModel.normals() takes whole frames"
PARTS = "other threads run during a call: split the rows, or the pictures"
LEFT_OUT = {
    "ofc_normals_compute_parallel": PARTS,
    "ofc_normals_uncertainty_parallel": PARTS,
    "ofc_version": "ofc_version_string() is __version__",
    "ofc_segment_mark": "labels == label is the same mask",
    "ofc_lmeds_params_default": "part of ofc_solve_params_default()",
    "ofc_lmeds_subset_count": A_STAGE,
    "ofc_lmeds_workspace_size": A_STAGE,
    "ofc_lmeds_fit": A_STAGE,
    "ofc_norm_location_workspace_size": A_STAGE,
    "ofc_norm_location": A_STAGE,
    "ofc_ellipsoid_decompose": A_STAGE,
    "ofc_rank_compute": A_STAGE,
    "ofc_location_workspace_size": A_STAGE,
    "ofc_location_fit": A_STAGE,
    "ofc_tilt_pentland": A_STAGE,
    "ofc_tilt_pentland_along": A_STAGE,
    "ofc_tilt_lee_rosenfeld": A_STAGE,
    "ofc_tilt_zheng_chellappa": A_STAGE,
    "ofc_largest_disc_workspace_size": A_STAGE,
    "ofc_largest_disc": A_STAGE,
    "ofc_tilt_chojnacki": A_STAGE,
    "ofc_slant_pentland": A_STAGE,
    "ofc_slant_lee_rosenfeld": A_STAGE,
    "ofc_slant_zheng_chellappa": A_STAGE,
    "ofc_channel_maxima": A_STAGE,
    "ofc_constrained_slants_find": A_STAGE,
    "ofc_constrained_slants_least_squares": A_STAGE,
    "ofc_slant_curve_sample": A_STAGE,
    "ofc_orientation_compose": A_STAGE,
    "ofc_integrability_integral": A_STAGE,
    "ofc_orthogonal_closed_form": A_STAGE,
    "ofc_annealing_params_default": A_STAGE,
    "ofc_orthogonal_annealing_workspace_size": A_STAGE,
    "ofc_orthogonal_annealing": A_STAGE,
    "ofc_constrained_slants_integrable_workspace_size": A_STAGE,
    "ofc_constrained_slants_integrable": A_STAGE,
    "ofc_rig_rows_begin": ROWS,
    "ofc_rig_row": ROWS,
    "ofc_rig_rows_contact": ROWS,
}


def test_every_export_is_wrapped_or_named_as_left_out() -> None:
    exports = set(re.findall(r"^(?:const char \*|\w+ )(ofc_\w+)\(", HEADER, re.MULTILINE))
    assert len(exports) > 80
    wrapped = set(re.findall(r"\blib\.(ofc_\w+)", SOURCES))
    assert wrapped | set(LEFT_OUT) == exports
    assert not wrapped & set(LEFT_OUT)


STRUCTS: dict[str, type] = {
    "ofc_solution": ofc.Solution,
    "ofc_pixel_counts": ofc.PixelCounts,
    "ofc_estimate": stages.Estimate,
    "ofc_color_fit": stages.ColorFit,
    "ofc_rank": stages.Rank,
    "ofc_location": stages.Location,
    "ofc_shadow_plane": stages.ShadowPlane,
    "ofc_inlier_test": stages.InlierTest,
    "ofc_ellipsoid": stages.Ellipsoid,
    "ofc_tilts": stages.Tilts,
    "ofc_slants": stages.SlantCandidate,
    "ofc_orientation": stages.Orientation,
    "ofc_confidence": stages.Confidence,
    "ofc_covariance": ofc.Covariance,
    "ofc_check_result": ofc.Check,
    "ofc_depth_result": ofc.Depth,
    "ofc_flat_field_result": ofc.FlatField,
    "ofc_offset": ofc.Offset,
    "ofc_paint": ofc.Paint,
    "ofc_relief": ofc.Relief,
    "ofc_region": ofc.Region,
    "ofc_rig_model": ofc.RigModel,
    "ofc_rig_contact": ofc.RigContact,
    "ofc_surface_light": ofc.SurfaceLight,
    "ofc_surface_result": ofc.Surface,
    "ofc_surface_params": ofc.SurfaceParams,
    "ofc_rendering": ofc.Rendering,
    "ofc_stream_drift": ofc.Drift,
    "ofc_lmeds_params": ofc.LmedsParams,
    "ofc_solve_params": ofc.SolveParams,
    "ofc_depth_params": ofc.DepthParams,
    "ofc_render_params": ofc.RenderParams,
    "ofc_stream_params": ofc.StreamParams,
    "ofc_paint_params": ofc.PaintParams,
    "ofc_relief_params": ofc.ReliefParams,
    "ofc_segment_params": ofc.SegmentParams,
}


@pytest.mark.parametrize("name", STRUCTS)
def test_a_dataclass_has_the_fields_of_its_struct(name: str) -> None:
    theirs = [field for field, _ in ffi.typeof(name).fields if field != "reserved"]
    not_in_c = getattr(STRUCTS[name], "_not_in_c", ())
    ours = [field.name for field in dataclasses.fields(STRUCTS[name]) if field.name not in not_in_c]
    assert ours == theirs


@pytest.mark.parametrize("name", [name for name in STRUCTS if name.endswith("_params")])
def test_defaults_are_those_of_c(name: str) -> None:
    theirs, ours = ffi.new(f"{name} *"), ffi.new(f"{name} *")
    _abi.check(getattr(lib, f"{name}_default")(theirs))
    _abi.fill(ours[0], STRUCTS[name]())
    assert bytes(ffi.buffer(ours)) == bytes(ffi.buffer(theirs))


PREFIXES: dict[type[enum.IntEnum], str] = {
    enums.Status: "STATUS",
    enums.Reason: "REASON",
    enums.Fit: "FIT",
    enums.Weighting: "WEIGHTING",
    enums.Tilt: "TILT",
    enums.Fallback: "FALLBACK",
    enums.OrientationMethod: "ORIENTATION",
    enums.ShadowRejection: "SHADOW_REJECTION",
    enums.Norms: "NORMS",
    enums.Convexity: "CONVEXITY",
    enums.Slants: "SLANTS",
    enums.Evidence: "EVIDENCE",
    enums.DepthMethod: "DEPTH",
    enums.PaintVerdict: "PAINT",
    enums.Scale: "SCALE",
    enums.NoRelief: "NO_RELIEF",
    enums.ReliefClass: "RELIEF",
    enums.RigAdvice: "RIG_ADVICE",
    enums.SurfaceClass: "SURFACE",
    enums.DualSource: "DUAL",
    enums.Pass: "PASS",
    enums.Transfer: "TRANSFER",
}
# Other constants with one of these prefixes.
NO_MEMBERS = {
    "OFC_PAINT_DISTANCES",
    "OFC_PAINT_WORKSPACE_SIZE",
    "OFC_SURFACE_CLASS",
    "OFC_SURFACE_FIRST_LIGHT",
    "OFC_SURFACE_DOUBTFUL",
}


def test_every_enum_has_a_prefix() -> None:
    every = {value for value in vars(enums).values() if isinstance(value, type) and issubclass(value, enum.IntEnum)}
    assert every - {enum.IntEnum} == set(PREFIXES)


@pytest.mark.parametrize("kind", PREFIXES)
def test_an_enum_has_the_constants_of_c(kind: type[enum.IntEnum]) -> None:
    pattern = rf"OFC_{PREFIXES[kind]}_(?!.*\()\w+"
    theirs = {name: getattr(lib, name) for name in dir(lib) if re.fullmatch(pattern, name) and name not in NO_MEMBERS}
    ours = {f"OFC_{PREFIXES[kind]}_{member.name}": int(member) for member in kind}
    if kind is enums.NoRelief:
        assert ours.pop("OFC_NO_RELIEF_NONE") == 0  # what C calls 0 where there is a relief
    assert ours == theirs


def test_every_message_and_advice_is_there() -> None:
    for status in enums.Status:
        assert status.message
    for reason in enums.Reason:
        assert reason.message
        assert reason.advice


def test_a_parameter_that_is_no_number_of_its_type_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="seed = -1"):
        ofc.solve(np.zeros((9, 9, 3), np.uint8), params=ofc.SolveParams(lmeds=ofc.LmedsParams(seed=-1)))


def test_every_public_name_is_documented() -> None:
    undocumented: list[Any] = [name for name in ofc.__all__ if not getattr(ofc, name).__doc__]
    assert not undocumented
