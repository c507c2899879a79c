"""Rows of built rigs: by hand, against pairs rectified by `rigsim.pixels`, and bound in the yields."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import rigsim
from rigsim.cli.app import run
from rigsim.errors import InvalidRange
from rigsim.pixels.dense.rectify import rectify
from rigsim.present.tolerance.console import quantity_heads, quantity_rows
from rigsim.present.tolerance.words import rows_sentence
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.presets import PRESETS
from rigsim.rig.stereo import StereoRig
from rigsim.study.design.buildable import expected
from rigsim.study.tolerance.batch import PARAMETERS, RigBatch, read_rays
from rigsim.study.tolerance.classes import CLASSES
from rigsim.study.tolerance.count import count_good
from rigsim.study.tolerance.first_order.predicted import expect
from rigsim.study.tolerance.rows import first_order_rows, row_errors_px
from rigsim.study.tolerance.run import Build, Recalibration, run_tolerance
from rigsim.study.tolerance.sensitivities import (
    BuildRequirement,
    Tolerances,
    causes,
    on_plane,
    sensitivities,
    shared_points,
)
from tests.helpers.sampling import RIGS, close, points_in_view

RIG = PRESETS["boards"].rig
RANGE = (1.0, 5.0)
KINDS = sorted(kind for kind, rig in RIGS.items() if kind != "forward")


def rows_px(assumed: StereoRig, left: Array, right: Array) -> Array:
    found = rectify(assumed)
    rows = []
    for uv, camera, turn in (
        (left, assumed.left, found.rectified_from_left),
        (right, assumed.right, found.rectified_from_right),
    ):
        rays = np.column_stack([camera.normalize(uv), np.ones(len(uv))]) @ turn.T
        rows.append(found.rig.left.fy * rays[:, 1] / rays[:, 2])
    return np.asarray(rows[1] - rows[0])


def test_3_mm_too_low_is_off_the_row_by_2_7_px_at_1_m() -> None:
    off = causes(RIG, Tolerances(vertical_mm=3.0, right_cy_px=0.5, yaw_deg=0.1))
    planes = {depth_m: shared_points(RIG, depth_m, 60) for depth_m in (1.0, 3.0, 5.0)}
    held = sensitivities(RIG, off, planes, BuildRequirement(0.05, 3.0))
    by_key = {item.key: item for item in held}
    close([by_key["vertical_mm"].row_px, by_key["vertical_mm"].row_largest_px], [0.9, 2.7])  # 2.7 px m / Z
    close([by_key["right_cy_px"].row_px, by_key["right_cy_px"].row_largest_px], [0.5, 0.5])
    assert by_key["vertical_mm"].needed_alone == np.inf
    # with a bound: 1.96 sigma x 900 px / 1 m = 0.5 px, and 1.96 sigma = 0.5 px
    bound = BuildRequirement(0.05, 3.0, row_px=0.5)
    by_key = {item.key: item for item in sensitivities(RIG, off, planes, bound)}
    close(by_key["vertical_mm"].needed_alone, 0.5 / 900 / 1.95996 * 1e3, rtol=1e-4)
    close(by_key["right_cy_px"].needed_alone, 0.5 / 1.95996, rtol=1e-4)
    assert all(by_key[key].is_held_by_rows for key in ("vertical_mm", "right_cy_px"))
    assert not by_key["yaw_deg"].is_held_by_rows
    # noise alone is too much: nothing helps
    by_key = {item.key: item for item in sensitivities(RIG, off, planes, bound, noise_px=1.0)}
    assert by_key["vertical_mm"].needed_alone == by_key["vertical_mm"].needed_equal_share == 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_batches_are_single_pairs_rectified(kind: str) -> None:
    rig = RIGS[kind]
    points = points_in_view(rig, 40, 1.0, 5.0)
    theta = np.zeros((2, len(PARAMETERS)))
    theta[1, [1, 2, 4, 5, 10]] = [2e-3, -3e-3, 1e-3, 2e-3, 1.5]  # pitch, roll, axial, vertical, cy
    pixels = RigBatch(rig, theta).project(points)
    rays = read_rays(rig, pixels)
    found = row_errors_px(RigBatch(rig, np.zeros((1, len(PARAMETERS)))), rays)
    assert np.abs(found[0]).max() < 1e-6
    close(found[1], rows_px(rig, pixels[:2, 1].T, pixels[2:, 1].T), rtol=1e-6, atol=1e-6)
    assert np.abs(found[1]).max() > 1.0
    # with its own calibration every pair is on its rows
    batch = RigBatch(rig, theta)
    assert np.abs(row_errors_px(batch, batch.rays(pixels, rays))).max() < 1e-6


def test_left_lens_of_a_verged_rig() -> None:
    # what a depth takes for the right camera's error turns the left picture's rows the other way
    rig = StereoRig.verged(RIG.left, 0.12, 10.0)
    off = causes(rig, Tolerances(left_cx_px=1.0, left_cy_px=1.0, left_focal_px=1.0))
    points = shared_points(rig, 2.0, 50)
    found = first_order_rows(rig, off, points)
    left, right = rig.project(points)
    lens = rig.left
    longer = replace(lens, fx=lens.fx + 1e-3, fy=lens.fy + 1e-3)
    shifted = {
        "left_focal_px": longer.project(points),
        "left_cx_px": left + np.array([1e-3, 0.0]),
        "left_cy_px": left + np.array([0.0, 1e-3]),
    }
    for place, key in enumerate(off.keys):
        close(1e-3 * found[:, place], rows_px(rig, shifted[key], right), rtol=1e-3, atol=1e-7)


def test_a_yield_within_rows_by_hand() -> None:
    # 900 px x 0.3 mm / 1 m = 0.27 px: of a normal 68.3 % are within one standard deviation
    required = BuildRequirement(0.2, 5.0, row_px=0.27)
    build = Build(RIG, Tolerances(vertical_mm=0.3))
    result = run_tolerance(build, required, RANGE, n_rigs=4000, n_points=80)
    assert result.yield_before == pytest.approx(0.6827, abs=0.003)
    assert result.rows_worst.depth_m == 1.0
    close(result.rows_worst.built.row_rms_px, 0.27, rtol=0.01)
    close(result.rows_worst.first_order_row_px, 0.27)
    close([item.first_order_row_px for item in result.depths], [0.27, 0.09, 0.054])
    assert count_good(build, required, RANGE).share == pytest.approx(0.6827, abs=0.01)
    found = expect(build, required, RANGE)
    assert (found.good, found.limited_by) == (pytest.approx(0.6827, abs=0.01), "vertical_mm")
    # judged at the far end alone it would be within; without a bound it is
    assert run_tolerance(build, replace(required, row_px=None), RANGE, n_rigs=500).yield_before == 1.0


def test_equal_shares_keep_depth_and_rows_at_once() -> None:
    off = Tolerances(yaw_deg=0.01, pitch_deg=0.01, vertical_mm=0.03, right_cx_px=0.1, right_cy_px=0.1)
    required = BuildRequirement(0.03, 3.0, row_px=0.3)
    needed = run_tolerance(Build(RIG, off), required, RANGE, n_rigs=10).sensitivities
    held = {item.key: item.needed_equal_share for item in needed}
    assert all(np.isfinite(value) for value in held.values())
    found = run_tolerance(Build(RIG, Tolerances(**held)), required, RANGE, n_rigs=4000, n_points=120)
    assert found.yield_before == pytest.approx(0.95, abs=0.012)


def test_recalibration_brings_rows_together() -> None:
    build = Build(RIG, Tolerances(pitch_deg=0.5, roll_deg=0.5, vertical_mm=3.0), 0.0, Recalibration())
    required = BuildRequirement(0.2, 5.0, row_px=0.5)
    result = run_tolerance(build, required, RANGE, n_rigs=60, n_points=60, with_interactions=False)
    before, after = (result.rows_px(state) for state in ("built", "recalibrated"))
    assert before is not None
    assert after is not None
    assert np.median(before) > 3.0
    assert after.max() < 0.3  # 0.079 px of noise a coordinate, on 60 features
    assert result.yield_before < 0.1
    assert result.yield_after == 1.0
    assert count_good(build, required, RANGE, sizes=[60]).share == 1.0


def test_what_breaks_the_rows_first_is_named_with_how_much_of_it() -> None:
    # by hand: 0.5 px / 1.96 of the principal point, 0.2551 px of the 0.5 px that it has; 0.2834 mm of 3 mm
    off = Tolerances(vertical_mm=3.0, right_cy_px=0.5, yaw_deg=0.1)
    required = BuildRequirement(0.05, 3.0, row_px=0.5)
    result = run_tolerance(Build(RIG, off), required, RANGE, n_rigs=20, n_points=40, with_interactions=False)
    said = rows_sentence(result)
    assert "What breaks them first, alone, is vertical shift (over 0.283 mm, the class has 3), then " in said
    assert "then right principal point v (over 0.255 px, the class has 0.5)." in said
    cells = {row[0]: row for row in quantity_rows(result)}
    at = quantity_heads(result).index("held\nby")
    assert [cells[name][at] for name in ("vertical shift", "yaw")] == ["rows", "depth"]
    free = replace(required, row_px=None)
    result = run_tolerance(Build(RIG, off), free, RANGE, n_rigs=20, n_points=40, with_interactions=False)
    assert "held\nby" not in quantity_heads(result)
    assert "breaks" not in rows_sentence(result)


def test_the_command_tells_rows(capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "tolerance",
        "--class",
        "none",
        "--tolerance",
        "vertical=3mm",
        "--tolerance",
        "yaw=0.01",
        "--rigs",
    ]
    words += ["400", "--points", "60", "--no-recalibrate", "--range", "1:5m"]
    assert run([*words, "--json", "--max-row-error", "2.7px"]) == 0
    said = json.loads(capsys.readouterr().out)
    rows = {row["quantity"]: (row["row_px"], row["row_largest_px"]) for row in said["quantities"]}
    assert rows["vertical_mm"] == pytest.approx((0.54, 2.7))
    assert said["required"]["row_px"] == 2.7
    assert said["rows"]["distance_mm"] == 1000.0
    assert said["rows"]["as_built_px"] == pytest.approx(2.7, rel=0.02)
    assert said["rows"]["not_rectified_px"] == pytest.approx(said["rows"]["as_built_px"])
    assert said["rows"]["recalibrated_px"] is None
    assert said["rows"]["kept"]["as_built"] == pytest.approx(0.683, abs=0.01)
    assert said["depths"][0]["simulated_row_px"] == pytest.approx(2.7, rel=0.02)
    assert said["depths"][0]["per_rig_row_p50_px"] == pytest.approx(2.7 * 0.6745, rel=0.03)
    assert run(words) == 0
    assert "without" not in capsys.readouterr().out  # a rectified rig's pairs are what they are


@pytest.mark.parametrize("value", ["0px", "-1px", "1mm"])
def test_a_bound_that_cannot_be(value: str, capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["tolerance"], ["design", "--range", "1:3m", "--depth-error", "30mm"]):
        assert run([*words, f"--max-row-error={value}"]) == 2
        assert "row error" in capsys.readouterr().err
    with pytest.raises(InvalidRange, match="row misalignment 0 px: must be > 0"):
        rigsim.tolerance("oak-d", max_row_error_px=0.0)


def test_design_counts_rows_in_the_yield() -> None:
    found = rigsim.design(
        range_m=(1, 3),
        depth_error_mm=60,
        resolutions_px=(1280, 720),
        lenses_deg=60,
        proof=False,
        tolerance_class="calibrated",
        max_row_error_px=0.35,
    )
    document = found.document()
    # 0.27 px from the two principal points, 0.19 px from pitch, and more from the lenses: half are within
    of_class = document["tolerance"]["yield"]["calibrated"]["as_built"]
    assert 0.3 < of_class < 0.7
    assert "rows within 0.35 px at every distance" in document["tolerance"]["says"]
    assert document["tolerance"]["required"]["row_px"] == 0.35
    bound = found.found.specification
    for row_px, least, most in ((0.35, of_class - 0.05, of_class + 0.05), (None, 0.97, 1.0)):
        share = expected(found.rig, replace(bound, row_px=row_px), "calibrated", recalibrated=False)
        assert share is not None
        assert least < share.good <= most
    # what a bound fails most for is what limits
    assert expected(found.rig, bound, "calibrated", False).limited_by == "right_cy_px"


def test_of_a_fisheye_places_within_60_degrees_are_judged_and_no_k1() -> None:
    lens = Intrinsics(640, 640, 190.0, 190.0, 319.5, 319.5, KannalaBrandt())
    rig = StereoRig.rectified(lens, 0.1)
    # 190 px a radian: 59 and 61 degrees lie 195.7 and 202.3 px from the middle
    points = on_plane(rig, np.array([[319.5 + 195.6, 319.5], [319.5 + 202.3, 319.5]]), np.array([2.0, 2.0]))
    assert points[0] == pytest.approx([2 * np.tan(195.6 / 190), 0, 2])
    assert np.isnan(points[1, :2]).all()
    flat = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0), 0.1)
    for kind in CLASSES.values():
        assert kind.tolerances(rig).right_k1 == kind.tolerances(rig).both_k1 == 0
        assert kind.tolerances(flat).right_k1 > 0
        assert kind.tolerances(rig).yaw_deg == kind.tolerances(flat).yaw_deg
