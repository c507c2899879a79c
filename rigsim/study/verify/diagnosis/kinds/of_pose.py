"""Mistakes with the right camera's pose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from rigsim.rig.arrays import Array
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.mistake import Mistake
from rigsim.study.verify.diagnosis.reenact import Given, turned, turned_back, unit

Axes: TypeAlias = Literal["xyz", "zyx", "XYZ", "ZYX", "YXZ"]
"""Euler angles' axes, as scipy has them."""
_ORDERS: tuple[Axes, ...] = ("xyz", "zyx", "XYZ", "ZYX", "YXZ")
_MIXED: tuple[tuple[Axes, Axes], ...] = (
    ("xyz", "XYZ"),
    ("XYZ", "xyz"),
    ("xyz", "zyx"),
    ("zyx", "xyz"),
    ("ZYX", "XYZ"),
)


def invert(g: Given) -> Given:
    """The pose the other way round."""
    return replace(g, R=g.R.transpose(0, 2, 1), t=g.centre_right)


def _rotated(turn: Callable[[Array], Array]) -> Callable[[Given], Given]:
    return lambda g: replace(g, R=turn(g.R))


def _moved(move: Callable[[Given], Array]) -> Callable[[Given], Given]:
    return lambda g: replace(g, t=move(g))


def _vector(change: Callable[[Array], Array]) -> Callable[[Array], Array]:
    return lambda R: Rotation.from_rotvec(change(Rotation.from_matrix(R).as_rotvec())).as_matrix()


def _euler(
    read: Axes, written: Axes, change: Callable[[Array], Array] = lambda angles: angles
) -> Callable[[Array], Array]:
    return lambda R: Rotation.from_euler(written, change(Rotation.from_matrix(R).as_euler(read))).as_matrix()


def _vector_as_euler(order: Axes) -> Callable[[Array], Array]:
    return lambda R: Rotation.from_euler(order, Rotation.from_matrix(R).as_rotvec()).as_matrix()


def _quaternion_order(order: list[int]) -> Callable[[Array], Array]:
    return lambda R: Rotation.from_quat(Rotation.from_matrix(R).as_quat()[:, order]).as_matrix()


def _small_angle(R: Array) -> Array:
    """``1 + [w]x``, the rotation to first order."""
    x, y, z = Rotation.from_matrix(R).as_rotvec().T
    one = np.ones(len(R))
    return np.stack([one, -z, y, z, one, -x, -y, x, one], axis=1).reshape(-1, 3, 3)


def _along_x(g: Given) -> Array:
    return g.t * (1.0, 0.0, 0.0)


def _all_along_x(g: Given) -> Array:
    length = np.linalg.norm(g.t, axis=1)
    return np.column_stack([-length, 0 * length, 0 * length])


def _component(axis: int, factor: float) -> Callable[[Given], Array]:
    factors = np.ones(3)
    factors[axis] = factor
    return lambda g: g.t * factors


def _one_angle(axis: int, factor: float, others: float) -> Callable[[Array], Array]:
    factors = np.full(3, others)
    factors[axis] = factor
    return _euler("xyz", "xyz", lambda angles: angles * factors)


def _turned_ray(g: Given) -> Given:
    turn = g.R.transpose(0, 2, 1)
    return replace(g, R=turn, t=-turned(turn, g.centre_right))


def _unit_length(g: Given) -> Array:
    return unit(g.t)


POSE: tuple[Mistake, ...] = (
    Mistake(
        saying("inverse-pose"),
        invert,
    ),
    Mistake(
        saying("transposed-rotation"),
        _rotated(lambda R: R.transpose(0, 2, 1)),
    ),
    Mistake(
        saying("transposed-rotation: rays"),
        _turned_ray,
        cost=0.001,
    ),
    Mistake(
        saying("baseline-sign"),
        _moved(lambda g: -g.t),
    ),
    Mistake(
        saying("centre-for-translation"),
        _moved(lambda g: g.centre_right),
        cost=0.001,
    ),
    Mistake(
        saying("centre-for-translation: R^T t"),
        _moved(lambda g: turned_back(g.R, g.t)),
        cost=0.001,
    ),
    Mistake(
        saying("centre-for-translation: R t"),
        _moved(lambda g: turned(g.R, g.t)),
        cost=0.001,
    ),
    Mistake(
        saying("centre-for-translation: no R^T"),
        _moved(lambda g: -turned(g.R, g.t)),
        cost=0.001,
    ),
    Mistake(
        saying("rotation-ignored"),
        _rotated(lambda R: np.broadcast_to(np.eye(3), R.shape)),
    ),
    Mistake(
        saying("small-angle"),
        _rotated(_small_angle),
        cost=0.001,
    ),
    Mistake(
        saying("baseline-along-x-only"),
        _moved(_along_x),
        cost=0.001,
    ),
    Mistake(
        saying("baseline-along-x-only: whole length"),
        _moved(_all_along_x),
        cost=0.001,
    ),
    *(
        Mistake(
            saying("baseline-component-lost", axis=axis),
            _moved(_component(i, 0.0)),
            cost=0.002,
        )
        for i, axis in enumerate("xyz")
    ),
    Mistake(
        saying("unit-baseline"),
        _moved(_unit_length),
    ),
    Mistake(
        saying("degrees-for-radians: too large"),
        _rotated(_vector(np.degrees)),
    ),
    Mistake(
        saying("degrees-for-radians: too small"),
        _rotated(_vector(np.radians)),
    ),
    *(
        Mistake(
            saying("degrees-for-radians: Euler", order=order),
            _rotated(_euler(order, order, change)),
        )
        for order in _ORDERS
        for change in (np.degrees, np.radians)
    ),
    *(
        Mistake(
            saying("euler-order", read=read, written=written), _rotated(_euler(read, written)), cost=0.002
        )
        for read, written in _MIXED
    ),
    *(
        Mistake(
            saying("baseline-sign: component", axis=axis),
            _moved(_component(i, -1.0)),
            cost=0.002,
        )
        for i, axis in enumerate("xyz")
    ),
    Mistake(
        saying("centre-for-translation: -R t"),
        _moved(lambda g: turned(g.R, turned(g.R, g.t))),
        cost=0.002,
    ),
    *(
        Mistake(
            saying(f"rotation-angle: {what}", axis=axis),
            _rotated(_one_angle(i, factor, others)),
            cost=0.003,
        )
        for i, axis in enumerate("xyz")
        for what, factor, others in (
            ("sign", -1.0, 1.0),
            ("lost", 0.0, 1.0),
            ("alone", 1.0, 0.0),
        )
    ),
    *(
        Mistake(
            saying("euler-order: rotation vector", order=order),
            _rotated(_vector_as_euler(order)),
            cost=0.002,
        )
        for order in _ORDERS
    ),
    *(
        Mistake(
            saying("quaternion-order"),
            _rotated(_quaternion_order(order)),
            cost=0.002,
        )
        for order in ([1, 2, 3, 0], [3, 0, 1, 2])
    ),
)
"""Where the right camera stands."""
