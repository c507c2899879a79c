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
_WIDE = 100
"""Cells from which on a line a little too long reads better than more wrapped columns."""
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

    Where the terminal is narrow the last column of words is wrapped, and where that is not enough the others
    from the right, words before numbers; only between words.

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
    _narrow(widths, heads, texts, numeric, console.width)

    if title:
        say(console, title, "bold")
    depth = max((len(head) for head in heads), default=0)
    for i in range(depth):
        # heads stand on the line below them
        cells = [head[i - depth + len(head)] if i >= depth - len(head) else "" for head in heads]
        say(console, _line(cells, widths, numeric), "bold")
    say(console, ("─" if console.is_terminal else "-") * min(total_width(widths), console.width), "dim")
    for row in texts:
        # words are not broken, and what stands beside them stays in line; a column may be empty, head and all
        parts = [
            textwrap.wrap(text, max(width, 1), break_long_words=False, break_on_hyphens=False)
            if cell_len(text) > width
            else [text]
            for text, width in zip(row, widths, strict=True)
        ]
        for k in range(max(map(len, parts), default=0)):
            say(console, _line([part[k] if k < len(part) else "" for part in parts], widths, numeric))
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


def _narrow(
    widths: list[int],
    heads: Sequence[Sequence[str]],
    texts: Sequence[Sequence[str]],
    numeric: Sequence[bool],
    room: int,
) -> None:
    """Make columns narrower until a line fits into `room` cells, or no cell can be wrapped any more."""
    by_turn = sorted(range(len(widths)), key=lambda i: (numeric[i], -i))
    for turn, i in enumerate(by_turn):
        excess = total_width(widths) - room
        if excess <= 0 or (turn and room >= _WIDE):
            return
        longest = max((cell_len(word) for row in texts for word in row[i].split()), default=0)
        head = max((cell_len(part) for part in heads[i]), default=0)
        # the last words may be narrower than their head
        least = min(_NARROWEST, widths[i]) if turn == 0 and not numeric[i] else head
        widths[i] = max(widths[i] - excess, least, longest)


def _line(cells: Sequence[str], widths: Sequence[int], numeric: Sequence[bool]) -> str:
    parts = []
    for cell, width, right in zip(cells, widths, numeric, strict=True):
        room = " " * max(width - cell_len(cell), 0)
        parts.append(room + cell if right else cell + room)
    return (" " * _GAP).join(parts).rstrip()
