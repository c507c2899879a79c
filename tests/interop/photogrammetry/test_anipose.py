"""Cameras around a subject: TOML tables whose rotation and translation map the world to the camera."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rigsim
from rigsim.errors import InvalidRig
from rigsim.interop.formats import rig_toml
from rigsim.interop.formats.calibration import RigReading, parse, read
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.photogrammetry import anipose
from rigsim.interop.formats.photogrammetry.anipose import parse_anipose
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from tests.helpers.bodies import BODY_FROM_LEFT, BODY_FROM_RIGHT, check_pose, found, matrix

THIRD = matrix((0.3, 0.01, -0.2), (0.02, 0.01, 0.09))
METADATA = "[metadata]\nadjusted = true\nerror = 0.4\n\n[metadata.errors]\ncam2 = 0.5\n"


def written(values: np.ndarray) -> str:
    return f"[ {', '.join(repr(float(value)) for value in np.ravel(values))},]"


def table(
    key: str, name: str, camera_from_world: tuple[np.ndarray, np.ndarray], fx: float = 400.0, more: str = ""
) -> str:
    rotvec, t = camera_from_world
    return (
        f'[{key}]\nname = "{name}"\nsize = [ 640.0, 480,]\n'
        f"matrix = [ [ {fx}, 0.0, 320.0,], [ 0.0, 401.0, 240.0,], [ 0.0, 0.0, 1.0,],]\n"
        f"distortions = [ 0.1, 0.2, 0.3, 0.4,]\nrotation = {written(rotvec)}\ntranslation = {written(t)}\n"
        f"{more}\n"
    )


def inverse(T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation vector and translation that map the body to the camera."""
    back = np.linalg.inv(T)
    return cv2.Rodrigues(back[:3, :3])[0].ravel(), back[:3, 3]


LEFT, UP, RIGHT = (inverse(T) for T in (BODY_FROM_LEFT, THIRD, BODY_FROM_RIGHT))
PAIR = table("cam_0", "A", LEFT) + table("cam_1", "B", RIGHT, 410) + METADATA
THREE = table("cam_0", "A", LEFT) + table("cam_1", "B", UP) + table("cam_2", "C", RIGHT) + METADATA


def test_the_pose_between_two_cameras_by_hand() -> None:
    """The left camera is at -z of a world that it is not turned in; the right one looks to its left.

    Its centre is -R^T t = (120, 30, 5), so from the left camera, 7 behind the world's origin, (120, 30, 12).
    """
    left = (np.zeros(3), np.array([0.0, 0, 7]))
    right = (np.array([0, np.pi / 2, 0]), np.array([-5.0, -30, 120]))
    one = parse_anipose(table("cam_0", "A", left) + table("cam_1", "B", right))
    pose = one.rig.right_from_left
    np.testing.assert_allclose(pose.inverse.t, [120, 30, 12], atol=1e-12)
    np.testing.assert_allclose(pose.t, [-12, -30, 120], atol=1e-12)
    np.testing.assert_allclose(pose.rotvec_rad, [0, np.pi / 2, 0], atol=1e-12)
    assert one.unit is None


def test_two_cameras() -> None:
    one = found(anipose.FORMAT, [File(Path("any"), PAIR)])
    check_pose(one.rig)
    lens = BrownConrady(0.1, 0.2, 0.3, 0.4)
    assert one.rig.left == Intrinsics(640, 480, 400, 401, 320, 240, lens)
    assert one.rig.right == Intrinsics(640, 480, 410, 401, 320, 240, lens)
    assert (one.unit, one.remarks) == (None, ())


@given(st.lists(st.floats(-1, 1), min_size=6, max_size=6))
def test_the_world_may_lie_anywhere(six: list[float]) -> None:
    move = np.eye(4)
    move[:3, :3], move[:3, 3] = cv2.Rodrigues(np.array(six[:3]))[0], six[3:]
    both = (inverse(move @ T) for T in (BODY_FROM_LEFT, BODY_FROM_RIGHT))
    text = "".join(table(f"cam_{i}", f"{i}", pose) for i, pose in enumerate(both))
    check_pose(parse_anipose(text).rig, tolerance=1e-9)


def test_fisheyes_say_so() -> None:
    both = ((LEFT, "fisheye = true"), (RIGHT, "fisheye = false"))
    text = "".join(table(f"int_cam{i}_img", f"n{i}", pose, 400, more) for i, (pose, more) in enumerate(both))
    rig = parse_anipose(text).rig
    assert rig.left.lens == KannalaBrandt(0.1, 0.2, 0.3, 0.4)
    assert rig.right.lens == BrownConrady(0.1, 0.2, 0.3, 0.4)
    with pytest.raises(InvalidRig, match="fisheye of int_cam0_img 1: must be true or false"):
        parse_anipose(text.replace("= true", "= 1"))


@pytest.mark.parametrize("cameras", [("A", "C"), ("a", "c"), ("cam_0", "cam_2"), ("0", "2")])
def test_cameras_by_name_table_and_number(cameras: tuple[str, str]) -> None:
    check_pose(parse_anipose(THREE, Asked(cameras=cameras)).rig)
    check_pose(parse_anipose(THREE, Asked(cameras=cameras[::-1])).rig, BODY_FROM_RIGHT, BODY_FROM_LEFT)


def test_names_come_before_tables_and_a_number_may_stand_in_the_middle() -> None:
    named = THREE.replace('"A"', '"1"').replace('"B"', '"2"').replace('"C"', '"3"')
    check_pose(parse_anipose(named, Asked(cameras=("1", "3"))).rig)
    check_pose(parse_anipose(named, Asked(cameras=("0", "2"))).rig)
    between = THREE
    for i, name in enumerate("ABC"):
        between = between.replace(f"cam_{i}", f"int_cam{i + 1}_img")
        between = between.replace(f'"{name}"', f'"int_cam{i + 1}_img"')
    check_pose(parse_anipose(between, Asked(cameras=("1", "3"))).rig)


def test_the_first_two_of_three_are_taken_and_said() -> None:
    one = parse_anipose(THREE)
    check_pose(one.rig, BODY_FROM_LEFT, THIRD)
    (remark,) = one.remarks
    assert (remark.code, "A and B are taken" in remark.text) == ("cameras", True)
    with pytest.raises(InvalidRig, match="camera D: the file has A, B, C; name two of them"):
        parse_anipose(THREE, Asked(cameras=("A", "D")))


def test_without_a_size_it_is_asked_for_or_assumed() -> None:
    text = PAIR.replace("size = [ 640.0, 480,]\n", "")
    assert [remark.code for remark in parse_anipose(text).remarks] == ["no_size"]
    asked = parse_anipose(text, Asked(size_px=(648, 488)))
    assert (asked.rig.left.width, asked.rig.right.height, asked.remarks) == (648, 488, ())


def test_the_unit_is_asked_for(tmp_path: Path) -> None:
    """In millimetres no metres can be meant: the file is read with its unit alone, and by no other format."""
    long = [(rotvec, t * 1e3) for rotvec, t in (LEFT, RIGHT)]
    text = table("cam_0", "A", long[0]) + table("cam_1", "B", long[1]) + METADATA
    path = tmp_path / "calibration.txt"
    path.write_text(text)
    for named in (path, tmp_path):
        with pytest.raises(InvalidRig, match="the unit of its lengths is not said"):
            read([named])
        one = read([named], RigReading(unit="mm"))
        check_pose(one.rig)
        assert one.format == "anipose"


def test_it_is_no_rig_toml_nor_the_other_way_round() -> None:
    rig = parse_anipose(PAIR).rig
    own = rigsim.write_rig(rig)
    assert (parse(own).format, parse(PAIR).format) == ("rig.toml", "anipose")
    assert not anipose.knows(own)
    assert not rig_toml.knows(PAIR)
    assert parse(own).rig == rig


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("size = [ 640.0, 480,]", "size = [ 640.5, 480,]", "size of cam_0 640.5 px: must be a whole number"),
        ("[ 0.0, 0.0, 1.0,]", "[ 0.0, 0.0,]", "matrix of cam_0: holds 2 values, must be 3"),
        ("[ 400.0, 0.0,", "[ 400.0, 0.5,", "matrix of cam_0: must be .* without skew"),
        ("[ 400.0, 0.0,", "[ -400.0, 0.0,", "cam_0: .*-400"),
        ("[ 0.1, 0.2,", "[ 0.2,", "distortions of cam_0: has 3 numbers, must be 4, 5, 8"),
        ("rotation = [ ", "rotation = [ 1.0, ", "rotation of cam_0: holds 4 values, must be 3"),
        ("translation", "place", "translation of cam_0 is missing"),
        ("[ 400.0, 0.0,", "[ nan, 0.0,", "matrix of cam_0 nan: must be finite"),
        ('name = "A"', 'name = "A', "is not TOML: .* line 2"),
        ("[cam_1]", "[cam_0]", "is not TOML: .*cam_0"),
    ],
)
def test_bad_files_are_one_line(old: str, new: str, message: str) -> None:
    assert old in PAIR
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_anipose(PAIR.replace(old, new, 1))
    assert "\n" not in str(caught.value)
