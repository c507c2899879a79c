"""Golden numbers and words, then and now: one comparison for every command."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import NormalDist
from typing import Literal, TypeAlias, get_args

from rigsim.study.golden.drawn import DrawnAnew, drawn_anew

GoldenVerdict: TypeAlias = Literal["same", "within tolerance", "within noise", "moved", "new", "gone"]
VERDICTS: tuple[GoldenVerdict, ...] = get_args(GoldenVerdict)
"""What may have become of a golden number."""

GoldenValue: TypeAlias = float | str
"""A golden number, NaN for nothing there; or a word."""

ROUNDING = 1e-6
"""What a statistic of the very same noise may differ by, relative."""
NOISE_SIGMAS = 3.0
"""A statistic has not moved while it is off by no more than this many standard errors of the difference."""
FALSE_ALARM = 0.01
"""Probability, about, that other noise alone moves any of the statistics of a record: of n of them each gets
its n-th part, and so a few more standard errors than `NOISE_SIGMAS`."""
MADE_BY = ("rigsim", "mujoco", "numpy", "scipy", "renderer")
"""What of a record's head says which software made it, not what was asked."""
COMMAND = "command"
"""The key of a record's head that says whose numbers it holds."""
TABLE = "table"
"""In place of a command: a table of somebody's own, of which nobody knows what made its noise."""
ASKED = "asked"
"""The key of a record's head that holds the options as typed: for people, not compared."""
COLOUR = "grey"
"""Unit of rendered colours, which are not compared where nothing draws."""

_DIGITS = 10


@dataclass(frozen=True, slots=True)
class Number:
    """One golden number or word, and what it may differ by."""

    name: str
    """Unique within its record, as ``depth (106, 89)``."""
    value: GoldenValue
    """The number, NaN for nothing there; or the word."""
    unit: str
    """Unit; empty for ratios and words."""
    allowed: float = 0.0
    """What it may differ by without being a statistic."""
    standard_error: float = 0.0
    """Its standard error when it is one."""
    drawn_only: bool = False
    """Whether noise excuses it only where other points were drawn, not where other versions drew the same."""


@dataclass(frozen=True, slots=True)
class Record:
    """The golden numbers of one scene, one triangulator or one command."""

    name: str
    """As ``scene-boards`` or ``sweep``: the file's name without its ending."""
    about: Mapping[str, str]
    """What made it: version of rigsim and mujoco, seed, and more where it matters."""
    numbers: tuple[Number, ...]
    """The numbers."""


@dataclass(frozen=True, slots=True)
class Move:
    """One golden number, then and now."""

    record: str
    """The record's name."""
    number: str
    """The number's name."""
    unit: str
    """Unit."""
    before: GoldenValue
    """Golden value; NaN when it is new."""
    now: GoldenValue
    """Value now; NaN when it is gone."""
    bound: float
    """What it may differ by."""
    verdict: GoldenVerdict
    """Whether that matters."""


@dataclass(frozen=True, slots=True)
class GoldenComparison:
    """All golden numbers, then and now."""

    moves: tuple[Move, ...]
    """One for each number of either side."""
    remarks: tuple[str, ...] = field(default=())
    """Differences in what made the two, a sentence each."""

    def count(self, verdict: GoldenVerdict) -> int:
        """How many numbers have a verdict."""
        return sum(move.verdict == verdict for move in self.moves)

    @property
    def passed(self) -> bool:
        """Whether nothing moved or is gone."""
        return not (self.count("moved") or self.count("gone"))


@dataclass(frozen=True, slots=True)
class GoldenReport:
    """How things stand with golden results."""

    folder: str
    """Their folder or file."""
    comparison: GoldenComparison
    """All numbers, then and now."""
    troubles: tuple[str, ...] = ()
    """Files that could not be read, a line each."""
    written: tuple[str, ...] = ()
    """Files that were written anew; what moved is then no failure."""

    @property
    def passed(self) -> bool:
        """Whether nothing moved, or it was meant to."""
        return bool(self.written) or (self.comparison.passed and not self.troubles)


def compare(
    golden: Sequence[Record], now: Sequence[Record], partial: bool = False, looser: float = 0.0
) -> GoldenComparison:
    """Hold records against golden ones of the same names; golden ones that were not made again are skipped.

    Colours are left out where nothing drew them now.

    Args:
        golden: what was written once.
        now: what was made again.
        partial: whether only some cases were run, so that a missing number is not a lost one.
        looser: what every number may differ by in any case, relative to its golden value.
    """
    before = {record.name: record for record in golden}
    moves: list[Move] = []
    remarks: list[str] = []
    for record in now:
        old = before.get(record.name)
        if old is None:
            moves.extend(
                Move(record.name, n.name, n.unit, math.nan, n.value, math.nan, "new") for n in record.numbers
            )
            continue
        for key in sorted({*old.about, *record.about} - {ASKED}):
            then, today = old.about.get(key, "nothing"), record.about.get(key, "nothing")
            if then != today:
                remarks.append(f"{record.name}: {key} was {then}, now {today}")
        old_numbers = old.numbers
        if not _has_colours(record) and _has_colours(old):
            remarks.append(f"{record.name}: colours not compared, there is no GL renderer here")
            old_numbers = tuple(number for number in old_numbers if number.unit != COLOUR)
        allowance = _Allowance(old, record, looser)
        remarks += [f"{record.name}: {said}" for said in _drawn_said(allowance.anew)]
        found = tuple(_moves(record.name, old_numbers, record.numbers, allowance))
        moves.extend(found)
        asked = [one.about.get(ASKED, "") for one in (old, record)]
        # the same can be asked for in other words: worth a word only where the answers differ
        if all(asked) and asked[0] != asked[1] and any(move.verdict in ("moved", "gone") for move in found):
            remarks.insert(0, f"{record.name}: asked was {asked[0]}, now {asked[1]}")
    kept = (move for move in moves if not (partial and move.verdict == "gone"))
    return GoldenComparison(tuple(kept), tuple(remarks))


def rounded(number: Number) -> Number:
    """As a file will hold it, so that a number equals itself after a round trip."""
    value = number.value
    return Number(
        number.name,
        value if isinstance(value, str) else float(f"{value:.{_DIGITS}g}"),
        number.unit,
        float(f"{number.allowed:.3g}"),
        float(f"{number.standard_error:.3g}"),
        number.drawn_only,
    )


class _Allowance:
    """What a number may differ by, given what made the two records."""

    def __init__(self, old: Record, new: Record, looser: float) -> None:
        def parts(record: Record, made_by: bool) -> dict[str, str]:
            kept = (item for item in record.about.items() if item[0] != ASKED)
            return {key: value for key, value in kept if (key in MADE_BY) == made_by}

        known = new.about.get(COMMAND) != TABLE
        self.same_draw = known and parts(old, False) == parts(new, False)
        # the same versions, seed and rig make the same noise: then there is only rounding to allow for
        self.again = self.same_draw and parts(old, True) == parts(new, True)
        self.looser = looser
        before, now = ({one.name: one.value for one in record.numbers} for record in (old, new))
        same_command = old.about.get(COMMAND) == new.about.get(COMMAND)
        command = new.about.get(COMMAND, "") if same_command else ""
        self.anew = drawn_anew(command, before, now) if self.same_draw else DrawnAnew()
        n = sum(number.standard_error > 0 for number in new.numbers)
        self.sigmas = max(NOISE_SIGMAS, -NormalDist().inv_cdf(FALSE_ALARM / 2 / max(n, 1)))

    def noise(self, then: Number, now: Number) -> float:
        """What noise excuses."""
        if self.is_again(now.name) or (now.drawn_only and self.has_same_points(now.name)):
            return 0.0
        return self.sigmas * math.hypot(then.standard_error, now.standard_error)

    def is_again(self, name: str) -> bool:
        """Whether that number was made of the very same noise."""
        return self.again and not self.anew.has_other_noise(name)

    def has_same_points(self, name: str) -> bool:
        """Whether that number was made of the same points."""
        return self.same_draw and not self.anew.has_other_points(name)


def _drawn_said(found: DrawnAnew) -> Iterator[str]:
    """What was drawn anew though the seed is the same, a clause each."""

    def of_table(rows: frozenset[str]) -> int:
        return sum(row.startswith("rows") for row in rows)

    for rows, what in ((found.noise - found.points, "noise"), (found.points, "rig")):
        if rows:
            n, every = of_table(rows), of_table(found.rows)
            of = f" in {n} of {every} rows" if n < every else ""
            yield f"another {what}{of} draws other noise, so what is simulated is held to the noise of both"


def _has_colours(record: Record) -> bool:
    return any(number.unit == COLOUR for number in record.numbers)


def _moves(name: str, old: Iterable[Number], new: Iterable[Number], allowance: _Allowance) -> Iterator[Move]:
    before, now = ({number.name: number for number in numbers} for numbers in (old, new))
    for key in [*before, *(key for key in now if key not in before)]:
        then, today = before.get(key), now.get(key)
        if then is None and today is not None:
            yield Move(name, key, today.unit, math.nan, today.value, math.nan, "new")
        elif then is not None and today is None:
            yield Move(name, key, then.unit, then.value, math.nan, math.nan, "gone")
        elif then is not None and today is not None:
            yield _move(name, then, today, allowance)


def _move(name: str, then: Number, now: Number, allowance: _Allowance) -> Move:
    before, value = then.value, now.value
    if isinstance(before, str) or isinstance(value, str):
        word: GoldenVerdict = "same" if before == value else "moved"
        # a word that rests on noise says nothing where other noise was drawn
        if word == "moved" and now.drawn_only and not allowance.is_again(now.name):
            word = "within noise"
        return Move(name, then.name, then.unit, before, value, math.nan, word)
    noise = allowance.noise(then, now)
    rounding = ROUNDING * abs(before) if then.standard_error and not now.drawn_only else 0.0
    looser = allowance.looser * abs(before) if math.isfinite(before) else 0.0
    bound = max(then.allowed, now.allowed, noise, rounding, looser)
    verdict: GoldenVerdict = "moved"
    if value == before or (math.isnan(value) and math.isnan(before)):
        verdict = "same"
    elif math.isnan(value) != math.isnan(before):
        # whether a bin of depth holds enough of other points to say anything is noise as well
        is_drawn = now.drawn_only or max(then.standard_error, now.standard_error) > 0
        verdict = "within noise" if is_drawn and not allowance.has_same_points(now.name) else "moved"
    elif abs(value - before) <= bound:
        verdict = "within noise" if noise else "within tolerance"
    return Move(name, then.name, then.unit, before, value, bound, verdict)
