"""What rs-enumerate-devices -c prints: streams, resolutions, models and the printed rotation by hand."""

from __future__ import annotations

import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked
from rigsim.interop.formats.makers.realsense import FORMAT
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from tests.helpers.calibrations import read


def intrinsic(
    name: str,
    size: str,
    focal: float,
    model: str = "Brown Conrady",
    terms: str = "0 0 0 0 0",
    formats: str = "Y8",
) -> str:
    width, height = size.split("x")
    shown = "".join(f"\t{term}  " for term in terms.split())
    return (
        f' Intrinsic of "{name}" / {size} / {{{formats}}}\n  Width:      \t{width}\n'
        f"  Height:     \t{height}\n  PPX:        \t{int(width) / 2 + 1}\n"
        f"  PPY:        \t{int(height) / 2 - 2}\n  Fx:         \t{focal}\n"
        f"  Fy:         \t{focal + 1}\n  Distortion: \t{model}\n  Coeffs:     {shown}\n"
        "  FOV (deg):  \t87.1 x 56.2\n\n"
    )


def extrinsic(start: str, end: str, t: str, R: str = "   1   0   0\n   0   1   0\n   0   0   1\n") -> str:
    return (
        f'Extrinsic from "{start}"\t  To\t  "{end}" :\n Rotation Matrix:\n{R}\n Translation Vector: {t}  \n\n'
    )


# x turns by 30 degrees towards y, as MuJoCo's and OpenCV's matrices are written
TURNED = "   0.866025    -0.5           0\n   0.5            0.866025    0\n   0   0   1\n"
D435 = (
    "Device info: \n    Name                          : \tIntel RealSense D435\n\nIntrinsic Parameters:\n\n"
    + intrinsic("Color", "1280x720", 900.0, "Inverse Brown Conrady")
    + intrinsic("Infrared 1", "640x480", 380.0)
    + intrinsic("Infrared 1", "1280x720", 640.0)
    + intrinsic("Infrared 1", "1920x1080", 1400.0, terms="0.1 0 0 0 0", formats="Y16")
    + intrinsic("Infrared 2", "640x480", 381.0)
    + intrinsic("Infrared 2", "1280x720", 641.0)
    + intrinsic("Infrared 2", "1920x1080", 1401.0, formats="Y16")
    + "\nExtrinsic Parameters:\n"
    + extrinsic("Infrared 2", "Infrared 1", "0.05  0  0")
    + extrinsic("Infrared 1", "Infrared 2", "-0.05  0.001  0.002", TURNED)
    + extrinsic("Infrared 1", "Color", "0.015  0  0")
)


def test_infrared_pair_by_hand() -> None:
    found = read(FORMAT, D435)
    rig = found.rig
    # the largest picture that the camera rectifies, not the raw one
    assert (rig.left.width, rig.left.fx, rig.left.fy, rig.left.cx, rig.left.cy) == (
        1280,
        640.0,
        641.0,
        641.0,
        358.0,
    )
    assert rig.right.fx == 641.0
    assert rig.left.lens is None
    np.testing.assert_array_equal(rig.right_from_left.t, [-0.05, 0.001, 0.002])
    np.testing.assert_allclose(rig.right_from_left.R[:2, :2], [[0.866025, -0.5], [0.5, 0.866025]], atol=1e-6)
    assert found.unit == "m"
    assert [remark.code for remark in found.remarks] == ["mode"]


def test_choices() -> None:
    found = read(FORMAT, D435, asked=Asked(mode="640x480"))
    assert (found.rig.left.width, found.rig.right.fx, found.remarks) == (640, 381.0, ())
    raw = read(FORMAT, D435, asked=Asked(mode="1920x1080")).rig
    assert raw.left.lens == BrownConrady(0.1)
    # the colour camera sees the left one at +15 mm: it lies at -15 mm, on the left side
    colour = read(FORMAT, D435, asked=Asked(cameras=("Color", "Infrared 1"))).rig
    np.testing.assert_allclose(colour.right_from_left.t, [-0.015, 0, 0])
    with pytest.raises(InvalidRig, match="mode 5x5: must be one of 1280x720, 640x480, 1920x1080"):
        read(FORMAT, D435, asked=Asked(mode="5x5"))


def test_tracking_camera_and_older_print() -> None:
    text = (
        'Intrinsic of "Fisheye 1"\t  848x800\t  {Y8}\n  Width:      \t848\n  Height:     \t800\n  PPX: 424\n'
        "  PPY: 400\n  Fx: 286\n  Fy: 287\n  Distortion: \tKannala Brandt4\n"
        "  Coeffs: -0.01 0.04 -0.04 0.006 0\n\n"
        + intrinsic("Fisheye 2", "848x800", 285.0, "Ftheta", "0.9 0 0 0 0")
        + extrinsic("Fisheye 1", "Fisheye 2", "-0.064  0  0")
    )
    found = read(FORMAT, text.replace("\n", "\r\n"))
    assert found.rig.left.lens == KannalaBrandt(-0.01, 0.04, -0.04, 0.006)
    assert found.rig.right.lens == FieldOfView(0.9)
    assert found.rig.right_from_left.t[0] == -0.064
    assert not found.remarks


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (D435.replace("Infrared 2", "Depth"), "no Infrared 1 and 2"),
        (D435 + D435, "describes 2 devices"),
        (
            D435.replace(
                "Brown Conrady\n  Coeffs:     \t0  ", "Inverse Brown Conrady\n  Coeffs:     \t0.2  "
            ),
            "maps pixels to rays",
        ),
        (D435.replace("Brown Conrady", "Fancy"), "distortion of Infrared 1 Fancy: must be"),
    ],
)
def test_what_is_none(text: str, says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        read(FORMAT, text)
