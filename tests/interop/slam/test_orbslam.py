"""ORB-SLAM's stereo settings, old and new."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.slam import orbslam
from rigsim.interop.formats.slam.orbslam import parse_orbslam
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.bodies import BODY_FROM_LEFT, BODY_FROM_RIGHT, check_pose, found, opencv
from tests.helpers.rig_strategies import same_rig

SIZE = "Camera.width: 640\nCamera.height: 480\n"
LEFT_FROM_RIGHT = np.linalg.inv(BODY_FROM_LEFT) @ BODY_FROM_RIGHT


def ends(name: str, fx: float = 400.0, **terms: float) -> str:
    values = {"fx": fx, "fy": 401.0, "cx": 320.0, "cy": 240.0, **terms}
    return "".join(f"{name}.{key}: {value}\n" for key, value in values.items())


def third(text: str) -> StereoRig:
    read = found(orbslam.FORMAT, [File(Path("settings"), f"%YAML:1.0\n\n{text}")])
    assert (read.unit, read.remarks) == ("m", ())
    return read.rig


def test_two_pinholes_of_the_third() -> None:
    rig = third(
        'Camera.type: "PinHole"\n'
        + ends("Camera1", k1=0.1, k2=0.2, p1=0.3, p2=0.4)
        + ends("Camera2", 410.0, k1=0.1, k2=0.2, p1=0.3, p2=0.4, k3=0.5)
        + SIZE
        + opencv("Stereo.T_c1_c2", LEFT_FROM_RIGHT)
    )
    check_pose(rig)
    assert rig.left == Intrinsics(640, 480, 400, 401, 320, 240, BrownConrady(0.1, 0.2, 0.3, 0.4))
    assert rig.right == Intrinsics(640, 480, 410, 401, 320, 240, BrownConrady(0.1, 0.2, 0.3, 0.4, 0.5))


@pytest.mark.parametrize(
    ("first", "pose"),
    [("Camera1", opencv("Stereo.T_c1_c2", LEFT_FROM_RIGHT)), ("Camera", opencv("Tlr", LEFT_FROM_RIGHT[:3]))],
)
def test_two_fisheyes_of_the_third(first: str, pose: str) -> None:
    terms = {"k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4}
    rig = third(
        'Camera.type: "KannalaBrandt8"\n' + ends(first, **terms) + ends("Camera2", **terms) + SIZE + pose
    )
    check_pose(rig)
    assert rig.left.lens == rig.right.lens == KannalaBrandt(0.1, 0.2, 0.3, 0.4)


def test_rectified_pictures() -> None:
    camera = Intrinsics(640, 480, 400, 401, 320, 240)
    new = third('Camera.type: "Rectified"\n' + ends("Camera1") + SIZE + "Stereo.b: 0.12\n")
    assert new == StereoRig(camera, camera, Pose(t=np.array([-0.12, 0.0, 0.0])))
    old = third(ends("Camera", k1=0.0) + SIZE + "Camera.bf: 48.0\n")  # 400 px * 0.12 m
    same_rig(old, new, 1e-15)
    swapped = parse_orbslam(ends("Camera") + SIZE + "Camera.bf: 48.0\n").rig
    assert (
        found(
            orbslam.FORMAT,
            [File(Path("a"), ends("Camera") + SIZE + "Camera.bf: 48.0\n")],
            Asked(cameras=("right", "left")),
        ).rig.right_from_left.t[0]
        == -swapped.right_from_left.t[0]
    )


def before_rectifying(bf: float | None = None) -> tuple[str, StereoRig]:
    R, T = cv2.Rodrigues(np.array([0.01, -0.05, 0.02]))[0], np.array([-0.12, 0.004, -0.003])
    K = [
        np.array([[810.0, 0, 330], [0, 805, 236], [0, 0, 1]]),
        np.array([[790.0, 0, 315], [0, 792, 244], [0, 0, 1]]),
    ]
    D = [np.array([-0.2, 0.05, 1e-3, -2e-3, 0.01]), np.array([-0.18, 0.04, -1e-3, 5e-4, 0.0])]
    R1, R2, P1, P2, *_ = cv2.stereoRectify(K[0], D[0], K[1], D[1], (640, 480), R, T[:, None], flags=0)
    text = f"Camera.fx: {P1[0, 0]}\nCamera.fy: {P1[1, 1]}\nCamera.cx: 1.0\nCamera.cy: 1.0\n{SIZE}"
    text += f"Camera.bf: {-P2[0, 3] if bf is None else bf}\n"
    for side, values in (("LEFT", (K[0], D[0], R1, P1)), ("RIGHT", (K[1], D[1], R2, P2))):
        text += f"{side}.width: 640\n{side}.height: 480\n"
        for key, value in zip("KDRP", values, strict=True):
            text += opencv(f"{side}.{key}", np.atleast_2d(value)).replace("data: [", "data:[")
    cameras = [
        Intrinsics(640, 480, k[0, 0], k[1, 1], k[0, 2], k[1, 2], BrownConrady(*d))
        for k, d in zip(K, D, strict=True)
    ]
    return text, StereoRig(cameras[0], cameras[1], Pose(R, T))


def test_what_cv2_rectified_is_the_rig_that_it_was() -> None:
    text, rig = before_rectifying()
    same_rig(third(text), rig)
    text, rig = before_rectifying(bf=55.0)
    read = parse_orbslam(text)
    same_rig(read.rig, rig)
    assert [remark.code for remark in read.remarks] == ["baselines_differ"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (ends("Camera") + "Camera.bf: 40\nDepthMapFactor: 1000\n", "settings of a depth camera"),
        (ends("Camera1") + SIZE, "neither Stereo.T_c1_c2, Stereo.b nor Camera.bf is there"),
        (
            ends("Camera1") + 'Camera.type: "Spline"\nStereo.b: 1\n' + SIZE,
            "Camera.type Spline: must be PinHole",
        ),
        (
            ends("Camera1", k1=0.1) + 'Camera.type: "KannalaBrandt8"\n' + SIZE + "Stereo.b: 1\n",
            "Camera1.k2 is missing: KannalaBrandt8 has k1, k2, k3, k4",
        ),
        (ends("Camera1") + SIZE + opencv("Stereo.T_c1_c2", LEFT_FROM_RIGHT), r"Camera2.fx is missing"),
        ("Camera1.fx: 4\nCamera1.fy: [", "is not YAML"),
    ],
)
def test_bad_settings_are_one_line(text: str, message: str) -> None:
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_orbslam(text)
    assert "\n" not in str(caught.value)


def test_a_size_is_asked_for() -> None:
    text = ends("Camera1") + "Stereo.b: 0.1\n"
    read = parse_orbslam(text, Asked(size_px=(650, 490)))
    assert (read.rig.left.width, read.rig.left.height, read.remarks) == (650, 490, ())
    assert [remark.code for remark in parse_orbslam(text).remarks] == ["no_size"]
    assert "is ORB-SLAM's settings of one camera" in str(orbslam.lacks(File(Path("a"), ends("Camera"))))
