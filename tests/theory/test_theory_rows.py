"""Row misalignment: hand-computed cases, laws, and rows of pairs that `rigsim.pixels` rectifies."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.pixels.dense.rectify import rectify, row_rotations
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.perturbation import NAMES, Perturbation
from rigsim.rig.stereo import StereoRig
from rigsim.theory.rows import row_axes, row_sensitivity
from tests.helpers.sampling import RIGS, close, points_in_view, rectified_rigs, rigs

LENS = Intrinsics.from_focal(1280, 720, 900.0)
RIG = StereoRig.rectified(LENS, 0.12)


def rows_px(rig: StereoRig, true: StereoRig, points: Array) -> Array:
    """Right row minus left row (N,) px of what `true` sees, in the pair that `rig` rectifies."""
    found = rectify(rig)
    seen = zip(
        true.project(points),
        (rig.left, rig.right),
        (found.rectified_from_left, found.rectified_from_right),
        strict=True,
    )
    rows = []
    for uv, camera, turn in seen:
        rays = np.column_stack([camera.normalize(uv), np.ones(len(uv))]) @ turn.T
        rows.append(found.rig.left.fy * rays[:, 1] / rays[:, 2])
    return np.asarray(rows[1] - rows[0])


def test_by_hand() -> None:
    # the point is 0.3 m right of the right camera and 0.2 m below it, at 1 m: (270, 180) px from the middle
    rows = row_sensitivity(RIG, [[0.42, 0.2, 1.0]])
    close(3e-3 * rows["vertical_m"], [-2.7])  # 900 px x 3 mm / 1 m, and a lower camera sees it higher
    close(math.radians(0.1) * rows["pitch_rad"], [(900 + 180**2 / 900) * math.radians(0.1)])  # 1.634 px
    close(math.radians(0.1) * rows["roll_rad"], [-270 * math.radians(0.1)])  # -0.471 px
    close(math.radians(0.1) * rows["yaw_rad"], [-270 * 180 / 900 * math.radians(0.1)])  # -0.094 px
    close(1e-3 * rows["axial_m"], [0.18])  # 1 mm nearer of 1 m is 0.1 % of 180 px
    close(9.0 * rows["right_focal_px"], [1.8])  # 1 % of 180 px
    close(rows["right_cy_px"], [1.0])
    close(rows["left_cy_px"], [-1.0])
    close(0.01 * rows["right_k1"], [0.01 * 180 * (270**2 + 180**2) / 900**2])  # 0.234 px
    # 0.42 m right of the left camera: 378 px
    left = 180 * (378**2 + 180**2) / 900**2
    close(0.01 * (rows["both_k1"] - rows["right_k1"]), [-0.01 * left])
    for name in ("baseline_m", "right_cx_px", "left_cx_px", "both_focal_px"):
        close(rows[name], [0.0], atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", sorted({*RIGS} - {"forward"}))
def test_every_kind_of_rig_against_a_rectified_pair(kind: str, name: str) -> None:
    rig = RIGS[kind]
    points = points_in_view(rig, 100, 1.0, 5.0)
    step = 1e-5
    high, low = (rows_px(rig, Perturbation(**{name: way * step}).apply(rig), points) for way in (1, -1))
    predicted = row_sensitivity(rig, points)[name]
    assert np.isfinite(predicted).all()
    close(predicted, (high - low) / (2 * step), rtol=1e-6, atol=1e-6)


@given(rigs(distorted=True), st.sampled_from(NAMES), st.integers(0, 2**32 - 1))
def test_rows_as_they_are_seen(rig: StereoRig, name: str, seed: int) -> None:
    points = points_in_view(rig, 10, 1.0, 5.0, seed)
    step = 1e-5
    rows = []
    for way in (1, -1):
        left, right = Perturbation(**{name: way * step}).apply(rig).project(points)
        rows.append(right[:, 1] - left[:, 1])
    seen = row_sensitivity(rig, points, rectified=False)[name]
    close(seen, (rows[0] - rows[1]) / (2 * step), rtol=1e-4, atol=1e-3)


@given(rectified_rigs(), st.integers(0, 2**32 - 1))
def test_a_rectified_rig_has_rows_already(rig: StereoRig, seed: int) -> None:
    points = points_in_view(rig, 10, 1.0, 5.0, seed)
    as_seen, rectified = (row_sensitivity(rig, points, rectified=either) for either in (False, True))
    for name in NAMES:
        close(as_seen[name], rectified[name])
    # a shift's rows go with one over the depth, a turn's do not
    twice = row_sensitivity(rig, 2 * points + rig.right_from_left.t)
    close(twice["vertical_m"], rectified["vertical_m"] / 2)


@given(rigs())
def test_axes_are_those_of_the_rectified_pictures(rig: StereoRig) -> None:
    of_left, _ = row_rotations(rig)
    across, forward = row_axes(rig.right_from_left.R, rig.right_from_left.t)
    close(across, of_left[1], atol=1e-12)
    close(forward, of_left[2], atol=1e-12)


def test_no_rows_along_the_line_of_sight() -> None:
    ahead = RIGS["forward"]
    assert np.isnan(row_sensitivity(ahead, [[0.1, 0.1, 2.0]])["pitch_rad"]).all()
    assert np.isnan(row_sensitivity(RIG, [[0.1, 0.1, -2.0]])["pitch_rad"]).all()
