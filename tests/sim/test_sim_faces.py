"""Pictures through lenses that no pinhole can stand for: faces of a cube, held to rays and to each other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigsim import BrownConrady, Intrinsics, KannalaBrandt, Mei, Simulator, StereoRig
from rigsim.errors import InvalidRig
from rigsim.rig.sensor import Sensor
from rigsim.sim import faces
from rigsim.sim.lens import distort_image, wider_intrinsics
from rigsim.sim.truth import rays
from rigsim.sim.truth.points import at_depth
from rigsim.study.scene.pictures import expose_pair
from tests.helpers.scenes import SLANTED, write

FISHEYE = Intrinsics(240, 200, 66.0, 64.0, 118.2, 101.1, KannalaBrandt(0.02, -0.004, 0.001))
OMNI = replace(FISHEYE, fx=158.0, fy=150.0, lens=Mei(1.6, -0.05, 0.01, 0.001, -0.002))
RIG = StereoRig.rectified(FISHEYE, 0.1)
BOXES = [((2.0, 0, 0), 1), ((-1.5, 0.4, 0), 2), ((0, 1.8, 0.3), 3), ((0.2, -2.2, 0), 4), ((0.1, 0, 1.4), 5)]
PLACES = "".join(
    f'<geom name="b{i}" type="box" pos="{x} {y} {z + 1}" euler="{20 * i} {10 * i} 5" size=".4 .4 .4" '
    f'rgba="{0.1 + 0.15 * i} {0.9 - 0.15 * i} {0.3 + 0.1 * (i % 3)} 1"/>'
    for (x, y, z), i in BOXES
)
# only ambient light: what is seen of a geom is its own colour, from every side
FLAT = f"""
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody><site name="rig" pos="0 0 1"/>{PLACES}</worldbody>
</mujoco>
"""
# everything that could jump from face to face: a shining room, lit by the headlight and by a lamp
SHINY = """
<mujoco>
  <visual><headlight ambient=".3 .3 .3" diffuse=".4 .4 .4" specular=".5 .5 .5"/></visual>
  <asset>
    <texture name="t" type="2d" builtin="gradient" width="512" height="512" rgb1=".9 .8 .3" rgb2=".2 .3 .6"/>
    <material name="m" texture="t" specular=".8" shininess=".2" texuniform="false"/>
  </asset>
  <worldbody>
    <site name="rig" pos="0 0 1"/>
    <light pos=".5 .3 1.8" dir="0 0 -1" directional="false" castshadow="false"/>
    <geom type="plane" pos="0 0 0" size="4 4 1" material="m"/>
    <geom type="plane" pos="4 0 1" zaxis="-1 .2 .1" size="9 9 1" material="m"/>
    <geom type="plane" pos="-3 0 1" zaxis="1 0 0" size="9 9 1" material="m"/>
    <geom type="plane" pos="0 3 1" zaxis=".2 -1 0" size="9 9 1" material="m"/>
    <geom type="plane" pos="0 -2 1" zaxis="0 1 .1" size="9 9 1" material="m"/>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def boxes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Simulator]:
    with Simulator(write(tmp_path_factory.mktemp("flat"), FLAT)) as simulator:
        yield simulator


@pytest.fixture(scope="module")
def slanted(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Simulator]:
    with Simulator(write(tmp_path_factory.mktemp("slanted"), SLANTED)) as simulator:
        yield simulator


def pixels(camera: Intrinsics) -> np.ndarray:
    v, u = np.mgrid[: camera.height, : camera.width]
    return np.column_stack([u.ravel(), v.ravel()]).astype(np.float64)


def inside(mask: np.ndarray) -> np.ndarray:
    """Pixels whose eight neighbours have the same value."""
    same = np.ones(mask.shape, bool)
    for dv in (-1, 0, 1):
        for du in (-1, 0, 1):
            same &= np.roll(mask, (dv, du), axis=(0, 1)) == mask
    same[[0, -1]] = same[:, [0, -1]] = False
    return same


@pytest.mark.parametrize("camera", [FISHEYE, OMNI], ids=lambda camera: camera.lens.model)
def test_every_box_is_where_rays_of_the_lens_meet_it(boxes: Simulator, camera: Intrinsics) -> None:
    import mujoco

    boxes.place(StereoRig.rectified(camera, 0.1))
    frame = boxes.render(2)
    for side, view in enumerate((frame.left, frame.right)):
        # by brute force: MuJoCo's own rays, one by one, along the lens's rays
        world = boxes.scene.world_from_camera(side)
        hit = np.full((camera.height, camera.width), -1)
        depth = np.full(hit.shape, np.nan)
        for (u, v), ray in zip(pixels(camera).astype(int), camera.ray(pixels(camera)), strict=True):
            if np.isnan(ray[2]):
                continue
            geom = np.zeros(1, np.int32)
            far = mujoco.mj_ray(
                boxes.scene.model, boxes.scene.data, world.t, world.R @ ray, None, 1, -1, geom, None
            )
            if far >= 0:
                hit[v, u], depth[v, u] = geom[0], far * ray[2]
        np.testing.assert_array_equal(view.segmentation, hit)
        np.testing.assert_allclose(view.depth, depth, atol=1e-9)
        assert (depth < 0).sum() > 50, "something is seen past 90 degrees"
        calm = inside(hit)
        for geom in range(boxes.scene.model.ngeom):
            mine = calm & (hit == geom)
            color = boxes.scene.model.geom_rgba[geom, :3]
            assert np.abs(view.light[mine] - color).max(initial=0) < 0.02, boxes.scene.object_name(geom)
        # and pixels on an edge are mixed of what is about them, so no box is displaced
        nearest = np.abs(view.light[:, :, None] - boxes.scene.model.geom_rgba[None, None, :, :3]).max(axis=-1)
        seen = hit >= 0
        assert (nearest.argmin(axis=2)[seen] == hit[seen]).mean() > 0.97


def test_light_does_not_jump_between_faces(tmp_path: Path) -> None:
    """The same ray through two faces, both of them wider than they need be, brings the same light."""
    with Simulator(write(tmp_path, SHINY)) as simulator:
        simulator.place(RIG)
        renderer = simulator._renderer_of((FISHEYE, FISHEYE), 2)
        lens = Intrinsics.from_hfov(301, 301, 100)  # five degrees beyond the edge, all round
        turns = {tuple(turn[:, 2].astype(int)): turn for turn in faces._TURNS}
        ahead = renderer.light(0, lens, 1, turns[0, 0, 1])
        for z in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
            beside = renderer.light(0, lens, 1, turns[z])
            along = np.linspace(-0.9, 0.9, 61)
            seam = np.outer(np.ones(61), np.add((0, 0, 1), z))
            seam[:, 1 if z[0] else 0] += along
            found = [
                picture[tuple(np.rint(lens.project(seam @ turn)).astype(int).T[::-1])]
                for picture, turn in ((ahead, turns[0, 0, 1]), (beside, turns[z]))
            ]
            assert found[0].std() > 0.02
            # but where a wall's edge is; a headlight that turned with the faces would be off by 0.25
            assert np.quantile(np.abs(found[0] - found[1]), 0.95) < 0.01, z


def test_a_smooth_picture_is_smooth_across_seams(tmp_path: Path) -> None:
    with Simulator(write(tmp_path, SHINY)) as simulator:
        simulator.place(RIG)
        view = simulator.render(2).left
    which = np.full(FISHEYE.width * FISHEYE.height, -1)
    for index, face in enumerate(faces.faces_of(FISHEYE)):
        which[face.pixels] = index
    which = which.reshape(FISHEYE.height, FISHEYE.width)
    assert len(np.unique(which)) >= 5
    grey = view.light.mean(axis=2).astype(np.float64)
    bend = np.abs(grey[:, 2:] - 2 * grey[:, 1:-1] + grey[:, :-2])
    one_wall = (inside(view.segmentation) & (view.segmentation >= 0))[:, 1:-1]
    seam = (which[:, 2:] != which[:, :-2]) & one_wall
    assert seam.sum() > 100
    assert np.quantile(bend[seam], 0.99) < 1.5 / 255 + np.quantile(bend[~seam & one_wall], 0.99)


def test_dark_beyond_the_circle(boxes: Simulator) -> None:
    # the image radius turns back at 1.6 rad: nothing is shown beyond
    camera = replace(FISHEYE, lens=KannalaBrandt(-0.13))
    boxes.place(StereoRig.rectified(camera, 0.1))
    view = boxes.render(2).left
    dark = np.isnan(camera.ray(pixels(camera))[:, 2]).reshape(200, 240)
    assert dark[0, 0]
    assert not dark[100, 120]
    assert (view.light[dark & inside(dark)] == 0).all()
    assert np.isnan(view.depth[dark]).all()
    assert (view.segmentation[dark] == -1).all()


def test_rim_pixels_project_onto_themselves(boxes: Simulator) -> None:
    boxes.place(RIG)
    view = boxes.render(1).left
    seen = np.isfinite(view.depth)
    uv = pixels(FISHEYE)[seen.ravel()]
    back = FISHEYE.project(at_depth(FISHEYE, uv, view.depth[seen]))
    np.testing.assert_allclose(back, uv, atol=1e-7)
    points, _ = rays.hits_at(boxes.scene, 0, uv)
    np.testing.assert_allclose(points[:, 2], view.depth[seen], rtol=0, atol=1e-12)
    assert points[:, 2].min() < -0.2


def test_one_pinhole_where_one_is_enough_and_the_same_bits(slanted: Simulator) -> None:
    bent = Intrinsics(160, 120, 110.0, 112.0, 78.3, 60.8, BrownConrady(-0.2, 0.05, 0.001, -0.002))
    assert not faces.needs_faces(bent)
    assert faces.needs_faces(FISHEYE)
    slanted.place(StereoRig.rectified(bent, 0.1))
    wide = wider_intrinsics(bent, 2)
    by_hand = distort_image(slanted.render(1, (wide, wide)).left.light, wide, bent)
    np.testing.assert_array_equal(slanted.render(2).left.light, by_hand.astype(np.float32))


def test_a_narrow_fisheye_is_drawn_alike_by_one_pinhole_and_by_faces(slanted: Simulator) -> None:
    narrow = Intrinsics(160, 120, 110.0, 112.0, 78.3, 60.8, KannalaBrandt(0.02, -0.004))
    assert not faces.needs_faces(narrow)
    slanted.place(StereoRig.rectified(narrow, 0.1))
    one = slanted.render(2).left.light
    renderer = slanted._renderer_of((FISHEYE, FISHEYE), 4)
    many = faces.box_average(faces.through_faces(renderer, 0, narrow.supersampled(2)), 2)
    off = np.abs(one - many)
    assert off.mean() < 0.002
    assert np.quantile(off, 0.999) < 0.1
    assert np.abs(one[:, 1:] - many[:, :-1]).mean() > 3 * off.mean()  # a pixel aside is far worse


def test_sensor_and_preview_take_a_fisheye(boxes: Simulator) -> None:
    boxes.place(RIG)
    exposure = expose_pair(boxes, RIG, Sensor(blur_px=0.5), 2)
    plain = boxes.render(2)
    preview = boxes.preview()
    assert exposure.cameras == (FISHEYE, FISHEYE)
    for light, exact, quick in (
        (exposure.light[0], plain.left, preview.left),
        (exposure.light[1], plain.right, preview.right),
    ):
        calm = inside(exact.segmentation)
        grey = exact.light @ np.array([0.299, 0.587, 0.114])
        assert np.abs(light - grey)[calm & inside(calm)].max() < 0.03
        assert np.abs(quick.light - exact.light)[calm].max() < 0.05
        np.testing.assert_array_equal(quick.depth, exact.depth)


def test_an_unseen_fold_is_refused_and_a_lens_beside_its_picture_too() -> None:
    with pytest.raises(InvalidRig, match="folds within the picture"):
        faces.faces_of(replace(FISHEYE, lens=BrownConrady(-2.0)))
    with pytest.raises(InvalidRig, match="shows nothing"):
        faces.faces_of(Intrinsics(40, 30, 66.0, 64.0, -900.0, 15.0, KannalaBrandt(-0.13)))
