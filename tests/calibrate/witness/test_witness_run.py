"""Both witnesses of a plan by one call."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from rigsim.errors import InvalidRange
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.asked import PlanAsked, Reach
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.plan.run import run_plan
from rigsim.study.calibrate.witness.run import run_witnesses
from tests.helpers.calibrate.board_pictures import RIG, small_bench


@cache
def small_plan() -> CalibrationPlan:
    bench = small_bench(boards=5)
    return run_plan(
        PlanAsked(RIG, bench.parameters, bench.board, bench.poses, Reach(0.3, 0.6), at_m=(1.0, 2.0), seed=3)
    )


def test_each_witness_speaks_of_the_plan() -> None:
    stages: list[str] = []
    simulated, measured = run_witnesses(
        small_plan(), simulated=9, measured=2, progress=lambda things, done, total: stages.append(things)
    )
    assert (simulated.name, simulated.calibrations, measured.name, measured.calibrations) == (
        *("simulated", 9),
        *("measured", 2),
    )
    assert list(dict.fromkeys(stages)) == ["recalibrations", "pictures", "calibrations"]
    assert [row.z_m for row in simulated.depths] == [row.z_m for row in measured.depths] == [1.0, 2.0]
    predicted = [row.calibration_m for row in small_plan().depths if row.place == "axis"]
    assert [row.predicted_m for row in simulated.depths] == pytest.approx(predicted, rel=1e-9)


def test_flat_only_on_average_is_predicted_as_the_plan_does() -> None:
    plan = run_plan(replace(small_plan().asked, flatness_m=2e-4))
    (simulated,) = run_witnesses(plan, simulated=2, measured=0)
    predicted = [row.calibration_m for row in plan.depths if row.place == "axis"]
    assert [row.predicted_m for row in simulated.depths] == pytest.approx(predicted, rel=1e-9)


def test_an_interrupt_leaves_the_other_witness_out() -> None:
    def stop(things: str, done: int, total: int) -> None:
        if things == "pictures" or done == 12:
            raise KeyboardInterrupt

    (simulated,) = run_witnesses(small_plan(), simulated=9, measured=3, progress=stop)
    assert simulated.calibrations == 9
    (simulated,) = run_witnesses(small_plan(), simulated=40, measured=3, progress=stop)
    assert simulated.calibrations == 12
    with pytest.raises(KeyboardInterrupt):
        run_witnesses(small_plan(), simulated=0, measured=3, progress=stop)


def test_what_does_not_fit_the_plan_is_one_line() -> None:
    other = StereoRig(replace(RIG.left, width=600), RIG.right, RIG.right_from_left)
    with pytest.raises(InvalidRange, match=r"-1 simulated calibrations: must be 0 to"):
        run_witnesses(small_plan(), simulated=-1)
    with pytest.raises(InvalidRange, match=r"true left camera of 600 x 480 px: must be 640 x 480"):
        run_witnesses(small_plan(), true_rig=other)
    with pytest.raises(InvalidRange, match=r"true board 9x6@30mm: must have 7x5 corners"):
        run_witnesses(small_plan(), true_board=Board(9, 6, 0.03))
