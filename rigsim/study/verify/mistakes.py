"""The mistakes that a diagnosis knows by name; here those with images, cameras and pose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from rigsim.rig.arrays import Array
from rigsim.study.verify.mistake import Mistake
from rigsim.study.verify.mistakes_answer import ANSWER
from rigsim.study.verify.mistakes_distortion import DISTORTION
from rigsim.study.verify.mistakes_lens import NUMBERS, PIXELS
from rigsim.study.verify.reenact import Given, Solver, homogeneous, turned, turned_back, unit

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


def _swap_images(g: Given) -> Given:
    return replace(g, uv_left=g.uv_right, uv_right=g.uv_left)


def _swap_lenses(g: Given) -> Given:
    return replace(g, left=g.right, right=g.left)


def _invert(g: Given) -> Given:
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


def _quaternion_order(order: list[int]) -> Callable[[Array], Array]:
    return lambda R: Rotation.from_quat(Rotation.from_matrix(R).as_quat()[:, order]).as_matrix()


def _along_x(g: Given) -> Array:
    return g.t * (1.0, 0.0, 0.0)


def _all_along_x(g: Given) -> Array:
    length = np.linalg.norm(g.t, axis=1)
    return np.column_stack([-length, 0 * length, 0 * length])


def _unit_length(g: Given) -> Array:
    return unit(g.t)


_SWAPPED = "Answers are what exchanged cameras give: left and right calibration are mixed up with the images"
_DEGREES = "The rotation is built from degrees where radians are meant, or the other way round"
_EULER = "The rotation's angles are put together in another order than they were taken apart"

CAMERAS: tuple[Mistake, ...] = (
    Mistake(
        "swapped-images",
        "Answers are what swapped images give: uv_left and uv_right are exchanged somewhere.",
        _swap_images,
    ),
    Mistake("swapped-cameras", f"{_SWAPPED} (both lenses).", lambda g: _swap_images(_swap_lenses(g))),
    Mistake("swapped-cameras", f"{_SWAPPED} (lenses and pose).", lambda g: _swap_lenses(_invert(g))),
    Mistake("swapped-cameras", f"{_SWAPPED} (pose).", lambda g: _swap_images(_invert(g))),
    Mistake(
        "swapped-intrinsics",
        "The left lens is used for the right image and the right one for the left: the two K are exchanged.",
        _swap_lenses,
    ),
    Mistake(
        "left-intrinsics-for-both",
        "The left camera's K is used for the right image as well.",
        lambda g: replace(g, right=replace(g.left, bend=g.right.bend)),
    ),
    Mistake(
        "left-intrinsics-for-both",
        "The left camera's K and distortion are used for the right image as well.",
        lambda g: replace(g, right=g.left),
    ),
    Mistake(
        "right-intrinsics-for-both",
        "The right camera's K is used for the left image as well.",
        lambda g: replace(g, left=replace(g.right, bend=g.left.bend)),
    ),
    Mistake(
        "right-intrinsics-for-both",
        "The right camera's K and distortion are used for the left image as well.",
        lambda g: replace(g, left=g.right),
    ),
    Mistake(
        "swapped-intrinsics",
        "The two K are exchanged, the distortions are not.",
        lambda g: replace(
            g, left=replace(g.right, bend=g.left.bend), right=replace(g.left, bend=g.right.bend)
        ),
        cost=0.002,
    ),
)
"""Which camera is which."""

POSE: tuple[Mistake, ...] = (
    Mistake(
        "inverse-pose",
        "The pose is used the wrong way round: right_from_left (x_right = R x_left + t) is taken for its "
        "inverse.",
        _invert,
    ),
    Mistake(
        "transposed-rotation",
        "R is transposed: a row-major matrix read by columns, or the inverse rotation with the right t.",
        _rotated(lambda R: R.transpose(0, 2, 1)),
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
        Mistake("baseline-along-x-only", f"Component {axis} of t is lost or zero.", _moved(keep), cost=0.002)
        for axis, keep in (
            ("x", lambda g: g.t * (0.0, 1.0, 1.0)),
            ("y", lambda g: g.t * (1.0, 0.0, 1.0)),
            ("z", lambda g: g.t * (1.0, 1.0, 0.0)),
        )
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
            "quaternion-order",
            "The quaternion's scalar is looked for at the wrong end: (w, x, y, z) and (x, y, z, w) differ.",
            _rotated(_quaternion_order(order)),
            cost=0.002,
        )
        for order in ([1, 2, 3, 0], [3, 0, 1, 2])
    ),
)
"""Where the right camera stands."""


def _parallel(length: Callable[[Given], Array], doffs: bool, undistorted: bool, mean_row: bool) -> Solver:
    """Z = f B / d whatever the rig."""

    def solve(g: Given, left: Array, right: Array) -> Array:
        one, other = (
            (left, right)
            if undistorted
            else ((g.uv_left - g.left.c) / g.left.f, (g.uv_right - g.right.c) / g.right.f)
        )
        fx = g.left.f[:, 0]
        u_left = one[:, 0] * fx + g.left.c[:, 0]
        u_right = other[:, 0] * g.right.f[:, 0] + g.right.c[:, 0]
        offset = g.right.c[:, 0] - g.left.c[:, 0] if doffs else 0.0
        z = fx * length(g) / (u_left - u_right + offset)
        y = (one[:, 1] + other[:, 1]) / 2 if mean_row else one[:, 1]
        return homogeneous(np.column_stack([one[:, 0], y])) * z[:, None]

    return solve


def _length(g: Given) -> Array:
    return np.asarray(np.linalg.norm(g.t, axis=1))


def _length_x(g: Given) -> Array:
    return -g.t[:, 0]


def _length_abs_x(g: Given) -> Array:
    return np.abs(g.t[:, 0])


PARALLEL: tuple[Mistake, ...] = tuple(
    Mistake(
        "treated-as-rectified",
        "Z = f B / d is used for rigs that are not rectified"
        + ("" if doffs else ", and without doffs")
        + ": rotate and rectify first, or solve for two rays.",
        solver=_parallel(length, doffs, undistorted, mean_row),
        cost=0.003,
    )
    for length in (_length, _length_x, _length_abs_x)
    for doffs in (True, False)
    for undistorted in (True, False)
    for mean_row in (True, False)
)
"""The formula of rectified rigs where it does not hold."""

LIBRARY: tuple[Mistake, ...] = (*CAMERAS, *POSE, *PIXELS, *NUMBERS, *DISTORTION, *ANSWER, *PARALLEL)
"""All mistakes that need no fit, the likelier first."""
