"""The answer in words: which configuration is best, what limits it, and whether the witnesses agree."""

from __future__ import annotations

import math

import pandas as pd

from rigsim.study.agreement.agreement import kind_of, reason_of
from rigsim.study.scene.columns import AXES
from rigsim.study.sweep.choice import choice, trend
from rigsim.study.sweep.comparison import WELL_COVERED, compare, row_of_bins
from rigsim.study.sweep.growth import growth_words
from rigsim.study.sweep.phrases import describe, mm, percent
from rigsim.study.sweep.result import Verdict
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS

_LOW_DISPARITY = 0.05
_FAILED = 0.01
_BIASED = 0.3


def swept_axes(rows: pd.DataFrame, order: tuple[str, ...]) -> tuple[str, ...]:
    """Axes that take more than one value, without those that merely follow another.

    Args:
        rows: sweep table.
        order: the axes that were asked for, which are preferred to those that follow them.
    """
    varied = [axis for axis in (*order, *(a for a in AXES if a not in order)) if rows[axis].nunique() > 1]
    swept: list[str] = []
    for axis in varied:
        followers = rows.groupby(swept, sort=False)[axis].nunique().max() if swept else 2
        if followers > 1:
            swept.append(axis)
    return tuple(sorted(swept, key=AXES.index))


def limits(rows: pd.DataFrame) -> tuple[str, ...]:
    """What limits each row, in a word or two."""
    coverage = rows["visible_fraction"].max()
    words = []
    for row in rows.itertuples():
        if not row.depth_rmse_mm >= 0:
            words.append("no result")
        elif row.failed_fraction > _FAILED:
            words.append("failed points")
        elif row.visible_fraction < WELL_COVERED * coverage:
            words.append("overlap")
        elif row.low_disparity_fraction > _LOW_DISPARITY:
            words.append("low disparity")
        elif abs(row.depth_bias_mm) > _BIASED * row.depth_rmse_mm:
            words.append("bias")
        else:
            words.append("pixel noise")
    return tuple(words)


def judge(
    rows: pd.DataFrame,
    by_depth: pd.DataFrame,
    swept: tuple[str, ...],
    order: tuple[int, ...],
    lens_note: str,
    complete: bool,
    far_limit: str = "",
) -> Verdict:
    """Put the sweep into sentences.

    Args:
        rows: `SweepResult.rows`.
        by_depth: `SweepResult.by_depth`.
        swept: the axes that were varied.
        order: places of the rows, best first.
        lens_note: what stayed and what changed between resolutions.
        complete: whether every rig was done.
        far_limit: what was left out for being too far, as `far_limit_words` says it.
    """
    best = order[0]
    row = rows.loc[best]
    bins = _bins(best, rows, by_depth)
    sentences = [
        *_far_end(bins),
        *_averages(row),
        *choice(rows, compare(rows, by_depth), swept, order),
        *trend(rows, by_depth, swept, best),
        *_measured(row),
        *_agreement(rows),
        *_coverage(rows, swept),
        *_low_disparity(row),
    ]
    if far_limit:
        sentences.append(far_limit)
    if lens_note:
        sentences.append(lens_note)
    if not complete:
        sentences.insert(0, "The run was interrupted: only the rigs done until then are shown.")
    flagged = rows["agreement"].map(kind_of) == "flagged"
    return Verdict(_headline(row, bins), tuple(sentences), not bool(flagged.any()))


def far_limit_words(limit_m: float, beyond_fraction: float) -> str:
    """What was left out for being too far; empty when nothing was."""
    if not (math.isfinite(limit_m) and beyond_fraction > 0):
        return ""
    return (
        f"Surfaces beyond {limit_m:.3g} m, up to {percent(beyond_fraction)} of a left image, are left out: "
        "there no rig of this sweep has a depth of 4 of its standard deviations (--range sets other limits)."
    )


def _headline(row: pd.Series, bins: pd.DataFrame) -> str:
    middle = bins[bins["depth_far_mm"] >= row["depth_median_mm"]].iloc[0]
    ending = {
        "agrees": "and in agreement",
        "flagged": f"and {row['agreement']}",
        # what is untold of the pictures leaves the simulation as it is
        "untold": "and in agreement"
        if row["agreement_witness"] == "measured"
        else "with too little to tell whether they agree",
    }[kind_of(row["agreement"])]
    return (
        f"At {_depths(middle)}, {row['baseline_mm']:.4g} mm of baseline gives "
        f"{mm(middle['depth_rmse_mm'])} RMS depth error; "
        f"predicted {mm(middle['predicted_depth_rmse_mm'])}; "
        f"simulated on {row['n_visible']:.0f} points of `{row['scene']}`, {ending}."
    )


def _far_end(bins: pd.DataFrame) -> list[str]:
    if len(bins) < 2:
        return []
    last = bins.iloc[-1]
    growth = growth_words(bins)
    return [
        f"At the far end, {_depths(last)}, the same rig gives {mm(last['depth_rmse_mm'])} RMS "
        f"(predicted {mm(last['predicted_depth_rmse_mm'])})" + (f": {growth}." if growth else ".")
    ]


def _averages(row: pd.Series) -> list[str]:
    """Both averages over what the row answers: they differ where near things fill the image."""
    pixels, balanced = row["depth_rmse_image_mm"], row["depth_rmse_mm"]
    if not pixels > 0:
        return []
    return [
        f"Over everything that it answers, its depth error is {mm(pixels)} RMS per pixel of the left image, "
        f"and {mm(balanced)} over points balanced over depth, where far ones count as much as near ones."
    ]


def _bins(place: int, rows: pd.DataFrame, by_depth: pd.DataFrame) -> pd.DataFrame:
    """The depth bins of one row that hold a result, near to far."""
    return by_depth[(row_of_bins(rows, by_depth) == place) & by_depth["depth_rmse_mm"].notna()]


def _depths(row: pd.Series) -> str:
    return f"{row['depth_near_mm'] / 1e3:.3g} to {row['depth_far_mm'] / 1e3:.3g} m"


def _agreement(rows: pd.DataFrame) -> list[str]:
    """How many rows agree, how many are flagged and why, and how many cannot tell and why."""
    kinds = rows["agreement"].map(kind_of)
    measured = bool((rows["measured_n"] > 0).any())
    who = "Prediction, simulation and measurement" if measured else "Prediction and simulation"
    ratio = rows["predicted_over_simulated"].dropna()
    ends = dict.fromkeys(f"{end:.3f}" for end in (ratio.min(), ratio.max())) if len(ratio) else {}
    span = f" (predicted over simulated {' to '.join(ends)})" if ends else ""
    n, n_agrees = len(rows), int((kinds == "agrees").sum())
    sentences = []
    if n_agrees == n:
        sentences.append(f"{who} agree{'' if n == 1 else f' in all {n} rows'}{span}.")
    elif n_agrees:
        sentences.append(f"{who} agree in {n_agrees} of {n} rows{span}.")
    flagged = rows[kinds == "flagged"]
    if len(flagged):
        is_ = "row is" if n == 1 else "rows is" if len(flagged) == 1 else "rows are"
        sentences.append(f"{len(flagged)} of {n} {is_} flagged: {_commonest(flagged)}.")
    return sentences + [
        f"In {len(part)} of {n} {'row' if n == 1 else 'rows'} {words}: {_commonest(part)}."
        for part, words in (
            (
                rows[(kinds == "untold") & (rows["agreement_witness"] == "measured")],
                "prediction and simulation agree, but there is not enough to tell of the measurement",
            ),
            (
                rows[(kinds == "untold") & (rows["agreement_witness"] != "measured")],
                "there is not enough to tell whether they agree",
            ),
        )
        if len(part)
    ]


def _commonest(rows: pd.DataFrame) -> str:
    """The commonest reason among rows, and whether there are others."""
    reasons = rows["agreement"].map(reason_of).value_counts()
    return str(reasons.index[0]) + (" (and others)" if len(reasons) > 1 else "")


def _measured(row: pd.Series) -> list[str]:
    """The third witness, and the noise level it stands for."""
    if not row["measured_n"] > 0:
        return []
    noise_px = row["measured_disparity_std_px"] / 2**0.5
    return [
        f"Measured in the pictures ({int(row['measured_n'])} {row['measured_method']}, sensor "
        f"`{row['sensor']}`): {mm(row['measured_depth_rmse_mm'])} RMS depth error, where the accuracy they "
        f"claim predicts {mm(row['predicted_from_measured_rmse_mm'])}; their disparity noise of "
        f"{row['measured_disparity_std_px']:.2g} px corresponds to `--noise {noise_px:.2g}`."
    ]


def _coverage(rows: pd.DataFrame, swept: tuple[str, ...]) -> list[str]:
    coverage = rows["visible_fraction"]
    poor = coverage < WELL_COVERED * coverage.max()
    if not poor.any():
        least = percent(coverage.min())
        return [f"Both cameras see {least} or more of the left image's pixels that show the scene."]
    worst = rows.loc[coverage.idxmin()]
    return [
        f"The cameras share least at {describe(worst, swept) or 'this rig'}: both see only "
        f"{percent(worst['visible_fraction'])} of the left image's pixels that show the scene, "
        f"against {percent(coverage.max())} at best; rows under {percent(WELL_COVERED)} of the best "
        "coverage are not called best."
    ]


def _low_disparity(row: pd.Series) -> list[str]:
    if not row["low_disparity_fraction"] > 0:
        return []
    share = percent(row["low_disparity_fraction"])
    return [
        f"At the best rig {share} of the pixels that both cameras see have a depth under "
        f"{LEAST_DEPTH_SIGMAS:g} of its own standard deviations; they are kept out of the RMS of depth. The "
        f"RMS error of their 1/Z is {row['far_inverse_depth_rmse_per_m']:.3g} per metre, "
        f"predicted {row['predicted_far_inverse_depth_rmse_per_m']:.3g}."
    ]
