"""VINS-Fusion's settings and the cameras' files that they name."""

from __future__ import annotations

from pathlib import Path

import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.calibration import read
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.slam import vins
from rigsim.interop.formats.slam.vins import parse_vins
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.rational import Rational
from tests.helpers.bodies import BODY_FROM_LEFT, BODY_FROM_RIGHT, check_pose, found, opencv

SETTINGS = (
    '%YAML:1.0\n\nimu: 1\nnum_of_cam: 2\n\nimage0_topic: "/cam0/image_raw"\n'
    'cam0_calib: "front_left.yaml"\ncam1_calib: "front_right.yaml"   # the other\nimage_width: 640\n'
    + opencv("body_T_cam0", BODY_FROM_LEFT)
    + "# and\n"
    + opencv("body_T_cam1", BODY_FROM_RIGHT)
)


def camera(model: str, projection: str, *others: str) -> str:
    return (
        f"%YAML:1.0\n---\nmodel_type: {model}\ncamera_name: camera\nimage_width: 640\nimage_height: 480\n"
        + "".join(f"{other}\n" for other in others)
        + f"projection_parameters:\n{projection}\n"
    )


PINHOLE = camera(
    "PINHOLE",
    "   fx: 400.0\n   fy: 401.0\n   cx: 320.0\n   cy: 240.0",
    "distortion_parameters:\n   k1: 0.1\n   k2: 0.2\n   p1: 0.3\n   p2: 0.4",
)
MEI = camera(
    "MEI",
    "   gamma1: 400.0\n   gamma2: 401.0\n   u0: 320.0\n   v0: 240.0",
    "mirror_parameters:\n   xi: 1.7",
    "distortion_parameters:\n   k1: 0.1\n   k2: 0.2\n   p1: 0.3\n   p2: 0.4",
)
FISHEYE = camera(
    "KANNALA_BRANDT",
    "   k2: 0.1\n   k3: 0.2\n   k4: 0.3\n   k5: 0.4\n   mu: 400.0\n   mv: 401.0\n   u0: 320.0\n   v0: 240.0",
)
FULL = camera(
    "PINHOLE_FULL",
    "   fx: 400.0\n   fy: 401.0\n   cx: 320.0\n   cy: 240.0",
    "distortion_parameters:\n   k1: 0.1\n   k2: 0.2\n   k3: 0.3\n   k4: 0.4\n   k5: 0.5\n   k6: 0.6\n"
    "   p1: 0.7\n   p2: 0.8",
)


def files(left: str = PINHOLE, right: str = MEI) -> list[File]:
    return [
        File(Path("config/front_right.yaml"), right),
        File(Path("config/stereo.yaml"), SETTINGS),
        File(Path("config/front_left.yaml"), left),
    ]


@pytest.mark.parametrize(
    ("text", "lens"),
    [
        (PINHOLE, BrownConrady(0.1, 0.2, 0.3, 0.4)),
        (MEI, Mei(1.7, 0.1, 0.2, 0.3, 0.4)),
        (FISHEYE, KannalaBrandt(0.1, 0.2, 0.3, 0.4)),
        (FULL, Rational(0.1, 0.2, 0.7, 0.8, 0.3, 0.4, 0.5, 0.6)),
    ],
)
def test_every_lens_by_hand(text: str, lens: Lens) -> None:
    one = found(vins.FORMAT, files(text, text.replace("400.0", "410.0")))
    check_pose(one.rig)
    assert one.rig.left == Intrinsics(640, 480, 400, 401, 320, 240, lens)
    assert one.rig.right == Intrinsics(640, 480, 410, 401, 320, 240, lens)
    assert (one.unit, one.remarks) == ("m", ())


def test_sides_can_be_asked_for() -> None:
    rig = found(vins.FORMAT, files(), Asked(cameras=("1", "0"))).rig
    check_pose(rig, BODY_FROM_RIGHT, BODY_FROM_LEFT)
    assert isinstance(rig.left.lens, Mei)


def test_any_of_the_files_and_their_folder(tmp_path: Path) -> None:
    for file in files():
        (tmp_path / file.name).write_text(file.text)
    every = [tmp_path / file.name for file in files()]
    for named in ([tmp_path], [every[1]], [every[0]], every):
        one = read(named)
        check_pose(one.rig)
        assert one.format == "vins"
    every[0].unlink()
    with pytest.raises(
        InvalidRig, match=r"VINS-Fusion's settings, whose cameras are in front_left\.yaml, fr"
    ):
        read([every[1]])
    with pytest.raises(InvalidRig, match="is one camera of CamOdoCal's: name VINS-Fusion's settings"):
        read([every[2]])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "MEI",
            "SCARAMUZZA",
            "front_right.yaml: model_type SCARAMUZZA: must be PINHOLE, PINHOLE_FULL, MEI or",
        ),
        ("   xi: 1.7", "   x: 1.7", r"front_right.yaml: xi of mirror_parameters is missing"),
        ("   gamma1: 400.0\n", "", "front_right.yaml: gamma1 of projection_parameters is missing"),
        ("image_width: 640", "image_width: -1", "front_right.yaml: image_width -1 px: must be"),
    ],
)
def test_bad_files_are_one_line(old: str, new: str, message: str) -> None:
    assert old in MEI
    with pytest.raises(InvalidRig, match=message) as caught:
        found(vins.FORMAT, files(right=MEI.replace(old, new, 1)))
    assert "\n" not in str(caught.value)


def test_settings_of_one_camera_are_refused() -> None:
    one = SETTINGS.replace("cam1_calib", "other_calib")
    with pytest.raises(InvalidRig, match="has one camera, cam0: a rig has two"):
        parse_vins(one, {"front_left.yaml": PINHOLE})
    with pytest.raises(InvalidRig, match="body_T_cam1 is missing"):
        parse_vins(
            SETTINGS.replace("body_T_cam1", "T"), {"front_left.yaml": PINHOLE, "front_right.yaml": MEI}
        )
