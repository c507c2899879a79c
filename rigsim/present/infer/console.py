"""The terminal's tables of `rigsim infer`."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from rigsim.present.infer.words import sentence, whose
from rigsim.present.kit.console import make_console, paragraph, print_table
from rigsim.present.kit.format import length, lengths_within, number, with_interval
from rigsim.study.infer.bias import BiasPart
from rigsim.study.infer.run import Inference, Transfer


def print_inference(
    inference: Inference, carried: Transfer | None = None, folder: Path | None = None
) -> None:
    """Print what was inferred, and what it does to another rig or at other distances, on standard output."""
    console = make_console()
    paragraph(console, sentence(inference))
    console.print()
    _print_inferred(inference)
    _print_distances(inference)
    if carried is not None:
        _print_carried(carried, whose(inference, carried))
    if folder is not None:
        console.print(f"Files: {folder}", soft_wrap=True)


def _print_inferred(inference: Inference) -> None:
    sigma, low, high = inference.disparity_std_px, inference.low_px, inference.high_px
    why = {
        "samples": "95 % interval from the counts n",
        "fit": "95 % interval from the scatter between distances",
        "none": "no interval: too few distances, and no counts",
    }[inference.interval_from]
    shown, between = _interval(sigma, (low, high))
    rows = [
        ("disparity std", shown, "px", between, why),
        ("noise", number(sigma / math.sqrt(2)), "px", "", "per pixel coordinate, as --noise takes it"),
    ]
    if inference.fit is not None:
        for law, misfit in inference.fit.misfit.items():
            rows.append((f"{law} law", number(100 * misfit, 2), "%", "", "misfit"))
    if inference.bias is not None:
        rows += _bias_rows(inference.bias)
    print_table("Inferred", ("quantity", "value", "unit", "interval", "meaning"), rows)


def _bias_rows(bias: BiasPart) -> list[tuple[str, str, str, str, str]]:
    shown, between = _interval(bias.disparity_offset_px, bias.offset_interval_px)
    rows = [("disparity offset", shown, "px", between, "bias part: yaw, principal point")]
    if not math.isnan(bias.scale):
        low, high = bias.scale_interval
        shown, between = _interval(100 * bias.scale, (100 * low, 100 * high))
        rows.append(("scale error", shown, "%", between, "bias part: baseline, focal length"))
    rows.append(("bias left over", number(bias.left_rms_m * 1e3), "mm", "", "RMS that neither explains"))
    rows.append(("bias share", number(100 * bias.share), "%", "", "of the mean squared error"))
    return rows


def _print_distances(inference: Inference) -> None:
    errors, sigma = inference.errors, inference.disparity_std_px
    print_table(
        "By distance",
        ("distance", "depth std", "explained", "disparity std px"),
        [
            (length(depth), length(std), length(sigma * gain), number(std / gain))
            for depth, std, gain in zip(errors.depths_m, errors.stds_m, inference.gains_m_per_px, strict=True)
        ],
        numeric=(True, True, True, True),
    )


def _print_carried(carried: Transfer, whose_rig: str) -> None:
    lens = carried.rig.left
    numbers = zip(
        carried.depths_m, carried.stds_m, carried.lows_m, carried.highs_m, carried.trusted, strict=True
    )
    shown = 3 if np.isfinite(carried.lows_m).any() else 1  # no columns of an interval that nobody knows
    print_table(
        f"Same noise, {whose_rig}: baseline {length(carried.rig.baseline_m)}, focal {number(lens.fx, 4)} px",
        ("distance", *("depth std", "from", "to")[:shown], "note"),
        [
            (
                length(depth),
                *lengths_within(std, low, high)[:shown],
                "" if trusted else "disparity under 4 sigma",
            )
            for depth, std, low, high, trusted in numbers
        ],
        numeric=(True, *[True] * shown, False),
    )


def _interval(value: float, ends: tuple[float, float]) -> tuple[str, str]:
    """A value, and the interval around it; no more digits than that leaves."""
    shown, low, high = with_interval(value, *ends)
    return shown, "" if math.isnan(ends[0]) else f"{low} to {high}"
