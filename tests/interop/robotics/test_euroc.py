"""The cameras of a data set in ASL's layout."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.calibration import read
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.robotics import euroc
from rigsim.interop.formats.robotics.euroc import parse_sensors
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from tests.helpers.bodies import BODY_FROM_LEFT, BODY_FROM_RIGHT, check_pose, found, matrix

THIRD = matrix((0.3, 0.01, -0.2), (0.02, 0.01, 0.09))


def sensor(T: np.ndarray, fx: float = 400.0, model: str = "radial-tangential") -> str:
    data = ", ".join(repr(float(value)) for value in T.ravel())
    return (
        "# as a data set's\nsensor_type: camera\ncomment: one\n\nT_BS:\n  cols: 4\n  rows: 4\n"
        f"  data: [{data}]\n\nrate_hz: 20\nresolution: [640, 480]\ncamera_model: pinhole\n"
        f"intrinsics: [{fx}, 401, 320, 240] #fu, fv, cu, cv\ndistortion_model: {model}\n"
        "distortion_coefficients: [0.1, 0.2, 0.3, 0.4]\n"
    )


def file(name: str, text: str) -> File:
    return File(Path("mav0") / name / "sensor.yaml", text)


UNIT = ", ".join(str(value) for value in np.eye(4).ravel())
IMU = f"sensor_type: imu\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{UNIT}]\n"


def test_two_cameras_and_what_else_there_is() -> None:
    files = [
        file("cam1", sensor(BODY_FROM_RIGHT, 410)),
        file("imu0", IMU),
        file("cam0", sensor(BODY_FROM_LEFT)),
    ]
    one = found(euroc.FORMAT, files)
    check_pose(one.rig)
    lens = BrownConrady(0.1, 0.2, 0.3, 0.4)
    assert one.rig.left == Intrinsics(640, 480, 400, 401, 320, 240, lens)
    assert one.rig.right == Intrinsics(640, 480, 410, 401, 320, 240, lens)
    assert (one.unit, one.remarks) == ("m", ())
    assert euroc.groups(files[:2]) == []
    assert "name the other's beside it" in str(euroc.lacks(files[0]))
    assert euroc.lacks(files[1]) is None


def test_fisheyes_and_three_cameras() -> None:
    files = [
        file(name, sensor(T, model="equidistant"))
        for name, T in (("cam0", BODY_FROM_LEFT), ("cam1", THIRD), ("cam2", BODY_FROM_RIGHT))
    ]
    across = found(euroc.FORMAT, files, Asked(cameras=("cam0", "cam2")))
    check_pose(across.rig)
    assert across.rig.left.lens == KannalaBrandt(0.1, 0.2, 0.3, 0.4)
    assert [remark.code for remark in found(euroc.FORMAT, files).remarks] == ["cameras"]


def test_files_and_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, text in (("cam0", sensor(BODY_FROM_LEFT)), ("cam1", sensor(BODY_FROM_RIGHT)), ("imu0", IMU)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "sensor.yaml").write_text(text)
    paths = [tmp_path / name / "sensor.yaml" for name in ("cam0", "cam1")]
    monkeypatch.chdir(tmp_path / "cam1")
    for named in (
        paths,
        paths[::-1],
        [tmp_path],
        [paths[0]],
        [Path("sensor.yaml")],
        [Path("../cam0/sensor.yaml")],
    ):
        one = read(named)
        check_pose(one.rig)
        assert one.format == "euroc"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radial-tangential", "cubic", "right: camera_model pinhole with distortion_model cubic: no lens"),
        ("[640, 480]", "[640]", "right: resolution: holds 1 values, must be 2"),
        ("  data: [", "  data: [1, ", "right: T_BS: holds 17 values, must be 16"),
    ],
)
def test_bad_files_are_one_line(old: str, new: str, message: str) -> None:
    text = sensor(BODY_FROM_RIGHT)
    assert old in text
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_sensors(text, text.replace(old, new, 1))
    assert "\n" not in str(caught.value)
