"""Which error of the right camera is named for rows that do not correspond, and with what amount."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rigsim.present.measure.words import sentence
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.result import PairMatches
from rigsim.study.measure.rows import row_verdict
from rigsim.theory.triangulation import triangulate

RIG = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 900.0), 0.12)


def said(off: Perturbation) -> str:
    """What is said of matches on a wall at 1 m that a rig off by `off` sees."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.6, 20), np.linspace(-0.35, 0.35, 15))
    wall = np.column_stack([x.ravel(), y.ravel(), np.ones(x.size)])
    left, right = off.apply(RIG).project(wall)
    noise = 0.02 * np.random.default_rng(0).standard_normal(len(wall))
    unknown, none = np.full(len(wall), math.nan), np.full(len(wall), -1, dtype=np.int32)
    matches = PairMatches(
        kind="patches",
        n_tried=len(wall),
        uv_left=left,
        uv_right=right,
        disparity_std_px=np.full(len(wall), 0.03),
        epipolar_px=right[:, 1] - left[:, 1] + noise,
        score=np.ones(len(wall)),
        points_left=triangulate(RIG, left, right),
        depth_std_m=np.full(len(wall), 1e-3),
        board=none,
        corner=none,
        truth_px=unknown,
        depth_error_m=unknown,
        errors=None,
    )
    return sentence(row_verdict(matches, RIG), RIG)


def test_a_shift_is_so_many_mm_or_so_many_deg() -> None:
    # 3 mm too low at 1 m: 2.7 px too high, and 2.7 / 900 rad = 0.17 deg of looking down
    says = said(Perturbation(vertical_m=3e-3))
    assert "2.70 px too high, as if its camera looked down by 0.17 deg more" in says
    assert "A right camera that stands 3.0 mm lower, at 1.00 m, makes such rows too." in says


@pytest.mark.parametrize(
    ("off", "words"),
    [
        (Perturbation(roll_rad=math.radians(0.2)), "is rolled clockwise by 0.2 deg"),
        (Perturbation(roll_rad=math.radians(-0.2)), "is rolled counter-clockwise by 0.2 deg"),
        (Perturbation(right_focal_px=9.0), "has a focal length 9 px longer"),
        (Perturbation(right_focal_px=-9.0), "has a focal length 9 px shorter"),
    ],
)
def test_a_turn_and_a_scale_are_named(off: Perturbation, words: str) -> None:
    assert f"A right camera that {words} makes such rows." in said(off)


def test_several_are_all_named() -> None:
    says = said(Perturbation(vertical_m=-2e-3, roll_rad=math.radians(0.3)))
    assert "looks up by 0.11 deg more or stands 2.0 mm higher, at 1.00 m" in says
    assert " and that is rolled clockwise by 0.3 deg makes such rows." in says
