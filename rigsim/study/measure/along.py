"""What rows cannot tell: a picture shifted along its rows, a wrong baseline or focal length.

All of them leave every match on its row and move every depth. A true disparity tells them, or squares of a
known side: they are flagged when they measure over 0.5 % and over 4 standard errors too large or too small,
and agree when they are within 2 % with 3 standard errors on top.
"""

from __future__ import annotations

import math

import numpy as np

from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.result import BoardFit, Finding, PairMatches

_TRUTH_KEYS = {"shift", "wrong_truth"}
_ENOUGH = 30
_LEAST = 0.005
_CERTAIN = 4.0
_CLOSE = 0.02


def along_verdict(
    matches: tuple[PairMatches, ...],
    findings: list[Finding],
    rig: StereoRig,
    boards: tuple[BoardFit, ...],
    square_m: float | None,
) -> Finding:
    """Whether disparities and the scale of depths are right, as far as anything tells."""
    judged = [m for m in matches if m.errors is not None and m.errors.errors.n >= _ENOUGH]
    if judged:
        if any(finding.key in _TRUTH_KEYS for finding in findings):
            return Finding("along_rows", "truth-off")
        return Finding("along_rows", "truth-fits", "agrees")
    if square_m is not None and boards:
        return _squares(boards, rig, square_m)
    return Finding("along_rows", "open", "untold")


def _squares(boards: tuple[BoardFit, ...], rig: StereoRig, square_m: float) -> Finding:
    known = [b for b in boards if b.n > 3 and math.isfinite(b.square_m) and math.isfinite(b.distance_m)]
    if not known:
        return Finding("along_rows", "no-board", "untold")
    ratio = np.array([board.square_m / square_m - 1 for board in known])
    # neighbouring sides share corners: as many count as there are corners
    se = np.array([max(board.square_std_m / math.sqrt(board.n), 1e-12) / square_m for board in known])
    weight = 1 / se**2
    off, off_se = float((ratio * weight).sum() / weight.sum()), float(1 / math.sqrt(weight.sum()))
    numbers = {
        "found_mm": 1e3 * (1 + off) * square_m,
        "true_mm": 1e3 * square_m,
        "off_pct": 100 * off,
        "off_se_pct": 100 * off_se,
    }
    if abs(off) > max(_LEAST, _CERTAIN * off_se):
        distance_m = float((np.array([b.distance_m for b in known]) * weight).sum() / weight.sum())
        shift_px = abs(off) * rig.left.fx * rig.baseline_m / distance_m
        return Finding("scale", "squares-off", numbers={**numbers, "shift_px": shift_px})
    if abs(off) + 3 * off_se > _CLOSE:
        return Finding("along_rows", "squares-uncertain", "untold", numbers)
    return Finding("along_rows", "squares-fit", "agrees", numbers)
