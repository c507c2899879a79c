"""The picture is the projection: frustum, depth, sides and rows, each against a hand-made formula."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.subjects.frusta import drawn_frustum
from rigsim import Intrinsics, Simulator, StereoRig
from rigsim.errors import RenderMismatch, RenderUnavailable
from rigsim.sim import render
from rigsim.sim.axes import CV_FROM_GL, REP103_FROM_RIG
from tests.helpers.scenes import SLANTED, WALL_NORMAL_WORLD, WALL_POINT_WORLD, write

LENS = Intrinsics(320, 240, 300.0, 330.0, 140.3, 131.8)
SMALL = StereoRig.rectified(Intrinsics.from_focal(320, 180, 225.0), 0.12)
RIGS = {
    "rectified": StereoRig.rectified(LENS, 0.2, right=replace(LENS, cx=150.9)),
    "verged": StereoRig.verged(LENS, 0.3, 12.0),
}


@pytest.fixture(scope="module")
def slanted(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Simulator]:
    with Simulator(write(tmp_path_factory.mktemp("scene"), SLANTED)) as simulator:
        assert simulator.backend != "rays", "no GL here: install libegl1 libopengl0 libgl1-mesa-dri"
        yield simulator


def wall_depth(rig: StereoRig, side: int) -> np.ndarray:
    """Depth of the wall's plane at every pixel centre, from the rig's numbers alone."""
    lens = (rig.left, rig.right)[side]
    v, u = np.mgrid[: lens.height, : lens.width]
    rays_camera = np.stack([(u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, np.ones(u.shape)], -1)
    rig_from_left = rig.rig_from_left
    rig_from_camera = rig_from_left if side == 0 else rig_from_left @ rig.right_from_left.inverse
    # the site's axes are the world's: x forward, y left, z up
    rays_world = rays_camera @ (REP103_FROM_RIG @ rig_from_camera.R).T
    origin_world = np.array([0, 0, 1]) + REP103_FROM_RIG @ rig_from_camera.t
    normal = np.array(WALL_NORMAL_WORLD)
    return ((np.array(WALL_POINT_WORLD) - origin_world) @ normal) / (rays_world @ normal)


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("side", [0, 1])
def test_depth_of_a_slanted_wall(slanted: Simulator, name: str, side: int):
    rig = RIGS[name]
    slanted.place(rig)
    frame = slanted.render()
    view = (frame.left, frame.right)[side]
    wall = view.segmentation == slanted.scene.model.geom("wall").id
    expected = wall_depth(rig, side)
    assert wall.mean() > 0.5
    assert np.abs(view.depth - expected)[wall].max() < 5e-6 * max(1, expected[wall].max())
    # a shift of half a pixel would be seen a hundred times over
    assert np.abs(view.depth[:, :-1] - expected[:, 1:])[wall[:, :-1]].min() > 1e-3


def test_post_moves_left_in_the_right_picture_and_stands_where_it_projects(slanted: Simulator):
    rig = RIGS["rectified"]
    slanted.place(rig)
    frame = slanted.render()
    post = slanted.scene.model.geom("post").id
    for view, lens, center_y in ((frame.left, rig.left, 0.1), (frame.right, rig.right, -0.1)):
        rows, columns = np.nonzero(view.segmentation == post)
        # the front face at X 1.95 spans Y 0.1..0.3 and Z 0.6..1.4; u grows towards -Y, v towards -Z
        u = lens.cx + lens.fx * (center_y - np.array([0.3, 0.1])) / 1.95
        v = lens.cy + lens.fy * np.array([-0.4, 0.4]) / 1.95
        assert columns.min() == np.ceil(u[0])
        assert rows.min() == np.ceil(v[0])
        assert rows.max() == np.floor(v[1])
    assert np.nonzero(frame.left.segmentation == post)[1].mean() > (
        np.nonzero(frame.right.segmentation == post)[1].mean()
    )


def test_rays_draw_the_same_depth_and_objects(slanted: Simulator):
    rig = RIGS["verged"]
    slanted.place(rig)
    drawn = slanted.render()
    with Simulator(str(slanted.scene.path), None, "rays") as simulator:
        simulator.place(rig)
        cast = simulator.render()
    for gl, ray in ((drawn.left, cast.left), (drawn.right, cast.right)):
        same = gl.segmentation == ray.segmentation
        assert same.mean() > 0.998  # edges may round either way
        assert np.nanmax(np.abs(gl.depth - ray.depth)[same]) < 2e-5
        assert ray.image.shape == (240, 320, 3)
        assert ray.image.std() > 5


def test_frustum_is_read_back_within_a_thousandth_of_a_pixel(slanted: Simulator):
    rig = RIGS["rectified"]
    slanted.place(rig)
    np.testing.assert_allclose(drawn_frustum(slanted, 1), (300.0, 330.0, 150.9, 131.8), atol=1e-3)


@pytest.mark.parametrize(
    "wrong",
    [
        (300.0, 330.0, 140.8, 131.8),  # half a pixel
        (300.0, 330.0, 178.7, 131.8),  # the principal offset's sign
        (300.0, 330.0, 140.3, 107.2),  # rows counted from below
        (300.2, 330.0, 140.3, 131.8),
        (float("nan"), 330.0, 140.3, 131.8),
    ],
)
def test_another_frustum_is_an_error(wrong: tuple[float, float, float, float]):
    render.check_frustum(LENS, (300.0, 330.0, 140.3, 131.8))
    with pytest.raises(RenderMismatch, match="use mujoco"):
        render.check_frustum(LENS, wrong)


@pytest.mark.parametrize("spoil", [lambda d: d * 1.001, lambda d: np.roll(d, 1, axis=1), lambda d: d[::-1]])
def test_wrong_depth_is_an_error(slanted: Simulator, spoil):
    slanted.place(RIGS["rectified"])
    left = slanted.render().left
    assert render.check_depth(slanted.scene, 0, left.depth, left.segmentation) < 5e-6
    with pytest.raises(RenderMismatch, match="rays say"):
        render.check_depth(slanted.scene, 0, spoil(left.depth), left.segmentation)


def test_larger_pictures_get_a_larger_buffer(slanted: Simulator):
    small, large = (Intrinsics.from_hfov(w, h, 60) for w, h in ((64, 48), (700, 500)))
    for lens in (small, large, small):
        slanted.place(StereoRig.rectified(lens, 0.1))
        assert slanted.render().right.image.shape == (lens.height, lens.width, 3)


def test_axes_constants_are_rotations():
    assert np.linalg.det(CV_FROM_GL) == pytest.approx(1)
    assert np.linalg.det(REP103_FROM_RIG) == pytest.approx(1)


def test_too_large_a_picture_names_the_limit(slanted: Simulator):
    slanted.place(StereoRig.rectified(Intrinsics.from_hfov(20000, 100, 60), 0.1))
    with pytest.raises(RenderUnavailable, match=r"20000x100 px, drawn 2 times as fine, is beyond .* 16384"):
        slanted.render()


@pytest.mark.parametrize("supersample", [1, 2, 4])
def test_an_edge_lands_where_it_projects(slanted: Simulator, supersample: int):
    slanted.place(RIGS["rectified"])
    row = slanted.render(supersample).left.light[131, :, 2].astype(np.float64)  # blue: the post's colour
    # the post's front face spans Y 0.1 to 0.3 at X 1.95, seen from the left camera at Y 0.1
    edges = LENS.cx + LENS.fx * (0.1 - np.array([0.3, 0.1])) / 1.95
    for edge, sign in zip(edges, (1, -1), strict=True):
        near = round(edge)
        step = sign * row[near - 6 : near + 7]
        low, high = step[:3].mean(), step[-3:].mean()
        # light gathered past the edge, in pixels of the bright side: the edge's place to a share of a pixel
        found = near + 6 + 0.5 - ((step - low) / (high - low)).sum()
        assert found == pytest.approx(edge, abs={1: 0.15, 2: 0.08, 4: 0.04}[supersample])


def test_bands_join_without_a_seam(slanted: Simulator, monkeypatch: pytest.MonkeyPatch):
    slanted.place(RIGS["rectified"])
    whole = slanted.render().left
    monkeypatch.setattr(render, "_BAND_PX", 320 * 4 * 50)  # fifty rows at a time
    banded = slanted.render().left
    np.testing.assert_allclose(banded.light, whole.light, atol=1.01 / 255)
    assert np.abs(banded.light - whole.light).mean() < 1e-4


def _light(simulator: Simulator) -> np.ndarray:
    return simulator.render(1).left.light


def test_two_simulators_at_once_draw_what_each_draws_alone():
    def alone(scene: str) -> np.ndarray:
        with Simulator(scene) as simulator:
            simulator.place(SMALL)
            return _light(simulator)

    boards, bin_ = alone("boards"), alone("bin")
    with Simulator("boards") as outer:
        outer.place(SMALL)
        np.testing.assert_array_equal(_light(outer), boards)
        with Simulator("bin") as inner:
            inner.place(SMALL)
            np.testing.assert_array_equal(_light(inner), bin_)
            np.testing.assert_array_equal(_light(outer), boards)
        np.testing.assert_array_equal(_light(outer), boards)


def test_a_simulator_that_is_dropped_takes_nothing_from_another():
    dropped = Simulator("boards")
    dropped.place(SMALL)
    _light(dropped)
    with Simulator("bin") as simulator:
        simulator.place(SMALL)
        before = _light(simulator)
        del dropped
        gc.collect()
        np.testing.assert_array_equal(_light(simulator), before)
