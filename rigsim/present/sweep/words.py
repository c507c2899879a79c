"""The answer in words: which configuration is best, what limits it, and whether the witnesses agree."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from rigsim.digits import short
from rigsim.present.kit import agreement
from rigsim.present.kit.agreement import fault as fault
from rigsim.present.kit.agreement import spelled as spelled
from rigsim.present.kit.format import count
from rigsim.present.sweep import requirement_words
from rigsim.present.sweep.phrases import describe, distances, mm, percent, say
from rigsim.study.agreement.agreement import kinds as kinds_of
from rigsim.study.scene import columns as col
from rigsim.study.scene.plan import DEFAULT_SCENE, Held
from rigsim.study.scene.showcase import Showcase
from rigsim.study.sweep.choice import choice, trend
from rigsim.study.sweep.comparison import WELL_COVERED, row_of_bins
from rigsim.study.sweep.growth import Growth, growth_of
from rigsim.study.sweep.requirement import take
from rigsim.study.sweep.result import SweepResult
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer in words, with numbers."""

    headline: str
    """One sentence: the answer."""
    sentences: tuple[str, ...]
    """What else must be known, a sentence each: what limits the rig, what was flagged."""
    agrees: bool
    """Whether no row was flagged."""


def verdict(result: SweepResult) -> Verdict:
    """A sweep in sentences."""
    rows, by_depth, best = result.rows, result.by_depth, result.best[0]
    row = rows.loc[best]
    bins = _bins(best, rows, by_depth)
    sentences = [
        *([] if result.complete else ["The run was interrupted: only the rigs done until then are shown."]),
        *_far_end(bins),
        *_averages(row),
        *([] if result.requirements else _choice(result)),
        *_trend(result),
        *_measured(row, result.showcase),
        *_agreement(rows),
        *_coverage(result),
        *_low_disparity(row),
        *_far_limit(result),
        *filter(None, [lens(result)]),
        *([_TWO_RIGS] if result.has_two_rigs else []),
    ]
    headline = _headline(row, bins)
    if result.requirements:
        sentences = [*requirement_words.reasons(result), headline, *sentences]
        headline = requirement_words.recommendation(result)
    return Verdict(headline, tuple(sentences), result.agrees)


def lens(result: SweepResult) -> str:
    """What stayed and what changed between resolutions; empty when there was but one."""
    return _LENS[result.lens_held]


_TWO_RIGS = (
    "Pixels and pictures are the true rig's; depths are triangulated, predicted and measured with the "
    "assumed one."
)
_LENS: dict[Held, str] = {
    "": "",
    "focal": (
        "The focal length in pixels is fixed, so more pixels widen the field of view "
        "(the same lens and pixel size on a larger sensor)."
    ),
    "lens": (
        "The lens is fixed, so more pixels lengthen the focal length in pixels and narrow what one "
        "pixel covers (smaller pixels on the same sensor)."
    ),
}


def _far_limit(result: SweepResult) -> list[str]:
    """What was left out for being too far."""
    if not math.isfinite(result.far_limit_m):
        return []
    return [
        f"Surfaces beyond {result.far_limit_m:.3g} m, up to {percent(result.beyond_fraction)} of a left "
        "image, are left out: there, the depth is under 4 of its standard deviations for every rig of this "
        "sweep (--range sets other limits)."
    ]


def _choice(result: SweepResult) -> list[str]:
    """By what the best row was chosen, and which row is as good as far as the sample can tell."""
    rows, found = result.rows, choice(result.rows, result.by_depth, result.best)
    if found is None:
        return []
    sentence = (
        f"Best of {found.n} compared at the same distances, {distances(found.spans_mm)}: "
        f"{describe(rows.loc[found.best], result.swept)}, {mm(found.best_mm)} RMS per pixel of the image"
    )
    if found.second is None:
        return [sentence + "."]
    word = "equally good within sampling error" if found.is_tie else "next"
    return [f"{sentence}; {word}: {describe(rows.loc[found.second], result.swept)}, {mm(found.second_mm)}."]


def _trend(result: SweepResult) -> list[str]:
    """How the error at the same distances moves along the first numeric axis, the others held."""
    found = trend(result.rows, result.by_depth, result.swept, result.best[0])
    if found is None:
        return []
    verb = "falls" if found.last_mm < found.first_mm else "rises"
    at = describe(result.rows.loc[result.best[0]], found.held)
    return [
        f"From {short(found.first, 4)} to {say(found.axis, found.last)}{f' (at {at})' if at else ''}, the "
        f"depth error at {distances(found.spans_mm)} {verb} from {mm(found.first_mm)} to "
        f"{mm(found.last_mm)} RMS per pixel of the image."
    ]


def growth_words(found: Growth | None) -> str:
    """How the error grows with the distance, as a clause; empty where that is not known."""
    if found is None:
        return ""
    if found.power is None:
        return (
            f"{found.times:.3g} times the error at {found.farther:.3g} times the distance "
            f"(its square would be {found.farther**2:.3g} times)"
        )
    if found.is_square:
        return "it grows with the distance squared"
    return f"it grows with the distance to the power {found.power:.2g}, not squared"


def _headline(row: pd.Series, bins: pd.DataFrame) -> str:
    middle = bins[bins[col.DEPTH_FAR] >= row[col.DEPTH_MEDIAN]].iloc[0]
    ending = {
        "agrees": "they agree",
        "flagged": f"{agreement.text(row[col.AGREEMENT])}",
        # what is untold of the pictures leaves the simulation as it is
        "untold": "they agree"
        if row[col.AGREEMENT].witness == "measured"
        else "not enough to tell whether they agree",
    }[row[col.AGREEMENT].kind]
    # a scene that nobody chose says nothing
    scene = "" if row[col.SCENE] == DEFAULT_SCENE else f" in scene `{row[col.SCENE]}`"
    return (
        f"At {_depths(middle)}, {short(row[col.BASELINE], 4)} mm of baseline gives "
        f"{mm(middle[col.DEPTH_RMSE])} RMS depth error; "
        f"predicted {mm(middle[col.PREDICTED_DEPTH_RMSE])}; "
        f"simulated on {count(row[col.N_VISIBLE])} points{scene}; {ending}."
    )


def _far_end(bins: pd.DataFrame) -> list[str]:
    if len(bins) < 2:
        return []
    last = bins.iloc[-1]
    growth = growth_words(growth_of(bins))
    return [
        f"At the far end, {_depths(last)}, the same rig gives {mm(last[col.DEPTH_RMSE])} RMS "
        f"(predicted {mm(last[col.PREDICTED_DEPTH_RMSE])})" + (f": {growth}." if growth else ".")
    ]


def _averages(row: pd.Series) -> list[str]:
    """Both averages over what the row answers: they differ where near things fill the image."""
    pixels, balanced = row[col.DEPTH_RMSE_IMAGE], row[col.DEPTH_RMSE]
    if not pixels > 0:
        return []
    return [
        f"Over all points that both cameras see, its depth error is {mm(pixels)} RMS per pixel of the left "
        f"image, and {mm(balanced)} over points balanced over depth, where far ones count as much as near "
        "ones."
    ]


def _bins(place: int, rows: pd.DataFrame, by_depth: pd.DataFrame) -> pd.DataFrame:
    """The depth bins of one row that hold a result, near to far."""
    return by_depth[(row_of_bins(rows, by_depth) == place) & by_depth[col.DEPTH_RMSE].notna()]


def _depths(row: pd.Series) -> str:
    return f"{row[col.DEPTH_NEAR] / 1e3:.3g} to {row[col.DEPTH_FAR] / 1e3:.3g} m"


def _agreement(rows: pd.DataFrame) -> list[str]:
    """How many rows agree, how many are flagged and why, and how many cannot tell and why."""
    kinds = kinds_of(rows)
    of_pictures = np.array([one.witness == "measured" for one in rows[col.AGREEMENT]], dtype=bool)
    measured = bool((rows[col.MEASURED_N] > 0).any())
    who = "Prediction, simulation and measurement" if measured else "Prediction and simulation"
    ratio = rows[col.PREDICTED_OVER_SIMULATED].dropna()
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
                rows[(kinds == "untold") & of_pictures],
                "prediction and simulation agree, but there is not enough to judge the measurement",
            ),
            (
                rows[(kinds == "untold") & ~of_pictures],
                "there is not enough to tell whether they agree",
            ),
        )
        if len(part)
    ]


def _commonest(rows: pd.DataFrame) -> str:
    """The commonest reason among rows, and whether there are others."""
    reasons = rows[col.AGREEMENT].map(agreement.reason).value_counts()
    return str(reasons.index[0]) + (" (and others)" if len(reasons) > 1 else "")


def _measured(row: pd.Series, showcase: Showcase) -> list[str]:
    """The third witness, and the noise level it stands for."""
    if not row[col.MEASURED_N] > 0:
        return []
    noise_px = row[col.MEASURED_DISPARITY_STD] / 2**0.5
    return [
        f"Measured in renderings ({int(row[col.MEASURED_N])} {row[col.MEASURED_METHOD]}{_on(showcase)}, "
        f"sensor `{row[col.SENSOR]}`): {mm(row[col.MEASURED_DEPTH_RMSE])} RMS depth error; its own error "
        f"estimate predicts {mm(row[col.PREDICTED_FROM_MEASURED_RMSE])}. The disparity noise of "
        f"{row[col.MEASURED_DISPARITY_STD]:.2g} px corresponds to `--noise {noise_px:.2g}`."
    ]


def _on(showcase: Showcase) -> str:
    """What the pictures of a wide lens were turned into before they were matched."""
    return (
        f" in a {showcase.view} view about the baseline" if showcase.view in ("cylinder", "latlong") else ""
    )


def _coverage(result: SweepResult) -> list[str]:
    rows = result.rows
    coverage = rows[col.VISIBLE_FRACTION]
    poor = coverage < WELL_COVERED * coverage.max()
    if not poor.any():
        least = percent(coverage.min())
        if least == percent(1.0):
            return ["Both cameras see all of the left image's pixels that show the scene."]
        return [f"Both cameras see {least} or more of the left image's pixels that show the scene."]
    worst = rows.loc[coverage.idxmin()]
    under = f"rows under {percent(WELL_COVERED)} of the best coverage"
    ending = f"{under} are not ranked"
    taken = take(rows, result.best, result.requirements) if result.requirements else None
    if taken is not None:
        ending = f"{under} are taken only where no other meets what is asked"
        if poor[taken]:
            ending += f", as here, with {percent(coverage[taken])}"
    return [
        f"Overlap is smallest at {describe(worst, result.swept) or 'this rig'}: both cameras see only "
        f"{percent(worst[col.VISIBLE_FRACTION])} of the left image's pixels that show the scene, "
        f"against {percent(coverage.max())} at best; {ending}."
    ]


def _low_disparity(row: pd.Series) -> list[str]:
    if not row[col.LOW_DISPARITY_FRACTION] > 0:
        return []
    share = percent(row[col.LOW_DISPARITY_FRACTION])
    return [
        f"At the best rig {share} of the pixels that both cameras see have a depth under "
        f"{LEAST_DEPTH_SIGMAS:g} of its own standard deviations; they are kept out of the RMS of depth. The "
        f"RMS error of their 1/Z is {row[col.FAR_INVERSE_DEPTH_RMSE]:.3g} per metre, "
        f"predicted {row[col.PREDICTED_FAR_INVERSE_DEPTH_RMSE]:.3g}."
    ]
