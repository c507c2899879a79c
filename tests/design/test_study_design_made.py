"""Scenes made for a design: something to see at every distance asked for, by both cameras."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rigsim.errors import InvalidRange
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.scenes.made import made_scene
from rigsim.sim.simulator import Simulator
from rigsim.study.design.made import proof_distances_m, scene_for
from rigsim.study.design.proof import prove, verdict
from rigsim.study.design.room import Room
from rigsim.study.design.solve import solve, specify
from rigsim.study.scene.plan import Plan
from rigsim.theory.inverse import Camera, Requirement


def camera(width_px: int, height_px: int, hfov_deg: float) -> Camera:
    return Camera(width_px, height_px, width_px / 2 / math.tan(math.radians(hfov_deg) / 2))


@pytest.mark.parametrize(
    ("range_m", "between_m", "size_px", "hfov_deg", "overlap"),
    [
        ((0.2, 0.4), (0.25, 0.32), (320, 240), 90, 0.5),
        ((0.8, 1.2), (1.0,), (320, 240), 60, 0.5),
        ((0.5, 3.0), (0.8, 1.3, 2.0), (480, 360), 100, 0.5),
        ((0.5, 3.0), (1.0,), (320, 240), 60, 0.1),
        ((0.5, 6.0), (0.7, 1.0, 1.3, 1.7, 2.2, 3.0, 4.0, 5.0), (320, 240), 60, 0.5),
        ((5.0, 20.0), (8.0, 12.0), (320, 240), 30, 0.5),
        ((100.0, 120.0), (), (320, 240), 60, 0.5),
    ],
)
def test_every_distance_asked_for_has_points_and_matches(
    range_m: tuple[float, float],
    between_m: tuple[float, ...],
    size_px: tuple[int, int],
    hfov_deg: float,
    overlap: float,
) -> None:
    asked = [Requirement("depth_error", 0.1 * z, z) for z in (*between_m, range_m[1])]
    asked.append(Requirement("overlap", overlap, range_m[0]))
    spec = specify(*range_m, asked, build_share=0.0)
    # the longest baseline shares least
    design = solve(spec, [camera(*size_px, hfov_deg)], "most-accurate")
    distances_m = proof_distances_m(spec)
    assert distances_m == (range_m[0], *between_m, range_m[1])
    plan = Plan(
        range_m=range_m, noises=(PixelNoise(0.25),), n_trials=20, sensors={"s": Sensor(grey_noise=2.0)}
    )
    with Room(plan, make=lambda candidate: scene_for(distances_m, candidate)) as room:
        (proof,) = prove(design, room)
        seen = room.trial(proof.candidate).seen
        matches = room.trial(proof.candidate).matches
        assert room.remarks == ()
    assert proof.verified
    assert proof.scene == f"a scene made for {range_m[0]:g} to {range_m[1]:g} m"
    assert proof.method == "patches"
    for held in proof.checks:
        if held.requirement.kind == "depth_error":
            assert held.n_points >= 100
            assert held.n_measured >= 30
            assert not held.is_widened
            assert verdict(held.requirement, proof.candidate, [proof], spec) == "met"
    # and at the near end, of which nothing is asked
    assert seen is not None
    assert matches is not None
    shown_m = seen.truth.points_left[seen.truth.visible][:, 2]
    matched_m = matches.points_left[~matches.outlier][:, 2]
    for depth_m, fewest in ((shown_m, 100), (matched_m, 30)):
        assert ((depth_m >= range_m[0]) & (depth_m <= range_m[0] * 1.25)).sum() >= fewest


@pytest.mark.parametrize("overlap", [0.1, 0.5, 0.95])
def test_no_wall_hides_another_and_all_lie_in_the_range(overlap: float) -> None:
    chip, distances_m = camera(320, 240, 70), (0.5, 0.7, 1.1, 2.0, 3.0)
    baseline_m = (1 - overlap) * chip.width_px * 0.5 / chip.focal_px
    lens = Intrinsics.from_focal(chip.width_px, chip.height_px, chip.focal_px)
    made = made_scene(distances_m, chip.hfov_rad, chip.vfov_rad, baseline_m)
    assert made == made_scene(distances_m[::-1], chip.hfov_rad, chip.vfov_rad, baseline_m)
    with Simulator(made, renderer="rays") as simulator:
        simulator.place(StereoRig.rectified(lens, baseline_m))
        truth = simulator.truth(2000, np.random.default_rng(1), (0.5, 3.0))
        corners = simulator.true_corners()
    # every ray of the left image ends in the range
    assert len(truth.coverage.depth_m) == truth.coverage.n_rays
    # what lies in the right camera's field of view it sees, but for slivers at the walls' upper edges: a wall
    # is turned by 4 % of its depth, so an edge slopes by 4 % of its angle: two rows of 240 for each of four
    held = truth.coverage.in_right_image
    assert truth.coverage.visible_right[held].mean() > 0.98
    # by hand: shared are 1 - B f / (Z W) of the columns; two sloping edges make a wall of 48 rows 4 rows
    # higher at one end than in the middle, 8 %, so that its ends count for more or less
    for at_m in distances_m[1:-1]:
        there = np.abs(truth.coverage.depth_m / at_m - 1) < 0.045
        shared = 1 - baseline_m * chip.focal_px / (at_m * chip.width_px)
        assert abs(held[there].mean() - shared) < 0.05
    # a board of 5 x 7 corners on each wall, all of them seen by both
    assert len(corners.points_left) == 35 * len(distances_m)
    for uv in StereoRig.rectified(lens, baseline_m).project(corners.points_left):
        assert lens.contains(uv).all()


def test_near_distances_share_a_wall_and_narrow_ranges_have_room() -> None:
    hfov, vfov = math.radians(60), math.radians(45)
    assert made_scene((1.0, 1.04, 2.0), hfov, vfov).text == made_scene((1.0, 2.0), hfov, vfov).text
    with Simulator(made_scene((1.0, 1.001), hfov, vfov), renderer="rays") as simulator:
        simulator.place(StereoRig.rectified(Intrinsics.from_focal(320, 240, 277.0), 0.1))
        truth = simulator.truth(500, np.random.default_rng(1), (1.0, 1.001))
    assert len(truth.coverage.depth_m) == truth.coverage.n_rays
    for wrong in ((), (1.0,), (0.0, 1.0), (1.0, math.inf)):
        with pytest.raises(InvalidRange, match="must be 0 < nearest < farthest"):
            made_scene(wrong, hfov, vfov)


def test_each_camera_has_a_scene_of_its_own() -> None:
    spec = specify(0.8, 1.2, [Requirement("depth_error", 0.1, 1.2)], build_share=0.0)
    wide, narrow = camera(320, 240, 100), camera(320, 240, 30)
    candidates = [solve(spec, [each], "smallest").candidates[0] for each in (wide, narrow)]
    distances_m = proof_distances_m(spec)
    plan = Plan(range_m=(0.8, 1.2), renderer="rays", measure="none")
    with Room(plan, make=lambda candidate: scene_for(distances_m, candidate)) as room:
        for candidate in candidates:
            seen = room.trial(candidate).seen
            assert seen is not None
            # both walls fill half of the picture each, within a tenth
            near = seen.truth.coverage.depth_m < 1.0
            assert 0.4 < near.mean() < 0.6
            assert len(near) == seen.truth.coverage.n_rays
            assert room.where == "a scene made for 0.8 to 1.2 m"
