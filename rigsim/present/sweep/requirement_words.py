"""What was asked of the rows, and which row to take, in words."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.present.kit.format import plain
from rigsim.present.sweep.phrases import describe, mm
from rigsim.present.sweep.taken_words import why_taken
from rigsim.study.design.words import rounded
from rigsim.study.scene import columns as col
from rigsim.study.sweep.requirement import (
    DepthRequirement,
    RowsHeld,
    RowVerdict,
    nearest_miss,
    take,
    verdicts,
    would_meet,
)
from rigsim.study.sweep.result import SweepResult

WORDS: dict[RowVerdict, str] = {"met": "met", "not_met": "not met", "not_shown": "not shown"}
"""How people read a verdict."""


def asked_words(asked: DepthRequirement) -> str:
    """What was asked: ``10 mm at 3 m``, ``1 % at 2 m``, ``p95 of 20 mm at 3 m``."""
    size = mm(asked.error_mm) if asked.pct is None else f"{plain(asked.pct)} %"
    return f"{'p95 of ' if asked.p95 else ''}{size} at {_metres(asked.at_mm)}"


def recommendation(result: SweepResult) -> str:
    """Which row to take, or that none is shown to do; empty where nothing was asked."""
    held = result.requirements
    if not held:
        return ""
    asked = " and ".join(asked_words(one.asked) for one in held)
    chosen = take(result.rows, result.best, held)
    if chosen is not None:
        return f"Take {_row(result, chosen)}: it meets {asked}."
    found = verdicts(held)
    if "not_shown" in found:
        return f"No rig is shown to meet {asked}."
    return f"No rig of this sweep meets {asked}."


def badge(result: SweepResult) -> tuple[str, str] | None:
    """Class and words of the badge that says whether any row keeps what was asked; None where nothing was."""
    held = result.requirements
    if not held:
        return None
    found = verdicts(held)
    if take(result.rows, result.best, held) is not None:
        return "agrees", "✓ Requirement met"
    if "not_shown" in found or "met" in found:
        return "untold", "? Requirement not shown"
    return "flagged", "✗ Requirement not met"


def reasons(result: SweepResult) -> list[str]:
    """Why, a sentence each: what the row does there, how many rows keep it, and what is not shown."""
    held = result.requirements
    if not held:
        return []
    chosen = take(result.rows, result.best, held)
    shown = chosen if chosen is not None else nearest_miss(result.best, held)
    sentences = []
    if shown is not None:
        who = "Its" if chosen is not None else f"Nearest to it comes {_row(result, shown)}: its"
        sentences.append(f"{who} depth error, simulated on points of the scene, is {_errors(held, shown)}.")
    found = verdicts(held)
    if chosen is None and shown is not None and found[shown] == "not_met":
        sentences += _would_meet(result)
    if "met" in found and len(found) > 1:
        sentences.append(_counts(found))
    why = [] if chosen is None else why_taken(result, chosen)
    return [*sentences, *why, *_not_shown(held, found)]


def _would_meet(result: SweepResult) -> list[str]:
    """What would do, as far as the closed form tells; the rig on show is the one that comes nearest."""
    show = result.showcase
    found = would_meet(show.rig, show.noise, result.requirements)
    if found is None:
        return []
    # rounded to the side that meets it
    noise = f"pixel noise of {rounded(found.noise_px, up=False):.3g} px"
    if found.baseline_m is None:
        return [
            f"By the closed form {noise} would, all else the same; it was not simulated. A baseline long "
            "enough would leave the cameras no view in common there."
        ]
    baseline = f"a baseline of {mm(rounded(1e3 * found.baseline_m, up=True))}"
    return [f"By the closed form {baseline} would, all else the same, or {noise}; neither was simulated."]


def _counts(found: Sequence[RowVerdict]) -> str:
    met, missed, open_ = (found.count(one) for one in WORDS)
    said = [f"{met} of {len(found)} rows {'meets' if met == 1 else 'meet'} it"]
    if missed:
        said.append(f"{missed} {'does' if missed == 1 else 'do'} not")
    if open_:
        said.append(f"{open_} {'is' if open_ == 1 else 'are'} not shown to")
    return f"{_listed(said)}."


def _errors(held: Sequence[RowsHeld], place: int) -> str:
    parts = []
    for one in held:
        row = one.rows[place]
        kind = "p95" if one.asked.p95 else "RMS"
        parts.append(
            f"{mm(row.error_mm)} {kind} at {_metres(one.asked.at_mm)} "
            f"({mm(row.low_mm)} to {mm(row.high_mm)} with 95 % confidence)"
        )
    return _listed(parts)


def _not_shown(held: Sequence[RowsHeld], found: Sequence[RowVerdict]) -> list[str]:
    """Why something is not shown, and the way out."""
    if "not_shown" not in found:
        return []
    empty = [one.asked for one in held if any(not row.near_mm > 0 for row in one.rows)]
    close = any(row.verdict == "not_shown" and row.near_mm > 0 for one in held for row in one.rows)
    said = []
    if empty:
        where = _listed(list(dict.fromkeys(_metres(asked.at_mm) for asked in empty)))
        said.append(
            f"Not shown: near {where} the scene has too few points that both cameras see; choose another "
            "`--scene` or `--range`."
        )
    if close:
        said.append("Not shown: the 95 % interval holds the limit; more `--points` or `--trials` would tell.")
    return said


def _row(result: SweepResult, place: int) -> str:
    """What to take, and at which noise, which is no choice; the simulation knows no sensor."""
    row = result.rows.loc[place]
    given = tuple(axis for axis in result.swept if axis == col.NOISE)
    chosen = tuple(axis for axis in result.swept if axis not in (col.NOISE, col.SENSOR))
    at = describe(row, given)
    return (describe(row, chosen) or "this rig") + (f" (at {at})" if at else "")


def _metres(at_mm: float) -> str:
    return f"{at_mm / 1e3:.4g} m"


def _listed(parts: Sequence[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
