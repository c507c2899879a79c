"""Sensitivities against finite differences through the real triangulation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.rig.arrays import Array
from rigsim.rig.perturbation import NAMES, Perturbation
from rigsim.rig.stereo import StereoRig
from rigsim.theory.sensitivity import depth_sensitivity
from rigsim.theory.triangulation import triangulate
from tests.helpers.sampling import PLAIN, RIGS, close, points_in_view, rectified_rigs, rigs

STEPS = {
    "yaw_rad": 1e-6,
    "pitch_rad": 1e-6,
    "roll_rad": 1e-6,
    "baseline_m": 1e-6,
    "axial_m": 1e-6,
    "vertical_m": 1e-6,
    "right_focal_px": 1e-3,
    "right_cx_px": 1e-3,
    "right_k1": 1e-5,
    "both_k1": 1e-5,
}


def finite_difference(rig: StereoRig, points: Array, name: str) -> Array:
    """Depth (N,) the assumed rig finds per unit of a perturbation of the true one."""
    above, below = (
        triangulate(rig, *Perturbation(**{name: step}).apply(rig).project(points))[:, 2]
        for step in (STEPS[name], -STEPS[name])
    )
    return (above - below) / (2 * STEPS[name])


def agree(actual: Array, expected: Array, scale: Array) -> None:
    """To 1e-4, and to 1e-6 of the depth per pixel where the two nearly cancel."""
    close(actual, expected, rtol=1e-4, atol=1e-6 * float(scale.max()))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", RIGS)
def test_ten_sensitivities_of_every_kind_of_rig(kind: str, name: str) -> None:
    rig = RIGS[kind]
    points = points_in_view(rig, 100, 1.0, 5.0)
    predicted = depth_sensitivity(rig, points)
    agree(predicted[name], finite_difference(rig, points, name), np.abs(predicted["right_cx_px"]))


@given(rigs(distorted=True), st.sampled_from(NAMES), st.integers(0, 2**32 - 1))
def test_ten_sensitivities_of_any_rig(rig: StereoRig, name: str, seed: int) -> None:
    points = points_in_view(rig, 10, 1.0, 5.0, seed)
    predicted = depth_sensitivity(rig, points)
    agree(predicted[name], finite_difference(rig, points, name), np.abs(predicted["right_cx_px"]))


def rectified_depth_sensitivity(rig: StereoRig, points_left: object) -> dict[str, np.ndarray]:
    """By hand, for rectified rigs: x and y are the right camera's ``X/Z``, ``Y/Z``."""
    points = np.asarray(points_left, dtype=np.float64)
    B, f = rig.baseline_m, rig.right.fx
    with np.errstate(all="ignore"):
        X, Y, Z = np.where(points[:, 2] > 0, points.T, np.nan)
        x, x_left, y = (X - B) / Z, X / Z, Y / Z
        per_angle = Z**2 / B
        r2, r2_left = x**2 + y**2, x_left**2 + y**2
    result = {
        "yaw_rad": -per_angle * (1 + x**2),
        "pitch_rad": per_angle * x * y,
        "roll_rad": per_angle * y,
        "baseline_m": -Z / B,
        "axial_m": Z * x / B,
        "vertical_m": 0 * Z,
        "right_focal_px": per_angle * x / f,
        "right_cx_px": per_angle / f,
        "right_k1": per_angle * x * r2,
        "both_k1": per_angle * (x * r2 - x_left * r2_left),
    }
    return {name: result[name] for name in NAMES}


@given(rectified_rigs(), st.integers(0, 2**32 - 1))
def test_closed_forms_are_the_general_ones(rig: StereoRig, seed: int) -> None:
    points = points_in_view(rig, 10, 1.0, 5.0, seed)
    general, closed = depth_sensitivity(rig, points), rectified_depth_sensitivity(rig, points)
    assert tuple(general) == tuple(closed) == NAMES
    for name in NAMES:
        close(closed[name], general[name], rtol=1e-7, atol=1e-9)


def test_signs_by_hand() -> None:
    # the right camera's axis: x = y = 0; Z = 5 m, B = 0.1 m, so a tenth of a degree of yaw is 0.44 m
    rig = StereoRig.rectified(PLAIN, 0.1)
    on_axis = depth_sensitivity(rig, [[0.1, 0.0, 5.0]])
    close(on_axis["yaw_rad"] * np.radians(0.1), [-250 * np.radians(0.1)])
    close(on_axis["yaw_rad"] * np.radians(0.1), [-0.436], rtol=1e-3)
    close(on_axis["baseline_m"], [-50.0])
    close(on_axis["right_cx_px"], [25 / 80])
    for name in ("pitch_rad", "roll_rad", "axial_m", "vertical_m", "right_focal_px", "right_k1"):
        close(on_axis[name], [0.0], atol=1e-9)
    # 1 m to the right and 0.5 m below that axis, 4 m ahead: x = 0.25, y = 0.125
    beside = depth_sensitivity(rig, [[1.1, 0.5, 4.0]])
    close(beside["pitch_rad"], [160 * 0.25 * 0.125])
    close(beside["roll_rad"], [160 * 0.125])
    close(beside["axial_m"], [4 * 0.25 / 0.1])
    close(beside["right_focal_px"], [160 * 0.25 / 800])
    close(beside["right_k1"], [160 * 0.25 * (0.25**2 + 0.125**2)])


def test_behind_a_camera_there_is_no_sensitivity() -> None:
    rig = RIGS["rectified"]
    for sensitivity in (depth_sensitivity, rectified_depth_sensitivity):
        for value in sensitivity(rig, [[0.0, 0.0, -1.0], [0.0, 0.0, 0.0]]).values():
            assert np.isnan(value).all()
