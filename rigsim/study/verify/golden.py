"""Golden results: what scenes and triangulators gave once, and what has moved since."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

import numpy as np

from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.study.verify.result import CaseResult, TriangulatorResult

GoldenVerdict: TypeAlias = Literal["same", "within tolerance", "within noise", "moved", "new", "gone"]
VERDICTS: tuple[GoldenVerdict, ...] = get_args(GoldenVerdict)
"""What may have become of a golden number."""

DEPTH_ALLOWED_M = 1e-9
"""What a depth found by rays may differ by, m: other processors round differently."""
GREY_ALLOWED = 2.0
"""What a rendered colour may differ by, grey levels of 255: other drivers shade differently."""
ROUNDING = 1e-6
"""What a statistic of the very same noise may differ by, relative."""
NOISE_SIGMAS = 3.0
"""A statistic has moved when it is off by more than this many standard errors of the difference."""

_GRID = (6, 4)
_BLOCK = 4
_DIGITS = 10
_GREY = "grey"


@dataclass(frozen=True, slots=True)
class Number:
    """One golden number, and what it may differ by."""

    name: str
    """Unique within its record, as ``depth (106, 89)``."""
    value: float
    """The number; NaN for nothing there."""
    unit: str
    """Unit; empty for ratios."""
    allowed: float = 0.0
    """What it may differ by without being a statistic."""
    standard_error: float = 0.0
    """Its standard error when it is one."""


@dataclass(frozen=True, slots=True)
class Record:
    """The golden numbers of one scene or one triangulator."""

    name: str
    """As ``scene-boards`` or ``triangulator-optimal``: the file's name without its ending."""
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
    before: float
    """Golden value; NaN when it is new."""
    now: float
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
    """How things stand with the golden results of a folder."""

    folder: str
    """The folder."""
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


def scene_record(simulator: Simulator, rig: StereoRig, about: Mapping[str, str]) -> Record:
    """Depth of a grid of left pixels by rays, and the colour of the picture around them where there is GL."""
    simulator.place(rig)
    columns, rows = _GRID
    u = np.round((np.arange(columns) + 0.5) * rig.left.width / columns)
    v = np.round((np.arange(rows) + 0.5) * rig.left.height / rows)
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    points_left, _ = simulator.points_at(uv)
    numbers = [
        Number(f"depth {_at(pixel)}", float(point[2]), "m", DEPTH_ALLOWED_M)
        for pixel, point in zip(uv, points_left, strict=True)
    ]
    if simulator.backend != "rays":
        light = simulator.render(supersample=1).left.light
        for pixel in uv.astype(int):
            x, y = (int(part) for part in pixel)
            block = light[y - _BLOCK : y + _BLOCK + 1, x - _BLOCK : x + _BLOCK + 1]
            for colour, level in zip(("red", "green", "blue"), block.mean(axis=(0, 1)), strict=True):
                numbers.append(Number(f"{colour} {_at(pixel)}", float(level) * 255, _GREY, GREY_ALLOWED))
    return Record(f"scene-{simulator.scene.name}", about, tuple(map(_rounded, numbers)))


def triangulator_record(result: TriangulatorResult, about: Mapping[str, str]) -> Record:
    """Size of the errors in every noisy or measured case, and how many rows did not come back in any case."""
    numbers = (number for case in result.results for number in _case_numbers(case))
    name = "".join(letter if letter.isalnum() else "-" for letter in result.triangulator)
    return Record(f"triangulator-{name}", about, tuple(map(_rounded, numbers)))


def compare(golden: Sequence[Record], now: Sequence[Record], partial: bool = False) -> GoldenComparison:
    """Hold records against golden ones of the same names; golden ones that were not made again are skipped.

    Colours are left out where nothing drew them now.

    Args:
        golden: what was written once.
        now: what was made again.
        partial: whether only some cases were run, so that a missing number is not a lost one.
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
        for key in sorted({*old.about, *record.about}):
            then, today = old.about.get(key, "nothing"), record.about.get(key, "nothing")
            if then != today:
                remarks.append(f"{record.name}: {key} was {then}, now {today}")
        old_numbers = old.numbers
        if not _has_colours(record) and _has_colours(old):
            remarks.append(f"{record.name}: colours not compared, there is no GL renderer here")
            old_numbers = tuple(number for number in old_numbers if number.unit != _GREY)
        again = dict(old.about) == dict(record.about)
        moves.extend(_moves(record.name, old_numbers, record.numbers, again))
    kept = (move for move in moves if not (partial and move.verdict == "gone"))
    return GoldenComparison(tuple(kept), tuple(remarks))


def rig_words(rig: StereoRig) -> str:
    """A rig in a few words, as the head of a golden file has it."""
    left = rig.left
    return f"{left.width}x{left.height} px, focal {left.fx:g} px, baseline {rig.baseline_m * 1e3:g} mm"


def _has_colours(record: Record) -> bool:
    return any(number.unit == _GREY for number in record.numbers)


def _case_numbers(result: CaseResult) -> Iterator[Number]:
    case, found = result.case, result.found_left
    if found is None or not case.answerable.any():
        return
    asked = case.answerable & np.isfinite(found).all(axis=1)
    yield Number(f"{case.name}, unanswered", float(case.answerable.sum() - asked.sum()), "rows")
    if case.kind not in ("noisy", "measured") or not math.isfinite(result.efficiency):
        return
    square = (found[asked, 2] - case.points_left[asked, 2]) ** 2
    n = len(square)
    error_m = float(square.std()) / math.sqrt(n) / (2 * result.depth_rms_m) if result.depth_rms_m else 0.0
    yield Number(
        f"{case.name}, depth RMS", result.depth_rms_m * 1e3, "mm", standard_error=max(error_m, 0.0) * 1e3
    )
    yield Number(f"{case.name}, error over bound", result.efficiency, "", standard_error=1 / math.sqrt(6 * n))


def _moves(name: str, old: Iterable[Number], new: Iterable[Number], again: bool) -> Iterator[Move]:
    before, now = ({number.name: number for number in numbers} for numbers in (old, new))
    for key in [*before, *(key for key in now if key not in before)]:
        then, today = before.get(key), now.get(key)
        if then is None and today is not None:
            yield Move(name, key, today.unit, math.nan, today.value, math.nan, "new")
        elif then is not None and today is None:
            yield Move(name, key, then.unit, then.value, math.nan, math.nan, "gone")
        elif then is not None and today is not None:
            yield _move(name, then, today, again)


def _move(name: str, then: Number, now: Number, again: bool) -> Move:
    # the same versions, seed and rig make the same noise: then there is nothing but rounding to allow for
    noise = 0.0 if again else NOISE_SIGMAS * math.hypot(then.standard_error, now.standard_error)
    rounding = ROUNDING * abs(then.value) if then.standard_error else 0.0
    bound = max(then.allowed, now.allowed, noise, rounding)
    change = abs(now.value - then.value)
    verdict: GoldenVerdict = "moved"
    if now.value == then.value or (math.isnan(now.value) and math.isnan(then.value)):
        verdict = "same"
    elif change <= bound:
        verdict = "within noise" if noise else "within tolerance"
    return Move(name, then.name, then.unit, then.value, now.value, bound, verdict)


def _rounded(number: Number) -> Number:
    """As the file will hold it, so that a number equals itself after a round trip."""
    return Number(
        number.name,
        float(f"{number.value:.{_DIGITS}g}"),
        number.unit,
        number.allowed,
        float(f"{number.standard_error:.3g}"),
    )


def _at(pixel: np.ndarray) -> str:
    return f"({pixel[0]:.0f}, {pixel[1]:.0f})"
