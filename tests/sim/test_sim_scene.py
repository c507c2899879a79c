"""Where the rig sits: mounts, reference poses, and limits that keep the picture true."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from rigsim import Intrinsics, Simulator, StereoRig
from rigsim.errors import InvalidScene
from tests.helpers.scenes import SLANTED, write

RIG = StereoRig.rectified(Intrinsics.from_focal(64, 48, 60.0), 0.2)


def centers_and_axes(scene: str, mount: str | None, rig: StereoRig = RIG):
    with Simulator(scene, mount, "rays") as simulator:
        simulator.place(rig)
        poses = [simulator.scene.world_from_camera(side) for side in (0, 1)]
    return [pose.t for pose in poses], [pose.R[:, 2] for pose in poses]


@pytest.mark.parametrize("mount", [None, "site:rig", "camera:front"])
def test_rig_looks_along_x_with_the_left_camera_towards_y(tmp_path: Path, mount: str | None):
    centers, forward = centers_and_axes(write(tmp_path, SLANTED), mount)
    np.testing.assert_allclose(centers[0], [0, 0.1, 1], atol=1e-12)
    np.testing.assert_allclose(centers[1], [0, -0.1, 1], atol=1e-12)
    np.testing.assert_allclose(forward, [[1, 0, 0]] * 2, atol=1e-12)


def test_body_turned_left_by_90_degrees_looks_along_y(tmp_path: Path):
    centers, forward = centers_and_axes(write(tmp_path, SLANTED), "body:head")
    np.testing.assert_allclose(centers[0], [-0.1, 0, 1], atol=1e-12)
    np.testing.assert_allclose(forward, [[0, 1, 0]] * 2, atol=1e-12)


def test_verged_rig_stays_centred_and_toes_in(tmp_path: Path):
    rig = StereoRig.verged(RIG.left, 0.2, 10.0)
    centers, forward = centers_and_axes(write(tmp_path, SLANTED), None, rig)
    np.testing.assert_allclose(centers, [[0, 0.1, 1], [0, -0.1, 1]], atol=1e-12)
    half = math.radians(5)
    # the left camera, at +Y, turns towards -Y
    np.testing.assert_allclose(forward[0], [math.cos(half), -math.sin(half), 0], atol=1e-12)
    np.testing.assert_allclose(forward[1], [math.cos(half), math.sin(half), 0], atol=1e-12)


def test_only_camera_of_a_file_is_the_mount(tmp_path: Path):
    xml = SLANTED.replace('<site name="rig" pos="0 0 1"/>', "")
    with Simulator(write(tmp_path, xml), None, "rays") as simulator:
        assert simulator.scene.mount == "camera:front"


def test_keyframe_pose_is_used(tmp_path: Path):
    xml = """<mujoco><worldbody><body name="arm"><joint name="turn" axis="0 0 1"/>
      <geom size=".1" mass="1"/><site name="rig" pos="1 0 0"/></body></worldbody>
      <keyframe><key qpos="1.5707963267948966"/></keyframe></mujoco>"""
    _, forward = centers_and_axes(write(tmp_path, xml), None)
    np.testing.assert_allclose(forward[0], [0, 1, 0], atol=1e-9)


def test_includes_and_meshes_beside_the_file_resolve(tmp_path: Path):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "tetra.obj").write_text(
        "v 0 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    (tmp_path / "parts.xml").write_text(
        '<mujoco><worldbody><geom name="tetra" type="mesh" mesh="tetra" pos="3 0 0"/></worldbody></mujoco>'
    )
    path = write(
        tmp_path,
        '<mujoco><compiler meshdir="meshes"/>'
        '<asset><mesh name="tetra" file="tetra.obj" inertia="shell"/></asset>'
        '<include file="parts.xml"/><worldbody><site name="rig"/></worldbody></mujoco>',
    )
    with Simulator(path, None, "rays") as simulator:
        simulator.place(RIG)
        truth = simulator.truth(50, np.random.default_rng(0))
        assert {simulator.scene.object_name(int(i)) for i in truth.geom_ids} == {"tetra"}
        assert truth.points_left[:, 2].min() > 2.7


@pytest.mark.parametrize(
    ("mount", "words"),
    [
        ("body:tail", ["body:tail", "no such body", "body:head", "site:rig", "camera:front"]),
        ("tail", ["'tail'", "body:NAME", "body:head"]),
        ("site:", ["no such site", "site:rig"]),
    ],
)
def test_unknown_mount_lists_the_known(tmp_path: Path, mount: str, words: list[str]):
    with pytest.raises(InvalidScene) as caught:
        Simulator(write(tmp_path, SLANTED), mount, "rays")
    message = str(caught.value)
    assert all(word in message for word in words)
    assert "\n" not in message


def test_no_default_mount_lists_what_could_be(tmp_path: Path):
    xml = '<mujoco><worldbody><body name="base"><site name="tip"/></body></worldbody></mujoco>'
    with pytest.raises(InvalidScene, match=r"choose a --mount among site:tip, .*body:base"):
        Simulator(write(tmp_path, xml), None, "rays")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("<mujoco><worldbody><geom type='cube'/></worldbody></mujoco>", "line 1"),
        ("<mujoco><worldbody>", "broken.xml"),
        ("", "broken.xml"),
    ],
)
def test_broken_file_is_one_line_with_its_place(tmp_path: Path, content: str, words: str):
    with pytest.raises(InvalidScene) as caught:
        Simulator(write(tmp_path, content, "broken.xml"), None, "rays")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_unknown_scene_lists_the_bundled():
    with pytest.raises(InvalidScene, match=r"'atlantis'.*artifact, bin, boards, branch, corridor"):
        Simulator("atlantis", None, "rays")


@pytest.mark.parametrize("extent", ["0.01", "1000"])
def test_clip_planes_do_not_follow_the_file(tmp_path: Path, extent: str):
    # with the file's own extent the sphere or everything near it would be clipped away, silently
    xml = f"""<mujoco><statistic extent="{extent}"/><worldbody><site name="rig"/>
      <geom name="ball" type="box" size=".01 .01 .01" pos="2 0 0"/>
      <geom name="back" type="box" size=".1 500 500" pos="60 0 0"/></worldbody></mujoco>"""
    with Simulator(write(tmp_path, xml)) as simulator:
        assert simulator.backend != "rays", "no GL here: install libegl1 libopengl0 libgl1-mesa-dri"
        simulator.place(StereoRig.rectified(Intrinsics.from_focal(65, 49, 300.0), 0.01))
        left = simulator.render().left
    assert left.depth[24, 32] == pytest.approx(1.99, abs=5e-6)
    assert left.depth[0, 0] == pytest.approx(59.9, abs=1e-3)
