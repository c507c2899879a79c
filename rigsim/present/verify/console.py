"""A verification in a terminal: a line a group when all is well, else what failed and how to run it again."""

from __future__ import annotations

import math
import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rigsim.present.kit.console import make_console, paragraph, print_table, say
from rigsim.present.kit.format import ratio
from rigsim.present.verify import words
from rigsim.study.verify.case import Case
from rigsim.study.verify.result import CaseResult, Check, TriangulatorResult, VerifyResult

if TYPE_CHECKING:
    from rich.console import Console

GROUP_HEADS = (
    "group",
    "cases",
    "worst\nwithout noise",
    "error over\nits bound",
    "depth RMS",
    "expected\nof the noise",
    "verdict",
)
"""Columns of `group_rows`."""
FAILURE_HEADS = ("case", "check", "found", "allowed", "also fails")
"""Columns of `failure_rows`."""

_MOST_FAILURES = 24
_MOST_NAMES = 3
_RANDOM = re.compile(r"random \d+$")


def print_verify(
    result: VerifyResult,
    strict: bool = False,
    again: Mapping[str, Sequence[str]] | None = None,
    folder: Path | None = None,
    *,
    console: Console | None = None,
) -> None:
    """Print what became of every triangulator.

    Args:
        result: the verification.
        strict: whether efficiency counts.
        again: the words that run one triangulator again, without its cases; nothing is said when None.
        folder: where the report is; nothing is said about it when None.
        console: where to; standard output by default.
    """
    console = console or make_console()
    for one in result.triangulators:
        _print_one(one, strict, (again or {}).get(one.triangulator, ()), console)
    for sentence in result.left_out:
        paragraph(console, f"Left out: {sentence}.")
    if result.left_out:
        console.print()
    if len(result.triangulators) > 1:
        good = sum(one.passed(strict) for one in result.triangulators)
        say(console, f"{good} of {len(result.triangulators)} triangulators passed.", "bold")
    if folder is not None:
        say(console, f"Report: {folder / 'verify.html'}", "bold")


def print_cases(cases: Iterable[Case], *, console: Console | None = None) -> None:
    """Print which cases there are: a line for those that share a rig, the random rigs as one."""
    cases = list(cases)
    lines: dict[str, list[Case]] = {}
    for case in cases:
        shares = case.name.startswith(f"{case.group} ")
        lines.setdefault(_RANDOM.sub("random*", case.group) if shares else case.name, []).append(case)
    rows = []
    for name, alike in lines.items():
        group = alike[0].group
        kinds = dict.fromkeys(case.name.removeprefix(f"{case.group} ") for case in alike)
        sizes = dict.fromkeys(str(len(case)) for case in alike)
        named = name == alike[0].name
        rows.append((group if named else name, ", ".join(kinds), ", ".join(sizes), words.about(alike[0])))
    print_table(
        f'{len(cases)} cases; --cases takes a group, a case as "verged exact", and * for any text',
        ("group", "cases", "rows", "what it shows"),
        rows,
        numeric=(False, False, True, False),
        console=console,
    )


def group_rows(result: TriangulatorResult, strict: bool) -> list[tuple[str, ...]]:
    """One line a group: cases, what was worst in them, and the verdict; random rigs are one group."""
    return [
        (
            name,
            str(len(cases)),
            words.length(_most(_exact(case) for case in cases)),
            efficiency(case.efficiency for case in cases),
            *_depths(cases),
            _verdict(cases, strict),
        )
        for name, cases in _groups(result).items()
    ]


def failure_rows(results: Iterable[CaseResult], strict: bool) -> list[tuple[str, ...]]:
    """One line a failing case: its first failing check, and the names of the others."""
    rows: list[tuple[str, ...]] = []
    for result in results:
        first, *others = result.failures(strict)
        rows.append(
            (
                result.case.name,
                first.name,
                words.found(first, rows_asked(result, first)),
                words.allowed(first),
                ", ".join(check.name for check in others),
            )
        )
    return rows


def efficiency(values: Iterable[float]) -> str:
    """The largest of some ratios, three decimals while it is anywhere near 1."""
    most = _most(values)
    return words.number(most) if most >= 10 else ratio(most)


def rows_asked(result: CaseResult, check: Check) -> int:
    """How many rows a check speaks of: those with an answer, or those without."""
    asked = int(result.case.answerable.sum())
    return len(result.case) - asked if check.name == "nowhere" else asked


def rerun(result: TriangulatorResult, strict: bool, words_before: Sequence[str]) -> str:
    """The command that runs just what failed: that takes the place of `--cases`, unless it is all of it."""
    bad = [case.case for case in result.results if case.status(strict) in ("failed", "error")]
    names = list(dict.fromkeys(case.name for case in bad))
    groups = list(dict.fromkeys(case.group for case in bad))
    all_groups = {case.case.group for case in result.results}
    if set(groups) == all_groups and len(groups) > _MOST_NAMES:
        return shlex.join(words_before)
    chosen = names if len(names) <= _MOST_NAMES else _starred(groups)
    plain = list(words_before)
    if "--cases" in plain:
        at = plain.index("--cases")
        del plain[at : at + 2]
    return shlex.join([*plain, "--cases", ",".join(chosen)])


def _print_one(one: TriangulatorResult, strict: bool, again: Sequence[str], console: Console) -> None:
    bad = [case for case in one.results if case.status(strict) in ("failed", "error")]
    title = words.verdict(one, strict)
    paragraph(console, title + ".", style="bold")
    if not bad:
        console.print()
        print_table(
            "",
            GROUP_HEADS,
            group_rows(one, strict),
            numeric=(False, True, True, True, True, True, False),
            console=console,
        )
        _print_notes(one, console)
        return
    _print_errors(bad, console)
    failed = [case for case in bad if not case.error]
    if failed:
        shown = failed if len(failed) <= _MOST_FAILURES else first_of_groups(failed)
        if len(failed) > len(shown):
            say(console, "The first of each group:")
        console.print()
        rows = failure_rows(shown, strict)
        print_table("", FAILURE_HEADS, rows, numeric=(False, False, True, True, False), console=console)
    good = [name for name, cases in _groups(one).items() if not any(case in bad for case in cases)]
    if good:
        paragraph(console, f"Passed: {', '.join(good)}.")
    _print_notes(one, console)
    for sentence in words.diagnoses(one.diagnoses):
        paragraph(console, sentence, style="bold" if sentence.startswith("Diagnosis") else "")
    if again:
        say(console, f"Again: {rerun(one, strict, again)}")
    console.print()


def _print_errors(bad: Sequence[CaseResult], console: Console) -> None:
    """Each message once, with the cases it came from."""
    by_message: dict[tuple[str, str], list[str]] = {}
    for case in bad:
        if case.error:
            by_message.setdefault(_kind(case), []).append(case.case.name)
    first = {_kind(case): case.error for case in reversed(bad) if case.error}
    for key, names in by_message.items():
        where = ", ".join(names[:_MOST_NAMES])
        where += f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
        paragraph(console, f"Error in {where}: {first[key]}", "  ")


def _kind(case: CaseResult) -> tuple[str, str]:
    """What errors must share to be printed once; sizes and row numbers differ from case to case."""
    if case.reason == "wrong-shape":
        return case.reason, f"{len(case.shape)} axes"
    return case.reason or "", re.sub(r"\d+", "#", case.error)


def _print_notes(one: TriangulatorResult, console: Console) -> None:
    notes: dict[str, int] = {}
    for case in one.results:
        for note in case.notes:
            notes[note] = notes.get(note, 0) + 1
    for note, n in list(notes.items())[:_MOST_NAMES]:
        paragraph(console, f"Note: {note}" + (f" (in {n} cases)" if n > 1 else ""))
    if len(notes) > _MOST_NAMES:
        say(console, f"and {len(notes) - _MOST_NAMES} more notes.")
    if notes:
        console.print()


def first_of_groups(results: Iterable[CaseResult]) -> list[CaseResult]:
    """The first case of each group; random rigs are one group."""
    first: dict[str, CaseResult] = {}
    for result in results:
        first.setdefault(_group(result), result)
    return list(first.values())


def _group(result: CaseResult) -> str:
    return _RANDOM.sub("random", result.case.group)


def _groups(result: TriangulatorResult) -> dict[str, list[CaseResult]]:
    groups: dict[str, list[CaseResult]] = {}
    for case in result.results:
        if case.status() != "not applicable":
            groups.setdefault(_group(case), []).append(case)
    return groups


def _starred(groups: Sequence[str]) -> list[str]:
    """The groups, and one pattern in place of all random rigs."""
    return list(dict.fromkeys(_RANDOM.sub("random*", name) for name in groups))


def _exact(result: CaseResult) -> float:
    return next((check.value for check in result.checks if check.name == "exact"), math.nan)


def _most(values: Iterable[float]) -> float:
    return max((value for value in values if math.isfinite(value)), default=math.nan)


def _depths(cases: Sequence[CaseResult]) -> tuple[str, str]:
    """Depth RMS and its prediction in the case that is worst beside its prediction."""
    held = [case for case in cases if case.predicted_depth_rms_m > 0 and math.isfinite(case.depth_rms_m)]
    if not held:
        return words.length(math.nan), words.length(math.nan)
    worst = max(held, key=lambda case: case.depth_rms_m / case.predicted_depth_rms_m)
    return words.length(worst.depth_rms_m), words.length(worst.predicted_depth_rms_m)


def _verdict(cases: Sequence[CaseResult], strict: bool) -> str:
    statuses = {case.status(strict) for case in cases}
    for status in ("error", "failed", "inefficient"):
        if status in statuses:
            return status
    return "passed"
