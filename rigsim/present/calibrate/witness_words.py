"""The other witnesses of a planned calibration: whole calibrations beside the prediction."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rigsim.present.kit.format import fixed, length, number, plain, ratio, with_interval
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.calibrate.witness.result import CalibrationWitness, WitnessedDepth

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


def witness_sentences(witnesses: Sequence[CalibrationWitness]) -> list[str]:
    """What each comes to, and what its user would have seen."""
    return [
        " ".join(part for part in (_verdict(one), _spread(one), _residual(one), _bias(one)) if part)
        for one in witnesses
    ]


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
    verdict = one.agreement.kind + (f": {why}" if why else "")
    return f"{one.name.capitalize()}, {one.calibrations} {how}{by}{boards}{unfound}{failed}: {verdict}."


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


def _bias(one: CalibrationWitness) -> str:
    """Where depths are off on average by more than they scatter."""
    off = [row for row in one.depths if abs(row.mean_m) > row.std_m]
    if not off:
        return ""
    worst = max(off, key=lambda row: abs(row.mean_m) / row.std_m if row.std_m > 0 else math.inf)
    return (
        f"At {plain(worst.z_m)} m depths are {length(abs(worst.mean_m))} too"
        f" {'large' if worst.mean_m > 0 else 'small'} on average: more pictures do not help there, another"
        " lens model or a flatter board does."
    )
