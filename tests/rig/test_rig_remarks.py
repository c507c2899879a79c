"""What is odd about a rig: each remark where it is due, and not a little before."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.double_sphere import DoubleSphere
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.mei import Mei
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.pose import Pose
from rigsim.rig.presets import PRESETS
from rigsim.rig.stereo import StereoRig
from rigsim.study.rig.remarks import remarks_of_rig, unseen_share
from rigsim.study.rig.shape import arrangement, relative_turn_deg
from rigsim.theory.limits import overlap_at_depth

LENS = BrownConrady(-0.08, 0.01, 0.0003, -0.0002)
CAMERA = Intrinsics(1280, 720, 900.0, 902.0, 650.0, 350.0, LENS)


def rig(
    left: Intrinsics = CAMERA,
    right: Intrinsics | None = None,
    turn_deg: tuple[float, float, float] = (0.1, 0.5, -0.2),
    at_mm: tuple[float, float, float] = (120.0, 1.0, -2.0),
) -> StereoRig:
    """A pair whose right camera stands at a place of the left one's frame, its body turned about x, y, z."""
    left_from_right = Pose.from_rotvec(np.radians(turn_deg), np.array(at_mm) / 1e3)
    return StereoRig(left, right or left, left_from_right.inverse)


def codes(found: StereoRig) -> list[str]:
    return [remark.code for remark in remarks_of_rig(found)]


@pytest.mark.parametrize("name", PRESETS)
def test_nothing_is_odd_about_a_preset(name: str) -> None:
    assert codes(PRESETS[name].rig) == []


def test_nothing_is_odd_about_a_calibrated_pair() -> None:
    assert codes(rig()) == []
    assert codes(rig(at_mm=(0.0, 120.0, 3.0))) == []  # above each other
    assert codes(rig(at_mm=(0.0, -120.0, 3.0))) == []


@pytest.mark.parametrize(
    ("odd", "fine", "code"),
    [
        (rig(at_mm=(5100.0, 0.0, 0.0)), rig(at_mm=(4900.0, 0.0, 0.0)), "unit"),
        (rig(at_mm=(0.9, 0.0, 0.0)), rig(at_mm=(1.1, 0.0, 0.0)), "unit"),
        (rig(at_mm=(-120.0, 1.0, 2.0)), rig(at_mm=(120.0, 1.0, 2.0)), "swapped"),
        (rig(turn_deg=(0.0, 0.0, 178.0)), rig(turn_deg=(0.0, 0.0, 90.0)), "upside_down"),
        (rig(turn_deg=(0.0, 0.0, -178.0)), rig(turn_deg=(0.0, 0.0, -90.0)), "upside_down"),
    ],
)
def test_the_pose(odd: StereoRig, fine: StereoRig, code: str) -> None:
    assert codes(odd) == [code]
    assert codes(fine) == []


def _at(cx: float, cy: float, lens: BrownConrady | None = LENS) -> StereoRig:
    camera = Intrinsics(1280, 720, 900.0, 900.0, cx, cy, lens)
    return StereoRig.rectified(camera, 0.1)


@pytest.mark.parametrize(
    ("odd", "fine"),
    [
        (_at(639.5 + 141, 359.5), _at(639.5 + 115, 359.5)),  # 11 % and 9 % of the width
        (_at(639.5 - 141, 359.5), _at(639.5 - 115, 359.5)),
        (_at(639.5, 359.5 + 79), _at(639.5, 359.5 + 65)),  # 11 % and 9 % of the height
        (_at(639.5 + 269, 359.5, None), _at(639.5 + 243, 359.5, None)),  # rectified: 21 % and 19 %
    ],
)
def test_the_principal_point(odd: StereoRig, fine: StereoRig) -> None:
    assert set(codes(odd)) == {"principal_point"}
    assert codes(fine) == []
    assert "left camera" in remarks_of_rig(odd)[0].text


@pytest.mark.parametrize(
    ("width", "height", "calibrated"),
    [(640, 360, "1280x720"), (1920, 1080, "1280x720"), (1280, 960, "1280x720"), (640, 480, "1280x720")],
)
def test_a_calibration_of_another_size_says_which(width: int, height: int, calibrated: str) -> None:
    left = Intrinsics(width, height, 900.0, 902.0, 645.0, 352.0, LENS)
    right = Intrinsics(width, height, 905.0, 907.0, 632.0, 366.0, LENS)
    found = {remark.code: remark.text for remark in remarks_of_rig(rig(left, right))}
    assert f"about {calibrated} px, not of {width}x{height}" in found["size"]
    assert "principal_point" not in found


def test_focal_lengths_are_compared_where_they_are_the_same_thing() -> None:
    def longer(share: float) -> Intrinsics:
        return Intrinsics(1280, 720, 900.0 * share, 902.0 * share, 650.0, 350.0, LENS)

    assert codes(rig(right=longer(1.06))) == codes(rig(right=longer(0.94))) == ["focal_lengths"]
    assert codes(rig(right=longer(1.04))) == codes(rig(right=longer(0.96))) == []
    # one lens behind two grids, and one focal length in two models: 900 (1 + 0.8) is 900 on the axis
    assert codes(rig(right=CAMERA.resized(640, 360))) == []
    omni = Intrinsics(1280, 720, 900 * 1.8, 902 * 1.8, 650.0, 350.0, Mei(0.8, 0.0, 0.0, 0.0, 0.0))
    assert codes(rig(right=omni)) == []
    stretched = CAMERA.resized(1280, 660)
    assert codes(rig(stretched, stretched)) == ["focal_lengths", "focal_lengths"]


def test_focal_lengths_in_millimetres() -> None:
    def pair(focal: float) -> StereoRig:
        return rig(Intrinsics(1280, 720, focal, focal, 639.5, 359.5))

    # 1280 px are 170 deg wide at 640 / tan(85 deg) = 56 px
    assert codes(pair(55.0)) == ["focal_unit", "focal_unit"]
    assert codes(pair(57.0)) == []
    fisheye = Intrinsics(1280, 720, 55.0, 55.0, 639.5, 359.5, KannalaBrandt())
    assert "focal_unit" not in codes(rig(fisheye))  # its circle is small, no more


def test_a_pair_of_which_one_has_no_distortion() -> None:
    assert codes(rig(right=replace(CAMERA, lens=None))) == ["one_lens"]
    assert "right camera has no distortion" in remarks_of_rig(rig(right=replace(CAMERA, lens=None)))[0].text
    assert codes(rig(replace(CAMERA, lens=None), CAMERA)) == ["one_lens"]


def test_a_fold_by_hand() -> None:
    # r (1 + k1 r^2) turns back where 1 + 3 k1 r^2 = 0: k1 = -0.4 at r = 0.9129, 42.39 deg, where it is 0.6086
    lens = BrownConrady(-0.4)
    camera = Intrinsics(640, 480, 500.0, 500.0, 319.5, 239.5, lens)
    radius_px = 500 * math.sqrt(1 / 1.2) * 2 / 3
    u, v = np.meshgrid(np.arange(640), np.arange(480))
    outside = float((np.hypot(u - 319.5, v - 239.5) > radius_px).mean())
    share, angle_deg = unseen_share(camera)
    assert share == pytest.approx(outside, abs=0.01)
    assert angle_deg == pytest.approx(math.degrees(math.atan(math.sqrt(1 / 1.2))), abs=1.0)
    assert codes(rig(camera)) == ["fold", "fold"]
    longer = Intrinsics(640, 480, 700.0, 700.0, 319.5, 239.5, lens)  # 426 px, beyond the corner's 400
    assert unseen_share(longer) == (0.0, math.inf)
    assert codes(rig(longer)) == []
    # cut inside the circle nothing is lost: the way out that the remark names
    assert "--crop" in remarks_of_rig(rig(camera))[0].text
    assert remarks_of_rig(rig(camera), rig(camera).cropped(120, 90, 400, 300)) == ()


@pytest.mark.parametrize(
    "lens",
    [DoubleSphere(-0.2, 0.6), KannalaBrandt(0.01, -0.004, 0.0, 0.0)],
)
def test_a_fisheyes_circle_is_no_fold(lens: DoubleSphere | KannalaBrandt) -> None:
    camera = Intrinsics(640, 640, 110.0, 110.0, 322.0, 316.0, lens)
    assert unseen_share(camera)[0] > 0.05  # the corners are dark
    assert codes(rig(camera)) == []


def test_fields_of_view_that_do_not_meet() -> None:
    apart = rig(turn_deg=(0.0, 100.0, 0.0), at_mm=(120.0, 0.0, 0.0))
    assert codes(apart) == ["no_overlap"]
    inwards = rig(turn_deg=(0.0, -80.0, 0.0), at_mm=(120.0, 0.0, 0.0))  # they cross, and part again
    assert overlap_at_depth(inwards, 10.0).fraction == 0
    assert codes(inwards) == []
    fisheye = Intrinsics(640, 640, 180.0, 180.0, 319.5, 319.5, KannalaBrandt(0.001, 0.0, 0.0, 0.0))
    assert codes(rig(fisheye, turn_deg=(0.0, 100.0, 0.0))) == []  # 200 deg wide, the same turn


# --- how the cameras stand ---


@given(
    st.floats(-1.5, 1.5),
    st.floats(-1.2, 1.2),
    st.floats(-3.0, 3.0),
)
def test_turns_have_the_signs_of_a_perturbation(yaw: float, pitch: float, roll: float) -> None:
    base = StereoRig.rectified(CAMERA, 0.1)
    for name, place in (("yaw_rad", 0), ("pitch_rad", 1), ("roll_rad", 2)):
        angle = (yaw, pitch, roll)[place]
        turned = relative_turn_deg(Perturbation(**{name: angle}).apply(base))
        expected = [0.0, 0.0, 0.0]
        expected[place] = math.degrees(angle)
        assert turned == pytest.approx(expected, abs=1e-9)
    rotation = (
        Pose.from_rotvec((0, yaw, 0)).R @ Pose.from_rotvec((pitch, 0, 0)).R @ Pose.from_rotvec((0, 0, roll)).R
    )
    made = StereoRig(CAMERA, CAMERA, Pose(rotation, np.array([0.1, 0.0, 0.0])).inverse)
    assert relative_turn_deg(made) == pytest.approx(np.degrees([yaw, pitch, roll]), abs=1e-6)
    assert relative_turn_deg(made)[0] == pytest.approx(-made.vergence_deg, abs=1e-9)


@pytest.mark.parametrize(
    ("at_mm", "word"),
    [
        ((100, 40, 500), "horizontal"),
        ((-100, -40, 0), "horizontal"),
        ((100, 43, 0), "diagonal"),
        ((100, 235, 0), "diagonal"),
        ((40, -100, 20), "vertical"),
    ],
)
def test_the_arrangement(at_mm: tuple[float, float, float], word: str) -> None:
    assert arrangement(rig(at_mm=at_mm)) == word


# --- what two cameras above each other share ---

UPPER = Intrinsics(1600, 1200, 1850.0, 1846.0, 792.0, 630.0, BrownConrady(-0.21, 0.17, 2e-4, -5e-4))
LOWER = Intrinsics(1600, 1200, 1835.0, 1831.0, 788.0, 604.0, BrownConrady(-0.2, 0.15, -5e-4, -4e-4))


def _sampled_share(found: StereoRig, depth_m: float, n: int) -> float:
    """The share by OpenCV: random left pixels, their rays, their points, and where the right camera has
    them."""
    left, right = found.left, found.right
    rng = np.random.default_rng(7)
    uv = rng.uniform([-0.5, -0.5], [left.width - 0.5, left.height - 0.5], (n, 2))
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-13)
    xy = cv2.undistortPoints(uv[:, None], left.K, _opencv(left), criteria=criteria)[:, 0]
    points = np.column_stack([xy, np.ones(n)]) * depth_m
    pose = found.right_from_left
    at = cv2.projectPoints(points, cv2.Rodrigues(pose.R)[0], pose.t, right.K, _opencv(right))[0][:, 0]
    ahead = (points @ pose.R.T + pose.t)[:, 2] > 0
    inside = (at >= -0.5).all(axis=1) & (at[:, 0] <= right.width - 0.5) & (at[:, 1] <= right.height - 0.5)
    # beyond the picture a polynomial may turn back: its corner is at 0.67 of the focal length
    off = (points @ pose.R.T + pose.t)[:, :2] / (points @ pose.R.T + pose.t)[:, 2:]
    return float((ahead & inside & (np.hypot(*off.T) < 0.8)).mean())


def _opencv(camera: Intrinsics) -> np.ndarray:
    assert isinstance(camera.lens, BrownConrady)
    return np.array([camera.lens.k1, camera.lens.k2, camera.lens.p1, camera.lens.p2, camera.lens.k3])


@pytest.mark.parametrize("depth_m", [0.5, 3.0, 20.0])
@pytest.mark.parametrize("up_deg", [-40.0, -25.0, -12.0, 0.0, 9.0])
def test_the_overlap_of_cameras_above_each_other(up_deg: float, depth_m: float) -> None:
    # the lower one looks down where `up_deg` is below 0: away from the upper one
    found = rig(UPPER, LOWER, (up_deg, 0.0, 0.0), (3.0, 212.0, -60.0))
    share = float(overlap_at_depth(found, depth_m).fraction)
    n = 40_000
    sampled = _sampled_share(found, depth_m, n)
    assert share == pytest.approx(sampled, abs=4 * math.sqrt(0.25 / n))
    assert (share == 0) == (sampled == 0)
    if up_deg == -40:
        assert share == 0
        assert codes(found) == ["no_overlap"]
