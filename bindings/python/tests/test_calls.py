"""What each call is for, once."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest

import orientation_from_color as ofc
from conftest import COLORS, LIGHTS, angles, dome

mpl.use("Agg")


def test_from_a_picture_to_normals_uncertainty_and_depth(scene: ofc.Rendering) -> None:
    mask = (scene.normals != 0).any(axis=-1)
    solution = ofc.solve(scene.pixels, mask)
    errors = angles(solution.normals(), scene.normals)
    assert np.median(errors) < 3
    assert solution.inlier_count == np.count_nonzero(solution.inliers) > 0.7 * np.count_nonzero(mask)
    sigma = solution.uncertainty()
    assert (sigma[~solution.inliers] == np.float32(np.pi)).all()
    assert 0 < np.degrees(np.median(sigma[solution.inliers])) < 15
    assert solution.covariance().f.shape == (9, 9)
    assert solution.matte_weight().max() <= 1
    depth = ofc.integrate(solution.normals(), solution.inliers, params=ofc.DepthParams(pixel_pitch=0.1))
    assert depth.converged
    assert np.isnan(depth.depth[~solution.inliers]).all()
    surface, _ = dome(90, 120)
    both = np.isfinite(depth.depth)
    assert np.corrcoef(depth.depth[both], surface[both])[0, 1] > 0.99
    assert 0.05 < np.ptp(depth.depth[both]) / np.ptp(surface[both]) < 0.15
    check = solution.check(depth=depth)
    assert (check.correlation > 0.99).all()
    assert check.has_turn
    assert np.median(angles(depth.normals(), scene.normals)) < 4


def test_slopes_are_as_good_as_normals(scene: ofc.Rendering) -> None:
    n = scene.normals
    with np.errstate(divide="ignore", invalid="ignore"):
        p, q = -n[..., 0] / n[..., 2], -n[..., 1] / n[..., 2]
    mask = n[..., 2] > 0
    by_normals, by_slopes = ofc.integrate(n, mask), ofc.integrate(p=p, q=q, mask=mask)
    assert np.nanmax(np.abs(by_normals.depth - by_slopes.depth)) < 0.05 * np.nanmax(by_normals.depth)
    heavy = ofc.integrate(n, mask, weights=np.where(mask, 1, 0).astype(np.float32), prior=np.full(mask.shape, 5, np.float32))
    assert np.nanmean(heavy.depth) == pytest.approx(5, abs=0.1)
    with pytest.raises(ValueError, match="normals, or p and q"):
        ofc.integrate(n, p=p, q=q)
    with pytest.raises(ValueError, match="normals, or p and q"):
        ofc.integrate(p=p)


def test_a_refusal_has_a_reason_and_an_advice() -> None:
    with pytest.raises(ofc.Refused) as flat:
        ofc.solve(np.full((50, 50, 3), 7, np.uint8))
    assert flat.value.reason is ofc.Reason.FLAT
    assert "object that bends" in flat.value.advice
    assert "try: take an object" in str(flat.value)
    assert isinstance(flat.value.result, ofc.Solution)
    assert "the surface is flat" in repr(flat.value.result)
    with pytest.raises(ofc.Refused) as dark:
        ofc.solve(np.zeros((50, 50, 3), np.uint8))
    assert (dark.value.status, dark.value.reason) == (ofc.Status.DARK, ofc.Reason.DARK)
    assert isinstance(dark.value.result, ofc.PixelCounts)
    assert dark.value.result.dark == 2500
    assert ofc.pixel_counts(np.zeros((50, 50, 3), np.uint8))[1] is ofc.Reason.DARK
    again = pickle.loads(pickle.dumps(dark.value))
    assert (str(again), again.reason) == (str(dark.value), dark.value.reason)
    with pytest.raises(ofc.Error) as wrong:
        ofc.solve(np.zeros((50, 50, 3), np.uint8), params=ofc.SolveParams(rank_threshold=2))
    assert wrong.value.status is ofc.Status.INVALID_PARAMETER
    assert not isinstance(wrong.value, ofc.Refused)


def test_a_solution_is_pickled_without_its_picture(scene: ofc.Rendering) -> None:
    solution = ofc.solve(scene.pixels)
    for again in (pickle.loads(pickle.dumps(solution)), copy.deepcopy(solution)):
        assert (again.f == solution.f).all()
        assert (again.inliers == solution.inliers).all()
        assert (again.normals(scene.pixels) == solution.normals()).all()
        with pytest.raises(ValueError, match="left its picture behind"):
            again.normals()


def test_the_direct_method_knows_no_uncertainty(scene: ofc.Rendering) -> None:
    solution = ofc.solve(scene.pixels, params=ofc.SolveParams(orientation_method=ofc.OrientationMethod.DIRECT))
    assert "not known" in solution.trust()
    with pytest.raises(ofc.Error) as error:
        solution.uncertainty()
    assert error.value.status is ofc.Status.NO_COVARIANCE
    assert len(solution.plot().axes) == 5


def test_hollow_is_the_twin(scene: ofc.Rendering) -> None:
    convex = ofc.solve(scene.pixels)
    hollow = ofc.solve(scene.pixels, params=ofc.SolveParams(convexity=ofc.Convexity.HOLLOW))
    assert np.allclose(hollow.f[:, :2], -convex.f[:, :2])


def test_normals_by_any_matrix(scene: ofc.Rendering) -> None:
    solution = ofc.solve(scene.pixels)
    normals = ofc.normals_from_matrix(scene.pixels, solution.orientation.f_inverse, inliers_of=solution)
    assert (normals == solution.normals()).all()
    raw = ofc.normals_from_matrix(scene.pixels, solution.orientation.f_inverse, inliers_of=solution, unit=False)
    assert not (raw == normals).all()
    with pytest.raises(ValueError, match=r"\(3, 3\)"):
        ofc.normals_from_matrix(scene.pixels, np.eye(2))


def test_a_flat_field_makes_even_what_was_not(scene: ofc.Rendering) -> None:
    fall_off = np.linspace(0.5, 1, 120)[None, :, None]
    uneven, background = (scene.pixels * fall_off).astype(np.float32), (200 * fall_off * np.ones((90, 1, 3))).astype(np.float32)
    even = ofc.flat_field(uneven, background)
    known = (scene.pixels > 40).all(axis=-1)
    ratio = even.pixels[known] / scene.pixels[known]
    assert ratio.std() / ratio.mean() < 0.001
    assert even.used > 0
    with pytest.raises(ofc.Error):
        ofc.flat_field(uneven, background[1:])


def test_what_files_hold_becomes_light(scene: ofc.Rendering) -> None:
    light = np.clip(np.asarray(scene.pixels, np.float64), 0, 255)
    stored = np.rint(255 * (light / 255) ** (1 / 2.2)).astype(np.uint8)
    through = ofc.linearize(stored, ofc.Transfer.GAMMA, gamma=2.2)
    assert np.abs(through - light).max() < 2
    table = ofc.transfer_table(ofc.Transfer.GAMMA, 2.2)
    assert (ofc.linearize(stored, ofc.Transfer.TABLE, table=table) == through).all()
    assert len(ofc.transfer_table(ofc.Transfer.SRGB, bits=16)) == 65536
    with pytest.raises(ofc.Error):
        ofc.linearize(stored, ofc.Transfer.TABLE, table=table[1:])

    pixels = np.asarray(scene.pixels, np.float32)
    clipped = np.minimum(pixels, pixels.max() / 2)
    found = ofc.find_saturation(clipped)
    assert found is not None
    assert found[0] == clipped.max()
    assert found[1] == (clipped == clipped.max()).any(axis=-1).sum()
    assert ofc.find_saturation(np.zeros((9, 9, 3), np.uint8)) is None


def test_light_that_is_not_ours_is_subtracted() -> None:
    depth, mask = dome(180, 240)
    directions = LIGHTS / np.linalg.norm(LIGHTS, axis=1, keepdims=True)
    scene = ofc.render(depth, directions, COLORS, mask, dtype=np.float32, params=ofc.RenderParams(peak=180, noise=0.3))
    lit = np.asarray(scene.pixels, np.float32) + np.float32(30)
    assert (ofc.subtract_offset(lit, (30, 30, 30)) == ofc.subtract_dark(lit, np.full_like(lit, 30))).all()
    offset = np.zeros(3)
    for _ in range(3):
        offset += ofc.fit_offset(ofc.solve(ofc.subtract_offset(lit, offset), mask)).offset
    assert np.abs(offset - 30).max() < 5
    with pytest.raises(ValueError, match="red, green, blue"):
        ofc.subtract_offset(lit, (30, 30))


def test_uneven_paint_is_divided_out() -> None:
    depth, mask = dome(180, 240)
    directions = LIGHTS / np.linalg.norm(LIGHTS, axis=1, keepdims=True)
    scene = ofc.render(depth, directions, COLORS, mask, dtype=np.float32, params=ofc.RenderParams(peak=200, noise=0.3))
    y, x = np.mgrid[0:180, 0:240]
    albedo = (1 + 0.25 * (x - 120) / 120 + 0.15 * (y - 90) / 90)[..., None].astype(np.float32)
    painted = np.asarray(scene.pixels) * albedo
    paint = ofc.estimate_paint(painted, mask)
    assert paint.verdict in (ofc.PaintVerdict.SMOOTH, ofc.PaintVerdict.ROUGH)
    known = np.isfinite(paint.albedo())
    assert np.corrcoef(paint.albedo()[known], albedo[..., 0][known])[0, 1] > 0.8
    even = ofc.solve(paint.divide(), mask)
    assert np.median(angles(even.normals(), scene.normals)) < 6
    assert len(paint.plot().axes) == 4
    with pytest.raises(ofc.Refused) as gray:
        ofc.estimate_paint(np.repeat(painted[..., :1], 3, axis=-1), mask)
    assert gray.value.status > 0


def test_the_whole_surface_has_a_normal_for_every_pixel(scene: ofc.Rendering) -> None:
    mask = (scene.normals != 0).any(axis=-1)
    solution = ofc.solve(scene.pixels, mask)
    surface = solution.complete(params=ofc.SurfaceParams(pixel_pitch=0.1))
    assert ((surface.classes != ofc.SurfaceClass.OUTSIDE) == mask).all()
    assert np.allclose(np.linalg.norm(surface.normals[mask], axis=-1), 1, atol=1e-3)
    assert (np.isfinite(surface.depth) == mask).all()
    assert np.median(angles(surface.normals, scene.normals)) < 4
    assert surface.class_counts[ofc.SurfaceClass.THREE_LIGHTS] == np.count_nonzero(surface.classes == 1)
    assert surface.sees(0)[surface.classes == 1].all()
    assert not surface.doubtful[~mask].any()
    assert "three lights" in repr(surface)
    assert len(surface.plot().axes) == 7
    with pytest.raises(ValueError, match="lights are"):
        surface.sees(3)
    direct = ofc.solve(scene.pixels, mask, params=ofc.SolveParams(orientation_method=ofc.OrientationMethod.DIRECT))
    with pytest.raises(ofc.Error):
        direct.complete()


def press(x0: float, y0: float, seed: int = 0) -> tuple[ofc.Rendering, ofc.Rendering]:
    """A ball of radius 40 pixels in a gel that comes up in a parabola around it, and the gel untouched."""
    y, x = np.mgrid[0:180, 0:240]
    d, edge, skirt = np.hypot(x - x0, y - y0), 26.0, 12.0
    steepest = edge / np.sqrt(40**2 - edge**2)
    inside = np.sqrt(np.maximum(40.0**2 - d**2, 0)) - np.sqrt(40**2 - edge**2) + steepest * skirt / 2
    outside = steepest * np.maximum(skirt - (d - edge), 0) ** 2 / (2 * skirt)
    depth = np.where(d < edge, inside, outside).astype(np.float32)
    directions = LIGHTS / np.linalg.norm(LIGHTS, axis=1, keepdims=True)
    scene = ofc.render(depth, directions, COLORS, params=ofc.RenderParams(noise=0.7, peak=200, seed=seed, cast_shadows=False))
    gray = scene.scale * ofc.render(0 * depth, directions, COLORS).largest_modulus
    untouched = ofc.render(0 * depth, directions, COLORS, params=ofc.RenderParams(noise=0.7, peak=gray, seed=99))
    return scene, untouched


def test_a_relief_on_a_plane() -> None:
    scene, untouched = press(130.5, 80.5)
    relief = ofc.solve_relief(scene.pixels, params=ofc.ReliefParams(ball_radius=40))
    contact = relief.classes == ofc.ReliefClass.CONTACT
    assert contact[80, 150]
    assert relief.classes[0, 0] == ofc.ReliefClass.PLANE
    normals = relief.normals()
    assert np.nanmedian(angles(normals * contact[..., None], scene.normals)) < 10
    assert np.nanmax(relief.uncertainty()) > 0
    assert relief.scale_source is ofc.Scale.BALL
    assert "contact" in repr(relief)
    assert len(relief.plot().axes) == 5
    known = ofc.solve_relief(scene.pixels, untouched.pixels, params=ofc.ReliefParams(ball_radius=40))
    assert known.has_background
    assert np.isfinite(known.normals()).any()
    with pytest.raises(ofc.Refused, match="nothing differs") as flat:
        ofc.solve_relief(untouched.pixels)
    assert isinstance(flat.value.result, ofc.Relief)
    assert flat.value.result.reason is ofc.NoRelief.UNTOUCHED


def test_frames_of_a_rig_add_up() -> None:
    places = [(60.5, 60.5), (180.5, 60.5), (120.5, 90.5), (60.5, 120.5), (180.5, 120.5)]
    presses = [press(x, y, seed)[0] for seed, (x, y) in enumerate(places)]
    one, other = ofc.Rig(240, 180), ofc.Rig(240, 180)
    for scene in presses[:3]:
        assert one.add(scene.pixels) is ofc.NoRelief.NONE
    for scene in presses[3:]:
        assert other.add(scene.pixels) is ofc.NoRelief.NONE
    assert other.add(press(60.5, 60.5)[1].pixels) is ofc.NoRelief.UNTOUCHED
    one.merge(pickle.loads(pickle.dumps(other)))
    assert (one.frames, one.balls) == (5, 0)
    without_balls = one.solve()
    assert without_balls.terms == 3
    assert one.add(presses[2].pixels, center=places[2], params=ofc.ReliefParams(ball_radius=40)) is ofc.NoRelief.NONE
    model = one.solve()
    assert model.balls == 1
    assert model.scale_source is ofc.Scale.BALL
    assert "5 frames" in repr(without_balls)
    frame = presses[0]
    classes = model.classify(frame.pixels)
    contact = classes == ofc.ReliefClass.CONTACT
    sigma = np.empty(contact.shape, np.float32)
    normals = model.normals(frame.pixels, classes=classes, uncertainty=sigma)
    assert (model.normals(frame.pixels) == normals)[contact].all()
    assert np.median(angles(normals * contact[..., None], frame.normals)) < 6
    assert (sigma[contact] > 0).all()
    depth = ofc.integrate(np.nan_to_num(normals)).depth
    mask = np.empty(classes.shape, np.uint8)
    pressed = ofc.measure_contact(classes, depth, pixel_size=0.5, mask=mask)
    assert pressed is not None
    assert pressed.area == 0.25 * np.count_nonzero(mask)
    assert np.hypot(*(pressed.center - places[0])) < 3
    assert pressed.peak > 0
    assert "high" in repr(pressed)
    assert ofc.measure_contact(np.full_like(classes, ofc.ReliefClass.PLANE), depth) is None
    kept = ofc.RigModel.from_bytes(model.to_bytes())
    assert (kept.normals(frame.pixels) == model.normals(frame.pixels))[contact].all()
    with pytest.raises(ofc.Error):
        ofc.RigModel.from_bytes(model.to_bytes()[:-1])
    background = np.full((*classes.shape, 3), np.nan, np.float32)
    untouched = press(60.5, 60.5)[1].pixels
    ofc.follow_background(background, untouched)
    assert (background == untouched).all()
    ofc.follow_background(background, frame.pixels, classes, rate=0.5)
    assert (background[contact] == untouched[contact]).all()
    one.set_scale(model, 1.1, 0.05)
    with pytest.raises(ofc.Refused):
        ofc.Rig(240, 180).solve()
    with pytest.raises(ofc.Error):
        one.add(frame.pixels[1:])


def test_two_materials_are_two_regions() -> None:
    depth, mask = dome(120, 120)
    directions = LIGHTS / np.linalg.norm(LIGHTS, axis=1, keepdims=True)
    one = ofc.render(depth, directions, COLORS, mask).pixels
    other = ofc.render(depth, directions, COLORS[:, ::-1] * [0.4, 1, 0.7], mask).pixels
    both = np.concatenate([one, other], axis=1)
    found = ofc.segment(both)
    assert len(found.regions) >= 2
    assert found.labels[60, 60] != found.labels[60, 180]
    assert found.regions[0].pixel_count == np.count_nonzero(found.labels == found.regions[0].label)
    assert "region 1" in repr(found)
    assert len(found.plot().axes) == 1
    light, surface = ofc.classify_patches(one, mask, side=16, noise=0.5)
    assert light.shape == surface.shape == (8, 8)
    assert light[4, 4] == surface[4, 4] == 3
    with pytest.raises(ofc.Error):
        ofc.classify_patches(one, side=0, noise=0.5)


def test_a_stream_finds_the_same_and_follows(scene: ofc.Rendering) -> None:
    stream = ofc.Stream(120, 90)
    frames = [stream.frame(scene.pixels) for _ in range(4)]
    assert frames[0].was is ofc.Pass.COLORS
    assert frames[0].normals is None
    assert frames[-1].was is ofc.Pass.REFINE
    assert frames[-1].normals is not None
    assert np.median(angles(frames[-1].normals, scene.normals)) < 4
    assert stream.drift().refined
    solution = stream.solution(scene.pixels)
    # A picture's normals are computed in single precision, a row's in double.
    assert np.allclose(solution.normals(), frames[-1].normals, rtol=0, atol=1e-5)
    row = scene.pixels[45:46]
    assert (stream.normals_row(row) == frames[-1].normals[45]).all()
    packed = np.rint(255 * (frames[-1].normals[45].astype(np.float64) + 1) / 2)
    flags = stream.inliers_row(row)
    assert (flags == (frames[-1].normals[45] != 0).any(axis=-1)).all()
    assert np.abs(stream.normals_row_packed(row)[flags] - packed[flags]).max() <= 1
    planes = [np.ascontiguousarray(scene.pixels[..., c]) for c in range(3)]
    assert stream.frame(planes).normals is not None
    black = stream.frame(np.zeros_like(scene.pixels))
    assert black.status is not ofc.Status.OK
    assert black.normals is None
    stream.restart()
    assert stream.begin() is ofc.Pass.COLORS
    stream.row(0, row)
    with pytest.raises(ofc.Error) as error:
        stream.row(7, row)
    assert error.value.status is ofc.Status.ROW_ORDER
    with pytest.raises(ofc.Error):
        stream.end()
    with pytest.raises(ValueError, match="119"):
        stream.normals_row(row[:, :119])
    with pytest.raises(ValueError, match="frames have"):
        stream.frame(scene.pixels[1:])
    with pytest.raises(ValueError, match="dtype"):
        ofc.Stream(120, 90, np.int64)


def test_lights_and_surfaces_that_do_not_fit_are_refused() -> None:
    depth = np.zeros((5, 5), np.float32)
    with pytest.raises(ValueError, match="lights, 3"):
        ofc.render(depth, LIGHTS, COLORS[:2])
    with pytest.raises(ValueError, match="dtype"):
        ofc.render(depth, LIGHTS, COLORS, dtype=np.int8)
    with pytest.raises(ofc.Error):
        ofc.render(depth * np.nan, LIGHTS / np.linalg.norm(LIGHTS, axis=1, keepdims=True), COLORS)


def test_results_show_themselves(scene: ofc.Rendering) -> None:
    solution = ofc.solve(scene.pixels)
    depth = ofc.integrate(solution.normals())
    assert "inliers" in repr(solution)
    assert repr(solution) != repr(depth)
    assert solution._repr_html_().startswith("<table>")
    assert "pixels" in depth._repr_html_()
    assert repr(ofc.Picture(scene.pixels, scene.normals[..., 2] > 0)) == "<Picture 120 x 90, RGB of uint8, masked>"
    for figure in (solution.plot(), depth.plot(), scene.plot()):
        assert figure.axes
    assert ofc.normal_map(scene.normals)[45, 60].tolist() == pytest.approx([127, 127, 255], abs=2)
    assert (ofc.normal_map(scene.normals)[0, 0] == 0).all()


def test_normal_maps_are_of_normals(scene: ofc.Rendering) -> None:
    normals = scene.normals
    assert ofc.normal_map(normals).shape == normals.shape
    several: list[Any] = [normals[0], normals[..., :2], normals[..., 0], np.zeros((4, 5, 6, 3)), normals * 3]
    for wrong in [*several, (normals * 100).astype(np.int32)]:
        with pytest.raises(ValueError, match="normals"):
            ofc.normal_map(wrong)
