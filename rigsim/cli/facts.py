"""A handful of named numbers as a table for people, Markdown, CSV or JSON."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass

import typer

from rigsim.cli.answer import print_document
from rigsim.errors import InvalidRange


@dataclass(frozen=True, slots=True)
class Fact:
    """One number of an answer."""

    key: str
    """Name for machines."""
    name: str
    """Name for people."""
    value: float
    """The number; infinite where there is no bound, NaN where there is no answer."""
    unit: str
    """Its unit; empty for a ratio."""
    meaning: str
    """What it says, in a few words."""


def print_facts(facts: Sequence[Fact], *, title: str, as_json: bool, as_csv: bool, as_markdown: bool) -> None:
    """Print `facts` on standard output.

    People get 5 significant digits, machines all of them; JSON, which knows neither infinity nor NaN,
    gets null. Lengths are in mm, which machines are told by a last field ``unit``.

    Raises:
        InvalidRange: more than one form is asked for.
    """
    if as_json + as_csv + as_markdown > 1:
        raise InvalidRange("--json, --csv and --markdown exclude each other: give one")
    if as_json:
        print_document({**{fact.key: fact.value for fact in facts}, "unit": "mm"})
    elif as_csv:
        from rigsim.interop.documents.text import DIGITS, clean

        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([*(fact.key for fact in facts), "unit"])
        writer.writerow([*(repr(clean(fact.value, DIGITS)) for fact in facts), "mm"])
        typer.echo(text.getvalue(), nl=False)
    elif as_markdown:
        typer.echo("| quantity | value | unit | meaning |\n|---|---:|---|---|")
        for fact in facts:
            typer.echo(f"| {fact.name} | {_shown(fact.value)} | {fact.unit} | {fact.meaning} |")
    else:
        from rigsim.present.console import print_table

        rows = [(fact.name, _shown(fact.value), fact.unit, fact.meaning) for fact in facts]
        numeric = (False, True, False, False)
        print_table(title, ("quantity", "value", "unit", "meaning"), rows, numeric=numeric)


def _shown(value: float) -> str:
    from rigsim.present.format import number

    return "infinite" if math.isinf(value) else number(value, 5)
