"""Two cameras of any MJCF scene: fields of view, sensors and attitudes by hand, however they are written."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.calibration import read
from rigsim.interop.formats.kit.reading import RigReading
from rigsim.interop.formats.mjcf import FORMAT
from tests.helpers.calibrations import read as read_text

PIXELS = 'resolution="640 480" sensorsize="6.4e-3 4.8e-3" '


def scene(left: str, right: str, around: str = "", names: tuple[str, str] = ("left", "right")) -> str:
    return (
        f'<mujoco>{around}<worldbody><camera name="third" pos="9 9 9"/>'
        f'<camera name="{names[0]}" {left}/><camera name="{names[1]}" {right}/></worldbody></mujoco>'
    )


def test_lenses_by_hand() -> None:
    # 4 mm and 5 mm over a pixel of 10 um; the principal point lies 0.1 mm before the middle, 319.5, 239.5
    metric = PIXELS + 'focal="4e-3 5e-3" principal="1e-4 2e-4"'
    by_pixel = PIXELS + 'focalpixel="400 500" principalpixel="10 20"'
    expected = (400.0, 500.0, 309.5, 219.5)
    for words in (metric, by_pixel):
        rig = read_text(FORMAT, scene(words, words + ' pos="0.1 0 0"')).rig
        own = (rig.left.fx, rig.left.fy, rig.left.cx, rig.left.cy)
        assert own == pytest.approx(expected, rel=1e-5)
    # tan(30 deg) over half the height, square pixels
    lens = read_text(FORMAT, scene('fovy="60" resolution="800 600"', 'fovy="60" pos="0.1 0 0"')).rig.left
    assert (lens.width, lens.height, lens.cx, lens.cy) == (800, 600, 399.5, 299.5)
    assert lens.fx == lens.fy == pytest.approx(300 / math.tan(math.radians(30)))


ATTITUDES = (
    'xyaxes="0 -1 0 0 0 1"',
    'quat="0.5 0.5 -0.5 -0.5"',
    'euler="90 -90 0"',
    'axisangle="1 -1 -1 120"',
)


@pytest.mark.parametrize("attitude", ATTITUDES)
def test_attitudes_by_hand(attitude: str) -> None:
    # both look along +x of the world with +z up: the picture's right is -y
    rig = read_text(FORMAT, scene(f'{attitude} pos="1 2 3"', f'{attitude} pos="1 1.9 3.02"')).rig
    # the right camera lies 0.1 to the right and 0.02 up
    np.testing.assert_allclose(rig.right_from_left.inverse.t, [0.1, -0.02, 0], atol=1e-9)
    np.testing.assert_allclose(rig.right_from_left.R, np.eye(3), atol=1e-9)


def test_zaxis_radians_defaults_and_nested_bodies() -> None:
    text = """<mujoco><compiler angle="radian" eulerseq="XYZ"/>
      <default><default class="eye"><camera fovy="40"/></default></default>
      <worldbody><body pos="5 0 0" euler="0 0 1.5707963267948966"><camera name="left" class="eye"
      pos="0 0 0" zaxis="0 0 1"/><body pos="0.2 0 0"><camera name="right" class="eye" zaxis="0 0 1"/>
      </body></body></worldbody></mujoco>"""
    rig = read_text(FORMAT, text).rig
    assert rig.left.height / 2 / rig.left.fy == pytest.approx(math.tan(math.radians(20)))
    np.testing.assert_allclose(rig.right_from_left.inverse.t, [0.2, 0, 0], atol=1e-9)


def test_which_two(tmp_path: Path) -> None:
    path = tmp_path / "scene.xml"
    path.write_text(scene("", 'pos="0.1 0 0"', names=("eye_a", "eye_b")))
    with pytest.raises(InvalidRig, match=r"3 camera\(s\), third, eye_a, eye_b: choose two, as --rig-cameras"):
        read([path])
    got = read([path], RigReading(cameras=("eye_b", "eye_a"), size_px=(320, 200)))
    assert got.rig.right_from_left.t[0] == pytest.approx(0.1)
    assert (got.rig.left.width, got.rig.left.height, got.format) == (320, 200, "mjcf")
    assert "no_size" not in [remark.code for remark in got.remarks]
    path.write_text(scene("", 'pos="0.1 0 0"', names=("cam_left", "cam_right")))
    got = read([path])
    assert got.rig.right_from_left.t[0] == pytest.approx(-0.1)
    assert "no_size" in [remark.code for remark in got.remarks]
    assert (got.rig.left.width, got.rig.left.height) == (640, 480)
    with pytest.raises(InvalidRig, match="camera up: must be one of third, cam_left, cam_right"):
        read([path], RigReading(cameras=("up", "third")))


def test_cameras_that_move_against_each_other() -> None:
    text = """<mujoco><worldbody><body><geom size="1"/><camera name="left"/></body>
      <body><joint/><geom size="1"/><camera name="right" pos="0.1 0 0"/></body></worldbody></mujoco>"""
    assert "moves" in [remark.code for remark in read_text(FORMAT, text).remarks]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<mujoco><worldbody></worldbody></mujoco>", "0 camera"),
        (scene('fovy="0"', ""), "fovy"),
        (scene("", 'projection="orthographic"'), "camera right is orthographic"),
        (scene("", 'pos="1 2"'), "'pos' does not have enough data"),
        ("<mujoco>", "is not XML"),
    ],
)
def test_what_is_none(text: str, says: str) -> None:
    with pytest.raises(InvalidRig, match=says) as caught:
        read_text(FORMAT, text)
    assert "\n" not in str(caught.value)
