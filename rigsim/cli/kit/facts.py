"""A handful of named numbers as a table for people, Markdown, CSV or JSON."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import typer

from rigsim.api.calc.fact import Fact
from rigsim.cli.kit.answer import print_document
from rigsim.cli.kit.golden import GoldenWords, golden_document, leave_where_moved, print_report
from rigsim.errors import InvalidRange


@dataclass(frozen=True, slots=True)
class Form:
    """How the answer is to be printed: for people unless one of the three is asked for."""

    json: bool
    csv: bool
    markdown: bool

    def __post_init__(self) -> None:
        if self.json + self.csv + self.markdown > 1:
            raise InvalidRange("--json, --csv and --markdown exclude each other: give one")


def print_facts(
    facts: Sequence[Fact],
    *,
    title: str,
    form: Form,
    document: Callable[[], Mapping[str, Any]],
    rows: Sequence[Sequence[Fact]] | None = None,
    golden: GoldenWords | None = None,
    show: Callable[[], None] | None = None,
) -> None:
    """Print `facts` on standard output.

    People get 5 significant digits, or as many as the error leaves; machines all of them; JSON, which knows
    neither infinity nor NaN, gets null. Lengths are in mm, which machines are told by a last field ``unit``.

    Args:
        facts: what is told.
        title: heading of the table; up to a colon it is the command's name.
        form: for whom.
        document: makes what JSON holds.
        rows: facts of CSV, a sequence a line; one line of `facts` by default.
        golden: golden results to compare with, as typed; the first word of the title says of which command.
        show: what prints for people and Markdown instead of the facts' own table.

    Raises:
        typer.Exit: a golden number moved.
    """
    report = None if golden is None else golden.report(f"calc {title.partition(':')[0].lower()}", document)
    if form.json:
        print_document({**document(), "golden": golden_document(report)})
    else:
        if form.csv:
            typer.echo(_csv(rows or [facts]), nl=False)
        elif show is not None:
            show()
        else:
            show_facts(facts, title, form)
        if report is not None:
            print_report(report, stderr=form.csv or form.markdown)
    leave_where_moved(report)


def show_facts(facts: Sequence[Fact], title: str, form: Form, says: str = "") -> None:
    """Print `facts` for people or as Markdown, under the answer in a sentence where there is one."""
    if form.markdown:
        if says:
            typer.echo(f"{says}\n")
        typer.echo("| quantity | value | unit | meaning |\n|---|---:|---|---|")
        for fact in facts:
            typer.echo(f"| {fact.name} | {fact.shown} | {fact.unit} | {fact.meaning} |")
        return
    from rigsim.present.kit.console import make_console, paragraph, print_table

    if says:
        console = make_console()
        paragraph(console, says)
        console.print()
    shown = [(fact.name, fact.shown, fact.unit, fact.meaning) for fact in facts]
    print_table(title, ("quantity", "value", "unit", "meaning"), shown, numeric=(False, True, False, False))


def _csv(rows: Sequence[Sequence[Fact]]) -> str:
    from rigsim.interop.documents.text import DIGITS, clean

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*(fact.key for fact in rows[0]), "unit"])
    for row in rows:
        cells = (
            fact.value if isinstance(fact.value, str) else repr(clean(fact.value, DIGITS)) for fact in row
        )
        writer.writerow([*cells, "mm"])
    return text.getvalue()
