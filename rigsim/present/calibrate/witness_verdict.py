"""Whether a witness bears a planned calibration out, in words."""

from __future__ import annotations

import math

from rigsim.present.kit.format import plain, with_interval
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.calibrate.witness.judge import BAND


def text(agreement: Agreement) -> str:
    """``agrees``, ``flagged: ...`` or ``untold: ...``."""
    return agreement.kind if agreement.kind == "agrees" else f"{agreement.kind}: {reason(agreement)}"


def reason(agreement: Agreement) -> str:
    """Why; empty when it agrees."""
    ratio = math.nan if agreement.ratio is None else agreement.ratio
    if agreement.reason == "all-failed":
        return "no calibration found a rig"
    if agreement.reason == "some-failed":
        return f"{plain(100 * ratio, 2)} % of the calibrations found no rig"
    if agreement.reason == "mean":
        sigmas = math.nan if agreement.sigmas is None else agreement.sigmas
        return f"depths are off on average, by {plain(sigmas, 3)} standard errors of that average"
    if agreement.reason == "spread" and agreement.quantity == "residuals":
        return f"residuals are {plain(ratio, 3)} times what the corners' noise alone leaves"
    if agreement.reason == "spread":
        what = "depths scatter" if agreement.quantity == "depth spread" else "the rig's numbers together scatter"
        return f"{what} {plain(ratio, 3)} times as much as predicted"
    if agreement.reason == "too-few-trials" and agreement.count is not None:
        made, least = agreement.count
        return f"{made} calibrations are too few to tell: it takes {least}"
    if agreement.reason == "unclear" and agreement.interval is not None:
        found, low, high = with_interval(ratio, *agreement.interval)
        return (
            f"depths scatter {found} times as much as predicted ({low} to {high}), not surely within"
            f" {plain(BAND[0])} to {plain(BAND[1])}: make more calibrations"
        )
    if agreement.reason == "nothing-measured":
        return f"no calibration from pictures ({agreement.cause})"
    return agreement.reason
