"""Each perturbation moves the right image the way its docstring says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.rig.perturbation import NAMES, Perturbation
from rigsim.rig.stereo import StereoRig
from tests.helpers.sampling import PLAIN, RIGS, close, rigs

ASSUMED = StereoRig.rectified(PLAIN, 0.1)
# one metre right and half a metre down of the right camera, 4 m ahead: x = 0.25, y = 0.125
POINT = np.array([[1.1, 0.5, 4.0]])
F = 800.0


def shift(**perturbation: float) -> np.ndarray:
    """How far the right image of POINT moves, per unit, px."""
    (value,) = perturbation.values()
    moved = Perturbation(**perturbation).apply(ASSUMED).project(POINT)[1] - ASSUMED.project(POINT)[1]
    return moved[0] / value


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        # turned right, the world moves left: -(1 + x^2), -xy
        ("yaw_rad", (-F * (1 + 0.25**2), -F * 0.25 * 0.125)),
        # turned up, the world moves down: +(1 + y^2)
        ("pitch_rad", (F * 0.25 * 0.125, F * (1 + 0.125**2))),
        # turned clockwise, the world turns counter-clockwise: (y, -x)
        ("roll_rad", (F * 0.125, -F * 0.25)),
        ("baseline_m", (-F / 4, 0.0)),
        # nearer, everything grows away from the middle
        ("axial_m", (F * 0.25 / 4, F * 0.125 / 4)),
        ("vertical_m", (0.0, -F / 4)),
        ("right_focal_px", (0.25, 0.125)),
        ("right_cx_px", (1.0, 0.0)),
        ("right_k1", (F * 0.25 * (0.25**2 + 0.125**2), F * 0.125 * (0.25**2 + 0.125**2))),
        ("both_k1", (F * 0.25 * (0.25**2 + 0.125**2), F * 0.125 * (0.25**2 + 0.125**2))),
    ],
)
def test_the_right_image_moves_by_hand(name: str, expected: tuple[float, float]) -> None:
    close(shift(**{name: 1e-7}), expected, rtol=1e-5, atol=1e-4)


def test_only_both_k1_touches_the_left_camera() -> None:
    for name in NAMES:
        moved = Perturbation(**{name: 1e-3}).apply(ASSUMED).project(POINT)[0]
        change = float(np.abs(moved - ASSUMED.project(POINT)[0]).max())
        assert (change > 1e-3) == (name == "both_k1")


def test_a_longer_baseline_is_longer() -> None:
    for rig in RIGS.values():
        close(Perturbation(baseline_m=0.01).apply(rig).baseline_m, rig.baseline_m + 0.01)


@given(rigs(distorted=True))
def test_no_perturbation_is_the_same_rig(rig: StereoRig) -> None:
    same = Perturbation().apply(rig)
    assert (same.left, same.right) == (rig.left, rig.right)
    close(same.right_from_left.R, rig.right_from_left.R, atol=1e-15)
    close(same.right_from_left.t, rig.right_from_left.t, atol=1e-15)


def test_the_names_are_the_ten_fields() -> None:
    assert len(NAMES) == 10
    assert NAMES[0] == "yaw_rad"
    with pytest.raises(InvalidRig, match="perturbation roll_rad nan: must be a finite number"):
        Perturbation(roll_rad=math.nan)
