"""rig.xml: by hand, drawn by MuJoCo as the Simulator draws the rig, and there and back."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.interop.formats.mjcf import parse_rig_xml, rig_xml
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from tests.helpers.rig_strategies import rigs, same_rig

LENS = Intrinsics(640, 480, 800.0, 810.0, 300.0, 250.0)
RECTIFIED = StereoRig.rectified(LENS, 0.2)

# a floor, and things at several depths, all in front of a body that looks along +X
SCENE = """
<mujoco>
  <include file="rig.xml"/>
  <worldbody>
    <light pos="0 0 4" dir="0.2 0 -1" castshadow="false"/>
    <geom type="plane" size="30 30 0.1" pos="0 0 -0.6" rgba="0.4 0.5 0.6 1"/>
    <geom type="box" size="0.2 0.3 0.2" pos="3 0.4 -0.1" euler="10 20 30" rgba="0.9 0.2 0.1 1"/>
    <geom type="box" size="0.1 0.2 0.4" pos="2 -0.3 0.1" rgba="0.1 0.8 0.3 1"/>
    <geom type="box" size="0.1 9 6" pos="6 0 0" rgba="0.7 0.7 0.2 1"/>
  </worldbody>
</mujoco>
"""


def test_by_hand() -> None:
    text = rig_xml(RECTIFIED)
    # half the baseline to the left, which is +y of a body that looks along +x
    assert 'name="left" pos="0.0 0.1 0.0"' in text
    assert 'name="right" pos="0.0 -0.1 0.0"' in text
    # the middle of 640 px is 319.5: the principal point lies 19.5 px left of it, and 10.5 px below 239.5
    assert text.count('principalpixel="19.5 -10.5"') == 2
    assert 'resolution="640 480" sensorsize="640 480" focalpixel="800.0 810.0"' in text


@given(rigs(distorted=False))
def test_there_and_back(rig: StereoRig) -> None:
    same_rig(parse_rig_xml(rig_xml(rig)), rig)


DRAW = """
import mujoco, numpy as np
model = mujoco.MjModel.from_xml_path("scene.xml")
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
for side in ("left", "right"):
    with mujoco.Renderer(model, 240, 320) as renderer:
        renderer.update_scene(data, camera=side)
        np.save(f"{side}_colours.npy", renderer.render())
        renderer.enable_depth_rendering()
        renderer.update_scene(data, camera=side)
        np.save(f"{side}_depth.npy", renderer.render())
"""


def test_mujoco_draws_what_the_simulator_draws(tmp_path: Path) -> None:
    """Off-centre, oblong pixels, verged, rolled, the right lens another one: same depth, same colours."""
    turned = Pose.from_rotvec([0.03, -0.1, 0.05])
    right = Intrinsics(320, 240, 380.0, 400.0, 170.0, 110.0)
    rig = StereoRig(
        Intrinsics(320, 240, 400.0, 390.0, 150.0, 125.0),
        right,
        Pose(turned.R, -turned.R @ [0.2, 0.01, -0.03]),
    )
    (tmp_path / "rig.xml").write_text(rig_xml(rig))
    (tmp_path / "scene.xml").write_text(SCENE)
    with Simulator(str(tmp_path / "scene.xml"), "body:rig") as simulator:
        simulator.place(rig)
        frame = simulator.render(supersample=1)
        environment = {**os.environ, "MUJOCO_GL": simulator.backend, "PYOPENGL_PLATFORM": simulator.backend}
    # in a process of its own, as MuJoCo settles on a GL library when it is imported
    subprocess.run([sys.executable, "-c", DRAW], cwd=tmp_path, env=environment, check=True)
    for side, view in (("left", frame.left), ("right", frame.right)):
        colours, depth = (np.load(tmp_path / f"{side}_{what}.npy") for what in ("colours", "depth"))
        off = np.abs(colours.astype(int) - view.image).max(axis=2) > 2
        assert off.mean() < 2e-4  # an edge may fall on the other side of a pixel's centre
        assert len(np.unique(colours.reshape(-1, 3), axis=0)) > 20
        edges = np.abs(depth - view.depth) > 1e-4
        assert edges.mean() < 2e-4
        assert np.nanmedian(np.abs(depth - view.depth)) < 2e-6


def test_distortion_is_refused() -> None:
    lens = Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0, BrownConrady(k1=0.1))
    with pytest.raises(InvalidRig, match="right lens distorts: MuJoCo draws pinholes"):
        rig_xml(StereoRig.rectified(LENS, 0.1, right=lens))


def test_defaults_and_a_quaternion_of_half_digits_are_read() -> None:
    half = math.sqrt(0.5)
    text = (
        '<mujoco><worldbody><body><body><camera name="right" pos="0 -1 0" resolution="64 48" sensorsize="1 1"'
        f' focalpixel="70 70" quat="{half:.4f} 0 0 {half:.4f}"/><camera name="left" resolution="64 48"'
        ' sensorsize="1 1" focalpixel="70 70"/></body></body></worldbody></mujoco>'
    )
    rig = parse_rig_xml(text)
    assert (rig.left.cx, rig.left.cy) == (31.5, 23.5)
    assert rig.baseline_m == pytest.approx(1.0)
    # the right one turned left by its own axis of sight: what is right of the left camera is up for it
    assert (rig.right_from_left.R @ [1, 0, 0]).tolist() == pytest.approx([0, 1, 0], abs=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name="right"', 'name="other"', "cameras left and right in one body: missing"),
        ("quat=", "euler=", "cameras left and right in one body: missing"),
        ('focalpixel="800.0 810.0"', 'focalpixel="800.0"', "focalpixel 800.0: must be 2 numbers"),
        ('focalpixel="800.0 ', 'focalpixel="-800.0 ', "fx -800 px: must be > 0"),
        ('pos="0.0 0.1 0.0"', 'pos="0.0 -0.1 0.0"', "baseline 0 mm: must be > 0"),
        ('pos="0.0 0.1 0.0"', 'pos="0.0 0.1 up"', "camera left: pos up: must be a number"),
        ('quat="0.5000000000000001', 'quat="1.5', "camera left: quat: a quaternion of length"),
        ("</mujoco>", "", "is not XML: no element found"),
    ],
)
def test_bad_input_is_one_line(old: str, new: str, message: str) -> None:
    text = rig_xml(RECTIFIED)
    assert old in text
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_rig_xml(text.replace(old, new, 1))
    assert "\n" not in str(caught.value)
