"""Which rows of a record had other noise drawn than their golden ones, by what they say of their rig.

The noise of a row is drawn from a stream of its own, made from the rig, the noise and the points of it
(`rigsim.study.scene.plan.Plan.stream`): a row with another `noise_px` has other noise altogether, not the
same scaled, and one with another rig has other points as well. The two then are independent, whatever the
seed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import AXES

COMMANDS = frozenset(("sweep", "design"))
"""Those whose noise is drawn so; built rigs, of `tolerance`, are the same ones whatever the rig."""
_OF_NOISE = frozenset((col.NOISE, col.SENSOR))
"""What draws other noise on the same points."""
_OF_POINTS = frozenset(AXES) - _OF_NOISE - {col.TRIANGULATOR}
"""What draws other points."""
_RELATIVE = 1e-9


@dataclass(frozen=True, slots=True)
class DrawnAnew:
    """Rows, as what stands before the column in a number's name, that do not repeat the golden draw."""

    rows: frozenset[str] = frozenset()
    """All rows that say of which rig they are."""
    noise: frozenset[str] = frozenset()
    """Those with other noise."""
    points: frozenset[str] = frozenset()
    """Those of them with other points as well."""

    def has_other_noise(self, name: str) -> bool:
        """Whether that number rests on other noise; what is in no row does where any row does."""
        return _holds(self.noise, self.rows, name)

    def has_other_points(self, name: str) -> bool:
        """Whether it rests on other points."""
        return _holds(self.points, self.rows, name)


def drawn_anew(command: str, before: Mapping[str, float | str], now: Mapping[str, float | str]) -> DrawnAnew:
    """Compare what rows say of their rigs.

    Args:
        command: whose numbers they are.
        before: golden numbers by their names.
        now: the numbers now.
    """
    if command not in COMMANDS:
        return DrawnAnew()
    told = [(name, *_parts(name)) for name in before if name in now]
    axes = [one for one in told if one[2] in _OF_NOISE | _OF_POINTS]
    changed = [(row, column) for name, row, column in axes if not _is_same(before[name], now[name])]
    points = frozenset(row for row, column in changed if column in _OF_POINTS)
    return DrawnAnew(
        frozenset(row for _, row, _ in axes), points | frozenset(row for row, _ in changed), points
    )


def _holds(rows: frozenset[str], known: frozenset[str], name: str) -> bool:
    row, _ = _parts(name)
    return row in rows if row in known and row else bool(rows)


def _parts(name: str) -> tuple[str, str]:
    """The row of a number's name, and its column; of a part of the document, as ``recommended.width_px``,
    the row is empty."""
    row, _, column = name.rpartition(" ")
    return row, column.rpartition(".")[2]


def _is_same(one: float | str, other: float | str) -> bool:
    if isinstance(one, str) or isinstance(other, str):
        return one == other
    return abs(one - other) <= _RELATIVE * abs(one) or (one != one and other != other)
