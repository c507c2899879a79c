"""What a rig has of each requirement, from cases computed by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from rigsim.present.design.words import grounds
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.design.checks import RequirementCheck, RigInScene, check, nearest_points
from rigsim.study.scene.third_witness import MeasuredMatches
from rigsim.theory.inverse import Requirement
from rigsim.theory.inverse_error import P95_OVER_STD
from tests.helpers.sampling import close

# f 1000 px, 1280 px wide, 100 mm; noise 0.25 px: at 3 m 9 x 0.25 sqrt(2) / 100 = 31.8 mm
RIG = StereoRig.rectified(Intrinsics.from_focal(1280, 960, 1000.0), 0.1)
NOISE = PixelNoise(0.25)
STD_3M = 9 * 0.25 * math.sqrt(2) / 100


def sight(
    points: NDArray[np.float64],
    rmse_m: NDArray[np.float64] | None = None,
    measured: MeasuredMatches | None = None,
) -> RigInScene:
    rmse = np.full(len(points), np.nan) if rmse_m is None else rmse_m
    return RigInScene(RIG, 0.1, (1280, 960), points, rmse, NOISE, 200, measured)


def at(depth_m: NDArray[np.float64] | float, n: int = 400) -> NDArray[np.float64]:
    z = np.broadcast_to(depth_m, (n,))
    return np.column_stack([np.linspace(-0.1, 0.3, n), np.zeros(n), z])


def found(asked: Requirement, seen: RigInScene) -> RequirementCheck:
    return check(asked, seen, np.random.default_rng(7))


def matches(points: NDArray[np.float64], disparity_error_px: NDArray[np.float64]) -> MeasuredMatches:
    uv_left, uv_right = RIG.project(points)
    shift = np.column_stack([disparity_error_px, np.zeros(len(points))])
    errors = np.hstack([np.zeros((len(points), 2)), -shift])
    covariance = np.zeros((len(points), 4, 4))
    astray = np.zeros(len(points), dtype=bool)
    return MeasuredMatches("patches", uv_left, uv_right - shift, covariance, points, errors, astray)


def test_a_standard_deviation_scales_by_the_square_of_the_distance() -> None:
    z = np.linspace(2.0, 3.0, 400)
    asked = Requirement("depth_error", 0.010, 3.0)
    held = found(asked, sight(at(z), 0.0099 * (z / 3.0) ** 2))
    close(held.simulated, 0.0099, rtol=1e-12)
    assert held.is_met
    assert held.nearest_m >= 3 / 1.25
    assert not found(asked, sight(at(z), 0.0101 * (z / 3.0) ** 2)).is_met
    nothing_there = found(asked, sight(at(1.0), np.full(400, 1e-6)))
    assert math.isnan(nothing_there.simulated)
    assert not nothing_there.is_met


def test_a_percentile_is_counted_not_multiplied() -> None:
    asked = Requirement("depth_error", 0.1, 3.0, P95_OVER_STD)
    # the RMS handed in is a lie: the percentile is drawn anew
    held = found(asked, sight(at(2.8), np.full(400, 1.0)))
    close(held.simulated, STD_3M * P95_OVER_STD, rtol=0.02)
    assert held.is_met


def test_disparities_come_from_points_there_or_from_a_plane() -> None:
    near = Requirement("max_disparity", 210.0, 0.5)
    for seen, shown_by in (
        (sight(at(0.55)), "points"),
        (sight(at(0.7)), "plane"),
        (sight(at(0.55, 29)), "plane"),
    ):
        held = found(near, seen)
        close(held.simulated, 1000 * 0.1 / 0.5, rtol=1e-9)
        assert held.shown_by == shown_by
        assert held.is_met
    far = found(Requirement("far_disparity", 4.0, 3.0), sight(at(2.9)))
    close(far.simulated, 1000 * 0.1 / 3 / (0.25 * math.sqrt(2)), rtol=1e-9)


def test_a_plane_shows_overlap_and_coverage() -> None:
    # at 0.5 m the right camera misses 200 of 1280 columns; at 2 m the left one sees 2.56 m
    overlap = found(Requirement("overlap", 1080 / 1280, 0.5), sight(at(1.0)))
    close(overlap.simulated, 1080 / 1280, rtol=1e-4)
    assert overlap.is_met
    assert not found(Requirement("overlap", 1082 / 1280, 0.5), sight(at(1.0))).is_met
    cover = found(Requirement("cover", 2.46, 2.0), sight(at(1.0)))
    close(cover.simulated, 2.46, rtol=1e-4)
    assert cover.is_met
    assert not found(Requirement("cover", 2.462, 2.0), sight(at(1.0))).is_met


def test_cameras_and_pictures_speak_for_themselves() -> None:
    seen = sight(at(1.0))
    close(found(Requirement("fov", 1.0), seen).simulated, 2 * math.atan(0.64), rtol=1e-12)
    assert found(Requirement("fov", 2 * math.atan(0.64)), seen).is_met
    assert not found(Requirement("pixels", 1_000_000), seen).is_met
    assert found(Requirement("max_baseline", 0.1), seen).is_met
    assert not found(Requirement("max_baseline", 0.0999), seen).is_met


@pytest.mark.parametrize("per_std", [1.0, P95_OVER_STD])
def test_pixels_are_held_to_the_same(per_std: float) -> None:
    rng = np.random.default_rng(5)
    points, error_px = at(2.7, 20_000), 0.5 * rng.standard_normal(20_000)
    asked = Requirement("depth_error", 0.05 * per_std, 3.0, per_std)
    seen = sight(points, np.full(20_000, 0.03), matches(points, error_px))
    held = found(asked, seen)
    close(held.measured, 9 * 0.5 / 100 * per_std, rtol=0.03)  # 45 mm at 3 m
    assert held.n_measured == 20_000
    assert not held.is_missed_by_pixels
    tight = Requirement("depth_error", 0.043 * per_std, 3.0, per_std)
    assert found(tight, seen).is_missed_by_pixels
    # thirty matches may miss by a quarter, and fewer say nothing
    few = sight(at(2.7), np.full(400, 0.03), matches(points[:30], np.full(30, 0.5)))
    assert found(tight, few).measured > 0
    none = sight(at(2.7), np.full(400, 0.03), matches(points[:29], np.full(29, 0.5)))
    assert math.isnan(found(tight, none).measured)
    assert not found(tight, none).is_missed_by_pixels


def test_grounds_count_each_point_once_and_say_where_they_are() -> None:
    std, p95 = (Requirement("depth_error", 1.0, 3.0, per_std) for per_std in (1.0, P95_OVER_STD))
    near = Requirement("depth_error", 1.0, 1.7)
    # 150 points about 1.64 m: nothing is within 1.25 of 3 m, so the nearest 100 stand for it
    seen = sight(at(np.linspace(1.63, 1.65, 150), 150), np.full(150, 1e-3))
    both = [found(std, seen), found(p95, seen)]
    assert [held.n_points for held in both] == [100, 100]
    assert both[0].is_widened
    far = "verified at 1.64 to 1.65 m (asked for at 3 m)"
    assert grounds(both, "`hall`", 50, "", "").startswith(
        f"{far}: simulated in `hall` on 100 points there, 50 trials each"
    )
    also_near = [*both, found(near, seen)]
    assert not also_near[-1].is_widened
    assert grounds(also_near, "`hall`", 50, "", "").startswith(
        f"{far} and near the other distances: simulated in `hall` on 150 points near the distances asked "
        "for, or the nearest to them, 50"
    )
    # matches of one distance are counted once as well
    points = at(np.linspace(2.5, 3.4, 400))
    seen = sight(points, np.full(400, 1e-3), matches(points, np.zeros(400)))
    said = grounds([found(std, seen), found(p95, seen)], "`hall`", 50, "patches", "ideal")
    assert said.startswith("verified: simulated in `hall`")
    assert "on 400 points near the distances asked for, 50" in said
    assert "measured on 400 patches" in said


def test_nearest_points_take_the_window_or_the_nearest() -> None:
    depth_m = np.array([1.0, 1.4, 2.0, 2.2, 2.6, 5.0])
    assert sorted(nearest_points(depth_m, 2.0, 2).tolist()) == [2, 3]
    assert sorted(nearest_points(depth_m, 2.0, 4).tolist()) == [1, 2, 3, 4]
    assert len(nearest_points(depth_m, 2.0, 6)) == 0  # 5 m is too far off
