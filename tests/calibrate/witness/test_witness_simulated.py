"""Recalibrations with corner noise scatter as the covariance says, and tell what it does not know of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigsim.rig.board import Board
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.witness.bench import CalibrationBench
from rigsim.study.calibrate.witness.simulated import simulate_calibrations
from rigsim.theory.calibration.adjust import adjust
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.calibrate.board_pictures import RIG, small_bench

COUNT = 60


def test_recalibrations_scatter_as_predicted() -> None:
    """14 parameters and the frame, 60 times: the whitened spread is known to 2 %."""
    found = simulate_calibrations(small_bench(), count=COUNT, seed=1)
    assert (found.calibrations, found.failed, found.agreement.kind) == (COUNT, 0, "agrees")
    assert found.parameter_ratio == pytest.approx(1, abs=0.07)
    assert found.parameter_interval[0] < 1 < found.parameter_interval[1]
    assert found.misfit == pytest.approx(1, abs=0.02)
    for depth in found.depths:
        assert depth.interval[0] < depth.ratio < depth.interval[1]
        assert depth.ratio == pytest.approx(1, abs=0.3)
        assert abs(depth.mean_m) < 4 * depth.predicted_m / np.sqrt(COUNT)


def test_one_calibration_is_the_same_however_many_are_made() -> None:
    first, second = (simulate_calibrations(small_bench(boards=5), count=n, seed=4) for n in (10, 10))
    other = simulate_calibrations(small_bench(boards=5), count=10, seed=5)
    assert first == second
    assert first.depths != other.depths


def flat_bias(bench: CalibrationBench) -> list[float]:
    """What the mean must be: the depth errors of one calibration without noise, m."""
    found = adjust(bench.rig, bench.parameters, bench.board, bench.poses, bench.exact)
    return [float(error) for error in bench.errors(found.rig, found.poses).depth_m]


def bent(k1: float) -> StereoRig:
    return StereoRig(
        replace(RIG.left, lens=BrownConrady(k1=k1)),
        replace(RIG.right, lens=BrownConrady(k1=k1)),
        RIG.right_from_left,
    )


@pytest.mark.parametrize(
    "bench",
    [
        replace(small_bench(0.02), true_rig=bent(-0.02)),
        replace(small_bench(0.02), true_board=Board(7, 5, 0.03, (0.002, 0.002))),
    ],
    ids=["lens", "warp"],
)
def test_what_the_model_cannot_say_is_bias_and_misfit(bench: CalibrationBench) -> None:
    found = simulate_calibrations(bench, count=20, seed=2)
    assert found.agreement.kind == "flagged"
    assert found.misfit > 1.5
    assert np.isnan(found.parameter_ratio)
    for depth, bias_m in zip(found.depths, flat_bias(bench), strict=True):
        assert depth.mean_m == pytest.approx(bias_m, abs=4 * depth.std_m / np.sqrt(20))
        assert abs(bias_m) > depth.std_m


def test_a_wrong_square_scales_depths() -> None:
    """Squares of 30.3 mm taken for 30 mm shrink space by 1 % about the boards, and are no misfit."""
    bench = replace(small_bench(0.01), true_board=Board(7, 5, 0.0303))
    found = simulate_calibrations(bench, count=10, seed=2)
    assert (found.agreement.kind, found.agreement.reason) == ("flagged", "mean")
    assert found.misfit == pytest.approx(1, abs=0.05)
    held_m = float(bench.poses.t[:, 2].mean())
    for depth in found.depths:
        assert depth.mean_m == pytest.approx(-(0.3 / 30.3) * (depth.z_m - held_m), abs=2e-4)


def test_an_interrupt_keeps_what_is_done() -> None:
    def stop(done: int) -> None:
        if done == 9:
            raise KeyboardInterrupt

    found = simulate_calibrations(small_bench(boards=5), count=50, seed=1, progress=stop)
    assert found.calibrations == 9


@pytest.mark.parametrize("warped", [False, True], ids=["taken-for-flat", "looked-for"])
def test_boards_that_are_not_flat_scatter_as_predicted(warped: bool) -> None:
    """Each calibration has a board of its own; the warp's share of the depth's spread is the larger one."""
    bench = replace(small_bench(0.02), flatness_m=5e-4)
    flat = small_bench(0.02).covariance(0.02).depth_std(bench.points)
    if warped:
        bench = replace(bench, parameters=RigParameters.of((None, None), warped=True))
    found = simulate_calibrations(bench, count=COUNT, seed=8)
    assert found.agreement.kind == "agrees"
    assert found.parameter_ratio == pytest.approx(1, abs=0.1)
    for depth, alone_m in zip(found.depths, flat, strict=True):
        assert depth.ratio == pytest.approx(1, abs=0.3)
        assert (depth.predicted_m > 1.5 * alone_m) != warped
    assert (found.misfit > 1.1) != warped


def test_without_noise_there_is_nothing_to_compare() -> None:
    found = simulate_calibrations(small_bench(0.0, boards=5), count=9)
    assert (found.failed, found.agreement.kind, found.agreement.reason) == (0, "untold", "exact")
    assert max(abs(depth.mean_m) for depth in found.depths) < 1e-6
