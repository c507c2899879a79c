"""An agreement in words: what the tables write, and why."""

from __future__ import annotations

import math
from collections.abc import Callable

import pandas as pd

from rigsim.present.kit.format import with_interval
from rigsim.present.kit.mistakes.faults import fault as fault
from rigsim.study.agreement.agreement import Agreement, AgreementPlace, Reason
from rigsim.study.agreement.claims import BAND
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS

_ROWS = ("upper", "middle", "lower")
_COLUMNS = ("left", "centre", "right")
_FIFTHS = ("leftmost", "second", "middle", "fourth", "rightmost")


def text(agreement: Agreement) -> str:
    """What the tables write: ``agrees``, ``flagged: ...`` or ``untold: ...``."""
    return agreement.kind if agreement.kind == "agrees" else f"{agreement.kind}: {reason(agreement)}"


def reason(agreement: Agreement) -> str:
    """Why, and what is off where that is known; empty when they agree."""
    if agreement.kind == "agrees":
        return ""
    said = _SAID[agreement.reason](agreement)
    if agreement.place is not None:
        said += f" {place(agreement.place)}"
    return said + (f"; {fault(agreement.fault)}" if agreement.fault is not None else "")


def spelled(table: pd.DataFrame) -> pd.DataFrame:
    """A table of a sweep with its agreements as words."""
    return table.assign(agreement=[text(one) for one in table["agreement"]])


def place(where: AgreementPlace) -> str:
    """Where something differs: ``at 2 to 2.5 m``."""
    if where.of == "depth":
        return "at {:.3g} to {:.3g} m".format(*where.at)
    if where.of == "column":
        return f"in the {_FIFTHS[int(where.at[0])]} fifth of the image's columns"
    row, column = (int(part) for part in where.at)
    return f"in the {_ROWS[row]} {_COLUMNS[column]} of the image"


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _percent(share: float | None) -> str:
    percent = min(_number(share) * 100, 100.0)
    return f"{percent:.0f} %" if percent >= 9.5 else f"{percent:.2g} %"


def _spread(agreement: Agreement) -> str:
    ratio = _number(agreement.ratio)
    what = "simulated error" if agreement.quantity == "depth spread" else "simulated position error"
    if not ratio < 2:  # one that is no number too
        return f"{what} {ratio:.3g} times the prediction"
    side = "above" if ratio > 1 else "below"
    return f"{what} {_percent(abs(ratio - 1))} {side} the prediction"


def _mean(agreement: Agreement) -> str:
    sigmas = _number(agreement.sigmas)
    return f"simulated {agreement.quantity} is {sigmas:.3g} standard errors from the prediction"


def _counted(agreement: Agreement) -> tuple[int, int]:
    return agreement.count or (0, 0)


def _astray(agreement: Agreement) -> str:
    n_astray, n_found = _counted(agreement)
    return f"{n_astray} of {n_found} measured points are wrong matches"


def _claim(agreement: Agreement) -> str:
    return _times(f"{_number(agreement.ratio):.2g}")


def _times(ratio: str) -> str:
    return f"measured errors are {ratio} times their own estimate"


def _unclear(agreement: Agreement) -> str:
    low, high = agreement.interval or (math.nan, math.nan)
    says, between = _claim(agreement), f"{low:.2g} to {high:.2g}"
    if math.isfinite(high - low):
        ratio, *ends = with_interval(_number(agreement.ratio), low, high)
        says, between = _times(ratio), " to ".join(ends)
    return f"{says} ({between}), not clearly within {BAND[0]:.2g} to {BAND[1]:.2g}"


_SAID: dict[Reason, Callable[[Agreement], str]] = {
    "": lambda _: "",
    "all-failed": lambda _: "every triangulation failed",
    "some-failed": lambda one: f"{_percent(one.ratio)} of the triangulations failed",
    "not-exact": lambda one: f"simulated error of {_number(one.size_px):.2g} px where none is predicted",
    "spread": _spread,
    "mean": _mean,
    "outliers": lambda one: f"{_percent(one.ratio)} of the measured points are wrong matches",
    "worse-than-claimed": _claim,
    "no-points": lambda one: one.cause,
    "triangulator-failed": lambda one: one.cause,
    "nothing-shared": lambda _: "left and right see nothing in common",
    "too-far": lambda _: f"every depth is below {LEAST_DEPTH_SIGMAS:g} of its standard deviations",
    "exact": lambda _: "without noise there is no error to compare; every point is found exactly",
    "correlated": lambda _: "with noise this correlated there is no scatter to test",
    "calibration": lambda _: (
        "what a calibration leaves is predicted for optimal alone, and this method is another"
    ),
    "too-few-trials": lambda one: f"{_counted(one)[0]} triangulations are too few",
    "nothing-measured": lambda one: (
        f"nothing was measured ({one.cause or 'no match on a surface that both cameras see'})"
    ),
    "too-few-measured": lambda one: f"{_counted(one)[0]} measured points are too few",
    "claims-nothing": lambda _: "dense matching gives no error estimate to compare its measured error with",
    "many-astray": _astray,
    "too-cautious": lambda one: f"{_claim(one)}: that estimate is too cautious to confirm",
    "unclear": _unclear,
}
