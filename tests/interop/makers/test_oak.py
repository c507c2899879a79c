"""DepthAI's JSON: centimetres, directions and chains of extrinsics by hand; there and back for any rig."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked
from rigsim.interop.formats.makers.oak import FORMAT
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.rational import Rational
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.calibrations import read
from tests.helpers.rig_strategies import rigs, same_rig

QUARTER = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]  # x turns to y


def camera(**others: Any) -> dict[str, Any]:
    return {
        "cameraType": 0,
        "width": 1280,
        "height": 800,
        "intrinsicMatrix": [[801.0, 0, 642.0], [0, 802.0, 395.0], [0, 0, 1]],
        "distortionCoeff": [0.0] * 14,
        "extrinsics": {"rotationMatrix": [], "toCameraSocket": -1, "translation": {"x": 0, "y": 0, "z": 0}},
    } | others


def extrinsics(to: int, x: float, y: float, z: float, R: Any = None) -> dict[str, Any]:
    return {
        "rotationMatrix": np.eye(3).tolist() if R is None else R,
        "toCameraSocket": to,
        "translation": {"x": x, "y": y, "z": z},
        "specTranslation": {"x": -7.5, "y": 0, "z": 0},
    }


def eeprom(cameras: dict[int, dict[str, Any]], left: int = 1, right: int = 2) -> str:
    stereo = {"leftCameraSocket": left, "rightCameraSocket": right}
    return json.dumps(
        {"cameraData": [list(item) for item in cameras.items()], "stereoRectificationData": stereo}
    )


def test_left_to_right_by_hand() -> None:
    terms = [0.1, 0.2, 0.003, 0.004, 0.5, 0.6, 0.7, 0.8] + [0.0] * 6
    left = camera(extrinsics=extrinsics(2, -7.5, 0.2, 0.1, QUARTER), distortionCoeff=terms)
    found = read(FORMAT, eeprom({0: camera(), 1: left, 2: camera(width=640, height=400)}))
    assert found.unit == "m"
    assert not found.remarks
    rig = found.rig
    np.testing.assert_allclose(rig.right_from_left.t, [-0.075, 0.002, 0.001])
    np.testing.assert_array_equal(rig.right_from_left.R, QUARTER)
    assert rig.left.lens == Rational(0.1, 0.2, 0.003, 0.004, 0.5, 0.6, 0.7, 0.8)
    assert (rig.left.fx, rig.left.cy, rig.right.width, rig.right.lens) == (801.0, 395.0, 640, None)


def test_both_lead_to_the_colour_camera() -> None:
    # from left: turned, then 3 cm; from right: 4 cm along its own x
    left = camera(extrinsics=extrinsics(0, -3.0, 0.0, 0.0, QUARTER))
    right = camera(extrinsics=extrinsics(0, 4.0, 0.0, 0.0))
    rig = read(FORMAT, eeprom({0: camera(), 1: left, 2: right}, -1, -1)).rig
    # the left camera's (1, 0, 0) m is (-0.03, 1, 0) of the colour camera, (-0.07, 1, 0) of the right one
    np.testing.assert_allclose(rig.right_from_left.apply([1.0, 0.0, 0.0]), [-0.07, 1.0, 0.0], atol=1e-12)
    swapped = read(FORMAT, eeprom({0: camera(), 1: left, 2: right}), asked=Asked(cameras=("right", "0"))).rig
    np.testing.assert_allclose(swapped.right_from_left.t, [0.04, 0.0, 0.0])


@given(rigs(distorted=False))
def test_flat_form_there_and_back(rig: StereoRig) -> None:
    left = rig.left
    rig = StereoRig(left, Intrinsics(left.width, left.height, 500.0, 501.0, 3.0, 4.0), rig.right_from_left)
    table = {
        "width": rig.left.width,
        "height": rig.left.height,
        "left_intrinsics": rig.left.K.tolist(),
        "right_intrinsics": rig.right.K.tolist(),
        "rotation_left_to_right": rig.right_from_left.R.tolist(),
        "translation_left_to_right": (100 * rig.right_from_left.t[:, None]).tolist(),
        "distortion_left": [0.0] * 14,
    }
    same_rig(read(FORMAT, json.dumps(table)).rig, rig)


def test_fisheye_and_a_translation_that_was_not_measured() -> None:
    fisheye = camera(cameraType=1, distortionCoeff=[0.1, 0.2, 0.3, 0.4] + [0.0] * 10)
    left = fisheye | {"extrinsics": extrinsics(2, 0.0, 0.0, 0.0)}
    found = read(FORMAT, eeprom({1: left, 2: fisheye}))
    assert found.rig.left.lens == found.rig.right.lens == KannalaBrandt(0.1, 0.2, 0.3, 0.4)
    assert found.rig.right_from_left == Pose(t=np.array([-0.075, 0, 0]))
    assert [remark.code for remark in found.remarks] == ["spec_translation"]


@pytest.mark.parametrize(
    ("cameras", "says"),
    [
        ({1: camera(), 2: camera()}, "no extrinsics lead from camera 1 to camera 2"),
        ({0: camera()}, "no stereo pair"),
        ({1: camera(extrinsics=extrinsics(2, 1, 0, 0, [[1, 0, 0]] * 3)), 2: camera()}, "is no rotation"),
        ({1: camera(cameraType=2, extrinsics=extrinsics(2, 1, 0, 0)), 2: camera()}, "equirectangular"),
        ({1: camera(width=0, extrinsics=extrinsics(2, 1, 0, 0)), 2: camera()}, "--rig-size"),
    ],
)
def test_what_is_none(cameras: dict[int, dict[str, Any]], says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        read(FORMAT, eeprom(cameras))
