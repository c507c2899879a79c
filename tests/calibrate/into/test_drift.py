"""What changes after a calibration, held to hand and to rigs that are built so."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.pose import Pose
from rigsim.rig.presets import preset
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.drift import CAUSES, FOCAL_PER_K, REFOCUS_SHARE, Drift, drift
from rigsim.theory.triangulation import triangulate

RIG = StereoRig.rectified(Intrinsics.from_focal(1280, 960, 1000.0), 0.1)


def _of(rows: tuple[Drift, ...], cause: str) -> Drift:
    return next(row for row in rows if row.cause == cause)


def test_by_hand_on_a_plain_rig() -> None:
    rows = drift(RIG, (1.0, 4.0))
    assert tuple(row.cause for row in rows) == CAUSES
    # a longer baseline or focal length makes disparities larger: depths read short, by the same share
    assert _of(rows, "bar_warmer").axis_m == pytest.approx((-23e-6, -4 * 23e-6), rel=1e-9)
    assert _of(rows, "lenses_warmer").axis_m == pytest.approx((-30e-6, -4 * 30e-6), rel=1e-9)
    # the right camera turned to the right sees things further left: larger disparities, Z^2 / (f B) of f a
    knock = _of(rows, "knock")
    angle = math.radians(0.01)
    assert (knock.amount, knock.unit) == (0.01, "deg")
    by_hand = [-(z**2) / 100 * 1000 * angle * (1 + (0.1 / z) ** 2) for z in (1.0, 4.0)]
    assert knock.axis_m == pytest.approx(by_hand, rel=1e-9)
    assert _of(rows, "refocus").axis_m == pytest.approx((-1e-3, -4e-3), rel=1e-9)


def test_over_the_image_one_lens_that_is_focused_anew_does_far_more_than_on_the_axis() -> None:
    refocus = _of(drift(RIG, (4.0,)), "refocus")
    assert refocus.image_m[0] > 5 * abs(refocus.axis_m[0])
    bar = _of(drift(RIG, (4.0,)), "bar_warmer")
    assert bar.image_m[0] == pytest.approx(abs(bar.axis_m[0]), rel=1e-9)


def test_a_rig_built_so_reads_what_is_said() -> None:
    camera = preset("oak-d").rig.left
    rig = StereoRig(
        camera,
        replace(camera, fx=1.01 * camera.fx, cx=camera.cx + 12),
        Pose.from_rotvec((0.01, -0.05, 0.02), (-0.075, 0.002, 0.004)),
    )
    point = np.array([[0.0, 0.0, 2.0]])
    # a hundredth of each change, so that the second order is nothing
    small = 0.01
    built = {
        "bar_warmer": Perturbation(baseline_m=small * 23e-6 * rig.baseline_m).apply(rig),
        "knock": Perturbation(yaw_rad=small * math.radians(0.01)).apply(rig),
        "refocus": Perturbation(right_focal_px=small * REFOCUS_SHARE * rig.right.fx).apply(rig),
        "lenses_warmer": replace(
            rig, left=_longer(rig.left, small * FOCAL_PER_K), right=_longer(rig.right, small * FOCAL_PER_K)
        ),
    }
    for row in drift(rig, (2.0,)):
        read = triangulate(rig, *built[row.cause].project(point))[0, 2] - 2.0
        assert read == pytest.approx(small * row.axis_m[0], rel=1e-3), row.cause


def test_where_the_cameras_share_no_part_there_is_none_over_the_image() -> None:
    wide = StereoRig.rectified(Intrinsics.from_focal(640, 480, 900.0), 3.0)
    rows = drift(wide, (0.5, 20.0))
    assert all(math.isnan(row.image_m[0]) and row.image_m[1] > 0 for row in rows)


def _longer(camera: Intrinsics, share: float) -> Intrinsics:
    return replace(camera, fx=camera.fx * (1 + share), fy=camera.fy * (1 + share))
