"""A planned calibration in a terminal."""

from __future__ import annotations

import math
import shlex
from collections.abc import Sequence
from pathlib import Path

from rigsim.present.calibrate.drift_words import (
    DRIFT_SAYS,
    DRIFT_TITLE,
    drift_heads,
    drift_numeric,
    drift_rows,
)
from rigsim.present.calibrate.plan_words import (
    curve_shown,
    frame_sentence,
    has_frame,
    headline,
    inseparable_sentence,
    next_sentence,
    sentences,
)
from rigsim.present.calibrate.witness_words import (
    WITNESS_HEADS,
    WITNESS_NUMERIC,
    WITNESS_TITLE,
    true_sentence,
    witness_rows,
    witness_sentences,
)
from rigsim.present.calibrate.words import parameter_head
from rigsim.present.kit.console import make_console, paragraph, print_table
from rigsim.present.kit.format import number, plain
from rigsim.study.calibrate.drift import drift
from rigsim.study.calibrate.estimated import estimates
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.witness.result import CalibrationWitness

DEPTH_HEADS = ("distance\nm", "where", "calib-\nration", "pixel\nnoise", "both")
FRAME_HEAD = "calibration, from\nthe left camera"
CURVE_HEADS = ("pictures", "calibration", "at random", "with pixel noise", "")
_PLACES = {"axis": "axis", "edge": "edge", "corner": "corner"}


def print_plan(
    plan: CalibrationPlan,
    witnesses: Sequence[CalibrationWitness] = (),
    command: str = "",
    folder: Path | None = None,
) -> None:
    """Print the answer, the depth at each distance, the number of pictures, and what to do next."""
    console = make_console()
    paragraph(console, headline(plan))
    true = true_sentence(plan, witnesses)
    for sentence in (*([true] if true else []), *sentences(plan)):
        paragraph(console, sentence)
    console.print()
    heads = depth_heads(plan)
    print_table(
        "Depth std, mm: from calibration, from pixel noise, and from both",
        heads,
        depth_rows(plan),
        numeric=(True, False, *[True] * (len(heads) - 2)),
    )
    print_table(
        f"Depth std at {plain(plan.asked.chosen_for_m)} m on the axis, mm, by number of pictures",
        CURVE_HEADS,
        curve_rows(plan),
        numeric=(*[True] * 4, False),
    )
    if witnesses:
        print_table(
            WITNESS_TITLE, WITNESS_HEADS, witness_rows(witnesses), numeric=WITNESS_NUMERIC, console=console
        )
        for sentence in witness_sentences(witnesses, plan):
            paragraph(console, sentence)
        console.print()
    for sentence in (frame_sentence(plan), inseparable_sentence(plan), next_sentence(plan)):
        if sentence:
            paragraph(console, sentence)
    console.print()
    paragraph(console, DRIFT_SAYS)
    found = drift(plan.asked.rig, plan.asked.at_m)
    print_table(DRIFT_TITLE, drift_heads(found), drift_rows(found), numeric=drift_numeric(found))
    _print_next(plan, command, folder)


def _print_next(plan: CalibrationPlan, command: str, folder: Path | None) -> None:
    console = make_console()
    board = plan.asked.board.text
    if folder is None:
        again = f"{command} --out plan" if command else "--out plan"
        paragraph(console, f"Next: print the sheet for the bench: {again} writes plan/plan.html.")
        return
    page = shlex.quote(str(folder / "plan.html"))
    pictures = f"rigsim calibrate pictures LEFT... RIGHT... --board {board}"
    console.print(f"Files: {folder}", soft_wrap=True)
    paragraph(
        console,
        f"Next: print {page} and take the pictures; `{pictures}` makes a calibration of them and says what"
        " it leaves.",
    )


def depth_heads(plan: CalibrationPlan) -> tuple[str, ...]:
    """Heads of the depth table; a newline starts a second line."""
    return (*DEPTH_HEADS, *([FRAME_HEAD] if has_frame(plan) else []))


def depth_rows(plan: CalibrationPlan) -> list[tuple[str, ...]]:
    """Rows of the depth table, mm."""
    framed = has_frame(plan)
    rows = []
    before = math.nan
    for row in plan.depths:
        values = [row.calibration_m, row.observation_m, row.joint_m, *([row.in_camera_m] if framed else [])]
        head = "" if row.z_m == before else plain(row.z_m)
        rows.append((head, _PLACES[row.place], *(number(value * 1e3) for value in values)))
        before = row.z_m
    return rows


def curve_rows(plan: CalibrationPlan) -> list[tuple[str, ...]]:
    """Rows of the short table of the curve, mm."""
    return [
        (
            str(point.pictures),
            *(_open(value) for value in (point.calibration_m, point.random_m, point.joint_m)),
            _mark(plan, point.pictures),
        )
        for point in (plan.curve[k] for k in curve_shown(plan))
    ]


def _open(value_m: float) -> str:
    return number(value_m * 1e3) if math.isfinite(value_m) else "open"


def _mark(plan: CalibrationPlan, pictures: int) -> str:
    marks = []
    if plan.asked.goal is not None and pictures == plan.needed.count:
        marks.append(f"enough for {plain(plan.asked.goal.error_m * 1e3)} mm")
    if pictures == len(plan.poses):
        marks.append("this plan")
    return ", ".join(marks)


def parameter_rows(plan: CalibrationPlan) -> Sequence[tuple[str, ...]]:
    """Rows of the table of parameters: name, value, std, unit."""
    return [
        (parameter_head(one.name), plain(one.value, 6), number(one.std, 2), one.unit)
        for one in estimates(plan)
    ]
