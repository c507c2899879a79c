"""mrcal's camera models: directions by hand, there and back, and as mrcal itself reads and projects them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked
from rigsim.interop.formats.photogrammetry.mrcal import FILE_NAMES, FORMAT, mrcal_files
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.rational import Rational
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.calibrations import read
from tests.helpers.rig_strategies import rigs, same_rig


def model(
    extrinsics: str, name: str = "LENSMODEL_OPENCV5", terms: str = ", 0.1, 0.2, 0.003, 0.004, 0.5"
) -> str:
    return (
        f"# made by hand\n{{\n  'lensmodel':  '{name}',\n  # fx,fy,cx,cy\n  'intrinsics': [ 1700.0, 1710.0,"
        f" 1999.5, 1000{terms},],\n  'extrinsics': [ {extrinsics} ],\n  'imagersize': [ 4000, 2200,],\n"
        "  'icam_intrinsics': 0,\n"
        "  'optimization_inputs': b'{(0A[' }\n"
    )


QUARTER = f"0, 0, {np.pi / 2!r}, "  # turns x to y


def test_poses_by_hand() -> None:
    found = read(FORMAT, model("0,0,0, 1, 0, 0"), model(QUARTER + "0, 0, 3"))
    # (0, 0, 0) of the left camera is (-1, 0, 0) of the common frame, (0, -1, 3) of the right camera
    np.testing.assert_allclose(found.rig.right_from_left.apply([0.0, 0, 0]), [0, -1, 3], atol=1e-12)
    np.testing.assert_allclose(found.rig.right_from_left.apply([1.0, 0, 0]), [0, 0, 3], atol=1e-12)
    assert found.rig.left == Intrinsics(
        4000, 2200, 1700, 1710, 1999.5, 1000, BrownConrady(0.1, 0.2, 0.003, 0.004, 0.5)
    )
    assert found.unit is None
    newer = model("0,0,0, 0,0,0").replace("extrinsics", "rt_cam_ref"), model("0,0,0, -1,0,0")
    assert read(FORMAT, *newer).rig.right_from_left == Pose(t=np.array([-1.0, 0, 0]))


@given(rigs())
def test_there_and_back(rig: StereoRig) -> None:
    same_rig(read(FORMAT, *mrcal_files(rig).items()).rig, rig)


def test_written_models() -> None:
    terms = tuple(0.01 * i for i in range(1, 13))
    for lens, name in (
        (None, "PINHOLE"),
        (BrownConrady(0.1), "OPENCV4"),
        (BrownConrady(k3=0.1), "OPENCV5"),
        (Rational(*terms[:8]), "OPENCV8"),
        (Rational(*terms), "OPENCV12"),
    ):
        rig = StereoRig.rectified(Intrinsics(640, 480, 500, 501, 320, 240, lens), 0.1)
        texts = mrcal_files(rig)
        assert f"'LENSMODEL_{name}'" in texts["right.cameramodel"]
        same_rig(read(FORMAT, *texts.items()).rig, rig)
    for lens, says in ((KannalaBrandt(0.1), "OpenCV's terms alone"), (Rational(tau_x=0.1), "no tilt")):
        with pytest.raises(InvalidRig, match=says):
            mrcal_files(StereoRig.rectified(Intrinsics(640, 480, 500, 501, 320, 240, lens), 0.1))


def test_more_than_two() -> None:
    files = [(f"camera-{i}.cameramodel", model(f"0,0,0, {-i}, 0, 0")) for i in range(3)]
    assert read(FORMAT, *files, asked=Asked(cameras=("0", "camera-2"))).rig.baseline_m == 2
    with pytest.raises(InvalidRig, match="3 cameras: choose two"):
        read(FORMAT, *files)
    swapped = read(FORMAT, ("right.cameramodel", files[1][1]), ("left.cameramodel", files[0][1]), files[2])
    assert swapped.rig.right_from_left.t[0] == -1
    assert FORMAT.groups is not None
    assert FORMAT.groups([]) == []


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (model("0,0,0,0,0,0", "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30"), "mrcal-convert-lensmodel"),
        (model("0,0,0,0,0,0", "LENSMODEL_CAHVOR"), "mrcal-convert-lensmodel"),
        (model("0,0,0,0,0"), "extrinsics of 0.txt: holds 5 values, must be 6"),
        (model("__import__('os').system('false'),0,0,0,0,0"), "no table of values"),
        (model("(" * 100_000), "no table of values"),
        (model("0," * 200_000), "characters"),
        (model("1e999,0,0,0,0,0"), "must be finite"),
        (model("0,0,0,0,0,0", "LENSMODEL_OPENCV8"), "must be 12"),
    ],
)
def test_what_is_none(text: str, says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        read(FORMAT, text, model("0,0,0, -1,0,0"))


def test_names() -> None:
    assert tuple(mrcal_files(StereoRig.rectified(Intrinsics(64, 48, 50, 50, 32, 24), 0.1))) == FILE_NAMES
