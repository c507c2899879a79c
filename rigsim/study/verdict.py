"""The answer in words: which configuration is best, what limits it, and whether the witnesses agree."""

from __future__ import annotations

import pandas as pd

from rigsim.study.agreement import kind_of, reason_of
from rigsim.study.result import AXES, Verdict
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS

WELL_COVERED = 0.8
"""A configuration must keep this share of the best coverage to be called best."""

_LOW_DISPARITY = 0.05
_FAILED = 0.01
_BIASED = 0.3

_AXIS_WORDS = {
    "baseline_mm": ("baseline", "mm"),
    "focal_px": ("focal length", "px"),
    "hfov_deg": ("field of view", "°"),
    "width_px": ("image width", "px"),
    "height_px": ("image height", "px"),
    "vergence_deg": ("vergence", "°"),
    "noise_px": ("noise", "px"),
    "triangulator": ("triangulator", ""),
    "sensor": ("sensor", ""),
}


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


def rank(rows: pd.DataFrame) -> tuple[int, ...]:
    """Places of the rows, best first: smallest depth error among those that cover enough and are not flagged.

    Noise is a circumstance, not a choice: only rows of the middle noise level compete.
    """
    noises = sorted(rows["noise_px"].unique())
    compete = rows[(rows["noise_px"] == noises[(len(noises) - 1) // 2]) & rows["depth_rmse_mm"].notna()]
    enough = compete["visible_fraction"] >= WELL_COVERED * compete["visible_fraction"].max()
    agrees = compete["agreement"].map(kind_of) != "flagged"
    order = (
        compete.assign(poor=~enough, doubtful=~agrees)
        .sort_values(["doubtful", "poor", "depth_rmse_mm"], kind="stable")
        .index
    )
    return tuple(int(i) for i in order)


def judge(
    rows: pd.DataFrame,
    by_depth: pd.DataFrame,
    swept: tuple[str, ...],
    best: int,
    lens_note: str,
    complete: bool,
) -> Verdict:
    """Put the sweep into sentences."""
    row = rows.loc[best]
    sentences = [
        *_far_end(row, by_depth),
        *_trend(rows, swept, best),
        *_measured(row),
        *_agreement(rows),
        *_coverage(rows, swept),
        *_low_disparity(row),
    ]
    if lens_note:
        sentences.append(lens_note)
    if not complete:
        sentences.insert(0, "The run was interrupted: only the rigs done until then are shown.")
    flagged = rows["agreement"].map(kind_of) == "flagged"
    return Verdict(_headline(row, by_depth), tuple(sentences), not bool(flagged.any()))


def describe(row: pd.Series, axes: tuple[str, ...]) -> str:
    """The row's values on some axes, as a person would say them."""
    return ", ".join(_say(axis, row[axis]) for axis in axes)


def _headline(row: pd.Series, by_depth: pd.DataFrame) -> str:
    bins = _bins(row, by_depth)
    middle = bins[bins["depth_far_mm"] >= row["depth_median_mm"]].iloc[0]
    n = round(row["n_points"] * row["visible_fraction"])
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
        f"{_mm(middle['depth_rmse_mm'])} RMS depth error; "
        f"predicted {_mm(middle['predicted_depth_rmse_mm'])}; "
        f"simulated on {n} points of `{row['scene']}`, {ending}."
    )


def _far_end(row: pd.Series, by_depth: pd.DataFrame) -> list[str]:
    bins = _bins(row, by_depth)
    if len(bins) < 2:
        return []
    last = bins.iloc[-1]
    return [
        f"At the far end, {_depths(last)}, the same rig gives {_mm(last['depth_rmse_mm'])} RMS "
        f"(predicted {_mm(last['predicted_depth_rmse_mm'])}): it grows with the distance squared."
    ]


def _bins(row: pd.Series, by_depth: pd.DataFrame) -> pd.DataFrame:
    """The depth bins of one row that hold a result, near to far."""
    key = ["scene", *AXES]
    return by_depth[(by_depth[key] == row[key]).all(axis=1) & by_depth["depth_rmse_mm"].notna()]


def _depths(row: pd.Series) -> str:
    return f"{row['depth_near_mm'] / 1e3:.3g} to {row['depth_far_mm'] / 1e3:.3g} m"


def _trend(rows: pd.DataFrame, swept: tuple[str, ...], best: int) -> list[str]:
    """How the error moves along the first numeric axis, the others held at the best row's values."""
    numeric = [axis for axis in swept if _AXIS_WORDS[axis][1]]
    if not numeric:
        return []
    axis = numeric[0]
    others = [other for other in swept if other != axis]
    line = rows[(rows[others] == rows.loc[best, others]).all(axis=1)] if others else rows
    line = line[line["depth_rmse_mm"].notna()].sort_values(axis, kind="stable")
    if len(line) < 2:
        return []
    first, last = line.iloc[0], line.iloc[-1]
    verb = "falls" if last["depth_rmse_mm"] < first["depth_rmse_mm"] else "rises"
    held = f" (at {describe(rows.loc[best], tuple(others))})" if others else ""
    return [
        f"From {first[axis]:.4g} to {_say(axis, last[axis])}{held}, the depth error over the whole "
        f"scene {verb} from {_mm(first['depth_rmse_mm'])} to {_mm(last['depth_rmse_mm'])} RMS."
    ]


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
        f"`{row['sensor']}`): {_mm(row['measured_depth_rmse_mm'])} RMS depth error, where the accuracy they "
        f"claim predicts {_mm(row['predicted_from_measured_rmse_mm'])}; their disparity noise of "
        f"{row['measured_disparity_std_px']:.2g} px corresponds to `--noise {noise_px:.2g}`."
    ]


def _coverage(rows: pd.DataFrame, swept: tuple[str, ...]) -> list[str]:
    coverage = rows["visible_fraction"]
    poor = coverage < WELL_COVERED * coverage.max()
    if not poor.any():
        return [f"Both cameras see {_percent(coverage.min())} or more of the points that the left one sees."]
    worst = rows.loc[coverage.idxmin()]
    return [
        f"The cameras share least at {describe(worst, swept) or 'this rig'}: both see only "
        f"{_percent(worst['visible_fraction'])} of what the left one sees, "
        f"against {_percent(coverage.max())} at best; rows under {_percent(WELL_COVERED)} of the best "
        "coverage are not called best."
    ]


def _low_disparity(row: pd.Series) -> list[str]:
    if not row["low_disparity_fraction"] > 0:
        return []
    return [
        f"At the best rig {_percent(row['low_disparity_fraction'])} of the points have a depth under "
        f"{LEAST_DEPTH_SIGMAS:g} of its own standard deviations; they are kept out of the RMS of depth. The "
        f"RMS error of their 1/Z is {row['far_inverse_depth_rmse_per_m']:.3g} per metre, "
        f"predicted {row['predicted_far_inverse_depth_rmse_per_m']:.3g}."
    ]


def _say(axis: str, value: object) -> str:
    words, unit = _AXIS_WORDS[axis]
    if not unit:
        return f"`{value}`"
    space = "" if unit == "°" else " "
    return f"{value:.4g}{space}{unit} of {words}"


def _mm(value: float) -> str:
    """Millimetres with three digits; metres from 1 m on."""
    if abs(value) >= 1000:
        return f"{value / 1000:.3g} m"
    return f"{value:.3g} mm"


def _percent(fraction: float) -> str:
    """Whole percent; one digit more where that would hide something."""
    percent = fraction * 100
    return f"{percent:.0f} %" if percent >= 1 or percent == 0 else f"{percent:.1g} %"
