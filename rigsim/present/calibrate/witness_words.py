"""The other witnesses of a planned calibration: whole calibrations beside the prediction."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.present.kit.agreement import text
from rigsim.present.kit.format import length, number, plain, with_interval
from rigsim.study.calibrate.witness.result import CalibrationWitness, WitnessedDepth

WITNESS_TITLE = "Depth std from calibration, mm: as predicted, and of whole calibrations"
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


def witness_rows(witnesses: Sequence[CalibrationWitness]) -> list[tuple[str, ...]]:
    """One row a witness and distance, mm."""
    return [
        (one.name if place == 0 else "", *_cells(row))
        for one in witnesses
        for place, row in enumerate(one.depths)
    ]


def _cells(row: WitnessedDepth) -> tuple[str, ...]:
    ratio, low, high = with_interval(row.ratio, *row.interval)
    lengths = (number(value * 1e3) for value in (row.predicted_m, row.std_m))
    return (plain(row.z_m), *lengths, ratio, f"{low} to {high}", number(row.mean_m * 1e3, 2))


def witness_sentences(witnesses: Sequence[CalibrationWitness]) -> list[str]:
    """What each comes to, and what its user would have seen."""
    return [_witness_sentence(one) for one in witnesses]


def _witness_sentence(one: CalibrationWitness) -> str:
    made = {
        "simulated": "calibrations with noise on every corner",
        "measured": "calibrations of rendered pictures by OpenCV",
    }[one.name]
    failed = f", {one.failed} of which found no rig" if one.failed else ""
    over = one.rms_px / one.corner_noise_px if one.corner_noise_px > 0 else float("nan")
    biased = [row for row in one.depths if abs(row.mean_m) > row.std_m]
    said = (
        f"{one.name.capitalize()}: {text(one.agreement)}, over {one.calibrations} {made}{failed}. Corners are"
        f" {plain(one.corner_noise_px, 3)} px off, and their user sees a residual of {plain(one.rms_px, 3)}"
        f" px, {plain(over, 3)} times that."
    )
    if biased:
        worst = max(biased, key=lambda row: abs(row.mean_m) / row.std_m)
        said += (
            f" At {plain(worst.z_m)} m depths are {length(abs(worst.mean_m))} too"
            f" {'large' if worst.mean_m > 0 else 'small'} on average, more than they scatter: a lens model or"
            " a board that is not the true one, which no residual within the noise rules out."
        )
    return said
