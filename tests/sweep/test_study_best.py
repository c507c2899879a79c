"""Which rig is best, over which distances, and whose average a number is."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from rigsim import Intrinsics, PixelNoise, Plan, RigGrid, StereoRig, sweep
from rigsim.present.sweep.words import growth_words, verdict
from rigsim.sim.truth.points import image_weights, spread_over
from rigsim.study.agreement.agreement import AGREES
from rigsim.study.scene.columns import AXES, DEPTH_COLUMNS, ROW_COLUMNS
from rigsim.study.sweep.choice import trend
from rigsim.study.sweep.comparison import compare, row_of_bins
from rigsim.study.sweep.growth import growth_of
from rigsim.theory.reach import reach_m
from rigsim.theory.uncertainty import depth_in_sigmas
from tests.helpers.scenes import SLANTED, write

F, WIDTH, HEIGHT, EYE_M, NOISE_PX = 200.0, 320, 240, 1.2, 0.25
RIG = StereoRig.rectified(Intrinsics.from_focal(WIDTH, HEIGHT, F), 0.2)
FLOOR = f"""<mujoco><worldbody>
  <site name="rig" pos="0 0 {EYE_M}"/><geom type="plane" size="0 0 .1"/>
</worldbody></mujoco>"""


@pytest.fixture(scope="module")
def floor(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write(tmp_path_factory.mktemp("open"), FLOOR)


def plan(scene: str, **changes: object) -> Plan:
    defaults = {
        "scene": scene,
        "renderer": "rays",
        "supersample": 1,
        "n_points": 1000,
        "n_trials": 40,
        "measure": "none",
    }
    return Plan(**(defaults | changes))


def floor_rows(baseline_m: float, far_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Depth of the floor in fine rows of the image, up to a far end, and the share of each that both see."""
    v = np.arange(-0.5, HEIGHT - 0.5, 1e-3) - (HEIGHT - 1) / 2
    depth = F * EYE_M / v[v > 0]
    depth = depth[depth <= far_m]
    return depth, 1 - F * baseline_m / depth / WIDTH


def test_short_baselines_do_not_win_by_losing_what_is_far(floor: str):
    # 100 mm lose the floor beyond 14 m, where 400 mm still have 4 sigma at 56 m; coverage is 98 and 93 %
    result = sweep(RigGrid(RIG, baselines_m=(0.1, 0.2, 0.4)), plan(floor, seed=1))
    own = result.rows["depth_rmse_mm"]
    assert own[0] < own[2]  # averages over what each can answer say the contrary
    assert list(result.best) == [2, 1, 0]
    (trend,) = [words for words in verdict(result).sentences if words.startswith("From 100 to 400 mm")]
    assert "at 2 to 12.5 m falls" in trend
    # the law: the error at the same distances goes with 1 / B; at 4.5 sigma, the shortest, a little faster
    error = compare(result.rows, result.by_depth).simulated_mm
    assert error[1] / error[2] == pytest.approx(2, rel=0.05)
    assert 2 < error[0] / error[1] < 2.6


def test_a_row_compares_at_shared_distances_only():
    rows, bins = tables(
        {
            # baseline: (near, far, rmse, points, low share, share of the image)
            100.0: [(1, 2, 10.0, 50, 0, 0.6), (2, 4, 40.0, 50, 0, 0.3), (4, 8, 90.0, 50, 0.4, 0.1)],
            200.0: [(1, 2, 5.0, 50, 0, 0.6), (2, 4, 20.0, 50, 0, 0.3), (4, 8, 80.0, 50, 0, 0.1)],
        }
    )
    found = compare(rows, bins)
    assert found.spans_mm == ((1000, 4000),)
    # two thirds of the shared pixels are near, a third is far
    np.testing.assert_allclose(found.simulated_mm, np.sqrt([(2 * 100 + 1600) / 3, (2 * 25 + 400) / 3]))


def test_other_depths_within_a_bin_are_brought_together():
    rows, bins = tables({100.0: [(1, 2, 10.0, 50, 0, 0.5)], 200.0: [(1, 2, 10.0, 50, 0, 0.5)]})
    bins["depth_of_rmse_mm"] = [1000.0, 1440.0]
    found = compare(rows, bins)
    # to 1220 mm by the square of the depth
    np.testing.assert_allclose(found.simulated_mm, 10 * 1.22**2 / np.array([1, 1.44]) ** 2)


@pytest.mark.parametrize(
    ("short", "long"),
    [
        # of 100 points, how many lie on a surface at 2.02 m, the others on one at 2.48 m
        (100, 0),  # averages over the bin rise from 41 to 52 mm
        (49, 51),  # medians lie on different surfaces: brought together by them, it rises from 43 to 55 mm
        (51, 49),
    ],
)
def test_where_the_error_falls_at_every_distance_it_is_said_to_fall(short: int, long: int):
    rows, bins = tables({b: [(2, 2.5, 1.0, 100, 0, 0.5)] for b in (100.0, 200.0)})
    for place, (near, factor_mm) in enumerate(((short, 10.0), (long, 8.5))):  # at 1 m: 15 % less
        depth_m = np.repeat([2.02, 2.48], [near, 100 - near])
        error_mm = factor_mm * depth_m**2
        rms_mm = float(np.sqrt((error_mm**2).mean()))
        for name in ("depth_rmse_mm", "predicted_depth_rmse_mm", "depth_rmse_ci_high_mm"):
            bins.loc[place, name] = rms_mm
        bins.loc[place, "depth_of_rmse_mm"] = 1e3 * np.mean(depth_m**4) ** 0.25
    found = trend(rows, bins, ("baseline_mm",), 1)
    assert found is not None
    assert found.last_mm / found.first_mm == pytest.approx(0.85, rel=1e-9)


def test_a_row_that_answers_little_does_not_decide_where():
    near, far = (1, 2, 9.0, 50, 0, 0.2), (2, 4, 30.0, 50, 0, 0.8)
    rows, bins = tables({10.0: [near], 100.0: [near, far], 200.0: [near, far]})
    found = compare(rows, bins)
    assert found.spans_mm == ((1000, 4000),)
    assert list(found.compared) == [False, True, True]


def tables(of: dict[float, list[tuple[float, ...]]]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Rows and bins with what a comparison looks at."""
    rows, bins = [], []
    for baseline, parts in of.items():
        head = dict.fromkeys(AXES, 1.0) | {"scene": "s", "baseline_mm": baseline}
        rows.append(
            head | {"n_points": 50, "depth_rmse_mm": 1.0, "visible_fraction": 1.0, "agreement": AGREES}
        )
        for near, far, rmse, n, low, share in parts:
            part = {"depth_near_mm": 1e3 * near, "depth_far_mm": 1e3 * far, "depth_rmse_mm": rmse}
            part |= {"n_visible": n, "low_disparity_fraction": low, "scene_fraction": share}
            part |= {"predicted_depth_rmse_mm": rmse, "depth_rmse_ci_high_mm": rmse}
            bins.append(head | part | {"depth_of_rmse_mm": 1e3 * math.sqrt(near * far)})
    return pd.DataFrame(rows, columns=list(ROW_COLUMNS)), pd.DataFrame(bins, columns=list(DEPTH_COLUMNS))


def test_equal_methods_are_said_to_be_as_good(floor: str):
    result = sweep([RIG], plan(floor, triangulators=("optimal", "dlt"), range_m=(2.0, 5.0)))
    assert any("equally good within sampling error: `" in words for words in verdict(result).sentences)


def test_rigs_that_no_column_tells_apart_keep_their_own_bins(floor: str):
    lower = StereoRig(RIG.left, replace(RIG.right, cy=RIG.right.cy - 20), RIG.right_from_left)
    result = sweep([RIG, lower], plan(floor, n_points=300))
    assert (result.rows.loc[0, list(AXES)] == result.rows.loc[1, list(AXES)]).all()
    places = row_of_bins(result.rows, result.by_depth)
    np.testing.assert_array_equal(result.by_depth.groupby(places)["n_points"].sum(), result.rows["n_points"])


def test_coverage_and_averages_are_those_of_the_floors_pixels(floor: str):
    row = sweep([RIG], plan(floor, n_points=4000, range_m=(0.1, 20.0))).rows.loc[0]
    depth, both = floor_rows(0.2, 20.0)
    assert row["scene_fraction"] == pytest.approx(len(depth) * 1e-3 / HEIGHT, rel=0.01)
    assert row["visible_fraction"] == pytest.approx(both.mean(), rel=0.01)
    assert row["overlap_fraction"] == pytest.approx(both.mean(), rel=0.01)
    a = (depth / (F * 0.2) * math.sqrt(2) * NOISE_PX) ** 2  # of (sigma_Z / Z)^2; 9 a^2 is the next term
    per_pixel_mm = 1e3 * math.sqrt((depth**2 * (a + 9 * a**2) * both).sum() / both.sum())
    assert row["predicted_depth_rmse_image_mm"] == pytest.approx(per_pixel_mm, rel=0.05)
    assert row["depth_rmse_image_mm"] == pytest.approx(per_pixel_mm, rel=0.05)
    # as many points from each bin of depth: another average by a factor of two
    assert row["depth_rmse_mm"] > 1.5 * row["depth_rmse_image_mm"]


def test_coverage_behind_a_post_is_a_dense_ray_counts(tmp_path: Path):
    lens = Intrinsics(320, 240, 300.0, 300.0, 150.0, 110.0)
    rig = StereoRig.rectified(lens, 0.2)
    result = sweep([rig], plan(write(tmp_path, SLANTED), n_points=200, n_trials=2))
    # every pixel of a grid four times as fine, by the planes of the scene; the rig is at (0, 0, 1)
    v, u = np.mgrid[-0.375:240:0.25, -0.375:320:0.25][:, :960, :1280].reshape(2, -1)
    y, z = -(u - 150) / 300, -(v - 110) / 300  # beside and above, for each metre ahead
    normal = np.array([math.cos(math.radians(30)), 0.5, 0.0])
    wall = (normal @ [4, 0, 0] - 0.05 - normal[1] * 0.1) / (normal[0] + normal[1] * y)
    post = (np.abs(1.95 * y + 0.1 - 0.2) <= 0.1) & (np.abs(1.95 * z) <= 0.4)
    depth = np.where(post, 1.95, wall)
    # of the wall, what the post's 2 x 4 faces hide from (0, -.1)
    x, side = depth, depth * y + 0.1 + 0.1
    hidden = np.zeros(len(x), dtype=bool)
    for at in np.linspace(1.95, 2.05, 21):
        across, up = side / x * at - 0.1, depth * z / x * at
        hidden |= (across > 0.1) & (across < 0.3) & (np.abs(up) < 0.4)
    inside = u - 300 * 0.2 / depth >= -0.5
    both = inside & (post | ~hidden)
    row = result.rows.loc[0]
    assert row["scene_fraction"] == pytest.approx(1, abs=1e-12)
    assert row["overlap_fraction"] == pytest.approx(inside.mean(), abs=0.003)
    assert row["visible_fraction"] == pytest.approx(both.mean(), abs=0.005)


def test_the_truth_ends_where_the_last_rig_ends(floor: str):
    # 200 x .2 / (4 sqrt(2) .25) = 28.3 m for the longer baseline: the end of its bin is 32 m
    result = sweep(RigGrid(RIG, baselines_m=(0.05, 0.2)), plan(floor))
    assert result.far_limit_m == 32
    assert result.by_depth["depth_far_mm"].max() == 32_000
    beyond = F * EYE_M / 32 / HEIGHT
    (words,) = [words for words in verdict(result).sentences if "beyond 32 m" in words]
    assert f"up to {100 * beyond:.0f} % of a left image" in words


def test_a_given_range_wins_and_a_near_scene_has_no_end(floor: str, tmp_path: Path):
    given = sweep([RIG], plan(floor, range_m=(1.0, 200.0)))
    assert given.by_depth["depth_far_mm"].max() == 200_000
    near = sweep([RIG], plan(write(tmp_path, SLANTED), n_points=100))
    for result in (given, near):
        assert math.isinf(result.far_limit_m)
        assert "left out" not in " ".join(verdict(result).sentences)


def test_reach_of_a_rectified_rig_is_by_hand():
    assert reach_m(RIG, PixelNoise(0.25)) == pytest.approx(40 / (4 * math.sqrt(2) * 0.25), rel=1e-9)
    assert reach_m(RIG, PixelNoise(0.25, correlation=0.5)) == pytest.approx(40, rel=1e-9)
    assert math.isinf(reach_m(RIG, PixelNoise(0.0)))


def test_reach_of_a_verged_rig_is_where_the_last_ray_comes_down_to_four():
    rig, noise = StereoRig.verged(RIG.left, 0.3, 8.0), PixelNoise(0.3)
    reach = reach_m(rig, noise)
    u, v = np.meshgrid(np.linspace(-0.5, WIDTH - 0.5, 41), np.linspace(-0.5, HEIGHT - 0.5, 41))
    rays = np.column_stack([rig.left.normalize(np.column_stack([u.ravel(), v.ravel()])), np.ones(u.size)])
    assert np.nanmax(depth_in_sigmas(rig, 0.99 * reach * rays, noise)) > 4
    assert np.nanmax(depth_in_sigmas(rig, 1.01 * reach * rays, noise)) < 4


@pytest.mark.parametrize(
    ("power", "words"),
    [
        (2.0, "it grows with the distance squared"),
        (1.5, "it grows with the distance to the power 1.5, not squared"),
    ],
)
def test_growth_is_what_the_bins_say(power: float, words: str):
    depth = np.array([1000.0, 2000.0, 4000.0, 8000.0])
    bins = pd.DataFrame({"depth_median_mm": depth, "depth_rmse_mm": 3 * (depth / 1e3) ** power})
    assert growth_words(growth_of(bins)) == words


def test_growth_that_is_no_power_is_told_by_its_ends():
    bins = pd.DataFrame({"depth_median_mm": [1e3, 2e3, 4e3], "depth_rmse_mm": [1.0, 20.0, 30.0]})
    assert (
        growth_words(growth_of(bins))
        == "30 times the error at 4 times the distance (its square would be 16 times)"
    )


def test_points_weigh_what_their_bin_covers():
    # 3 of 4 rays meet the near bin, which holds one point of three
    weights = image_weights(np.array([0, 1, 1]), np.array([0, 0, 1, 0]), 2)
    np.testing.assert_allclose(weights, [0.75, 0.125, 0.125])


def test_rays_of_coverage_spread_evenly():
    uv = spread_over(64, 48, 1 << 14)
    assert uv.min() >= -0.5
    assert (uv.max(axis=0) <= (63.5, 47.5)).all()
    counts, _, _ = np.histogram2d(*uv.T, bins=(16, 12), range=((-0.5, 63.5), (-0.5, 47.5)))
    assert np.abs(counts / (len(uv) / 192) - 1).max() < 0.1  # random ones: 0.3
