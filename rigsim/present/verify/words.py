"""What was checked, as a person says it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rigsim.present.kit.mistakes.said import says as says
from rigsim.present.kit.sayings import spoken
from rigsim.present.verify.sentences import ABOUT, WHY
from rigsim.study.verify.case import Case
from rigsim.study.verify.geometries import Geometry
from rigsim.study.verify.result import CaseResult, Check, Diagnosis, TriangulatorResult

MEANS = {
    "answered": "rows with a point that came back as none, or behind a camera",
    "nowhere": "points where there are none",
    "exact": "worst distance to the true point",
    "size": "pixel error over what the noise must cause",
    "depth": "depth error over what the noise must cause",
    "unbiased": "mean error, in standard deviations of one",
    "efficient": "pixel error over what the noise must cause",
    "shape": "shape of the answer",
}
"""What each check's number is, in a few words."""

_UNITS_M = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"), (1e-12, "pm"))


def number(value: float) -> str:
    """Three significant digits; a power of ten only where there would be many zeros."""
    if not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    if 1e-3 <= abs(value) < 99_950:
        return f"{value:.0f}" if abs(value) >= 99.95 else f"{value:#.3g}"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def length(length_m: float) -> str:
    """A length in the unit that suits it, from pm to m."""
    if not math.isfinite(length_m):
        return "–"
    if length_m == 0:
        return "0 m"
    for factor, unit in _UNITS_M:
        if abs(length_m) >= 0.9995 * factor:
            return f"{number(length_m / factor)} {unit}"
    return "< 1 pm"


def amount(value: float, unit: str) -> str:
    """A check's number with its unit."""
    if unit == "m":
        return length(value)
    if not math.isfinite(value):
        return "–"
    if unit == "rows":
        return f"{value:.0f} {'row' if value == 1 else 'rows'}"
    return f"{number(value)} {unit}".rstrip()


def found(check: Check, of: int = 0) -> str:
    """What was found; with the number of rows in the case, how many of them."""
    text = amount(check.value, check.unit)
    match check.name:
        case "answered" | "nowhere":
            text = f"{check.value:.0f} of {of} rows" if of else text
            return f"{_point(check)} in {text}"
        case "exact":
            return f"{text} off"
        case "size" | "depth" | "efficient":
            return f"{text} × expected"
        case _:
            return text


def _point(check: Check) -> str:
    """What came back of rows without an answer, or where none was to come back."""
    if check.name == "nowhere":
        return "a point"
    if not check.n_behind:
        return "no point"
    return "point behind" if check.n_behind == check.value else "none or behind"


def allowed(check: Check) -> str:
    """What passes."""
    if check.low == check.high:
        return amount(check.high, check.unit)
    if check.low == 0:
        return f"at most {amount(check.high, check.unit)}"
    return f"{number(check.low)} to {amount(check.high, check.unit)}"


def sentence(check: Check) -> str:
    """What is wrong, on one line: ``exact: 35.0 mm off, allowed at most 1.00 nm``."""
    return f"{check.name}: {found(check)}, allowed {allowed(check)}"


def about(what: Case | Geometry) -> str:
    """What a case or a geometry shows, in a sentence or two that stand alone."""
    return spoken(what.about, ABOUT)


def why(check: Check) -> str:
    """Where the bounds of a check come from, and what its value means."""
    return spoken(check.why, WHY)


def reason(result: CaseResult, strict: bool) -> str:
    """Why a case failed, one line."""
    return result.error or "; ".join(sentence(check) for check in result.failures(strict))


def verdict(result: TriangulatorResult, strict: bool) -> str:
    """How many cases passed, one sentence: ``optimal: all 49 cases passed``."""
    status = [case.status(strict) for case in result.results]
    n = sum(one != "not applicable" for one in status)
    bad = sum(one in ("failed", "error") for one in status)
    slow = status.count("inefficient")
    skipped = len(status) - n
    said = f"{result.triangulator}: "
    if n == 0:
        said += "no case is meant for it"
    elif bad:
        said += f"{bad} of {n} cases failed" if n > 1 else "the case failed"
    else:
        said += f"all {n} cases passed" if n > 1 else "the case passed"
    if slow:
        said += (
            f"; {slow} {'more have' if bad else 'of them have'} larger errors than least squares would leave"
        )
    if skipped and n:
        said += f"; {skipped} are not meant for it"
    return said


def diagnosis(found: Diagnosis) -> str:
    """A diagnosis in one paragraph."""
    n = len(found.cases)
    return (
        f"{found.mistake}: {says(found).rstrip('.')}. That explains {100 * found.explained:.0f} % of the "
        f"error in {n} failing case{'s' if n != 1 else ''}."
    )


def diagnoses(found: Sequence[Diagnosis]) -> list[str]:
    """All of them, best first; one that explains no case more than those before it is less likely."""
    said: list[str] = []
    explained: set[str] = set()
    for one in found:
        label = "Less likely" if said and explained.issuperset(one.cases) else "Diagnosis"
        said.append(f"{label}: {diagnosis(one)}")
        explained.update(one.cases)
    return said
