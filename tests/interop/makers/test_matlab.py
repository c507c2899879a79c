"""MATLAB's structs: pixels from 1, transposed matrices, both generations of names; files that are none."""

from __future__ import annotations

import contextlib
import io
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from scipy.io import savemat

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked
from rigsim.interop.formats.makers.mat5 import mat5_variables
from rigsim.interop.formats.makers.matlab import FORMAT
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.stereo import StereoRig
from tests.helpers.calibrations import read
from tests.helpers.rig_strategies import rigs, same_rig


def saved(name: str = "s", compressed: bool = False, **table: Any) -> bytes:
    file = io.BytesIO()
    savemat(file, {name: table}, do_compression=compressed)
    return file.getvalue()


def camera(**others: Any) -> dict[str, Any]:
    return {
        "IntrinsicMatrix": np.array([[800.0, 0, 0], [0, 810.0, 0], [321.0, 241.0, 1]]),
        "RadialDistortion": np.array([[-0.1, 0.02]]),
        "TangentialDistortion": np.array([[0.003, -0.004]]),
        "ImageSize": np.array([[480.0, 640.0]]),
        "WorldUnits": "millimeters",
    } | others


TURN = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])  # x2 = TURN x1: x turns towards y
OLD = {
    "CameraParameters1": camera(),
    "CameraParameters2": camera(
        RadialDistortion=np.array([[0.1, 0.2, 0.3]]), TangentialDistortion=np.zeros((1, 2))
    ),
    "RotationOfCamera2": TURN.T,
    "TranslationOfCamera2": np.array([[-120.0, 3.0, 4.0]]),
}


@pytest.mark.parametrize("compressed", [False, True])
def test_old_names_by_hand(compressed: bool) -> None:
    found = read(FORMAT, saved(compressed=compressed, **OLD))
    rig = found.rig
    # the first pixel's middle is (1, 1) there, (0, 0) here
    assert (rig.left.width, rig.left.height, rig.left.cx, rig.left.cy) == (640, 480, 320.0, 240.0)
    assert rig.left.project([0.0, 0.0, 2.0]).tolist() == [320.0, 240.0]
    assert rig.left.lens == BrownConrady(-0.1, 0.02, 0.003, -0.004)
    assert rig.right.lens == BrownConrady(0.1, 0.2, 0.0, 0.0, 0.3)
    # MATLAB's row: [1 0 0] * RotationOfCamera2 + t, mm
    np.testing.assert_allclose(rig.right_from_left.apply([1.0, 0, 0]), [0.8 - 0.12, 0.6 + 0.003, 0.004])
    assert found.unit == "m"
    assert not found.remarks


def test_new_names_and_no_unit() -> None:
    K = np.array([[800.0, 0, 321.0], [0, 810.0, 241.0], [0, 0, 1]])
    plain = {"K": K, "ImageSize": np.array([[480.0, 640.0]])}
    A = np.eye(4)
    A[:3, :3], A[:3, 3] = TURN, (-5.0, 0, 0)
    for pose in ({"A": A}, A, {"R": TURN, "Translation": np.array([[-5.0, 0, 0]])}):
        table = {"CameraParameters1": plain, "CameraParameters2": plain, "PoseCamera2": pose}
        found = read(FORMAT, saved("session", inner=table))
        assert found.unit is None
        assert found.rig.left == Intrinsics(640, 480, 800, 810, 320, 240)
        np.testing.assert_allclose(found.rig.right_from_left.R, TURN)
        np.testing.assert_allclose(found.rig.right_from_left.t, [-5, 0, 0])


@given(rigs(distorted=False))
def test_there_and_back(rig: StereoRig) -> None:
    one_based = np.array([[0, 0, 1.0], [0, 0, 1], [0, 0, 0]])
    tables = {
        f"CameraParameters{i}": {
            "IntrinsicMatrix": (side.K + one_based).T,
            "ImageSize": np.array([[side.height, side.width]]),
            "WorldUnits": "m",
        }
        for i, side in enumerate((rig.left, rig.right), start=1)
    }
    pose = {"RotationOfCamera2": rig.right_from_left.R.T, "TranslationOfCamera2": rig.right_from_left.t[None]}
    same_rig(read(FORMAT, saved(**tables, **pose)).rig, rig)


def test_without_a_size() -> None:
    bare = camera(ImageSize=np.zeros((0, 0)))
    content = saved(**OLD | {"CameraParameters1": bare, "CameraParameters2": bare})
    assert [remark.code for remark in read(FORMAT, content).remarks] == ["no_size"]
    assert read(FORMAT, content, asked=Asked(size_px=(700, 500))).rig.left.width == 700


def test_whatever_is_cut_or_changed_is_one_line() -> None:
    content = saved(**OLD)
    for place in range(128, len(content), 7):
        for broken in (
            content[:place],
            content[:place] + bytes([255 - content[place]]) + content[place + 1 :],
        ):
            with contextlib.suppress(InvalidRig):
                assert read(FORMAT, broken).rig.baseline_m > 0


def test_every_class_of_numbers_is_read() -> None:
    for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8", "i8", "u8", "?"):
        values = np.array([[1, 0, 1], [0, 1, 100 if kind != "?" else 1]]).astype(kind)
        found = mat5_variables(saved(inner={"values": values, "text": "mm", "cell": [1.0]}))["s"]
        assert isinstance(found, dict)
        np.testing.assert_array_equal(found["inner"]["values"], values)
        assert found["inner"]["text"] == "mm"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"MATLAB 7.3 MAT-file, Platform: GLNXA64", "-v7"),
        (saved(**OLD)[:900], "no whole MAT-file"),
        (saved(other=1.0), "no struct with CameraParameters1 and 2"),
        (saved(**OLD | {"RotationOfCamera2": 2 * TURN}), "RotationOfCamera2 is no rotation"),
        (saved(compressed=True, zeros=np.zeros(8_000_000)), "unpacks to over 50 MB"),
        (
            saved(**OLD | {"CameraParameters1": camera(IntrinsicMatrix=np.eye(2))}),
            "IntrinsicMatrix of CameraParam",
        ),
    ],
)
def test_what_is_none(content: bytes, says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        read(FORMAT, content)
