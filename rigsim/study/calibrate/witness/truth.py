"""What a plan comes to where lens or board are not what it takes them for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rigsim.study.calibrate.enough import chosen_depth
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.witness.result import CalibrationWitness, WitnessedDepth


@dataclass(frozen=True, slots=True)
class TrueDepth:
    """The depth error at the distance that was asked for, what is off on average included."""

    witness: CalibrationWitness
    """Who found it."""
    row: WitnessedDepth
    """What it found there."""
    rms_m: float
    """Root mean square of the mean error, the calibrations' spread and the noise of a match, m."""
    met: bool | None
    """Whether that meets the goal; None where there is none."""


def true_depth(plan: CalibrationPlan, witnesses: Sequence[CalibrationWitness]) -> TrueDepth | None:
    """What the witnesses found at the plan's distance: the worst of those that met another lens or board, or
    were flagged as off on average; None where none did."""
    goal, noise_m = plan.asked.goal, chosen_depth(plan).observation_m
    found = []
    for one in witnesses:
        row = next((row for row in one.depths if math.isclose(row.z_m, plan.asked.chosen_for_m)), None)
        if row is None or not (math.isfinite(row.mean_m) and math.isfinite(row.std_m)):
            continue
        if one.true_lens or one.true_board or _biased(one, row):
            rms_m = math.sqrt(row.mean_m**2 + row.std_m**2 + noise_m**2)
            found.append(TrueDepth(one, row, rms_m, None if goal is None else rms_m <= goal.error_m))
    return max(found, key=lambda each: each.rms_m, default=None)


def _biased(one: CalibrationWitness, row: WitnessedDepth) -> bool:
    off = one.agreement.reason == "mean" or abs(row.mean_m) > row.std_m
    return one.agreement.kind == "flagged" and off
