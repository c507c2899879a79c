"""Boards that are drawn, found and calibrated by OpenCV leave the spread that the covariance predicts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigsim.rig.board import Board
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.study.calibrate.witness.measured import fix_for_opencv, measure_calibrations
from rigsim.theory.calibration.adjust import adjust
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.calibrate.board_pictures import small_bench


def test_rendered_boards_scatter_as_predicted_at_the_noise_found() -> None:
    stages: list[tuple[str, int, int]] = []
    found = measure_calibrations(
        small_bench(boards=6), count=8, seed=1, progress=lambda *stage: stages.append(stage)
    )
    assert (found.calibrations, found.failed, found.boards, found.unfound) == (8, 0, 6, 0)
    assert found.by_opencv
    assert 0.01 < found.corner_noise_px < 0.1
    assert found.misfit == pytest.approx(1, abs=0.1)
    # 20 numbers, 8 times: 1 +- .06
    assert 0.8 < found.parameter_ratio < 1.25
    assert found.agreement.kind != "flagged"
    for depth in found.depths:
        assert abs(depth.mean_m) < 3 * depth.predicted_m
        assert depth.predicted_m > 0
    assert stages[11] == ("pictures", 12, 12)
    assert stages[-1] == ("calibrations", 8, 8)


def test_boards_of_one_camera_are_left_out_of_what_opencv_calibrates() -> None:
    bench = small_bench(boards=6)
    seen = bench.seen.copy()
    seen[4, 1] = seen[5, 0] = False
    found = measure_calibrations(replace(bench, seen=seen), count=2, seed=1)
    assert (found.boards, found.by_opencv, found.agreement.reason) == (4, True, "too-few-trials")


def test_what_opencv_cannot_hold_is_adjusted_instead() -> None:
    bench = small_bench(boards=6)
    parameters = RigParameters.of((None, None), fix=("left.cx",))
    seen = bench.seen.copy()
    seen[5, 0] = False
    found = measure_calibrations(replace(bench, parameters=parameters, seen=seen), count=2, seed=1)
    assert (found.boards, found.by_opencv, found.failed) == (6, False, 0)
    assert found.misfit == pytest.approx(1, abs=0.15)


def test_too_few_boards_are_untold() -> None:
    bench = small_bench(boards=6)
    found = measure_calibrations(replace(bench, seen=np.eye(6, 2) > 1), count=2)
    assert (found.agreement.kind, found.agreement.reason) == ("untold", "nothing-measured")


@pytest.mark.parametrize(
    ("fix", "held"),
    [
        ((), ()),
        (("k3", "aspect"), ("left.k3", "right.k3", "left.aspect", "right.aspect")),
        (("left.k3",), None),
        (("rx_rad",), None),
    ],
)
def test_what_is_held_is_handed_to_opencv_where_it_can(
    fix: tuple[str, ...], held: tuple[str, ...] | None
) -> None:
    assert fix_for_opencv(RigParameters.of((BrownConrady, BrownConrady), fix=fix)) == held


def test_a_warped_board_leaves_the_bias_that_exact_corners_have() -> None:
    bench = replace(small_bench(boards=6), true_board=Board(7, 5, 0.03, (0.002, 0.002)))
    found = measure_calibrations(bench, count=2, seed=1)
    exact = adjust(bench.rig, bench.parameters, bench.board, bench.poses, bench.exact)
    bias_m = bench.errors(exact.rig, exact.poses).depth_m
    assert found.misfit > 1.5
    for depth, expected_m in zip(found.depths, bias_m, strict=True):
        assert depth.mean_m == pytest.approx(expected_m, abs=4 * depth.predicted_m)
        assert abs(expected_m) > 5 * depth.predicted_m
