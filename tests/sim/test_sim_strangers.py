"""Scenes that others bring: rays and GL see the same, and what is left out or odd is said by name."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from rigsim import Intrinsics, Plan, Simulator, StereoRig, sweep
from rigsim.errors import NothingSeen
from rigsim.sim.frame import StereoFrame
from rigsim.sim.truth.facets import slices
from tests.helpers.scenes import write

LENS = Intrinsics.from_hfov(160, 120, 60.0)
RIG = StereoRig.rectified(LENS, 0.06)
WALL = '<geom name="wall" type="box" pos="2.5 0 0" size=".5 4 4"/>'  # its face stands 2 m before the rig


def scene(body: str, head: str = "") -> str:
    return f'<mujoco>{head}<worldbody><site name="rig"/>{body}</worldbody></mujoco>'


def look(path: str, rig: StereoRig = RIG, mount: str | None = None) -> tuple[Simulator, StereoFrame]:
    with Simulator(path, mount) as simulator:
        assert simulator.backend != "rays", "no GL here: install libegl1 libopengl0 libgl1-mesa-dri"
        simulator.place(rig)
        return simulator, simulator.render()


def said(simulator: Simulator) -> dict[str, str]:
    return {remark.code: remark.text for remark in simulator.remarks}


SOLIDS = {
    "sphere": 'type="sphere" size=".1"',
    "capsule": 'type="capsule" size=".1 .1"',
    "cylinder": 'type="cylinder" size=".1 .2"',
    "ellipsoid": 'type="ellipsoid" size=".1 .2 .1"',
    "box": 'type="box" size=".1 .1 .1"',
    "mesh": 'type="mesh" mesh="cube"',
}
CUBE = """<asset><mesh name="cube" inertia="shell" vertex="-.1 -.1 -.1 .1 -.1 -.1 -.1 .1 -.1 .1 .1 -.1
  -.1 -.1 .1 .1 -.1 .1 -.1 .1 .1 .1 .1 .1"/></asset>"""


@pytest.mark.parametrize("solid", SOLIDS)
def test_a_geom_around_a_camera_is_left_out_of_both_pictures_and_named(tmp_path: Path, solid: str):
    xml = scene(f'<body name="head"><geom name="skull" {SOLIDS[solid]}/></body>{WALL}', CUBE)
    path = write(tmp_path, xml)
    with Simulator(path, "body:head") as simulator:
        simulator.place(RIG)
        frame = simulator.render()
        points_left = simulator.truth(100, np.random.default_rng(0)).points_left
        text = said(simulator)["inside_geom"]
        assert "skull" in text
        assert "body:head" in text
        for view in (frame.left, frame.right):
            np.testing.assert_allclose(view.depth, 2.0, atol=1e-4)
        np.testing.assert_allclose(points_left[:, 2], 2.0, atol=1e-9)
        # a wider rig's cameras sit on either side of the skull: it is there again
        simulator.place(StereoRig.rectified(LENS, 0.6))
        assert simulator.scene.around == ()
        # one camera inside is enough: the other must not see the geom either
        simulator.place(StereoRig.rectified(LENS, 0.16))
        assert simulator.scene.around == (simulator.scene.model.geom("skull").id,)


def test_a_rig_beside_a_geom_sees_it(tmp_path: Path):
    xml = scene(f'<geom name="skull" type="sphere" size=".1" pos="1 0 0"/>{WALL}')
    simulator, frame = look(write(tmp_path, xml))
    assert simulator.remarks == ()
    assert frame.left.depth[60, 83] == pytest.approx(0.9, abs=0.01)


def test_a_plane_seen_from_behind_is_left_out(tmp_path: Path):
    """Rays go through its back; GL draws it as if it were glass."""
    lid = '<geom name="lid" type="plane" size="1 1 .1" pos="1 0 0" zaxis="1 0 0"/>'
    xml = scene(lid + WALL)
    simulator, frame = look(write(tmp_path, xml))
    assert "lid" in said(simulator)["inside_geom"]
    np.testing.assert_allclose(frame.left.depth, 2.0, atol=1e-4)


def test_twins_in_one_place_are_one_object_the_visual_one(tmp_path: Path):
    twin = 'type="box" size=".2 .5 .5" pos="1.2 0 0"'
    xml = scene(
        f'<geom name="collision" {twin} rgba="0 .5 0 .5"/>'
        f'<geom name="visual" {twin} contype="0" conaffinity="0" rgba=".8 .2 .2 1" group="1"/>{WALL}'
    )
    simulator, frame = look(write(tmp_path, xml))
    model = simulator.scene.model
    assert set(np.unique(frame.left.segmentation)) == {model.geom("visual").id, model.geom("wall").id}
    red, green, _ = frame.left.light[60, 80]
    assert red > 1.8 * green  # .2 of .8, and the highlight


def test_surfaces_in_one_place_may_be_either_geom(tmp_path: Path):
    """Two unequal boxes whose faces coincide: which is seen is a matter of rounding, the depth is not."""
    xml = scene(
        '<geom name="a" type="box" size=".2 .5 .5" pos="1.2 0 0"/>'
        f'<geom name="b" type="box" size=".3 .4 .45" pos="1.3 0 0"/>{WALL}'
    )
    _, frame = look(write(tmp_path, xml))
    assert frame.left.depth[60, 80] == pytest.approx(1.0, abs=1e-5)


def test_alpha_means_the_same_to_rays_and_pictures(tmp_path: Path):
    """A geom's own colour covers its material's, in pictures; rays look at the material's alone."""
    material = '<asset><material name="solid" rgba="1 1 1 1"/><material name="clear" rgba="1 1 1 0"/></asset>'
    xml = scene(
        '<geom type="box" size=".1 .5 .5" pos="1 0 0" material="solid" rgba="1 0 0 0"/>'
        f'<geom name="seen" type="box" size=".1 .1 .1" pos="1.5 0 0" material="clear" rgba="1 0 0 1"/>{WALL}',
        material,
    )
    simulator, frame = look(write(tmp_path, xml))
    assert frame.left.depth[60, 81] == pytest.approx(1.4, abs=1e-5)
    points_left, _ = simulator.points_at(np.array([[81.0, 60.0]]))
    assert points_left[0, 2] == pytest.approx(1.4, abs=1e-9)


def test_a_sheet_seen_from_behind_is_there(tmp_path: Path):
    """A mesh of two triangles, one of which turns its back to the rig: rays hit it, and GL draws it."""
    head = """<asset><mesh name="sheet" inertia="shell" vertex="0 -2 -2 0 2 -2 0 0 3 1 0 -2"
      face="0 1 2 0 1 3"/></asset>"""
    for turn in ("0 0 0", "0 0 180"):
        xml = scene(f'<geom name="sheet" type="mesh" mesh="sheet" pos="1 0 0" euler="{turn}"/>{WALL}', head)
        _, frame = look(write(tmp_path, xml))
        assert frame.left.depth[70, 80] == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("aside", [0.0, 0.002])
def test_a_camera_in_a_surface_is_one_line(tmp_path: Path, aside: float):
    xml = scene(f'<geom name="panel" type="box" size=".1 1 1" pos="{0.1 + aside} 0 0"/>{WALL}')
    path = write(tmp_path, xml)
    where = "is 2 mm from panel" if aside else "lies in the surface of panel"
    words = f"left camera at site:rig {where}, where nothing can be seen: must be >= 5 mm"
    with Simulator(path) as simulator:
        simulator.place(RIG)
        with pytest.raises(NothingSeen, match=words) as caught:
            simulator.render()
        assert "\n" not in str(caught.value)
        with pytest.raises(NothingSeen, match=words):
            simulator.truth(100, np.random.default_rng(0))


def test_a_camera_set_flush_into_a_body_looks_out_of_it(tmp_path: Path):
    xml = scene(f'<geom name="bumper" type="box" size=".1 1 1" pos="-.1 0 0"/>{WALL}')
    simulator, frame = look(write(tmp_path, xml))
    assert "bumper" in said(simulator)["inside_geom"]
    np.testing.assert_allclose(frame.left.depth, 2.0, atol=1e-4)


def test_every_picture_is_the_same_whatever_came_before(tmp_path: Path):
    """An infinite floor and a headlight: both were laid out about the camera of the picture before."""
    xml = scene(
        '<light pos="1 1 3"/><geom type="plane" size="0 0 .1" pos="0 0 -1" material="tiles"/>'
        '<geom type="sphere" size=".3" pos="2 0 -.5"/>',
        '<asset><texture name="tiles" type="2d" builtin="checker" width="64" height="64" rgb1=".2 .3 .4" '
        'rgb2=".8 .7 .6"/><texture name="sky" type="skybox" builtin="gradient" width="64" height="64" '
        'rgb1=".3 .5 .7" rgb2="0 0 0"/><material name="tiles" texture="tiles" texrepeat="3 3" '
        'texuniform="true" reflectance=".2"/></asset>',
    )
    path = write(tmp_path, xml)
    narrow, wide = RIG, StereoRig.rectified(LENS, 3.0)
    with Simulator(path) as simulator:
        pictures = []
        for rig in (narrow, wide, narrow):
            simulator.place(rig)
            frame = simulator.render()
            pictures.append(frame.left.light.tobytes() + frame.right.light.tobytes())
    assert pictures[0] == pictures[2]
    assert pictures[0] != pictures[1]
    _, alone = look(path, wide)
    assert pictures[1] == alone.left.light.tobytes() + alone.right.light.tobytes()


STARS = (
    '<texture name="stars" type="skybox" builtin="gradient" width="512" height="3072" mark="random" '
    'markrgb="1 1 1" random=".05" rgb1=".3 .5 .7" rgb2="0 0 0"/>'
)


def test_a_textured_skybox_is_named_and_a_plain_one_is_not(tmp_path: Path):
    ball = '<geom type="sphere" size=".3" pos="2 0 0"/>'
    marked = scene(ball, f"<asset>{STARS}</asset>")
    simulator, frame = look(write(tmp_path, marked))
    assert "stars" in said(simulator)["skybox"]
    sky = np.isnan(frame.left.depth)
    v, u = np.nonzero(sky)
    points_left, _ = simulator.points_at(np.column_stack([u, v]).astype(np.float64))
    assert simulator.on_sky(points_left).mean() > 0.99
    points_left, _ = simulator.points_at(np.array([[82.0, 60.0]]))
    assert not simulator.on_sky(points_left).any()
    simulator, _ = look(write(tmp_path, marked.replace('mark="random"', "")))
    assert simulator.remarks == ()
    assert not simulator.on_sky(np.full((3, 3), np.nan)).any()


def test_matches_on_the_skybox_are_no_outliers(tmp_path: Path):
    """Stars all over the sky, a speckled box before it: what is found on the sky has no truth."""
    head = (
        f'<asset>{STARS}<texture name="spots" type="2d" width="8" '
        'height="8" builtin="flat"/><material name="spots" texture="spots"/></asset>'
        '<custom><text name="texture:spots" data="speckle size=256 seed=1"/></custom>'
    )
    xml = scene('<geom type="box" size=".1 .6 .6" pos="2 0 0" material="spots"/>', head)
    rig = StereoRig.rectified(Intrinsics.from_hfov(320, 240, 60.0), 0.06)
    plan = Plan(scene=write(tmp_path, xml), n_points=200, n_trials=10, measure="patches")
    result = sweep([rig], plan)
    row = result.rows.iloc[0]
    assert row["measured_n"] > 20
    assert row["measured_outlier_fraction"] < 0.2
    assert [remark.code for remark in result.remarks] == ["skybox"]


def test_what_is_not_drawn_is_named(tmp_path: Path):
    xml = scene(
        '<body name="a"><freejoint/><geom size=".1" pos="2 0 0"/><site name="s1" pos="2 0 .2"/></body>'
        '<site name="s2" pos="2 0 1"/>'
        '<flexcomp name="cloth" type="grid" dim="2" count="4 4 1" spacing=".1 .1 .1" mass="1" pos="2 1 0" '
        f'radius=".01"><edge equality="true"/></flexcomp>{WALL}',
        '<visual><map fogstart="2" fogend="9"/></visual>',
    ).replace(
        "</mujoco>",
        '<tendon><spatial name="rope" width=".01"><site site="s1"/><site site="s2"/></spatial></tendon>'
        "</mujoco>",
    )
    simulator, _ = look(write(tmp_path, xml))
    remarks = said(simulator)
    assert "flex cloth" in remarks["left_out"]
    assert "tendon rope" in remarks["left_out"]
    assert "fog" in remarks["fog"]
    assert "haze" not in remarks["fog"]


def test_a_surface_before_the_lens_is_remarked(tmp_path: Path):
    xml = scene(f'<geom name="finger" type="box" size=".1 .01 1" pos=".109 .03 0"/>{WALL}')
    simulator, _ = look(write(tmp_path, xml))
    text = said(simulator)["near_surface"]
    assert "finger is 9 mm before the left camera" in text


def test_what_a_grid_hides_is_remarked(tmp_path: Path):
    # slits half as wide as the bars between them, so near that either camera looks through slits of its own
    bars = "".join(
        f'<geom name="bar{i}" type="box" size=".001 .0075 1" pos=".3 {0.02 * i - 1.01:g} 0"/>'
        for i in range(100)
    )
    simulator, _ = look(write(tmp_path, scene(bars + WALL.replace("2.5", "2.6"))))
    # where a ray to the wall passes the bars, the other camera's to the same point passes 51.4 mm aside,
    # 60 mm (1 - .3 / 2.1): 2 pitches and 11.4 mm, so that every slit of 5 mm lands on a bar of 15
    assert "between 2 and 2.5 m, " in said(simulator)["mostly_hidden"]
    simulator, _ = look(write(tmp_path, scene(WALL)))
    assert simulator.remarks == ()


@pytest.mark.parametrize(
    ("radius_px", "n"), [(0.5, 16), (2.0, 16), (2.2, 32), (8.0, 32), (100.0, 128), (5000.0, 256)]
)
def test_slices_leave_a_sag_of_four_hundredths_of_a_pixel(radius_px: float, n: int):
    assert slices(np.array([radius_px]))[0] == n
    if n < 256:
        assert radius_px * (1 - math.cos(math.pi / n)) <= 0.04
    if n > 16:
        assert radius_px * (1 - math.cos(2 * math.pi / n)) > 0.04


@pytest.mark.parametrize("shape", ["sphere", "capsule", "cylinder", "ellipsoid"])
def test_coarse_shapes_are_where_rays_hit(tmp_path: Path, shape: str):
    """A facet's edge lies inside by 0.04 px at most, its middle by twice that; by depth over focal, m."""
    geom = f'<geom type="{shape}" size=".05 .12 .09" pos="1.5 0 0" euler="20 30 40"/>'
    simulator, frame = look(write(tmp_path, scene(geom + WALL)))
    v, u = np.nonzero(frame.left.segmentation == 0)
    points_left, _ = simulator.points_at(np.column_stack([u, v]).astype(np.float64))
    behind = frame.left.depth[v, u] - points_left[:, 2]
    assert len(v) > 40
    assert np.median(behind) < 2 * 0.04 * 1.5 / LENS.fx
    assert behind.min() > -1e-4
    assert np.median(behind) > 1e-6  # and facets they are
