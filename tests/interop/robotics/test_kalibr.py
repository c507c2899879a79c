"""Kalibr's camera chain: by hand, one rig said in four ways, every lens, and there and back."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.robotics import kalibr
from rigsim.interop.formats.robotics.kalibr import camchain_yaml, parse_camchain
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.double_sphere import DoubleSphere
from rigsim.rig.lens.eucm import Eucm
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.rational import Rational
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.bodies import BODY_FROM_LEFT, BODY_FROM_RIGHT, check_pose, found, matrix, rows
from tests.helpers.rig_strategies import rigs

LEFT = Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0)
RIGHT = Intrinsics(640, 480, 800.0, 800.0, 330.0, 240.0)
RECTIFIED = StereoRig.rectified(LEFT, 0.25, right=RIGHT)
BODY_FROM_THIRD = matrix((0.3, 0.01, -0.2), (0.02, 0.01, 0.09))


def camera(name: str, lens: str = "", **transforms: np.ndarray) -> str:
    lens = lens or "camera_model: pinhole\n  distortion_model: none\n  intrinsics: [400, 401, 320, 240]"
    text = f"{name}:\n  {lens}\n  resolution: [640, 480]\n"
    return text + "".join(f"  {key}:\n{rows(T)}" for key, T in transforms.items())


def inverse(matrix: np.ndarray) -> np.ndarray:
    return np.linalg.inv(matrix)


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


@pytest.mark.parametrize(
    "transforms",
    [
        ({}, {"T_cn_cnm1": inverse(BODY_FROM_RIGHT) @ BODY_FROM_LEFT}),
        ({"T_cam_imu": inverse(BODY_FROM_LEFT)}, {"T_cam_imu": inverse(BODY_FROM_RIGHT)}),
        ({"T_imu_cam": BODY_FROM_LEFT}, {"T_imu_cam": BODY_FROM_RIGHT}),
        ({"T_imu_cam": BODY_FROM_LEFT}, {"T_cam_imu": inverse(BODY_FROM_RIGHT)}),
    ],
    ids=["T_cn_cnm1", "T_cam_imu", "T_imu_cam", "mixed"],
)
def test_one_rig_said_in_four_ways(transforms: tuple[dict[str, np.ndarray], dict[str, np.ndarray]]) -> None:
    text = "%YAML:1.0 # to please OpenCV\n\n" + "".join(
        camera(f"cam{i}", **own) for i, own in enumerate(transforms)
    )
    (file,) = [File(Path("chain.txt"), text)]
    read = found(kalibr.FORMAT, [file])
    check_pose(read.rig)
    assert (read.unit, read.remarks) == ("m", ())


def test_cameras_of_three_are_chained() -> None:
    chain = [BODY_FROM_LEFT, BODY_FROM_THIRD, BODY_FROM_RIGHT]
    links = [inverse(chain[i]) @ chain[i - 1] for i in (1, 2)]
    lenses = [f"camera_model: pinhole-none\n  intrinsics: [40{i}, 400, 320, 240]" for i in range(3)]
    text = camera("cam0", lenses[0]) + "".join(
        camera(f"cam{i}", lenses[i], T_cn_cnm1=links[i - 1]) for i in (1, 2)
    )
    across = parse_camchain(text, Asked(cameras=("cam0", "cam2")))
    check_pose(across.rig)
    assert (across.rig.left.fx, across.rig.right.fx, across.remarks) == (400, 402, ())
    back = parse_camchain(text, Asked(cameras=("2", "0"))).rig
    check_pose(back, BODY_FROM_RIGHT, BODY_FROM_LEFT)
    assert (back.left.fx, back.right.fx) == (402, 400)
    usual = parse_camchain(text)
    check_pose(usual.rig, BODY_FROM_LEFT, BODY_FROM_THIRD)
    (remark,) = usual.remarks
    assert remark.code == "cameras"
    assert "cam0 and cam1 are taken; others with --rig-cameras, as 0,2" in remark.text
    for cameras, message in (
        (("cam0", "cam3"), "camera cam3: the file has cam0, cam1, cam2; name two of them"),
        (("1", "cam1"), "cameras 1,cam1: must be two different ones of cam0, cam1, cam2"),
    ):
        with pytest.raises(InvalidRig, match=message):
            parse_camchain(text, Asked(cameras=cameras))


def test_two_ways_that_differ_are_told() -> None:
    off = BODY_FROM_RIGHT.copy()
    off[0, 3] += 0.01
    text = camera("cam0", T_imu_cam=BODY_FROM_LEFT) + camera(
        "cam1", T_imu_cam=off, T_cn_cnm1=inverse(BODY_FROM_RIGHT) @ BODY_FROM_LEFT
    )
    read = parse_camchain(text)
    check_pose(read.rig)
    (remark,) = read.remarks
    assert remark.code == "poses_differ"
    assert remark.text.startswith("T_cn_cnm1 and the T_cam_imu of both cameras differ by 10 mm and ")


def test_rounded_rotations_are_put_right() -> None:
    """As OpenVINS and Kalibr's pages print them, three decimals; nothing is made of a broken unit."""
    T = np.round(inverse(BODY_FROM_RIGHT) @ BODY_FROM_LEFT, 3)
    rig = parse_camchain(camera("cam0", T_cam_imu=np.ones((1, 4))) + camera("cam1", T_cn_cnm1=T)).rig
    R = rig.right_from_left.R
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
    check_pose(rig, tolerance=0.01)
    np.testing.assert_array_equal(rig.right_from_left.t, T[:3, 3])


@pytest.mark.parametrize(
    ("text", "lens"),
    [
        (
            "camera_model: pinhole\n  intrinsics: [400, 401, 320, 240]\n  distortion_model: radtan\n"
            "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]",
            BrownConrady(0.1, 0.2, 0.3, 0.4),
        ),
        (
            "camera_model: pinhole\n  intrinsics: [400, 401, 320, 240]\n  distortion_model: equidistant\n"
            "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]",
            KannalaBrandt(0.1, 0.2, 0.3, 0.4),
        ),
        (
            "camera_model: pinhole-fov\n  intrinsics: [400, 401, 320, 240]\n  distortion_coeffs: [0.9]",
            FieldOfView(0.9),
        ),
        (
            "camera_model: omni\n  intrinsics: [1.2, 400, 401, 320, 240]\n  distortion_model: radtan\n"
            "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]",
            Mei(1.2, 0.1, 0.2, 0.3, 0.4),
        ),
        (
            "camera_model: omni\n  intrinsics: [0.8, 400, 401, 320, 240]\n  distortion_model: none",
            Mei(0.8),
        ),
        (
            "camera_model: ds\n  intrinsics: [-0.2, 0.6, 400, 401, 320, 240]\n  distortion_model: none\n"
            "  distortion_coeffs: []",
            DoubleSphere(-0.2, 0.6),
        ),
        (
            "camera_model: eucm\n  intrinsics: [0.6, 1.1, 400, 401, 320, 240]\n  distortion_model: radtan\n"
            "  distortion_coeffs: [0, 0, 0, 0]",
            Eucm(0.6, 1.1),
        ),
    ],
)
def test_every_lens_by_hand(text: str, lens: Lens) -> None:
    T = inverse(BODY_FROM_RIGHT) @ BODY_FROM_LEFT
    read = parse_camchain(camera("cam0", text) + camera("cam1", text, T_cn_cnm1=T)).rig
    assert read.left == read.right == Intrinsics(640, 480, 400, 401, 320, 240, lens)


def test_equidistant_is_what_cv2_calls_fisheye() -> None:
    text = (
        "camera_model: pinhole\n  intrinsics: [400, 410, 320, 240]\n  distortion_model: equidistant\n"
        "  distortion_coeffs: [0.03, -0.02, 0.01, -0.004]"
    )
    T = inverse(BODY_FROM_RIGHT) @ BODY_FROM_LEFT
    rig = parse_camchain(camera("cam0", text) + camera("cam1", text, T_cn_cnm1=T)).rig
    points = np.array([[0.4, -1.2, 1.0], [2.0, 0.3, 1.0]])
    K = np.array([[400.0, 0, 320], [0, 410, 240], [0, 0, 1]])
    D = np.array([0.03, -0.02, 0.01, -0.004])
    seen, _ = cv2.fisheye.projectPoints(points[None], np.zeros(3), np.zeros(3), K, D)
    np.testing.assert_allclose(rig.left.project(points), seen[0], atol=1e-9)


LENSES = st.sampled_from(
    [
        None,
        BrownConrady(-0.2, 0.05, 1e-5, -2e-4),
        KannalaBrandt(0.01, -0.02, 3e-5, 0.001),
        Mei(1.1, -0.1, 0.02, 1e-4, 1e-5),
        DoubleSphere(-0.17, 0.59),
        Eucm(0.58, 1.12),
        FieldOfView(0.92),
    ]
)


@given(rigs(k3=False), LENSES, LENSES)
def test_camchain_there_and_back_to_the_bit(rig: StereoRig, left: Lens | None, right: Lens | None) -> None:
    cameras = [
        Intrinsics(own.width, own.height, own.fx, own.fy, own.cx, own.cy, lens)
        for own, lens in ((rig.left, left), (rig.right, right))
    ]
    rig = StereoRig(*cameras, rig.right_from_left)
    assert parse_camchain(camchain_yaml(rig)).rig == rig


@pytest.mark.parametrize(
    ("lens", "message"),
    [
        (BrownConrady(k3=0.05), "right k3 0.05: must be 0, Kalibr's radtan lens has no k3"),
        (Rational(k4=0.1), "right lens rational with .* k4 0.1, .*: Kalibr has no such model"),
    ],
)
def test_what_kalibr_lacks_is_refused(lens: Lens, message: str) -> None:
    right = Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0, lens)
    with pytest.raises(InvalidRig, match=message):
        camchain_yaml(StereoRig.rectified(LEFT, 0.1, right=right))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("cam1:", "other:", r"has one camera, cam0: a rig has two"),
        ("T_cn_cnm1:", "T_cn:", "T_cn_cnm1 of cam1 is missing, and so is T_cam_imu or T_imu_cam"),
        ("  - [1.0, 0.0, 0.0, -0.25]", "  - [2.0, 0.0, 0.0, -0.25]", "T_cn_cnm1 of cam1 is no rotation"),
        ("  - [0.0, 0.0, 0.0, 1.0]", "  - [0.0, 0.0, 0.0, 2.0]", "last row is 0.0, 0.0, 0.0, 2.0, must be"),
        ("-0.25]", "0.0]", "baseline 0 mm: must be > 0"),
        ("radtan", "cubic", "camera_model pinhole with distortion_model cubic of cam0: .* pinhole-radtan, "),
        ("pinhole", "omni", "intrinsics of cam0: holds 4 values, must be 5"),
        ("pinhole", "ds", "intrinsics of cam0: holds 4 values, must be 6"),
        ("radtan", "fov", "distortion_coeffs of cam0: holds 4 values, must be 1, as of fov"),
        ("intrinsics: [800.0, ", "intrinsics: [", "intrinsics of cam0: holds 3 values, must be 4"),
        ("intrinsics: [800.0, ", "intrinsics: [.nan, ", "intrinsics of cam0 nan: must be finite"),
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


def test_omni_equidistant_is_refused_by_name() -> None:
    text = camera(
        "cam0",
        "camera_model: omni\n  intrinsics: [1, 400, 401, 320, 240]\n  distortion_model: equidistant\n"
        "  distortion_coeffs: [0.1, 0, 0, 0]",
    )
    with pytest.raises(InvalidRig, match="camera_model omni with distortion_model equidistant of cam0: no"):
        parse_camchain(text + camera("cam1"))


@pytest.mark.parametrize("word", ["rational_polynomial", "rational", "plumb_bob"])
@pytest.mark.parametrize("count", [4, 5, 8, 12, 14])
def test_opencv_s_terms_in_a_chain_without_camera_models(word: str, count: int) -> None:
    terms = [-0.31, 0.12, 1.5e-3, -2.5e-4, -0.02, 0.05, 0.011, -0.004, 1e-3, 2e-4, -1e-3, 3e-4, 0.01, -0.02][
        :count
    ]
    lens = (
        f"distortion_model: {word}\n  distortion_coeffs: {terms}\n  intrinsics: [400.5, 401.25, 322, 239.5]"
    )
    way = inverse(BODY_FROM_RIGHT) @ BODY_FROM_LEFT
    text = camera("cam0", lens) + camera("cam1", lens, T_cn_cnm1=way)
    read = parse_camchain(text)
    check_pose(read.rig)
    assert [remark.code for remark in read.remarks] == ["camera_model"]
    assert "cam0 and cam1 without camera_model: pinhole assumed" in read.remarks[0].text
    points = np.array([[0.3, -0.2, 1.0], [-0.25, 0.1, 0.9]])
    K = np.array([[400.5, 0, 322], [0, 401.25, 239.5], [0, 0, 1]])
    image, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, np.array(terms))
    np.testing.assert_allclose(read.rig.left.project(points), image[:, 0], atol=1e-9)
    said = text.replace("  distortion_model", "  camera_model: pinhole\n  distortion_model")
    assert parse_camchain(said).rig == read.rig
    assert parse_camchain(said).remarks == ()
    with pytest.raises(InvalidRig, match="has 3 numbers, must be 4"):
        parse_camchain(text.replace(str(terms), str(terms[:3])))
