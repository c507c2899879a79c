"""Basalt's calibration: by hand, from a body's matrices, and there and back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.robotics import basalt
from rigsim.interop.formats.robotics.basalt import basalt_json, parse_basalt
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.double_sphere import DoubleSphere
from rigsim.rig.lens.eucm import Eucm
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.rational import Rational
from rigsim.rig.stereo import StereoRig
from tests.helpers.bodies import BODY_FROM_LEFT, BODY_FROM_RIGHT, check_pose, found, matrix
from tests.helpers.rig_strategies import rigs, same_rig

ENDS = {"fx": 300.0, "fy": 301.0, "cx": 320.0, "cy": 240.0}
RADTAN = dict(zip(("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"), np.arange(1, 9) / 100, strict=True))


def place(body_from_camera: np.ndarray) -> dict[str, float]:
    """A camera's entry, its quaternion as scipy has it: x, y, z, w."""
    q = Rotation.from_matrix(body_from_camera[:3, :3]).as_quat()
    values = (*body_from_camera[:3, 3], *q)
    return dict(zip(("px", "py", "pz", "qx", "qy", "qz", "qw"), map(float, values), strict=True))


def text(*cameras: tuple[str, dict[str, float]], places: tuple[np.ndarray, ...] = ()) -> str:
    table = {
        "T_imu_cam": [place(one) for one in places or (BODY_FROM_LEFT, BODY_FROM_RIGHT)],
        "intrinsics": [{"camera_type": kind, "intrinsics": ENDS | terms} for kind, terms in cameras],
        "resolution": [[640, 480 + i] for i in range(len(cameras))],
        "vignette": [],
    }
    return json.dumps({"value0": table})


def test_a_body_s_cameras() -> None:
    (file,) = [File(Path("any.name"), text(("pinhole", {}), ("ds", {"xi": -0.2, "alpha": 0.6})))]
    read = found(basalt.FORMAT, [file])
    check_pose(read.rig)
    assert read.rig.left == Intrinsics(640, 480, 300, 301, 320, 240)
    assert read.rig.right == Intrinsics(640, 481, 300, 301, 320, 240, DoubleSphere(-0.2, 0.6))
    assert (read.unit, read.remarks) == ("m", ())


def test_cameras_of_three() -> None:
    third = matrix((0.3, 0.01, -0.2), (0.02, 0.01, 0.09))
    three = text(*[("pinhole", {})] * 3, places=(BODY_FROM_LEFT, third, BODY_FROM_RIGHT))
    check_pose(parse_basalt(three, Asked(cameras=("0", "2"))).rig)
    usual = parse_basalt(three)
    check_pose(usual.rig, BODY_FROM_LEFT, third)
    assert [remark.code for remark in usual.remarks] == ["cameras"]


@pytest.mark.parametrize(
    ("kind", "terms", "lens"),
    [
        ("ds", {"xi": -0.2, "alpha": 0.6}, DoubleSphere(-0.2, 0.6)),
        ("eucm", {"alpha": 0.6, "beta": 1.1}, Eucm(0.6, 1.1)),
        ("ucm", {"alpha": 0.6}, Eucm(0.6, 1.0)),
        ("kb4", {"k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4}, KannalaBrandt(0.1, 0.2, 0.3, 0.4)),
        ("fov", {"w": 0.9}, FieldOfView(0.9)),
        ("pinhole-radtan8", RADTAN | {"rpmax": 0.0}, Rational(*RADTAN.values())),
        ("pinhole-radtan5", RADTAN, BrownConrady(*list(RADTAN.values())[:5])),
    ],
)
def test_every_lens_by_hand(kind: str, terms: dict[str, float], lens: Lens) -> None:
    assert parse_basalt(text((kind, terms), ("pinhole", {}))).rig.left.lens == lens


LENSES = st.sampled_from(
    [
        None,
        BrownConrady(-0.2, 0.05, 1e-5, -2e-4, 0.01),
        Rational(-0.2, 0.05, 1e-5, -2e-4, 0.01, 0.1, 0.2, 1e-3),
        KannalaBrandt(0.01, -0.02, 3e-5, 0.001),
        DoubleSphere(-0.17, 0.59),
        Eucm(0.58, 1.12),
        FieldOfView(0.92),
    ]
)


@given(rigs(angle_rad=1.5), LENSES, LENSES)
def test_there_and_back(rig: StereoRig, left: Lens | None, right: Lens | None) -> None:
    """Lenses to the bit; the turn, which goes through a quaternion, to its rounding."""
    cameras = [
        Intrinsics(own.width, own.height, own.fx, own.fy, own.cx, own.cy, lens)
        for own, lens in ((rig.left, left), (rig.right, right))
    ]
    rig = StereoRig(*cameras, rig.right_from_left)
    back = parse_basalt(basalt_json(rig)).rig
    assert (back.left, back.right) == (rig.left, rig.right)
    same_rig(back, rig, 2e-14)


def test_what_is_written_by_hand() -> None:
    rig = StereoRig.rectified(Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0), 0.25)
    table = json.loads(basalt_json(rig))["value0"]
    # the right camera stands 0.25 m along the left one's x: imu from camera, not camera from imu
    assert table["T_imu_cam"][1] == {"px": 0.25, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}
    assert table["resolution"] == [[640, 480], [640, 480]]
    assert table["intrinsics"][0]["camera_type"] == "pinhole"


@pytest.mark.parametrize(
    ("lens", "message"),
    [
        (Mei(1.0), "left lens mei with .*: Basalt has no such model"),
        (Rational(s1=0.5, tau_y=0.1), "left lens rational .*: Basalt's radtan8 has no s1, tau_y"),
    ],
)
def test_what_basalt_lacks_is_refused(lens: Lens, message: str) -> None:
    with pytest.raises(InvalidRig, match=message):
        basalt_json(StereoRig.rectified(Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0, lens), 0.1))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"pinhole"', '"spline"', "cam0: camera_type spline: must be one of pinhole, pinhole-radtan8, ds"),
        ('"xi"', '"x"', r"cam1: xi of intrinsics of cam1 is missing \(found fx"),
        ('"qw": ', '"qw": 5', "T_imu_cam of cam0: a quaternion of length .* is no rotation"),
        ('"fx": 300.0', '"fx": NaN', "fx of cam0 nan: must be finite"),
        (
            '"resolution": [',
            '"resolution": [[1, 1], ',
            "resolution: holds 3 values, must be 2, as intrinsics",
        ),
        ('"T_imu_cam"', '"T_cam_imu"', r"T_imu_cam is missing"),
        ("}", "", "is not JSON"),
    ],
)
def test_bad_files_are_one_line(old: str, new: str, message: str) -> None:
    good = text(("pinhole", {}), ("ds", {"xi": -0.2, "alpha": 0.6}))
    assert old in good
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_basalt(good.replace(old, new, 1))
    assert "\n" not in str(caught.value)


def test_one_camera_is_refused() -> None:
    with pytest.raises(InvalidRig, match="has one camera, cam0: a rig has two"):
        parse_basalt(text(("pinhole", {}), places=(BODY_FROM_LEFT,)))
