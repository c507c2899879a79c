"""Whether prediction and simulation agree: one family of tests, with one false alarm rate for a whole row.

`rigsim.study.agreement.whitened` has the tests. They are run on all points together, on each depth bin,
and on nine regions and five columns of the left image; points under 4 sigma of depth are in none.
Bonferroni over all of them holds the false alarms of a row at `FALSE_ALARMS`. Where every trial has another
calibration, which all of its points share, points are not independent, but the trials of each are: one point
of each part is tested then.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.study.agreement.agreement import AGREES, Agreement, AgreementPlace, Reason, finite, worst
from rigsim.study.agreement.whitened import WhitenedFinding, examine, point_by_point, whitened
from rigsim.study.scene.statistics import ErrorStatistics
from rigsim.study.scene.trials import Prediction

FALSE_ALARMS = 1e-4
"""Probability that a row of a correct rig is flagged, over all its tests together."""

FEW = 50
"""Triangulations below which even a scatter 1.5 times too large would pass: 5 / sqrt(2 n) = 0.5."""

_FAILED = (3, 1e-3)  # more failures than this, in number and share, are no accident at 4 sigma
_EXACT_PX = 1e-6  # what arithmetic may cost where there is no noise


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Some of the visible points."""

    place: AgreementPlace | None
    """Where they are; None for everywhere."""
    inside: Mask
    """Which they are, (N,)."""


def image_parts(uv_left: Array, width_px: int, height_px: int) -> list[Part]:
    """A grid of three by three regions of the left image, and five columns."""
    across = np.clip((uv_left[:, 0] + 0.5) / width_px, 0, 1 - 1e-9)
    down = np.clip((uv_left[:, 1] + 0.5) / height_px, 0, 1 - 1e-9)
    ninths = [
        Part(AgreementPlace("region", (j, i)), (np.floor(3 * across) == i) & (np.floor(3 * down) == j))
        for j in range(3)
        for i in range(3)
    ]
    return ninths + [Part(AgreementPlace("column", (i,)), np.floor(5 * across) == i) for i in range(5)]


def compare(
    prediction: Prediction, stats: ErrorStatistics, bins: Sequence[Part], regions: Sequence[Part]
) -> tuple[Agreement, list[Agreement]]:
    """The agreement of the whole row, and that of each depth bin; a flagged bin or region flags the row.

    Args:
        prediction: of the visible points.
        stats: their simulated errors.
        bins: depth bins.
        regions: parts of the image.
    """
    whole = Part(None, np.ones(len(stats.count), dtype=bool))
    if prediction.shares_calibration:
        if prediction.method != "optimal":
            return _untold("calibration"), [_untold("calibration") for _ in bins]
        if 1 < stats.n_trials < FEW:
            few = Agreement("untold", "simulated", "too-few-trials", count=(stats.n_trials, FEW))
            return few, [few for _ in bins]
        # points of one trial share its calibration: of each part one point, whose trials are independent
        whole, *rest = [_one(part, prediction) for part in (whole, *bins, *regions)]
        bins, regions = rest[: len(bins)], rest[len(bins) :]
    ahead = [_beforehand(prediction, stats, part.inside) for part in (whole, *bins)]
    if ahead[0] is not None and ahead[0].kind == "untold":
        return ahead[0], [own or ahead[0] for own in ahead[1:]]
    kept = ~prediction.low_disparity
    sums = whitened(prediction, stats, kept)
    parts = [whole, *bins, *regions]
    findings = [
        tuple(examine(sums, part.inside[kept])) if sums.count[part.inside[kept]].any() else ()
        for part in parts
    ]
    if stats.n_trials > 1 and findings[0] and not prediction.shares_calibration:
        findings[0] += (point_by_point(sums),)
    limit = FALSE_ALARMS / max(sum(map(len, findings)), 1)
    n_bins = len(bins)
    told = [
        own or _judge(found, limit) for own, found in zip(ahead[1:], findings[1 : n_bins + 1], strict=True)
    ]
    everywhere = [_judge(found, limit, part.place) for found, part in zip(findings, parts, strict=True)]
    failed = [own for own in ahead if own is not None and own.kind == "flagged"]
    return worst([*failed, *everywhere]), told


def _one(part: Part, prediction: Prediction) -> Part:
    """The point of a part that is in the middle of those to be tested, by its depth over the standard
    deviation of that; the part itself where none is."""
    places = np.flatnonzero(part.inside & ~prediction.low_disparity)
    if not len(places):
        return part
    middle = places[np.argsort(prediction.depth_sigmas[places], kind="stable")[len(places) // 2]]
    inside = np.zeros_like(part.inside)
    inside[middle] = True
    return Part(part.place, inside)


def _beforehand(prediction: Prediction, stats: ErrorStatistics, inside: Mask) -> Agreement | None:
    """What is known of some points before any test; None when they can be tested."""
    kept = inside & ~prediction.low_disparity
    tried, n = int(kept.sum()) * stats.n_trials, int(stats.count[kept].sum())
    failed = tried - n
    if not inside.any():
        return _untold("nothing-shared")
    if not kept.any():
        return _untold("too-far")
    if n == 0:
        return Agreement("flagged", "simulated", "all-failed", "failures")
    if failed > _FAILED[0] and failed > _FAILED[1] * tried:
        return Agreement("flagged", "simulated", "some-failed", "failures", failed / tried)
    if np.isinf(prediction.depth_sigmas[kept]).all():
        return _without_noise(math.sqrt(float(stats.sum_nees[kept].sum()) / n / 3))
    if not np.isfinite(prediction.whitening[:, kept]).all():
        return _untold("correlated")
    if n < FEW:
        return Agreement("untold", "simulated", "too-few-trials", count=(n, FEW))
    return None


def _without_noise(error_px: float) -> Agreement:
    """Exact pixels must give exact points; of noise they tell nothing."""
    if error_px <= _EXACT_PX:
        return _untold("exact")
    return Agreement("flagged", "simulated", "not-exact", "position", size_px=finite(error_px))


def _untold(reason: Reason) -> Agreement:
    return Agreement("untold", "simulated", reason)


def _judge(
    findings: Sequence[WhitenedFinding], limit: float, place: AgreementPlace | None = None
) -> Agreement:
    """Flagged by the first test whose p-value is below `limit`; one that is no number is flagged too."""
    for finding in findings:
        if not finding.p >= limit:
            return Agreement(
                "flagged",
                "simulated",
                "spread" if finding.quantity.endswith("spread") else "mean",
                finding.quantity,
                finite(finding.ratio),
                sigmas=finite(finding.sigmas),
                place=place,
            )
    return AGREES
