"""ROS's camera_info: by hand, as cv2 rectifies, every lens, and there and back."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.robotics import ros
from rigsim.interop.formats.robotics.kalibr import camchain_yaml
from rigsim.interop.formats.robotics.ros import camera_info_yaml, parse_camera_info
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.rational import Rational
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.bodies import found
from tests.helpers.rig_strategies import rectified_rigs, rigs, same_rig

LEFT = Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0)
RIGHT = Intrinsics(640, 480, 800.0, 800.0, 330.0, 240.0)
RECTIFIED = StereoRig.rectified(LEFT, 0.25, right=RIGHT)
POINTS_LEFT = np.array([[0.1, -0.2, 3.0], [-0.3, 0.25, 4.0], [0.4, 0.1, 2.5]])


def data(table: dict[str, dict[str, object]], name: str) -> np.ndarray:
    entry = table[name]
    return np.array(entry["data"], dtype=float).reshape(int(str(entry["rows"])), int(str(entry["cols"])))


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
    same_rig(parse_camera_info(*camera_info_yaml(rig)).rig, rig)


@given(rectified_rigs())
def test_camera_info_of_rectified_rigs_there_and_back(rig: StereoRig) -> None:
    same_rig(parse_camera_info(*camera_info_yaml(rig)).rig, rig)


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


def cv2_pair(R: np.ndarray, T: np.ndarray) -> tuple[list[str], StereoRig]:
    """The two files as a calibration by cv2 makes them, and the rig that was calibrated."""
    K = [
        np.array([[810.0, 0, 330], [0, 805, 236], [0, 0, 1]]),
        np.array([[790.0, 0, 315], [0, 792, 244], [0, 0, 1]]),
    ]
    D = [np.array([-0.2, 0.05, 1e-3, -2e-3, 0.01]), np.array([-0.18, 0.04, -1e-3, 5e-4, 0.0])]
    R1, R2, P1, P2, *_ = cv2.stereoRectify(K[0], D[0], K[1], D[1], (640, 480), R, T[:, None], flags=0)
    texts = [info(*one) for one in zip(K, D, (R1, R2), (P1, P2), strict=True)]
    cameras = [
        Intrinsics(640, 480, k[0, 0], k[1, 1], k[0, 2], k[1, 2], BrownConrady(*d))
        for k, d in zip(K, D, strict=True)
    ]
    return texts, StereoRig(cameras[0], cameras[1], Pose(R, T))


def info(
    K: np.ndarray, D: np.ndarray, R: np.ndarray, P: np.ndarray, model: str = "distortion_model: plumb_bob"
) -> str:
    return (
        f"image_width: 640\nimage_height: 480\ncamera_name: narrow\n{model}\n"
        + entry("camera_matrix", K)
        + entry("distortion_coefficients", np.atleast_2d(D))
        + entry("rectification_matrix", R)
        + entry("projection_matrix", P)
    )


def entry(name: str, M: np.ndarray) -> str:
    values = ", ".join(repr(float(value)) for value in M.ravel())
    return f"{name}:\n  rows: {M.shape[0]}\n  cols: {M.shape[1]}\n  data: [{values}]\n"


def files(texts: list[str], names: tuple[str, ...] = ("left.yaml", "right.yaml")) -> list[File]:
    return [File(Path("folder") / name, text) for name, text in zip(names, texts, strict=True)]


@pytest.mark.parametrize(
    ("T", "place"),
    [
        ((-0.12, 0.004, -0.003), (0, 3)),
        ((0.006, -0.2, 0.004), (1, 3)),
        ((0.12, -0.002, 0.003), (0, 3)),
        ((0.003, 0.2, -0.004), (1, 3)),
    ],
    ids=["right", "below", "left", "above"],
)
@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_what_cv2_rectified_is_the_rig_that_it_was(
    T: tuple[float, float, float], place: tuple[int, int], order: tuple[int, int]
) -> None:
    """Side by side, one above the other, and each the other way round; whichever file comes first."""
    R = cv2.Rodrigues(np.array([0.01, -0.05, 0.02]))[0]
    texts, rig = cv2_pair(R, np.array(T))
    P = data(yaml.safe_load(texts[1]), "projection_matrix")
    assert P[place] != 0
    given_files = files([texts[i] for i in order], ("a.yaml", "b.yaml"))
    read = found(ros.FORMAT, given_files)
    same_rig(read.rig, rig)
    assert (read.unit, read.remarks) == ("m", ())


def test_the_right_file_has_the_baseline_whatever_its_name() -> None:
    texts, rig = cv2_pair(np.eye(3), np.array([-0.1, 0.0, 0.0]))
    read = found(ros.FORMAT, files(texts[::-1]))
    same_rig(read.rig, rig)
    (remark,) = read.remarks
    assert remark.code == "files_exchanged"
    assert remark.text.startswith("left.yaml has the baseline in its projection_matrix")
    asked = found(ros.FORMAT, files(texts), Asked(cameras=("right", "left"))).rig
    same_rig(asked, StereoRig(rig.right, rig.left, rig.right_from_left.inverse))


@pytest.mark.parametrize(
    ("names", "left"),
    [
        (("right.yaml", "left.yaml"), 1),
        (("camera_left.yaml", "camera_right.yaml"), 0),
        (("rightCamera.yml", "leftCamera.yml"), 1),
        (("cam1.yaml", "cam0.yaml"), 1),
        (("infra1.yaml", "infra2.yaml"), 0),
        (("right/ost.yaml", "left/ost.yaml"), 1),
    ],
)
def test_names_tell_where_both_have_a_baseline(names: tuple[str, str], left: int) -> None:
    """As of two cameras of three, each with its offset from the first."""
    texts, rig = cv2_pair(np.eye(3), np.array([-0.1, 0.0, 0.0]))
    P = [data(yaml.safe_load(text), "projection_matrix") for text in texts]
    shifted = [
        text.replace(entry("projection_matrix", one), entry("projection_matrix", one + offset))
        for text, one in zip(texts, P, strict=True)
        for offset in [np.pad([[-0.3 * one[0, 0]]], ((0, 2), (3, 0)))]
    ]
    given_files = [
        File(Path("folder") / name, shifted[0 if i == left else 1]) for i, name in enumerate(names)
    ]
    if "/" in names[0]:
        assert ros.groups(given_files)
        with pytest.raises(InvalidRig, match="neither their names nor camera_name tell"):
            found(ros.FORMAT, files(shifted, ("one.yaml", "other.yaml")))
    same_rig(found(ros.FORMAT, given_files).rig, rig)


def test_pairs_in_a_folder_of_several() -> None:
    small, _ = cv2_pair(np.eye(3), np.array([-0.1, 0.0, 0.0]))
    names = ("left_720.yaml", "right_720.yaml", "left_1080.yaml", "right_1080.yaml", "rear.yaml")
    many = files([small[0], small[1], small[0], small[1], small[0]], names)
    pairs = [[file.name for file in pair] for pair in ros.groups(many)]
    assert pairs == [["left_720.yaml", "right_720.yaml"], ["left_1080.yaml", "right_1080.yaml"]]
    other = info(np.eye(3) + 1, np.zeros(5), np.eye(3), np.hstack([np.eye(3), np.zeros((3, 1))]))
    odd = files([small[0], other, small[1]], ("front.yaml", "rear.yaml", "aux.yaml"))
    assert [[file.name for file in pair] for pair in ros.groups(odd)] == [["front.yaml", "aux.yaml"]]
    assert ros.groups(odd[:1]) == []
    assert "camera_info of one camera: name the other's beside it" in str(ros.lacks(odd[0]))


@pytest.mark.parametrize(
    ("model", "D", "lens"),
    [
        ("distortion_model: plumb_bob", [0.1, 0.2, 0.3, 0.4, 0.5], BrownConrady(0.1, 0.2, 0.3, 0.4, 0.5)),
        ("distortion_model: plumb_bob", [0.1, 0.2, 0.3, 0.4], BrownConrady(0.1, 0.2, 0.3, 0.4)),
        ("camera_model: plumb_bob", [0.1, 0.2, 0.3, 0.4, 0.5], BrownConrady(0.1, 0.2, 0.3, 0.4, 0.5)),
        (
            "distortion_model: rational_polynomial",
            [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8],
            Rational(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8),
        ),
        ("distortion_model: equidistant", [0.1, 0.2, 0.3, 0.4], KannalaBrandt(0.1, 0.2, 0.3, 0.4)),
        ("distortion_model: fisheye", [0.0, 0.0, 0.0, 0.0], KannalaBrandt()),
        ("distortion_model: fov", [0.9], FieldOfView(0.9)),
        ("distortion_model: none", [], None),
        ("distortion_model: ''", [0.0, 0.0, 0.0, 0.0, 0.0], None),
    ],
)
def test_every_lens_by_hand(model: str, D: list[float], lens: Lens | None) -> None:
    P = np.hstack([LEFT.K, np.zeros((3, 1))])
    right = P.copy()
    right[0, 3] = -80
    texts = [info(LEFT.K, np.array(D), np.eye(3), one, model) for one in (P, right)]
    read = parse_camera_info(*texts)
    assert (read.rig.left.lens, read.rig.right.lens, read.remarks) == (lens, lens, ())
    assert read.rig.right_from_left.t.tolist() == [-0.1, 0, 0]


def test_a_model_that_is_not_named_is_assumed_aloud() -> None:
    P = np.hstack([LEFT.K, np.zeros((3, 1))])
    right = P.copy()
    right[0, 3] = -80
    D = np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    read = parse_camera_info(*(info(LEFT.K, D, np.eye(3), one, "") for one in (P, right)))
    assert read.rig.right.lens == BrownConrady(*D)
    (remark,) = read.remarks
    assert (remark.code, remark.text[:63]) == (
        "lens_model",
        "no distortion_model is named: plumb_bob assumed, by its 5 terms",
    )


def test_the_message_of_a_running_camera_is_read() -> None:
    message = """---
header:
  frame_id: "camera"
height: 480
width: 640
distortion_model: "plumb_bob"
D: [0.1, 0.2, 0.0, 0.0, 0.0]
K: [800.0, 0.0, 320.0, 0.0, 800.0, 240.0, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [800.0, 0.0, 320.0, {}, 0.0, 800.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]
roi:
  height: 0
---
header: again
"""
    texts = [message.format(value) for value in ("0.0", "-40.0")]
    rig = found(ros.FORMAT, files(texts, ("l.txt", "r.txt"))).rig
    assert rig.right_from_left.t.tolist() == [-0.05, 0, 0]
    assert rig.left.lens == BrownConrady(0.1, 0.2)
    lower = [
        text.replace("D:", "d:").replace("K:", "k:").replace("R:", "r:").replace("P:", "p:") for text in texts
    ]
    assert found(ros.FORMAT, files(lower)).rig == rig


@pytest.mark.parametrize(
    "lens", [KannalaBrandt(0.01, -0.02, 3e-5, 0.001), Rational(0.1, 0.2, 1e-4, -1e-5, 0.01, 0.3, 0.05, 1e-6)]
)
def test_lenses_there_and_back(lens: Lens) -> None:
    left = Intrinsics(640, 480, 800.0, 790.0, 325.0, 236.0, lens)
    turned = Pose.from_rotvec([0.01, -0.08, 0.02])
    rig = StereoRig(left, LEFT, Pose(turned.R, -turned.R @ [0.12, 0.004, -0.003]))
    same_rig(parse_camera_info(*camera_info_yaml(rig)).rig, rig)


def test_a_vertical_rig_there_and_back() -> None:
    rig = StereoRig(LEFT, RIGHT, Pose(Pose.from_rotvec([0.02, 0.01, -0.01]).R, np.array([0.003, -0.2, 0.01])))
    same_rig(parse_camera_info(*camera_info_yaml(rig)).rig, rig)


@pytest.mark.parametrize(
    ("lens", "message"),
    [
        (
            Mei(1.0),
            "left lens mei with .*: camera_info has plumb_bob, rational_polynomial and equidistant alone",
        ),
        (Rational(s1=0.1), "left lens rational .*: rational_polynomial has k1 to k6, p1, p2 alone"),
    ],
)
def test_what_camera_info_lacks_is_refused(lens: Lens, message: str) -> None:
    with pytest.raises(InvalidRig, match=message):
        camera_info_yaml(StereoRig.rectified(Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0, lens), 0.1))


@pytest.mark.parametrize(
    ("side", "old", "new", "message"),
    [
        (1, "-200.0", "0.0", "projection_matrix.* are 0 in both files: .* monocular calibrations"),
        (1, "plumb_bob", "spline", "right.yaml: distortion_model spline: must be plumb_bob, rational_poly"),
        (0, "plumb_bob", "equidistant", "left.yaml: .* has 5 numbers, must be 4, as of equidistant"),
        (
            0,
            "  data: [1.0, 0.0, 0.0,",
            "  data: [1.0, 0.1, 0.0,",
            "left.yaml: rectification_matrix is no rotation",
        ),
        (0, "camera_matrix:", "camera_mat:", r"left.yaml: camera_matrix is missing \(found image_width"),
        (1, "image_width: 640", "image_width: wide", "right.yaml: image_width wide: must be a number"),
        (
            1,
            "data: [800.0, 0.0, 330.0, -200.0",
            "data: [700.0, 0.0, 330.0, -200.0",
            "800 left, 700 right: must be equal",
        ),
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


def test_a_rational_polynomial_without_its_terms_is_read() -> None:
    left, right = camera_info_yaml(RECTIFIED)
    rational = left.replace("plumb_bob", "rational_polynomial").replace(
        "cols: 5\n  data: [0.0, 0.0, 0.0, 0.0, 0.0]", "cols: 8\n  data: [0.1, 0, 0, 0, 0.2, 0, 0, 0]"
    )
    assert parse_camera_info(rational, right).rig.left.lens == BrownConrady(k1=0.1, k3=0.2)
