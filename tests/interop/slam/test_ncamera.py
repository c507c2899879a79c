"""The cameras of SVO Pro and aslam, whose matrices map a camera's frame to the body's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.calibration import read
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.slam import ncamera
from rigsim.interop.formats.slam.ncamera import parse_ncamera
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from tests.helpers.bodies import BODY_FROM_LEFT, BODY_FROM_RIGHT, check_pose, found, matrix, rows

THIRD = matrix((0.3, 0.01, -0.2), (0.02, 0.01, 0.09))
FOUR = "0.1, 0.2, 0.3, 0.4"


def data(indent: str, rows: int, columns: int, values: str) -> str:
    return f"{indent}cols: {columns}\n{indent}rows: {rows}\n{indent}data: [{values}]\n"


def camera(
    T: np.ndarray, label: str, ends: str = "400, 401, 320, 240", model: str = "pinhole", lens: str = ""
) -> str:
    lens = lens or f"type: radial-tangential  \n      parameters:\n{data('        ', 4, 1, FOUR)}"
    return (
        f"- camera:\n    label: {label}\n    id: 5f\n    image_height: 480\n    image_width: 640\n"
        f"    type: {model}\n\n    intrinsics:\n{data('      ', 4, 1, ends)}"
        f"    distortion:\n      {lens}\n  T_B_C:\n"
        + data("    ", 4, 4, ",\n           ".join(repr(float(value)) for value in T.ravel()))
    )


def settings(*cameras: str) -> str:
    return f'label: "Two"\nid: 41\ncameras:\n{"".join(cameras)}\nimu_params:\n  g: 9.81\n'


PAIR = settings(camera(BODY_FROM_LEFT, "front"), camera(BODY_FROM_RIGHT, "back", "410, 401, 320, 240"))


def test_the_right_camera_lies_where_its_matrix_says_by_hand() -> None:
    """The body's axes are the left camera's: the right one is 120 mm along x, turned 90 degrees about y."""
    left, right = np.eye(4), np.eye(4)
    right[:3] = [[0, 0, 1, 0.12], [0, 1, 0, 0.03], [-1, 0, 0, 0.2]]
    pose = parse_ncamera(settings(camera(left, "a"), camera(right, "b"))).rig.right_from_left
    np.testing.assert_allclose(pose.inverse.t, [0.12, 0.03, 0.2], atol=1e-15)
    np.testing.assert_allclose(pose.t, [0.2, -0.03, -0.12], atol=1e-15)
    np.testing.assert_allclose(pose.rotvec_rad, [0, -np.pi / 2, 0], atol=1e-12)


def test_two_cameras() -> None:
    one = found(ncamera.FORMAT, [File(Path("any"), PAIR)])
    check_pose(one.rig)
    lens = BrownConrady(0.1, 0.2, 0.3, 0.4)
    assert one.rig.left == Intrinsics(640, 480, 400, 401, 320, 240, lens)
    assert one.rig.right == Intrinsics(640, 480, 410, 401, 320, 240, lens)
    assert (one.unit, one.remarks) == ("m", ())


@pytest.mark.parametrize(
    ("ends", "model", "words", "lens"),
    [
        ("400, 401, 320, 240", "pinhole", "type: none", None),
        (
            "400, 401, 320, 240",
            "pinhole",
            f"type: equidistant\n      parameters: [{FOUR}]",
            KannalaBrandt(0.1, 0.2, 0.3, 0.4),
        ),
        (
            "400, 401, 320, 240",
            "pinhole",
            "type: fisheye\n      parameters: {data: [0.9]}",
            FieldOfView(0.9),
        ),
        (
            "1.7, 400, 401, 320, 240",
            "unified-projection",
            f"type: radial-tangential\n      parameters: [{FOUR}]",
            Mei(1.7, 0.1, 0.2, 0.3, 0.4),
        ),
    ],
)
def test_other_lenses(ends: str, model: str, words: str, lens: Lens | None) -> None:
    both = (
        camera(T, label, ends, model, words) for T, label in ((BODY_FROM_LEFT, "a"), (BODY_FROM_RIGHT, "b"))
    )
    rig = parse_ncamera(settings(*both)).rig
    check_pose(rig)
    assert rig.left == rig.right == Intrinsics(640, 480, 400, 401, 320, 240, lens)


def test_the_inverse_under_its_own_name() -> None:
    head = PAIR.split("  T_B_C:")[0]
    text = "".join(
        f"{head if i == 0 else head.partition('cameras:')[2].lstrip()}  T_C_B:\n"
        + rows(np.linalg.inv(T), "    ")
        for i, T in enumerate((BODY_FROM_LEFT, BODY_FROM_RIGHT))
    )
    check_pose(found(ncamera.FORMAT, [File(Path("any"), text)]).rig)


def test_three_cameras_by_label_and_by_number() -> None:
    three = (BODY_FROM_LEFT, THIRD, BODY_FROM_RIGHT)
    labelled = settings(*(camera(T, label) for T, label in zip(three, ("port", "up", "star"), strict=True)))
    check_pose(parse_ncamera(labelled, Asked(cameras=("port", "star"))).rig)
    alike = settings(*(camera(T, "same") for T in three))
    check_pose(parse_ncamera(alike, Asked(cameras=("2", "0"))).rig, BODY_FROM_RIGHT, BODY_FROM_LEFT)
    first = parse_ncamera(alike)
    check_pose(first.rig, BODY_FROM_LEFT, THIRD)
    assert [remark.code for remark in first.remarks] == ["cameras"]


def test_no_other_format_takes_it(tmp_path: Path) -> None:
    path = tmp_path / "two.txt"
    path.write_text(PAIR)
    for named in (path, tmp_path):
        one = read([named])
        check_pose(one.rig)
        assert (one.format, one.unit) == ("ncamera", "m")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radial-tangential", "cubic", "camera_model pinhole with distortion_model cubic of front: no lens"),
        ("radial-tangential", "fisheye", "of front: holds 4 values, must be 1, as of fov"),
        ("image_width", "width", "image_width of front is missing"),
        ("data: [400, ", "data: [", "intrinsics of front: holds 3 values, must be 4"),
        ("T_B_C", "T_X", "T_B_C of front is missing"),
    ],
)
def test_bad_files_are_one_line(old: str, new: str, message: str) -> None:
    assert old in PAIR
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_ncamera(PAIR.replace(old, new, 1))
    assert "\n" not in str(caught.value)
