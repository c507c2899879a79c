"""OKVIS's settings, whose matrices map a camera's frame to the sensor's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.calibration import read
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.slam import okvis
from rigsim.interop.formats.slam.okvis import parse_okvis
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from tests.helpers.bodies import BODY_FROM_LEFT, BODY_FROM_RIGHT, check_pose, found, matrix

THIRD = matrix((0.3, 0.01, -0.2), (0.02, 0.01, 0.09))
FOUR = "0.1, 0.2, 0.3, 0.4"


def camera(T: np.ndarray, fx: float = 400.0, kind: str = "radialtangential", terms: str = FOUR) -> str:
    first, *others = (", ".join(repr(float(value)) for value in row) for row in T)
    rest = ",\n          ".join(others)
    return (
        f"     - {{T_SC:\n        [ {first},\n          {rest}],\n        image_dimension: [640, 480],\n"
        f"        distortion_coefficients: [{terms}],\n        distortion_type: {kind},\n"
        f"        focal_length: [{fx}, 401],\n        principal_point: [320, 240]}}\n\n"
    )


def settings(*cameras: str) -> str:
    return (
        f"%YAML:1.0\ncameras:\n{''.join(cameras)}\ncamera_params:\n    camera_rate: 20 # frames\n\n"
        "imu_params:\n    a_max: 170.0\n    T_BS:\n        [1, 0, 0, 0,\n         0, 1, 0, 0,\n"
        "         0, 0, 1, 0,\n         0, 0, 0, 1]\n"
    )


PAIR = settings(camera(BODY_FROM_LEFT), camera(BODY_FROM_RIGHT, 410))


def test_the_right_camera_lies_where_its_matrix_says_by_hand() -> None:
    """The body's axes are the left camera's: the right one is 120 mm along x, turned 90 degrees about y."""
    left, right = np.eye(4), np.eye(4)
    right[:3] = [[0, 0, 1, 0.12], [0, 1, 0, 0.03], [-1, 0, 0, 0.2]]
    pose = parse_okvis(settings(camera(left), camera(right))).rig.right_from_left
    np.testing.assert_allclose(pose.inverse.t, [0.12, 0.03, 0.2], atol=1e-15)
    np.testing.assert_allclose(pose.t, [0.2, -0.03, -0.12], atol=1e-15)
    np.testing.assert_allclose(pose.rotvec_rad, [0, -np.pi / 2, 0], atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "terms", "lens"),
    [
        ("radialtangential", FOUR, BrownConrady(0.1, 0.2, 0.3, 0.4)),
        ("equidistant", FOUR, KannalaBrandt(0.1, 0.2, 0.3, 0.4)),
        (
            "radialtangential8",
            f"{FOUR}, 0.5, 0.6, 0.7, 0.8",
            Rational(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8),
        ),
    ],
)
def test_every_lens(kind: str, terms: str, lens: Lens) -> None:
    pair = settings(camera(BODY_FROM_LEFT, 400, kind, terms), camera(BODY_FROM_RIGHT, 410, kind, terms))
    one = found(okvis.FORMAT, [File(Path("any"), pair)])
    check_pose(one.rig)
    assert one.rig.left == Intrinsics(640, 480, 400, 401, 320, 240, lens)
    assert one.rig.right == Intrinsics(640, 480, 410, 401, 320, 240, lens)
    assert (one.unit, one.remarks) == ("m", ())


def test_three_cameras() -> None:
    text = settings(camera(BODY_FROM_LEFT), camera(THIRD), camera(BODY_FROM_RIGHT))
    check_pose(parse_okvis(text, Asked(cameras=("0", "2"))).rig)
    check_pose(parse_okvis(text, Asked(cameras=("cam2", "cam0"))).rig, BODY_FROM_RIGHT, BODY_FROM_LEFT)
    first = parse_okvis(text)
    check_pose(first.rig, BODY_FROM_LEFT, THIRD)
    assert [remark.code for remark in first.remarks] == ["cameras"]


def test_no_other_format_takes_it(tmp_path: Path) -> None:
    path = tmp_path / "config.txt"
    path.write_text(PAIR)
    for named in (path, tmp_path):
        one = read([named])
        check_pose(one.rig)
        assert (one.format, one.unit) == ("okvis", "m")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "radialtangential,",
            "cubic,",
            "distortion_type of cam0 cubic: must be one of radialtangential, r",
        ),
        ("radialtangential,", "radialtangential8,", "coefficients of cam0: holds 4 values, must be 8"),
        ("[640, 480]", "[640]", "image_dimension of cam0: holds 1 values, must be 2"),
        ("[ ", "[ 1, ", "T_SC of cam0: holds 17 values, must be 16"),
        ("[400.0, 401]", "[-400.0, 401]", "cam0: .*-400"),
        ("focal_length", "focal", "focal_length of cam0 is missing"),
    ],
)
def test_bad_files_are_one_line(old: str, new: str, message: str) -> None:
    assert old in PAIR
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_okvis(PAIR.replace(old, new, 1))
    assert "\n" not in str(caught.value)


def test_one_camera_is_no_rig() -> None:
    with pytest.raises(InvalidRig, match="has one camera, cam0: a rig has two"):
        parse_okvis(settings(camera(BODY_FROM_LEFT)))
    with pytest.raises(InvalidRig, match="cameras 3: must be a list of cameras"):
        parse_okvis("cameras: 3\n")
