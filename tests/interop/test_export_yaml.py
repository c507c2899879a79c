"""ROS's and Kalibr's YAML: by hand, through plain YAML and cv2, and there and back."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import yaml
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.interop.formats.kalibr import camchain_yaml, parse_camchain
from rigsim.interop.formats.ros import camera_info_yaml, parse_camera_info
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.rig_strategies import rectified_rigs, rigs, same_rig

LEFT = Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0)
RIGHT = Intrinsics(640, 480, 800.0, 800.0, 330.0, 240.0)
RECTIFIED = StereoRig.rectified(LEFT, 0.25, right=RIGHT)
POINTS_LEFT = np.array([[0.1, -0.2, 3.0], [-0.3, 0.25, 4.0], [0.4, 0.1, 2.5]])


def data(table: dict[str, dict[str, object]], name: str) -> np.ndarray:
    entry = table[name]
    return np.array(entry["data"], dtype=float).reshape(int(str(entry["rows"])), int(str(entry["cols"])))


# --- ROS ----------------------------------------------------------------------------------------


def test_camera_info_by_hand() -> None:
    left, right = (yaml.safe_load(text) for text in camera_info_yaml(RECTIFIED))
    assert (left["image_width"], left["image_height"], left["camera_name"]) == (640, 480, "left")
    assert left["distortion_model"] == "plumb_bob"
    assert left["camera_matrix"]["data"] == [800, 0, 320, 0, 800, 240, 0, 0, 1]
    # the baseline, 0.25 m * 800 px = 200, stands in the right P alone
    assert left["projection_matrix"]["data"] == [800, 0, 320, 0, 0, 800, 240, 0, 0, 0, 1, 0]
    assert right["projection_matrix"]["data"] == [800, 0, 330, -200, 0, 800, 240, 0, 0, 0, 1, 0]
    assert left["rectification_matrix"]["data"] == [1, 0, 0, 0, 1, 0, 0, 0, 1]
    assert left["distortion_coefficients"]["data"] == [0] * 5


@given(rigs(sideways=True))
def test_camera_info_there_and_back(rig: StereoRig) -> None:
    same_rig(parse_camera_info(*camera_info_yaml(rig)), rig)


@given(rectified_rigs())
def test_camera_info_of_rectified_rigs_there_and_back(rig: StereoRig) -> None:
    same_rig(parse_camera_info(*camera_info_yaml(rig)), rig)


def test_a_verged_distorted_rig_is_rectified_by_what_was_written() -> None:
    """cv2 undistorts and turns pixels as image_proc does; then rows agree and Z = fx b / d."""
    lens = Intrinsics(640, 480, 800.0, 790.0, 325.0, 236.0, BrownConrady(-0.2, 0.05, 1e-3, -2e-3, 0.01))
    turned = Pose.from_rotvec([0.01, -0.08, 0.02])
    rig = StereoRig(lens, lens, Pose(turned.R, -turned.R @ [0.12, 0.004, -0.003]))
    left, right = (yaml.safe_load(text) for text in camera_info_yaml(rig))
    uv = []
    for info, pixels in zip((left, right), rig.project(POINTS_LEFT), strict=True):
        K, D, R, P = (
            data(info, name)
            for name in (
                "camera_matrix",
                "distortion_coefficients",
                "rectification_matrix",
                "projection_matrix",
            )
        )
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-14)
        uv.append(cv2.undistortPoints(pixels[:, None], K, D, R=R, P=P, criteria=criteria)[:, 0])
    np.testing.assert_allclose(uv[0][:, 1], uv[1][:, 1], atol=1e-6)
    P = data(right, "projection_matrix")
    depth = -P[0, 3] / (uv[0][:, 0] - uv[1][:, 0])
    expected = (POINTS_LEFT @ data(left, "rectification_matrix").T)[:, 2]
    np.testing.assert_allclose(depth, expected, rtol=1e-8)
    assert -P[0, 3] / P[0, 0] == pytest.approx(rig.baseline_m)
    # the two optical axes stay, on average, where the principal points were: the pictures do not wander off
    axes = [
        data(info, "projection_matrix")[:, :3] @ data(info, "rectification_matrix")[:, 2]
        for info in (left, right)
    ]
    np.testing.assert_allclose(np.mean([axis[:2] / axis[2] for axis in axes], axis=0), [325, 236], atol=1e-9)


def test_forward_motion_has_no_camera_info() -> None:
    rig = StereoRig(LEFT, LEFT, Pose(t=np.array([0.0, 0.0, -0.5])))
    with pytest.raises(InvalidRig, match="look 0 deg off their baseline"):
        camera_info_yaml(rig)


def test_small_numbers_stay_numbers() -> None:
    """YAML 1.1 reads 1e-05 as a word; a driver that does arithmetic with it dies."""
    lens = Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0, BrownConrady(k1=1e-05, p2=-3e-07))
    for text in (
        *camera_info_yaml(StereoRig.rectified(lens, 0.1)),
        camchain_yaml(StereoRig.rectified(lens, 0.1)),
    ):
        document = yaml.safe_load(text)
        found = (
            document.get("cam0", {}).get("distortion_coeffs") or document["distortion_coefficients"]["data"]
        )
        assert found[:4] == [1e-05, 0.0, 0.0, -3e-07]


@pytest.mark.parametrize(
    ("side", "old", "new", "message"),
    [
        (
            0,
            "800.0, 0.0, 320.0, 0.0,",
            "800.0, 0.0, 320.0, -200.0,",
            "left.yaml: projection_matrix.* -200: must be 0",
        ),
        (1, "-200.0", "0.0", r"right.yaml: projection_matrix\[0,3\] 0: must be -fx b"),
        (1, "-200.0", "200.0", r"right.yaml: projection_matrix\[0,3\] 200: .* lies to the left of the other"),
        (
            1,
            "-200.0,\n         0.0, 800.0, 240.0, 0.0",
            "0.0,\n         0.0, 800.0, 240.0, -200.0",
            r"right.yaml: projection_matrix\[1,3\] -200, .* one above the other",
        ),
        (1, "240.0, 0.0", "240.0, -2.0", r"right.yaml: projection_matrix\[1,3\] -2 and .* must be 0"),
        (1, "plumb_bob", "equidistant", "right.yaml: distortion_model equidistant: must be plumb_bob or"),
        (
            0,
            "  data: [1.0, 0.0, 0.0,",
            "  data: [1.0, 0.1, 0.0,",
            "left.yaml: rectification_matrix is no rotation",
        ),
        (0, "camera_matrix:", "camera_mat:", r"left.yaml: camera_matrix is missing \(found image_width"),
        (1, "image_width: 640", "image_width: wide", "right.yaml: image_width wide: must be a number"),
        (1, "data: [800.0, 0.0, 330.0, -200.0", "data: [700.0, 0.0, 330.0, -200.0", "800 left, 700 right"),
        (1, "rows: 3", "rows: [3", "right.yaml: is not YAML: line"),
    ],
)
def test_bad_camera_info_is_one_line(side: int, old: str, new: str, message: str) -> None:
    texts = list(camera_info_yaml(RECTIFIED))
    assert old in texts[side]
    texts[side] = texts[side].replace(old, new, 1)
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_camera_info(*texts)
    assert "\n" not in str(caught.value)


def test_swapped_camera_info_is_told() -> None:
    left, right = camera_info_yaml(RECTIFIED)
    with pytest.raises(InvalidRig, match="are the two files swapped"):
        parse_camera_info(right, left)


def test_a_rational_polynomial_without_its_terms_is_read() -> None:
    left, right = camera_info_yaml(RECTIFIED)
    rational = left.replace("plumb_bob", "rational_polynomial").replace(
        "cols: 5\n  data: [0.0, 0.0, 0.0, 0.0, 0.0]", "cols: 8\n  data: [0.1, 0, 0, 0, 0.2, 0, 0, 0]"
    )
    assert parse_camera_info(rational, right).left.lens == BrownConrady(k1=0.1, k3=0.2)


# --- Kalibr -------------------------------------------------------------------------------------


def test_camchain_by_hand() -> None:
    # the right camera 0.5 m to the right and turned by 90 deg about z: x_right = R (x_left - c), and
    # R c is (0, 1, 0) * 0.5 for R that takes x to y
    R = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    lens = Intrinsics(640, 480, 800.0, 801.0, 320.0, 240.0, BrownConrady(0.1, 0.2, 0.3, 0.4))
    document = yaml.safe_load(camchain_yaml(StereoRig(lens, RIGHT, Pose(R, np.array([0.0, -0.5, 0.0])))))
    assert document["cam1"]["T_cn_cnm1"] == [[0, -1, 0, 0], [1, 0, 0, -0.5], [0, 0, 1, 0], [0, 0, 0, 1]]
    assert "T_cn_cnm1" not in document["cam0"]
    assert document["cam0"]["intrinsics"] == [800, 801, 320, 240]
    assert document["cam0"]["distortion_model"] == "radtan"
    assert document["cam0"]["distortion_coeffs"] == [0.1, 0.2, 0.3, 0.4]
    assert document["cam1"]["resolution"] == [640, 480]


@given(rigs(k3=False))
def test_camchain_there_and_back(rig: StereoRig) -> None:
    same_rig(parse_camchain(camchain_yaml(rig)), rig)


def test_camchain_of_kalibr_itself_is_read() -> None:
    """As its wiki prints it: rounded, nested, with more keys than are needed."""
    text = """cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
  distortion_model: radtan
  intrinsics: [458.654, 457.296, 367.215, 248.375]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  T_cam_imu:
  - [1, 0, 0, 0]
cam1:
  T_cn_cnm1:
  - [0.9999974, 0.0018235, 0.0013869, -0.1100738]
  - [-0.0018185, 0.9999915, -0.0035976, 0.0003991]
  - [-0.0013934, 0.0035951, 0.9999926, -0.0008537]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: []
  distortion_model: none
  intrinsics: [457.587, 456.134, 379.999, 255.238]
  resolution: [752, 480]
"""
    rig = parse_camchain(text)
    assert rig.left.lens == BrownConrady(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05)
    assert rig.right.lens is None
    assert rig.baseline_m == pytest.approx(0.1100778, abs=1e-6)
    # rounded rows are put right
    np.testing.assert_allclose(rig.right_from_left.R @ rig.right_from_left.R.T, np.eye(3), atol=1e-14)
    assert rig.right_from_left.R[1, 2] == pytest.approx(-0.0035976, abs=1e-5)


def test_k3_is_refused() -> None:
    lens = Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0, BrownConrady(k3=0.05))
    with pytest.raises(InvalidRig, match=r"right k3 0.05: must be 0, Kalibr's radtan lens has no k3"):
        camchain_yaml(StereoRig.rectified(LEFT, 0.1, right=lens))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("cam1:", "cam2:", r"cam1 is missing \(found cam0, cam2\)"),
        ("T_cn_cnm1:", "T_cn:", "T_cn_cnm1 of cam1 is missing"),
        ("  - [1.0, 0.0, 0.0, -0.25]", "  - [2.0, 0.0, 0.0, -0.25]", "T_cn_cnm1 of cam1 is no rotation"),
        ("  - [0.0, 0.0, 0.0, 1.0]", "  - [0.0, 0.0, 0.0, 2.0]", "last row is 0.0, 0.0, 0.0, 2.0, must be"),
        ("  - [0.0, 0.0, 0.0, 1.0]", "", "T_cn_cnm1 of cam1: has 3 rows, must be 4"),
        ("-0.25]", "0.0]", "baseline 0 mm: must be > 0"),
        ("radtan", "equidistant", "distortion_model of cam0 equidistant: must be radtan or none"),
        ("pinhole", "omni", "camera_model of cam0 omni: must be pinhole"),
        ("intrinsics: [800.0, ", "intrinsics: [", "intrinsics of cam0: holds 3 values, must be 4"),
        ("resolution: [640, 480]", "resolution: 640", r"resolution of cam0 640: must be a list of 2"),
        ("cam0:", "cam0: none\nother:", "cam0 none: must be a table"),
    ],
)
def test_bad_camchain_is_one_line(old: str, new: str, message: str) -> None:
    text = camchain_yaml(RECTIFIED)
    assert old in text
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_camchain(text.replace(old, new, 1))
    assert "\n" not in str(caught.value)
