"""The other witnesses of a planned calibration: whole calibrations beside the prediction."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rigsim.present.kit.format import fixed, length, number, plain, ratio, with_interval
from rigsim.rig.lens.registry import BY_NAME
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.witness.judge import MEASURED, SIMULATED
from rigsim.study.calibrate.witness.result import CalibrationWitness, WitnessedDepth
from rigsim.study.calibrate.witness.truth import true_depth

WITNESS_TITLE = "Depth std from calibration, on the axis, mm: predicted for the corners met, and found"
WITNESS_HEADS = (
    "witness",
    "distance\nm",
    "predicted",
    "found",
    "found over\npredicted",
    "95 %",
    "mean\nerror",
)
WITNESS_NUMERIC = (False, True, True, True, True, True, True)
_ODD_MISFIT = 1.1


def witness_rows(witnesses: Sequence[CalibrationWitness]) -> list[tuple[str, ...]]:
    """One row a witness and distance, mm."""
    return [
        (one.name if place == 0 else "", *_cells(row))
        for one in witnesses
        for place, row in enumerate(one.depths)
    ]


def _cells(row: WitnessedDepth) -> tuple[str, ...]:
    found, low, high = with_interval(row.ratio, *row.interval)
    lengths = (number(value * 1e3) for value in (row.predicted_m, row.std_m))
    return (plain(row.z_m), *lengths, found, f"{low} to {high}", number(row.mean_m * 1e3, 2))


def witness_sentences(
    witnesses: Sequence[CalibrationWitness], plan: CalibrationPlan | None = None
) -> list[str]:
    """What each comes to, and what its user would have seen; of the plan's distance where there is one."""
    return [
        " ".join(part for part in (_verdict(one), _spread(one), _residual(one), _bias(one, plan)) if part)
        for one in witnesses
    ]


def true_sentence(plan: CalibrationPlan, witnesses: Sequence[CalibrationWitness]) -> str:
    """Whether the goal is met with the lens and the board that are in the pictures, what is off on average
    counted; empty where they are the plan's."""
    found = true_depth(plan, witnesses)
    if found is None:
        return ""
    one, goal, at = found.witness, plan.asked.goal, plain(found.row.z_m)
    what = {"simulated": "simulated calibrations", "measured": "calibrations of rendered pictures"}[one.name]
    but = ""
    if goal is not None:
        verb = "meets" if found.met else "misses"
        but = f"this plan {verb} {plain(goal.error_m * 1e3)} mm: "
    too = "large" if found.row.mean_m > 0 else "small"
    said = (
        f"{_truth(one)}{but}in {one.calibrations} {what} depths at {at} m are"
        f" {length(abs(found.row.mean_m))} too {too} on average, and with spread and pixel noise"
        f" {length(found.rms_m)} off (root mean square)."
    )
    said = said[:1].upper() + said[1:]
    if found.met or not abs(found.row.mean_m) > found.row.std_m:
        return said
    return f"{said} More pictures do not help; {_remedy(one, plan)}."


def _truth(one: CalibrationWitness) -> str:
    lens = f"lens ({one.true_lens})" if one.true_lens else ""
    true = " and the true ".join(part for part in (lens, "board" if one.true_board else "") if part)
    return f"with the true {true} " if true else ""


def _remedy(one: CalibrationWitness, plan: CalibrationPlan | None) -> str:
    """What takes away a mean error."""
    parts = []
    if one.true_lens:
        models = set() if plan is None else {lens.model for lens in plan.asked.parameters.lenses if lens}
        known = one.true_lens in BY_NAME and one.true_lens not in models
        parts.append(
            f"plan with the true lens (`--model {one.true_lens}`)" if known else "free its coefficients"
        )
    if one.true_board:
        warped = plan is not None and plan.asked.parameters.warped
        parts.append("take a better board" if warped else "let the calibration find its warp (`--warp`)")
    return ", and ".join(parts) or "another lens model or a flatter board does"


def agreement_words(agreement: Agreement) -> str:
    """Why a witness does not agree; empty where it does."""
    if agreement.kind == "agrees":
        return ""
    over = fixed(math.nan if agreement.ratio is None else agreement.ratio, 2)
    few = agreement.count or (0, 0)
    what = {
        "depth spread": "depths scatter",
        "parameter spread": "all parameters together scatter",
        "residuals": "residuals are",
    }.get(agreement.quantity, agreement.quantity)
    said = {
        "all-failed": "none of them found a rig",
        "some-failed": "too many of them found no rig",
        "spread": f"{what} {over} times what is predicted",
        "mean": "depths are off on average, which the prediction knows nothing of",
        "too-few-trials": f"{few[0]} of them are too few to tell, {few[1]} at least",
        "unclear": f"depths scatter {over} times as predicted, but so few do not tell it from agreement",
    }
    return agreement.cause or said.get(agreement.reason, agreement.reason)


def _verdict(one: CalibrationWitness) -> str:
    how = {
        "simulated": "calibrations of corners with noise",
        "measured": "calibrations of rendered pictures",
    }[one.name]
    by = " by OpenCV" if one.by_opencv else ""
    boards = f", {one.boards} places of the board each" if one.boards else ""
    unfound = f", in {one.unfound} pictures of which no board was found" if one.unfound else ""
    failed = f"; {one.failed} found no rig" if one.failed else ""
    why = agreement_words(one.agreement)
    verdict = one.agreement.kind + (f": {why}" if why else _excused(one))
    return f"{one.name.capitalize()}, {one.calibrations} {how}{by}{boards}{unfound}{failed}: {verdict}."


def _excused(one: CalibrationWitness) -> str:
    """What the verdict allows, where it is needed: where an interval does not hold 1."""
    intervals = [row.interval for row in one.depths]
    if math.isfinite(one.parameter_ratio):
        intervals.append(one.parameter_interval)
    if all(low <= 1 <= high for low, high in intervals):
        return ""
    slack = {"simulated": SIMULATED, "measured": MEASURED}[one.name]
    return f", within the {plain(100 * slack.spread)} % of scatter that such calibrations may differ by"


def _spread(one: CalibrationWitness) -> str:
    if not math.isfinite(one.parameter_ratio):
        return ""
    found, low, high = with_interval(one.parameter_ratio, *one.parameter_interval)
    return f"All parameters together scatter {found} times as predicted ({low} to {high})."


def _residual(one: CalibrationWitness) -> str:
    noise, residual = plain(one.corner_noise_px, 3), plain(one.rms_px, 3)
    if not math.isfinite(one.misfit):
        return f"Corners were {noise} px off; the residual was {residual} px."
    said = (
        f"Corners were {noise} px off; the residual, {residual} px, is {ratio(one.misfit)} times what that"
        " noise leaves"
    )
    if one.misfit > _ODD_MISFIT:
        return f"{said}: lens or board are not what the calibration takes them for."
    return f"{said}."


def _bias(one: CalibrationWitness, plan: CalibrationPlan | None) -> str:
    """Where depths are off on average by more than they scatter."""
    off = [row for row in one.depths if abs(row.mean_m) > row.std_m]
    if not off:
        return ""
    asked = [row for row in off if plan is not None and math.isclose(row.z_m, plan.asked.chosen_for_m)]
    worst = max(asked or off, key=lambda row: abs(row.mean_m) / row.std_m if row.std_m > 0 else math.inf)
    return (
        f"At {plain(worst.z_m)} m depths are {length(abs(worst.mean_m))} too"
        f" {'large' if worst.mean_m > 0 else 'small'} on average: more pictures do not help there;"
        f" {_remedy(one, plan)}."
    )
