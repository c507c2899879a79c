"""What many pairs of pixels come to: a sentence, and the first of them as a table."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rigsim.present.kit.console import make_console, paragraph, print_table
from rigsim.present.kit.format import count, fixed, length, number, percent
from rigsim.study.calc.points import FALSE_ALARM, PairPoints

_FIRST = 10
_HEADS = (
    "u left\npx",
    "v left\npx",
    "u right\npx",
    "v right\npx",
    "X\nmm",
    "Y\nmm",
    "Z\nmm",
    "std of Z\nmm",
    "off\npx",
    "consistent",
)


def pairs_sentence(found: PairPoints) -> str:
    """The answer in two sentences: the points and their depths, and the pairs that do not belong together."""
    n, known = len(found.uv), found.why == ""
    off, is_off = found.n_inconsistent, "is" if found.n_inconsistent == 1 else "are"
    judged = (
        f"{_many(off, 'pair').capitalize()} ({_share(off / n)}) {is_off} further off than the noise "
        f"explains; by chance {_share(FALSE_ALARM)} of right pairs would be."
    )
    if not known.any():
        return f"{_many(n, 'pair')} of pixels, no point. {judged}"
    z, std = found.points[known, 2], length(float(np.median(found.stds[known, 2])))
    near, far = length(z.min()), length(z.max())
    where = f"at {near}" if near == far else f"from {near} to {far}"
    return (
        f"{_many(n, 'pair')} of pixels, {_many(int(known.sum()), 'point')} {where}; the median std of their "
        f"depth is {std}, for {found.noise.std_px:g} px of noise per coordinate. {judged}"
    )


def print_points(found: PairPoints, *, markdown: bool = False, file: Path | None = None) -> None:
    """Print the summary and the first pairs, for people or as Markdown; `file` is where all were written."""
    rows = [_row(found, place) for place in range(min(_FIRST, len(found.uv)))]
    left = len(found.uv) - len(rows)
    more = (
        f"The first {len(rows)} of {count(len(found.uv))}; --csv prints all, --out FILE writes them."
        if left
        else ""
    )
    console = make_console()
    if markdown:
        heads = [head.replace("\n", ", ") for head in _HEADS]
        lines = [pairs_sentence(found), "", f"| {' | '.join(heads)} |", "|" + "---:|" * 9 + "---|"]
        lines += [f"| {' | '.join(row)} |" for row in rows]
        print("\n".join([*lines, *(["", more] if more else [])]))
        return
    paragraph(console, pairs_sentence(found))
    console.print()
    print_table("Points, in the left camera's frame", _HEADS, rows, numeric=(*[True] * 9, False))
    if more and file is None:
        paragraph(console, more)
    if file is not None:
        console.print(f"File: {file}", soft_wrap=True)


def _row(found: PairPoints, place: int) -> tuple[str, ...]:
    x, y, z = found.points[place] * 1e3
    std = found.stds[place, 2] * 1e3
    decimals = 3 if not std > 0 else int(np.clip(2 - np.floor(np.log10(std)), 0, 4))
    why = f"no point: {found.why[place]}" if found.why[place] else ""
    judged = "yes" if found.consistent[place] else "no"
    return (
        *(fixed(pixel, 2) for pixel in found.uv[place]),
        *(fixed(value, decimals) for value in (x, y, z)),
        number(std),
        fixed(found.off_px[place], 2),
        f"{judged}; {why}" if why else judged,
    )


def _share(share: float) -> str:
    return f"{percent(share)} %"


def _many(number_of: int, what: str) -> str:
    return f"{count(number_of) if number_of else 'no'} {what}{'' if number_of == 1 else 's'}"
