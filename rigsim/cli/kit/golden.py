"""``--golden``: an answer held against an earlier one, or written to be held against."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from rigsim.cli.kit.answer import typed
from rigsim.errors import InvalidRange

if TYPE_CHECKING:
    from rigsim.api.result import Result
    from rigsim.study.golden.compare import GoldenReport

MOVED = 3
"""Exit code when a golden number moved."""
GOLDEN = Path("reports/golden")
"""Where golden results are written unless something else is said."""

_OWN = ("--golden", "--golden-tolerance", "--out", "--jobs", "--renderer", "--title", "--note", "--logo")
_OWN_FLAGS = ("--update", "--force", "--json", "--csv", "--markdown", "--yes")
_SHARE = re.compile(r"\s*([0-9]*\.?[0-9]+(?:e[-+]?[0-9]+)?)\s*(%?)\s*", re.IGNORECASE)

GoldenTolerance = Annotated[
    str | None,
    typer.Option(
        metavar="SHARE", help="What any golden number may differ by in any case, of itself: 1%, 1e-6."
    ),
]


@dataclass(frozen=True, slots=True)
class GoldenWords:
    """The options of golden results, as typed."""

    golden: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE|DIR", help="Compare with golden results; a changed number makes the exit code 3."
        ),
    ] = None
    update: Annotated[
        bool, typer.Option("--update", help=f"Write golden results, to {GOLDEN} or --golden.")
    ] = False
    golden_tolerance: GoldenTolerance = None

    @property
    def path(self) -> Path | None:
        """Where golden results are; None when nobody asks."""
        return self.golden if self.golden is not None else GOLDEN if self.update else None

    def check(self, command: str) -> None:
        """Fail before the work where nothing can be compared, or not be written.

        Raises:
            InvalidRange: a tolerance that cannot be read, or without golden results.
            OutputError: there is no golden file, or it is another command's.
        """
        share(self.golden_tolerance)
        if self.path is None:
            if self.golden_tolerance is not None:
                raise InvalidRange("golden tolerance: of what? give --golden as well")
            return
        from rigsim.api.kit.golden import check

        check(self.path, command, self.update)

    def report(
        self, command: str, document: Callable[[], Mapping[str, Any]], about: Mapping[str, str] | None = None
    ) -> GoldenReport | None:
        """What came of the comparison; None when nobody asks."""
        if self.path is None:
            return None
        from rigsim.api.kit.golden import hold, record_of

        record = record_of(command, document(), {**(about or {}), "asked": " ".join(asked())})
        return hold(record, self.path, self.update, share(self.golden_tolerance))


_R = TypeVar("_R", bound="Result")


def held(result: _R, words: GoldenWords, command: str, about: Mapping[str, str] | None = None) -> _R:
    """The result with what came of the comparison."""
    if words.path is None:
        return result
    report = words.report(command, result.document, about)
    return result if report is None else result.holding(report)


def golden_document(report: GoldenReport | None) -> dict[str, Any] | None:
    """What a document says of it; None when nobody asks."""
    if report is None:
        return None
    from rigsim.interop.documents.base import golden_part

    part = golden_part(report)
    return None if part is None else part.model_dump()


def print_report(report: GoldenReport, stderr: bool) -> None:
    """Print what moved, beside an answer that programs read on standard error."""
    from rigsim.present.kit.console import make_console
    from rigsim.present.verify.golden import print_golden

    print_golden(report, console=make_console(stderr=stderr))


def leave_where_moved(report: GoldenReport | None) -> None:
    """End with exit code 3 where a golden number moved."""
    if report is not None and not report.passed:
        raise typer.Exit(MOVED)


def share(text: str | None) -> float:
    """A tolerance as a share, 0 to 1: ``1%`` or ``1e-6``; 0 without one.

    Raises:
        InvalidRange: it cannot be read, or is no share.
    """
    if text is None:
        return 0.0
    match = _SHARE.fullmatch(text)
    value = float(match[1]) / (100 if match[2] else 1) if match else -1.0
    if not 0 <= value < 1:
        raise InvalidRange(f"golden tolerance {text or 'empty'}: must be a share under 100 %, as 1% or 1e-6")
    return value


def asked() -> list[str]:
    """The options as typed, those left out that change no number."""
    kept: list[str] = []
    words = iter(typed())
    for word in words:
        name, equals, _ = word.partition("=")
        if name in _OWN:
            if not equals:
                next(words, None)
        elif name not in _OWN_FLAGS:
            kept.append(word)
    return kept
