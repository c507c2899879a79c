"""The third witness on rendered pictures: right detectors agree with the truth, broken ones are flagged."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rigsim import BrownConrady, Intrinsics, PixelNoise, Plan, RigGrid, Simulator, StereoRig, preset, sweep
from rigsim.errors import InvalidRange, InvalidRig, RenderMismatch
from rigsim.present.kit.agreement import text
from rigsim.present.sweep.words import verdict
from rigsim.rig.sensor import Sensor
from rigsim.sim.render import GlRenderer
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.agreement.claims import measured_agreement
from rigsim.study.scene import third_witness as room
from rigsim.study.scene.pictures import Pictures, expose_pair
from rigsim.study.scene.third_witness import MeasuredMatches, bins_of, measure, measured_row

RIG = preset("boards").rig
ORDINARY = Sensor(grey_noise=2.0)


@pytest.fixture(scope="module")
def boards() -> Iterator[Simulator]:
    with Simulator("boards") as simulator:
        assert simulator.backend != "rays", "no GL here: install libegl1 libopengl0 libgl1-mesa-dri"
        simulator.place(RIG)
        yield simulator


@pytest.fixture(scope="module")
def pictures(boards: Simulator) -> Pictures:
    exposure = expose_pair(boards, RIG, ORDINARY, 2)
    return exposure.pictures(ORDINARY, np.random.default_rng(0))


@pytest.fixture(scope="module")
def corners(boards: Simulator, pictures: Pictures) -> MeasuredMatches:
    return measure("corners", boards, RIG, pictures)


def judged(measured: MeasuredMatches, rig: StereoRig = RIG) -> tuple[dict, Agreement]:
    row = measured_row(measured, rig, "optimal", np.ones(len(measured.outlier), dtype=bool))
    return row, measured_agreement(row, len(measured.outlier), measured.why)


def test_corners_are_as_good_as_they_claim(corners: MeasuredMatches):
    row, agreement = judged(corners)
    assert agreement.kind == "agrees"
    assert row["measured_n"] > 500
    assert row["measured_outlier_fraction"] == 0
    assert row["measured_pixel_rms_px"] < 0.01
    assert 0.8 < row["measured_over_predicted"] < 1.25
    assert row["measured_within_3_sigma"] > 0.97
    # the nearest board lies at 0.58 m, the farthest at 5 m: all of them are joined to their own truth
    assert corners.points_left[:, 2].min() < 0.65
    assert corners.points_left[:, 2].max() > 4.9


def test_patches_are_as_good_as_they_claim(boards: Simulator, pictures: Pictures):
    row, agreement = judged(measure("patches", boards, RIG, pictures))
    # a cautious claim: nine of ten errors lie within 0.6 to 0.85 of it, about the edge of what agrees
    assert agreement.kind != "flagged"
    assert 0.5 < row["measured_scale"] < 1.25
    assert row["measured_n"] > 300
    assert row["measured_within_3_sigma"] > 0.95


def test_a_dense_matcher_fills_most_of_the_picture(boards: Simulator, pictures: Pictures):
    row, _ = judged(measure("dense", boards, RIG, pictures))
    assert row["measured_n"] > 0.5 * 1280 * 720 / 16
    assert row["measured_disparity_std_px"] < 1


def test_half_a_pixel_is_flagged(corners: MeasuredMatches):
    shifted = replace(corners, error_px=corners.error_px + 0.5)
    _, agreement = judged(shifted)
    assert (agreement.kind, agreement.witness, agreement.quantity) == ("flagged", "measured", "scale")
    assert agreement.ratio > 5


def test_half_a_pixel_in_one_picture_is_flagged_by_depth_too(corners: MeasuredMatches):
    moved = replace(
        corners,
        uv_right=corners.uv_right + np.array([0.5, 0.0]),
        error_px=corners.error_px + np.array([0.0, 0.0, 0.5, 0.0]),
    )
    row, agreement = judged(moved)
    assert row["measured_over_predicted"] > 5
    assert agreement.kind == "flagged"


def test_swapped_pictures_are_flagged(boards: Simulator, pictures: Pictures):
    for method in ("corners", "patches"):
        _, agreement = judged(measure(method, boards, RIG, Pictures(pictures.right, pictures.left)))
        assert agreement.kind != "agrees", method


def test_a_wrong_board_order_is_flagged(
    boards: Simulator, pictures: Pictures, monkeypatch: pytest.MonkeyPatch
):
    honest = room.match_sizes

    def turned(*args: object, **words: object):
        found = honest(*args, **words)
        uv_right = found.observations.uv_right.copy()
        for board in np.unique(found.board):
            ours = found.board == board
            uv_right[ours] = uv_right[ours][::-1]
        return replace(found, observations=replace(found.observations, uv_right=uv_right))

    monkeypatch.setattr(room, "match_sizes", turned)
    row, agreement = judged(measure("corners", boards, RIG, pictures))
    assert (agreement.kind, agreement.quantity) == ("flagged", "outliers")
    assert row["measured_outlier_fraction"] > 0.5


def test_nothing_found_says_why(boards: Simulator, pictures: Pictures):
    black = Pictures(np.full_like(pictures.left, 90), np.full_like(pictures.right, 90))
    for method in ("corners", "patches"):
        row, agreement = judged(measure(method, boards, RIG, black))
        assert row["measured_n"] == 0
        assert text(agreement).startswith("untold: nothing was measured (")


def test_bins_follow_the_true_depth(corners: MeasuredMatches):
    bins = bins_of(corners, RIG, np.array([0.5, 1.0, 2.0, 4.0]))
    depth = corners.points_left[:, 2]
    assert set(bins[depth > 4]) == {-1}
    assert set(bins[(depth > 1) & (depth < 2)]) == {1}


def test_a_lens_that_distorts_is_rectified_away(boards: Simulator):
    sensor = Sensor(blur_px=0.8, distortion=BrownConrady(k1=-0.2, k2=0.05))
    exposure = expose_pair(boards, RIG, sensor, 2)
    assert exposure.cameras[0].lens == sensor.distortion
    assert exposure.rig is RIG
    taken = exposure.pictures(sensor, np.random.default_rng(1))
    row, _ = judged(measure("corners", boards, RIG, taken))
    assert row["measured_n"] > 300
    assert row["measured_pixel_rms_px"] < 0.02


def test_two_distortions_are_refused(boards: Simulator):
    lens = replace(RIG.left, lens=BrownConrady(k1=-0.1))
    rig = StereoRig.rectified(lens, 0.12)
    boards.place(rig)
    with pytest.raises(InvalidRig, match="both distort"):
        expose_pair(boards, rig, Sensor(distortion=BrownConrady(k1=-0.2)), 1)
    boards.place(RIG)


def test_noise_of_the_picture_adds_no_render(monkeypatch: pytest.MonkeyPatch):
    drawn = []
    original = Simulator.render

    def counted(self: Simulator, supersample: int):
        drawn.append(self.scene.rig)
        return original(self, supersample)

    monkeypatch.setattr(Simulator, "render", counted)
    sensors = {f"{grey} grey": Sensor(grey_noise=grey) for grey in (0.0, 2.0, 6.0)}
    plan = Plan(n_points=200, n_trials=5, sensors=sensors, noises=(PixelNoise(0.1), PixelNoise(0.2)))
    result = sweep(RigGrid(RIG, resolutions_px=((640, 360),)), plan)
    assert len(drawn) == 1 + 1  # the rig, and the best one again for its pictures
    assert len(result.rows) == 6
    assert result.swept == ("noise_px", "sensor")
    by_sensor = result.rows[result.rows["noise_px"] == 0.1].set_index("sensor")
    assert (
        by_sensor.loc["0.0 grey", "measured_depth_rmse_mm"]
        < by_sensor.loc["6.0 grey", "measured_depth_rmse_mm"]
    )
    # pixel noise is simulated: it does not move what is measured
    assert result.rows.groupby("sensor")["measured_depth_rmse_mm"].nunique().eq(1).all()
    assert "corresponds to `--noise" in " ".join(verdict(result).sentences)


def test_what_nobody_measures_is_not_drawn_but_held_to_rays(monkeypatch: pytest.MonkeyPatch):
    lit, held = [], []
    render, check = Simulator.render, Simulator.check
    monkeypatch.setattr(Simulator, "render", lambda self, *of: lit.append(of) or render(self, *of))
    monkeypatch.setattr(Simulator, "check", lambda self, *of: held.append(of) or check(self, *of))
    grid = RigGrid(RIG, baselines_m=(0.06, 0.12), resolutions_px=((320, 180),))
    plan = Plan(n_points=200, n_trials=5)
    rows = sweep(grid, replace(plan, measure="none")).rows
    assert (len(lit), len(held)) == (1, 2)  # the best one's pictures; both rigs' depth
    drawn = sweep(grid, replace(plan, measure="patches")).rows
    assert (len(lit), len(held)) == (1 + 3, 2)
    assert rows["depth_rmse_mm"].tolist() == drawn["depth_rmse_mm"].tolist()
    # a renderer that draws another depth than rays hit is found out all the same
    original = GlRenderer.depth_and_segmentation

    def further(self: GlRenderer, *of: Any) -> Any:
        depth, ids = original(self, *of)
        return 1.01 * depth, ids

    monkeypatch.setattr(GlRenderer, "depth_and_segmentation", further)
    with pytest.raises(RenderMismatch):
        sweep(grid, replace(plan, measure="none"))


def test_scenes_with_few_boards_are_measured_by_patches():
    plan = Plan(scene="bin", n_points=200, n_trials=5)
    (small,) = RigGrid(preset("bin").rig, resolutions_px=((640, 480),))
    row = sweep([small], plan).rows.loc[0]
    assert row["measured_method"] == "patches"
    assert row["agreement"].kind == "agrees"


def test_plain_pictures_of_rays_are_not_measured():
    small = StereoRig.rectified(Intrinsics.from_focal(320, 180, 225.0), 0.12)
    row = sweep([small], Plan(n_points=100, n_trials=5, renderer="rays", supersample=1)).rows.loc[0]
    assert row["measured_method"] == "none"
    assert row["agreement"].kind == "agrees"


def test_unknown_methods_and_no_sensor_are_refused():
    with pytest.raises(InvalidRange, match="choose one of auto, none, corners"):
        Plan(measure="guess")
    with pytest.raises(InvalidRange, match="one sensor"):
        Plan(sensors={})
