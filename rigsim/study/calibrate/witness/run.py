"""Both witnesses of a plan, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rigsim import interrupts
from rigsim.errors import InvalidRange
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.progress import Stage
from rigsim.study.calibrate.witness.bench import CalibrationBench
from rigsim.study.calibrate.witness.measured import measure_calibrations
from rigsim.study.calibrate.witness.result import CalibrationWitness
from rigsim.study.calibrate.witness.simulated import simulate_calibrations

MOST = 100_000
"""Most calibrations of one witness."""


def run_witnesses(
    plan: CalibrationPlan,
    *,
    simulated: int = 300,
    measured: int = 20,
    true_rig: StereoRig | None = None,
    true_board: Board | None = None,
    seed: int | None = None,
    progress: Stage | None = None,
) -> tuple[CalibrationWitness, ...]:
    """Make a planned calibration many times: of simulated corners, and of rendered pictures.

    Args:
        plan: What is calibrated, and where the board is held.
        simulated: Calibrations of simulated corners; 0 leaves them out.
        measured: Calibrations of rendered pictures; 0 leaves them out. Each board is drawn once by each
            camera, which takes longest.
        true_rig: What the cameras really are, as with a lens that the plan's model cannot say.
        true_board: What the board really is, as a warped one, or one of another square.
        seed: Of all noise; the plan's by default.
        progress: Told of what things (``recalibrations``, ``pictures``, ``calibrations``), how many are done,
            of how many. When it is interrupted (KeyboardInterrupt), what is done by then is returned.

    Raises:
        InvalidRange: a count is negative, or what is true does not fit the plan.
        Undetermined: the boards leave a parameter open.
        RenderUnavailable: no renderer works here.
    """
    for name, count in (("simulated", simulated), ("measured", measured)):
        if not 0 <= count <= MOST:
            raise InvalidRange(f"{count} {name} calibrations: must be 0 to {MOST}")
    _check(plan, true_rig, true_board)
    bench = CalibrationBench.of(plan, true_rig, true_board)
    seed = plan.asked.seed if seed is None else seed
    found: list[CalibrationWitness] = []
    if simulated:
        told = None if progress is None else lambda done: progress("recalibrations", done, simulated)
        found.append(simulate_calibrations(bench, count=simulated, seed=seed, progress=told))
        if found[0].calibrations < simulated:
            return told_truth(found, bench)
    if measured:
        try:
            found.append(measure_calibrations(bench, count=measured, seed=seed, progress=progress))
        except KeyboardInterrupt:
            if not found:
                raise
            interrupts.caught()
    return told_truth(found, bench)


def told_truth(
    found: Sequence[CalibrationWitness], bench: CalibrationBench
) -> tuple[CalibrationWitness, ...]:
    """The witnesses with what was true in them where the plan takes it for something else."""
    lens = ""
    if bench.true_rig is not None:
        own = bench.true_rig.left.lens or bench.true_rig.right.lens
        lens = "pinhole" if own is None else own.model
    board = bench.true_board is not None and bench.true_board != bench.board
    return tuple(replace(one, true_lens=lens, true_board=board) for one in found)


def _check(plan: CalibrationPlan, true_rig: StereoRig | None, true_board: Board | None) -> None:
    asked = plan.asked
    if true_rig is not None:
        for side, camera, planned in (
            ("left", true_rig.left, asked.rig.left),
            ("right", true_rig.right, asked.rig.right),
        ):
            if (camera.width, camera.height) != (planned.width, planned.height):
                raise InvalidRange(
                    f"true {side} camera of {camera.width} x {camera.height} px: must be"
                    f" {planned.width} x {planned.height} as the plan's"
                )
    board = asked.board
    if true_board is not None and (true_board.cols, true_board.rows) != (board.cols, board.rows):
        raise InvalidRange(
            f"true board {true_board.text}: must have {board.cols}x{board.rows} corners as the plan's"
        )
