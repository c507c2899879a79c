"""stereo.yml: by hand, read by cv2, and there and back."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.interop.formats.opencv.calibration import parse_opencv_yaml
from rigsim.interop.formats.opencv_yaml import opencv_yaml, write_opencv_yaml
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.rational import Rational
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.rig_strategies import rigs, same_rig


def stored(path: Path, *names: str) -> list[np.ndarray]:
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    try:
        return [storage.getNode(name).mat() for name in names]
    finally:
        storage.release()


def test_by_hand() -> None:
    # f 1000 px, 120 mm: P2[0,3] = -1000 * 0.12 = -120 px m; doffs 8: Q[3] = 1 / 0.12, 8 / 0.12
    left = Intrinsics(640, 480, 1000.0, 1000.0, 319.5, 239.5)
    rig = StereoRig.rectified(left, 0.12, right=Intrinsics(640, 480, 1000.0, 1000.0, 327.5, 239.5))
    text = opencv_yaml(rig)
    assert text.startswith("%YAML:1.0\n---\n")
    assert "data: [ 1000.0, 0.0, 319.5,\n      0.0, 1000.0, 239.5,\n      0.0, 0.0, 1.0 ]" in text
    assert "T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ -0.12," in text
    assert "1000.0, 0.0, 327.5, -120.0,\n" in text
    assert "0.0, 0.0, 8.333333333333334, 66.66666666666667 ]" in text


@given(rigs())
def test_there_and_back(rig: StereoRig) -> None:
    same_rig(parse_opencv_yaml(opencv_yaml(rig)), rig)


@pytest.mark.parametrize(
    ("lens", "terms"),
    [
        (BrownConrady(0.1), 5),
        (Rational(0.1, 0.02, 0.001, 0.002, 0.03, 0.04, 0.005, 0.006), 8),
        (Rational(0.1, s4=0.001), 12),
        (Rational(0.1, tau_y=0.01), 14),
    ],
)
def test_cv2_projects_what_was_written_with_more_terms(tmp_path: Path, lens: Lens, terms: int) -> None:
    rig = StereoRig.rectified(Intrinsics(640, 480, 800.0, 810.0, 319.5, 239.5, lens), 0.12)
    path = tmp_path / "stereo.yml"
    write_opencv_yaml(path, rig)
    K1, D1 = stored(path, "K1", "D1")
    assert D1.size == terms
    points = np.array([[0.1, -0.2, 3.0], [-0.3, 0.25, 4.0]])
    found, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), K1, D1)
    np.testing.assert_allclose(found[:, 0], rig.left.project(points), atol=1e-9)


def test_fisheyes_and_omnidirectional_cameras(tmp_path: Path) -> None:
    fisheye = Intrinsics(640, 480, 300.0, 310.0, 319.5, 239.5, KannalaBrandt(0.1, 0.02, -0.003, 0.004))
    rig = StereoRig.rectified(fisheye, 0.12)
    path = tmp_path / "stereo.yml"
    write_opencv_yaml(path, rig)
    K1, D1 = stored(path, "K1", "D1")
    points = np.array([[[0.1, -0.2, 0.3], [-0.3, 0.25, 0.4]]])
    found, _ = cv2.fisheye.projectPoints(points, np.zeros(3), np.zeros(3), K1, D1)
    np.testing.assert_allclose(found[0], rig.left.project(points[0]), atol=1e-9)
    same_rig(parse_opencv_yaml(opencv_yaml(rig)), rig)
    omni = Intrinsics(640, 480, 700.0, 710.0, 319.5, 239.5, Mei(1.2, 0.1, 0.02, 0.003, -0.004))
    other = Intrinsics(640, 480, 700.0, 710.0, 319.5, 239.5, Mei(1.1, 0.1))
    rig = StereoRig(omni, other, rig.right_from_left)
    assert "xi1: 1.2\nxi2: 1.1\n" in opencv_yaml(rig)
    same_rig(parse_opencv_yaml(opencv_yaml(rig)), rig)
    with pytest.raises(
        InvalidRig, match="left lens is fisheye, right one omnidir: OpenCV takes two of one kind"
    ):
        opencv_yaml(StereoRig(fisheye, omni, rig.right_from_left))
    with pytest.raises(InvalidRig, match=r"lens fov with w 0\.9: OpenCV, beside fisheyes"):
        opencv_yaml(
            StereoRig.rectified(Intrinsics(640, 480, 700.0, 710.0, 319.5, 239.5, FieldOfView(0.9)), 0.1)
        )


@given(rigs())
def test_cv2_reads_every_digit_and_projects_alike(
    tmp_path_factory: pytest.TempPathFactory, rig: StereoRig
) -> None:
    path = tmp_path_factory.mktemp("opencv") / "stereo.yml"
    write_opencv_yaml(path, rig)
    K1, D1, K2, D2, R, T = stored(path, "K1", "D1", "K2", "D2", "R", "T")
    points_left = np.array([[0.1, -0.2, 3.0], [-0.3, 0.25, 4.0]])
    uv_left, uv_right = rig.project(points_left)
    found_left, _ = cv2.projectPoints(points_left, np.zeros(3), np.zeros(3), K1, D1)
    found_right, _ = cv2.projectPoints(points_left @ R.T + T[:, 0], np.zeros(3), np.zeros(3), K2, D2)
    for found, uv in ((found_left[:, 0], uv_left), (found_right[:, 0], uv_right)):
        seen = np.isfinite(uv)  # cv2 also projects what is behind a camera
        np.testing.assert_allclose(found[seen], uv[seen], rtol=1e-9, atol=1e-6)
    assert np.array_equal(R, rig.right_from_left.R)
    assert np.array_equal(K2, rig.right.K)


def test_stereo_rectify_agrees(tmp_path: Path) -> None:
    lens = Intrinsics(640, 480, 800.0, 800.0, 310.0, 245.0)
    rig = StereoRig.rectified(lens, 0.1)
    path = tmp_path / "stereo.yml"
    write_opencv_yaml(path, rig)
    K1, D1, K2, D2, R, T, *own = stored(path, "K1", "D1", "K2", "D2", "R", "T", "R1", "R2", "P1", "P2", "Q")
    found = cv2.stereoRectify(K1, D1, K2, D2, (640, 480), R, T, flags=cv2.CALIB_ZERO_DISPARITY, alpha=-1)
    R1, R2, P1, P2, Q = found[:5]
    for name, theirs, ours in zip(("R1", "R2"), (R1, R2), own[:2], strict=True):
        np.testing.assert_allclose(theirs, ours, atol=1e-9, err_msg=name)
    assert P2[0, 3] / P2[0, 0] == pytest.approx(own[3][0, 3] / own[3][0, 0])
    assert P1[0, 3] == own[2][0, 3] == 0
    # Q takes a disparity to the same point, whichever of the two rectified cameras it was seen with
    point = np.array([[0.2, -0.1, 2.0]])
    for projection_left, projection_right, reproject in ((P1, P2, Q), (own[2], own[3], own[4])):
        one = np.append(point[0], 1.0)
        a, b = projection_left @ one, projection_right @ one
        u, v, d = a[0] / a[2], a[1] / a[2], a[0] / a[2] - b[0] / b[2]
        back = reproject @ (u, v, d, 1.0)
        np.testing.assert_allclose(back[:3] / back[3], point[0], atol=1e-9)


def test_a_q_with_doffs_and_oblong_pixels_reprojects(tmp_path: Path) -> None:
    left = Intrinsics(640, 480, 900.0, 700.0, 330.0, 200.0)
    rig = StereoRig.rectified(left, 0.25, right=Intrinsics(640, 480, 900.0, 700.0, 300.0, 200.0))
    write_opencv_yaml(tmp_path / "stereo.yml", rig)
    (Q,) = stored(tmp_path / "stereo.yml", "Q")
    point = np.array([[0.3, -0.4, 5.0]])
    uv_left, uv_right = rig.project(point)
    back = Q @ (*uv_left[0], uv_left[0, 0] - uv_right[0, 0], 1.0)
    np.testing.assert_allclose(back[:3] / back[3], point[0], atol=1e-12)


def test_what_cv2_writes_is_read(tmp_path: Path) -> None:
    """Fewer digits, `1.` for 1.0, column vectors, and the sample program's names."""
    path = tmp_path / "extrinsics.yml"
    R = Pose.from_rotvec([0.01, -0.2, 0.03]).R
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", 640)
    storage.write("image_height", 480)
    K = np.array([[801.5, 0, 320], [0, 802.5, 240], [0, 0, 1]])
    storage.write("M1", K)
    storage.write("D1", np.array([[-0.1, 0.01, 1e-5, -2e-4, 0.0, 0, 0, 0]]).T)
    storage.write("M2", K)
    storage.write("D2", np.zeros((1, 5)))
    storage.write("R", R)
    storage.write("T", np.array([[-0.1], [0.0], [0.001]]))
    storage.release()
    rig = parse_opencv_yaml(path.read_text())
    assert rig.left.lens == BrownConrady(-0.1, 0.01, 1e-5, -2e-4)
    assert rig.right.lens is None
    np.testing.assert_allclose(rig.right_from_left.R, R, atol=1e-14)
    assert rig.right_from_left.t.tolist() == [-0.1, 0.0, 0.001]


GOOD = opencv_yaml(StereoRig.rectified(Intrinsics.from_focal(640, 480, 800.0), 0.1))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("K2:", "K3:", "K2 is missing"),
        ("image_width: 640", "", "image_width is missing"),
        ("image_width: 640", "image_width: 640.5", r"image_width 640.5 px: must be a whole number"),
        ("R: !!opencv-matrix\n   rows: 3", "R: !!opencv-matrix\n   rows: 2", "holds 9 values, must be 6"),
        ("data: [ 1.0, 0.0, 0.0", "data: [ 1.1, 0.0, 0.0", r"R is no rotation \(\|R R\^T - 1\| = 0.21"),
        ("data: [ 1.0, 0.0, 0.0", "data: [ -1.0, 0.0, 0.0", r"R is no rotation .*det = -1"),
        ("data: [ -0.1,", "data: [ 0.0,", "T 0, 0, 0: must be the way"),
        ("data: [ -0.1,", "data: [ .nan,", "nan: must be finite"),
        ("data: [ 800.0, 0.0,", "data: [ 800.0, 2.0,", "without skew"),
        ("data: [ 800.0, 0.0,", "data: [ -800.0, 0.0,", "fx -800 px: must be > 0"),
        ("data: [ 800.0, 0.0,", "data: [ fast, 0.0,", "fast: must be a number"),
        ("---", "--- [", "is not YAML: line"),
    ],
)
def test_bad_input_is_one_line(old: str, new: str, message: str) -> None:
    assert old in GOOD
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_opencv_yaml(GOOD.replace(old, new, 1))
    assert "\n" not in str(caught.value)


def test_a_rational_lens_projects_as_cv2_s() -> None:
    text = GOOD.replace(
        "cols: 5\n   dt: d\n   data: [ 0.0, 0.0, 0.0, 0.0, 0.0 ]",
        "cols: 8\n   dt: d\n   data: [ 0.1, 0.02, 1.0e-03, -2.0e-03, 0.01, 0.2, 0.03, 0.004 ]",
        1,
    )
    rig = parse_opencv_yaml(text)
    assert rig.left.lens == Rational(0.1, 0.02, 1e-3, -2e-3, 0.01, 0.2, 0.03, 0.004)
    assert rig.right.lens is None
    points = np.array([[0.4, -0.3, 1.0], [-0.2, 0.35, 1.0]])
    D = np.array([0.1, 0.02, 1e-3, -2e-3, 0.01, 0.2, 0.03, 0.004])
    found, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), rig.left.K, D)
    np.testing.assert_allclose(rig.left.project(points), found[:, 0], atol=1e-9)
