"""Triangulators side by side: rows by hand, the bound's law, and what is said of those that break."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rigsim.errors import InvalidRange, TriangulatorError, TriangulatorTimeout
from rigsim.present.compare.words import headline, sentences
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.study.compare.columns import COLUMNS
from rigsim.study.compare.judge import off_bound, quantile
from rigsim.study.compare.row import Errors, errors, figures
from rigsim.study.compare.run import ComparisonPlan, ComparisonResult, compare
from rigsim.study.triangulators.registry import KNOWN
from rigsim.study.verify.bound import bound
from rigsim.theory.custom import TriangulatorFunction

RIG = StereoRig.rectified(Intrinsics.from_focal(1001, 1001, 1000.0), 0.1)
OPTIMAL, MIDPOINT, DLT = (KNOWN[name] for name in ("optimal", "midpoint", "dlt"))
QUICK = ComparisonPlan(("rectified", "verged"), (0.5, 1.0), 2000)


def moved(by_px: float) -> TriangulatorFunction:
    """Least squares on right pixels that are moved along u."""
    return lambda rig, uv_left, uv_right: OPTIMAL(rig, uv_left, uv_right + np.array([by_px, 0.0]))


def only_parallel(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    if not rig.is_rectified:
        raise ValueError("only parallel cameras")
    return OPTIMAL(rig, uv_left, uv_right)


def every_fourth_lost(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    found = OPTIMAL(rig, uv_left, uv_right)
    found[::4] = np.nan
    return found


def said(result: ComparisonResult) -> str:
    return " ".join(sentences(result))


def test_errors_of_a_point_by_hand() -> None:
    # f B / Z = 100 px; found where the right pixel is 1 px farther right, so at a disparity of 99
    truth, found = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, 100 / 99]])
    mine = errors(RIG, truth, found, 0.5)
    assert mine.squares == pytest.approx(1 / (3 * 0.25))
    # a disparity's noise is sqrt(2) times a pixel's, and 1 px less of it is too far
    assert mine.inverse_depth == pytest.approx(1 / (math.sqrt(2) * 0.5))
    assert mine.depth_m == pytest.approx(1 / 99)
    nowhere = errors(RIG, truth, np.full((1, 3), np.nan), 0.5)
    assert np.isnan([nowhere.squares, nowhere.inverse_depth, nowhere.depth_m]).all()


def test_bound_of_points_that_noise_loses_by_hand() -> None:
    # a disparity of sqrt(2) px at 1 px of noise stands one standard deviation from nothing:
    # Phi(1) = 0.841345, phi(1) = 0.241971, l = 0.287600
    points = np.tile([[0.0, 0.0, 100 / math.sqrt(2)]], (50, 1))
    must = bound(RIG, points, 1.0)
    assert must.failed_share == pytest.approx(0.158655, abs=1e-6)
    assert must.failed_share_se == pytest.approx(math.sqrt(0.158655 * 0.841345 / 50), rel=1e-5)
    assert must.squares == pytest.approx((3 - 0.287600) / 3, abs=1e-6)
    assert must.depth_squares == pytest.approx(1 - 0.287600, abs=1e-6)
    assert must.bias == pytest.approx(-0.287600, abs=1e-6)
    second, fourth = 1 - 0.287600, 3 - 4 * 0.287600
    assert must.squares_std == pytest.approx(
        math.sqrt((8 + 4 * second + fourth) / 9 - ((2 + second) / 3) ** 2), abs=1e-6
    )


def test_bound_without_losses_is_that_of_three_degrees_of_freedom() -> None:
    must = bound(RIG, np.array([[0.1, 0.1, 1.0]]), 0.1)
    assert (must.failed_share, must.squares, must.depth_squares) == pytest.approx((0, 1, 1))
    assert must.squares_std == pytest.approx(math.sqrt(2 / 3))


def test_figures_of_a_row_by_hand() -> None:
    must = bound(RIG, np.tile([[0.0, 0.0, 1.0]], (4, 1)), 0.5)
    nan = math.nan
    mine = Errors(
        np.array([4.0, 16.0, 4.0, nan]), np.array([2.0, 4.0, 0.0, nan]), np.array([1.0, 3, -2, nan])
    )
    first = Errors(np.array([1.0, 4.0, nan, 9.0]), np.zeros(4), np.zeros(4))
    row = figures(mine, first, must, 0.5)
    assert row["n"] == 4
    assert row["failed_share"] == 0.25
    assert row["pixel_bound_px"] == pytest.approx(0.5 * math.sqrt(3))
    assert row["pixel_error_px"] == pytest.approx(0.5 * math.sqrt(24))
    assert row["pixel_error_over_bound"] == pytest.approx(math.sqrt(8))
    # squares' std is sqrt(32); that of a root of their mean is std / (2 root sqrt(n))
    assert row["pixel_error_over_bound_se"] == pytest.approx(
        math.sqrt(32) / (2 * math.sqrt(8) * math.sqrt(3))
    )
    # over the two points that both found, each twice as far off: no doubt about it
    assert (row["pixel_error_over_first"], row["pixel_error_over_first_se"]) == pytest.approx((2, 0))
    assert row["depth_error_over_bound"] == pytest.approx(math.sqrt(20 / 3))
    assert row["depth_bias_over_std"] == pytest.approx(2)
    assert row["depth_bias_over_std_se"] == pytest.approx(math.sqrt(8 / 3) / math.sqrt(3))
    assert row["depth_median_abs_mm"] == 2000


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_least_squares_stays_at_the_bound_wherever_points_are_lost(seed: int) -> None:
    plan = ComparisonPlan(("far", "verged", "forward", "unequal"), (0.05, 0.3, 1.0, 3.0), 5000, seed)
    result = compare(plan, {"optimal": OPTIMAL})
    rows = result.rows
    assert rows["failed_share"].max() > 0.3  # far, at 3 px
    assert ((rows["pixel_error_over_bound"] - 1).abs() < 4.5 * rows["bound_se"]).all()
    beyond = rows["depth_bias_over_std"] - rows["expected_depth_bias_over_std"]
    assert (beyond.abs() < 4.5 * rows["depth_bias_over_std_se"]).all()
    more = rows["failed_share"] - rows["expected_failed_share"]
    assert (more.abs() <= 4.5 * rows["expected_failed_share_se"] + 1e-9).all()
    # what is seen of the spread is what the bound says
    assert rows["pixel_error_over_bound_se"].to_numpy() == pytest.approx(rows["bound_se"].to_numpy(), rel=0.1)
    assert headline(result) == "optimal stays within noise of the bound everywhere."


def test_midpoint_bias_grows_with_noise_and_is_called_near() -> None:
    plan = ComparisonPlan(("rectified",), (1.0, 2.0, 4.0, 8.0), 20_000)
    result = compare(plan, {"optimal": OPTIMAL, "midpoint": MIDPOINT})
    rows = result.rows[result.rows["triangulator"] == "midpoint"]
    bias, se = rows["depth_bias_over_std"].to_numpy(), rows["depth_bias_over_std_se"].to_numpy()
    assert (np.diff(bias) < -3 * se[1:]).all()
    assert "midpoint's points are too near by up to 0." in said(result)
    assert "optimal shows no bias beyond noise." in said(result)


@pytest.mark.parametrize(("by_px", "side"), [(0.5, "far"), (-0.5, "near")])
def test_a_bias_is_found_with_its_sign_and_size(by_px: float, side: str) -> None:
    # half a pixel of disparity, whose noise is sqrt(2) px
    plan = ComparisonPlan(("rectified",), (1.0,), 20_000)
    result = compare(plan, {"optimal": OPTIMAL, "biased": moved(by_px)})
    row = result.rows.iloc[1]
    assert row["depth_bias_over_std"] == pytest.approx(
        by_px / math.sqrt(2), abs=5 * row["depth_bias_over_std_se"]
    )
    assert f"biased's points are too {side} by up to 0.3" in said(result)
    # least squares keeps all of it in the right image: 0.25 beside the noise's 3
    must, se = math.sqrt(1 + 0.25 / 3), row["pixel_error_over_first_se"]
    assert row["pixel_error_over_first"] == pytest.approx(must, abs=5 * se)
    assert se < 0.005
    assert off_bound(result).tolist() == [False, True]
    assert "; biased is farthest off, 1.0" in headline(result)


def test_every_method_gets_the_same_noise() -> None:
    plan = replace(QUICK, n_points=20_000)
    result = compare(plan, {"optimal": OPTIMAL, "again": OPTIMAL, "dlt": DLT})
    rows = result.rows.set_index("triangulator")
    same = list(COLUMNS)[3:-2]
    assert (
        rows.loc["optimal", same]
        .reset_index(drop=True)
        .equals(rows.loc["again", same].reset_index(drop=True))
    )
    assert (rows.loc["again", "pixel_error_over_first"] == 1).all()
    assert (rows.loc["again", "pixel_error_over_first_se"] == 0).all()
    # pairs tell apart what the noise of each alone hides
    verged = result.rows[(result.rows["triangulator"] == "dlt") & (result.rows["geometry"] == "verged")]
    assert (verged["pixel_error_over_first"] - 1 > 3 * verged["pixel_error_over_first_se"]).all()
    assert (verged["pixel_error_over_first_se"] < verged["bound_se"] / 3).all()


def test_one_that_breaks_somewhere_is_told_and_the_rest_goes_on() -> None:
    result = compare(QUICK, {"mine": only_parallel, "optimal": OPTIMAL})
    assert set(result.rows["geometry"][result.rows["triangulator"] == "mine"]) == {"rectified"}
    assert (result.rows["triangulator"] == "optimal").sum() == 4
    assert result.left_out == ("triangulator 'mine' raised ValueError: only parallel cameras (in verged)",)
    assert headline(result) == "optimal stays within noise of the bound everywhere, mine wherever it ran."
    verged = result.rows[result.rows["geometry"] == "verged"]
    # there is no first one there
    assert verged[["pixel_error_over_first", "speed_over_first"]].isna().all(axis=None)


def test_lost_points_are_told() -> None:
    result = compare(QUICK, {"optimal": OPTIMAL, "loses": every_fourth_lost})
    assert (result.rows["failed_share"][result.rows["triangulator"] == "loses"] == 0.25).all()
    assert "loses loses 25 % of the points in rectified at 0.5 px, where noise alone loses 0 %." in said(
        result
    )
    assert "optimal loses" not in said(result)


def test_one_that_never_answers_has_rows_without_numbers() -> None:
    result = compare(
        QUICK, {"optimal": OPTIMAL, "none": lambda rig, uv_left, uv_right: np.full((len(uv_left), 3), np.nan)}
    )
    rows = result.rows[result.rows["triangulator"] == "none"]
    assert (rows["failed_share"] == 1).all()
    assert rows["pixel_error_over_bound"].isna().all()
    assert off_bound(result)[rows.index].all()
    assert headline(result).endswith("; none returns no point somewhere.")


def test_one_that_hangs_is_asked_three_times() -> None:
    calls = []

    def hangs(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        calls.append(len(uv_left))
        raise TriangulatorTimeout("took longer than 1 s")

    names = ("rectified", "verged", "rolled", "vertical", "unequal")
    result = compare(replace(QUICK, geometries=names), {"optimal": OPTIMAL, "hangs": hangs})
    assert len(calls) == 3
    assert result.left_out == ("hangs: took longer than 1 s (in rectified, verged, rolled)",)


def test_nothing_to_compare_is_an_error() -> None:
    with pytest.raises(InvalidRange, match="at least one triangulator"):
        compare(QUICK, {})
    with pytest.raises(TriangulatorError, match=r"^nothing could be compared: .*only parallel cameras"):
        compare(replace(QUICK, geometries=("verged",)), {"mine": only_parallel})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"geometries": ("nope",)}, "geometry 'nope': choose among rectified, "),
        ({"geometries": ()}, "at least one geometry or a --rig"),
        ({"noises_px": ()}, "at least one noise level"),
        ({"noises_px": (0.0,)}, "noise 0 px: must be > 0"),
        ({"noises_px": (math.nan,)}, "noise nan px: must be > 0 and finite"),
        ({"noises_px": (1.0, 1.0)}, "noise 1 px: given twice"),
        ({"n_points": 0}, "points 0: must be between 100 and 1,000,000"),
        ({"seed": -1}, "seed -1: must be >= 0"),
    ],
)
def test_plans_that_make_no_sense_are_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(InvalidRange) as raised:
        replace(QUICK, **given)
    assert words in str(raised.value)


def test_a_rig_of_ones_own_comes_first() -> None:
    plan = ComparisonPlan(("verged",), (0.5,), 200, rig=RIG)
    result = compare(plan, {"optimal": OPTIMAL})
    assert result.rows["geometry"].tolist() == ["your rig", "verged"]
    assert quantile(result) == pytest.approx(2.2414, abs=1e-3)  # 95 % for two rows together
