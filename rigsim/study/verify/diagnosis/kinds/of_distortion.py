"""Mistakes with lens distortion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.mistake import Mistake, of_both, sides
from rigsim.study.verify.diagnosis.reenact import Lenses, Undo, bent, undo


def _bend(order: list[int], factors: tuple[float, ...] = (1.0,) * 5) -> Callable[[Lenses], Lenses]:
    return lambda lens: replace(lens, bend=lens.bend[:, order] * factors)


def _undone(how: Undo) -> Callable[[Lenses], Lenses]:
    return lambda lens: replace(lens, undo=how)


def _fixed_point(steps: int) -> Undo:
    """OpenCV's iteration."""

    def solve(seen: Array, bend: Array) -> Array:
        k1, k2, _, _, k3 = bend.T
        xy = seen
        for _ in range(steps):
            s = np.sum(xy**2, axis=1)
            radial = (1 + s * (k1 + s * (k2 + s * k3)))[:, None]
            xy = (seen - (bent(xy, bend) - xy * radial)) / radial
        return xy

    return solve


def _subtracted(steps: int) -> Undo:
    def solve(seen: Array, bend: Array) -> Array:
        xy = seen
        for _ in range(steps):
            xy = seen - (bent(xy, bend) - xy)
        return xy

    return solve


def _newton(steps: int) -> Undo:
    def solve(seen: Array, bend: Array) -> Array:
        xy = seen
        for _ in range(steps):
            residual = bent(xy, bend) - seen
            slope = by_jacobian(xy, bend)
            xy = xy - np.linalg.solve(slope, residual[:, :, None])[:, :, 0]
        return xy

    return solve


def by_jacobian(xy: Array, bend: Array) -> Array:
    """Derivative (N, 2, 2) of every row's distortion."""
    columns = []
    for axis in range(2):
        step = np.zeros(2)
        step[axis] = 1e-6
        columns.append((bent(xy + step, bend) - bent(xy - step, bend)) / 2e-6)
    return np.stack(columns, axis=2)


def _twice(seen: Array, bend: Array) -> Array:
    return undo(undo(seen, bend), bend)


_KEPT = [0, 1, 2, 3, 4]

DISTORTION: tuple[Mistake, ...] = (
    *sides("distortion-ignored", _bend(_KEPT, (0.0,) * 5)),
    *sides(
        "distortion-twice",
        _undone(_twice),
    ),
    *sides(
        "distortion-inverted",
        _undone(bent),
    ),
    *sides("distortion-sign", _bend(_KEPT, (-1.0,) * 5)),
    Mistake(
        saying("distortion-swapped"),
        lambda g: replace(
            g, left=replace(g.left, bend=g.right.bend), right=replace(g.right, bend=g.left.bend)
        ),
    ),
    Mistake(
        saying("distortion-swapped: left for both"),
        lambda g: replace(g, right=replace(g.right, bend=g.left.bend)),
    ),
    Mistake(
        saying("distortion-swapped: right for both"),
        lambda g: replace(g, left=replace(g.left, bend=g.right.bend)),
    ),
    *sides("distortion-p1-p2", _bend([0, 1, 3, 2, 4])),
    *sides(
        "distortion-tangential",
        _bend(_KEPT, (1, 1, 0, 0, 1)),
    ),
    *sides("distortion-k3", _bend(_KEPT, (1, 1, 1, 1, 0))),
    *sides(
        "distortion-k1-only",
        _bend(_KEPT, (1, 0, 0, 0, 0)),
        cost=0.001,
    ),
    *sides(
        "distortion-order",
        _bend([0, 1, 4, 2, 3]),
    ),
    *sides(
        "distortion-order",
        _bend([0, 1, 3, 4, 2]),
    ),
    *sides("distortion-k1-k2", _bend([1, 0, 2, 3, 4])),
    *sides("distortion-k2", _bend(_KEPT, (1, 0, 1, 1, 1))),
    *sides(
        "distortion-tangential: sign",
        _bend(_KEPT, (1, 1, -1, -1, 1)),
    ),
    *sides(
        "undistortion-unfinished: opposite signs",
        _undone(lambda seen, bend: bent(seen, -bend)),
        cost=0.001,
    ),
    *(
        mistake
        for steps in (1, 2, 3, 4, 5, 6, 8, 10, 15, 20)
        for mistake in (
            Mistake(
                saying("undistortion-unfinished: fixed point", steps=steps),
                of_both(_undone(_fixed_point(steps))),
                cost=0.001,
            ),
            Mistake(
                saying("undistortion-unfinished: subtraction", steps=steps),
                of_both(_undone(_subtracted(steps))),
                cost=0.001,
            ),
        )
    ),
    *(
        Mistake(
            saying("undistortion-unfinished: Newton", steps=steps),
            of_both(_undone(_newton(steps))),
            cost=0.001,
        )
        for steps in (1, 2, 3)
    ),
)
"""How a lens bends."""
