"""Ground truth: on the surface, balanced over depth, and hidden when something stands in between."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rigsim import Intrinsics, Simulator, StereoRig
from rigsim.errors import InvalidScene
from rigsim.sim.truth.points import balanced, depth_edges_m
from tests.helpers.scenes import SLANTED, WALL_NORMAL_WORLD, WALL_POINT_WORLD, write

RIG = StereoRig.rectified(Intrinsics.from_focal(320, 240, 300.0), 0.2)


@pytest.fixture(scope="module")
def slanted(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Simulator]:
    with Simulator(write(tmp_path_factory.mktemp("scene"), SLANTED), None, "rays") as simulator:
        simulator.place(RIG)
        yield simulator


def test_points_lie_on_the_wall(slanted: Simulator):
    truth = slanted.truth(500, np.random.default_rng(1))
    wall = truth.geom_ids == slanted.scene.model.geom("wall").id
    points_world = slanted.scene.world_from_camera(0).apply(truth.points_left)
    offset = (points_world - WALL_POINT_WORLD) @ np.array(WALL_NORMAL_WORLD)
    assert wall.sum() > 100
    assert np.abs(offset[wall]).max() < 1e-9


def test_visibility_behind_a_post_is_that_of_its_shadow(slanted: Simulator):
    truth = slanted.truth(4000, np.random.default_rng(2))
    wall = truth.geom_ids == slanted.scene.model.geom("wall").id
    points_world = slanted.scene.world_from_camera(0).apply(truth.points_left)
    # from the right camera at Y -0.1, does the segment cross the post (X 1.95..2.05, Y .1..3, Z .6..1.4)?
    x, y, z = (points_world - (0, -0.1, 1)).T
    hidden = np.zeros(len(x), dtype=bool)
    for plane_x in np.linspace(1.95, 2.05, 41):
        at_y, at_z = y / x * plane_x - 0.1, z / x * plane_x
        hidden |= (at_y > 0.1) & (at_y < 0.3) & (np.abs(at_z) < 0.4)
    expected = truth.in_right_image & ~hidden
    assert truth.visible_left.all()
    assert hidden[wall].sum() > 20
    np.testing.assert_array_equal(truth.visible_right[wall], expected[wall])


def test_field_of_view_of_the_right_camera(slanted: Simulator):
    truth = slanted.truth(2000, np.random.default_rng(3))
    x, _, z = truth.points_left.T
    u_right = 159.5 + 300 * (x - 0.2) / z
    np.testing.assert_array_equal(truth.in_right_image, (u_right >= -0.5) & (u_right <= 319.5))
    assert not truth.in_right_image.all()


def test_same_stream_same_points(slanted: Simulator):
    first, second = (slanted.truth(100, np.random.default_rng(4)).points_left for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_range_keeps_to_the_range(slanted: Simulator):
    depth = slanted.truth(300, np.random.default_rng(5), (3.0, 4.0)).points_left[:, 2]
    assert 3.0 <= depth.min() < depth.max() <= 4.0
    assert len(depth) == 300


def test_nothing_within_the_range_says_what_is_seen(slanted: Simulator):
    with pytest.raises(InvalidScene, match=r"nothing between 50 and 60 m; the left camera sees 1.95 to"):
        slanted.truth(10, np.random.default_rng(0), (50.0, 60.0))


def test_nothing_in_sight_is_an_error(tmp_path: Path):
    xml = '<mujoco><worldbody><site name="rig"/><geom size=".1" pos="-3 0 0"/></worldbody></mujoco>'
    with Simulator(write(tmp_path, xml), None, "rays") as simulator:
        simulator.place(RIG)
        with pytest.raises(InvalidScene, match="sees nothing"):
            simulator.truth(10, np.random.default_rng(0))


def test_rare_depths_are_all_kept():
    rng = np.random.default_rng(6)
    depth = np.concatenate([rng.uniform(1.0, 1.2, 10_000), rng.uniform(4.1, 4.9, 30)])
    rng.shuffle(depth)
    chosen = depth[balanced(depth, 400)]
    assert len(chosen) == 400
    assert (chosen > 4).sum() == 30


def test_bins_are_filled_alike():
    depth = np.random.default_rng(7).uniform(1.0, 3.2, 50_000)
    chosen = depth[balanced(depth, 500)]
    counts, _ = np.histogram(chosen, [1, 1.25, 1.6, 2, 2.5, 3.2])
    np.testing.assert_array_equal(counts, [100] * 5)


@pytest.mark.parametrize(
    ("near", "far", "edges"),
    [
        (0.5, 1.0, [0.5, 0.63, 0.8, 1.0]),
        (0.55, 0.9, [0.5, 0.63, 0.8, 1.0]),
        (9.0, 11.0, [8.0, 10.0, 12.5]),
        (2.0, 2.0, [2.0, 2.5]),
    ],
)
def test_depth_edges(near: float, far: float, edges: list[float]):
    np.testing.assert_allclose(depth_edges_m(near, far), edges, rtol=1e-12)
