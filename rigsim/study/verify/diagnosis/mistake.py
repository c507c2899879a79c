"""What a mistake is: something done to what a right triangulator is given, or to what it gives back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from rigsim.rig.arrays import Array
from rigsim.study.saying import Saying, Value, saying
from rigsim.study.verify.diagnosis.reenact import Given, Lenses, Solver

Before: TypeAlias = Callable[[Given], Given]
"""What the triangulator is made to believe."""
After: TypeAlias = Callable[[Array, Given], Array]
"""What becomes of the right points (N, 3) m; the second argument is what was truly given."""
SIDES: tuple[Literal["left", "right"], ...] = ("left", "right")
"""The two images."""


@dataclass(frozen=True, slots=True, eq=False)
class Mistake:
    """One way to be wrong."""

    said: Saying
    """Its name, which of its forms, and what stands in the sentence of `rigsim.present.kit.mistakes`."""
    before: Before | None = None
    """What it does to pixels, lenses and pose; None for nothing."""
    after: After | None = None
    """What it does to the points; None for nothing."""
    solver: Solver | None = None
    """The only triangulator that makes it; None for any."""
    cost: float = 0.0
    """How much more it must explain to be believed before a simpler one."""

    @property
    def name(self) -> str:
        """Stable short name, as ``swapped-images``; forms of one mistake share it."""
        return self.said.subject


def of_left(change: Callable[[Lenses], Lenses]) -> Before:
    """Change the left camera."""
    return lambda g: replace(g, left=change(g.left))


def of_right(change: Callable[[Lenses], Lenses]) -> Before:
    """Change the right camera."""
    return lambda g: replace(g, right=change(g.right))


def of_both(change: Callable[[Lenses], Lenses]) -> Before:
    """Change either camera in the same way."""
    return lambda g: replace(g, left=change(g.left), right=change(g.right))


def of_pixels(change: Callable[[Array], Array]) -> Before:
    """Change the pixels (N, 2) of either image in the same way."""
    return lambda g: replace(g, uv_left=change(g.uv_left), uv_right=change(g.uv_right))


def sides(
    form: str, change: Callable[[Lenses], Lenses], cost: float = 0.0, **values: Value
) -> tuple[Mistake, Mistake, Mistake]:
    """The mistake in both cameras, in the left one, in the right one: ``{side}`` of its sentence."""

    def said(side: str) -> Saying:
        return saying(form, **values, side=saying(side))

    return (
        Mistake(said("in-both"), of_both(change), cost=cost),
        Mistake(said("in-left"), of_left(change), cost=cost + 0.002),
        Mistake(said("in-right"), of_right(change), cost=cost + 0.002),
    )
