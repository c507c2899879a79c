"""Tables in a terminal: the end of a sweep, and lists of anything; plain text when nobody is watching."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

if TYPE_CHECKING:
    pass

_GAP = 2
_NARROWEST = 12
_NUMBER = re.compile(r"[-−+]?\d[\d,]*(\.\d+)?([eE][-+]?\d+)?|–")


def make_console(*, stderr: bool = False, width: int | None = None) -> Console:
    """A console that prints what it is given: no markup, no emoji, and no colour unless on a terminal."""
    return Console(stderr=stderr, width=width, emoji=False, markup=False, highlight=False)


def print_table(
    title: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[object]],
    *,
    numeric: Sequence[bool] | None = None,
    console: Console | None = None,
) -> None:
    """Print a table with a heading, and an empty line after it.

    Only the last column of words is wrapped when the terminal is narrow, and only between words.

    Args:
        title: heading; none when empty.
        columns: heads of the columns; a newline starts a second line.
        rows: values, one sequence a row, turned into text as they are.
        numeric: which columns stand right; by default those whose values are all numbers.
        console: where to; standard output by default.
    """
    console = console or make_console()
    if numeric is None:
        numeric = [bool(rows) and all(_is_number(row[i]) for row in rows) for i in range(len(columns))]
    texts = [[str(value) for value in row] for row in rows]
    heads = [column.split("\n") for column in columns]
    widths = column_widths(heads, texts)
    loose = max((i for i in range(len(columns)) if not numeric[i]), default=None)
    excess = total_width(widths) - console.width
    if loose is not None and excess > 0:
        # words are not broken, and what stands beside them stays in line
        longest = max((len(word) for row in texts for word in row[loose].split()), default=0)
        widths[loose] = max(widths[loose] - excess, min(_NARROWEST, widths[loose]), longest)

    if title:
        say(console, title, "bold")
    depth = max((len(head) for head in heads), default=0)
    for i in range(depth):
        # heads stand on the line below them
        cells = [head[i - depth + len(head)] if i >= depth - len(head) else "" for head in heads]
        say(console, _line(cells, widths, numeric), "bold")
    say(console, ("─" if console.is_terminal else "-") * min(total_width(widths), console.width), "dim")
    for row in texts:
        wrapped = list(row)
        more: list[str] = []
        if loose is not None:
            width = max(widths[loose], 1)  # a column may be empty, head and all
            parts = textwrap.wrap(row[loose], width, break_long_words=False, break_on_hyphens=False)
            wrapped[loose], more = (parts[0], parts[1:]) if parts else ("", [])
        say(console, _line(wrapped, widths, numeric))
        for part in more:
            say(console, _line([part if i == loose else "" for i in range(len(row))], widths, numeric))
    console.print()


def paragraph(console: Console, text: str, indent: str = "", *, style: str = "") -> None:
    """Print prose, wrapped between words; code marks are for pages, not for terminals."""
    lines = textwrap.wrap(
        text.replace("`", ""),
        max(console.width, 20),
        initial_indent=indent,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    for line in lines:
        say(console, line, style)


def say(console: Console, text: str, style: str = "") -> None:
    """Print one line as it is: what is too long, such as a path, is left to the terminal."""
    console.print(Text(text, style=style), soft_wrap=True)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) or bool(isinstance(value, str) and _NUMBER.fullmatch(value))


def column_widths(heads: Sequence[Sequence[str]], rows: Sequence[Sequence[str]]) -> list[int]:
    """Cells that each column needs, for its widest word."""
    return [
        max([cell_len(part) for part in head] + [cell_len(row[i]) for row in rows])
        for i, head in enumerate(heads)
    ]


def total_width(widths: Sequence[int]) -> int:
    """Cells of a line with columns of `widths`, the gaps included."""
    return sum(widths) + _GAP * max(len(widths) - 1, 0)


def _line(cells: Sequence[str], widths: Sequence[int], numeric: Sequence[bool]) -> str:
    parts = []
    for cell, width, right in zip(cells, widths, numeric, strict=True):
        room = " " * max(width - cell_len(cell), 0)
        parts.append(room + cell if right else cell + room)
    return (" " * _GAP).join(parts).rstrip()
