"""Mistakes with the right camera's pose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from rigsim.rig.arrays import Array
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


_DEGREES = "The rotation is built from degrees where radians are meant, or the other way round"
_EULER = "The rotation's angles are put together in another order than they were taken apart"

POSE: tuple[Mistake, ...] = (
    Mistake(
        "inverse-pose",
        "The pose is used the wrong way round: right_from_left (x_right = R x_left + t) is taken for its "
        "inverse.",
        invert,
    ),
    Mistake(
        "transposed-rotation",
        "R is transposed: a row-major matrix read by columns, or the inverse rotation with the right t.",
        _rotated(lambda R: R.transpose(0, 2, 1)),
    ),
    Mistake(
        "transposed-rotation",
        "The right camera's rays are turned by R where its transpose is meant; its place is right.",
        _turned_ray,
        cost=0.001,
    ),
    Mistake(
        "baseline-sign",
        "t has the wrong sign: the right camera is put on the left camera's other side.",
        _moved(lambda g: -g.t),
    ),
    Mistake(
        "centre-for-translation",
        "t is taken for the right camera's place (-R^T t), or its place for t.",
        _moved(lambda g: g.centre_right),
        cost=0.001,
    ),
    Mistake(
        "centre-for-translation",
        "R^T t stands for t: the translation is rotated once too often.",
        _moved(lambda g: turned_back(g.R, g.t)),
        cost=0.001,
    ),
    Mistake(
        "centre-for-translation",
        "R t stands for t: the translation is rotated once too often.",
        _moved(lambda g: turned(g.R, g.t)),
        cost=0.001,
    ),
    Mistake(
        "centre-for-translation",
        "The camera's place lacks its R^T: -t is used where -R^T t is meant.",
        _moved(lambda g: -turned(g.R, g.t)),
        cost=0.001,
    ),
    Mistake(
        "rotation-ignored",
        "The rotation between the cameras is ignored: R is taken for the identity.",
        _rotated(lambda R: np.broadcast_to(np.eye(3), R.shape)),
    ),
    Mistake(
        "small-angle",
        "The rotation is taken to first order, 1 + [w]x: that holds for small angles alone.",
        _rotated(_small_angle),
        cost=0.001,
    ),
    Mistake(
        "baseline-along-x-only",
        "Only the x component of t is used: the right camera is taken to sit exactly beside the left one.",
        _moved(_along_x),
        cost=0.001,
    ),
    Mistake(
        "baseline-along-x-only",
        "The whole length of t is laid along x: the right camera is taken to sit exactly beside "
        "the left one.",
        _moved(_all_along_x),
        cost=0.001,
    ),
    *(
        Mistake(
            "baseline-component-lost",
            f"Component {axis} of t is lost or zero.",
            _moved(_component(i, 0.0)),
            cost=0.002,
        )
        for i, axis in enumerate("xyz")
    ),
    Mistake(
        "unit-baseline",
        "The baseline's length is lost: t is scaled to length 1, as recoverPose gives it.",
        _moved(_unit_length),
    ),
    Mistake(
        "degrees-for-radians",
        f"{_DEGREES}: the angle is 57.3 times too large.",
        _rotated(_vector(np.degrees)),
    ),
    Mistake(
        "degrees-for-radians",
        f"{_DEGREES}: the angle is 57.3 times too small.",
        _rotated(_vector(np.radians)),
    ),
    *(
        Mistake(
            "degrees-for-radians",
            f"{_DEGREES} (Euler angles {order}).",
            _rotated(_euler(order, order, change)),
        )
        for order in _ORDERS
        for change in (np.degrees, np.radians)
    ),
    *(
        Mistake(
            "euler-order", f"{_EULER}: {read} and {written}.", _rotated(_euler(read, written)), cost=0.002
        )
        for read, written in _MIXED
    ),
    *(
        Mistake(
            "baseline-sign",
            f"Component {axis} of t has the wrong sign.",
            _moved(_component(i, -1.0)),
            cost=0.002,
        )
        for i, axis in enumerate("xyz")
    ),
    Mistake(
        "centre-for-translation",
        "The right camera's place is computed as -R t where -R^T t is meant.",
        _moved(lambda g: turned(g.R, turned(g.R, g.t))),
        cost=0.002,
    ),
    *(
        Mistake(
            "rotation-angle",
            f"The rotation about {axis} {what}.",
            _rotated(_one_angle(i, factor, others)),
            cost=0.003,
        )
        for i, axis in enumerate("xyz")
        for what, factor, others in (
            ("has the wrong sign", -1.0, 1.0),
            ("is lost", 0.0, 1.0),
            ("alone is used", 1.0, 0.0),
        )
    ),
    *(
        Mistake(
            "euler-order",
            f"The rotation vector's three numbers are taken for Euler angles ({order}).",
            _rotated(_vector_as_euler(order)),
            cost=0.002,
        )
        for order in _ORDERS
    ),
    *(
        Mistake(
            "quaternion-order",
            "The quaternion's scalar is looked for at the wrong end: (w, x, y, z) and (x, y, z, w) differ.",
            _rotated(_quaternion_order(order)),
            cost=0.002,
        )
        for order in ([1, 2, 3, 0], [3, 0, 1, 2])
    ),
)
"""Where the right camera stands."""
